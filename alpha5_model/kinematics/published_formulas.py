"""The inverse kinematics that the document prints, to the letter.

References:
    [ReachAlpha] Manufacturer's document, Sections 1.3 and 1.4.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, float_array
from alpha5_model.numbers.parameters import Alpha5Parameters


def published_inverse_kinematics(
    parameters: Alpha5Parameters, position: ArrayLike
) -> FloatArray:
    """theta_0, theta_1, theta_2 of the two published poses, (..., 2, 3) [rad].

    The first pose is underarm, the second overarm; NaN if the formulas have no value.
    The names are the document's.
    """
    target = float_array("position", position, (3,))
    x, y, z = np.moveaxis(target, -1, 0)
    a_0 = parameters.dh[0].a
    d_0 = parameters.dh[0].d
    a_2 = parameters.dh[2].a
    l_1 = parameters.dh[1].a
    l_2 = np.sqrt(a_2**2 + parameters.dh[3].d ** 2)

    theta = np.empty((*target.shape[:-1], 2, 3))
    underarm = theta[..., 0, :]
    overarm = theta[..., 1, :]
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        R = np.sqrt(x**2 + y**2)
        height = z - d_0
        azimuth = np.arctan2(y, x)
        underarm[..., 0] = azimuth + np.pi
        underarm[..., 1] = np.pi / 2 + np.arctan2(height, R - a_0)
        overarm[..., 0] = azimuth
        overarm[..., 1] = 3 * np.pi / 2 - np.arctan2(height, R + a_0)

        # The rest is printed alike for both.
        r = np.stack([R - a_0, R + a_0], axis=-1)
        l_3 = np.sqrt(r**2 + height[..., None] ** 2)
        offset = np.arcsin(2 * a_2 / l_1)
        theta[..., 1] -= _angle(l_1, l_3, opposite=l_2)
        theta[..., 1] -= offset
        theta[..., 2] = _angle(l_1, l_2, opposite=l_3)
        theta[..., 2] -= offset
        theta[..., 2] -= np.arcsin(a_2 / l_2)

    without_value = np.isnan(theta).any(axis=-1, keepdims=True)
    return np.where(without_value, np.nan, theta)


def _angle(
    one: float | FloatArray, other: float | FloatArray, opposite: float | FloatArray
) -> FloatArray:
    """The angle between two sides of a triangle, by the law of cosines."""
    cosine = (one**2 + other**2 - opposite**2) / (2 * one * other)
    return np.asarray(np.arccos(cosine))
