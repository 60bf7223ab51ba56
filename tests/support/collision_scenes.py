"""Small scenes of the compiled self-collision, and calls that must compute."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from compiled_kernels import compiled_kernels

compiled = compiled_kernels()

AT_ORIGIN = np.eye(4)[:3].ravel()


def at(x: float, y: float = 0.0, z: float = 0.0, turn: Any = None) -> np.ndarray:
    rotation = np.eye(3) if turn is None else turn.as_matrix()
    return np.column_stack([rotation, [x, y, z]]).ravel()


def shape(
    body: int, half: Sequence[float], pose: np.ndarray = AT_ORIGIN, is_round: int = 0
) -> np.ndarray:
    """A box, or a cylinder of half [radius, radius, half length]."""
    return np.array([body, is_round, *half, *pose])


def chain(count: int, pose: np.ndarray = AT_ORIGIN) -> np.ndarray:
    """Bodies that each turn about the z of the one before."""
    return np.array([[body - 1, *pose] for body in range(count)], np.float64)


def scene_of(
    bodies: np.ndarray,
    shapes: Sequence[np.ndarray],
    pairs: Sequence[tuple[int, int]],
) -> Any:
    rows = np.array(shapes, np.float64).reshape(-1, 17)
    numbers = np.array(pairs, np.float64).reshape(-1, 2)
    return compiled.scene(bodies, rows, numbers)


def cubes(distance: float = 1.0) -> tuple[np.ndarray, list[np.ndarray]]:
    """Two cubes of 0.2, the second one at a distance along x, and turned about z."""
    bodies = np.array([[-1, *AT_ORIGIN], [0, *at(distance)]], np.float64)
    return bodies, [shape(0, [0.1, 0.1, 0.1]), shape(1, [0.1, 0.1, 0.1])]


def nearest(scene: Any, angles: np.ndarray) -> np.ndarray:
    out = np.full((len(angles), 9), 7.0)
    assert compiled.nearest_bodies_rows(scene, angles, out) is True
    return out


def assert_same_nearest(one: np.ndarray, other: np.ndarray) -> None:
    """Points of bodies that touch have no meaning."""
    apart = other[:, 0] > 0.0
    assert np.array_equal(one[apart], other[apart])
    assert np.array_equal(one[:, :3], other[:, :3])


def hits(scene: Any, angles: np.ndarray, margin: float = 0.0, asked: Any = None) -> Any:
    out = np.zeros(len(angles), np.bool_)
    assert compiled.self_collision_rows(scene, angles, margin, asked, out) is True
    return out


def shares(scene: Any, rates: Any, start: Any, end: Any, margin: float = 0.0) -> Any:
    out = np.full(len(start), np.nan)
    assert compiled.free_shares(scene, rates, start, end, margin, out) is True
    return out
