"""What is wrong with the joint axes, what it costs, and what to write instead."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import rotation_about, wrap
from alpha5_model.proofs.comparison.alignment import (
    ANGLE_TOLERANCE,
    LENGTH_TOLERANCE,
    Alignment,
)
from alpha5_model.proofs.comparison.axis_lines import Z
from alpha5_model.proofs.comparison.best_alignment import without_zero
from alpha5_model.proofs.comparison.chains import AXES
from alpha5_model.proofs.comparison.correction import LEVER, JointCorrection
from alpha5_model.proofs.comparison.evidence import Evidence
from alpha5_model.proofs.comparison.findings import finding
from alpha5_model.proofs.comparison.four_joint_arm import FourJointArm
from alpha5_model.proofs.comparison.own_arm import DIMENSIONS
from alpha5_model.proofs.comparison.placement import bodies_in_our_frames
from alpha5_model.proofs.comparison.poses import origin_of
from alpha5_model.proofs.comparison.records import Finding
from alpha5_model.proofs.comparison.tool import tool_in_wrist

#: A COM of link_0 this close to ours settles the zero of axis_e.
SAME_COM = 1e-3  # [m]
#: The first of `DIMENSIONS` are lengths, the others angles.
LENGTHS = 4


def findings_of_axes(evidence: Evidence) -> Iterator[Finding]:
    """What is wrong with signs, zeros and dimensions, base to tip."""
    yield from _zeros(evidence)
    yield from _dimensions(evidence)


# -------------------------------------------------------------------------------- zeros


def _zeros(evidence: Evidence) -> Iterator[Finding]:
    """Joints that turn the other way or have another zero."""
    alignment = evidence.alignment
    for joint in range(4):
        if np.signbit(alignment.sign[joint]):
            yield _reversed(evidence, joint)
        if abs(alignment.zero[joint]) > evidence.tolerance.angle:
            yield _shifted(evidence, joint)


def _reversed(evidence: Evidence, joint: int) -> Finding:
    """A joint that turns the other way."""
    q = evidence.q.copy()
    q[:, joint] = -q[:, joint]
    cost = evidence.torque_change(evidence.ours.reduced, q)
    return finding(
        "reversed",
        where=AXES[joint],
        cost=round(cost, 9),
        line=evidence.joint_replacements[joint],
    )


def _shifted(evidence: Evidence, joint: int) -> Finding:
    """A joint with another zero."""
    alignment = evidence.alignment
    zero = float(alignment.zero[joint])
    q = evidence.q.copy()
    q[:, joint] -= alignment.sign[joint] * zero
    cost = evidence.torque_change(evidence.ours.reduced, q)

    key = "zero"
    words = {"shift": math.degrees(zero), "line": evidence.joint_replacements[joint]}
    if joint in (1, 2):
        key = "zero.fitted"
        without = without_zero(evidence.ours, evidence.theirs, alignment, joint)
        words |= {"fit": _fit(alignment), "without": without * 1e3}
    elif joint == 0 and not _base_is_known(evidence):
        key = "zero.or_base"
    return finding(key, where=AXES[joint], cost=round(cost, 9), **words)


def _base_is_known(evidence: Evidence) -> bool:
    """Whether link_0 shows that the base is not turned by the shifted zero."""
    alignment = evidence.alignment
    coms, _ = bodies_in_our_frames(evidence.ours, evidence.theirs, alignment)
    ours = evidence.ours.reduced.com[0]
    turn = rotation_about(Z, alignment.sign[0] * alignment.zero[0])
    here = float(np.linalg.norm(coms[0] - ours))
    turned = float(np.linalg.norm(turn @ coms[0] - ours))
    return bool(evidence.theirs.mass[0]) and (here < SAME_COM or 3 * here < turned)


# --------------------------------------------------------------------------- dimensions


def _dimensions(evidence: Evidence) -> Iterator[Finding]:
    """Dimensions that differ by more than the digits explain."""
    length, angle = evidence.tolerance
    for index, change in enumerate(evidence.alignment.dimensions):
        within = length if index < LENGTHS else angle
        if abs(change) > within:
            yield _dimension(evidence, index, change)


def _dimension(evidence: Evidence, index: int, change: float) -> Finding:
    """A dimension that differs.

    Args:
        evidence: Both arms.
        index: Its place in `DIMENSIONS`.
        change: Theirs minus ours [m or rad].
    """
    name = DIMENSIONS[index]
    kind, _, number = name.partition("_")
    row = int(number)
    is_length = index < LENGTHS
    scale = 1e3 if is_length else 180 / math.pi
    ours = getattr(evidence.parameters.dh[row], kind, 0.0) * scale
    theirs = ours + change * scale
    if not is_length:
        theirs = float(wrap(math.radians(theirs), math.radians(ours)) * scale)

    only = np.zeros(len(DIMENSIONS))
    only[index] = change
    q = evidence.q
    shifts = evidence.ours.tips(q, only) - evidence.ours.tips(q)
    return finding(
        f"dimension.{name}",
        cost=evidence.torque_change(evidence.ours.with_dimensions(only), q),
        theirs=theirs,
        ours=ours,
        unit="mm" if is_length else "deg",
        off=np.linalg.norm(shifts, axis=1).max() * 1e3,
        line=evidence.joint_replacements[row + 1],
    )


# --------------------------------------------------------------------------------- rest


def findings_of_rest(
    evidence: Evidence, corrections: list[JointCorrection]
) -> Iterator[Finding]:
    """Misplaced joints that no other finding corrects, and effects of printed digits.

    Args:
        evidence: Both arms.
        corrections: Of joints that no other finding corrects.
    """
    length, angle = evidence.tolerance
    rounded = []
    for correction in corrections:
        if correction.off > 3 * (length + LEVER * angle):
            yield _misplaced(correction)
        elif correction.off > LENGTH_TOLERANCE:
            rounded.append(correction.text)
    yield from _digits(evidence, "; ".join(rounded))


def _misplaced(correction: JointCorrection) -> Finding:
    """A joint that is misplaced by more than its digits explain."""
    return finding(
        "misplaced",
        where=correction.ours.name if correction.ours else "tool",
        off=correction.off * 1e3,
        line=correction.text,
    )


def _digits(evidence: Evidence, line: str) -> Iterator[Finding]:
    """Effects of the number of printed digits on the axes and on the tip.

    Args:
        evidence: Both arms.
        line: What to write in place of the joints that are rounded.
    """
    alignment = evidence.alignment
    there = alignment.theirs(evidence.q)
    meant = _tips(evidence, evidence.theirs, there)
    written = _tips(evidence, evidence.written, there)
    off = float(np.linalg.norm(meant - written, axis=1).max())
    pi_is_cut = off > LENGTH_TOLERANCE
    if pi_is_cut:
        yield finding("digits.of_pi", off=off * 1e3, line=line)

    zeros = _small_zeros(evidence)
    axes_are_off = alignment.residual[0] > LENGTH_TOLERANCE
    if axes_are_off or zeros or (line and not pi_is_cut):
        yield finding(
            "digits",
            length=evidence.tolerance.length * 1e3,
            angle=math.degrees(evidence.tolerance.angle),
            fit=_fit(alignment),
            zeros=zeros,
            line="" if pi_is_cut else line,
        )


def _tips(evidence: Evidence, reading: FourJointArm, q: FloatArray) -> FloatArray:
    """Tool points of the other arm as it is meant or written, (N, 3) [m]."""
    tool = tool_in_wrist(evidence.ours, evidence.theirs, reading, evidence.alignment)
    return origin_of(reading.poses(q)[:, 4] @ tool)


def _small_zeros(evidence: Evidence) -> str:
    """The zeros of axis_d and axis_c that the digits explain, in words."""
    words = ""
    for joint in (1, 2):
        zero = evidence.alignment.zero[joint]
        if ANGLE_TOLERANCE < abs(zero) <= evidence.tolerance.angle:
            words += f", zero of {AXES[joint]} {math.degrees(zero):.2f} deg"
    return words


def _fit(alignment: Alignment) -> FloatArray:
    """Residual of the axes, root mean square [mm] and [deg]."""
    return np.multiply(alignment.residual, (1e3, 180 / math.pi))
