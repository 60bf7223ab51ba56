"""Draw what arms reach: shapes for a scene; plots of the arm's boundary, of self-collision, of planar arms."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.paths import REPOSITORY_PATH
from alpha5_model.kinematics import workspace
from alpha5_model.kinematics.plane import arm_plane
from alpha5_model.kinematics.reach import planar_arc
from alpha5_model.theory import planar
from alpha5_model.viewer.figures import Color, new_figure, style, write_figure
from alpha5_model.viewer.scene import Rigid, Shape
from alpha5_model.viewer.shapes import join, lathe, quads, read_obj, tube

_FILL = "#E8EEF3"
#: Colours of planar arms.
REACHED, DEXTEROUS, EDGE, ARM, ALL = (
    "#dbe7f3",
    "#5b9bd5",
    "#2f4b66",
    "#d9730d",
    "#b8860b",
)
#: Colour of the shapes.
_GREEN = (0.08, 0.60, 0.50)
#: Longest chord of an arc in a picture, of a planar arm's, and of a shape [rad].
_CHORD, _FINE, _COARSE = 0.01, math.tau / 360, 0.08
#: Width of the strips that fill the section, step along them, and radius of the boundary line [m].
_STRIP, _STEP, _LINE = 1.5e-3, 0.5e-3, 1.1e-3
_ORIGIN = (0.0, 0.0)
#: Edge of the cells in which self-collision is counted [m].
CELL = 0.015


@cache
def workspace_shapes() -> tuple[Shape, ...]:
    """Section (turns with the arm: outwards underarm, behind the yaw axis overarm) and surface."""
    edges, strips = [], []
    for side, sign in (("underarm", 1.0), ("overarm", -1.0)):
        in_plane = np.array(
            [[sign, 0.0, 0.0], [0.0, 0.0, 1.0]]
        )  # (R, z) to the axes of link_1
        outline = [
            polyline(planar_arc(arc), _COARSE) for arc in workspace.boundary(side)
        ]
        edges += [tube(points @ in_plane, _LINE) for points in outline]
        corners = _strips(side, np.concatenate(outline)) @ in_plane
        strips.append(quads(corners, [0.0, 1.0, 0.0]))
    shell = [
        lathe(polyline(planar_arc(arc), _COARSE), 48)
        for arc in workspace.boundary("both")
    ]
    plane, base = Rigid("link_1"), Rigid("base_link")
    section = Shape(
        "workspace", "section", plane, join(strips), _GREEN, opacity=0.16, flat=True
    )
    boundary = Shape("workspace", "boundary", plane, join(edges), _GREEN)
    surface = Shape(
        "surface", "shell", base, join(shell), _GREEN, opacity=0.10, flat=True
    )
    return section, boundary, surface


def polyline(curve: planar.Curve, step: float) -> FloatArray:
    """Points along a curve, (N, 2) [m], on an arc at most an angle of ``step`` [rad] apart."""
    span = curve.span if isinstance(curve, planar.Arc) else step
    return curve.point(np.linspace(*curve.interval, max(2, math.ceil(span / step) + 1)))


def _strips(side: str, outline: FloatArray) -> FloatArray:
    """Corners (N, 4, 2) of upright strips of what is reached; the boundary line hides their ends."""
    (_, bottom), (width, top) = outline.min(axis=0), outline.max(axis=0)
    radius = np.arange(_STRIP / 2, width + _STRIP, _STRIP)
    z = np.arange(bottom - _STEP, top + 2 * _STEP, _STEP)
    inside = workspace.in_half_plane(*np.meshgrid(radius, z, indexing="ij"), side)
    # In each column what is reached begins and ends in turn.
    column, row = np.nonzero(np.diff(inside, axis=1))
    low, high = (z[row] + _STEP / 2).reshape(-1, 2).T
    left, right = radius[column[::2]] - _STRIP / 2, radius[column[::2]] + _STRIP / 2
    corners = [left, low, right, low, right, high, left, high]
    return np.stack(corners, axis=1).reshape(-1, 4, 2)


def loops(arcs: Iterable[workspace.Arc], step: float = _CHORD) -> list[FloatArray]:
    """The origin and each arc of a boundary, which together wind once around what it bounds.

    What runs from the origin and back cancels, and so does the yaw axis where the boundary is open.

    Args:
        arcs: A whole boundary, as `workspace.boundary` gives it.
        step: Angle between two points of an arc, at most [rad].

    Returns:
        Polygons (N, 2), (R, z) [m], counter-clockwise around what is filled.
    """
    lines = (polyline(planar_arc(arc), step)[:: arc.filled] for arc in arcs)
    return [np.vstack([_ORIGIN, line]) for line in lines]


def _fill(axes: Any, lines: Iterable[FloatArray], color: str, **options: Any) -> None:
    """Fill what lines (N, 2) bound that have it on their left, in any order: see `loops`."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Outline

    outlines = [
        Outline(np.vstack([_ORIGIN, line, _ORIGIN]), closed=True) for line in lines
    ]
    if outlines:
        whole = Outline.make_compound_path(*outlines)
        axes.add_patch(PathPatch(whole, facecolor=color, linewidth=0, **options))


