"""Principal moments and axes of a body's inertia, as MuJoCo and USD want them."""

from __future__ import annotations

from itertools import permutations, product

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import cross_matrix
from alpha5_model.description.digits import quaternion, rounded

#: Moments that differ by less, relative to the largest, are equal: files have 12
#: digits.
_EQUAL = 1e-11
#: Turns from the body's axes that differ by less are the same, as a difference of
#: traces.
_SAME_TURN = 1e-9


def principal_axes(inertia: FloatArray) -> tuple[FloatArray, list[float]]:
    """Principal moments [kg m^2], and the quaternion (w, x, y, z) of their axes.

    The axes are those nearest to the body's own, by the angle between them; moment i
    belongs to the axis near axis i of the body. If moments are equal, so that axes are
    arbitrary, these too are as near as possible. Both have 12 digits.
    """
    moments, axes = np.linalg.eigh(inertia)
    equal = np.diff(moments) < _EQUAL * moments[2]
    if equal.all():
        nearest = np.eye(3)
    elif equal.any():
        nearest = _nearest_about(axes[:, 2 if equal[0] else 0])
    else:
        nearest = _nearest(axes)

    of_axes = np.diag(nearest.T @ inertia @ nearest)
    return rounded(of_axes), quaternion(nearest)


def _nearest(axes: FloatArray) -> FloatArray:
    """The rotation with these columns, in another order and with signs, next to 1.

    Of several that are equally near, the one whose first axis is nearest to x, and then
    the one whose second axis is nearest to y.
    """
    candidates = []
    for order in permutations(range(3)):
        for signs in product((1.0, -1.0), repeat=3):
            rotation = axes[:, order] * signs
            if np.linalg.det(rotation) > 0:
                candidates.append(rotation)

    def nearness(rotation: FloatArray) -> tuple[float, ...]:
        parts = np.array([np.trace(rotation), *rotation.ravel()])
        return tuple(np.round(parts / _SAME_TURN).tolist())

    return max(candidates, key=nearness)


def _nearest_about(axis: FloatArray) -> FloatArray:
    """The smallest rotation that turns a coordinate axis into the line of an axis."""
    sizes = np.round(np.abs(axis) / _SAME_TURN)
    i = int(np.argmax(sizes))
    unit = np.eye(3)[i]
    target = axis if axis[i] > 0 else -axis
    k = cross_matrix(np.cross(unit, target))
    return np.asarray(np.eye(3) + k + k @ k / (1.0 + target[i]))
