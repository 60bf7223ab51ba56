"""Inverse kinematics of many targets: blocks of rows with NumPy, in scratch that is made once."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from alpha5_model.checks import FloatArray
from alpha5_model.kinematics.ik_one import LIMIT_TOLERANCE, Constants, constants, solve_one

BoolArray = NDArray[np.bool_]

#: Rows per block: the scratch, about 1 MB, stays in the processor's cache.
BLOCK = 4096

#: Rows closer than this to the yaw axis [m], or to the edge of reach [m^2, in rho^2], go to
#: `solve_one`, which knows how rounding grows there.
NEAR_AXIS = 1e-3
NEAR_EDGE = 1e-5

_TAU = 2 * math.pi


def solve_rows(
    position: FloatArray,
    wrist: FloatArray,
    q: FloatArray,
    exists: BoolArray,
    within: BoolArray,
    singular: BoolArray,
) -> None:
    """Solve finite targets into the arrays given.

    Args:
        position: (N, 3) [m].
        wrist: () or (N,) [rad].
        q: Output, (N, 4, 4).
        exists, within: Output, (N, 4).
        singular: Output, (N,).
    """
    constant = constants()
    scratch = _Scratch(min(BLOCK, len(position)))
    singular[...] = False
    with np.errstate(divide="ignore", invalid="ignore"):
        for start in range(0, len(position), BLOCK):
            part = slice(start, start + BLOCK)
            target, angle = position[part], wrist if wrist.ndim == 0 else wrist[part]
            if len(target) != scratch.rows:
                scratch = _Scratch(len(target))
            near = _solve_block(constant, scratch, target, angle, q[part], exists[part], within[part])
            for row in near:
                at = start + int(row)
                solution = solve_one(*target[row].tolist(), float(angle if angle.ndim == 0 else angle[row]))
                q[at] = np.reshape(solution[0], (4, 4))
                exists[at], within[at], singular[at] = solution[1:]


class _Scratch:
    """Arrays of one block. First axis: the plane's two ways to face, or the four branches."""

    def __init__(self, rows: int) -> None:
        self.rows = rows
        self.radius = np.empty(rows)
        self.height = np.empty(rows)
        self.r = np.empty((2, rows))
        self.above = np.empty((2, rows))
        self.below = np.empty((2, rows))
        self.theta_0 = np.empty((2, rows))
        self.theta_1 = np.empty((4, rows))
        self.theta_2 = np.empty((4, rows))
        self.theta_3 = np.empty((2, rows))
        self.work = np.empty((4, rows))
        self.found = np.empty((2, rows), np.bool_)
        self.fits = np.empty((4, rows), np.bool_)
        self.test = np.empty((4, rows), np.bool_)
        self.near = np.empty(rows, np.bool_)


