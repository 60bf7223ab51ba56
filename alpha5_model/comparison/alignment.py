"""Lay another model's joint axes over ours, as lines, in the least-squares sense.

What is free: where the other base stands, the sign of each joint, the zeros of axis_d and axis_c, and
those dimensions of the arm that differ. The axes do not tell two zeros: a shifted zero of axis_e is a yaw
of the base, one of axis_b a roll of the last body. Frames and bodies decide these.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.comparison.arm import FourJointArm
from alpha5_model.comparison.axis_fit import (
    DIMENSIONS,
    ZEROS,
    Alignment,
    closed_form,
    difference,
    fit,
    our_frames,
    our_lines,
    their_lines,
)
from alpha5_model.parameters import parameters
from alpha5_model.spatial import rotation_about, transform, wrap

#: Residual of the closed form beyond which an axis points the other way [m and rad].
REVERSED = 0.05
#: Smaller differences are no findings: of the axes, and of their angles, at arm's length 0.03 mm.
LENGTH_TOLERANCE = 1e-5  # [m]
ANGLE_TOLERANCE = 1e-4  # [rad]


def align(ours: FourJointArm, theirs: FourJointArm) -> Alignment:
    """Best alignment of two models of the same arm.

    Base, signs and the zeros of axis_d and axis_c bring their axes onto ours as well as they can. The
    dimensions that are then still off by more than the printed digits allow are fitted too: an
    offset must not look like a shifted zero. An arm lies over itself upside down with every joint
    reversed; of alignments that fit equally well, the one with the fewest oddities is taken.
    """
    starts = [
        closed_form(theirs, np.array(sign)) for sign in itertools.product((1.0, -1.0), repeat=4)
    ]
    errors = [np.sqrt(np.square(difference(theirs, start)[0]).mean()) for start in starts]
    # Where a direction is reversed no dimension helps.
    close = [s for s, e in zip(starts, errors, strict=True) if e <= max(REVERSED, 2 * min(errors))]
    # With all dimensions free the axes coincide: each tells its own error, whatever the others'.
    length, angle = allowed(theirs)
    within = np.where(np.arange(8) < 4, length, angle)
    fits = [_with_base_link(theirs, fit(theirs, start, range(16))) for start in close]
    exact = min(fits, key=lambda one: _oddities(ours, theirs, one, within))
    wrong = np.abs(exact.dimensions) > within
    best = replace(exact, dimensions=np.where(wrong, exact.dimensions, 0.0))
    best = _with_base_link(theirs, fit(theirs, best, (*ZEROS, *(8 + np.flatnonzero(wrong)))))
    exact = _settle_zeros(ours, theirs, exact)
    return replace(_settle_zeros(ours, theirs, best), exact=exact)


def allowed(theirs: FourJointArm, short_pi: bool = False) -> tuple[float, float]:
    """What is no finding: the printed digits and the tolerances allow it; lengths [m], angles [rad].

    Rounded lengths turn the axes by as much over the length of the upper arm. Where a file cuts pi
    short, the same error may hide in angles that were computed from it (``short_pi``).
    """
    lengths, angles, pi = theirs.digits
    turns = math.hypot(angles, lengths / parameters().dh[1].a, 2 * pi * short_pi)
    arms = parameters().dh[1].a * 2 * pi * short_pi
    return max(LENGTH_TOLERANCE, lengths, arms), max(ANGLE_TOLERANCE, turns)


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


def _oddities(
    ours: FourJointArm, theirs: FourJointArm, alignment: Alignment, within: FloatArray
) -> float:
    """How unlikely an alignment is: everything that a person would have had to do to the model.

    A turned sign, a shifted zero count one, a wrong dimension four, a base that stands elsewhere or
    upside down up to six, bodies elsewhere up to four.
    """
    base = min(6.0, 30 * _distance(alignment.stands))
    com = bodies_in_our_frames(ours, theirs, alignment)[0][2:] - ours.com[2:]
    bodies = 4 * np.minimum(1.0, np.linalg.norm(com, axis=1) / 0.05).mean()
    changed = 4 * (np.abs(alignment.dimensions) > within).sum()
    return float(alignment.oddities + base + changed + bodies)


def _settle_zeros(ours: FourJointArm, theirs: FourJointArm, alignment: Alignment) -> Alignment:
    """Zeros of axis_e and axis_b: where the frames stand turned, and the bodies fit with them."""
    if alignment.same_base and theirs.mass[0]:
        yaw = _yaw(alignment)
        angle = alignment.sign[0] * math.atan2(yaw[1, 0], yaw[0, 0])
        back = transform(yaw.T)
        turned = replace(
            alignment,
            base=back @ alignment.base,
            stands=back @ alignment.stands,
            zero=alignment.zero + angle * np.eye(4)[0],
        )
        alignment = min(turned, alignment, key=lambda a: _body_errors(ours, theirs, a)[0])
    seen = body_transforms(ours, theirs, alignment)[4]
    roll = math.atan2(seen[1, 0], seen[0, 0])
    turned = replace(alignment, zero=alignment.zero - alignment.sign[3] * roll * np.eye(4)[3])
    if 4 * _body_errors(ours, theirs, turned)[4] < _body_errors(ours, theirs, alignment)[4]:
        alignment = turned
    return replace(alignment, zero=wrap(alignment.zero))


def _yaw(alignment: Alignment) -> FloatArray:
    """The turn of their base_link about our axis_e, (3, 3)."""
    return rotation_about((0, 0, 1), math.atan2(alignment.stands[1, 0], alignment.stands[0, 0]))


def _body_errors(ours: FourJointArm, theirs: FourJointArm, alignment: Alignment) -> FloatArray:
    """How far each body is from ours in second moments, (5,) [kg m^2]."""
    com, inertia = bodies_in_our_frames(ours, theirs, alignment)
    moved = ours.mass * np.square(com - ours.com).sum(axis=1)
    out: FloatArray = moved + np.abs(inertia - ours.inertia).max(axis=(1, 2))
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
    an error of the geometry and not one of the COM as well. The first body is held by the frame that
    was meant to be base_link, if there is one; body 1 by the base or by the shoulder, whose height
    above it may differ: by the one that fits.
    """
    here = with_dimensions(ours, alignment.dimensions).poses(np.zeros(4))
    there = alignment.base @ theirs.poses(alignment.zero)
    transforms: FloatArray = np.linalg.inv(here) @ there
    if alignment.same_base:
        base = theirs.link_poses[alignment.base_link]
        transforms[0] = transform(_yaw(alignment)) @ np.linalg.inv(base)
        held = transforms[1].copy()
        held[2, 3] -= alignment.stands[2, 3]
        transforms[1] = min(
            (held, transforms[1]),
            key=lambda t: float(np.linalg.norm(t[:3, :3] @ theirs.com[1] + t[:3, 3] - ours.com[1])),
        )
    return transforms


