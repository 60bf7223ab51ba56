"""Plausible ranges of the arm's quantities, and the warning about other values.

An impossible value, such as a negative mass, raises an error elsewhere. A value that is
possible, but was most likely given in another unit, causes an `ImplausibleWarning` that
names that unit. In an arm file it is an error. Objects warn when they are made, and
methods when they are given joint positions.

Each range has its reason beside it. The ranges are wide, so that everything passes that
a user may mean.
"""

from __future__ import annotations

import math
import sys
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from types import FrameType

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import MOST_ANGLE, FloatArray, array
from alpha5_model.errors import ImplausibleWarning, InputError


@dataclass(frozen=True)
class Plausible:
    """The plausible values of one quantity.

    Attributes:
        unit: SI unit.
        ranges: Closed ranges of the magnitude; 0 is plausible in any case.
        units: Other units that people use -> their size in SI units, the likeliest
            first.
    """

    unit: str
    ranges: tuple[tuple[float, float], ...]
    units: Mapping[str, float] = field(default_factory=dict)

    def holds(self, magnitude: float) -> bool:
        """Whether a magnitude is plausible."""
        inside = (low <= magnitude <= high for low, high in self.ranges)
        return magnitude == 0 or any(inside)

    @property
    def expected(self) -> str:
        """The ranges in words."""
        words = [
            f"{low:g} to {high:g}" if low else f"at most {high:.4g}"
            for low, high in self.ranges
        ]
        return f"{' or '.join(words)} {self.unit}"


_MM = {"mm": 1e-3, "cm": 1e-2}
_LITRES = {"L": 1e-3, "cm^3": 1e-6, "mm^3": 1e-9}
_GRAMS = {"g": 1e-3}

#: Ideal gas at 1 atm: 1.40 kg/m^3 at -20 °C, 1.11 at 45 °C. Liquids: pentane has 626
#: kg/m^3, the heaviest drilling fluids have 2400.
FLUID_DENSITY = Plausible("kg/m^3", ((1.1, 1.4), (500.0, 2500.0)), {"g/cm^3": 1e3})
#: The Moon has 1.62 m/s^2, Jupiter 24.8.
GRAVITY = Plausible(
    "m/s^2", ((1.5, 25.0),), {"mm/s^2": 1e-3, "cm/s^2": 1e-2, "g": 9.81}
)
#: 20 kg at the arm's reach of 0.5 m take 98 N m: the shoulder stalls at about that,
#: from 24 V and without any limit of its current.
MASS = Plausible("kg", ((0.0, 20.0),), _GRAMS)
#: What a scale shows may be a tenth of the arm's mass off, where it tells little.
SCALE_NOISE = Plausible("kg", ((0.0, 0.1),), _GRAMS)
#: The plate on the scales is about 0.3 m wide.
PLACEMENT = Plausible("m", ((0.0, 0.05),), _MM)
#: Four times the arm's reach: the middle of a pole of 4 m.
POSITION = Plausible("m", ((0.0, 2.0),), _MM)
#: A buoy of this volume lifts with 1000 N: at 0.5 m, five times what the shoulder's
#: motor can hold.
VOLUME = Plausible("m^3", ((0.0, 0.1),), _LITRES)
#: Radius of gyration; a pole of 3.5 m has 1 m about its middle.
GYRATION = Plausible(
    "m",
    ((0.0, 1.0),),
    {"kg mm^2": 1e-3, "g cm^2": 1e-7**0.5, "g mm^2": 1e-9**0.5},
)
#: Mean density of a body: the lightest foam has 10 kg/m^3, osmium 22590.
BODY_DENSITY = Plausible("kg/m^3", ((10.0, 23000.0),))
#: Density of a material, from balsa to osmium.
SOLID_DENSITY = Plausible("kg/m^3", ((100.0, 23000.0),), {"g/cm^3": 1e3})
#: The heaviest remotely operated vehicles have about 10 t, displace their own weight
#: and are 5 m long. A neutral one has 1000 kg/m^3; an empty frame of steel, or a boat,
#: is within a factor of 10.
VEHICLE_MASS = Plausible("kg", ((0.0, 2e4),), _GRAMS)
VEHICLE_VOLUME = Plausible("m^3", ((0.0, 20.0),), _LITRES)
VEHICLE_DENSITY = Plausible("kg/m^3", ((100.0, 1e4),))
VEHICLE_POSITION = Plausible("m", ((0.0, 5.0),), _MM)
#: Smallest extent of a mesh around the arm: most test tanks are shallower.
POOL = Plausible("m", ((0.0, 20.0),), _MM)
#: The jaws are 0.1 m long.
JAW_LENGTH = Plausible("m", ((0.0, 0.5),), _MM)
#: Two turns either way.
ANGLE = Plausible("rad", ((0.0, MOST_ANGLE),), {"deg": math.pi / 180})
#: The joints are rated at a twelfth of a turn a second, reached with 50 rad/s^2 in
#: 10 ms. The public models have 9 N m; the shoulder stalls at about 98.
JOINT: Mapping[str, Plausible] = {
    "lower": ANGLE,
    "upper": ANGLE,
    "velocity": Plausible("rad/s", ((0.0, 4 * math.pi),), {"deg/s": math.pi / 180}),
    "acceleration": Plausible("rad/s^2", ((0.0, 50.0),), {"deg/s^2": math.pi / 180}),
    "effort": Plausible("N m", ((0.0, 98.0),), {"N mm": 1e-3}),
}
#: A hundred times the jaw rod's 3 mm/s and the 10 N of the public models.
ROD: Mapping[str, Plausible] = {
    "lower": JAW_LENGTH,
    "upper": JAW_LENGTH,
    "velocity": Plausible("m/s", ((0.0, 0.3),), {"mm/s": 1e-3}),
    "acceleration": Plausible("m/s^2", ((0.0, 3.0),), {"mm/s^2": 1e-3}),
    "effort": Plausible("N", ((0.0, 1000.0),), {"mN": 1e-3}),
}
#: The fastest tidal currents have 10 m/s.
WATER_VELOCITY = Plausible("m/s", ((0.0, 10.0),), {"cm/s": 1e-2, "mm/s": 1e-3})
#: A hundred times Table 4's largest numbers, in the units that it prints.
RESISTANCE = Plausible("Ohm", ((0.0, 4000.0),), {"mOhm": 1e-3})
INDUCTANCE = Plausible("H", ((0.0, 0.13),), {"mH": 1e-3, "uH": 1e-6})
MOTOR_FRICTION = Plausible("N m", ((0.0, 0.4),), {"mN m": 1e-3})
MOTOR_CONSTANT = Plausible("N m/A", ((0.0, 2.7),), {"mN m/A": 1e-3})
#: At 100 rad/s of the motor, the largest plausible friction.
VISCOUS_FRICTION = Plausible("N m s/rad", ((0.0, 0.01),), {"mN m s/rad": 1e-3})
#: A rotor of 0.2 kg, more than one of the arm's motors, and a radius of 1 cm. Makers
#: print g cm^2.
ROTOR_INERTIA = Plausible(
    "kg m^2", ((0.0, 1e-5),), {"g cm^2": 1e-7, "kg mm^2": 1e-6, "g mm^2": 1e-9}
)
#: Ten times the 24 V of the arm's supply.
SUPPLY_VOLTAGE = Plausible("V", ((0.0, 240.0),), {"mV": 1e-3})
#: The arm's largest motor stalls with 7.5 A at 24 V; ten times as much.
CURRENT_LIMIT = Plausible("A", ((0.0, 75.0),), {"mA": 1e-3})
#: The slowest controllers of an arm run at a few hertz.
TIME_STEP = Plausible("s", ((0.0, 1.0),), {"ms": 1e-3, "us": 1e-6})
#: At rated speed, a joint needs 12 s for a full turn; fifty times as long.
SETTLING_TIME = Plausible("s", ((0.0, 600.0),), {"ms": 1e-3})
#: Of a control loop; the longest link through satellites is shorter.
LOOP_DELAY = Plausible("s", ((0.0, 10.0),), {"ms": 1e-3})
#: The jaw rod travels 12 mm.
SCREW_LEAD = Plausible("m", ((0.0, 0.1),), {"mm": 1e-3})

