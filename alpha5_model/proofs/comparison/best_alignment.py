"""Choose the likeliest of the alignments that bring another model's axes onto ours.

Lines have no direction, so several alignments fit equally well. One turns the arm
upside down with every joint reversed; another mounts one joint the wrong way round,
with all that follows it. Nor do the axes show two of the zeros, see `axis_fit`. Bodies,
collision shapes, the base frame and the tool frame decide.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import rotation_about, transform, wrap
from alpha5_model.proofs.comparison.alignment import Alignment, allowed
from alpha5_model.proofs.comparison.axis_fit import AxisFit
from alpha5_model.proofs.comparison.axis_lines import Z
from alpha5_model.proofs.comparison.base_link import (
    com_errors_by_link,
    with_base_link,
)
from alpha5_model.proofs.comparison.chains import AXES
from alpha5_model.proofs.comparison.four_joint_arm import FourJointArm
from alpha5_model.proofs.comparison.line_screws import POSE_UNKNOWNS, UNKNOWNS
from alpha5_model.proofs.comparison.oddity import Judge
from alpha5_model.proofs.comparison.own_arm import AS_IT_IS, DIMENSIONS, TWISTS, OwnArm
from alpha5_model.proofs.comparison.placement import body_errors, body_transforms

#: A closed form with a larger error has a wrong sign or twist [m and rad].
WRONG_START_ERROR = 0.05
#: How many alignments are fitted: the likeliest of those whose axes coincide.
FITTED = 8


def align(ours: OwnArm, theirs: FourJointArm) -> Alignment:
    """Best alignment of another model of this arm.

    Base, signs and the zeros of axis_d and axis_c bring their axes as close to ours as
    possible. Dimensions that are off by more than the printed digits allow are fitted
    too: a wrong offset must not look like a shifted zero. If several alignments fit
    equally well, the least odd one is taken (`Judge.oddity`).
    """
    axes = AxisFit(our_arm=ours, their_arm=theirs)
    tolerance = allowed(ours.parameters, theirs)
    tolerances = np.repeat([tolerance.length, tolerance.angle], 4)
    judge = Judge(ours=ours, theirs=theirs, tolerances=tolerances)

    com_errors = com_errors_by_link(ours, theirs)
    starts = _close_starts(axes)
    placed = [with_base_link(theirs, com_errors, start) for start in starts]
    likely = sorted(placed, key=judge.oddity)[:FITTED]

    # With all dimensions free the axes coincide: each dimension shows its own error.
    fits = [axes.fit(start, UNKNOWNS) for start in likely]
    with_bases = [with_base_link(theirs, com_errors, fit) for fit in fits]
    all_free = min(with_bases, key=judge.oddity)

    fit = _with_wrong_dimensions_only(axes, all_free, tolerances)
    best = with_base_link(theirs, com_errors, fit)
    return replace(
        _settle_zeros(ours, theirs, best),
        exact=_settle_zeros(ours, theirs, all_free),
    )


def _with_wrong_dimensions_only(
    axes: AxisFit, all_free: Alignment, tolerances: FloatArray
) -> Alignment:
    """The best fit with our dimensions, except those that differ.

    Args:
        axes: Both arms.
        all_free: The fit with all dimensions free.
        tolerances: Of the dimensions, (8,) [m, rad].
    """
    wrong = np.abs(all_free.dimensions) > tolerances
    dimensions = np.where(wrong, all_free.dimensions, 0.0)
    free = {*POSE_UNKNOWNS, *itertools.compress(DIMENSIONS, wrong)}
    return axes.fit(replace(all_free, dimensions=dimensions), free)


def without_zero(
    ours: OwnArm, theirs: FourJointArm, alignment: Alignment, joint: int
) -> float:
    """Residual [m] of the best fit if axis_d or axis_c has our zero.

    Args:
        ours: Our arm.
        theirs: The other arm.
        alignment: Its best alignment.
        joint: 1 for axis_d, 2 for axis_c.
    """
    zero = alignment.zero.copy()
    zero[joint] = 0.0
    held = replace(alignment, zero=zero)
    free = {*POSE_UNKNOWNS, *alignment.changes()}
    free.remove(f"zero of {AXES[joint]}")
    axes = AxisFit(our_arm=ours, their_arm=theirs)
    length, _ = axes.fit(held, free).residual
    return length


def _close_starts(axes: AxisFit) -> list[Alignment]:
    """The alignments in closed form whose axes nearly coincide."""
    choices = _signs_and_dimensions()
    starts = [axes.closed_form(sign, dimensions) for sign, dimensions in choices]
    errors = [axes.guess_error(start) for start in starts]

    # With a wrong sign or twist, no fit of the dimensions would help.
    most = max(WRONG_START_ERROR, 2 * min(errors))
    return [start for start, error in zip(starts, errors, strict=True) if error <= most]


def _signs_and_dimensions() -> Iterator[tuple[FloatArray, FloatArray]]:
    """All choices of signs and of twists that are turned by pi or not.

    Yields:
        Signs of the joints, (4,), and changes of our dimensions, (8,) [m, rad].
    """
    for sign in itertools.product((1.0, -1.0), repeat=4):
        for twists in itertools.product((0.0, math.pi), repeat=3):
            dimensions = AS_IT_IS.copy()
            dimensions[TWISTS] = twists
            yield np.array(sign), dimensions


def _settle_zeros(
    ours: OwnArm, theirs: FourJointArm, alignment: Alignment
) -> Alignment:
    """The alignment with the zeros of axis_e and axis_b, which the axes do not show.

    The base frame decides the zero of axis_e. The last body decides that of axis_b: it
    is shifted if the body then fits four times better.
    """
    with_yaw = _with_base_yaw(alignment) if alignment.same_base else alignment
    with_roll = _with_wrist_roll(ours, theirs, with_yaw)
    error = body_errors(ours, theirs, with_yaw)[4]
    error_with_roll = body_errors(ours, theirs, with_roll)[4]
    best = with_roll if 4 * error_with_roll < error else with_yaw
    return replace(best, zero=wrap(best.zero))


def _with_base_yaw(alignment: Alignment) -> Alignment:
    """The alignment with the yaw of their base frame as a zero of axis_e."""
    base_link_pose = alignment.stands
    yaw = math.atan2(base_link_pose[1, 0], base_link_pose[0, 0])
    back = transform(rotation_about(Z, -yaw))
    shift = alignment.sign * [yaw, 0, 0, 0]
    return replace(
        alignment,
        base=back @ alignment.base,
        stands=back @ base_link_pose,
        zero=alignment.zero + shift,
    )


def _with_wrist_roll(
    ours: OwnArm, theirs: FourJointArm, alignment: Alignment
) -> Alignment:
    """The alignment with the roll of their last body as a zero of axis_b."""
    wrist = body_transforms(ours, theirs, alignment)[4]
    roll = math.atan2(wrist[1, 0], wrist[0, 0])
    shift = alignment.sign * [0, 0, 0, roll]
    return replace(alignment, zero=alignment.zero - shift)
