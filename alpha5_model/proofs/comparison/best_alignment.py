"""Choose the likeliest of the alignments that bring another model's axes onto ours.

Lines have no direction, so that several alignments fit equally well: an arm upside down
with every joint reversed, or one whose joint is mounted the wrong way round, with all
that follows. The axes do not show two of the zeros either, see `axis_fit`. Bodies,
collision shapes, the base frame and the tool frame decide these.
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
from alpha5_model.proofs.comparison.base_link import with_base_link
from alpha5_model.proofs.comparison.chains import AXES
from alpha5_model.proofs.comparison.four_joint_arm import FourJointArm
from alpha5_model.proofs.comparison.line_screws import POSE_UNKNOWNS, UNKNOWNS
from alpha5_model.proofs.comparison.oddity import Judge
from alpha5_model.proofs.comparison.own_arm import AS_IT_IS, DIMENSIONS, TWISTS, OwnArm
from alpha5_model.proofs.comparison.placement import body_errors, body_transforms

#: Residual of the closed form beyond which an axis points the other way [m and rad].
REVERSED = 0.05
#: How many alignments are fitted, the likeliest of those that fit as lines.
FITTED = 8


def align(ours: OwnArm, theirs: FourJointArm) -> Alignment:
    """Best alignment of another model of this arm.

    Base, signs and the zeros of axis_d and axis_c bring their axes onto ours as well as
    they can. The dimensions that are then still off by more than the printed digits
    allow are fitted too: an offset must not look like a shifted zero. Of alignments
    that fit equally well, the one with the fewest oddities is taken.
    """
    axes = AxisFit(ours=ours, theirs=theirs)
    tolerance = allowed(ours.parameters, theirs)
    within = np.repeat([tolerance.length, tolerance.angle], 4)
    judge = Judge(ours=ours, theirs=theirs, within=within)

    starts = _close_starts(axes)
    placed = [with_base_link(ours, theirs, start) for start in starts]
    likely = sorted(placed, key=judge.oddity)[:FITTED]

    # With all dimensions free the axes coincide: each dimension shows its own error.
    fits = [axes.fit(start, UNKNOWNS) for start in likely]
    fitted = [with_base_link(ours, theirs, fit) for fit in fits]
    exact = min(fitted, key=judge.oddity)

    fit = _with_wrong_dimensions_only(axes, exact, within)
    best = with_base_link(ours, theirs, fit)
    return replace(
        _settle_zeros(ours, theirs, best),
        exact=_settle_zeros(ours, theirs, exact),
    )


def _with_wrong_dimensions_only(
    axes: AxisFit, exact: Alignment, within: FloatArray
) -> Alignment:
    """The best fit with our dimensions, except those that differ.

    Args:
        axes: Both arms.
        exact: The fit with all dimensions free.
        within: Changes of the dimensions that are none, (8,) [m, rad].
    """
    wrong = np.abs(exact.dimensions) > within
    dimensions = np.where(wrong, exact.dimensions, 0.0)
    free = {*POSE_UNKNOWNS, *itertools.compress(DIMENSIONS, wrong)}
    return axes.fit(replace(exact, dimensions=dimensions), free)


def without_zero(
    ours: OwnArm, theirs: FourJointArm, alignment: Alignment, joint: int
) -> float:
    """Residual [m] of the best fit with the zero of axis_d or axis_c held at ours.

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
    axes = AxisFit(ours=ours, theirs=theirs)
    length, _ = axes.fit(held, free).residual
    return length


def _close_starts(axes: AxisFit) -> list[Alignment]:
    """Alignments with any signs and directions that fit as lines."""
    starts = [axes.closed_form(sign, twists) for sign, twists in _directions()]
    errors = [axes.line_error(start) for start in starts]

    # If a direction is reversed no dimension helps.
    most = max(REVERSED, 2 * min(errors))
    return [start for start, error in zip(starts, errors, strict=True) if error <= most]


def _directions() -> Iterator[tuple[FloatArray, FloatArray]]:
    """Signs of the joints, (4,), and dimensions, (8,), with any twists turned by pi."""
    for sign in itertools.product((1.0, -1.0), repeat=4):
        for turned in itertools.product((0.0, math.pi), repeat=3):
            dimensions = AS_IT_IS.copy()
            dimensions[TWISTS] = turned
            yield np.array(sign), dimensions


def _settle_zeros(
    ours: OwnArm, theirs: FourJointArm, alignment: Alignment
) -> Alignment:
    """The alignment with zeros of axis_e and axis_b.

    The base frame decides the first one, the last body the second.
    """
    upright = _without_yaw(alignment) if alignment.same_base else alignment
    turned = _without_roll(ours, theirs, upright)
    error = body_errors(ours, theirs, upright)[4]
    turned_error = body_errors(ours, theirs, turned)[4]
    best = turned if 4 * turned_error < error else upright
    return replace(best, zero=wrap(best.zero))


def _without_yaw(alignment: Alignment) -> Alignment:
    """Their base frame turned into ours about z, by the zero of axis_e."""
    stands = alignment.stands
    yaw = math.atan2(stands[1, 0], stands[0, 0])
    back = transform(rotation_about(Z, -yaw))
    shift = alignment.sign * [yaw, 0, 0, 0]
    return replace(
        alignment,
        base=back @ alignment.base,
        stands=back @ stands,
        zero=alignment.zero + shift,
    )


def _without_roll(
    ours: OwnArm, theirs: FourJointArm, alignment: Alignment
) -> Alignment:
    """Their last body turned into ours about the wrist, by the zero of axis_b."""
    wrist = body_transforms(ours, theirs, alignment)[4]
    roll = math.atan2(wrist[1, 0], wrist[0, 0])
    shift = alignment.sign * [0, 0, 0, roll]
    return replace(alignment, zero=alignment.zero - shift)
