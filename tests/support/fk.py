"""Forward kinematics from the retyped Table 1, for many configurations at once."""

from __future__ import annotations

import math

import numpy as np
import reference
from reference import LOWER, UPPER

#: theta_2 of the stretched arm: the angle of the triangle of Section 1.3 is pi.
STRETCHED = math.pi - reference.THETA_C - math.asin(20 / math.hypot(20, 180))
FOLDED = STRETCHED - math.pi
WEDGE = 2 * math.pi - (UPPER[0] - LOWER[0])


def fk(q: np.ndarray) -> np.ndarray:
    """transform_tcp_to_base, (..., 4, 4), written out row by row."""
    out = np.broadcast_to(np.eye(4), (*q.shape[:-1], 4, 4))
    for j, (d, offset, a, alpha) in enumerate(reference.DH):
        theta = (q[..., j] if j < 4 else np.zeros(q.shape[:-1])) + offset
        row = np.zeros((*q.shape[:-1], 4, 4))
        c, s, ca, sa = np.cos(theta), np.sin(theta), math.cos(alpha), math.sin(alpha)
        row[..., 0, 0], row[..., 0, 1], row[..., 0, 2] = c, -s * ca, s * sa
        row[..., 1, 0], row[..., 1, 1], row[..., 1, 2] = s, c * ca, -c * sa
        row[..., 2, 1], row[..., 2, 2] = sa, ca
        row[..., 0, 3], row[..., 1, 3], row[..., 2, 3] = (
            a / 1e3 * c,
            a / 1e3 * s,
            d / 1e3,
        )
        row[..., 3, 3] = 1.0
        out = out @ row
    return out


def tip(q: np.ndarray) -> np.ndarray:
    """tcp positions, (..., 3)."""
    return np.ascontiguousarray(fk(q)[..., :3, 3])


def sample(count: int, seed: int) -> np.ndarray:
    """Random configurations within the limits, (count, 4)."""
    return np.random.default_rng(seed).uniform(LOWER, UPPER, (count, 4))
