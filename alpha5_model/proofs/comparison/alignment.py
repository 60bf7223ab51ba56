"""Fit another model's joint axes to ours, as lines, by least squares.

What is free: where the other base stands, the sign of each joint, the zeros of axis_d and axis_c,
and those dimensions of the arm that differ. Lines have no direction, so that several alignments
fit equally well: an arm upside down with every joint reversed, or one whose joint is mounted the
wrong way round, with all that follows. The axes do not show two of the zeros either: a shifted
zero of axis_e is a yaw of the base, one of axis_b a roll of the last body. Bodies, collision
shapes, the base frame and the tool frame decide these.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import moved, rotation_about, transform, wrap
from alpha5_model.numbers.parameters import parameters
from alpha5_model.proofs.comparison import arm
from alpha5_model.proofs.comparison.arm import (
    FourJointArm,
    Pair,
    Z,
    our_arm,
    our_frames,
    zero_poses,
)
from alpha5_model.proofs.comparison.reading import foot

#: The dimensions of our arm that another model may have otherwise: distances and twists of axes
#: that follow each other, the offset of the elbow along axis_d, and its tilt (parallel axes have no
#: twist about their second direction).
DIMENSIONS = ("a_0", "a_1", "a_2", "d_1", "alpha_0", "alpha_1", "alpha_2", "beta_1")
#: A frame that lies closer to our base_link than this was meant to be the same one; 0.1 m are taken
#: for a radian of tilt. So was one in which the COM of link_0 lies as close to ours.
SAME_FRAME, SAME_COM = 0.05, 0.02  # [m]
#: A smaller zero is no oddity.
SAME_ZERO = 0.005  # [rad]
#: Residual of the closed form beyond which an axis points the other way [m and rad].
REVERSED = 0.05
#: Smaller differences are no findings: of the axes, and of their angles, at arm's length 0.03 mm.
LENGTH_TOLERANCE, ANGLE_TOLERANCE = 1e-5, 1e-4  # [m], [rad]
#: How many alignments are fitted, the likeliest of those that fit as lines.
FITTED = 8
#: Bodies, tools and shapes that lie farther off than this speak as loudly as they can.
ELSEWHERE = 0.05  # [m]
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
        same_base: Whether that frame was meant to be our base_link.
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
    same_base: bool = False
    exact: Alignment | None = None

    @property
    def oddities(self) -> int:
        """Number of turned signs and shifted zeros."""
        return int((self.sign < 0).sum() + (np.abs(self.zero) > SAME_ZERO).sum())

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
    offset must not look like a shifted zero. Of alignments that fit equally well, the one with the
    fewest oddities is taken, see `_oddities`.
    """
    starts = [closed_form(theirs, *choice) for choice in _directions()]
    errors = [_line_error(theirs, start) for start in starts]
    # Where a direction is reversed no dimension helps.
    most = max(REVERSED, 2 * min(errors))
    close = [s for s, e in zip(starts, errors, strict=True) if e <= most]
    # With all dimensions free the axes coincide: each dimension shows its own error only.
    within = np.repeat(allowed(theirs), 4)

    def odd(one: Alignment) -> float:
        return _oddities(theirs, one, within)

    likely = sorted((_with_base_link(theirs, start) for start in close), key=odd)[
        :FITTED
    ]
    fits = [_with_base_link(theirs, fit(theirs, start, range(16))) for start in likely]
    exact = min(fits, key=odd)
    wrong = np.abs(exact.dimensions) > within
    best = replace(exact, dimensions=np.where(wrong, exact.dimensions, 0.0))
    best = _with_base_link(
        theirs, fit(theirs, best, [*range(8), *(8 + np.flatnonzero(wrong))])
    )
    return replace(_settle_zeros(theirs, best), exact=_settle_zeros(theirs, exact))


def _directions() -> Iterator[Pair]:
    """Signs of the joints, (4,), and dimensions, (8,), with any of the twists turned by pi."""
    for sign in itertools.product((1.0, -1.0), repeat=4):
        for turned in itertools.product((0.0, math.pi), repeat=3):
            yield np.array(sign), np.array([0.0] * 4 + [*turned, 0.0])


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
    free = [
        i
        for i in range(16)
        if i != 5 + joint and (i < 8 or alignment.dimensions[i - 8])
    ]
    return fit(theirs, held, free).residual[0]


