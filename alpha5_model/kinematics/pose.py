"""Inverse kinematics of a whole pose: position exact, orientation as close as four joints allow.

A branch fixes theta_0 to theta_2; what is left of the orientation is a turn about the wrist axis.
Split into a turn about that axis and a swing across it (swing-twist decomposition,
[Dobrowolski2015]), the turn is what theta_3 can do and the swing is what remains, the angle between
the wrist axis and where the target wants it.

Approach directions are what the arm has instead of a dexterous workspace. The arm moves in a vertical
plane through its yaw axis, and joint 3 turns about the approach
direction through the tcp, moving neither. So at a point the arm has at most four approach
directions, one per branch of its inverse kinematics, each with any roll that the wrist's range
allows.

Its dexterous workspace is empty, whatever the joint limits. By rank: the Jacobian of four joints
has rank four at most, so the poses form a set of dimension four in SE(3), and a dexterous workspace
with an interior needs six. Nor is there a single dexterous point p, for which the approach
directions at p would have to fill a sphere. Off the yaw axis the plane has two azimuths and the two
links in it have two configurations, so there are four directions at most. On the axis the azimuth
is free and the links have as many configurations as before, so the directions form four circles
about the axis at most. That does not fill a sphere.

References:
    [Lecture7.1] Describing Robot Arms, "Dexterous Workspace".
    [ReachAlpha] Manufacturer's document, Section 1, Figures 3 to 6.
    [Dobrowolski2015] Swing-twist decomposition in Clifford algebra, arXiv:1506.05481.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import BoolArray, FloatArray, float_array, is_rigid
from alpha5_model._support.spatial import cross_matrix, wrap
from alpha5_model.errors import InputError
from alpha5_model.kinematics.ik import inverse_kinematics, nearest, require_solution
from alpha5_model.kinematics.plane import arm_plane, on_axis
from alpha5_model.theory.dh.chain import DHChain

#: A rotation error below this counts as none [rad]; on the edge of reach, rounding of the position
#: turns the wrist axis by some 1e-8.
EXACT_TOLERANCE = 1e-7
#: Rotation errors that differ by less are equal: `PoseSolutions.best` goes by joint travel [rad].
TIE = 1e-7


class PoseSolutions(NamedTuple):
    """All solutions of a set of target poses. Arrays are read-only.

    Attributes:
        q: (..., 4, 4): branch axis (`BRANCHES`), joint axis [rad]; NaN where the branch does not
            reach the position. theta_3 minimises the rotation error within its limits.
        exists: The branch reaches the position, limits aside, (..., 4).
        within_limits: It respects all four joint limits, (..., 4).
        singular: As for `Solutions`, (...).
        position: The target positions, (..., 3) [m].
        rotation_error: Angle between the orientation reached and the target's, (..., 4) [rad].
        exact: The branch attains the pose: ``rotation_error`` below 1e-7 rad, (..., 4).
    """

    q: FloatArray
    exists: BoolArray
    within_limits: BoolArray
    singular: BoolArray
    position: FloatArray
    rotation_error: FloatArray
    exact: BoolArray

    def best(self, q_reference: ArrayLike) -> FloatArray:
        """The solution within the limits with the least rotation error.

        Of equally good ones, the nearest to ``q_reference`` in the Euclidean norm of the joint
        differences [rad].

        Args:
            q_reference: (4,) or (..., 4) [rad].

        Returns:
            (..., 4) [rad].

        Raises:
            UnreachableError: A position that no branch reaches within the limits.
        """
        require_solution(self.q, self.within_limits, self.position)
        error = np.where(self.within_limits, self.rotation_error, np.inf)
        least = error <= error.min(axis=-1, keepdims=True) + TIE
        return nearest(
            self.q, q_reference, least & self.within_limits, np.zeros((), np.bool_)
        )


def inverse_kinematics_pose(transform: Any) -> PoseSolutions:
    """Joint positions that reach a position exactly and an orientation as closely as possible.

    On the yaw axis theta_0 is free: it and theta_3 are chosen together, for the least rotation
    error within the limits of both.

    Args:
        transform: transform_tcp_to_base, (..., 4, 4), or a ``pinocchio.SE3``.

    Returns:
        Four branches per pose, each with its rotation error.

    Raises:
        InputError: Not real numbers of that shape, or not a rigid transform.
    """
    target = float_array(
        "transform", getattr(transform, "homogeneous", transform), (4, 4)
    )
    rigid = is_rigid(target)
    if not rigid.all():
        index = tuple(int(i) for i in np.argwhere(~rigid)[0])
        place = f"transform[{', '.join(map(str, index))}]" if index else "transform"
        expected = "a rigid transform (rotation, translation, 0 0 0 1)"
        raise InputError(place, target[index].tolist(), expected)
    position, rotation = np.ascontiguousarray(target[..., :3, 3]), target[..., :3, :3]
    g = arm_plane()
    solutions = inverse_kinematics(position, g.middle[3])
    q = np.where(solutions.exists[..., None], solutions.q, np.asarray(g.middle))
    q, error = _turn_wrist(q, rotation)
    free = on_axis(position)
    if free.any():
        for theta_0 in _yaw_candidates(q[free], rotation[free]):
            trial = q[free]
            trial[..., 0] = theta_0
            trial, missed = _turn_wrist(trial, rotation[free])
            better = missed < error[free]
            q[free] = np.where(better[..., None], trial, q[free])
            error[free] = np.where(better, missed, error[free])
    q[~solutions.exists] = error[~solutions.exists] = np.nan
    exact = error <= EXACT_TOLERANCE
    for array in (q, error, exact):
        array.flags.writeable = False
    return PoseSolutions(q, *solutions[1:], rotation_error=error, exact=exact)


@cache
def _hand() -> tuple[DHChain, FloatArray]:
    """The arm, and the axis of joint 3 in the axes of the tcp, (3,), the same for every q."""
    chain = DHChain.alpha5()
    _, axes = chain.joint_axes(chain.home)
    return chain, chain.forward_kinematics(chain.home)[:3, :3].T @ axes[3]


def _turn_wrist(q: FloatArray, rotation: FloatArray) -> tuple[FloatArray, FloatArray]:
    """q (..., 4, 4) with the best theta_3 for rotations (..., 3, 3), and the error (..., 4)."""
    (chain, axis), g, q = _hand(), arm_plane(), q.copy()
    q[..., 3] = 0.0
    # Rotation that is left over, in the axes of the tcp: a turn about the wrist axis, and a swing.
    rest = (
        np.swapaxes(chain.forward_kinematics(q)[..., :3, :3], -1, -2)
        @ rotation[..., None, :, :]
    )
    swung = rest @ axis
    along = swung @ axis
    swing = np.arctan2(np.linalg.norm(np.cross(axis, swung), axis=-1), along)
    sine = np.einsum("...ij,ij->...", rest, cross_matrix(axis))
    wanted = wrap(
        np.arctan2(sine, np.trace(rest, axis1=-2, axis2=-1) - along), g.middle[3]
    )
    q[..., 3] = np.clip(wanted, g.lower[3], g.upper[3])
    # cos(error / 2) = cos(swing / 2) cos(missed / 2), in the form that keeps small angles.
    s, m = np.sin(swing / 2) ** 2, np.sin((q[..., 3] - wanted) / 2) ** 2
    return q, 2 * np.arctan2(np.sqrt(s + m - s * m), np.sqrt((1 - s) * (1 - m)))


def _yaw_candidates(q: FloatArray, rotation: FloatArray) -> list[FloatArray]:
    """Candidates for a free theta_0, one of them the best, (N, 4) each, for q (N, 4, 4).

    cos(error / 2) is bilinear in the half angles of theta_0 and theta_3. Its one maximum has the
    wrist axis at the target's azimuth; where that is beyond a limit, one of the two joints is at a
    limit.
    """
    (chain, axis), g = _hand(), arm_plane()
    target, hand = (
        r @ axis for r in (rotation, chain.forward_kinematics(q)[..., :3, :3])
    )
    azimuth = np.arctan2(target[:, 1], target[:, 0])[:, None]
    turns = [azimuth - np.arctan2(hand[..., 1], hand[..., 0])]
    for end in (g.lower[3], g.upper[3]):
        at_end = q.copy()
        at_end[..., 3] = end
        # The turn about z that is nearest to the rotation left over.
        reached = chain.forward_kinematics(at_end)[..., :3, :3]
        left = rotation[:, None] @ np.swapaxes(reached, -1, -2)
        sine, cosine = (
            left[..., 1, 0] - left[..., 0, 1],
            left[..., 0, 0] + left[..., 1, 1],
        )
        turns.append(np.arctan2(sine, cosine))
    wanted = [wrap(q[..., 0] + turn, g.middle[0]) for turn in turns]
    ends = [np.full(q.shape[:-1], end) for end in (g.lower[0], g.upper[0])]
    return [*(np.clip(theta_0, g.lower[0], g.upper[0]) for theta_0 in wanted), *ends]


@dataclass(frozen=True, eq=False)
class ApproachDirections:
    """Approach directions at points, by branch of the inverse kinematics (`BRANCHES`).

    Attributes:
        directions: Unit vectors from the wrist to the tcp, in ``base_link``, (..., 4, 3); NaN where
            the branch does not reach the point.
        exists: The branch reaches the point, limits aside, (..., 4).
        within_limits: It does so within the joint limits, (..., 4).
        any_azimuth: The point lies on the yaw axis: each direction stands for the circle that
            theta_0 sweeps, and is its middle, (...).
        roll: Least and greatest turn about the direction, the range of the wrist, (2,) [rad].
    """

    directions: FloatArray
    exists: BoolArray
    within_limits: BoolArray
    any_azimuth: BoolArray
    roll: tuple[float, float]


def approach_directions(position: ArrayLike) -> ApproachDirections:
    """The directions from which the arm reaches points.

    Args:
        position: tcp in ``base_link``, (..., 3) [m].

    Raises:
        InputError: Not finite real numbers of shape (..., 3).
    """
    (chain, _), g = _hand(), arm_plane()
    q, exists, within_limits, _, target = inverse_kinematics(position, g.middle[3])
    _, axes = chain.joint_axes(np.where(exists[..., None], q, chain.home))
    # The hand leaves the elbow along -z of joint 3's axis: d_3 is negative in Table 1.
    outwards = np.sign(chain.links[3].d) * axes[..., 3, :]
    directions, roll = (
        np.where(exists[..., None], outwards, np.nan),
        (g.lower[3], g.upper[3]),
    )
    return ApproachDirections(directions, exists, within_limits, on_axis(target), roll)
