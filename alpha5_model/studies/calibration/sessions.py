"""What was measured: one sensor in one fluid, in some states; and the file of it.

`alpha5 calibrate plan` writes the file, people fill it in::

    format = 1
    sensor = "scales"
    fluid = "air"                     # or fresh, sea, a density [kg/m^3]
    gravity = [0.0, 0.0, -9.81]       # in base_link [m/s^2]
    unit = "g"                        # of the readings
    [settings]                        # arguments of the sensor, SI units
    positions = [[0.18, 0.0, -0.03], [-0.09, 0.156, -0.03], [-0.09, -0.156, -0.03]]
    [[pose]]
    angles = [10.0, 90.0, 120.0, 0.0] # as the joints report them [deg]
    readings = [512, 431, 329]
    rates = [0.0, 3.0, 0.0, 0.0]      # of an arm that moves [deg/s]
    accelerations = [0.0, 0.0, 0.0, 0.0]
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from inspect import signature
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    FloatArray,
    array,
    choice,
    float_array,
    frozen,
    instance,
    named,
    shaped,
)
from alpha5_model._support.files import PathLike, read_named
from alpha5_model._support.toml import toml_tables
from alpha5_model.errors import Alpha5Error, FileFormatError, InputError, ShapeError
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.fluids import AIR, FLUIDS, Fluid, density_of
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.studies.calibration.sensor import Sensor
from alpha5_model.studies.calibration.sensors import SENSORS

#: States of one session at most; a file of them has fewer than `_LARGEST` bytes.
MOST_STATES = 5000
_LARGEST = 1 << 22
#: A larger number in a file is a typing error.
_LARGEST_NUMBER = 1e9
#: The version of the keys.
FORMAT = 1
#: Keys of a file.
_KEYS = ("format", "sensor", "fluid", "gravity", "unit", "settings", "pose")
#: Keys of a pose that hold a number for each joint, in degrees.
_OF_JOINTS = ("angles", "rates", "accelerations")


@dataclass(frozen=True, eq=False)
class Session:
    """Readings of one sensor in one fluid; make one with `session`.

    Attributes:
        sensor: What was read.
        density: Of the fluid [kg/m^3].
        q: Joint positions as the joints report them, (N, 4) [rad].
        v, a: Their rates, (N, 4) each [rad/s, rad/s^2].
        gravity: In base_link, (3,) [m/s^2].
        readings: In the sensor's units, (N, k); NaN for what is not read.
        name: For messages, for example its file's.
    """

    sensor: Sensor
    density: float
    q: FloatArray
    v: FloatArray
    a: FloatArray
    gravity: FloatArray
    readings: FloatArray
    name: str = "session"

    @property
    def is_read(self) -> bool:
        """Whether there is any reading."""
        return bool(np.isfinite(self.readings).any())

    @property
    def moves(self) -> bool:
        """Whether a joint moves."""
        return bool(self.v.any() or self.a.any())


def session(
    sensor: Sensor,
    q: ArrayLike,
    readings: ArrayLike | None = None,
    *,
    fluid_density: Fluid = AIR,
    v: ArrayLike | None = None,
    a: ArrayLike | None = None,
    gravity: ArrayLike | None = None,
    name: str = "session",
) -> Session:
    """Readings of one sensor in one fluid.

    Args:
        sensor: What is read.
        q: Joint positions as the joints report them, (N, 4) [rad].
        readings: In the sensor's units, (N, k); NaN for one that is missing. None for
            poses that are only planned.
        fluid_density: [kg/m^3], or a name as for `alpha5_model.load`.
        v, a: Rates of joints that move, (N, 4); None for an arm at rest. Then the rows
            are in the order of time.
        gravity: In base_link, (3,) [m/s^2]. None for that of a level mount, or of a
            level vehicle whose tilt is read.
        name: For messages.

    Raises:
        InputError: Not such numbers, more than 5000 states, scales that do not lie
            level, or an arm that moves on a vehicle whose tilt is read.
    """
    chosen = instance("sensor", sensor, Sensor)  # type: ignore[type-abstract]
    positions = float_array("q", q, (4,))
    if positions.ndim != 2 or not 0 < len(positions) <= MOST_STATES:
        expected = f"1 to {MOST_STATES} states, (N, 4)"
        raise ShapeError("q", positions.shape, expected)
    plausibility.check("q", np.abs(positions).max(), plausibility.ANGLE)
    if gravity is None:
        pull = chosen.usual_gravity()
    else:
        pull = array("gravity", gravity, 3)
        plausibility.check_gravity(gravity, pull)
    shape = positions.shape
    made = Session(
        sensor=chosen,
        density=density_of(fluid_density),
        q=positions,
        v=np.zeros(shape) if v is None else shaped("v", v, shape),
        a=np.zeros(shape) if a is None else shaped("a", a, shape),
        gravity=frozen(pull.copy()),
        readings=frozen(np.full((len(positions), chosen.size), np.nan)),
        name=name,
    )
    chosen.check(made.gravity, made.density, made.moves)
    return made if readings is None else with_readings(made, readings)


def with_readings(planned: Session, readings: ArrayLike) -> Session:
    """The same states with readings (N, k); NaN for one that is missing.

    Raises:
        InputError: Not a session, or not such numbers.
    """
    states = instance("planned", planned, Session)
    shape = states.readings.shape
    is_plain = isinstance(readings, list | tuple) or type(readings) is np.ndarray
    try:
        given = np.asarray(readings) if is_plain else None
    except ValueError:  # of no one shape; `shaped` says so
        given = None
    if given is None or given.dtype.kind != "f":
        found = shaped("readings", readings, shape)
    else:
        gaps = np.isnan(given)
        found = shaped("readings", np.where(gaps, 0.0, given), shape).copy()
        found[gaps] = np.nan
    states.sensor.check_readings(found)
    return replace(states, readings=frozen(found))


# --- the file -------------------------------------------------------------------------


def session_text(planned: Session, arm: Alpha5Parameters | None = None) -> str:
    """The text of a file of states, with their readings if there are any.

    `read_session` reads it again, all numbers to ten digits.

    Args:
        planned: The states.
        arm: Record of the arm, whose joints report angles with its signs; None for the
            catalogue's.
    """
    signs = chosen_arm(arm).signs[:4]
    sensor = planned.sensor
    unit, size = next(iter(sensor.units.items()))
    names = {density: f'"{fluid}"' for fluid, density in FLUIDS.items()}
    lines = [
        *(f"# {line}" for line in sensor.guide),
        "# Then: alpha5 calibrate fit THIS_FILE --output my_arm.toml",
        f"format = {FORMAT}",
        f'sensor = "{sensor.kind}"',
        f"fluid = {names.get(planned.density, repr(planned.density))}"
        "  # air, fresh, sea or kg/m^3",
        f"gravity = {_toml(planned.gravity)}  # in base_link (m/s^2)",
        f'unit = "{unit}"  # of the readings',
        "",
        "[settings]  # SI units; noise, gain and so on are standard deviations",
    ]
    by_one_number = _by_one_number(sensor)
    tables = []
    for name, value in sensor.settings().items():
        if isinstance(value, Mapping):
            tables += ["", f"[settings.{name}]"]
            tables += [f"{key} = {_toml(one)}" for key, one in value.items()]
            continue
        same_for_all = name in by_one_number and (value == value[0]).all()
        lines.append(f"{name} = {_toml(value[0] if same_for_all else value)}")
    lines += tables

    joints = ", ".join(JOINT_NAMES[:4])
    channels = ", ".join(sensor.channels)
    angles, rates, accelerations = (
        signs * np.degrees(one) for one in (planned.q, planned.v, planned.a)
    )
    readings = planned.readings / size
    if sensor.by_joint:
        readings = signs * readings
    for k, row in enumerate(readings):
        known = np.isfinite(row).any()
        lines += [
            "",
            f"[[pose]]  # {k + 1} of {len(readings)}",
            f"angles = {_toml(angles[k])}  # {joints} (deg)",
            f"readings = {_toml(row) if known else '[]'}  # {channels} ({unit})",
        ]
        if planned.moves:
            lines.append(f"rates = {_toml(rates[k])}  # deg/s")
            lines.append(f"accelerations = {_toml(accelerations[k])}  # deg/s^2")
    return "\n".join(lines) + "\n"


def _by_one_number(sensor: Sensor) -> tuple[str, ...]:
    """Names of the settings (k,) that one number for all may stand for.

    Their arguments have one number as default; a direction, say, has three.
    """
    if sensor.kind not in SENSORS:
        return ()
    arguments = signature(SENSORS[sensor.kind]).parameters
    return tuple(
        name
        for name, value in sensor.settings().items()
        if np.ndim(value) == 1 and isinstance(arguments[name].default, int | float)
    )


def read_session(path: PathLike, arm: Alpha5Parameters | None = None) -> Session:
    """The session of a file, its angles and readings in SI units.

    Args:
        path: As `session_text` makes it.
        arm: Record of the arm, whose joints report angles with its signs; None for the
            catalogue's.

    Raises:
        MissingFileError: No such file.
        FileFormatError: Not TOML, an unknown key, or a value that cannot be. The
            message names file, pose and key.
    """
    content = read_named(path, "a file of poses and readings (TOML)", _LARGEST)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise FileFormatError(path, "expected TOML, which is UTF-8 text") from None
    tables = toml_tables(text, str(path))
    try:
        return _session_of(tables, str(path), chosen_arm(arm).signs[:4])
    except Alpha5Error as error:
        raise FileFormatError(path, str(error)) from None


def _session_of(given: Mapping[str, Any], name: str, signs: FloatArray) -> Session:
    """The session that tables of a file say, with the joints' signs (4,)."""
    named("key", given, _KEYS)
    for key in ("format", "sensor", "pose"):
        if key not in given:
            raise InputError(key, None, "a value")
    if given["format"] != FORMAT or isinstance(given["format"], bool):
        raise InputError("format", given["format"], f"{FORMAT}, for this version")
    make = SENSORS[choice("sensor", given["sensor"], tuple(SENSORS))]
    sensor = _sensor(make, given.get("settings", {}))
    unit = given.get("unit", next(iter(sensor.units)))
    size = sensor.units[choice("unit", unit, tuple(sensor.units))]
    fluid = given.get("fluid", "air")
    if isinstance(fluid, str):
        choice("fluid", fluid, tuple(FLUIDS))

    poses = given["pose"]
    if not isinstance(poses, list) or not 0 < len(poses) <= MOST_STATES:
        raise InputError("pose", type(poses).__name__, f"1 to {MOST_STATES} [[pose]]")
    states = []
    readings = []
    for number, pose in enumerate(poses, 1):
        place = f"pose {number}"
        if not isinstance(pose, dict):
            raise InputError(place, pose, "a table")
        named(f"key of {place}", pose, (*_OF_JOINTS, "readings"))
        if "angles" not in pose:
            raise InputError(f"{place}: angles", None, "a value")
        of_joints = []
        for key in _OF_JOINTS:
            of_one = pose.get(key, [0.0] * 4)
            of_joints.append(_numbers(f"{place}: {key}", of_one, JOINT_NAMES[:4]))
        states.append(of_joints)
        read = pose.get("readings", [])
        if read == []:
            read = [np.nan] * sensor.size
        key = f"{place}: readings"
        readings.append(_numbers(key, read, sensor.channels, gaps=True))
    q, v, a = signs * np.radians(states).swapaxes(0, 1)
    in_si = size * np.array(readings)
    return session(
        sensor,
        q,
        signs * in_si if sensor.by_joint else in_si,
        fluid_density=fluid,
        v=v,
        a=a,
        gravity=given.get("gravity"),
        name=name,
    )


