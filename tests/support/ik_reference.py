"""Inverse kinematics with its edges, in long doubles and by half angles.

The tests compare the kernels with it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from fk import FOLDED
from ik_targets import L_1, L_2
from reference import DH, LOWER, THETA_C, UPPER

MIDDLE = (LOWER + UPPER) / 2
PHI = THETA_C - math.pi / 2
#: Allowed rounding: beyond the edge of reach [m], off the yaw axis [m],
#: beyond a limit [rad].
EDGE, AXIS, LIMIT = 1e-10, 1e-9, 1e-12


def near(angle: np.ndarray, joint: int) -> np.ndarray:
    """The shift by full turns that is nearest to the middle of the joint's range."""
    return angle - 2 * np.pi * np.floor((angle - MIDDLE[joint]) / (2 * np.pi) + 0.5)


def on_limit(
    angle: np.ndarray, joint: int, slack: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The angle, and whether it is within its limits.

    An angle beyond a limit by no more than the slack is moved onto the limit.
    """
    clipped = np.clip(angle, LOWER[joint], UPPER[joint])
    fits = np.abs(angle - clipped) <= slack
    return np.where(fits, clipped, angle), fits


@dataclass(frozen=True)
class ElbowTriangle:
    """Shoulder, elbow and tip at distances ``rho`` of shoulder and tip [m]."""

    rho: np.ndarray

    @property
    def margin(self) -> np.ndarray:
        """How far inside the reach the tip is; negative outside [m]."""
        return np.minimum(L_1 + L_2 - self.rho, self.rho - (L_2 - L_1))

    @property
    def half_fold(self) -> np.ndarray:
        below = np.sqrt(np.maximum(self.rho**2 - (L_2 - L_1) ** 2, 0))
        above = np.sqrt(np.maximum((L_1 + L_2) ** 2 - self.rho**2, 0))
        return np.arctan2(below, above)

    @property
    def inner_angle(self) -> np.ndarray:
        """The angle at the shoulder."""
        fold = 2 * self.half_fold
        return np.arctan2(L_2 * np.sin(fold), L_1 - L_2 * np.cos(fold))

    @property
    def sine(self) -> np.ndarray:
        """Nearly the sine of the inner angle when stretched, at least 1e-7."""
        above = (L_1 + L_2) ** 2 - self.rho**2
        return np.maximum(np.sqrt(np.abs(above) / (L_1 * L_2)), 1e-7)


def shoulder_and_elbow(
    triangle: ElbowTriangle, bearing: np.ndarray, side: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """theta_1, theta_2, and whether both are within their limits."""
    raw = near(bearing - side * triangle.inner_angle - PHI, 1)
    theta_1, fits_1 = on_limit(raw, 1, LIMIT + 1e-14 / triangle.sine)

    # Moving theta_1 onto its limit moves the elbow; theta_2 keeps the tip in place.
    follow = (L_1 + L_2) / L_2 * (theta_1 - raw)
    raw_2 = near(side * 2 * triangle.half_fold + FOLDED, 2) + follow
    theta_2, fits_2 = on_limit(raw_2, 2, np.full(len(raw), LIMIT))
    return theta_1, theta_2, fits_1 & fits_2


def yaw(
    x: np.ndarray, y: np.ndarray, free: np.ndarray, faces: int
) -> tuple[np.ndarray, np.ndarray]:
    """theta_0, and whether it is within its limits; on the yaw axis it is free."""
    azimuth = np.arctan2(y, x) - math.pi + (0 if faces > 0 else math.pi)
    slack = LIMIT + 1e-15 / np.maximum(np.hypot(x, y), AXIS)
    theta_0, fits = on_limit(near(azimuth, 0), 0, slack)
    return np.where(free, MIDDLE[0], theta_0), fits | free


def solved(position: np.ndarray, wrist: np.ndarray) -> tuple[np.ndarray, ...]:
    """q (N, 4, 4), exists and within limits (N, 4), singular (N,).

    These are the fields of `alpha5_model.Solutions`.
    """
    x, y, z = position.astype(np.longdouble).T
    height = z - DH[0][0] / 1e3
    free = np.hypot(x, y) <= AXIS
    theta_3, fits_3 = on_limit(near(wrist, 3), 3, np.full(len(position), LIMIT))

    q = np.empty((len(position), 4, 4))
    exists, within = np.empty((2, len(position), 4), bool)
    singular = free.copy()
    for branch in range(4):
        faces = 1 if branch % 2 == 0 else -1
        side = 1 if branch < 2 else -1
        theta_0, fits_0 = yaw(x, y, free, faces)
        r = faces * np.where(free, 0.0, np.hypot(x, y)) - DH[0][2] / 1e3
        triangle = ElbowTriangle(np.hypot(r, height))
        theta_1, theta_2, fits_12 = shoulder_and_elbow(
            triangle, np.arctan2(height, r), side
        )

        exists[:, branch] = triangle.margin >= -EDGE
        singular |= exists[:, branch] & (triangle.margin <= 1e-9)
        q[:, branch] = np.stack([theta_0, theta_1, theta_2, theta_3], axis=-1)
        within[:, branch] = exists[:, branch] & fits_0 & fits_12 & fits_3

    q[~exists] = np.nan
    return q, exists, within, singular