def _with_base_link(theirs: FourJointArm, alignment: Alignment) -> Alignment:
    """The link between root and axis_e that comes closest to being our base_link.

    By its frame; by the COM of link_0 in it, if axis_e stands elsewhere; or by its place and name, if
    axis_e is upside down. Of frames that could all be meant, one that is called so.
    """
    poses = {
        name: alignment.base @ theirs.link_poses[name] for name in theirs.base_path
    }
    off = {name: _distance(pose) for name, pose in poses.items()}
    named = {name: name.lower().endswith(("base", "base_link")) for name in poses}
    same = {name: far < SAME_FRAME for name, far in off.items()}
    for name, pose in poses.items():
        if named[name] and np.linalg.norm(pose[:3, 3]) < SAME_FRAME:
            same[name] = True
    if theirs.mass[0]:
        for name in poses:
            back: FloatArray = np.asarray(
                np.linalg.inv(theirs.link_poses[name]), np.float64
            )
            com = float(np.linalg.norm(moved(back, theirs.com[0]) - our_arm().com[0]))
            if com < SAME_COM:
                off[name] = min(off[name], SAME_FRAME + com)
                same[name] = True

    def likely(name: str) -> tuple[bool, float]:
        called = same[name] and named[name]
        return not called, round(off[name] - 1e-3 * poses[name][0, 0], 6)

    name = min(poses, key=likely)
    return replace(alignment, base_link=name, stands=poses[name], same_base=same[name])


def _distance(pose: FloatArray) -> float:
    """Of a frame from ours, whatever its yaw [m]; 0.1 m are taken for a radian of tilt."""
    return float(
        np.linalg.norm(pose[:3, 3]) + 0.1 * math.acos(np.clip(pose[2, 2], -1, 1))
    )


def _oddities(theirs: FourJointArm, alignment: Alignment, within: FloatArray) -> float:
    """How unlikely an alignment is: everything that somebody must have changed in the model.

    A turned sign, a shifted zero count one, a wrong dimension four, one to the other side two, a base
    that stands elsewhere or upside down up to six. Bodies elsewhere count up to four together, and
    so do collision shapes; a tool frame up to six.
    """
    base = min(6.0, 30 * _distance(alignment.stands))
    wrong = np.abs(alignment.dimensions) > within
    # A distance to the other side is one joint mounted the wrong way round.
    lengths = [row.a for row in parameters().dh[:3]]
    mirrored = np.isclose(alignment.dimensions[:3], np.multiply(-2, lengths), atol=5e-3)
    changed = 4 * wrong.sum() - 2 * mirrored.sum()
    transforms = body_transforms(theirs, alignment)
    ours = our_arm()
    bodies = moved(transforms, theirs.com) - ours.com
    shapes = moved(transforms, theirs.shape_centres) - ours.shape_centres
    odd = alignment.oddities + base + changed
    odd += 4 * _elsewhere(bodies[2:][theirs.mass[2:] > 0])
    odd += 4 * _elsewhere(shapes[1:][np.isfinite(shapes[1:, 0])])
    if theirs.tool:
        tool = moved(transforms[4], theirs.link_poses[theirs.tool][:3, 3])
        odd += 6 * _elsewhere(tool[None] - ours.link_poses[ours.tool][:3, 3])
    return float(odd)


def _elsewhere(off: FloatArray) -> float:
    """How far off points (N, 3) are on average, from 0 to 1; 0 without any."""
    if not len(off):
        return 0.0
    return float(np.minimum(1.0, np.linalg.norm(off, axis=1) / ELSEWHERE).mean())


def _settle_zeros(theirs: FourJointArm, alignment: Alignment) -> Alignment:
    """Zeros of axis_e and axis_b: as the base frame stands, and as the last body fits."""
    sign, zero = alignment.sign, alignment.zero
    if alignment.same_base:
        yaw = math.atan2(alignment.stands[1, 0], alignment.stands[0, 0])
        back = transform(rotation_about(Z, -yaw))
        base, stands = back @ alignment.base, back @ alignment.stands
        zero = zero + sign * [yaw, 0, 0, 0]
        alignment = replace(alignment, base=base, stands=stands, zero=zero)
    seen = body_transforms(theirs, alignment)[4]
    roll = math.atan2(seen[1, 0], seen[0, 0])
    turned = replace(alignment, zero=alignment.zero - sign * [0, 0, 0, roll])
    if 4 * _body_errors(theirs, turned)[4] < _body_errors(theirs, alignment)[4]:
        alignment = turned
    return replace(alignment, zero=wrap(alignment.zero))


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
        transforms[0] = np.linalg.inv(theirs.link_poses[alignment.base_link])
        held = np.stack([transforms[1]] * 2)
        held[0, 2, 3] -= alignment.stands[2, 3]
        off = np.linalg.norm(moved(held, theirs.com[1]) - our_arm().com[1], axis=1)
        transforms[1] = held[off.argmin()]
    return transforms


