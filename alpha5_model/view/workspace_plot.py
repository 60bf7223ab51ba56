"""Draw what the tcp can reach: shapes for a scene, plots of its boundary and of self-collision."""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.kinematics import workspace
from alpha5_model.kinematics.plane import arm_plane
from alpha5_model.paths import REPOSITORY_PATH
from alpha5_model.view.figures import Color, fill, joined, legend, new_figure, style
from alpha5_model.view.scene import Rigid, Shape
from alpha5_model.view.shapes import Mesh, join, lathe, quads, read_obj, tube

_FILL = "#E8EEF3"
#: Colour of the shapes.
_GREEN = (0.08, 0.60, 0.50)
#: Ends of arcs that are closer than this meet [m].
_MEET = 1e-9
#: Longest chord of an arc in a picture, and of a shape [rad].
_CHORD, _COARSE = 0.01, 0.08
#: Width of the strips that fill the section, and step along them [m].
_STRIP, _STEP = 1.5e-3, 0.5e-3
#: Radius of the boundary line [m].
_LINE = 1.1e-3
#: Edge of the cells in which self-collision is counted [m].
CELL = 0.015


def workspace_shapes() -> list[Shape]:
    """Section (turns with the arm: outwards underarm, behind the yaw axis overarm) and surface."""
    plane = Rigid("link_1")
    edges, fill, shell = _workspace_meshes()
    return [
        Shape("workspace", "section", plane, fill, _GREEN, opacity=0.16, flat=True),
        Shape("workspace", "boundary", plane, edges, _GREEN),
        Shape("surface", "shell", Rigid("base_link"), shell, _GREEN, opacity=0.10, flat=True),
    ]


def arc_points(arc: workspace.Arc, step: float) -> FloatArray:
    """Points (R, z) along an arc, (N, 2) [m], at most an angle of ``step`` [rad] apart."""
    count = max(2, math.ceil((arc.end - arc.start) / step) + 1)
    return arc.points(np.linspace(arc.start, arc.end, count))


@cache
def _workspace_meshes() -> tuple[Mesh, Mesh, Mesh]:
    edges, fill = [], []
    for side, sign in (("underarm", 1.0), ("overarm", -1.0)):
        outline = [arc_points(arc, _COARSE) for arc in workspace.boundary(side)]
        edges += [tube(_in_plane(points, sign), _LINE) for points in outline]
        fill.append(_section(side, sign, np.concatenate(outline)))
    shell = [lathe(arc_points(arc, _COARSE), sides=48) for arc in workspace.boundary("both")]
    return join(edges), join(fill), join(shell)


def _in_plane(points: FloatArray, sign: float) -> FloatArray:
    """(R, z) to the arm's plane, x and z of link_1, (..., 3)."""
    radius, z = points[..., 0], points[..., 1]
    return np.stack([sign * radius, np.zeros_like(z), z], axis=-1)


def _section(side: str, sign: float, outline: FloatArray) -> Mesh:
    """Vertical strips over what can be reached; their ragged ends hide behind the boundary line."""
    (_, bottom), (width, top) = outline.min(axis=0), outline.max(axis=0)
    radius = np.arange(_STRIP / 2, width + _STRIP, _STRIP)
    z = np.arange(bottom - _STEP, top + 2 * _STEP, _STEP)
    inside = workspace.in_half_plane(*np.meshgrid(radius, z, indexing="ij"), side)
    # runs of reachable points in each column
    change = np.diff(np.pad(inside.astype(np.int8), ((0, 0), (1, 1))), axis=1)
    column, first = np.nonzero(change == 1)
    last = np.nonzero(change == -1)[1] - 1
    low, high = z[first] - _STEP / 2, z[last] + _STEP / 2
    left, right = radius[column] - _STRIP / 2, radius[column] + _STRIP / 2
    corners = [left, low, right, low, right, high, left, high]
    points = np.stack(corners, axis=1).reshape(-1, 4, 2)
    return quads(_in_plane(points, sign), [0.0, 1.0, 0.0])


@style(axes={"grid": True}, grid={"color": "0.9", "linewidth": 0.5}, legend={"fontsize": 8.5})
def figure() -> Any:
    """Plot the exact and the published reachable set in the half-plane, as a matplotlib Figure.

    Left, the boundary of the reachable set by the joint that stops it. Right, the published region
    over it. Lengths in mm.
    """
    page = new_figure(9.4, 9.0)
    panels = page.subplots(1, 2, sharey=True)
    for axes, draw in zip(panels, (_draw_exact, _draw_published), strict=True):
        draw(axes)
        legend(axes, 0.08)
        axes.set(aspect="equal", xlim=(0.0, 370.0), ylim=(-310.0, 400.0))
        axes.set_xlabel("distance from the yaw axis R [mm]")
    panels[0].set_ylabel("height above the base z [mm]")
    return page


