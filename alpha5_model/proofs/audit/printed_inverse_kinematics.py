"""The inverse kinematics that the document prints, to the letter.

References:
    [ReachAlpha] Manufacturer's document, Sections 1.3 and 1.4.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, float_array
from alpha5_model.numbers.parameters import parameters


def published_inverse_kinematics(position: ArrayLike) -> FloatArray:
    """The two poses that the document solves, by its formulas to the letter.

    The formulas wrap no angle, check no limit and leave out the wrist.
    `alpha5_model.inverse_kinematics` gives all four solutions with flags. The names are
    the document's.

    Args:
        position: tcp in ``base_link``, (..., 3) [m].

    Returns:
        theta_0, theta_1, theta_2 of the underarm pose (Section 1.3) and the overarm
        pose (Section 1.4), (..., 2, 3) [rad]; NaN if the formulas have no value.

    Raises:
        InputError: Not real numbers of that shape; `NonFiniteError` names a bad row.
    """
    target = float_array("position", position, (3,))
    x, y, z = np.moveaxis(target, -1, 0)
    dh = parameters().dh
    a_0 = dh[0].a
    d_0 = dh[0].d
    a_2 = dh[2].a
    l_1 = dh[1].a
    l_2 = np.sqrt(a_2**2 + dh[3].d ** 2)

    theta = np.empty((*target.shape[:-1], 2, 3))
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        R = np.sqrt(x**2 + y**2)
        height = z - d_0
        theta[..., 0, 0] = np.arctan2(y, x) + np.pi
        theta[..., 0, 1] = np.pi / 2 + np.arctan2(height, R - a_0)
        theta[..., 1, 0] = np.arctan2(y, x)
        theta[..., 1, 1] = 3 * np.pi / 2 - np.arctan2(height, R + a_0)

        # The rest is printed alike for both.
        r = np.stack([R - a_0, R + a_0], axis=-1)
        l_3 = np.sqrt(r**2 + height[..., None] ** 2)
        offset = np.arcsin(2 * a_2 / l_1)
        theta[..., 1] -= _angle(l_1, l_3, opposite=l_2) + offset
        theta[..., 2] = _angle(l_1, l_2, opposite=l_3) - offset - np.arcsin(a_2 / l_2)

    without_value = np.isnan(theta).any(axis=-1, keepdims=True)
    return np.where(without_value, np.nan, theta)


def _angle(
    one: float | FloatArray, other: float | FloatArray, opposite: float | FloatArray
) -> FloatArray:
    """The angle between two sides of a triangle, by the law of cosines."""
    cosine = (one**2 + other**2 - opposite**2) / (2 * one * other)
    return np.asarray(np.arccos(cosine))
