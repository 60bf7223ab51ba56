"""Plausible ranges of the arm's quantities, and the warning about other values.

An impossible value, such as a negative mass, raises an error elsewhere. A value that is
possible, but was most likely given in another unit, causes an `ImplausibleWarning` that
names that unit. Objects warn when they are made; methods that compute never warn.

Each range has its reason beside it. The ranges are wide, so that everything passes that
a user may mean.
"""

from __future__ import annotations

import math
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from types import FrameType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray
from alpha5_model.errors import ImplausibleWarning


@dataclass(frozen=True)
class Plausible:
    """The plausible values of one quantity.

    Attributes:
        unit: SI unit.
        ranges: Closed ranges of the magnitude; 0 is plausible in any case.
        expected: The ranges in words.
        units: Other units that people use -> their size in SI units, the likeliest
            first.
    """

    unit: str
    ranges: tuple[tuple[float, float], ...]
    expected: str
    units: Mapping[str, float] = field(default_factory=dict)

    def holds(self, magnitude: float) -> bool:
        """Whether a magnitude is plausible."""
        inside = (low <= magnitude <= high for low, high in self.ranges)
        return magnitude == 0 or any(inside)


_LENGTHS = {"mm": 1e-3, "cm": 1e-2}
_VOLUMES = {"L": 1e-3, "cm^3": 1e-6, "mm^3": 1e-9}
_MASSES = {"g": 1e-3}
_ANGLES = {"deg": math.pi / 180}

#: Ideal gas at 1 atm: 1.40 kg/m^3 at -20 °C, 1.11 at 45 °C. Liquids: pentane has 626
#: kg/m^3, the heaviest drilling fluids have 2400.
FLUID_DENSITY = Plausible(
    unit="kg/m^3",
    ranges=((1.1, 1.4), (500.0, 2500.0)),
    expected="500 to 2500 for a liquid, 1.1 to 1.4 for air, 0 for no fluid",
    units={"g/cm^3": 1e3},
)
#: The Moon has 1.62 m/s^2, Jupiter 24.8.
GRAVITY = Plausible(
    unit="m/s^2",
    ranges=((1.5, 25.0),),
    expected="1.5 to 25, or 0",
    units={"mm/s^2": 1e-3, "cm/s^2": 1e-2, "g": 9.81},
)
#: 20 kg at the arm's reach of 0.5 m take 98 N m: the shoulder stalls at about that,
#: from 24 V and without any limit of its current.
MASS = Plausible(
    unit="kg", ranges=((0.0, 20.0),), expected="at most 20 on this arm", units=_MASSES
)
#: Four times the arm's reach: the middle of a pole of 4 m.
POSITION = Plausible(
    unit="m", ranges=((0.0, 2.0),), expected="at most 2 on this arm", units=_LENGTHS
)
#: A buoy of this volume lifts with 1000 N: at 0.5 m, five times what the shoulder's
#: motor can hold.
VOLUME = Plausible(
    unit="m^3", ranges=((0.0, 0.1),), expected="at most 0.1 on this arm", units=_VOLUMES
)
#: Radius of gyration; a pole of 3.5 m has 1 m about its middle.
GYRATION = Plausible(
    unit="m",
    ranges=((0.0, 1.0),),
    expected="at most 1 on this arm",
    units={"kg mm^2": 1e-3, "g cm^2": 1e-7**0.5, "g mm^2": 1e-9**0.5},
)
#: Mean density of a body: the lightest foam has 10 kg/m^3, osmium 22590.
BODY_DENSITY = Plausible(
    unit="kg/m^3", ranges=((10.0, 23000.0),), expected="10 to 23000"
)
#: Density of a material, from balsa to osmium.
SOLID_DENSITY = Plausible(
    unit="kg/m^3",
    ranges=((100.0, 23000.0),),
    expected="100 to 23000 for a solid",
    units={"g/cm^3": 1e3},
)
#: The heaviest remotely operated vehicles have about 10 t and displace their own
#: weight.
VEHICLE_MASS = Plausible(
    unit="kg",
    ranges=((0.0, 2e4),),
    expected="at most 20000 for a vehicle",
    units=_MASSES,
)
VEHICLE_VOLUME = Plausible(
    unit="m^3",
    ranges=((0.0, 20.0),),
    expected="at most 20 for a vehicle",
    units=_VOLUMES,
)
#: A neutral vehicle has 1000 kg/m^3. An empty frame of steel, or a boat, is within a
#: factor of 10.
VEHICLE_DENSITY = Plausible(
    unit="kg/m^3", ranges=((100.0, 1e4),), expected="100 to 10000 for a vehicle"
)
#: The heaviest vehicles are 5 m long.
VEHICLE_POSITION = Plausible(
    unit="m", ranges=((0.0, 5.0),), expected="at most 5 for a vehicle", units=_LENGTHS
)
#: Two turns either way.
ANGLE = Plausible(
    unit="rad",
    ranges=((0.0, 4 * math.pi),),
    expected="at most two turns",
    units=_ANGLES,
)
#: Two turns a second; the arm's joints are rated at a twelfth of a turn.
ANGULAR_SPEED = Plausible(
    unit="rad/s",
    ranges=((0.0, 4 * math.pi),),
    expected="at most two turns a second",
    units={"deg/s": math.pi / 180},
)
#: The jaws are 0.1 m long.
JAW_LENGTH = Plausible(
    unit="m", ranges=((0.0, 0.5),), expected="at most 0.5 for the jaws", units=_LENGTHS
)
#: The fastest tidal currents have 10 m/s.
CURRENT = Plausible(
    unit="m/s",
    ranges=((0.0, 10.0),),
    expected="at most 10 for a current",
    units={"cm/s": 1e-2, "mm/s": 1e-3},
)
#: A hundred times Table 4's largest numbers, in the units that it prints.
RESISTANCE = Plausible(
    unit="Ohm", ranges=((0.0, 4000.0),), expected="at most 4000", units={"mOhm": 1e-3}
)
INDUCTANCE = Plausible(
    unit="H",
    ranges=((0.0, 0.13),),
    expected="at most 0.13",
    units={"mH": 1e-3, "uH": 1e-6},
)
MOTOR_FRICTION = Plausible(
    unit="N m",
    ranges=((0.0, 0.4),),
    expected="at most 0.4 at a motor",
    units={"mN m": 1e-3},
)
MOTOR_CONSTANT = Plausible(
    unit="N m/A", ranges=((0.0, 2.7),), expected="at most 2.7", units={"mN m/A": 1e-3}
)
#: A rotor of 1 kg and a radius of 5 cm.
ROTOR_INERTIA = Plausible(
    unit="kg m^2",
    ranges=((0.0, 1.3e-3),),
    expected="at most 0.0013 for a small motor",
    units={"kg mm^2": 1e-6, "g cm^2": 1e-7, "g mm^2": 1e-9},
)
#: Ten times the 24 V of the arm's supply.
SUPPLY_VOLTAGE = Plausible(
    unit="V", ranges=((0.0, 240.0),), expected="at most 240", units={"mV": 1e-3}
)
#: The arm's largest motor stalls with 7.5 A at 24 V; ten times as much.
CURRENT_LIMIT = Plausible(
    unit="A", ranges=((0.0, 75.0),), expected="at most 75", units={"mA": 1e-3}
)
#: The jaw rod travels 12 mm.
SCREW_LEAD = Plausible(
    unit="m", ranges=((0.0, 0.1),), expected="at most 0.1 per turn", units={"mm": 1e-3}
)

