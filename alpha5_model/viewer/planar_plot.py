"""Plot of a planar arm with its workspace and its dexterous workspace."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray
from alpha5_model.theory import planar
from alpha5_model.viewer.figures import new_figure, write_figure
from alpha5_model.viewer.outlines import CHORD, fill, legend_below, polyline

if TYPE_CHECKING:
    from matplotlib.axes import Axes

REACHED = "#dbe7f3"
DEXTEROUS = "#5b9bd5"
EDGE = "#2f4b66"
ARM = "#d9730d"
#: Outline of the points that are reached in all orientations.
ALL = "#b8860b"
#: Angles of revolute joints without limits at which an arm is drawn, in turn [rad].
_BENT = (0.5, 0.9, -0.7)


def plot_planar(
    arm: planar.PlanarArm,
    q: ArrayLike | None = None,
    axes: Axes | None = None,
    dexterous: bool = True,
    resolution: int = 81,
) -> Axes:
    """Draw a planar arm, its workspace and its dexterous workspace, within limits.

    The dexterous workspace is exact where `dexterous_radii` applies. For other arms of
    three joints, the last one revolute, it is a map of the share of orientations
    reached.

    Args:
        arm: The arm.
        q: Joint position at which it is drawn, (N,); in the middle of its limits by
            default.
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
    _fill_workspace(axes, space)
    if dexterous and arm.length_ranges is not None:
        _draw_dexterous_rings(axes, arm)
    elif dexterous and arm.n == 3 and arm.joints.endswith("R"):
        _draw_dexterity_map(axes, arm, resolution)
    lines = _draw_boundary(axes, space)
    path = arm.poses(_middle(arm) if q is None else q)[:, :2]
    _draw_arm(axes, arm, path)

    _set_limits(axes, np.concatenate([*lines, path]))
    axes.set_title(title(arm, space), fontsize=10)
    legend_below(axes, 0.14, in_row=True, fontsize=8, frameon=False)
    return axes


def title(arm: planar.PlanarArm, space: planar.Workspace) -> str:
    """Kind and size of the workspace, in one line."""
    lengths = ", ".join(f"{x:g}" for x in arm.lengths)
    revolute = [
        limits
        for limits, kind in zip(arm.limits, arm.joints, strict=True)
        if kind == "R"
    ]
    limited = any(limits is not None for limits in revolute)
    name = f"{arm.joints}, l = ({lengths})"
    if limited:
        name += ", joint limits"
    low, high = space.radii
    size = f"area {space.area:.4g} m²"
    if not space.edges:
        size = f"radii {low:.4g} to {high:.4g} m"
    return f"{name}: {space.shape}, {size}"


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


def _fill_workspace(axes: Axes, space: planar.Workspace) -> None:
    edges = []
    for edge in space.edges:
        line = polyline(edge.curve, CHORD)
        edges.append(line if edge.inside_left else line[::-1])
    fill(axes, edges, REACHED, label="workspace", zorder=0)


def _draw_boundary(axes: Axes, space: planar.Workspace) -> list[FloatArray]:
    """Draw the boundary, with thicker lines for parts without area.

    Returns:
        Its lines, (N, 2) each.
    """
    lines = []
    for curve in space.curves:
        line = polyline(curve, CHORD)
        lines.append(line)
        look = {"lw": 2.4, "label": "workspace"} if curve in space.thin else {"lw": 1.0}
        axes.plot(*line.T, color=EDGE, **look)
    return lines


def _middle(arm: planar.PlanarArm) -> list[float]:
    """Joint positions in the middle of the limits; bent at joints without limits."""
    position = []
    for joint, limits in enumerate(arm.limits):
        if limits is None:
            position.append(_BENT[min(joint, len(_BENT) - 1)])
        else:
            position.append(sum(limits) / 2)
    return position


def _draw_arm(axes: Axes, arm: planar.PlanarArm, path: FloatArray) -> None:
    """The arm along the places of its joints and its tip, (n + 1, 2)."""
    axes.plot(*path.T, color=ARM, lw=3, solid_capstyle="round", label="arm")
    for kind, place in zip(arm.joints, path[:-1], strict=True):
        marker = "o" if kind == "R" else "s"
        axes.plot(*place, marker, ms=7, mfc="white", mec=ARM, mew=2)
    axes.plot(*path[-1], ".", ms=9, color=ARM)


def _set_limits(axes: Axes, points: FloatArray) -> None:
    """Show all points, in a square and with the same scale on both axes."""
    low = points.min(axis=0)
    high = points.max(axis=0)
    half = 0.54 * float((high - low).max())
    x, y = (low + high) / 2
    axes.set(aspect="equal", xlim=(x - half, x + half), ylim=(y - half, y + half))
    axes.set(xlabel="x [m]", ylabel="y [m]")


def _draw_dexterous_rings(axes: Axes, arm: planar.PlanarArm) -> None:
    """The exact dexterous workspace: rings, circles or the origin."""
    point = 1e-12 * arm.reach
    for low, high in planar.dexterous_radii(arm):
        inner = polyline(planar.Arc((0.0, 0.0), low), CHORD)
        outer = polyline(planar.Arc((0.0, 0.0), high), CHORD)
        if high <= point:
            (circle,) = axes.plot(0, 0, "o", ms=11, label="dexterous")
            circle.set(mfc="none", mec=DEXTEROUS, mew=2.5)
        elif high - low <= point:
            axes.plot(*outer.T, color=DEXTEROUS, lw=2.5, ls="--", label="dexterous")
        else:
            fill(axes, [outer, inner[::-1]], DEXTEROUS, label="dexterous")


def _draw_dexterity_map(axes: Axes, arm: planar.PlanarArm, resolution: int) -> None:
    """The share of orientations in which each point of a grid is reached."""
    found = planar.dexterity_map(arm, resolution)
    mesh = axes.pcolormesh(
        found.x,
        found.y,
        np.ma.masked_equal(found.share, 0),
        shading="nearest",
        zorder=0.5,
        cmap="Blues",
        vmin=0,
        vmax=1,
    )
    bar = axes.figure.colorbar(mesh, ax=axes, fraction=0.04, pad=0.02)
    bar.set_label("share of orientations reached", fontsize=8)
    if found.share.max() >= 1:
        edge = [1 - 1e-9]
        axes.contour(
            found.x, found.y, found.share, levels=edge, colors=[ALL], linewidths=1
        )
        axes.plot([], [], color=ALL, lw=1, label="dexterous (numerical)")
