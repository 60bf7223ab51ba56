"""Inverse kinematics of a whole pose: exact position, closest orientation.

A branch fixes theta_0 to theta_2. theta_3 then turns the hand about the wrist axis, as
close to the orientation as it can (`alpha5_model.kinematics.hand`). The angle that
remains is the rotation error.
"""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model.kinematics.approach import ApproachDirections
from alpha5_model.kinematics.catalogue_arm import catalogue, kinematics_of
from alpha5_model.kinematics.solutions import PoseSolutionArrays
from alpha5_model.numbers.parameters import Alpha5Parameters

__all__ = [
    "ApproachDirections",
    "ArmPoseSolutions",
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

    @property
    def collides(self) -> BoolArray:
        """It is within the limits, and the arm touches itself there, (..., 4).

        The jaws are closed, and bodies are as in `Arm.in_collision`.
        """
        return catalogue().collides(self)

    def best(self, q_reference: ArrayLike, allow_collision: bool = False) -> FloatArray:
        """The solution with the least rotation error, within limits and free.

        If several are equally good, the one nearest to ``q_reference`` in the Euclidean
        norm of the joint differences [rad].

        Args:
            q_reference: (4,) or (..., 4) [rad].
            allow_collision: Choose also among the solutions that collide.

        Returns:
            (..., 4) [rad].

        Raises:
            UnreachableError: A position that no branch reaches within the limits.
            SelfCollisionError: A kind of `UnreachableError`: all branches within the
                limits collide.
        """
        return catalogue().best_pose(self, q_reference, allow_collision)


class ArmPoseSolutions(PoseSolutions):
    """The same of an arm other than the catalogue's.

    Attributes:
        arm: Its record, to which `best` refers.
    """

    arm: Alpha5Parameters

    @property
    def collides(self) -> BoolArray:
        """It is within the limits, and the arm touches itself there, (..., 4)."""
        return kinematics_of(self.arm).collides(self)

    def best(self, q_reference: ArrayLike, allow_collision: bool = False) -> FloatArray:
        """The solution with the least rotation error, within limits and free.

        As `PoseSolutions.best`. With a tool beside the wrist axis, the error of a
        target that is out of reach does not know the nearest point.
        """
        return kinematics_of(self.arm).best_pose(self, q_reference, allow_collision)


def inverse_kinematics_pose(
    transform: Any, *, arm: Alpha5Parameters | None = None
) -> PoseSolutions:
    """Joint positions that reach a position exactly and an orientation closely.

    The orientation is as close as four joints allow. On the yaw axis theta_0 is free:
    it and theta_3 are chosen together, for the least rotation error within the limits
    of both.

    If the tool point of your own arm is beside the wrist axis, theta_3 moves it. Then
    the orientation is searched along theta_3
    (`alpha5_model.kinematics.pose_search`). A pose that can be attained is found. The
    rotation error of another pose is the least that the search finds: a branch that
    comes within the limits for a few hundredths of a radian only can be missed.

    Args:
        transform: transform_tcp_to_base, (..., 4, 4), or a ``pinocchio.SE3``.
        arm: Record of the arm; None is the catalogue's.

    Returns:
        Four branches per pose, each with its rotation error.

    Raises:
        InputError: Not real numbers of that shape, or not a rigid transform.
    """
    solutions = kinematics_of(arm).inverse_kinematics_pose(transform)
    if arm is None:
        return PoseSolutions._make(solutions)
    answer = ArmPoseSolutions._make(solutions)
    answer.arm = arm
    return answer


def approach_directions(
    position: ArrayLike, *, arm: Alpha5Parameters | None = None
) -> ApproachDirections:
    """The directions from which the arm reaches points.

    Args:
        position: tcp in ``base_link``, (..., 3) [m].
        arm: Record of the arm; None is the catalogue's.

    Raises:
        InputError: Not finite real numbers of shape (..., 3), or an arm whose tool
            point is beside the wrist axis: theta_3 changes the direction then.
    """
    return kinematics_of(arm).approach_directions(position)
