"""Make the figures of README and documentation from the package itself.

    python scripts/figures/make_figures.py [FOLDER]

``arm.png``: the arm with its frames and centres. ``workspace.png``: the published
region against the exact
one. ``self_collision.png``: what is reached in self-collision only. ``torque.png``: the
torque over a recorded trajectory, split into its terms; the recording is the first one
found beside the checkout or in ALPHA5_RECORDINGS, and without one this figure is left
as it is. ``mjcf/alpha5.png``: MuJoCo's own picture of the committed scene (MUJOCO_GL is
egl if not set). Those that explain the concepts are in ``concept_figures.py``,
those of the errata in ``errata_figures.py``, plots of numbers in
``guide_figures.py``, pictures of the arm for guides in ``scene_figures.py``.
"""

from __future__ import annotations

import io
import os
import sys
from pathlib import Path
from typing import Any

import numpy as np

import alpha5_model as a5
from alpha5_model._support.writing import atomic_write
from alpha5_model.trajectory import analyse, read_motion
from alpha5_model.viewer import self_collision_plot, workspace_plot
from alpha5_model.viewer.build import build_scene
from alpha5_model.viewer.figures import CAUSES, Color, new_figure, number, style
from alpha5_model.viewer.framing import framed
from alpha5_model.viewer.picture import picture_png

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from figures import concept_figures, errata_figures, guide_figures, scene_figures

#: Those that are drawn by functions without arguments.
FIGURES = concept_figures.FIGURES | errata_figures.FIGURES | guide_figures.FIGURES

ROOT = Path(__file__).resolve().parents[2]
MUJOCO = ROOT / "mjcf"
BESIDE = ROOT.parent / "shared" / "data"


def main(folder: Path) -> None:
    """Make every figure that can be made."""
    for name, content in (
        ("arm.png", arm_picture()),
        ("workspace.png", workspace_figure()),
        (
            "self_collision.png",
            _png(self_collision_plot.self_collision_figure(samples=100_000)),
        ),
        ("torque.png", torque_figure()),
        *((name, _png(draw())) for name, draw in FIGURES.items()),
        *((name, draw()) for name, draw in scene_figures.FIGURES.items()),
    ):
        if content is None:
            print(f"{name}: no recording found, left as it is")
        else:
            print(f"wrote {atomic_write(folder / name, content)}")
    print(f"wrote {atomic_write(MUJOCO / 'alpha5.png', mujoco_picture())}")


def arm_picture() -> bytes:
    """The arm, see-through, with link frames and centres of mass and buoyancy."""
    show = ("bodies", "see-through", "labels", "frames", "com", "cob")
    size = (1600, 900)
    scene = build_scene(a5.load(), [3.6, 1.15, 1.75, 1.2], show=show)
    return picture_png(framed(scene, size), size)


def workspace_figure() -> bytes:
    """Half-plane through the yaw axis: what can be reached, and what is published."""
    return _png(workspace_plot.workspace_figure())


def mujoco_picture() -> bytes:
    """The arm with jaws in the first key frame, over the sea bed."""
    os.environ.setdefault("MUJOCO_GL", "egl")
    import mujoco
    from PIL import Image

    model = mujoco.MjModel.from_xml_path(str(MUJOCO / "scene_jaws.xml"))
    data, camera, buffer = mujoco.MjData(model), mujoco.MjvCamera(), io.BytesIO()
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    camera.azimuth, camera.elevation, camera.distance = 130, -15, 0.62
    camera.lookat[:] = 0.08, 0.0, 0.0
    with mujoco.Renderer(model, 900, 1200) as renderer:
        renderer.update_scene(data, camera)
        Image.fromarray(renderer.render()).save(buffer, "PNG", optimize=True)
    return buffer.getvalue()


@style(axes={"grid": True}, grid={"color": "#E6E6E6", "linewidth": 0.6})
def torque_figure() -> bytes | None:
    """Torque of shoulder and elbow over a recorded trajectory, split into its terms."""
    recordings = Path(os.environ.get("ALPHA5_RECORDINGS", BESIDE))
    found = sorted(recordings.glob("traj*_joint_states.csv"))
    if not found:
        return None
    # The pool is fresh water.
    a = analyse(
        read_motion(found[0]), arm=a5.load(fluid_density=a5.FRESH_WATER, gripper="jaws")
    )
    figure = new_figure(9.6, 5.2)
    grid = figure.subplots(2, 2, sharex=True, sharey="col")
    causes = a.causes()
    # Weight and buoyancy would hide the others, which are a hundred times smaller.
    columns = (
        ({"weight": 1.0, "buoyancy": 1.0, "torque": 1.0}, "N·m"),
        ({"inertia": 1e3, "coriolis": 1e3}, "mN·m"),
    )
    for row, name in zip(grid, ("axis_d", "axis_c"), strict=True):
        k = a.smooth.joints.index(name)
        for axes, (terms, unit) in zip(row, columns, strict=True):
            for term, scale in terms.items():
                values = a.torque if term == "torque" else causes[term]
                color = CAUSES.get(term, Color.BLACK)
                axes.plot(a.smooth.time, scale * values[:, k], color=color, label=term)
            axes.set_ylabel(f"{name} [{unit}]")
            axes.margins(x=0.01)
    weight, lift, inertia = (
        number(np.abs(causes[term][:, 1:3]).max())
        for term in ("weight", "buoyancy", "inertia")
    )
    most = f"weight up to {weight}, buoyancy {lift}, inertia {inertia} N·m"
    figure.suptitle(f"Torque over a recorded motion: {most}", fontsize=11)
    for axes in grid[0]:
        axes.legend(ncols=3, fontsize=9, loc="lower left", bbox_to_anchor=(0, 1.0))
    figure.supxlabel(f"time [s]   ({found[0].name}, fresh water)", fontsize=10)
    return _png(figure)


def _png(figure: Any) -> bytes:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=120, metadata={"Software": None})
    return buffer.getvalue()


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "scripts" / "figures")
