"""Retracted poses: the hand near the yaw axis, where the arm can turn about it."""

from __future__ import annotations

from functools import lru_cache
from itertools import product

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.collision.bodies import CollisionBodies, body_poses
from alpha5_model.collision.self_collision import self_collision
from alpha5_model.collision.turning_radii import corners_around
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.planning.goals import joint_range

#: Angles of theta_1 and of theta_2 that are looked at.
_GRID = 11
#: Yaw angles at which a pose may be free of the arm itself.
_YAWS = 24
#: Retracted poses of an arm at most.
MOST = 60


@lru_cache(maxsize=16)
def retracted_poses(arm: Alpha5Parameters) -> tuple[tuple[float, float], ...]:
    """theta_1 and theta_2 of retracted poses, the one that needs least room first.

    At some yaw angle none of them touches itself.

    Args:
        arm: Record of the arm.
    """
    lower, upper = joint_range(arm)
    middle = (lower + upper) / 2
    yaws = np.linspace(lower[0], upper[0], _YAWS)
    angles = product(
        np.linspace(lower[1], upper[1], _GRID), np.linspace(lower[2], upper[2], _GRID)
    )
    poses = [(float(theta_1), float(theta_2)) for theta_1, theta_2 in angles]
    q = np.array([[yaw, *pose, middle[3]] for pose in poses for yaw in yaws])
    touching = self_collision(arm).touches(q).reshape(len(poses), _YAWS)
    free = np.flatnonzero(~touching.all(axis=1))

    radii = _radii(self_collision(arm).bodies, q[::_YAWS][free])
    order = free[np.argsort(radii, kind="stable")]
    return tuple(poses[number] for number in order[:MOST])


def _radii(bodies: CollisionBodies, q: FloatArray) -> FloatArray:
    """Largest distance of the moving links from the yaw axis at q (N, 4), (N,) [m]."""
    corners = [
        np.vstack([corners_around(shape) for shape in body.shapes])
        for body in bodies.bodies
    ]
    radii = np.zeros(len(q))
    for row, angles in enumerate(q):
        placements = body_poses(bodies, angles)
        for points, placement in zip(corners[1:], placements[1:], strict=True):
            flat = points @ placement[:2, :3].T + placement[:2, 3]
            radii[row] = max(radii[row], np.hypot(flat[:, 0], flat[:, 1]).max())
    return radii
