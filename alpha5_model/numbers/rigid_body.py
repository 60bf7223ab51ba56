"""A rigid body in the water: mass and displaced volume in its own frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from alpha5_model._support.checks import FloatArray, array, frozen, real
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.inertia import check_possible, combine


@dataclass(frozen=True, eq=False)
class RigidBody:
    """Mass and displaced water of one body, in its own frame.

    Attributes:
        name: As the link of the URDF.
        mass: [kg].
        com: Centre of mass, (3,) [m].
        inertia: At the COM, URDF sign, (3, 3) [kg m^2].
        volume: Displaced volume [m^3].
        cob: Centre of buoyancy, (3,) [m].

    Raises:
        InputError: A negative mass or volume, or an inertia that no body can have.

    Warns:
        ImplausibleWarning: Numbers that seem to be in another unit.
    """

    #: Whether a mass without any inertia, a point, is possible.
    _may_be_a_point: ClassVar[bool] = False

    name: str
    mass: float
    com: FloatArray
    inertia: FloatArray
    volume: float
    cob: FloatArray

    def __post_init__(self) -> None:
        mass = real(f"{self.name}.mass", self.mass, minimum=0.0)
        com = frozen(array(f"{self.name}.com", self.com, 3))
        inertia = frozen(array(f"{self.name}.inertia", self.inertia, 3, 3))
        volume = real(f"{self.name}.volume", self.volume, minimum=0.0)
        cob = frozen(array(f"{self.name}.cob", self.cob, 3))
        if not self._may_be_a_point or np.any(inertia):
            check_possible(f"{self.name}.inertia", mass, com, inertia)
        plausibility.check_body(mass, com, inertia, volume, cob, f"{self.name}.")
        object.__setattr__(self, "mass", mass)
        object.__setattr__(self, "com", com)
        object.__setattr__(self, "inertia", inertia)
        object.__setattr__(self, "volume", volume)
        object.__setattr__(self, "cob", cob)


def joined(name: str, bodies: Sequence[RigidBody]) -> RigidBody:
    """One body of several that are rigidly joined, all given in one frame.

    Args:
        name: Of the result.
        bodies: At least one, with a mass.

    Raises:
        InputError: Their masses add up to zero.
    """
    masses = [body.mass for body in bodies]
    coms = [body.com for body in bodies]
    inertias = [body.inertia for body in bodies]
    mass, com, inertia = combine(masses, coms, inertias)

    volumes = np.array([body.volume for body in bodies])
    volume = float(volumes.sum())
    cob = com
    if volume:
        cob = volumes @ np.array([body.cob for body in bodies]) / volume
    return RigidBody(
        name=name,
        mass=mass,
        com=com,
        inertia=(inertia + inertia.T) / 2,
        volume=volume,
        cob=cob,
    )