#: The file that the numbers come from, if they do.
_file: ContextVar[str] = ContextVar("file", default="")
_silent: ContextVar[bool] = ContextVar("silent", default=False)
#: Packages whose frames a warning skips: it points at the line that called them.
_PASSED = ("alpha5_model", "dataclasses", "copy", "contextlib")


def check(
    name: str,
    value: ArrayLike,
    plausible: Plausible,
) -> None:
    """Warn of an implausible quantity; refuse it if it stands in a file.

    Args:
        name: Of the argument.
        value: A number, or a vector whose length counts, in SI units.
        plausible: Its plausible values.

    Raises:
        InputError: The value is implausible and stands in a file (`of_file`).

    Warns:
        ImplausibleWarning: The value is implausible.
    """
    given = np.asarray(value, dtype=np.float64)
    if plausible.holds(_magnitude(given)):
        return
    expected = plausible.expected
    for unit, size in plausible.units.items():
        if plausible.holds(_magnitude(given * size)):
            expected += f"; if it is in {unit}, write {_written(given * size)}"
            break
    if _file.get():
        raise InputError(name, given.tolist(), expected)
    message = f"{name}: {_written(given)} {plausible.unit} is implausible"
    warn(f"{message}, expected {expected}")


def _magnitude(value: FloatArray) -> float:
    """Length of a vector, or magnitude of a number; it may be huge."""
    return math.hypot(*value.ravel().tolist())


def check_largest(name: str, values: FloatArray, plausible: Plausible) -> None:
    """`check` the largest of some finite numbers (...), such as joint positions."""
    if values.ndim == 0:
        largest = abs(values.item())
    else:
        largest = float(np.abs(values).max(initial=0.0))
    if not plausible.holds(largest):
        check(name, float(values.flat[np.abs(values).argmax()]), plausible)


def angles(name: str, value: ArrayLike) -> FloatArray:
    """Three angles (3,) [rad], with a warning if they are more likely in degrees.

    Raises:
        InputError: Not three finite numbers.

    Warns:
        ImplausibleWarning: They are implausible.
    """
    given = array(name, value, 3)
    check(name, given, ANGLE)
    return given


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
    sizes = [("volume", unit, size, 1 / size) for unit, size in _LITRES.items()]
    sizes += [("mass", unit, size, size) for unit, size in _GRAMS.items()]
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
    source = f"{_file.get()}: " if _file.get() else ""
    warnings.warn(source + message, ImplausibleWarning, stacklevel=level)


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
def of_file(path: object) -> Iterator[None]:
    """A context for numbers of a file: warnings name it, other units are refused."""
    token = _file.set(str(path))
    try:
        yield
    finally:
        _file.reset(token)


def _written(value: FloatArray) -> str:
    numbers = ", ".join(f"{x:.6g}" for x in value.ravel())
    return f"({numbers})" if value.ndim else numbers
