"""Make the README's figures from the package itself.

    python scripts/make_figures.py [FOLDER]

``arm.png``: the arm with its frames and centres. ``workspace.png``: the published region against the exact
one. ``torque.png``: the torque over a recorded trajectory, split into its terms; the recording is the first
one found beside the checkout or in ALPHA5_RECORDINGS, and without one this figure is left as it is.
"""

from __future__ import annotations

import io
import os
import sys
from pathlib import Path
from typing import Any

import numpy as np

import alpha5_model as a5
from alpha5_model.files import atomic_write
from alpha5_model.kinematics.boundary import boundary, in_half_plane
from alpha5_model.trajectory import analyse, read_motion
from alpha5_model.view.build import build_scene
from alpha5_model.view.framing import framed
from alpha5_model.view.picture import picture_png

ROOT = Path(__file__).resolve().parent.parent
BESIDE = ROOT.parent / "shared" / "data"
#: Okabe and Ito's colours.
TEAL, RED, BLUE, ORANGE, PINK = "#009E73", "#D55E00", "#0072B2", "#E69F00", "#CC79A7"
SKY, BLACK = "#56B4E9", "#222222"


def main(folder: Path) -> None:
    """Make every figure that can be made."""
    for name, content in (
        ("arm.png", arm_picture()),
        ("workspace.png", workspace_figure()),
        ("torque.png", torque_figure()),
    ):
        if content is None:
            print(f"{name}: no recording found, left as it is")
        else:
            print(f"wrote {atomic_write(folder / name, content)}")


def arm_picture() -> bytes:
    """The arm, see-through, with its link frames and the centres of mass and buoyancy."""
    show = ("bodies", "see-through", "labels", "frames", "com", "cob")
    size = (1600, 900)
    scene = build_scene(a5.load(), [3.6, 1.15, 1.75, 1.2], show=show)
    return picture_png(framed(scene, size), size)


def workspace_figure() -> bytes:
    """Half-plane through the yaw axis: what is published and what can be reached."""
    figure, (axes,) = _figure(1, (7.4, 7.2))
    radius, z = np.meshgrid(np.arange(0.0, 0.40, 5e-4), np.arange(-0.34, 0.40, 5e-4))
    exact = in_half_plane(radius.ravel(), z.ravel()).reshape(radius.shape)
    points = np.stack([radius, np.zeros_like(radius), z], axis=-1)
    printed = a5.workspace.published_reachable(points)
    code = exact.astype(int) + 2 * printed
    extent = (0, 400, -340, 400)
    for value, colour, label in (
        (3, "#BFE3D6", "published and reachable"),
        (2, "#F2B48C", "published, cannot be reached"),
        (1, "#A8D4F0", "reachable, not published"),
    ):
        axes.contourf(
            1e3 * radius, 1e3 * z, code == value, levels=[0.5, 1.5], colors=[colour], extent=extent
        )
        axes.plot([], [], "s", color=colour, markersize=11, label=label)
    for i, arc in enumerate(boundary("both")):
        curve = 1e3 * arc.points(np.linspace(arc.start, arc.end, 80))
        axes.plot(*curve.T, color=TEAL, linewidth=1.8, label="" if i else "exact boundary")
    for i, torus in enumerate(a5.workspace.published_tori()):
        angle = np.linspace(0, 2 * np.pi, 400)
        x = 1e3 * (torus.center[0] + torus.radius * np.cos(angle))
        y = 1e3 * (torus.center[1] + torus.radius * np.sin(angle))
        x[x < 0] = np.nan
        axes.plot(x, y, "--", color=RED, linewidth=1.2, label="" if i else "published tori")
    errors = a5.workspace.published_errors()
    axes.set_title(
        f"Of the published region {errors.unreachable_area / errors.published_area:.1%} cannot be "
        f"reached;\nof what can be reached {errors.missed_area / errors.reachable_area:.1%} is not "
        "published",
        loc="left",
        fontsize=11,
    )
    axes.set_xlabel("distance from the yaw axis [mm]")
    axes.set_ylabel("height above base_link [mm]")
    axes.set_aspect("equal")
    axes.set_xlim(0, 390)
    axes.set_ylim(-330, 400)
    axes.legend(loc="center left", bbox_to_anchor=(1.02, 0.5), fontsize=10, frameon=False)
    return _png(figure)


def torque_figure() -> bytes | None:
    """Torque of shoulder and elbow over a recorded trajectory, split into its terms."""
    recordings = Path(os.environ.get("ALPHA5_RECORDINGS", BESIDE))
    found = sorted(recordings.glob("traj*_joint_states.csv"))
    if not found:
        return None
    # The pool is fresh water.
    a = analyse(read_motion(found[0]), arm=a5.load(fluid_density=a5.FRESH_WATER, gripper="jaws"))
    figure, rows = _figure(2, (9.6, 5.2), sharex=True)
    names = ("axis_d", "axis_c")
    for axes, name in zip(rows, names, strict=True):
        k = a.smooth.joints.index(name)
        for term, colour in (
            ("weight", ORANGE),
            ("buoyancy", SKY),
            ("inertia", PINK),
            ("coriolis", TEAL),
        ):
            axes.plot(
                a.smooth.time, getattr(a, term)[:, k], color=colour, linewidth=1.2, label=term
            )
        axes.plot(a.smooth.time, a.torque[:, k], color=BLACK, linewidth=1.6, label="torque")
        axes.set_ylabel(f"{name} [N m]")
        axes.margins(x=0.01)
    rows[0].legend(ncols=5, fontsize=9, frameon=False, loc="lower left", bbox_to_anchor=(0, 1.0))
    rows[-1].set_xlabel(f"time [s]   ({found[0].name}, fresh water)")
    return _png(figure)


def _figure(rows: int, size: tuple[float, float], sharex: bool = False) -> tuple[Any, Any]:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure: Any = Figure(figsize=size, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(rows, 1, sharex=sharex, squeeze=False)[:, 0]
    for one in axes:
        one.grid(color="#E6E6E6", linewidth=0.6)
        one.set_axisbelow(True)
        one.spines[["top", "right"]].set_visible(False)
    return figure, axes


def _png(figure: Any) -> bytes:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=120, metadata={"Software": None})
    return buffer.getvalue()


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "scripts" / "figures")
