"""Inverse kinematics of many targets: blocks of rows with NumPy, in scratch that is made once."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from alpha5_model.checks import BoolArray, FloatArray
from alpha5_model.kinematics.ik.one import (
    LIMIT_TOLERANCE,
    NEAR_AXIS,
    NEAR_EDGE,
    NEAR_LIMIT,
    solve_one,
)
from alpha5_model.kinematics.plane import ArmPlane, arm_plane

#: Rows per block: the scratch, about 2 MB, stays in the processor's cache.
BLOCK = 8192


def solve_batch(
    position: FloatArray, wrist: FloatArray
) -> tuple[FloatArray, BoolArray, BoolArray, BoolArray]:
    """Solve finite targets of any shape.

    Args:
        position: (..., 3) [m].
        wrist: Broadcasts to (...) [rad].

    Returns:
        q (..., 4, 4), exists (..., 4), within limits (..., 4) and singular (...), as in
        `alpha5_model.kinematics.ik.solutions.Solutions`.
    """
    lead = position.shape[:-1]
    position = position.reshape(-1, 3)
    if wrist.ndim:
        wrist = np.broadcast_to(wrist, lead).reshape(-1)
    rows = len(position)
    q, singular = np.empty((rows, 4, 4)), np.zeros(rows, np.bool_)
    exists, within = np.empty((rows, 4), np.bool_), np.empty((rows, 4), np.bool_)
    g, scratch = arm_plane(), _Scratch(min(BLOCK, rows))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        theta_3, theta_3_fits = _wrist(wrist if wrist.ndim == 0 else wrist[:1], g)
        for start in range(0, rows, BLOCK):
            part = slice(start, start + BLOCK)
            target = position[part]
            if len(target) != scratch.rows:
                del scratch  # never two at a time
                scratch = _Scratch(len(target))
            if wrist.ndim:
                theta_3, theta_3_fits = _wrist(wrist[part], g)
            near = _solve_block(
                g, scratch, target, theta_3, theta_3_fits, q[part], exists[part], within[part]
            )
            for row in near.tolist():
                x, y, z = target[row].tolist()
                angle = float(theta_3[row] if wrist.ndim else theta_3)
                angles, found, fit, edge = solve_one(x, y, z, angle)
                at = start + row
                q[at] = np.reshape(angles, (4, 4))
                exists[at] = [found >> branch & 1 for branch in range(4)]
                within[at] = [fit >> branch & 1 for branch in range(4)]
                singular[at] = edge
    shape = (*lead, 4)
    return (
        q.reshape(*shape, 4),
        exists.reshape(shape),
        within.reshape(shape),
        singular.reshape(lead),
    )


def reached(position: FloatArray, limits: bool) -> BoolArray:
    """Which branches reach finite targets, whatever the wrist angle.

    Args:
        position: (..., 3) [m].
        limits: Within the limits of theta_0, theta_1 and theta_2; without, all angles are free.

    Returns:
        (..., 4), branch axis as in `alpha5_model.kinematics.ik.solutions.BRANCHES`.
    """
    middle = arm_plane().middle[3]
    _, exists, within, _ = solve_batch(position, np.asarray(middle))
    return within if limits else exists


def _wrist(wrist: FloatArray, g: ArmPlane) -> tuple[FloatArray, BoolArray]:
    """theta_3 in its range, and whether it fits; rounding beside a limit is removed."""
    lower, upper, middle = g.limits[3]
    angle = wrist - math.tau * np.rint((wrist - middle) / math.tau)
    clipped = np.clip(angle, lower, upper)
    fits = np.abs(angle - clipped) <= LIMIT_TOLERANCE
    return np.where(fits, clipped, angle), fits


class _Scratch:
    """Arrays of one block. First axis: the plane's two ways to face, or the four branches."""

    def __init__(self, rows: int) -> None:
        self.rows = rows
        self.xyz = np.empty((3, rows))
        self.radius = np.empty(rows)
        self.r, self.above, self.below, self.theta_0 = np.empty((4, 2, rows))
        self.theta_1, self.theta_2, self.work = np.empty((3, 4, rows))
        self.found = np.empty((2, rows), np.bool_)
        self.fits, self.test, self.wide = np.empty((3, 4, rows), np.bool_)
        self.near = np.empty(rows, np.bool_)