def mended_transforms(theirs: FourJointArm, alignment: Alignment) -> FloatArray:
    """The same once the joints are written as ours: each body's axis lies exactly on ours."""
    transforms = body_transforms(theirs, alignment)
    for body, axis in enumerate(alignment.sign[:, None] * theirs.axes, start=1):
        transforms[body] = _on_axis(transforms[body], axis)
    return transforms


def _on_axis(pose: FloatArray, axis: FloatArray) -> FloatArray:
    """The pose, moved as little as possible, so that its axis (3,) lies on our z axis, (4, 4)."""
    seen = pose[:3, :3] @ axis
    across = np.cross(seen, Z)
    sine = float(np.linalg.norm(across))
    turn = (
        rotation_about(across / sine, math.atan2(sine, seen[2]))
        if sine > 1e-15
        else np.eye(3)
    )
    return transform(turn @ pose[:3, :3], [0.0, 0.0, pose[2, 3]])


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
    return replace(
        alignment, base=base, zero=zero, dimensions=alignment.dimensions + change[8:]
    )


def _line_error(theirs: FourJointArm, alignment: Alignment) -> float:
    """Root mean square of `difference`, from fewer positions."""
    q = arm.random_positions(POSITIONS)[:4]
    frames = our_frames(q, alignment.dimensions)
    points, heading = their_lines(theirs, alignment, q)
    moments = _cross(points, heading) - _cross(frames[..., :3, 3], frames[..., :3, 2])
    return math.sqrt(np.square([moments, heading - frames[..., :3, 2]]).mean())


def difference(theirs: FourJointArm, alignment: Alignment) -> Pair:
    """Their axes minus ours in Plücker coordinates, (24 N,), and the derivative, (24 N, 16).

    The coordinates are moments about our root [m] and directions. Each unknown, of base (6), zeros
    (2) and dimensions (8), is a screw (w, v) that moves the lines (m, d) behind it by w x d and w x
    m + v x d.
    """
    q, sign = arm.random_positions(POSITIONS), alignment.sign[1:3, None, None]
    frames = np.moveaxis(our_frames(q, alignment.dimensions), 1, 0)  # joint, position
    points, x, y, z = (frames[..., :3, k] for k in (3, 0, 1, 2))
    there, heading = (
        np.moveaxis(part, 1, 0) for part in their_lines(theirs, alignment, q)
    )
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
    return points @ rotation.T + shift, directions @ rotation.T * alignment.sign[
        :, None
    ]


def closed_form(
    theirs: FourJointArm, sign: FloatArray, dimensions: FloatArray
) -> Alignment:
    """The alignment with these signs and dimensions that is exact where the shapes agree.

    The first two axes, which cross at a right angle, place the base. Turning about axis_d brings
    axis_c to its side of the shoulder, turning about axis_c the wrist into its direction.
    """
    zero = np.zeros(4)
    frames = our_frames(zero, dimensions)
    points, directions = frames[:, :3, 3], frames[:, :3, 2]
    out = Alignment(sign=sign, dimensions=dimensions)
    there, heading = their_lines(theirs, out, zero)
    turn = _frame(directions) @ _frame(heading).T
    shift = foot(points, directions, 0, 1) - turn @ foot(there, heading, 0, 1)
    out = replace(out, base=transform(turn, shift))
    for joint in (1, 2):
        axis = directions[joint]
        there, heading = their_lines(theirs, out, zero)
        mine = (points[2] - points[1], directions[3])[joint - 1]
        other = (there[2] - there[1], heading[3])[joint - 1]
        sine, cosine = (
            np.cross(other, mine) @ axis,
            other @ mine - (other @ axis) * (mine @ axis),
        )
        shift = sign[joint] * math.atan2(sine, cosine) * np.eye(4)[joint]
        out = replace(out, zero=out.zero + shift)
    return out


def _frame(directions: FloatArray) -> FloatArray:
    """Rotation with z along the first axis and the second axis in the plane of y and z, (3, 3)."""
    z = directions[0]
    x = np.cross(directions[1], z)
    size = np.linalg.norm(x)
    x = (
        x / size if size > 1e-9 else np.linalg.svd(z[None])[2][1]
    )  # one direction: any x will do
    return np.stack([x, np.cross(z, x), z], axis=1)
