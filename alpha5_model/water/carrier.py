"""What the static trim of a vehicle depends on, and its table in files."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray, array, named, real
from alpha5_model._support.spatial import pose
from alpha5_model.errors import InputError
from alpha5_model.numbers import plausibility

#: Keys of a vehicle that must be there, and all of them.
_REQUIRED = ("mass", "com", "volume", "cob")
_KEYS = (*_REQUIRED, "xyz", "rpy")


class Carrier(NamedTuple):
    """What the trim of a vehicle depends on, in its own frame.

    Attributes:
        mass: [kg].
        com: Centre of mass, (3,) [m].
        volume: Displaced volume [m^3].
        cob: Centre of buoyancy, (3,) [m].
        mount: Pose of base_link, (4, 4).
    """

    mass: float
    com: FloatArray
    volume: float
    cob: FloatArray
    mount: FloatArray

    def lever(self, density: float) -> FloatArray:
        """Mass less displaced mass, each times its centre, (3,) [kg m].

        Args:
            density: Of the fluid [kg/m^3].
        """
        return self.mass * self.com - density * self.volume * self.cob


def read_carrier(place: str, given: Any) -> Carrier:
    """A table of a vehicle, in SI units.

    Args:
        place: Of the table, for messages.
        given: With ``mass``, ``com``, ``volume``, ``cob``, and the pose of base_link in
            ``xyz`` and ``rpy``.

    Raises:
        InputError: A missing key, or an invalid value, with its place.
        UnknownNameError: Another key.

    Warns:
        ImplausibleWarning: A value that seems to be in another unit.
    """
    if not isinstance(given, dict):
        raise InputError(place, given, f"a table with {', '.join(_REQUIRED)}")
    named(f"key of {place}", given, _KEYS)
    for key in _REQUIRED:
        if key not in given:
            keys = ", ".join(_REQUIRED)
            raise InputError(f"{place}.{key}", None, f"a value, one for each of {keys}")
    xyz = array(f"{place}.xyz", given.get("xyz", np.zeros(3)), 3)
    rpy = plausibility.angles(f"{place}.rpy", given.get("rpy", np.zeros(3)))
    plausibility.check(f"{place}.xyz", xyz, plausibility.VEHICLE_POSITION)
    carrier = Carrier(
        mass=real(f"{place}.mass", given["mass"], 0.0),
        com=array(f"{place}.com", given["com"], 3),
        volume=real(f"{place}.volume", given["volume"], 0.0),
        cob=array(f"{place}.cob", given["cob"], 3),
        mount=pose(xyz, rpy),
    )
    # The trim at rest does not depend on the inertia.
    plausibility.check_body(
        carrier.mass,
        carrier.com,
        np.zeros((3, 3)),
        carrier.volume,
        carrier.cob,
        prefix=f"{place}.",
        on_vehicle=True,
    )
    return carrier