@style()
def self_collision_figure(cell: float = CELL, samples: int = 20_000) -> Any:
    """Plot, from above and from the side, the share that is reached in self-collision only.

    Args:
        cell: Edge of the cells whose centres are tried [m].
        samples: Points behind the share in the title.
    """
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import ListedColormap

    # Imported here because nothing else in this module needs Pinocchio.
    from alpha5_model.dynamics import load
    from alpha5_model.dynamics.collision import without_self_collision

    plane = arm_plane()
    side, up = (math.ceil(far / cell) for far in (plane.a_0 + plane.longest, plane.longest))
    x, y, z = (cell * np.arange(-n, n + 1) for n in (side, side, up))
    z = z + plane.d_0
    grid = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1)
    reached = workspace.reachable(grid)
    free = np.zeros_like(reached)
    free[reached] = workspace.reachable(grid[reached], accept=without_self_collision)
    at = load().forward_kinematics(np.zeros(4), "link_0").homogeneous
    base = read_obj(str(Path(REPOSITORY_PATH, "meshes", "link_0.obj"))).moved(at)

    page = new_figure(9.6, 4.7)
    views = page.subplots(1, 2)
    for axes, along, rows, name in ((views[0], 2, y, "y"), (views[1], 1, z, "z")):
        seen = reached.sum(axis=along)
        share = 100 * (seen - free.sum(axis=along)) / np.maximum(seen, 1)
        _cells(axes, x, rows, seen, ListedColormap([_FILL]))
        image = _cells(axes, x, rows, share, "YlOrRd")
        faces: Any = base.vertices[base.faces][:, :, [0, 3 - along]] * 1e3
        axes.add_collection(PolyCollection(faces, color=Color.BLACK, linewidth=0.3))
        axes.annotate("link_0", (0, 0), (0, -14), textcoords="offset points", fontsize=8)
        span = (-390, 390)
        axes.set(aspect="equal", xlim=span, ylim=span, xlabel="x [mm]", ylabel=f"{name} [mm]")
    views[0].set_title("from above: share of the reached heights")
    views[1].set_title("from the side: share of the reached widths")
    line = {"arrowstyle": "-", "lw": 0.6}
    views[0].annotate("theta_0 stops", (-300, 20), (-385, 330), fontsize=8, arrowprops=line)
    found = workspace.sampled_share(without_self_collision, samples)
    hit = f"{1 - found.share:.1%} ± {found.standard_error:.1%}"
    title = f"{hit} of the reachable volume is reached only in self-collision"
    page.suptitle(title, fontsize=11)
    page.colorbar(image, ax=views, shrink=0.8, pad=0.02, label="reached only in self-collision [%]")
    return page


def _cells(axes: Any, x: Any, y: Any, values: Any, colors: Any) -> Any:
    """Cells about (x, y) [m], left open where there is nothing."""
    look = {"cmap": colors, "vmin": 0, "vmax": 100, "shading": "nearest"}
    return axes.pcolormesh(x * 1e3, y * 1e3, np.ma.masked_equal(values, 0).T, **look)


def _draw_exact(axes: Any) -> None:
    _fill(axes, workspace.boundary("both"), _FILL)
    for side, color in (("underarm", Color.BLUE), ("overarm", Color.ORANGE)):
        for arc in workspace.boundary(side):
            line = "-" if arc.cause == "stretched" else "--" if "theta_1" in arc.cause else ":"
            axes.plot(*arc_points(arc, _CHORD).T * 1e3, line, color=color, linewidth=1.8)
    plane = arm_plane()
    shoulder = (plane.a_0 * 1e3, plane.d_0 * 1e3)
    axes.plot(*shoulder, "+", color=Color.BLACK)
    leader = {"arrowstyle": "-", "lw": 0.6}
    axes.annotate("shoulder", shoulder, (12, -70), fontsize=8, arrowprops=leader)
    for color, line, text in (
        (Color.BLUE, "-", "underarm: the arm faces the point"),
        (Color.ORANGE, "-", "overarm: the arm turns its back to it"),
        (Color.BLACK, "-", "arm stretched"),
        (Color.BLACK, "--", "theta_1 (axis_d) at a limit"),
        (Color.BLACK, ":", "theta_2 (axis_c) at a limit"),
    ):
        axes.plot([], [], line, color=color, label=text)
    area, volume = workspace.cross_section_area() * 1e4, workspace.volume() * 1e3
    size = f"{area:.0f} cm² of the half-plane, {volume:.1f} L in all"
    axes.set_title(f"What is reached within the joint limits\n{size}")


def _draw_published(axes: Any) -> None:
    for torus in workspace.published_tori():
        circle = workspace.Arc(torus.center, torus.radius, -np.pi, np.pi, 0, torus.name, "")
        points = arc_points(circle, _CHORD) * 1e3
        points[points[:, 0] < 0] = np.nan
        axes.plot(*points.T, color=Color.BLACK, linewidth=1.0, label="the three published tori")
    e = workspace.published_errors()
    wrong = f"not reachable: {e.unreachable_area / e.published_area:.1%} of the published area"
    missed = f"not published: {e.missed_area / e.reachable_area:.1%} of the reachable area"
    _fill(axes, workspace.boundary("both"), _FILL, label="published, and reachable")
    _fill(axes, workspace.published_but_unreachable(), Color.VERMILION, alpha=0.55, label=wrong)
    _fill(axes, workspace.reachable_but_unpublished(), Color.GREEN, alpha=0.55, label=missed)
    wrong = f"{e.unreachable_volume / e.published_volume:.1%} of its volume is not reached"
    missed = f"{e.missed_volume / e.reachable_volume:.1%} of what is reached is missing"
    axes.set_title(f"The document's workspace (Section 1.2):\n{wrong},\n{missed}")


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
    """Length that no arc covers: none, or a piece down the axis; infinite if neither."""
    if math.dist(end, start) < _MEET:
        return 0.0
    on_axis = abs(end[0]) < _MEET and abs(start[0]) < _MEET and start[1] < end[1]
    return float(end[1] - start[1]) if on_axis else math.inf


def _fill(axes: Any, arcs: Iterable[workspace.Arc], color: str, **options: Any) -> None:
    """Fill what arcs bound, in mm."""
    fill(axes, [loop * 1e3 for loop in loops(arcs)], color, zorder=0.8, **options)
