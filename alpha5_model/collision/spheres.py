"""Spheres that stand for the shapes of a body, for distances without branches.

Candidates lie on a grid in the shapes. Each has the largest sphere that fits into all
shapes together, made larger by `STICKING_OUT`. Of these, a greedy set cover takes one
after the other, always the one that covers most of the surface that is still bare; a
place counts as covered if it is no farther than `SHORT_BY` from a sphere.

Surface and candidates are sampled, so that both bounds hold to a millimetre or two.

References:
    [Chvatal1979] A greedy heuristic for the set-covering problem.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import BoolArray, FloatArray, frozen
from alpha5_model._support.spatial import moved, pose
from alpha5_model.geometry.primitives import Primitive

#: How far a sphere sticks out of the shapes at most [m].
STICKING_OUT = 0.0045
#: How far a place of the surface is from the next sphere at most [m].
SHORT_BY = 0.003
#: Distance of neighbouring places on the surface, and of candidates [m].
_SPACING = 0.004


class Spheres(NamedTuple):
    """Spheres in the frame of a body.

    Attributes:
        centres: (n, 3) [m].
        radii: (n,) [m].
    """

    centres: FloatArray
    radii: FloatArray


@lru_cache(maxsize=32)
def spheres_for(shapes: tuple[Primitive, ...]) -> Spheres:
    """Spheres that stand for the shapes of a body.

    Args:
        shapes: Boxes and cylinders, at least one.
    """
    surface = _outer_surface(shapes)
    candidates = _grid_inside(shapes, surface)
    apart = _distances(surface, candidates)
    radii = apart.min(axis=0) + STICKING_OUT
    chosen = _greedy_cover(apart <= radii + SHORT_BY)
    return Spheres(centres=frozen(candidates[chosen]), radii=frozen(radii[chosen]))


def signed_distances(shape: Primitive, points: FloatArray) -> FloatArray:
    """Distances of points (n, 3) from the surface of a shape, below 0 inside, (n,)."""
    at = pose(shape.xyz, shape.rpy)
    local = (points - at[:3, 3]) @ at[:3, :3]
    if shape.kind == "cylinder":
        radius, length = shape.size
        across = np.hypot(local[:, 0], local[:, 1]) - radius
        beyond = np.column_stack([across, np.abs(local[:, 2]) - length / 2])
    else:
        beyond = np.abs(local) - np.array(shape.size) / 2
    outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=1)
    inside = np.minimum(beyond.max(axis=1), 0.0)
    return np.asarray(outside + inside)


def _outer_surface(shapes: tuple[Primitive, ...]) -> FloatArray:
    """Places on the surface of shapes that are in no other shape, (n, 3)."""
    places = np.vstack([surface_places(shape) for shape in shapes])
    deepest = np.min([signed_distances(shape, places) for shape in shapes], axis=0)
    return np.asarray(places[deepest > -1e-9])


def _grid_inside(shapes: tuple[Primitive, ...], surface: FloatArray) -> FloatArray:
    """Places of a grid that are in a shape, (n, 3)."""
    lowest = surface.min(axis=0)
    highest = surface.max(axis=0)
    axes = [
        np.arange(low, high + _SPACING, _SPACING)
        for low, high in zip(lowest, highest, strict=True)
    ]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    deepest = np.min([signed_distances(shape, grid) for shape in shapes], axis=0)
    return np.asarray(grid[deepest < -1e-9])


def surface_places(shape: Primitive) -> FloatArray:
    """Places on the surface of a shape, edges and corners included, (n, 3)."""
    local = _on_cylinder(*shape.size) if shape.kind == "cylinder" else _on_box(shape)
    return moved(pose(shape.xyz, shape.rpy), local)


def _on_box(shape: Primitive) -> FloatArray:
    axes = [np.linspace(-edge / 2, edge / 2, _steps(edge) + 1) for edge in shape.size]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    on_face = np.isclose(np.abs(grid), np.array(shape.size) / 2, atol=1e-12, rtol=0.0)
    return np.asarray(grid[on_face.any(axis=1)])


def _on_cylinder(radius: float, length: float) -> FloatArray:
    corners = max(8, _steps(math.tau * radius))
    around = math.tau * np.arange(corners) / corners
    circle = np.column_stack([np.cos(around), np.sin(around)])
    heights = np.linspace(-length / 2, length / 2, _steps(length) + 1)
    rings = [(radius, height) for height in heights]
    for inner in np.linspace(0.0, radius, _steps(radius) + 1)[:-1]:
        rings += [(inner, heights[0]), (inner, heights[-1])]
    return np.vstack(
        [
            np.column_stack([width * circle, np.full(len(circle), height)])
            for width, height in rings
        ]
    )


def _steps(length: float) -> int:
    """Into how many parts a length is divided."""
    return math.ceil(length / _SPACING)


def _distances(one: FloatArray, other: FloatArray) -> FloatArray:
    """Distances of points (n, 3) from points (m, 3), (n, m)."""
    # In place: there are some ten million.
    squares = np.zeros((len(one), len(other)))
    for mine, theirs in zip(one.T, other.T, strict=True):
        along = mine[:, None] - theirs
        along *= along
        squares += along
    return np.sqrt(squares, out=squares)


def _greedy_cover(covers: BoolArray) -> list[int]:
    """Columns of a table (places, sets) that cover all places that any column does."""
    chosen = []
    gains = covers.sum(axis=0)
    bare = np.asarray(covers.any(axis=1))
    while bare.any():
        best = int(gains.argmax())
        new = np.flatnonzero(covers[:, best] & bare)
        chosen.append(best)
        bare[new] = False
        gains = gains - covers[new].sum(axis=0)
    return chosen
