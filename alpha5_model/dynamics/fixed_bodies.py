"""Bodies fixed to the universe: link_0 on a fixed base.

Pinocchio leaves them out of its sums. `FixedBodies` has what to add.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray

if TYPE_CHECKING:
    import pinocchio as pin


class FixedBodies(NamedTuple):
    """The share of the fixed bodies in the sums over a whole arm.

    Attributes:
        moving_fraction: Mass of the moving bodies over that of the whole arm, (3,).
        com: What the fixed bodies add to the arm's centre of mass, (3,) [m].
        load: Wrench that holds them in the fluid, a pin.Force in base_link.
        potential_energy: Of their weight and buoyancy [J].
    """

    moving_fraction: FloatArray
    com: FloatArray
    load: Any
    potential_energy: float


def fixed_bodies(model: pin.Model, net: pin.Model) -> FixedBodies:
    """The share of the bodies fixed to the universe.

    Args:
        model: pin.Model of the arm.
        net: pin.Model of weight less buoyancy.
    """
    of_moving = moving_mass(model)
    fixed = model.inertias[0]
    total_mass = of_moving + fixed.mass

    gravity = model.gravity
    net_body = net.inertias[0]
    return FixedBodies(
        moving_fraction=np.full(3, of_moving / total_mass),
        com=fixed.lever * (fixed.mass / total_mass),
        load=net_body * -gravity,
        potential_energy=float(-net_body.mass * (gravity.linear @ net_body.lever)),
    )


def moving_mass(model: pin.Model) -> float:
    """Mass of all that is not fixed to the universe [kg]."""
    return float(sum(inertia.mass for inertia in list(model.inertias)[1:]))
