"""Fit another model's joint axes to ours, as lines, by least squares.

What is free: where the other base stands, the sign of each joint, the zeros of axis_d and axis_c,
and those dimensions of the arm that differ. The axes do not show two of the zeros: a shifted zero
of axis_e is a yaw of the base, one of axis_b a roll of the last body. Frames and bodies decide
these.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.comparison import arm
from alpha5_model.comparison.arm import FourJointArm, Pair, Z, our_arm, our_frames, zero_poses
from alpha5_model.comparison.reading import foot
from alpha5_model.parameters import parameters
from alpha5_model.spatial import moved, rotation_about, transform, wrap

#: The dimensions of our arm that another model may have otherwise: distances and twists of axes
#: that follow each other, the offset of the elbow along axis_d, and its tilt (parallel axes have no
#: twist about their second direction).
DIMENSIONS = ("a_0", "a_1", "a_2", "d_1", "alpha_0", "alpha_1", "alpha_2", "beta_1")
#: A frame that lies closer to ours than this was meant to be the same one.
SAME_FRAME, SAME_TILT = 0.005, 0.02  # [m], [rad]
#: Residual of the closed form beyond which an axis points the other way [m and rad].
REVERSED = 0.05
#: Smaller differences are no findings: of the axes, and of their angles, at arm's length 0.03 mm.
LENGTH_TOLERANCE, ANGLE_TOLERANCE = 1e-5, 1e-4  # [m], [rad]
#: Positions at which the axes are compared: 40 lines for at most 16 unknowns.
POSITIONS = 10
#: The first axis that each unknown moves.
MOVES_FROM = (0,) * 6 + (2, 3) + (1, 2, 3, 2) * 2


@dataclass(frozen=True, eq=False)
class Alignment:
    """How the other model's coordinates relate to ours: ``q_theirs = sign * q_ours + zero``.

    Attributes:
        base: transform_theirs_to_ours of the root frames, (4, 4).
        sign: +1 or -1 per joint, (4,).
        zero: Position of the other joint where ours is zero, (4,) [rad].
        dimensions: Theirs minus ours of each of `DIMENSIONS`, (8,) [m, rad]; zero where it was
            held.
        residual: What is left between their axes and ours, root mean square over positions and
            axes: of the coordinates of the lines (their moment [m] and direction), and of their
            angle [rad].
        base_link: The link of theirs whose frame comes closest to our base_link.
        stands: Pose of that frame in our base_link, (4, 4).
        exact: The same with all dimensions fitted, also those that the printed digits explain; None
            in itself.
    """

    base: FloatArray = field(default_factory=lambda: np.eye(4))
    sign: FloatArray = field(default_factory=lambda: np.ones(4))
    zero: FloatArray = field(default_factory=lambda: np.zeros(4))
    dimensions: FloatArray = field(default_factory=lambda: np.zeros(len(DIMENSIONS)))
    residual: tuple[float, float] = (math.nan, math.nan)
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


def align(theirs: FourJointArm) -> Alignment:
    """Best alignment of another model of this arm.

    Base, signs and the zeros of axis_d and axis_c bring their axes onto ours as well as they can.
    The dimensions that are then still off by more than the printed digits allow are fitted too: an
    offset must not look like a shifted zero. An arm upside down with every joint reversed has the
    same axes; of alignments that fit equally well, the one with the fewest oddities is taken.
    """
    signs = map(np.array, itertools.product((1.0, -1.0), repeat=4))
    starts = [closed_form(theirs, sign) for sign in signs]
    errors = [np.sqrt(np.square(difference(theirs, start)[0]).mean()) for start in starts]
    # Where a direction is reversed no dimension helps.
    close = [s for s, e in zip(starts, errors, strict=True) if e <= max(REVERSED, 2 * min(errors))]
    # With all dimensions free the axes coincide: each dimension shows its own error only.
    within = np.repeat(allowed(theirs), 4)
    fits = [_with_base_link(theirs, fit(theirs, start, range(16))) for start in close]
    exact = min(fits, key=lambda one: _oddities(theirs, one, within))
    wrong = np.abs(exact.dimensions) > within
    best = replace(exact, dimensions=np.where(wrong, exact.dimensions, 0.0))
    best = _with_base_link(theirs, fit(theirs, best, [*range(8), *(8 + np.flatnonzero(wrong))]))
    return replace(_settle_zeros(theirs, best), exact=_settle_zeros(theirs, exact))


def allowed(theirs: FourJointArm, short_pi: bool = False) -> tuple[float, float]:
    """Differences that printed digits and tolerances allow, no findings: lengths [m], angles [rad].

    Rounded lengths turn the axes by as much over the length of the upper arm. Where a file cuts pi
    short, the same error may hide in angles that were computed from it (``short_pi``).
    """
    lengths, angles, pi = theirs.digits
    upper, pi = parameters().dh[1].a, 2 * pi * short_pi
    turns = math.hypot(angles, lengths / upper, pi)
    return max(LENGTH_TOLERANCE, lengths, upper * pi), max(ANGLE_TOLERANCE, turns)


def without_zero(theirs: FourJointArm, alignment: Alignment, joint: int) -> float:
    """Residual [m] of the best fit with the zero of one joint held at ours."""
    held = replace(alignment, zero=np.where(np.arange(4) == joint, 0.0, alignment.zero))
    free = [i for i in range(16) if i != 5 + joint and (i < 8 or alignment.dimensions[i - 8])]
    return fit(theirs, held, free).residual[0]


def _with_base_link(theirs: FourJointArm, alignment: Alignment) -> Alignment:
    """The link between root and axis_e whose frame comes closest to our base_link."""
    poses = {name: alignment.base @ theirs.link_poses[name] for name in theirs.base_path}
    name = min(poses, key=lambda n: round(_distance(poses[n]) - 1e-3 * poses[n][0, 0], 6))
    return replace(alignment, base_link=name, stands=poses[name])


def _distance(pose: FloatArray) -> float:
    """Of a frame from ours, whatever its yaw [m]; 0.1 m are taken for a radian of tilt."""
    return float(np.linalg.norm(pose[:3, 3]) + 0.1 * math.acos(np.clip(pose[2, 2], -1, 1)))


def _oddities(theirs: FourJointArm, alignment: Alignment, within: FloatArray) -> float:
    """How unlikely an alignment is: everything that somebody must have changed in the model.

    A turned sign, a shifted zero count one, a wrong dimension four, a base that stands elsewhere or
    upside down up to six, bodies elsewhere up to four.
    """
    base = min(6.0, 30 * _distance(alignment.stands))
    com = bodies_in_our_frames(theirs, alignment)[0][2:] - our_arm().com[2:]
    bodies = 4 * np.minimum(1.0, np.linalg.norm(com, axis=1) / 0.05).mean()
    changed = 4 * (np.abs(alignment.dimensions) > within).sum()
    return float(alignment.oddities + base + changed + bodies)


def _settle_zeros(theirs: FourJointArm, alignment: Alignment) -> Alignment:
    """Zeros of axis_e and axis_b: where the frames stand turned, and the bodies fit with them."""
    sign, zero = alignment.sign, alignment.zero
    if alignment.same_base and theirs.mass[0]:
        yaw = _yaw(alignment)
        back = transform(rotation_about(Z, -yaw))
        base, stands = back @ alignment.base, back @ alignment.stands
        turned = replace(alignment, base=base, stands=stands, zero=zero + sign * [yaw, 0, 0, 0])
        alignment = min(turned, alignment, key=lambda a: _body_errors(theirs, a)[0])
    seen = body_transforms(theirs, alignment)[4]
    roll = math.atan2(seen[1, 0], seen[0, 0])
    turned = replace(alignment, zero=alignment.zero - sign * [0, 0, 0, roll])
    if 4 * _body_errors(theirs, turned)[4] < _body_errors(theirs, alignment)[4]:
        alignment = turned
    return replace(alignment, zero=wrap(alignment.zero))


def _yaw(alignment: Alignment) -> float:
    """By how much their base_link is turned about our axis_e [rad]."""
    return math.atan2(alignment.stands[1, 0], alignment.stands[0, 0])


def _body_errors(theirs: FourJointArm, alignment: Alignment) -> FloatArray:
    """How far each body is from ours in second moments, (5,) [kg m^2]."""
    (com, inertia), ours = bodies_in_our_frames(theirs, alignment), our_arm()
    away = ours.mass * np.square(com - ours.com).sum(axis=1)
    return np.asarray(away + np.abs(inertia - ours.inertia).max(axis=(1, 2)))


def bodies_in_our_frames(theirs: FourJointArm, alignment: Alignment) -> Pair:
    """COM (5, 3) [m] and tensor at the COM (5, 3, 3) of the other bodies in our link frames."""
    return arm.carried(theirs, body_transforms(theirs, alignment))[1:]


def body_transforms(theirs: FourJointArm, alignment: Alignment) -> FloatArray:
    """transform_theirs_to_ours of the five body frames, (5, 4, 4).

    Each body is held by its own joint: where the other arm's joint lies elsewhere than ours, that
    is an error of the geometry and not one of the COM as well. The first body is held by the frame
    that was meant to be base_link, if there is one; body 1 by the base or by the shoulder, whose
    height above it may differ: by the one that fits.
    """
    there = alignment.base @ theirs.poses(alignment.zero)
    transforms: FloatArray = np.linalg.inv(zero_poses(alignment.dimensions)) @ there
    if alignment.same_base:
        base = theirs.link_poses[alignment.base_link]
        transforms[0] = transform(rotation_about(Z, _yaw(alignment))) @ np.linalg.inv(base)
        held = np.stack([transforms[1]] * 2)
        held[0, 2, 3] -= alignment.stands[2, 3]
        off = np.linalg.norm(moved(held, theirs.com[1]) - our_arm().com[1], axis=1)
        transforms[1] = held[off.argmin()]
    return transforms


def their_tips(theirs: FourJointArm, alignment: Alignment, q: FloatArray) -> FloatArray:
    """The same point of the other arm, (N, 3) [m], which needs no named frame of it.

    Where a link was meant to be our base_link, the arms are mounted by it.
    """
    tips, stands = arm.tip_points(*their_lines(theirs, alignment, q)), alignment.stands
    if alignment.same_base:
        tips = (tips - stands[:3, 3]) @ stands[:3, :3] @ rotation_about(Z, -_yaw(alignment))
    return tips


def fit(theirs: FourJointArm, start: Alignment, free: Iterable[int]) -> Alignment:
    """Gauss-Newton over the free ones of 16 unknowns: base (6), two zeros, dimensions (8)."""
    columns = list(free)
    best, (error, jacobian) = start, difference(theirs, start)
    for _ in range(50):
        change = np.zeros(16)
        change[columns] = -np.linalg.lstsq(jacobian[:, columns], error, rcond=None)[0]
        for _ in range(20):  # a step too long is cut until it helps
            tried = _changed(best, change)
            left, slope = difference(theirs, tried)
            if (gain := error @ error - left @ left) >= 0:
                break
            change = change / 4
        if gain > 0:
            best, error, jacobian = tried, left, slope
        if gain <= 1e-9 * (left @ left) or np.abs(change).max() < 1e-9:
            break
    turns = np.square(error.reshape(-1, 6)[:, 3:]).sum(axis=1)
    residual = math.sqrt(np.square(error).mean()), math.sqrt(turns.mean())
    return replace(best, zero=wrap(best.zero), residual=residual)


def _changed(alignment: Alignment, change: FloatArray) -> Alignment:
    """Base moved by a small rotation and shift (6,), zeros (2,) and dimensions (8,)."""
    size = float(np.linalg.norm(change[:3]))
    turn = rotation_about(change[:3] / size, size) if size else None
    base = transform(turn) @ alignment.base
    base[:3, 3] += change[3:6]
    zero = alignment.zero + np.array([0.0, change[6], change[7], 0.0])
    return replace(alignment, base=base, zero=zero, dimensions=alignment.dimensions + change[8:])


def difference(theirs: FourJointArm, alignment: Alignment) -> Pair:
    """Their axes minus ours in Plücker coordinates, (24 N,), and the derivative, (24 N, 16).

    The coordinates are moments about our root [m] and directions. Each unknown, of base (6), zeros
    (2) and dimensions (8), is a screw (w, v) that moves the lines (m, d) behind it by w x d and w x
    m + v x d.
    """
    q, sign = arm.random_positions(POSITIONS), alignment.sign[1:3, None, None]
    frames = np.moveaxis(our_frames(q, alignment.dimensions), 1, 0)  # joint, position
    points, x, y, z = (frames[..., :3, k] for k in (3, 0, 1, 2))
    there, heading = (np.moveaxis(part, 1, 0) for part in their_lines(theirs, alignment, q))
    moments, ours = _cross(there, heading), _cross(points, z)
    alpha = parameters().dh[1].alpha + alignment.dimensions[5]
    tilt = math.cos(alpha) * y[1] + math.sin(alpha) * z[1]
    w, v = np.zeros((2, 16, 1, POSITIONS, 3))  # unknown, any joint, position
    w[:3, 0] = v[3:6, 0] = np.eye(3)[:, None]
    w[6:8, 0], v[6:8, 0] = sign * heading[1:3], sign * moments[1:3]
    v[8:11, 0], v[11, 0] = x[:3], z[1]
    w[12:15, 0], v[12:15, 0] = x[:3], _cross(points[1:], x[:3])
    w[15, 0], v[15, 0] = tilt, _cross(points[2], tilt)
    m, d = (np.repeat([a, -b], 8, axis=0) for a, b in ((moments, ours), (heading, z)))
    columns = np.concatenate([_cross(w, m) + _cross(v, d), _cross(w, d)], axis=-1)
    columns *= (np.arange(4) >= np.array(MOVES_FROM)[:, None])[..., None, None]
    error = np.concatenate([moments - ours, heading - z], axis=-1)
    return error.ravel(), columns.reshape(16, -1).T


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """NumPy's cross product without its overhead."""
    one, two = [1, 2, 0], [2, 0, 1]
    out: FloatArray = a[..., one] * b[..., two] - a[..., two] * b[..., one]
    return out


def their_lines(theirs: FourJointArm, alignment: Alignment, q: FloatArray) -> Pair:
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
    frames = our_frames(zero)
    points, directions = frames[:, :3, 3], frames[:, :3, 2]
    out = Alignment(sign=sign)
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
