"""Inverse kinematics of a whole pose: exact position, closest orientation.

A branch fixes theta_0 to theta_2. theta_3 then turns the hand about the wrist axis, as
close to the orientation as it can (`alpha5_model.kinematics.hand`). The angle that
remains is the rotation error.

The arm has no dexterous workspace, but approach directions. It moves in a vertical
plane through its yaw axis, and joint 3 turns about the approach direction through the
tcp, moving neither. So at a point the arm has at most four approach directions, one per
branch of its inverse kinematics, each with any roll that the wrist's range allows.

The dexterous workspace is empty, whatever the joint limits. By rank: the Jacobian of
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
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import BoolArray, FloatArray, float_array, is_rigid
from alpha5_model.errors import InputError
from alpha5_model.kinematics.geometry import Geometry, on_axis
from alpha5_model.kinematics.hand import Hand
from alpha5_model.kinematics.ik import answer_of
from alpha5_model.kinematics.pose_search import search_poses
from alpha5_model.kinematics.solver import Branches, solve
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm

#: A rotation error below this counts as none [rad]; on the edge of reach, rounding of
#: the position turns the wrist axis by some 1e-8.
EXACT_TOLERANCE = 1e-7


class PoseSolutions(NamedTuple):
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

    q: FloatArray
    exists: BoolArray
    within_limits: BoolArray
    singular: BoolArray
    position: FloatArray
    rotation_error: FloatArray
    exact: BoolArray

    @property
    def arm(self) -> Alpha5Parameters:
        """Record of the arm that was solved."""
        return chosen_arm(None)

    @property
    def collides(self) -> BoolArray:
        """It is within the limits, and the arm touches itself there, (..., 4).

        The jaws are closed, and bodies are as in `Arm.in_collision`.
        """
        from alpha5_model.kinematics import choosing

        return choosing.collides(self._branches, self.arm)

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
            UnreachableError: A position that no branch reaches within the limits. With
                a tool beside the wrist axis, the nearest point that is reached is NaN.
            SelfCollisionError: A kind of `UnreachableError`: all branches within the
                limits collide.
        """
        from alpha5_model.kinematics import choosing

        return choosing.best_pose(
            self._branches, self.rotation_error, self.arm, q_reference, allow_collision
        )

    @property
    def _branches(self) -> Branches:
        """Without the orientations."""
        return Branches._make(self[:5])


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
    record = chosen_arm(arm)
    hand = Hand.of(record)
    target = _rigid(transform)
    position = np.ascontiguousarray(target[..., :3, 3])
    rotation = target[..., :3, :3]
    if hand.geometry.tool_on_axis:
        solved, error = _solved(hand, position, rotation)
    else:
        solved, error = search_poses(hand, position, rotation)

    solved.q[~solved.exists] = np.nan
    error[~solved.exists] = np.nan
    answer = (*solved, error, error <= EXACT_TOLERANCE)
    for array in answer:
        array.flags.writeable = False
    return answer_of(PoseSolutions, record, answer)


def _rigid(transform: Any) -> FloatArray:
    """Rigid transforms (..., 4, 4), or of a ``pinocchio.SE3``."""
    matrix = getattr(transform, "homogeneous", transform)
    target = float_array("transform", matrix, (4, 4))
    rigid = is_rigid(target)
    if not rigid.all():
        index = tuple(int(i) for i in np.argwhere(~rigid)[0])
        place = f"transform[{', '.join(map(str, index))}]" if index else "transform"
        expected = "a rigid transform (rotation, translation, 0 0 0 1)"
        raise InputError(place, target[index].tolist(), expected)
    return target


def _solved(
    hand: Hand, position: FloatArray, rotation: FloatArray
) -> tuple[Branches, FloatArray]:
    """Branches of poses and their rotation errors, with a tool on the wrist axis.

    Args:
        hand: Of the arm.
        position, rotation: Of the poses, (..., 3) [m] and (..., 3, 3).
    """
    middle = np.array(hand.geometry.middle)
    solved = solve(hand.geometry, position, middle[3])
    q = np.where(solved.exists[..., None], solved.q, middle)
    q, error = hand.turn_wrist(q, rotation)

    free = on_axis(position)
    if free.any():
        best, least, target = q[free], error[free], rotation[free]
        for theta_0 in hand.yaws(best, target):
            trial = best.copy()
            trial[..., 0] = theta_0
            trial, missed = hand.turn_wrist(trial, target)
            better = missed < least
            best = np.where(better[..., None], trial, best)
            least = np.where(better, missed, least)
        q[free], error[free] = best, least
    return solved._replace(q=q), error


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
    """

    directions: FloatArray
    exists: BoolArray
    within_limits: BoolArray
    any_azimuth: BoolArray


def approach_directions(
    position: ArrayLike, *, arm: Alpha5Parameters | None = None
) -> ApproachDirections:
    """The directions from which the arm reaches points.

    Args:
        position: tcp in ``base_link``, (..., 3) [m].
        arm: Record of the arm; None is the catalogue's.

    Raises:
        InputError: Not finite real numbers of shape (..., 3), or an arm whose tool
            point is beside the wrist axis: theta_3 changes the direction then, so that
            there are infinitely many.
    """
    record = chosen_arm(arm)
    geometry = Geometry.of(record)
    geometry.require_tool_on_axis("approach directions")
    target = float_array("position", position, (3,))

    chain = Hand.of(record).chain
    solved = solve(geometry, target, geometry.middle[3])
    exists = solved.exists[..., None]
    _, axes = chain.joint_axes(np.where(exists, solved.q, chain.home))
    # The jaws are along -z of link_4, which is joint 3's axis.
    outwards = -axes[..., 3, :]
    return ApproachDirections(
        directions=np.where(exists, outwards, np.nan),
        exists=solved.exists,
        within_limits=solved.within_limits,
        any_azimuth=on_axis(target),
    )
