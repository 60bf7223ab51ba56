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
from alpha5_model.kinematics.arm_plane import arm_plane
from alpha5_model.kinematics.boundary import Arc
from alpha5_model.paths import URDF_PATH
from alpha5_model.view.bodies import urdf_bodies
from alpha5_model.view.figures import check_format, fill, joined, new_figure, tidy, write_figure

#: Okabe and Ito's colours, told apart by colour-blind readers as well.
_COLOR = {"underarm": "#0072B2", "overarm": "#E69F00", "wrong": "#D55E00", "missed": "#009E73"}
_FILL, _INK = "#E8EEF3", "#222222"
#: Ends of arcs that are closer than this meet [m].
_MEET = 1e-9


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
    check_format(path)
    page = self_collision_figure(samples=samples) if self_collision else figure()
    return write_figure(page, path, dpi=150)


def figure() -> Any:
    """The picture as a matplotlib Figure that no window or global state knows of.

    Left, the boundary of the reachable set by the joint that stops it. Right, the published region
    over it. Lengths in mm.
    """
    page = new_figure(9.4, 9.0)
    exact, published = page.subplots(1, 2, sharey=True)
    _draw_exact(exact)
    _draw_published(published)
    for axes in (exact, published):
        axes.set_aspect("equal")
        axes.set_xlim(0.0, 370.0)
        axes.set_ylim(-310.0, 400.0)
        axes.set_xlabel("distance from the yaw axis R (mm)")
        tidy(axes, color="0.9", linewidth=0.5)
    exact.set_ylabel("height above the base z (mm)")
    return page


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
    base = [body.mesh.vertices[body.mesh.faces] for body in bodies if body.link == "link_0"]
    points = np.concatenate(base) @ at[:3, :3].T + at[:3, 3]

    page = new_figure(9.6, 4.7)
    views = page.subplots(1, 2)
    for axes, along, rows, name in ((views[0], 2, y, "y"), (views[1], 1, z, "z")):
        seen = reached.sum(axis=along)
        only_hit = seen - free.sum(axis=along)
        share = 100 * only_hit / np.maximum(seen, 1)
        _cells(axes, x, rows, seen, ListedColormap([_FILL]))
        image = _cells(axes, x, rows, share, "YlOrRd")
        faces = points[:, :, [0, 3 - along]] * 1e3
        axes.add_collection(PolyCollection(faces, facecolor=_INK, edgecolor=_INK, linewidth=0.3))
        axes.annotate("link_0", (0, 0), (0, -14), textcoords="offset points", fontsize=8)
        axes.set_aspect("equal")
        axes.set_xlim(-390, 390)
        axes.set_ylim(-390, 390)
        axes.set_xlabel("x (mm)")
        axes.set_ylabel(f"{name} (mm)")
        tidy(axes)
    views[0].set_title("from above: share of the reached heights", fontsize=10)
    views[1].set_title("from the side: share of the reached widths", fontsize=10)
    views[0].annotate(
        "theta_0 stops",
        (-300, 20),
        (-385, 330),
        fontsize=8,
        arrowprops={"arrowstyle": "-", "lw": 0.6},
    )
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
    from matplotlib.lines import Line2D

    _fill(axes, workspace.boundary("both"), _FILL)
    for side in workspace.SIDES[:2]:
        for arc in workspace.boundary(side):
            style = "-" if arc.cause == "stretched" else "--" if "theta_1" in arc.cause else ":"
            axes.plot(*_points(arc).T * 1e3, style, color=_COLOR[side], linewidth=1.8)
    plane = arm_plane()
    axes.plot([plane.a_0 * 1e3], [plane.d_0 * 1e3], "+", color=_INK)
    shoulder = (plane.a_0 * 1e3, plane.d_0 * 1e3)
    axes.annotate("shoulder", shoulder, (-14, 6), textcoords="offset points", fontsize=7)
    lines: Any = (
        (_COLOR["underarm"], "-", "underarm: the arm faces the point"),
        (_COLOR["overarm"], "-", "overarm: the arm turns its back to it"),
        (_INK, "-", "arm stretched"),
        (_INK, "--", "theta_1 (axis_d) at a limit"),
        (_INK, ":", "theta_2 (axis_c) at a limit"),
    )
    _legend(axes, [Line2D([], [], color=c, linestyle=s, label=t) for c, s, t in lines])
    axes.set_title(
        "Reachable within the joint limits\n"
        f"{workspace.cross_section_area() * 1e4:.0f} cm² of the half-plane, "
        f"{workspace.volume() * 1e3:.1f} L in all",
        fontsize=10,
    )


