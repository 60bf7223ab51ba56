"""A picture of the workspace: the exact reachable set beside the published one, in the half-plane."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray, choice
from alpha5_model.errors import MissingDependencyError
from alpha5_model.files import atomic_write
from alpha5_model.kinematics import workspace
from alpha5_model.kinematics.arm_plane import arm_plane

FORMATS = (".png", ".pdf", ".svg")
#: Okabe and Ito's colours, told apart by colour-blind readers as well.
_COLOR = {"underarm": "#0072B2", "overarm": "#E69F00", "wrong": "#D55E00", "missed": "#009E73"}
_FILL, _INK = "#E8EEF3", "#222222"
#: Frame of the panels [m].
_EXTENT = (0.0, 0.37, -0.31, 0.40)


def write(path: str | os.PathLike[str]) -> Path:
    """Draw the picture and write it; the suffix says how: ``.png``, ``.pdf`` or ``.svg``.

    Raises:
        UnknownNameError: Another suffix.
        MissingDependencyError: matplotlib is not installed.
        OutputError: The file cannot be written.
    """
    target = Path(path)
    kind = choice("plot format", target.suffix.lower(), FORMATS)
    picture = io.BytesIO()
    figure().savefig(picture, format=kind[1:], dpi=150)
    return atomic_write(target, picture.getvalue())


def figure() -> Any:
    """The picture as a matplotlib Figure that no window or global state knows of.

    Left, the boundary of the reachable set by the joint that stops it. Right, the published region
    over it. Lengths in mm.
    """
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingDependencyError(
            "matplotlib", "the plot", "pip install 'alpha5-model[plot]'"
        ) from None
    page = Figure(figsize=(11.0, 7.6), layout="constrained")
    FigureCanvasAgg(page)
    exact, published = page.subplots(1, 2, sharey=True)
    _draw_exact(exact)
    _draw_published(published)
    for axes in (exact, published):
        axes.set_aspect("equal")
        axes.set_xlim(_EXTENT[0] * 1e3, _EXTENT[1] * 1e3)
        axes.set_ylim(_EXTENT[2] * 1e3, _EXTENT[3] * 1e3)
        axes.set_xlabel("distance from the yaw axis R (mm)")
        axes.grid(color="0.9", linewidth=0.5)
        axes.set_axisbelow(True)
        for spine in ("top", "right"):
            axes.spines[spine].set_visible(False)
    exact.set_ylabel("height above the base z (mm)")
    return page


def _draw_exact(axes: Any) -> None:
    R, z = _grid()
    inside = workspace.in_half_plane(R, z)
    _fill(axes, inside, _FILL)
    for side in workspace.SIDES[:2]:
        for arc in workspace.boundary(side):
            points = _points(arc)
            style = "-" if arc.cause == "stretched" else "--" if "theta_1" in arc.cause else ":"
            axes.plot(*points.T, style, color=_COLOR[side], linewidth=1.8)
    from matplotlib.lines import Line2D

    handles = [
        Line2D([], [], color=_COLOR["underarm"], label="underarm: the arm faces the point"),
        Line2D([], [], color=_COLOR["overarm"], label="overarm: the arm turns its back to it"),
        Line2D([], [], color=_INK, linestyle="-", label="arm stretched"),
        Line2D([], [], color=_INK, linestyle="--", label="theta_1 (axis_d) at a limit"),
        Line2D([], [], color=_INK, linestyle=":", label="theta_2 (axis_c) at a limit"),
    ]
    axes.legend(handles=handles, loc="upper right", fontsize=8, framealpha=0.95)
    plane = arm_plane()
    axes.plot([plane.a_0 * 1e3], [plane.d_0 * 1e3], "+", color=_INK)
    axes.annotate(
        "shoulder",
        (plane.a_0 * 1e3, plane.d_0 * 1e3),
        (4, 5),
        textcoords="offset points",
        fontsize=8,
    )
    axes.set_title(
        "Reachable within the joint limits\n"
        f"{workspace.cross_section_area() * 1e4:.0f} cm² of the half-plane, "
        f"{workspace.volume() * 1e3:.1f} L in all",
        fontsize=10,
    )


def _draw_published(axes: Any) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    R, z = _grid()
    inside, printed = workspace.in_half_plane(R, z), workspace.in_tori(R, z)
    _fill(axes, inside & printed, _FILL)
    _fill(axes, printed & ~inside, _COLOR["wrong"], 0.55)
    _fill(axes, inside & ~printed, _COLOR["missed"], 0.55)
    angle = np.linspace(0.0, 2 * np.pi, 721)
    for torus in workspace.published_tori():
        r = torus.center[0] + torus.radius * np.cos(angle)
        axes.plot(
            np.where(r >= 0, r, np.nan) * 1e3,
            (torus.center[1] + torus.radius * np.sin(angle)) * 1e3,
            color=_INK,
            linewidth=1.0,
        )
    errors = workspace.published_errors()
    wrong = errors.unreachable_area / errors.published_area
    missed = errors.missed_area / errors.reachable_area
    handles = [
        Line2D([], [], color=_INK, linewidth=1.0, label="published tori"),
        Patch(color=_FILL, label="published, and reachable"),
        Patch(color=_COLOR["wrong"], alpha=0.55, label=f"published, not reachable: {wrong:.1%}"),
        Patch(color=_COLOR["missed"], alpha=0.55, label=f"reachable, not published: {missed:.1%}"),
    ]
    axes.legend(handles=handles, loc="upper right", fontsize=8, framealpha=0.95)
    axes.set_title(
        "The document's workspace (Section 1.2) against it\n"
        f"by volume {errors.unreachable_volume / errors.published_volume:.1%} of it cannot be "
        f"reached, {errors.missed_volume / errors.reachable_volume:.1%} is missed",
        fontsize=10,
    )


def _points(arc: workspace.Arc) -> FloatArray:
    steps = max(2, int((arc.end - arc.start) * 180 / np.pi) + 1)
    return arc.points(np.linspace(arc.start, arc.end, steps)) * 1e3


def _grid() -> tuple[FloatArray, FloatArray]:
    """Centres of half-millimetre cells, [m]."""
    left, right, low, high = _EXTENT
    step = 5e-4
    R, z = np.meshgrid(
        np.arange(left + step / 2, right, step), np.arange(low + step / 2, high, step)
    )
    return R, z


def _fill(axes: Any, mask: np.ndarray, color: str, alpha: float = 1.0) -> None:
    from matplotlib.colors import to_rgba

    image = np.zeros((*mask.shape, 4))
    image[mask] = to_rgba(color, alpha)
    axes.imshow(
        image,
        extent=[1e3 * x for x in _EXTENT],
        origin="lower",
        aspect="equal",
        interpolation="nearest",
        zorder=0.5,
    )
