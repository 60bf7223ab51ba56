"""What surrounds the arm: fluid densities and the direction of gravity. NumPy only."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray, float_array
from alpha5_model.errors import InputError
from alpha5_model.fluids import AIR, FRESH_WATER, GRAVITY, SEA_WATER

__all__ = ["AIR", "FRESH_WATER", "GRAVITY", "SEA_WATER", "gravity_in_base"]

#: How far from a rotation a matrix may be, entrywise, before it is refused.
_ROTATION_TOLERANCE = 1e-6


def gravity_in_base(rotation: ArrayLike, gravity: ArrayLike = GRAVITY) -> FloatArray:
    """Gravity seen from a tilted mount or a vehicle, ``R^T g``, for ``load(gravity=...)``.

    Args:
        rotation: ``rotation_base_to_world``, (3, 3): the attitude of base_link; it maps coordinates
            in base_link to coordinates in the world.
        gravity: In the world, (3,) [m/s^2]; the default has z up, ``(0, 0, 9.81)`` is for NED.

    Returns:
        Gravity in base_link, (3,) [m/s^2].

    Raises:
        InputError: ``rotation`` is not a rotation.
    """
    r = float_array("rotation", rotation, (3, 3))
    g = float_array("gravity", gravity, (3,))
    if r.shape != (3, 3) or g.shape != (3,):
        raise InputError("rotation", r.shape, "one rotation (3, 3) and one gravity vector (3,)")
    if np.abs(r @ r.T - np.eye(3)).max() > _ROTATION_TOLERANCE or np.linalg.det(r) < 0:
        raise InputError("rotation", r.tolist(), "a rotation: orthonormal rows, determinant +1")
    return r.T @ g
