"""How the unknowns of a fit move the joint axes, as screws: rotation and velocity."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.proofs.comparison.axis_lines import X, Y, Z, cross
from alpha5_model.proofs.comparison.own_arm import DIMENSIONS, OwnArm

#: Joint positions at which the axes are compared: 40 lines for at most 16 unknowns.
POSITIONS = 10
#: The unknowns that move the other arm's axes: pose of its base, and two zeros.
POSE_UNKNOWNS = (
    "base about x",
    "base about y",
    "base about z",
    "base along x",
    "base along y",
    "base along z",
    "zero of axis_d",
    "zero of axis_c",
)
#: All unknowns; the dimensions move our axes.
UNKNOWNS = (*POSE_UNKNOWNS, *DIMENSIONS)

#: The vector 0 for each of the `POSITIONS`.
ZEROS = np.zeros((POSITIONS, 3))


class Screw(NamedTuple):
    """How an unknown moves the axes behind it, at each position.

    Attributes:
        angular: Rotation per unit of the unknown, (POSITIONS, 3).
        linear: Velocity of the point at our root, (POSITIONS, 3).
        first_axis: Index of the first axis that moves; all behind it move as well.
    """

    angular: FloatArray = ZEROS
    linear: FloatArray = ZEROS
    first_axis: int = 0


def _everywhere(vector: FloatArray) -> FloatArray:
    """The same vector at each of the `POSITIONS`, (POSITIONS, 3)."""
    return np.tile(vector, (POSITIONS, 1))


BASE_SCREWS = {
    "base about x": Screw(angular=_everywhere(X)),
    "base about y": Screw(angular=_everywhere(Y)),
    "base about z": Screw(angular=_everywhere(Z)),
    "base along x": Screw(linear=_everywhere(X)),
    "base along y": Screw(linear=_everywhere(Y)),
    "base along z": Screw(linear=_everywhere(Z)),
}


def zero_screws(
    sign: FloatArray, directions: FloatArray, moments: FloatArray
) -> dict[str, Screw]:
    """How the zeros of axis_d and axis_c move the other arm's axes.

    Args:
        sign: +1 or -1 per joint, (4,).
        directions: Of its axes, (4, POSITIONS, 3).
        moments: Of its axes, (4, POSITIONS, 3) [m].
    """
    return {
        "zero of axis_d": Screw(
            angular=sign[1] * directions[1],
            linear=sign[1] * moments[1],
            first_axis=2,
        ),
        "zero of axis_c": Screw(
            angular=sign[2] * directions[2],
            linear=sign[2] * moments[2],
            first_axis=3,
        ),
    }


def dimension_screws(
    ours: OwnArm, frames: FloatArray, change: FloatArray
) -> dict[str, Screw]:
    """How the dimensions of our arm move its axes.

    Args:
        ours: Our arm.
        frames: Its DH frames, (4, POSITIONS, 4, 4).
        change: The change of its dimensions with which they were computed, (8,).
    """
    x, y, z, points = (frames[..., :3, k] for k in range(4))
    # The elbow's tilt turns about y of link 1's end, after the twist alpha_1.
    alpha = ours.parameters.dh[1].alpha + change[DIMENSIONS.index("alpha_1")]
    tilt = math.cos(alpha) * y[1] + math.sin(alpha) * z[1]
    return {
        "a_0": Screw(linear=x[0], first_axis=1),
        "a_1": Screw(linear=x[1], first_axis=2),
        "a_2": Screw(linear=x[2], first_axis=3),
        "d_1": Screw(linear=z[1], first_axis=2),
        "alpha_0": Screw(angular=x[0], linear=cross(points[1], x[0]), first_axis=1),
        "alpha_1": Screw(angular=x[1], linear=cross(points[2], x[1]), first_axis=2),
        "alpha_2": Screw(angular=x[2], linear=cross(points[3], x[2]), first_axis=3),
        "beta_1": Screw(angular=tilt, linear=cross(points[2], tilt), first_axis=2),
    }


def line_derivatives(
    screws: Sequence[Screw], moments: FloatArray, directions: FloatArray
) -> FloatArray:
    """Derivatives of lines by the unknowns that move them, (16, 24 * POSITIONS).

    Args:
        screws: One per unknown.
        moments: For each unknown, of the lines that it moves,
            (16, 4, POSITIONS, 3) [m].
        directions: Of the same lines, (16, 4, POSITIONS, 3).
    """
    angular = np.stack([screw.angular for screw in screws])[:, None]
    linear = np.stack([screw.linear for screw in screws])[:, None]
    first_axes = np.array([screw.first_axis for screw in screws])
    moment_rates = cross(angular, moments) + cross(linear, directions)
    direction_rates = cross(angular, directions)
    rates = np.concatenate([moment_rates, direction_rates], axis=-1)

    moves = np.arange(4) >= first_axes[:, None]
    rates *= moves[..., None, None]
    return rates.reshape(len(screws), -1)