def _legend(axes: Any, drop: float, **options: Any) -> None:
    """A legend under the axes, ``drop`` of their height below them, each label once."""
    handles, labels = axes.get_legend_handles_labels()
    unique = dict(zip(labels, handles, strict=True))
    where = {"loc": "upper center", "bbox_to_anchor": (0.5, -drop)}
    axes.legend(unique.values(), unique.keys(), **where, **options)


@style(
    axes={"grid": True},
    grid={"color": "0.9", "linewidth": 0.5},
    legend={"fontsize": 8.5},
)
def workspace_figure() -> Any:
    """Plot the exact and the published reachable set in the half-plane, as a matplotlib Figure.

    Left, the boundary of the reachable set by the joint that stops it. Right, the published region
    over it. Lengths in mm.
    """
    page = new_figure(9.4, 9.0)
    panels = page.subplots(1, 2, sharey=True)
    for axes, draw in zip(panels, (_draw_exact, _draw_published), strict=True):
        draw(axes)
        _legend(axes, 0.08)
        axes.set(aspect="equal", xlim=(0.0, 370.0), ylim=(-310.0, 400.0))
        axes.set_xlabel("distance from the yaw axis R [mm]")
    panels[0].set_ylabel("height above the base z [mm]")
    return page


def _draw_exact(axes: Any) -> None:
    _fill_arcs(axes, workspace.boundary("both"), _FILL)
    for side, color in (("underarm", Color.BLUE), ("overarm", Color.ORANGE)):
        for arc in workspace.boundary(side):
            line = (
                "-"
                if arc.cause == "stretched"
                else "--"
                if "theta_1" in arc.cause
                else ":"
            )
            points = polyline(planar_arc(arc), _CHORD) * 1e3
            axes.plot(*points.T, line, color=color, linewidth=1.8)
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
        points = (
            polyline(planar.Arc(torus.center, torus.radius, -math.pi), _CHORD) * 1e3
        )
        points[points[:, 0] < 0] = np.nan
        axes.plot(
            *points.T,
            color=Color.BLACK,
            linewidth=1.0,
            label="the three published tori",
        )
    e = workspace.published_errors()
    wrong = f"not reachable: {e.unreachable_area / e.published_area:.1%} of the published area"
    missed = (
        f"not published: {e.missed_area / e.reachable_area:.1%} of the reachable area"
    )
    beyond, left_out = (
        workspace.published_but_unreachable(),
        workspace.reachable_but_unpublished(),
    )
    _fill_arcs(
        axes, workspace.boundary("both"), _FILL, label="published, and reachable"
    )
    _fill_arcs(axes, beyond, Color.VERMILION, alpha=0.55, label=wrong)
    _fill_arcs(axes, left_out, Color.GREEN, alpha=0.55, label=missed)
    wrong = (
        f"{e.unreachable_volume / e.published_volume:.1%} of its volume is not reached"
    )
    missed = f"{e.missed_volume / e.reachable_volume:.1%} of what is reached is missing"
    axes.set_title(f"The document's workspace (Section 1.2):\n{wrong},\n{missed}")


