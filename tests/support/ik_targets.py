"""Targets of the inverse kinematics: ordinary ones, and on every edge and near it."""

from __future__ import annotations

import math

import numpy as np
from fk import FOLDED, STRETCHED, sample, tip
from reference import LOWER, UPPER

L_1, L_2 = math.hypot(0.040, 0.1453), math.hypot(0.020, 0.180)
EDGES = ("axis", "stretched", "folded", *(f"limit_{joint}" for joint in range(4)))


def ordinary(count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Targets (N, 3) and wrists (N,): half reached at random q, half anywhere."""
    rng = np.random.default_rng(seed)
    reached, anywhere = (
        tip(sample(count // 2, seed)),
        rng.uniform(-0.4, 0.4, (count // 2, 3)),
    )
    return np.concatenate([reached, anywhere]), rng.uniform(
        -10.0, 10.0, 2 * (count // 2)
    )


def at_edge(
    edge: str, count: int, seed: int, gap: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Targets beside an edge, at a gap of either sign, (count,) [m or rad]."""
    rng, q = np.random.default_rng(seed), sample(count, seed)
    if edge.startswith("limit"):
        joint = int(edge[-1])
        q[:, joint] = (
            np.where(rng.random(count) < 0.5, LOWER[joint], UPPER[joint]) + gap
        )
        return elbow_and_tip(q)[1], q[:, 3].copy()
    _, position = elbow_and_tip(q)
    if edge == "axis":
        turn = rng.uniform(-math.pi, math.pi, count)
        position[:, 0], position[:, 1] = gap * np.cos(turn), gap * np.sin(turn)
        return position, q[:, 3].copy()
    q[:, 2], sign = (STRETCHED, 1.0) if edge == "stretched" else (FOLDED, -1.0)
    elbow, position = elbow_and_tip(q)
    return position + sign * gap[:, None] * (position - elbow) / L_2, q[:, 3].copy()


def elbow_and_tip(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Elbow and tip (..., 3) [m], both drawn in the turned plane of the arm.

    This is faster than the product of matrices.
    """
    azimuth, phi = q[..., 0] + math.pi, q[..., 1] + math.atan(40 / 145.3) - math.pi / 2
    turned = phi - q[..., 2] + STRETCHED
    r, z = 0.020 + L_1 * np.cos(phi), 0.0462 + L_1 * np.sin(phi)
    cos, sin, points = np.cos(azimuth), np.sin(azimuth), []
    for out, up in ((r, z), (r + L_2 * np.cos(turned), z + L_2 * np.sin(turned))):
        points.append(np.stack([out * cos, out * sin, up], axis=-1))
    return points[0], points[1]
