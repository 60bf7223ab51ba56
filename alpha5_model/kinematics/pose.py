"""Inverse kinematics of a whole pose: exact position, closest orientation.

A branch fixes theta_0 to theta_2. theta_3 then turns the hand about the wrist axis, as
close to the orientation as it can (`alpha5_model.kinematics.hand`). The angle that
remains is the rotation error.
"""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray
from alpha5_model.kinematics.approach import ApproachDirections
from alpha5_model.kinematics.catalogue_arm import catalogue
from alpha5_model.kinematics.solutions import PoseSolutionArrays

__all__ = [
    "ApproachDirections",
    "PoseSolutions",
    "approach_directions",
    "inverse_kinematics_pose",
]


class PoseSolutions(PoseSolutionArrays):
    """All solutions of a set of target poses. Arrays are read-only.

    Attributes:
        q: (..., 4, 4): branch axis (`BRANCHES`), joint axis [rad]; NaN if the branch
            does not reach the position. theta_3 minimises the rotation error within its
            limits.
        exists: The branch reaches the position, limits aside, (..., 4).
        within_limits: It respects all four joint limits, (..., 4).
        singular: As for `Solutions`, (...).
        position: The target positions, (..., 3) [m].
        rotation_error: Angle between the orientation reached and the target's,
            (..., 4) [rad].
        exact: The branch attains the pose: ``rotation_error`` below 1e-7 rad, (..., 4).
    """

    __slots__ = ()

    def best(self, q_reference: ArrayLike) -> FloatArray:
        """The solution within the limits with the least rotation error.

        If several are equally good, the one nearest to ``q_reference`` in the Euclidean
        norm of the joint differences [rad].

        Args:
            q_reference: (4,) or (..., 4) [rad].

        Returns:
            (..., 4) [rad].

        Raises:
            UnreachableError: A position that no branch reaches within the limits.
        """
        return catalogue().best_pose(self, q_reference)


def inverse_kinematics_pose(transform: Any) -> PoseSolutions:
    """Joint positions that reach a position exactly and an orientation closely.

    The orientation is as close as four joints allow. On the yaw axis theta_0 is free:
    it and theta_3 are chosen together, for the least rotation error within the limits
    of both.

    Args:
        transform: transform_tcp_to_base, (..., 4, 4), or a ``pinocchio.SE3``.

    Returns:
        Four branches per pose, each with its rotation error.

    Raises:
        InputError: Not real numbers of that shape, or not a rigid transform.
    """
    return PoseSolutions._make(catalogue().inverse_kinematics_pose(transform))


def approach_directions(position: ArrayLike) -> ApproachDirections:
    """The directions from which the arm reaches points.

    Args:
        position: tcp in ``base_link``, (..., 3) [m].

    Raises:
        InputError: Not finite real numbers of shape (..., 3).
    """
    return catalogue().approach_directions(position)