_silent: ContextVar[bool] = ContextVar("silent", default=False)
#: Before each message: the file that the numbers come from.
_prefix: ContextVar[str] = ContextVar("prefix", default="")
#: Packages whose frames a warning skips: it points at the line that called them.
_PASSED = ("alpha5_model", "dataclasses", "copy", "contextlib")


def check(
    name: str,
    value: ArrayLike,
    plausible: Plausible,
    magnitude: Callable[[Any], Any] | None = None,
) -> None:
    """Warn of an implausible quantity.

    Args:
        name: Of the argument.
        value: A number, or a vector whose length counts, in SI units.
        plausible: Its plausible values.
        magnitude: From the value to the number that is compared; None for its length.

    Warns:
        ImplausibleWarning: The value is implausible.
    """
    measured = magnitude or _length
    if plausible.holds(float(measured(value))):
        return
    given = np.asarray(value, dtype=np.float64)
    message = f"{name}: {_written(given)} {plausible.unit} is implausible"
    message += f", expected {plausible.expected}"
    for unit, size in plausible.units.items():
        if plausible.holds(float(measured(given * size))):
            message += f"; if it is in {unit}, write {_written(given * size)}"
            break
    warn(message)


def check_body(
    mass: float,
    com: FloatArray,
    inertia: FloatArray,
    volume: float,
    cob: FloatArray,
    prefix: str = "",
    on_vehicle: bool = False,
) -> None:
    """Warn of implausible numbers of a body, of the arm or of its vehicle.

    Args:
        mass: [kg].
        com, cob: In the body's frame, (3,) [m].
        inertia: At the COM, (3, 3) [kg m^2].
        volume: [m^3].
        prefix: Before the names of the quantities in the message.
        on_vehicle: Whether it is the vehicle's body.

    Warns:
        ImplausibleWarning: One of them is implausible.
    """
    far = VEHICLE_POSITION if on_vehicle else POSITION
    check(f"{prefix}mass", mass, VEHICLE_MASS if on_vehicle else MASS)
    check(f"{prefix}com", com, far)
    if not np.array_equal(cob, com):
        check(f"{prefix}cob", cob, far)
    _check_volume(prefix, mass, volume, on_vehicle)
    _check_inertia(prefix, mass, inertia, far if on_vehicle else GYRATION)


