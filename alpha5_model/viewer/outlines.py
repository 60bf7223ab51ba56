"""Boundaries as polylines, and the regions that they bound on matplotlib axes."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.kinematics.half_plane import Arc
from alpha5_model.theory import arcs

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Longest chord of an arc in a plot [rad].
CHORD = 0.01
_ORIGIN = (0.0, 0.0)


def polyline(curve: arcs.Curve, step: float) -> FloatArray:
    """Points along a curve, (N, 2) [m]; on an arc at most ``step`` [rad] apart."""
    span = curve.span if isinstance(curve, arcs.Arc) else step
    count = max(2, math.ceil(span / step) + 1)
    return curve.point(np.linspace(*curve.interval, count))


def loops(bounding: Iterable[Arc], step: float = CHORD) -> list[FloatArray]:
    """Polygons of the origin and each arc, which together wind once around a region.

    Lines from the origin and back cancel, and so does the yaw axis where the boundary
    is open.

    Args:
        bounding: A whole boundary, as `alpha5_model.workspace.boundary` gives it.
        step: Angle between two points of an arc, at most [rad].

    Returns:
        Polygons (N, 2), (R, z) [m], counter-clockwise around what is filled.
    """
    polygons = []
    for arc in bounding:
        line = polyline(arc.curve, step)[:: arc.filled]
        polygons.append(np.vstack([_ORIGIN, line]))
    return polygons


def fill(axes: Axes, lines: Iterable[FloatArray], color: str, **options: Any) -> None:
    """Fill what lies to the left of closed boundaries, lines (N, 2) in any order."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Outline

    # As in `loops`, lines from the origin and back cancel.
    outlines = [
        Outline(np.vstack([_ORIGIN, line, _ORIGIN]), closed=True) for line in lines
    ]
    if outlines:
        region = Outline.make_compound_path(*outlines)
        axes.add_patch(PathPatch(region, facecolor=color, linewidth=0, **options))


def legend_below(axes: Axes, drop: float, in_row: bool = False, **options: Any) -> None:
    """A legend under the axes, with each label once.

    Args:
        axes: The axes.
        drop: How far below them, in heights of the axes.
        in_row: Whether the labels stand beside one another.
        options: Of matplotlib's legend.
    """
    handles, labels = axes.get_legend_handles_labels()
    unique = dict(zip(labels, handles, strict=True))
    axes.legend(
        unique.values(),
        unique.keys(),
        loc="upper center",
        bbox_to_anchor=(0.5, -drop),
        ncols=len(unique) if in_row else 1,
        **options,
    )
