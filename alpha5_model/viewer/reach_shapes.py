"""What the arm reaches, as shapes of a scene."""

from __future__ import annotations

from functools import cache

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.kinematics.half_plane import boundary_of, contains
from alpha5_model.viewer.outlines import polyline
from alpha5_model.viewer.scene import Rigid, Shape
from alpha5_model.viewer.shapes import Mesh, join, lathe, quads, tube

_GREEN = (0.08, 0.60, 0.50)
#: Longest chord of an arc [rad].
_CHORD = 0.08
#: Width of the strips that fill the section [m].
_STRIP = 1.5e-3
#: Step along a strip in which its ends are found [m].
_STEP = 0.5e-3
#: Radius of the boundary line [m].
_LINE = 1.1e-3


@cache
def workspace_shapes(geometry: Geometry) -> tuple[Shape, Shape, Shape]:
    """The section of the reachable set, its boundary line, and its surface.

    The section turns with the arm; it lies outwards for underarm solutions, behind the
    yaw axis for overarm ones.

    Args:
        geometry: Of the arm.
    """
    outwards = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    behind = np.array([[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    strips = []
    lines = []
    for side, in_plane in (("underarm", outwards), ("overarm", behind)):
        outline = _outline(geometry, side)
        if not outline:
            continue  # the limits keep the arm from this side
        lines += [tube(points @ in_plane, _LINE) for points in outline]
        strips.append(_section(geometry, side, np.concatenate(outline), in_plane))
    shell = [lathe(points, 48) for points in _outline(geometry, "both")]
    return (
        Shape(
            group="workspace",
            name="section",
            anchor=Rigid("link_1"),
            mesh=join(strips),
            color=_GREEN,
            opacity=0.16,
            flat=True,
        ),
        Shape(
            group="workspace",
            name="boundary",
            anchor=Rigid("link_1"),
            mesh=join(lines),
            color=_GREEN,
        ),
        Shape(
            group="surface",
            name="shell",
            anchor=Rigid("base_link"),
            mesh=join(shell),
            color=_GREEN,
            opacity=0.10,
            flat=True,
        ),
    )


def _outline(geometry: Geometry, side: str) -> list[FloatArray]:
    """The arcs of a boundary as polylines (N, 2), (R, z) [m]."""
    arcs = boundary_of(geometry, side, limits=True)
    return [polyline(arc.curve, _CHORD) for arc in arcs]


def _section(
    geometry: Geometry, side: str, outline: FloatArray, in_plane: FloatArray
) -> Mesh:
    """The reachable part of the half-plane, filled with upright strips.

    Args:
        geometry: Of the arm.
        side: ``"underarm"`` or ``"overarm"``.
        outline: Points of its boundary, (N, 2) [m].
        in_plane: (R, z) to the axes of link_1, (2, 3).
    """
    corners = _strips(geometry, side, outline) @ in_plane
    return quads(corners, [0.0, 1.0, 0.0])


def _strips(geometry: Geometry, side: str, outline: FloatArray) -> FloatArray:
    """Corners of the strips, (N, 4, 2); the boundary line hides their steps."""
    bottom = outline[:, 1].min()
    width, top = outline.max(axis=0)
    middles = np.arange(_STRIP / 2, width + _STRIP, _STRIP)
    heights = np.arange(bottom - _STEP, top + 2 * _STEP, _STEP)
    radius, z = np.meshgrid(middles, heights, indexing="ij")
    inside = contains(geometry, radius, z, side, limits=True)

    # Up each column the arm's reach begins and ends in turn.
    changes = np.diff(inside, axis=1)
    column, row = np.nonzero(changes)
    ends = heights[row] + _STEP / 2
    low = ends[0::2]
    high = ends[1::2]
    middle = middles[column[0::2]]
    left = middle - _STRIP / 2
    right = middle + _STRIP / 2

    corners = [left, low, right, low, right, high, left, high]
    return np.stack(corners, axis=1).reshape(-1, 4, 2)