def _solve_block(
    c: Constants,
    s: _Scratch,
    target: FloatArray,
    wrist: FloatArray,
    q: FloatArray,
    exists: BoolArray,
    within: BoolArray,
) -> NDArray[np.intp]:
    """The formulas of `alpha5_model.kinematics.ik` on one block.

    Returns:
        The rows that are near a singularity, whose solution is not to be relied on.
    """
    x, y = target[:, 0], target[:, 1]
    h, r, above, below = s.height, s.r, s.above, s.below
    pair_work, pair_test = s.work[:2], s.test[:2]

    # The target in the plane that faces it and in the plane that turns its back to it.
    np.subtract(target[:, 2], c.d_0, out=h)
    np.multiply(x, x, out=s.radius)
    np.multiply(y, y, out=pair_work[0])
    s.radius += pair_work[0]
    np.sqrt(s.radius, out=s.radius)
    np.subtract(s.radius, c.a_0, out=r[0])
    np.subtract(-c.a_0, s.radius, out=r[1])
    np.multiply(r, r, out=below)
    np.multiply(h, h, out=pair_work[0])
    below += pair_work[0]
    np.subtract(c.longest_2, below, out=above)
    below -= c.shortest_2
    np.greater_equal(above, 0.0, out=s.found)
    s.found &= np.greater_equal(below, 0.0, out=pair_test)

    # theta_0, one turn above the lower end of the window around its range.
    np.arctan2(y, x, out=s.theta_0[0])
    s.theta_0[0] -= c.azimuth_offset
    np.add(s.theta_0[0], math.pi, out=s.theta_0[1])
    _wrap(s.theta_0, c.limits[0][2], pair_work)

    # theta_1, theta_2. Where the target is out of reach, the root is NaN and so is what follows.
    np.arctan2(h, r, out=s.theta_1[:2])
    s.theta_1[:2] -= c.phi_offset
    tangent, half_gamma, alpha = s.work[:2], s.theta_2[:2], s.work[2:]
    np.divide(below, above, out=tangent)
    np.sqrt(tangent, out=tangent)
    np.arctan(tangent, out=half_gamma)
    np.divide(c.k, tangent, out=tangent)
    np.arctan(tangent, out=alpha)
    alpha -= half_gamma
    alpha += math.pi / 2
    np.add(s.theta_1[:2], alpha, out=s.theta_1[2:])
    s.theta_1[:2] -= alpha
    half_gamma *= 2.0
    np.negative(half_gamma, out=s.theta_2[2:])
    s.theta_2 -= c.gamma_offset
    _wrap(s.theta_1, c.limits[1][2], s.work)
    _wrap(s.theta_2, c.limits[2][2], s.work)

    # NaN in the other two angles of a branch that does not exist.
    np.multiply(half_gamma, 0.0, out=pair_work)
    s.theta_0 += pair_work
    np.add(pair_work, wrist, out=s.theta_3)
    _wrap(s.theta_3, c.limits[3][2], pair_work)

    s.fits[:2] = s.found
    s.fits[2:] = s.found
    for theta, limits in zip((s.theta_1, s.theta_2), c.limits[1:3], strict=True):
        s.fits &= _fit(theta, limits, s.work, s.test)
    for theta, limits in zip((s.theta_0, s.theta_3), (c.limits[0], c.limits[3]), strict=True):
        pair_fits = _fit(theta, limits, pair_work, pair_test)
        s.fits[:2] &= pair_fits
        s.fits[2:] &= pair_fits

    q[:, :2, 0] = s.theta_0.T
    q[:, 2:, 0] = s.theta_0.T
    q[:, :, 1] = s.theta_1.T
    q[:, :, 2] = s.theta_2.T
    q[:, :2, 3] = s.theta_3.T
    q[:, 2:, 3] = s.theta_3.T
    exists[:, :2] = s.found.T
    exists[:, 2:] = s.found.T
    within[...] = s.fits.T

    near = np.less(s.radius, NEAR_AXIS, out=s.near)
    for gap in (above, below):
        np.abs(gap, out=pair_work)
        np.less(pair_work, NEAR_EDGE, out=pair_test)
        near |= pair_test[0]
        near |= pair_test[1]
    return np.flatnonzero(near)


def _wrap(angle: FloatArray, middle: float, work: FloatArray) -> None:
    """Shift by full turns into the turn around the middle of a range, in place."""
    np.multiply(angle, 1 / _TAU, out=work)
    work -= middle / _TAU
    np.rint(work, out=work)
    work *= _TAU
    angle -= work


def _fit(
    angle: FloatArray, limits: tuple[float, float, float], work: FloatArray, out: BoolArray
) -> BoolArray:
    """Which angles lie in a range; those that rounding put beside a limit are moved onto it."""
    lower, upper, middle = limits
    half = (upper - lower) / 2
    np.subtract(angle, middle, out=work)
    np.abs(work, out=work)
    clear = np.count_nonzero(np.less(work, half - LIMIT_TOLERANCE, out=out))
    np.less_equal(work, half + LIMIT_TOLERANCE, out=out)
    if np.count_nonzero(out) != clear:
        angle[out] = np.clip(angle[out], lower, upper)
    return out
