"""Plot of the arm's exact and published workspace in the half-plane."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.kinematics.workspace import (
    Arc,
    boundary,
    cross_section_area,
    volume,
)
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters
from alpha5_model.proofs.audit import printed_workspace
from alpha5_model.theory import arcs as plane
from alpha5_model.viewer.figures import Color, new_figure, style
from alpha5_model.viewer.outlines import CHORD, fill, legend_below, loops, polyline

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Colour of a reachable region.
FILL = "#E8EEF3"
#: Changes of the style of both figures.
_STYLE: dict[str, dict[str, Any]] = {
    "axes": {"grid": True},
    "grid": {"color": "0.9", "linewidth": 0.5},
    "legend": {"fontsize": 8.5},
}
#: Colour, line style and text of the entries of the legend of the exact boundary.
_LEGEND = (
    (Color.BLUE, "-", "underarm: the arm faces the point"),
    (Color.ORANGE, "-", "overarm: the arm turns its back to it"),
    (Color.BLACK, "-", "arm stretched"),
    (Color.BLACK, "--", "theta_1 (axis_d) at a limit"),
    (Color.BLACK, ":", "theta_2 (axis_c) at a limit"),
)


@style(**_STYLE)
def workspace_figure() -> Any:
    """Plot the catalogue's exact and published workspace, as a matplotlib Figure.

    Left, the boundary of the reachable set by the joint that stops it. Right, the
    published region over it. Lengths in mm.
    """
    page = new_figure(9.4, 9.0)
    left, right = page.subplots(1, 2, sharey=True)
    _draw_exact(left, parameters())
    _draw_published(right)
    for axes in (left, right):
        legend_below(axes, 0.08)
        axes.set(aspect="equal", xlim=(0.0, 370.0), ylim=(-310.0, 400.0))
        axes.set_xlabel("distance from the yaw axis R [mm]")
    left.set_ylabel("height above the base z [mm]")
    return page


@style(**_STYLE)
def own_workspace_figure(arm: Alpha5Parameters) -> Any:
    """Plot the exact workspace of an arm of one's own, as a matplotlib Figure.

    It is the left half of `workspace_figure`; nothing is published of such an arm.

    Args:
        arm: Its record.

    Raises:
        InputError: A tool point beside the wrist axis, whose reach no arcs bound.
    """
    page = new_figure(5.2, 9.0)
    axes = page.subplots()
    _draw_exact(axes, arm)
    legend_below(axes, 0.08)
    axes.set(aspect="equal", xlim=(0.0, None))
    axes.set_xlabel("distance from the yaw axis R [mm]")
    axes.set_ylabel("height above the base z [mm]")
    return page


def _draw_exact(axes: Axes, arm: Alpha5Parameters) -> None:
    _fill_arcs(axes, boundary(arm=arm), FILL)
    for side, color in (("underarm", Color.BLUE), ("overarm", Color.ORANGE)):
        for arc in boundary(side, arm=arm):
            points = polyline(arc.curve, CHORD) * 1e3
            axes.plot(*points.T, _line_style(arc), color=color, linewidth=1.8)
    _mark_shoulder(axes, Geometry.of(arm))
    for color, line, text in _LEGEND:
        axes.plot([], [], line, color=color, label=text)
    area = cross_section_area(arm=arm) * 1e4
    litres = volume(arm=arm) * 1e3
    size = f"{area:.0f} cm² of the half-plane, {litres:.1f} L in all"
    axes.set_title(f"What is reached within the joint limits\n{size}")


def _line_style(arc: Arc) -> str:
    """The line style for what bounds the workspace at an arc, as in `_LEGEND`."""
    if arc.cause == "stretched":
        return "-"
    return "--" if "theta_1" in arc.cause else ":"


def _mark_shoulder(axes: Axes, geometry: Geometry) -> None:
    shoulder = (geometry.a_0 * 1e3, geometry.d_0 * 1e3)
    axes.plot(*shoulder, "+", color=Color.BLACK)
    leader = {"arrowstyle": "-", "lw": 0.6}
    axes.annotate("shoulder", shoulder, (12, -70), fontsize=8, arrowprops=leader)


def _draw_published(axes: Axes) -> None:
    for torus in printed_workspace.published_tori():
        circle = plane.Arc(center=torus.center, radius=torus.radius, start=math.pi)
        points = polyline(circle, CHORD) * 1e3
        # The half-plane ends at the yaw axis.
        points[points[:, 0] < 0] = np.nan
        words = "the three published tori"
        axes.plot(*points.T, color=Color.BLACK, linewidth=1.0, label=words)

    errors = printed_workspace.published_errors()
    unreachable = errors.unreachable_area / errors.published_area
    missed = errors.missed_area / errors.reachable_area
    for arcs, color, alpha, label in (
        (boundary(), FILL, None, "published, and reachable"),
        (
            printed_workspace.published_but_unreachable(),
            Color.VERMILION,
            0.55,
            f"not reachable: {unreachable:.1%} of the published area",
        ),
        (
            printed_workspace.reachable_but_unpublished(),
            Color.GREEN,
            0.55,
            f"not published: {missed:.1%} of the reachable area",
        ),
    ):
        _fill_arcs(axes, arcs, color, alpha=alpha, label=label)

    unreachable = errors.unreachable_volume / errors.published_volume
    missed = errors.missed_volume / errors.reachable_volume
    axes.set_title(
        "The document's workspace (Section 1.2):\n"
        f"{unreachable:.1%} of its volume is not reached,\n"
        f"{missed:.1%} of what is reached is missing"
    )


def _fill_arcs(axes: Axes, arcs: Iterable[Arc], color: str, **options: Any) -> None:
    """Fill what arcs bound, in mm."""
    fill(axes, [loop * 1e3 for loop in loops(arcs)], color, zorder=0.8, **options)
