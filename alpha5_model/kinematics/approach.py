"""The directions from which the arm can approach a point.

They are what the arm has instead of a dexterous workspace. The arm moves in a vertical
plane through its yaw axis, and joint 3 turns about the approach direction through the
tcp, moving neither. So at a point the arm has at most four approach directions, one per
branch of its inverse kinematics, each with any roll that the wrist's range allows.

Its dexterous workspace is empty, whatever the joint limits. By rank: the Jacobian of
four joints has rank four at most, so the poses form a set of dimension four in SE(3),
and a dexterous workspace with an interior needs six. Nor is there a single dexterous
point p, for which the approach directions at p would have to fill a sphere. Off the yaw
axis the plane has two azimuths and the two links in it have two configurations, so
there are four directions at most. On the axis the azimuth is free and the links have as
many configurations as before, so the directions form four circles about the axis at
most. That does not fill a sphere.

References:
    [Lecture7.1] Describing Robot Arms, "Dexterous Workspace".
    [ReachAlpha] Manufacturer's document, Section 1, Figures 3 to 6.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model.kinematics.hand import Hand
from alpha5_model.kinematics.plane import check_tool_on_axis, on_axis
from alpha5_model.kinematics.solutions import SolutionArrays
from alpha5_model.kinematics.solver import solve


@dataclass(frozen=True, eq=False)
class ApproachDirections:
    """Approach directions at points, by branch of the inverse kinematics (`BRANCHES`).

    Attributes:
        directions: Unit vectors from the wrist to the tcp, in ``base_link``,
            (..., 4, 3); NaN if the branch does not reach the point.
        exists: The branch reaches the point, limits aside, (..., 4).
        within_limits: It does so within the joint limits, (..., 4).
        any_azimuth: The point lies on the yaw axis, (...). Each direction is then the
            middle of the circle of directions that theta_0 sweeps.
        roll: Least and greatest turn about the direction, the range of the wrist,
            (2,) [rad].
    """

    directions: FloatArray
    exists: BoolArray
    within_limits: BoolArray
    any_azimuth: BoolArray
    roll: tuple[float, float]


def approach_directions(hand: Hand, position: ArrayLike) -> ApproachDirections:
    """The directions from which a hand reaches points (..., 3).

    Raises:
        InputError: A tool beside the wrist axis: theta_3 then changes the direction,
            so that there are infinitely many.
    """
    check_tool_on_axis(hand.shape, "approach directions")
    chain = hand.chain
    shape = hand.shape
    solutions = solve(SolutionArrays, position, shape.middle[3], shape)
    exists = solutions.exists[..., None]
    _, axes = chain.joint_axes(np.where(exists, solutions.q, chain.home))
    # The jaws are along -z of link_4, which is joint 3's axis.
    outwards = -axes[..., 3, :]
    return ApproachDirections(
        directions=np.where(exists, outwards, np.nan),
        exists=solutions.exists,
        within_limits=solutions.within_limits,
        any_azimuth=on_axis(solutions.position),
        roll=(shape.lower[3], shape.upper[3]),
    )