def _sensor(make: Callable[..., Sensor], settings: Any) -> Sensor:
    """The sensor of some settings; errors name the setting."""
    if not isinstance(settings, dict):
        raise InputError("settings", settings, "a table")
    arguments = signature(make).parameters
    named("key of settings", settings, tuple(arguments))
    for name, argument in arguments.items():
        if argument.default is argument.empty and name not in settings:
            raise InputError(f"settings: {name}", None, "a value")
    try:
        return make(**settings)
    except InputError as error:
        place = f"settings: {error.name}"
        raise InputError(place, error.value, error.expected) from None


def _numbers(
    place: str, given: Any, names: tuple[str, ...], gaps: bool = False
) -> list[float]:
    """One number for each name; NaN only for gaps."""
    expected = f"{len(names)} numbers: {', '.join(names)}"
    if not isinstance(given, list) or len(given) != len(names):
        raise InputError(place, given, expected)
    for one in given:
        is_number = isinstance(one, int | float) and not isinstance(one, bool)
        is_gap = gaps and is_number and one != one
        if not is_gap and not (is_number and abs(one) < _LARGEST_NUMBER):
            raise InputError(place, one, expected)
    return [float(one) for one in given]


def _toml(value: Any) -> str:
    """A truth, a text, a number to ten digits, or lists of them as TOML."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if np.ndim(value):
        return f"[{', '.join(_toml(one) for one in np.asarray(value).tolist())}]"
    # Adding zero turns a negative zero into zero.
    return "nan" if np.isnan(value) else f"{value + 0.0:.10g}"
