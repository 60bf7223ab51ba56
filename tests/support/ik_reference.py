"""Inverse kinematics with its edges, in long doubles and by half angles: what the kernels are held against."""

from __future__ import annotations

import math

import numpy as np
from fk import FOLDED
from ik_targets import L_1, L_2
from reference import DH, LOWER, THETA_C, UPPER

MIDDLE = (LOWER + UPPER) / 2
PHI = THETA_C - math.pi / 2
#: Rounding that is forgiven: beyond the edge of reach, off the yaw axis [m], beyond a limit [rad].
EDGE, AXIS, LIMIT = 1e-10, 1e-9, 1e-12


def near(angle: np.ndarray, joint: int) -> np.ndarray:
    """The shift by full turns that is nearest to the middle of the joint's range."""
    return angle - 2 * np.pi * np.floor((angle - MIDDLE[joint]) / (2 * np.pi) + 0.5)


def on_limit(
    angle: np.ndarray, joint: int, slack: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The angle, on its limit if it passes that by no more than the slack; whether it is within."""
    clipped = np.clip(angle, LOWER[joint], UPPER[joint])
    fits = np.abs(angle - clipped) <= slack
    return np.where(fits, clipped, angle), fits


def solved(position: np.ndarray, wrist: np.ndarray) -> tuple[np.ndarray, ...]:
    """q (N, 4, 4), exists and within limits (N, 4), singular (N,), as `alpha5_model.Solutions` has them."""
    x, y, z = position.astype(np.longdouble).T
    distance, h = np.hypot(x, y), z - DH[0][0] / 1e3
    free = distance <= AXIS
    q = np.empty((len(position), 4, 4))
    exists, within = np.empty((2, len(position), 4), bool)
    singular = free.copy()
    least = np.full(len(position), LIMIT)
    theta_3, fits_3 = on_limit(near(wrist, 3), 3, least)
    for branch in range(4):
        faces, side = (1 if branch % 2 == 0 else -1), (1 if branch < 2 else -1)
        r = faces * np.where(free, 0.0, distance) - DH[0][2] / 1e3
        rho = np.hypot(r, h)
        left = np.minimum(L_1 + L_2 - rho, rho - (L_2 - L_1))
        exists[:, branch] = left >= -EDGE
        singular |= exists[:, branch] & (left <= 1e-9)
        azimuth = np.arctan2(y, x) - math.pi + (0 if faces > 0 else math.pi)
        theta_0, fits_0 = on_limit(
            near(azimuth, 0), 0, LIMIT + 1e-15 / np.maximum(distance, AXIS)
        )
        theta_0 = np.where(free, MIDDLE[0], theta_0)
        above, below = (L_1 + L_2) ** 2 - rho**2, rho**2 - (L_2 - L_1) ** 2
        half = np.arctan2(*(np.sqrt(np.maximum(part, 0)) for part in (below, above)))
        inner = np.arctan2(L_2 * np.sin(2 * half), L_1 - L_2 * np.cos(2 * half))
        raw = near(np.arctan2(h, r) - side * inner - PHI, 1)
        sine = np.maximum(np.sqrt(np.abs(above) / (L_1 * L_2)), 1e-7)
        theta_1, fits_1 = on_limit(raw, 1, LIMIT + 1e-14 / sine)
        theta_2 = near(side * 2 * half + FOLDED, 2) + (L_1 + L_2) / L_2 * (
            theta_1 - raw
        )
        theta_2, fits_2 = on_limit(theta_2, 2, least)
        q[:, branch] = np.stack([theta_0, theta_1, theta_2, theta_3], axis=-1)
        within[:, branch] = (
            exists[:, branch] & (fits_0 | free) & fits_1 & fits_2 & fits_3
        )
    q[~exists] = np.nan
    return q, exists, within, singular