def _solve_block(
    g: ArmPlane,
    s: _Scratch,
    target: FloatArray,
    wrist: FloatArray,
    wrist_fits: BoolArray,
    q: FloatArray,
    exists: BoolArray,
    within: BoolArray,
) -> NDArray[np.intp]:
    """The formulas of `alpha5_model.kinematics.ik.solutions` on one block.

    Returns:
        The rows that are near an edge, whose solution is not to be relied on.
    """
    (x, y, h), r, above, below, near = s.xyz, s.r, s.above, s.below, s.near
    pair_work, pair_test = s.work[:2], s.test[:2]

    # The target in the plane that faces it and in the plane that turns its back to it.
    for axis in range(3):
        s.xyz[axis] = target[:, axis]
    h -= g.d_0
    np.multiply(x, x, out=s.radius)
    np.multiply(y, y, out=pair_work[0])
    s.radius += pair_work[0]
    np.sqrt(s.radius, out=s.radius)
    np.less(s.radius, NEAR_AXIS, out=near)
    np.subtract(s.radius, g.a_0, out=r[0])
    np.subtract(-g.a_0, s.radius, out=r[1])
    np.multiply(r, r, out=below)
    np.multiply(h, h, out=pair_work[0])
    below += pair_work[0]
    np.subtract(g.squares[0], below, out=above)
    below -= g.squares[1]
    # above + below = 4 l_1 l_2 > 0: the product is positive within reach and small at its edges.
    np.multiply(above, below, out=pair_work)
    np.greater(pair_work, 0.0, out=s.found)
    np.abs(pair_work, out=pair_work)
    np.less(pair_work, NEAR_EDGE * 4 * g.l_1 * g.l_2, out=pair_test)
    near |= pair_test[0]
    near |= pair_test[1]

    # Where a target is out of reach, the root is NaN and so is what follows.
    tangent, half_gamma, alpha = s.work[:2], s.theta_2[:2], s.work[2:]
    np.divide(below, above, out=tangent)
    np.sqrt(tangent, out=tangent)
    np.arctan(tangent, out=half_gamma)
    np.divide(g.k, tangent, out=tangent)
    np.arctan(tangent, out=alpha)
    alpha -= half_gamma
    alpha += math.pi / 2
    np.arctan2(h, r, out=s.theta_1[:2])
    s.theta_1[:2] -= g.phi_offset
    np.add(s.theta_1[:2], alpha, out=s.theta_1[2:])
    s.theta_1[:2] -= alpha
    half_gamma *= 2.0
    np.subtract(2 * math.pi - g.gamma_offset, half_gamma, out=s.theta_2[2:])
    half_gamma -= g.gamma_offset
    np.arctan2(y, x, out=s.theta_0[0])
    s.theta_0[0] -= g.azimuth_offset
    np.add(s.theta_0[0], math.pi, out=s.theta_0[1])
    _wrap(s.theta_0, g.limits[0][2], pair_work)
    _wrap(s.theta_1, g.limits[1][2], s.work)
    _wrap(s.theta_2[2:], g.limits[2][2], pair_work)  # gamma needs no shift

    _fit(s.theta_0, g.limits[0], pair_work, s.fits[:2], s.wide[:2], near)
    s.fits[:2] &= s.found
    if not wrist_fits.all():
        s.fits[:2] &= wrist_fits
    s.fits[2:] = s.fits[:2]
    for theta, limits in ((s.theta_1, g.limits[1]), (s.theta_2, g.limits[2])):
        s.fits &= _fit(theta, limits, s.work, s.test, s.wide, near)

    # NaN in the other two angles of a branch that does not exist.
    np.multiply(half_gamma, 0.0, out=pair_work)
    s.theta_0 += pair_work
    pair_work += wrist
    for branch in range(4):
        pair = branch % 2
        q[:, branch, 0] = s.theta_0[pair]
        q[:, branch, 1] = s.theta_1[branch]
        q[:, branch, 2] = s.theta_2[branch]
        q[:, branch, 3] = pair_work[pair]
        exists[:, branch] = s.found[pair]
        within[:, branch] = s.fits[branch]
    return np.flatnonzero(near)


def _wrap(angle: FloatArray, middle: float, work: FloatArray) -> None:
    """Shift by full turns into the turn around the middle of a range, in place."""
    np.multiply(angle, 1 / math.tau, out=work)
    work -= middle / math.tau
    np.rint(work, out=work)
    work *= math.tau
    angle -= work


def _fit(
    angle: FloatArray,
    limits: tuple[float, float, float],
    work: FloatArray,
    fits: BoolArray,
    wide: BoolArray,
    near: BoolArray,
) -> BoolArray:
    """Which angles lie in a range; columns with one close to a limit are added to ``near``."""
    lower, upper, middle = limits
    half = (upper - lower) / 2
    np.subtract(angle, middle, out=work)
    np.abs(work, out=work)
    np.less(work, half - NEAR_LIMIT, out=fits)
    np.less(work, half + NEAR_LIMIT, out=wide)
    if np.count_nonzero(wide) != np.count_nonzero(fits):
        near |= (wide & ~fits).any(axis=0)
    return fits
