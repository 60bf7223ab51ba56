"""The reachable set as shapes: the section in the arm's plane, and its surface."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.kinematics.boundary import Arc, boundary, in_half_plane
from alpha5_model.view.scene import Rigid, Shape
from alpha5_model.view.shapes import Mesh, join, lathe, quads, tube

_COLOR = (0.08, 0.60, 0.50)
#: Width of the strips that fill the section, and step along them [m].
_STRIP, _STEP = 1.5e-3, 0.5e-3
#: Radius of the boundary line [m].
_LINE = 1.1e-3
#: Longest chord of an arc [rad].
_CHORD = 0.08


def workspace_shapes() -> list[Shape]:
    """Section (turns with the arm: outwards underarm, behind the yaw axis overarm) and surface."""
    plane = Rigid("link_1")
    edges, fill, shell = _meshes()
    return [
        Shape("workspace", "section", plane, fill, _COLOR, opacity=0.16, flat=True),
        Shape("workspace", "boundary", plane, edges, _COLOR),
        Shape("surface", "shell", Rigid("base_link"), shell, _COLOR, opacity=0.10, flat=True),
    ]


def arc_points(arc: Arc, step: float) -> FloatArray:
    """Points (R, z) along an arc, (N, 2) [m], at most an angle of ``step`` [rad] apart."""
    count = max(2, math.ceil((arc.end - arc.start) / step) + 1)
    return arc.points(np.linspace(arc.start, arc.end, count))


@cache
def _meshes() -> tuple[Mesh, Mesh, Mesh]:
    sides = {
        (side, sign): [arc_points(arc, _CHORD) for arc in boundary(side)]
        for side, sign in (("underarm", 1.0), ("overarm", -1.0))
    }
    edges = [tube(_in_plane(arc, sign), _LINE) for (_, sign), arcs in sides.items() for arc in arcs]
    fill = [_section(side, sign, np.concatenate(arcs)) for (side, sign), arcs in sides.items()]
    shell = [lathe(arc_points(arc, _CHORD), sides=48) for arc in boundary("both")]
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
    inside = in_half_plane(*np.meshgrid(radius, z, indexing="ij"), side)
    # runs of reachable points in each column
    change = np.diff(np.pad(inside.astype(np.int8), ((0, 0), (1, 1))), axis=1)
    column, first = np.nonzero(change == 1)
    last = np.nonzero(change == -1)[1] - 1
    low, high = z[first] - _STEP / 2, z[last] + _STEP / 2
    left, right = radius[column] - _STRIP / 2, radius[column] + _STRIP / 2
    corners = [left, low, right, low, right, high, left, high]
    points = np.stack(corners, axis=1).reshape(-1, 4, 2)
    return quads(_in_plane(points, sign), [0.0, 1.0, 0.0])
