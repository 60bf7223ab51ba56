"""What the kernels take beside a state: base parameters, then dimensions."""

from __future__ import annotations

from typing import Any

import numpy as np

import alpha5_model as a5
from alpha5_model.codegen.regrouping import base_parameters
from alpha5_model.kinematics.geometry import Geometry

#: Of the catalogue's arm.
DIMENSIONS = Geometry.of(a5.parameters()).dimensions


def kernel_inputs(links: Any, *water: Any) -> np.ndarray:
    """Of bodies on the catalogue's joints; ``water`` is density, then gravity."""
    base = base_parameters(links, *water, parameters=a5.parameters())
    return np.append(base, DIMENSIONS)