def _draw_published(axes: Any) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    _fill(axes, workspace.boundary("both"), _FILL)
    _fill(axes, workspace.published_but_unreachable(), _COLOR["wrong"], 0.55)
    _fill(axes, workspace.reachable_but_unpublished(), _COLOR["missed"], 0.55)
    for torus in workspace.published_tori():
        circle = Arc(torus.center, torus.radius, -np.pi, np.pi, 0, torus.name, "published")
        points = _points(circle) * 1e3
        points[points[:, 0] < 0] = np.nan
        axes.plot(*points.T, color=_INK, linewidth=1.0)
    errors = workspace.published_errors()
    wrong = errors.unreachable_area / errors.published_area
    missed = errors.missed_area / errors.reachable_area
    regions = (
        (_FILL, 1.0, "published, and reachable"),
        (_COLOR["wrong"], 0.55, f"published, not reachable: {wrong:.1%}"),
        (_COLOR["missed"], 0.55, f"reachable, not published: {missed:.1%}"),
    )
    tori = Line2D([], [], color=_INK, linewidth=1.0, label="the three published tori")
    _legend(axes, [tori, *(Patch(color=c, alpha=a, label=text) for c, a, text in regions)])
    axes.set_title(
        "The document's workspace (Section 1.2)\n"
        f"{errors.unreachable_volume / errors.published_volume:.1%} of its volume cannot be reached, "
        f"it misses {errors.missed_volume / errors.reachable_volume:.1%}",
        fontsize=10,
    )


def loops(arcs: Iterable[Arc], step: float = 0.01) -> list[FloatArray]:
    """Closed outlines of the region that arcs bound, joined along the yaw axis where it is open.

    Args:
        arcs: A whole boundary, as `workspace.boundary` gives it.
        step: Angle between two points of an arc, at most [rad].

    Returns:
        Polygons (N, 2), (R, z) [m], counter-clockwise around what is filled.
    """
    # Every arc with the region on its left; along the axis the outline then runs downwards.
    return joined((_points(arc, step)[:: arc.filled] for arc in arcs), _gap)


def _gap(end: FloatArray, start: FloatArray) -> float:
    """How far the outline goes without an arc: not at all, or down the axis; infinite if neither."""
    if math.dist(end, start) < _MEET:
        return 0.0
    on_axis = abs(end[0]) < _MEET and abs(start[0]) < _MEET and start[1] < end[1]
    return float(end[1] - start[1]) if on_axis else math.inf


def _points(arc: Arc, step: float = 0.01) -> FloatArray:
    count = max(2, math.ceil((arc.end - arc.start) / step) + 1)
    return arc.points(np.linspace(arc.start, arc.end, count))


def _fill(axes: Any, arcs: Iterable[Arc], color: str, alpha: float = 1.0) -> None:
    """Fill what arcs bound; holes run the other way round and stay open."""
    outlines = [1e3 * loop for loop in loops(arcs)]
    fill(axes, outlines, facecolor=color, alpha=alpha, linewidth=0, zorder=0.5)


def _legend(axes: Any, handles: list[Any]) -> None:
    below = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.08)}
    axes.legend(handles=handles, fontsize=8.5, frameon=False, **below)
