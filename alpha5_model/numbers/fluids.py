"""Densities of fluids, and gravity. NumPy only."""

from __future__ import annotations

from typing import Any, Literal

from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, array, is_rotation, real, shaped
from alpha5_model.errors import InputError
from alpha5_model.numbers import plausibility

#: Sea water of 35 g/kg near the surface [kg/m^3].
SEA_WATER = 1025.0
#: Fresh water [kg/m^3].
FRESH_WATER = 1000.0
#: No fluid at all [kg/m^3].
AIR = 0.0
#: Gravity with z up [m/s^2].
GRAVITY = (0.0, 0.0, -9.81)


#: The names of fluids, as on the command line and in files.
FLUIDS = {"sea": SEA_WATER, "fresh": FRESH_WATER, "air": AIR}
#: A density [kg/m^3], or a name.
Fluid = float | Literal["sea", "fresh", "air"]


def density_of(fluid_density: Any) -> float:
    """The density of a fluid [kg/m^3].

    Args:
        fluid_density: It, or a name of `FLUIDS`.

    Raises:
        InputError: No such name, and not a number of at least 0.

    Warns:
        ImplausibleWarning: No fluid has it; it may be in g/cm^3.
    """
    if isinstance(fluid_density, str):
        if fluid_density not in FLUIDS:
            expected = f"a density [kg/m^3], or {', '.join(FLUIDS)}"
            raise InputError("fluid_density", fluid_density, expected)
        return FLUIDS[fluid_density]
    density = real("fluid_density", fluid_density, minimum=0.0)
    plausibility.check("fluid_density", density, plausibility.FLUID_DENSITY)
    return density


def gravity_in_base(rotation: ArrayLike, gravity: ArrayLike = GRAVITY) -> FloatArray:
    """Gravity in a tilted mount or a vehicle, ``R^T g``, for ``load(gravity=...)``.

    Args:
        rotation: ``rotation_base_to_world``, (3, 3): the attitude of base_link; it maps
            coordinates in base_link to coordinates in the world.
        gravity: In the world, (3,) [m/s^2]; the default has z up, ``(0, 0, 9.81)`` is
            for NED.

    Returns:
        Gravity in base_link, (3,) [m/s^2].

    Raises:
        InputError: ``rotation`` is not a rotation, or gravity not three finite numbers.
    """
    r = shaped("rotation", rotation, (3, 3))
    g = array("gravity", gravity, 3)
    if not is_rotation(r):
        raise InputError(
            "rotation", r.tolist(), "a rotation: orthonormal rows, determinant +1"
        )
    return r.T @ g
