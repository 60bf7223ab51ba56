"""Lay another model's joint axes over ours: base pose, sign and zero of each joint.

The first two axes fix where the other base stands. Each further axis must then come to lie on
ours by turning about the axis before it; the angle it takes is the shift of that joint's zero. Two
shifts cannot be seen in the axes: that of axis_e is a yaw of the base, that of axis_b a roll of the
last body.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.comparison.mapping import FourJointArm

#: A root that stands closer to ours than this was meant to be the same one; the rest is an error of
#: the model's geometry, not another mount.
SAME_ROOT = 0.005  # [m], and [rad] for its rotation


@dataclass(frozen=True, eq=False)
class Alignment:
    """How the other model's coordinates relate to ours: ``q_theirs = sign * q_ours + zero``.

    Attributes:
        base: transform_theirs_to_ours of the root frames, (4, 4).
        sign: +1 or -1 per joint, (4,).
        zero: Position of the other joint where ours is zero, (4,) [rad]; those of axis_e and
            axis_b are taken as 0.
    """

    base: FloatArray
    sign: FloatArray
    zero: FloatArray

    @property
    def oddities(self) -> int:
        """Number of turned signs and shifted zeros."""
        return int((self.sign < 0).sum() + (np.abs(self.zero) > SAME_ROOT).sum())

    def theirs(self, q: FloatArray) -> FloatArray:
        """The other model's joint positions for ours."""
        return self.sign * q + self.zero


def align(ours: FourJointArm, theirs: FourJointArm) -> Alignment:
    """Best alignment of two models of the same arm.

    There are two ways to lay the first two axes over ours, head up or head down. The one that leaves
    fewer turned signs and shifted zeros is taken, then the one with the smaller rotation of the base.
    """
    reference = axis_lines(ours, np.zeros(4))
    candidates = [_align(theirs, reference, head) for head in (1.0, -1.0)]
    best = min(candidates, key=lambda c: (c.oddities, -np.trace(c.base[:3, :3])))
    if np.abs(best.base - np.eye(4)).max() < SAME_ROOT:
        return Alignment(np.eye(4), best.sign, best.zero)
    return best


