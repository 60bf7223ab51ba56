"""The document's own inverse kinematics, as printed (Sections 1.3 and 1.4)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray, float_array
from alpha5_model.parameters import parameters


def published_inverse_kinematics(position: ArrayLike) -> FloatArray:
    """The two poses that the document solves, by its formulas to the letter.

    No angle is wrapped, no limit checked, and the wrist is not mentioned there; `inverse_kinematics`
    gives all four solutions with flags.

    Args:
        position: tcp in ``base_link``, (..., 3) [m].

    Returns:
        theta_0, theta_1, theta_2 of the underarm pose (Section 1.3) and the overarm pose (Section
        1.4), (..., 2, 3) [rad]; NaN where the formulas have no value.

    Raises:
        InputError: Not real numbers of that shape; `NonFiniteError` names a bad row.
    """
    target = float_array("position", position, (3,))
    dh = parameters().dh
    a_0, a_1, a_2, d_0, d_3 = dh[0].a, dh[1].a, dh[2].a, dh[0].d, dh[3].d
    x, y, z = np.moveaxis(target, -1, 0)
    l_1, l_2 = a_1, np.sqrt(a_2**2 + d_3**2)
    out = np.empty((*target.shape[:-1], 2, 3))
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        R = np.sqrt(x**2 + y**2)
        underarm, overarm = np.arctan2(z - d_0, R - a_0), np.arctan2(z - d_0, R + a_0)
        out[..., 0, 0] = np.arctan2(y, x) + np.pi
        out[..., 0, 1] = np.pi / 2 + underarm
        out[..., 1, 0] = np.arctan2(y, x)
        out[..., 1, 1] = 3 * np.pi / 2 - overarm
        # The rest is printed alike for both.
        l_3 = np.sqrt(np.stack([R - a_0, R + a_0], axis=-1) ** 2 + (z - d_0)[..., None] ** 2)
        out[..., 1] -= np.arccos((l_1**2 + l_3**2 - l_2**2) / (2 * l_1 * l_3))
        out[..., 1] -= np.arcsin(2 * a_2 / l_1)
        out[..., 2] = (
            np.arccos((l_1**2 + l_2**2 - l_3**2) / (2 * l_1 * l_2))
            - np.arcsin(2 * a_2 / l_1)
            - np.arcsin(a_2 / l_2)
        )
    return np.where(np.isnan(out).any(axis=-1, keepdims=True), np.nan, out)
