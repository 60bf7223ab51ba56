"""Inverse kinematics of many targets: blocks of rows with NumPy, in scratch that is made once."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from alpha5_model.checks import BoolArray, FloatArray
from alpha5_model.kinematics import edges
from alpha5_model.kinematics.ik import one
from alpha5_model.kinematics.plane import arm_plane
from alpha5_model.spatial import wrap

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
        `alpha5_model.kinematics.ik.Solutions`.
    """
    lead = position.shape[:-1]
    position = position.reshape(-1, 3)
    rows = len(position)
    if wrist.ndim:
        wrist = np.broadcast_to(wrist, lead).reshape(rows)
    q, singular = np.empty((rows, 4, 4)), np.zeros(rows, np.bool_)
    exists, within = np.empty((rows, 4), np.bool_), np.empty((rows, 4), np.bool_)
    scratch = np.empty((24, min(BLOCK, rows)))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        fixed = None if wrist.ndim else _wrist(wrist)
        for start in range(0, rows, BLOCK):
            part = slice(start, start + BLOCK)
            target, theta_3 = position[part], fixed or _wrist(wrist[part])
            near = _solve_block(scratch, target, theta_3, (q[part], exists[part], within[part]))
            for row in near.tolist():
                (x, y, z), at = target[row].tolist(), start + row
                angle = float(theta_3[0][row] if wrist.ndim else theta_3[0])
                q[at], exists[at], within[at], singular[at], _ = one.careful_answer(x, y, z, angle)
    return (
        q.reshape(*lead, 4, 4),
        exists.reshape(*lead, 4),
        within.reshape(*lead, 4),
        singular.reshape(lead),
    )


def _wrist(wrist: FloatArray) -> tuple[FloatArray, BoolArray]:
    """theta_3 in its range, and whether it fits; rounding beside a limit is removed."""
    lower, upper, middle = arm_plane().limits[3]
    angle = wrap(wrist, middle)
    clipped = np.clip(angle, lower, upper)
    fits = np.abs(angle - clipped) <= edges.LIMIT_TOLERANCE
    return np.where(fits, clipped, angle), fits


def _solve_block(
    scratch: FloatArray,
    target: FloatArray,
    wrist: tuple[FloatArray, BoolArray],
    out: tuple[FloatArray, BoolArray, BoolArray],
) -> NDArray[np.intp]:
    """The formulas of `alpha5_model.kinematics.ik` on one block, in scratch (24, its rows or more).

    Returns:
        The rows that are near an edge, whose solution is not to be relied on.
    """
    # Axes: the two elbows, the plane's two ways to face, rows.
    g, (q, exists, within), scratch = arm_plane(), out, scratch[:, : len(target)]
    x, y, h, radius = scratch[:4]
    r, above, below, theta_0 = scratch[4:12].reshape(4, 2, -1)
    theta_1, theta_2, work = scratch[12:].reshape(3, 2, 2, -1)
    (half_gamma, flipped_2), (tangent, alpha) = theta_2, work

    # The target in the plane that faces it and in the plane that faces away.
    scratch[:3] = target.T
    h -= g.d_0
    np.multiply(x, x, out=radius)
    np.multiply(y, y, out=work[0, 0])
    radius += work[0, 0]
    np.sqrt(radius, out=radius)
    near = radius < edges.NEAR_AXIS
    np.subtract(radius, g.a_0, out=r[0])
    np.subtract(-g.a_0, radius, out=r[1])
    np.multiply(r, r, out=below)
    np.multiply(h, h, out=work[0, 0])
    below += work[0, 0]
    np.subtract(g.squares[0], below, out=above)
    below -= g.squares[1]
    # above + below = 4 l_1 l_2 > 0: the product is positive within reach and small at its edges.
    np.multiply(above, below, out=work[0])
    found = work[0] > 0.0
    np.abs(work[0], out=work[0])
    near |= (work[0] < edges.NEAR_EDGE * 4 * g.l_1 * g.l_2).any(axis=0)

    # Where a target is out of reach, the root is NaN and so is what follows.
    np.divide(below, above, out=tangent)
    np.sqrt(tangent, out=tangent)
    np.arctan(tangent, out=half_gamma)
    np.divide(g.k, tangent, out=tangent)
    np.arctan(tangent, out=alpha)
    alpha -= half_gamma
    alpha += math.pi / 2
    np.arctan2(h, r, out=theta_1[0])
    theta_1[0] -= g.phi_offset
    np.add(theta_1[0], alpha, out=theta_1[1])
    theta_1[0] -= alpha
    half_gamma *= 2.0
    np.subtract(2 * math.pi - g.gamma_offset, half_gamma, out=flipped_2)
    half_gamma -= g.gamma_offset
    np.arctan2(y, x, out=theta_0[0])
    theta_0[0] -= g.azimuth_offset
    np.add(theta_0[0], math.pi, out=theta_0[1])
    _wrap(theta_0, g.middle[0], work[0])
    _wrap(theta_1, g.middle[1], work)
    _wrap(flipped_2, g.middle[2], work[0])  # gamma needs no shift

    fits = np.array([found, found])
    if not wrist[1].all():
        fits &= wrist[1]
    for theta, (lower, upper, middle) in zip(
        (theta_0[None], theta_1, theta_2), g.limits[:3], strict=True
    ):
        off, half = work[: len(theta)], (upper - lower) / 2
        np.subtract(theta, middle, out=off)
        np.abs(off, out=off)
        inside, close = off < half - edges.NEAR_LIMIT, off < half + edges.NEAR_LIMIT
        if np.count_nonzero(close) != np.count_nonzero(inside):
            near |= (close & ~inside).any(axis=(0, 1))
        fits &= inside

    # NaN in the other two angles of a branch that does not exist.
    theta_3 = np.multiply(half_gamma, 0.0, out=work[0])
    theta_0 += theta_3
    theta_3 += wrist[0]
    for branch in range(4):
        elbow, pair = divmod(branch, 2)
        q[:, branch, 0] = theta_0[pair]
        q[:, branch, 1] = theta_1[elbow, pair]
        q[:, branch, 2] = theta_2[elbow, pair]
        q[:, branch, 3] = theta_3[pair]
        exists[:, branch], within[:, branch] = found[pair], fits[elbow, pair]
    return np.flatnonzero(near)


def _wrap(angle: FloatArray, middle: float, work: FloatArray) -> None:
    """Shift by full turns into the turn around the middle of a range, in place."""
    np.multiply(angle, 1 / math.tau, out=work)
    work -= middle / math.tau
    np.rint(work, out=work)
    work *= math.tau
    angle -= work
