"""Principal moments and axes of a body's inertia, as MuJoCo and USD want them."""

from __future__ import annotations

import numpy as np

from alpha5_model._support.checks import FloatArray


def principal_axes(inertia: FloatArray) -> tuple[FloatArray, list[float]]:
    """Principal moments [kg m^2], and the quaternion (w, x, y, z) of their axes."""
    from scipy.spatial.transform import Rotation

    moments, axes = np.linalg.eigh(inertia)
    right_handed = axes * np.sign(np.linalg.det(axes))
    rotation = Rotation.from_matrix(right_handed)
    x, y, z, w = rotation.as_quat(canonical=True).tolist()
    # Adding zero turns a negative zero into zero.
    return moments, [w + 0.0, x + 0.0, y + 0.0, z + 0.0]