def _check_volume(prefix: str, mass: float, volume: float, on_vehicle: bool) -> None:
    """Warn of an implausible volume, alone or beside a mass that is plausible."""
    volumes = VEHICLE_VOLUME if on_vehicle else VOLUME
    masses = VEHICLE_MASS if on_vehicle else MASS
    densities = VEHICLE_DENSITY if on_vehicle else BODY_DENSITY
    check(f"{prefix}volume", volume, volumes)
    alone = not (mass and volume)
    if alone or not (volumes.holds(volume) and masses.holds(mass)):
        return
    density = mass / volume
    if densities.holds(density):
        return
    message = (
        f"{prefix}volume: {volume:.6g} m^3 of {mass:.6g} kg is {density:.4g} kg/m^3"
    )
    message += f", implausible, expected {densities.expected}"
    sizes = [("volume", unit, size, 1 / size) for unit, size in _VOLUMES.items()]
    sizes += [("mass", unit, size, size) for unit, size in _MASSES.items()]
    for name, unit, size, factor in sizes:
        if densities.holds(density * factor):
            given = volume if name == "volume" else mass
            message += f"; if the {name} is in {unit}, write {given * size:.6g}"
            break
    warn(message)


def _check_inertia(
    prefix: str, mass: float, inertia: FloatArray, limits: Plausible
) -> None:
    """Warn of an inertia whose radius of gyration is implausible."""
    if not mass:
        return
    radius = math.sqrt(np.trace(inertia) / 2 / mass)
    if limits.holds(radius):
        return
    message = f"{prefix}inertia: a radius of gyration of {radius:.4g} m is implausible"
    message += f", expected {limits.expected}"
    for unit, scale in GYRATION.units.items():
        if limits.holds(radius * scale):
            message += f"; if it is in {unit}, multiply it by {scale**2:.0e}"
            break
    warn(message)


def check_gravity(given: ArrayLike, gravity: FloatArray) -> None:
    """Warn of implausible gravity.

    A tuple or list that points straight up was written by hand, and is most likely
    meant to point down. An array was computed, for example by `gravity_in_base`, and
    may point anywhere.

    Args:
        given: The user's argument.
        gravity: The same as an array, (3,) [m/s^2].

    Warns:
        ImplausibleWarning: Its strength, or its direction, is implausible.
    """
    check("gravity", gravity, GRAVITY)
    x, y, z = gravity.tolist()
    if z > 0 and x == y == 0 and not isinstance(given, np.ndarray):
        warn(
            f"gravity: {_written(gravity)} m/s^2 points up; write (0, 0, {-z:.6g}), "
            "or, if the arm hangs or the world's z points down, "
            "give the rotation of its mount (gravity_in_base; --mount)"
        )


def hints(text: str, value: float, plausible: Plausible) -> list[str]:
    """What to write in place of an implausible number on the command line.

    Args:
        text: As it was typed.
        value: Its value in SI units.
        plausible: Its plausible values.

    Returns:
        Empty if the number is plausible, or is not in the next unit either.
    """
    unit, size = next(iter(plausible.units.items()))
    if plausible.holds(abs(value)) or not plausible.holds(abs(value * size)):
        return []
    return [f"if {text} is in {unit}, write {text}{unit}"]


def warn(message: str) -> None:
    """Give an `ImplausibleWarning` at the line that called the package."""
    if _silent.get():
        return
    level = 1
    frame = sys._getframe()
    while frame.f_back and _package_of(frame) in _PASSED:
        level += 1
        frame = frame.f_back
    warnings.warn(_prefix.get() + message, ImplausibleWarning, stacklevel=level)


def _package_of(frame: FrameType) -> str:
    """Name of the package whose code a frame runs."""
    module: str = frame.f_globals.get("__name__", "")
    return module.partition(".")[0]


@contextmanager
def silenced() -> Iterator[None]:
    """A context without warnings, for numbers that were checked before."""
    token = _silent.set(True)
    try:
        yield
    finally:
        _silent.reset(token)


@contextmanager
def prefixed(text: str) -> Iterator[None]:
    """A context whose warnings start with a text, such as the name of a file."""
    token = _prefix.set(text)
    try:
        yield
    finally:
        _prefix.reset(token)


def _length(value: ArrayLike) -> Any:
    return np.linalg.norm(value)


def _written(value: FloatArray) -> str:
    numbers = ", ".join(f"{x:.6g}" for x in value.ravel())
    return f"({numbers})" if value.ndim else numbers
