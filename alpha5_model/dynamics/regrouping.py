"""From an arm as Pinocchio has it to the base parameters of the symbolic equations."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from alpha5_model.base_parameters import base_parameters
from alpha5_model.checks import FloatArray
from alpha5_model.errors import InputError
from alpha5_model.parameters import RigidBody

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm


def arm_parameters(arm: Arm) -> FloatArray:
    """Values of `BASE_PARAMETERS` of an arm with its fluid, gravity and payloads, (41,).

    Raises:
        InputError: Its base floats, or its jaws move.
    """
    model = arm.model
    if arm.floating_base or model.nv != 4:
        raise InputError("arm", arm, "one on a fixed base with its jaws locked")
    bodies = []
    for name, inertia in zip(model.names, model.inertias, strict=True):
        displaced = [d for d in arm.displacements if d.joint == name and d.volume]
        volume = sum(d.volume for d in displaced)
        cob = sum((d.volume * d.cob for d in displaced), np.zeros(3)) / (volume or 1.0)
        bodies.append(RigidBody(name, inertia.mass, inertia.lever, inertia.inertia, volume, cob))
    return base_parameters(bodies, arm.fluid_density, model.gravity.linear)
