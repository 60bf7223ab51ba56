"""Pictures of planar arms: workspace, dexterous workspace, joint limits included."""

from __future__ import annotations

import math
import os
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model import planar
from alpha5_model.checks import FloatArray
from alpha5_model.view.figures import fill, joined, legend, new_figure, write_figure

REACHED, DEXTEROUS, EDGE, ARM, ALL = "#dbe7f3", "#5b9bd5", "#2f4b66", "#d9730d", "#b8860b"
#: Points along a full circle.
FINENESS = 361


def plot_planar(
    arm: planar.PlanarArm,
    q: ArrayLike | None = None,
    axes: Any = None,
    dexterous: bool = True,
    resolution: int = 81,
) -> Any:
    """Draw an arm, its workspace and its dexterous workspace.

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
    edges = [_polyline(edge.curve)[:: 1 if edge.inside_left else -1] for edge in space.edges]
    fill(axes, joined(edges, math.dist), REACHED, label="workspace", zorder=0)
    if dexterous and arm.length_ranges is not None:
        _dexterous_rings(axes, arm)
    elif dexterous and arm.n == 3 and arm.joints[-1] == "R":
        _dexterity_map(axes, arm, resolution)
    lines = [_polyline(curve) for curve in space.curves]
    for curve, line in zip(space.curves, lines, strict=True):
        whole = {"lw": 2.4, "label": "workspace"} if curve in space.thin else {"lw": 1.0}
        axes.plot(*line.T, color=EDGE, **whole)
    poses = arm.poses(middle_position(arm) if q is None else q)
    _draw_arm(axes, arm, poses)
    # The same scale on both axes and the same shape for every picture.
    points = np.concatenate([*lines, poses[:, :2]])
    low, high = points.min(axis=0), points.max(axis=0)
    half = 0.54 * float((high - low).max())
    x, y = (low + high) / 2
    axes.set(aspect="equal", xlim=(x - half, x + half), ylim=(y - half, y + half))
    axes.set(xlabel="x [m]", ylabel="y [m]")
    axes.set_title(title(arm, space), fontsize=10)
    legend(axes, 0.14, ncols=9, fontsize=8, frameon=False)
    return axes


def title(arm: planar.PlanarArm, space: planar.Workspace) -> str:
    """Kind and size of the workspace, in one line."""
    lengths = ", ".join(f"{x:g}" for x in arm.lengths)
    limited = any(r is not None for r, k in zip(arm.limits, arm.joints, strict=True) if k == "R")
    low, high = space.radii
    size = f"area {space.area:.4g} m²" if space.edges else f"radii {low:.4g} to {high:.4g} m"
    limits = ", joint limits" if limited else ""
    return f"{arm.joints}, l = ({lengths}){limits}: {space.shape}, {size}"


def middle_position(arm: planar.PlanarArm) -> FloatArray:
    """A joint position that shows the arm well: joints in mid-range, free ones bent, (N,)."""
    free = [0.5, 0.9, -0.7]
    middle = [free[min(j, 2)] if r is None else sum(r) / 2 for j, r in enumerate(arm.limits)]
    return np.array(middle)


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
        inner, outer = (_polyline(planar.Arc((0.0, 0.0), radius)) for radius in (low, high))
        if high <= point:
            axes.plot(0, 0, "o", ms=11, mfc="none", mec=DEXTEROUS, mew=2.5, label="dexterous")
        elif high - low <= point:
            axes.plot(*outer.T, color=DEXTEROUS, lw=2.5, ls="--", label="dexterous")
        else:
            fill(axes, [outer, inner[::-1]], DEXTEROUS, label="dexterous")


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


def _draw_arm(axes: Any, arm: planar.PlanarArm, poses: FloatArray) -> None:
    axes.plot(poses[:, 0], poses[:, 1], color=ARM, lw=3, solid_capstyle="round", label="arm")
    for kind, pose in zip(arm.joints, poses[:-1], strict=True):
        marker = "o" if kind == "R" else "s"
        axes.plot(*pose[:2], marker, ms=7, mfc="white", mec=ARM, mew=2)
    axes.plot(*poses[-1, :2], ".", ms=9, color=ARM)


def _polyline(curve: planar.Curve) -> FloatArray:
    count = 2
    if isinstance(curve, planar.Arc):
        count = max(2, math.ceil(curve.span / math.tau * (FINENESS - 1)) + 1)
    return curve.point(np.linspace(*curve.interval, count))