def _fill_arcs(
    axes: Any, arcs: Iterable[workspace.Arc], color: str, **options: Any
) -> None:
    """Fill what arcs bound, in mm."""
    _fill(axes, [loop * 1e3 for loop in loops(arcs)], color, zorder=0.8, **options)


@style()
def self_collision_figure(cell: float = CELL, samples: int = 20_000) -> Any:
    """Plot, from above and from the side, the share that is reached in self-collision only.

    Args:
        cell: Edge of the cells whose centres are tried [m].
        samples: Points behind the share in the title.
    """
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import ListedColormap

    from alpha5_model.dynamics.collision import without_self_collision

    # Imported here because nothing else in this module needs Pinocchio.
    from alpha5_model.dynamics.load import load

    plane = arm_plane()
    side, up = (
        math.ceil(far / cell) for far in (plane.a_0 + plane.longest, plane.longest)
    )
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
        for values, colors in ((seen, ListedColormap([_FILL])), (share, "YlOrRd")):
            cells = np.ma.masked_equal(values, 0).T  # open where there is nothing
            look = {"cmap": colors, "vmin": 0, "vmax": 100, "shading": "nearest"}
            image = axes.pcolormesh(x * 1e3, rows * 1e3, cells, **look)
        faces: Any = base.vertices[base.faces][:, :, [0, 3 - along]] * 1e3
        axes.add_collection(PolyCollection(faces, color=Color.BLACK, linewidth=0.3))
        axes.annotate(
            "link_0", (0, 0), (0, -14), textcoords="offset points", fontsize=8
        )
        span = (-390, 390)
        axes.set(
            aspect="equal", xlim=span, ylim=span, xlabel="x [mm]", ylabel=f"{name} [mm]"
        )
    views[0].set_title("from above: share of the reached heights")
    views[1].set_title("from the side: share of the reached widths")
    line = {"arrowstyle": "-", "lw": 0.6}
    views[0].annotate(
        "theta_0 stops", (-300, 20), (-385, 330), fontsize=8, arrowprops=line
    )
    found = workspace.sampled_share(without_self_collision, samples)
    hit = f"{1 - found.share:.1%} ± {found.standard_error:.1%}"
    page.suptitle(
        f"{hit} of the reachable volume is reached only in self-collision", fontsize=11
    )
    page.colorbar(
        image,
        ax=views,
        shrink=0.8,
        pad=0.02,
        label="reached only in self-collision [%]",
    )
    return page


def plot_planar(
    arm: planar.PlanarArm,
    q: ArrayLike | None = None,
    axes: Any = None,
    dexterous: bool = True,
    resolution: int = 81,
) -> Any:
    """Draw a planar arm, its workspace and its dexterous workspace, joint limits included.

    The dexterous workspace is exact where `dexterous_radii` applies; else, for arms of three joints,
    the last one revolute, it is a map of the share of orientations reached.

    Args:
        arm: The arm.
        q: Joint position at which it is drawn, (N,); in the middle of its limits by default.
        axes: matplotlib axes; a new figure by default.
        dexterous: Whether to draw the dexterous workspace too.
        resolution: Points along each side of the map.

    Returns:
        The axes.

    Raises:
        MissingDependencyError: matplotlib is not installed.
    """
    axes = new_axes() if axes is None else axes
    space = arm.workspace()
    edges = [
        polyline(edge.curve, _FINE)[:: 1 if edge.inside_left else -1]
        for edge in space.edges
    ]
    _fill(axes, edges, REACHED, label="workspace", zorder=0)
    if dexterous and arm.length_ranges is not None:
        _dexterous_rings(axes, arm)
    elif dexterous and arm.n == 3 and arm.joints[-1] == "R":
        _dexterity_map(axes, arm, resolution)
    lines = [polyline(curve, _FINE) for curve in space.curves]
    for curve, line in zip(space.curves, lines, strict=True):
        whole = (
            {"lw": 2.4, "label": "workspace"} if curve in space.thin else {"lw": 1.0}
        )
        axes.plot(*line.T, color=EDGE, **whole)
    if q is None:  # in mid-range, free ones bent
        free = (0.5, 0.9, -0.7)
        q = [
            free[min(j, 2)] if r is None else sum(r) / 2
            for j, r in enumerate(arm.limits)
        ]
    path = arm.poses(q)[:, :2]
    axes.plot(*path.T, color=ARM, lw=3, solid_capstyle="round", label="arm")
    for kind, place in zip(arm.joints, path[:-1], strict=True):
        axes.plot(
            *place, "o" if kind == "R" else "s", ms=7, mfc="white", mec=ARM, mew=2
        )
    axes.plot(*path[-1], ".", ms=9, color=ARM)
    # The same scale on both axes and the same shape for every picture.
    points = np.concatenate([*lines, path])
    low, high = points.min(axis=0), points.max(axis=0)
    half = 0.54 * float((high - low).max())
    x, y = (low + high) / 2
    axes.set(aspect="equal", xlim=(x - half, x + half), ylim=(y - half, y + half))
    axes.set(xlabel="x [m]", ylabel="y [m]")
    axes.set_title(title(arm, space), fontsize=10)
    _legend(axes, 0.14, ncols=9, fontsize=8, frameon=False)
    return axes