def axis_lines(arm: FourJointArm, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A point on each joint's axis and its direction in the root frame, (4, 3) each."""
    poses = arm.poses(q)[1:]
    return poses[:, :3, 3], np.einsum("nij,nj->ni", poses[:, :3, :3], arm.axes)


def _align(
    theirs: FourJointArm,
    reference: tuple[FloatArray, FloatArray],
    head: float,
) -> Alignment:
    points, directions = reference
    sign, zero = np.ones(4), np.zeros(4)
    there, heading = axis_lines(theirs, zero)
    sign[0] = head
    base = _frame(points, directions, 1.0) @ np.linalg.inv(_frame(there, heading, head))
    for joint in (1, 2, 3):
        there, heading = axis_lines(theirs, zero)
        there = there @ base[:3, :3].T + base[:3, 3]
        heading = heading @ base[:3, :3].T
        sign[joint] = 1.0 if heading[joint] @ directions[joint] >= 0 else -1.0
        if joint == 3:
            break
        # Turn about this axis until the next one lies where ours does.
        axis = directions[joint]
        mine = _offset(points, directions, joint)
        other = _offset(there, heading, joint)
        angle = math.atan2(np.cross(other, mine) @ axis, other @ mine)
        zero[joint] = sign[joint] * angle
    return Alignment(base, sign, zero)


def _offset(points: FloatArray, directions: FloatArray, joint: int) -> FloatArray:
    """From axis `joint` to the next one along their common normal; the direction if they meet."""
    u, w = directions[joint], directions[joint + 1]
    between = points[joint + 1] - points[joint]
    normal = np.cross(u, w)
    if np.linalg.norm(normal) > 1e-6:
        normal = normal / np.linalg.norm(normal)
        offset = (between @ normal) * normal
    else:
        offset = between - (between @ u) * u
    if np.linalg.norm(offset) < 1e-4:  # [m]: the axes meet, within a tenth of a millimetre
        offset = w - (w @ u) * u
    out: FloatArray = offset
    return out


def _frame(points: FloatArray, directions: FloatArray, head: float) -> FloatArray:
    """Frame on the first two axes: z along the first, x along the common normal to the second."""
    z = head * directions[0]
    x = _offset(points, directions, 0)
    if np.linalg.norm(np.cross(x, z)) < 1e-9:  # both axes are one line: any normal will do
        x = np.eye(3)[np.abs(z).argmin()]
    x = x - (x @ z) * z
    x = x / np.linalg.norm(x)
    out = np.eye(4)
    out[:3, :3] = np.stack([x, np.cross(z, x), z], axis=1)
    out[:3, 3] = _foot(points[0], directions[0], points[1], directions[1])
    return out


def _foot(point: FloatArray, u: FloatArray, other: FloatArray, w: FloatArray) -> FloatArray:
    """Foot on the axis (point, u) of its common normal with the axis (other, w), (3,)."""
    r, b = point - other, u @ w
    out: FloatArray = point
    if 1 - b * b > 1e-12:  # parallel axes have a common normal everywhere
        out = point + (b * (w @ r) - u @ r) / (1 - b * b) * u
    return out


def bodies_in_our_frames(
    ours: FourJointArm, theirs: FourJointArm, alignment: Alignment
) -> tuple[FloatArray, FloatArray]:
    """COM (5, 3) [m] and tensor at the COM (5, 3, 3) of the other bodies in our link frames."""
    transforms = body_transforms(ours, theirs, alignment)
    rotation, shift = transforms[:, :3, :3], transforms[:, :3, 3]
    com = np.einsum("nij,nj->ni", rotation, theirs.com) + shift
    return com, rotation @ theirs.inertia @ np.swapaxes(rotation, 1, 2)


def body_transforms(ours: FourJointArm, theirs: FourJointArm, alignment: Alignment) -> FloatArray:
    """transform_theirs_to_ours of the five body frames, (5, 4, 4).

    Each body is held by its own joint: where the other arm's joint lies elsewhere than ours, that is
    an error of the geometry and not one of the COM as well.
    """
    here = ours.poses(np.zeros(4))
    there = alignment.base @ theirs.poses(alignment.zero)
    transforms = np.linalg.inv(here) @ there
    mine, other = (
        _seats(ours, np.zeros(4), np.eye(4)),
        _seats(theirs, alignment.zero, alignment.base),
    )
    transforms[1:, :3, 3] += np.einsum("nji,nj->ni", here[1:, :3, :3], mine - other)
    return transforms


def _seats(arm: FourJointArm, q: FloatArray, base: FloatArray) -> FloatArray:
    """One point on each joint's axis that both arms can find, in our root frame, (4, 3).

    The foot of the common normal with a neighbouring axis that is not parallel; for the first
    joint, whose height its neighbour does not tell, the point level with the root.
    """
    points, directions = axis_lines(arm, q)
    points = points @ base[:3, :3].T + base[:3, 3]
    directions = directions @ base[:3, :3].T
    feet = [
        _foot(points[j], directions[j], points[k], directions[k])
        for j, k in ((1, 0), (2, 3), (3, 2))
    ]
    level = points[0] - (points[0] @ directions[0]) * directions[0]
    return np.array([level, *feet])


def tip_distance(
    ours: FourJointArm, theirs: FourJointArm, alignment: Alignment, reach: float, q: FloatArray
) -> float:
    """Distance of the two arms' tips at our joint position q (4,) [m].

    The tip is ``reach`` along the wrist axis from the foot of its common normal with axis_c, on the
    side of ours: a point that needs no named frame of the other model.
    """
    tips = []
    for arm, angles, base, sign in (
        (ours, q, np.eye(4), 1.0),
        (theirs, alignment.theirs(q), alignment.base, alignment.sign[3]),
    ):
        points, directions = axis_lines(arm, angles)
        wrist = _foot(points[3], directions[3], points[2], directions[2])
        tip = wrist - sign * reach * directions[3]
        tips.append(base[:3, :3] @ tip + base[:3, 3])
    return float(np.linalg.norm(tips[0] - tips[1]))