def with_dimensions(ours: FourJointArm, change: FloatArray) -> FourJointArm:
    """Our arm with changed dimensions; each body stays with its own joint."""
    before, after = (our_frames(np.zeros((1, 4)), c)[0] for c in (np.zeros(8), change))
    poses = ours.poses(np.zeros(4))
    poses[1:] = after @ np.linalg.inv(before) @ poses[1:]
    return replace(ours, placements=np.linalg.inv(poses[:-1]) @ poses[1:])


def our_tips(q: FloatArray, change: FloatArray | None = None) -> FloatArray:
    """Tips of our arm, (N, 3) [m]: on the wrist axis, d_3 from the foot of its normal with axis_c."""
    return _tips(our_lines(q, np.zeros(len(DIMENSIONS)) if change is None else change))


def their_tips(theirs: FourJointArm, alignment: Alignment, q: FloatArray) -> FloatArray:
    """The same point of the other arm, (N, 3) [m], which needs no named frame of it.

    Where a link was meant to be our base_link, the arms are mounted by it.
    """
    tips = _tips(their_lines(theirs, alignment, q))
    if alignment.same_base:
        tips = (tips - alignment.stands[:3, 3]) @ alignment.stands[:3, :3] @ _yaw(alignment).T
    return tips


def _tips(lines: tuple[FloatArray, FloatArray]) -> FloatArray:
    points, directions = lines
    u, w, r = directions[:, 3], directions[:, 2], points[:, 3] - points[:, 2]
    b, along, across = (np.sum(x * y, axis=1) for x, y in ((u, w), (w, r), (u, r)))
    reach = (b * along - across) / (1 - b * b) + parameters().dh[3].d
    out: FloatArray = points[:, 3] + reach[:, None] * u
    return out
