"""Cubic splines through points, without SciPy, whose import takes half a second.

The inverse kinematics need the shapes of the fingers, to see self-collision.
"""

from __future__ import annotations

import numpy as np

from alpha5_model._support.checks import FloatArray


def cubic_spline(knots: FloatArray, values: FloatArray, at: FloatArray) -> FloatArray:
    """A cubic spline whose third derivative does not jump at the outermost inner knots.

    [deBoor2001] A Practical Guide to Splines, chapter IV: "not-a-knot".

    Args:
        knots: Increasing, at least four, (K,).
        values: At the knots, (K, D).
        at: Places between the first and the last knot, (N,).

    Returns:
        (N, D).
    """
    step = np.diff(knots)
    slope = np.diff(values, axis=0) / step[:, None]
    derivative = np.linalg.solve(*_conditions(knots, step, slope))

    piece = np.searchsorted(knots[1:-1], at, side="right")
    past = (at - knots[piece])[:, None]
    width = step[piece][:, None]
    start, end = derivative[piece], derivative[piece + 1]
    bend = (start + end - 2.0 * slope[piece]) / width
    second = (slope[piece] - start) / width - bend
    return np.asarray(
        values[piece] + past * (start + past * (second + past * bend / width))
    )


def _conditions(
    knots: FloatArray, step: FloatArray, slope: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Linear equations of the derivatives at the knots: (K, K) and (K, D)."""
    count = len(knots)
    matrix = np.zeros((count, count))
    right = np.empty((count, slope.shape[1]))
    for k in range(1, count - 1):
        matrix[k, k - 1 : k + 2] = step[k], 2.0 * (step[k - 1] + step[k]), step[k - 1]
        right[k] = 3.0 * (step[k] * slope[k - 1] + step[k - 1] * slope[k])

    both = step[0] + step[1]
    matrix[0, :2] = step[1], both
    first = (step[0] + 2.0 * both) * step[1] * slope[0] + step[0] ** 2 * slope[1]
    right[0] = first / both

    both = step[-2] + step[-1]
    matrix[-1, -2:] = both, step[-2]
    last = step[-1] ** 2 * slope[-2] + (step[-1] + 2.0 * both) * step[-2] * slope[-1]
    right[-1] = last / both
    return matrix, right
