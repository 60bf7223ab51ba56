"""The reachable set as shapes: the section in the arm's plane, and its surface."""

from __future__ import annotations

from functools import cache

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.kinematics.boundary import Arc, boundary, in_half_plane
from alpha5_model.view.scene import Rigid, Shape
from alpha5_model.view.shapes import Mesh, join, sheet, tube

_COLOR = (0.08, 0.60, 0.50)
#: Width of the strips that fill the section, and step along them [m].
_STRIP, _STEP = 1.5e-3, 0.5e-3
#: Radius of the boundary line [m].
_LINE = 1.1e-3
#: Longest chord of an arc [rad].
_CHORD = 0.08
_SIDES = 48


def workspace_shapes() -> list[Shape]:
    """Section (turns with the arm: outwards underarm, behind the yaw axis overarm) and surface."""
    plane = Rigid("link_1")
    edges, fill, shell = _meshes()
    return [
        Shape("workspace", "section", plane, fill, _COLOR, opacity=0.16, flat=True),
        Shape("workspace", "boundary", plane, edges, _COLOR),
        Shape("surface", "shell", Rigid("base_link"), shell, _COLOR, opacity=0.10, flat=True),
    ]


@cache
def _meshes() -> tuple[Mesh, Mesh, Mesh]:
    edges = [
        tube(_in_plane(_along(arc), sign), _LINE)
        for side, sign in (("underarm", 1.0), ("overarm", -1.0))
        for arc in boundary(side)
    ]
    fill = [_section(side, sign) for side, sign in (("underarm", 1.0), ("overarm", -1.0))]
    shell = [_revolved(_along(arc)) for arc in boundary("both")]
    return join(edges), join(fill), join(shell)


def _along(arc: Arc) -> FloatArray:
    count = max(2, int(np.ceil((arc.end - arc.start) / _CHORD)) + 1)
    return arc.points(np.linspace(arc.start, arc.end, count))


def _in_plane(points: FloatArray, sign: float) -> FloatArray:
    """(R, z) to the arm's plane, x and z of link_1."""
    return np.stack([sign * points[:, 0], np.zeros(len(points)), points[:, 1]], axis=1)


def _section(side: str, sign: float) -> Mesh:
    """Vertical strips over what can be reached; their ragged ends hide behind the boundary line."""
    points = np.concatenate([_along(arc) for arc in boundary(side)])
    radius = np.arange(_STRIP / 2, points[:, 0].max() + _STRIP, _STRIP)
    z = np.arange(points[:, 1].min() - _STEP, points[:, 1].max() + 2 * _STEP, _STEP)
    grid = np.meshgrid(radius, z, indexing="ij")
    inside = in_half_plane(grid[0].ravel(), grid[1].ravel(), side).reshape(grid[0].shape)
    # runs of reachable points in each column
    change = np.diff(np.pad(inside.astype(np.int8), ((0, 0), (1, 1))), axis=1)
    column, first = np.nonzero(change == 1)
    last = np.nonzero(change == -1)[1] - 1
    low, high, left = z[first] - _STEP / 2, z[last] + _STEP / 2, radius[column] - _STRIP / 2
    corners = [(left, low), (left + _STRIP, low), (left + _STRIP, high), (left, high)]
    vertices = np.stack([np.stack(corner, axis=1) for corner in corners], axis=1).reshape(-1, 2)
    start = 4 * np.arange(len(column), dtype=np.uint32)[:, None]
    faces = np.concatenate(
        [start + np.array([0, 1, 2], np.uint32), start + np.array([0, 2, 3], np.uint32)]
    )
    return sheet(_in_plane(vertices, sign), faces, [0.0, 1.0, 0.0])


def _revolved(points: FloatArray) -> Mesh:
    """A curve (R, z) turned about z."""
    angle = np.linspace(0.0, 2 * np.pi, _SIDES + 1)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    vertices = np.concatenate(
        [np.column_stack([radius * ring, np.full(len(ring), z)]) for radius, z in points]
    )
    i, k = np.meshgrid(np.arange(len(points) - 1), np.arange(_SIDES), indexing="ij")
    a = (i * (_SIDES + 1) + k).ravel().astype(np.uint32)
    b, d = a + np.uint32(1), a + np.uint32(_SIDES + 1)
    faces = np.concatenate(
        [np.stack([a, b, d + np.uint32(1)], 1), np.stack([a, d + np.uint32(1), d], 1)]
    )
    return sheet(vertices, faces, [0.0, 0.0, 1.0])
