"""The axes of two arms as lines, and what brings them onto each other in the least-squares sense."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import cache

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.comparison.arm import FourJointArm, foot
from alpha5_model.parameters import parameters
from alpha5_model.spatial import rotation_about, transform, wrap

#: Positions at which the axes are compared: 40 lines for at most 16 unknowns.
POSITIONS = 10
#: The dimensions of our arm that another model may have otherwise: distances and twists of axes that
#: follow each other, the offset of the elbow along axis_d, and its tilt (parallel axes have no twist
#: about their second direction).
DIMENSIONS = ("a_0", "a_1", "a_2", "d_1", "alpha_0", "alpha_1", "alpha_2", "beta_1")
#: The unknowns of a fit that changes no dimension.
ZEROS = range(8)
#: A frame that lies closer to ours than this was meant to be the same one.
SAME_FRAME = 0.005  # [m]
SAME_TILT = 0.02  # [rad]


@dataclass(frozen=True, eq=False)
class Alignment:
    """How the other model's coordinates relate to ours: ``q_theirs = sign * q_ours + zero``.

    Attributes:
        base: transform_theirs_to_ours of the root frames, (4, 4).
        sign: +1 or -1 per joint, (4,).
        zero: Position of the other joint where ours is zero, (4,) [rad].
        dimensions: Theirs minus ours of each of `DIMENSIONS`, (8,) [m, rad]; zero where it was held.
        residual: What is left between their axes and ours, root mean square over positions and axes: of
            the coordinates of the lines (their moment [m] and direction), and of their angle [rad].
        base_link: The link of theirs whose frame comes closest to our base_link.
        stands: Pose of that frame in our base_link, (4, 4).
        exact: The same with all dimensions fitted, also those that the printed digits explain; None in
            itself.
    """

    base: FloatArray
    sign: FloatArray
    zero: FloatArray
    dimensions: FloatArray = field(default_factory=lambda: np.zeros(len(DIMENSIONS)))
    residual: tuple[float, float] = (0.0, 0.0)
    base_link: str = ""
    stands: FloatArray = field(default_factory=lambda: np.eye(4))
    exact: Alignment | None = None

    @property
    def same_base(self) -> bool:
        """Whether a link's frame was meant to be our base_link, up to its height and yaw."""
        lateral = float(np.hypot(*self.stands[:2, 3]))
        height, up = abs(self.stands[2, 3]), self.stands[2, 2]
        return max(lateral, height) < SAME_FRAME and math.acos(min(1.0, up)) < SAME_TILT

    @property
    def oddities(self) -> int:
        """Number of turned signs and shifted zeros."""
        return int((self.sign < 0).sum() + (np.abs(self.zero) > SAME_FRAME).sum())

    def changes(self) -> dict[str, float]:
        """The dimensions that differ, theirs minus ours [m, rad]."""
        found = zip(DIMENSIONS, self.dimensions.tolist(), strict=True)
        return {name: change for name, change in found if change}

    def theirs(self, q: FloatArray) -> FloatArray:
        """The other model's joint positions for ours."""
        return self.sign * q + self.zero


@cache
def _positions() -> FloatArray:
    joints = parameters().joints[:4]
    lower, upper = [j.lower for j in joints], [j.upper for j in joints]
    return np.random.default_rng(0).uniform(lower, upper, (POSITIONS, 4))


def our_frames(q: FloatArray, change: FloatArray) -> FloatArray:
    """DH frames {0} to {3} of our arm with changed dimensions, (N, 4, 4, 4), at q (N, 4).

    Their z axes are the joint axes; each stands turned by its joint already, ready for the next link.
    """
    pose, frames = np.broadcast_to(np.eye(4), (len(q), 4, 4)), []
    for j, row in enumerate(parameters().dh[:4]):
        turn = np.broadcast_to(np.eye(4), (len(q), 4, 4)).copy()
        c, s = np.cos(q[:, j] + row.theta_offset), np.sin(q[:, j] + row.theta_offset)
        turn[:, 0, 0], turn[:, 0, 1], turn[:, 1, 0], turn[:, 1, 1] = c, -s, s, c
        frames.append(pose @ turn)
        if j == 3:
            break
        lateral, tilt = (change[3], change[7]) if j == 1 else (0.0, 0.0)
        twist = rotation_about((1, 0, 0), row.alpha + change[4 + j])
        link = transform(
            twist @ rotation_about((0, 1, 0), tilt), (row.a + change[j], 0.0, row.d + lateral)
        )
        pose = frames[-1] @ link
    return np.stack(frames, axis=1)