def title(arm: planar.PlanarArm, space: planar.Workspace) -> str:
    """Kind and size of the workspace, in one line."""
    lengths = ", ".join(f"{x:g}" for x in arm.lengths)
    limited = any(
        r is not None for r, k in zip(arm.limits, arm.joints, strict=True) if k == "R"
    )
    low, high = space.radii
    size = (
        f"area {space.area:.4g} m²"
        if space.edges
        else f"radii {low:.4g} to {high:.4g} m"
    )
    return f"{arm.joints}, l = ({lengths}){', joint limits' * limited}: {space.shape}, {size}"


def new_axes(columns: int = 1, rows: int = 1, size: float = 5.2) -> Any:
    """One set of matplotlib axes, or an array of them, on a new figure.

    Raises:
        MissingDependencyError: matplotlib is not installed.
    """
    return new_figure(size * columns, size * rows).subplots(rows, columns)


def save(axes: Any, path: str | os.PathLike[str]) -> None:
    """Write the figure of the axes in the format of the suffix, as `write_figure` does.

    Raises:
        UnknownNameError: Another suffix.
        OutputError: It could not be written; nothing is left half-written.
    """
    write_figure(np.ravel(axes)[0].figure, path, dpi=120)


def _dexterous_rings(axes: Any, arm: planar.PlanarArm) -> None:
    point = 1e-12 * arm.reach
    for low, high in planar.dexterous_radii(arm):
        inner, outer = (polyline(planar.Arc(_ORIGIN, r), _FINE) for r in (low, high))
        if high <= point:
            axes.plot(
                0, 0, "o", ms=11, mfc="none", mec=DEXTEROUS, mew=2.5, label="dexterous"
            )
        elif high - low <= point:
            axes.plot(*outer.T, color=DEXTEROUS, lw=2.5, ls="--", label="dexterous")
        else:
            _fill(axes, [outer, inner[::-1]], DEXTEROUS, label="dexterous")


def _dexterity_map(axes: Any, arm: planar.PlanarArm, resolution: int) -> None:
    found = planar.dexterity_map(arm, resolution)
    x, y, share = found.x, found.y, found.share
    seen, look = np.ma.masked_equal(share, 0), {"cmap": "Blues", "vmin": 0, "vmax": 1}
    mesh = axes.pcolormesh(x, y, seen, shading="nearest", zorder=0.5, **look)
    bar = axes.figure.colorbar(mesh, ax=axes, fraction=0.04, pad=0.02)
    bar.set_label("share of orientations reached", fontsize=8)
    if share.max() >= 1:
        axes.contour(x, y, share, levels=[1 - 1e-9], colors=[ALL], linewidths=1)
        axes.plot([], [], color=ALL, lw=1, label="dexterous (numerical)")
