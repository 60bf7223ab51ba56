"""Pictures of the workspace: the exact reachable set beside the published one, in the half-plane, and where
it is reached in self-collision only.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.kinematics import workspace
from alpha5_model.kinematics.plane import arm_plane
from alpha5_model.paths import URDF_PATH
from alpha5_model.view.bodies import urdf_bodies
from alpha5_model.view.figures import Color, fill, joined, legend, new_figure, style, write_figure
from alpha5_model.view.reach import arc_points

_COLOR = {"underarm": Color.BLUE, "overarm": Color.ORANGE}
_FILL = "#E8EEF3"
#: Ends of arcs that are closer than this meet [m].
_MEET = 1e-9
#: Longest chord of an arc [rad].
_CHORD = 0.01
#: Edge of the cells in which self-collision is counted [m].
CELL = 0.015


def write(
    path: str | os.PathLike[str], self_collision: bool = False, samples: int = 20_000
) -> Path:
    """Draw the picture and write it; the suffix says how: ``.png``, ``.pdf`` or ``.svg``.

    Args:
        path: The file.
        self_collision: `self_collision_figure` in place of `figure`.
        samples: Points behind its share.

    Raises:
        UnknownNameError: Another suffix.
        MissingDependencyError: matplotlib is not installed.
        OutputError: The file cannot be written.
    """
    page = self_collision_figure(samples=samples) if self_collision else figure()
    return write_figure(page, path, dpi=150)


@style({"axes.grid": True, "grid.color": "0.9", "grid.linewidth": 0.5, "legend.fontsize": 8.5})
def figure() -> Any:
    """The picture as a matplotlib Figure that no window or global state knows of.

    Left, the boundary of the reachable set by the joint that stops it. Right, the published region
    over it. Lengths in mm.
    """
    page = new_figure(9.4, 9.0)
    panels = page.subplots(1, 2, sharey=True)
    for axes, draw in zip(panels, (_draw_exact, _draw_published), strict=True):
        draw(axes)
        legend(axes, 0.08)
        axes.set(aspect="equal", xlim=(0.0, 370.0), ylim=(-310.0, 400.0))
        axes.set_xlabel("distance from the yaw axis R (mm)")
    panels[0].set_ylabel("height above the base z (mm)")
    return page


@style()
def self_collision_figure(cell: float = CELL, samples: int = 20_000) -> Any:
    """From above and from the side: how much of what the arm reaches it reaches in self-collision only.

    Args:
        cell: Edge of the cells whose centres are tried [m].
        samples: Points behind the share in the title.
    """
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import ListedColormap

    from alpha5_model.dynamics.loading import load  # late: the other picture needs no Pinocchio
    from alpha5_model.dynamics.self_collision import without_self_collision

    plane = arm_plane()
    side = math.ceil((plane.a_0 + plane.longest) / cell)
    up = math.ceil(plane.longest / cell)
    x, y, z = (cell * np.arange(-n, n + 1) for n in (side, side, up))
    z = z + plane.d_0
    grid = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1)
    reached = workspace.reachable(grid)
    free = np.zeros_like(reached)
    free[reached] = workspace.reachable(grid[reached], accept=without_self_collision)
    urdf, at = Path(URDF_PATH), load().forward_kinematics(np.zeros(4), "link_0").homogeneous
    bodies = urdf_bodies(urdf.read_text("utf-8"), str(urdf.parent))
    base = [body.mesh.moved(at) for body in bodies if body.link == "link_0"]
    triangles: Any = np.concatenate([mesh.vertices[mesh.faces] for mesh in base])

    page = new_figure(9.6, 4.7)
    views = page.subplots(1, 2)
    for axes, along, rows, name in ((views[0], 2, y, "y"), (views[1], 1, z, "z")):
        seen = reached.sum(axis=along)
        only_hit = seen - free.sum(axis=along)
        share = 100 * only_hit / np.maximum(seen, 1)
        _cells(axes, x, rows, seen, ListedColormap([_FILL]))
        image = _cells(axes, x, rows, share, "YlOrRd")
        faces = triangles[:, :, [0, 3 - along]] * 1e3
        axes.add_collection(
            PolyCollection(faces, facecolor=Color.BLACK, edgecolor=Color.BLACK, linewidth=0.3)
        )
        axes.annotate("link_0", (0, 0), (0, -14), textcoords="offset points", fontsize=8)
        span = (-390, 390)
        axes.set(aspect="equal", xlim=span, ylim=span, xlabel="x (mm)", ylabel=f"{name} (mm)")
    views[0].set_title("from above: share of the reached heights")
    views[1].set_title("from the side: share of the reached widths")
    line = {"arrowstyle": "-", "lw": 0.6}
    views[0].annotate("theta_0 stops", (-300, 20), (-385, 330), fontsize=8, arrowprops=line)
    found = workspace.sampled_share(without_self_collision, samples)
    page.suptitle(
        f"{1 - found.share:.1%} ± {found.standard_error:.1%} of the reachable volume is reached only in "
        "self-collision",
        fontsize=11,
    )
    bar = page.colorbar(image, ax=views, shrink=0.8, pad=0.02)
    bar.set_label("reached only in self-collision (%)")
    return page


def _cells(axes: Any, x: Any, y: Any, values: Any, colors: Any) -> Any:
    """Cells about (x, y) [m], left open where there is nothing."""
    shown = np.ma.masked_equal(values, 0).T
    return axes.pcolormesh(
        x * 1e3, y * 1e3, shown, cmap=colors, vmin=0, vmax=100, shading="nearest"
    )


def _draw_exact(axes: Any) -> None:
    _fill(axes, workspace.boundary("both"), _FILL)
    for side, color in _COLOR.items():
        for arc in workspace.boundary(side):
            line = "-" if arc.cause == "stretched" else "--" if "theta_1" in arc.cause else ":"
            axes.plot(*arc_points(arc, _CHORD).T * 1e3, line, color=color, linewidth=1.8)
    plane = arm_plane()
    shoulder = (plane.a_0 * 1e3, plane.d_0 * 1e3)
    axes.plot(*shoulder, "+", color=Color.BLACK)
    axes.annotate("shoulder", shoulder, (-14, 6), textcoords="offset points", fontsize=7)
    for color, line, text in (
        (Color.BLUE, "-", "underarm: the arm faces the point"),
        (Color.ORANGE, "-", "overarm: the arm turns its back to it"),
        (Color.BLACK, "-", "arm stretched"),
        (Color.BLACK, "--", "theta_1 (axis_d) at a limit"),
        (Color.BLACK, ":", "theta_2 (axis_c) at a limit"),
    ):
        axes.plot([], [], line, color=color, label=text)
    axes.set_title(
        "Reachable within the joint limits\n"
        f"{workspace.cross_section_area() * 1e4:.0f} cm² of the half-plane, "
        f"{workspace.volume() * 1e3:.1f} L in all"
    )


def _draw_published(axes: Any) -> None:
    for torus in workspace.published_tori():
        circle = workspace.Arc(torus.center, torus.radius, -np.pi, np.pi, 0, torus.name, "")
        points = arc_points(circle, _CHORD) * 1e3
        points[points[:, 0] < 0] = np.nan
        axes.plot(*points.T, color=Color.BLACK, linewidth=1.0, label="the three published tori")
    e = workspace.published_errors()
    wrong, missed = e.unreachable_area / e.published_area, e.missed_area / e.reachable_area
    unreachable = workspace.published_but_unreachable()
    _fill(axes, workspace.boundary("both"), _FILL, label="published, and reachable")
    for arcs, color, text in (
        (unreachable, Color.VERMILION, f"published, not reachable: {wrong:.1%}"),
        (
            workspace.reachable_but_unpublished(),
            Color.GREEN,
            f"reachable, not published: {missed:.1%}",
        ),
    ):
        _fill(axes, arcs, color, alpha=0.55, label=text)
    axes.set_title(
        "The document's workspace (Section 1.2)\n"
        f"{e.unreachable_volume / e.published_volume:.1%} of its volume cannot be reached, "
        f"it misses {e.missed_volume / e.reachable_volume:.1%}"
    )


def loops(arcs: Iterable[workspace.Arc], step: float = _CHORD) -> list[FloatArray]:
    """Closed outlines of the region that arcs bound, joined along the yaw axis where it is open.

    Args:
        arcs: A whole boundary, as `workspace.boundary` gives it.
        step: Angle between two points of an arc, at most [rad].

    Returns:
        Polygons (N, 2), (R, z) [m], counter-clockwise around what is filled.
    """
    # Every arc with the region on its left; along the axis the outline then runs downwards.
    return joined([arc_points(arc, step)[:: arc.filled] for arc in arcs], _gap)


def _gap(end: FloatArray, start: FloatArray) -> float:
    """How far the outline goes without an arc: not at all, or down the axis; infinite if neither."""
    if math.dist(end, start) < _MEET:
        return 0.0
    on_axis = abs(end[0]) < _MEET and abs(start[0]) < _MEET and start[1] < end[1]
    return float(end[1] - start[1]) if on_axis else math.inf


def _fill(axes: Any, arcs: Iterable[workspace.Arc], color: str, **options: Any) -> None:
    """Fill what arcs bound, in mm."""
    fill(axes, [loop * 1e3 for loop in loops(arcs)], color, zorder=0.5, **options)