def our_lines(q: FloatArray, change: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Points on and directions of our axes, (N, 4, 3), at q (N, 4), with changed dimensions (8,)."""
    frames = our_frames(q, change)
    return frames[..., :3, 3], frames[..., :3, 2]


def fit(theirs: FourJointArm, start: Alignment, free: Iterable[int]) -> Alignment:
    """Gauss-Newton over those of base (6), zeros of axis_d and axis_c (2), dimensions (8) that are free."""
    columns = list(free)
    best, (error, jacobian) = start, difference(theirs, start)
    for _ in range(50):
        change = np.zeros(16)
        change[columns] = -np.linalg.lstsq(jacobian[:, columns], error, rcond=None)[0]
        for _ in range(20):  # a step too long is cut until it helps
            moved = _moved(best, change)
            left, slope = difference(theirs, moved)
            if (gain := error @ error - left @ left) >= 0:
                break
            change = change / 4
        if gain > 0:
            best, error, jacobian = moved, left, slope
        if gain <= 1e-9 * (left @ left) or np.abs(change).max() < 1e-9:
            break
    angles = error.reshape(-1, 6)[:, 3:]
    return replace(
        best,
        zero=wrap(best.zero),
        residual=(
            math.sqrt(float(np.square(error).mean())),
            math.sqrt(float(np.square(angles).sum(axis=1).mean())),
        ),
    )


def _moved(alignment: Alignment, change: FloatArray) -> Alignment:
    """Base moved by a small rotation and shift (6,), zeros (2,) and dimensions (8,)."""
    size = float(np.linalg.norm(change[:3]))
    turn = rotation_about(change[:3] / size, size) if size else None
    base = transform(turn) @ alignment.base
    base[:3, 3] += change[3:6]
    zero = alignment.zero + np.array([0.0, change[6], change[7], 0.0])
    return replace(alignment, base=base, zero=zero, dimensions=alignment.dimensions + change[8:])


def difference(theirs: FourJointArm, alignment: Alignment) -> tuple[FloatArray, FloatArray]:
    """Their axes minus ours in Plücker coordinates, (24 N,), and the derivative, (24 N, 16).

    The coordinates are moments about our root [m] and directions. Each unknown, of base (6), zeros (2) and
    dimensions (8), is a screw (w, v) that moves the lines (m, d) behind it by w x d and w x m + v x d.
    """
    q, still = _positions(), np.zeros((POSITIONS, 3))
    frames = our_frames(q, alignment.dimensions)
    points, x, y, z = (frames[..., :3, k] for k in (3, 0, 1, 2))
    there, heading = their_lines(theirs, alignment, q)
    moments, ours, sign = _cross(there, heading), _cross(points, z), alignment.sign
    alpha = parameters().dh[1].alpha + alignment.dimensions[5]
    tilt = math.cos(alpha) * y[:, 1] + math.sin(alpha) * z[:, 1]
    theirs_move = [(still + axis, still, 0) for axis in np.eye(3)]
    theirs_move += [(still, still + axis, 0) for axis in np.eye(3)]
    theirs_move += [(sign[j] * heading[:, j], sign[j] * moments[:, j], j + 1) for j in (1, 2)]
    ours_move = [(still, x[:, j], j + 1) for j in range(3)]
    ours_move.append((still, z[:, 1], 2))
    ours_move += [(x[:, j], _cross(points[:, j + 1], x[:, j]), j + 1) for j in range(3)]
    ours_move.append((tilt, _cross(points[:, 2], tilt), 2))
    columns = []
    for screws, m, d, side in ((theirs_move, moments, heading, 1.0), (ours_move, ours, z, -1.0)):
        w, v = (np.array([screw[k] for screw in screws])[:, :, None] for k in (0, 1))
        moved = np.concatenate([_cross(w, m) + _cross(v, d), _cross(w, d)], axis=-1)
        moved *= np.array([np.arange(4) >= screw[2] for screw in screws])[:, None, :, None]
        columns.append(side * moved.reshape(8, -1))
    error = np.concatenate([moments - ours, heading - z], axis=-1).ravel()
    return error, np.concatenate(columns).T


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """NumPy's cross product, without what it takes to prepare."""
    one, two = [1, 2, 0], [2, 0, 1]
    out: FloatArray = a[..., one] * b[..., two] - a[..., two] * b[..., one]
    return out


def their_lines(
    theirs: FourJointArm, alignment: Alignment, q: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Their axes at our positions q (..., 4), in our root frame and turning our way."""
    points, directions = theirs.axis_lines(alignment.theirs(q))
    rotation, shift = alignment.base[:3, :3], alignment.base[:3, 3]
    return points @ rotation.T + shift, directions @ rotation.T * alignment.sign[:, None]


def closed_form(theirs: FourJointArm, sign: FloatArray) -> Alignment:
    """The alignment with these signs that is exact where the shapes agree.

    The first two axes, which cross at a right angle, place the base. Turning about axis_d brings
    axis_c to its side of the shoulder, turning about axis_c the wrist into its direction.
    """
    zero = np.zeros(4)
    points, directions = (x[0] for x in our_lines(zero[None], np.zeros(8)))
    out = Alignment(np.eye(4), sign, zero)
    there, heading = their_lines(theirs, out, zero)
    turn = _frame(directions) @ _frame(heading).T
    shift = foot(points, directions, 0, 1) - turn @ foot(there, heading, 0, 1)
    out = replace(out, base=transform(turn, shift))
    for joint in (1, 2):
        axis = directions[joint]
        there, heading = their_lines(theirs, out, zero)
        mine = (points[2] - points[1], directions[3])[joint - 1]
        other = (there[2] - there[1], heading[3])[joint - 1]
        sine, cosine = np.cross(other, mine) @ axis, other @ mine - (other @ axis) * (mine @ axis)
        shift = sign[joint] * math.atan2(sine, cosine) * np.eye(4)[joint]
        out = replace(out, zero=out.zero + shift)
    return out


def _frame(directions: FloatArray) -> FloatArray:
    """Rotation with z along the first axis and the second axis in the plane of y and z, (3, 3)."""
    z = directions[0]
    x = np.cross(directions[1], z)
    size = np.linalg.norm(x)
    x = x / size if size > 1e-9 else np.linalg.svd(z[None])[2][1]  # one direction: any x will do
    return np.stack([x, np.cross(z, x), z], axis=1)
