"""What several topics share."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from alpha5_model.fluids import GRAVITY as DOWN

if TYPE_CHECKING:
    from alpha5_model.checks import FloatArray

MM = 1e-3
GRAVITY = abs(DOWN[2])  # m/s^2


def excess_of_box(point: FloatArray, bounds: FloatArray) -> float:
    """Distance of a point (3,) from a box (3, 2); 0 inside."""
    outside = np.maximum(np.maximum(bounds[:, 0] - point, point - bounds[:, 1]), 0.0)
    return float(np.linalg.norm(outside))
