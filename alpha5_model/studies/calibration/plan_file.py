"""A file of poses and readings: `alpha5 calibrate plan` writes it, people fill it in.

::

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
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import PathLike, read_named
from alpha5_model._support.spatial import rpy_from_rotation
from alpha5_model._support.toml import toml_tables
from alpha5_model.errors import Alpha5Error, FileFormatError
from alpha5_model.numbers.fluids import AIR, FRESH_WATER, SEA_WATER
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.studies.calibration.sensors import (
    ANY_MASS,
    Sensor,
    efforts,
    force_torque,
    scales,
    weight,
)
from alpha5_model.studies.calibration.sessions import Session, session
from alpha5_model.studies.calibration.tilt_sensor import vehicle_tilt

#: The version of the keys.
FORMAT = 1
#: Kind of sensor -> the function that makes it, and its settings.
SENSORS: Mapping[str, tuple[Callable[..., Sensor], tuple[str, ...]]] = {
    "scales": (scales, ("positions", "noise", "gain", "placement", "zeroed")),
    "weight": (weight, ("noise", "gain", "zeroed")),
    "force-torque": (force_torque, ("force_noise", "torque_noise", "gain")),
    "efforts": (efforts, ("noise", "gain", "offset")),
    "vehicle-tilt": (vehicle_tilt, ("vehicle", "noise", "gain", "offset", "yaw")),
}
#: Unit of readings -> its size; the first is the one of a new file.
UNITS: Mapping[str, Mapping[str, float]] = {
    "scales": {"g": 1e-3, "kg": 1.0},
    "weight": {"g": 1e-3, "kg": 1.0},
    "force-torque": {"N, N m": 1.0},
    "efforts": {"N m": 1.0, "mN m": 1e-3},
    "vehicle-tilt": {"deg": np.pi / 180, "rad": 1.0},
}
#: Name of a fluid -> its density [kg/m^3].
FLUIDS = {"air": AIR, "fresh": FRESH_WATER, "sea": SEA_WATER}
_KEYS = ("format", "sensor", "fluid", "gravity", "unit", "settings", "pose")
_POSE = ("angles", "readings")
_LARGEST = 1 << 18
_MOST_POSES = 2000
_HEAD = {
    "scales": (
        "Set the arm on a plate on three scales, and the scales on a firm table. The",
        "positions are where the plate rests on them, in base_link. Move to each pose,",
        "wait until the scales are still, and write what they show. If a joint reports",
        "another angle, correct it. Write nan for a reading that you missed.",
    ),
    "weight": ("Set the arm on one scale and write what it shows in each pose.",),
    "force-torque": (
        "Mount the arm on the sensor. Write its readings in the axes and about the",
        "origin of base_link in each pose, averaged over a second or more.",
    ),
    "efforts": (
        "Write the torques of the joints, without friction: the mean of those after",
        "coming from above and from below.",
    ),
    "vehicle-tilt": (
        "Let the vehicle float without thrust. Move to each pose, wait until it is",
        "still, and write its roll and pitch: turns about fixed axes, x forward, y to",
        "the left, z up.",
    ),
}


def session_text(planned: Session, arm: Alpha5Parameters | None = None) -> str:
    """The text of a file of poses, with their readings if there are any.

    Args:
        planned: The poses.
        arm: Record of the arm, whose joints report angles with its signs; None for the
            catalogue's.
    """
    signs = chosen_arm(arm).signs[:4]
    sensor = planned.sensor
    kind = sensor.kind
    unit, size = next(iter(UNITS[kind].items()))
    lines = [
        *(f"# {line}" for line in _HEAD[kind]),
        "# Then: alpha5 calibrate fit THIS_FILE --output my_arm.toml",
        f"format = {FORMAT}",
        f'sensor = "{kind}"',
        f"fluid = {_fluid(planned.density)}  # air, fresh, sea or kg/m^3",
        *_gravity(planned),
        f'unit = "{unit}"  # of the readings',
        "",
        "[settings]  # SI units; noise, gain and so on are standard deviations",
        *_settings(sensor),
    ]
    joints = ", ".join(JOINT_NAMES[:4])
    channels = ", ".join(sensor.channels)
    degrees = signs * np.degrees(planned.motion.q)
    rows = zip(degrees, _of_driver(sensor, signs, planned.readings) / size, strict=True)
    for number, (angles, readings) in enumerate(rows, 1):
        known = np.isfinite(readings).any()
        lines += [
            "",
            f"[[pose]]  # {number} of {len(degrees)}",
            f"angles = {_list(np.round(angles, 2))}  # {joints} (deg)",
            f"readings = {_list(readings) if known else '[]'}  # {channels} ({unit})",
        ]
    return "\n".join(lines) + "\n"


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
    signs = chosen_arm(arm).signs[:4]
    reader = _Reader(path, toml_tables(text, str(path)), signs)
    return reader.session()


def _of_driver(sensor: Sensor, signs: FloatArray, readings: FloatArray) -> FloatArray:
    """Readings in the directions of the driver, or from there: efforts turn."""
    return signs * readings if sensor.kind == "efforts" else readings


class _Reader:
    """Reads the tables of a file."""

    def __init__(
        self, path: PathLike, given: dict[str, Any], signs: FloatArray
    ) -> None:
        self._path = path
        self._given = given
        self._signs = signs

    def session(self) -> Session:
        """What the file says."""
        given = self._given
        self._check_keys("", given, _KEYS)
        for key in ("format", "sensor", "pose"):
            if key not in given:
                raise self._error(key, "missing")
        if given["format"] != FORMAT or isinstance(given["format"], bool):
            problem = f"this version reads format = {FORMAT}"
            raise self._error("format", problem)
        kind = self._one_of("sensor", given["sensor"], SENSORS)
        sensor = self._sensor(kind)
        units = UNITS[kind]
        unit = self._one_of("unit", given.get("unit", next(iter(units))), units)
        angles, readings = self._poses(sensor)
        try:
            return session(
                sensor,
                self._signs * np.radians(angles),
                _of_driver(sensor, self._signs, readings * units[unit]),
                fluid_density=self._density(),
                gravity=given.get("gravity"),
                name=str(self._path),
            )
        except Alpha5Error as error:
            raise self._error("", str(error)) from None

    def _sensor(self, kind: str) -> Sensor:
        make, names = SENSORS[kind]
        settings = self._given.get("settings", {})
        self._check_keys("settings", settings, names)
        own = dict(settings)
        if kind == "weight" and "gravity" in self._given:
            own["gravity"] = self._given["gravity"]
        if kind == "vehicle-tilt" and "vehicle" not in own:
            raise self._error("settings: vehicle", "missing")
        try:
            return make(**own)
        except Alpha5Error as error:
            raise self._error("settings", str(error)) from None

    def _density(self) -> float:
        """Of the fluid, by its name or as a number."""
        fluid = self._given.get("fluid", "air")
        if isinstance(fluid, str):
            return float(FLUIDS[self._one_of("fluid", fluid, FLUIDS)])
        if not _is_number(fluid):
            raise self._error("fluid", f"{fluid!r}; expected a name or a density")
        return float(fluid)

    def _poses(self, sensor: Sensor) -> tuple[FloatArray, FloatArray]:
        """Angles in degrees and readings of all poses."""
        poses = self._given["pose"]
        if not isinstance(poses, list) or not 0 < len(poses) <= _MOST_POSES:
            raise self._error("pose", f"expected 1 to {_MOST_POSES} tables [[pose]]")
        angles = []
        readings = []
        for number, pose in enumerate(poses, 1):
            place = f"pose {number}"
            self._check_keys(place, pose, _POSE)
            if "angles" not in pose:
                raise self._error(f"{place}: angles", "missing")
            joints = JOINT_NAMES[:4]
            angles.append(self._numbers(f"{place}: angles", pose["angles"], joints))
            found = pose.get("readings", [])
            if found == []:
                found = [float("nan")] * sensor.size
            key = f"{place}: readings"
            readings.append(self._numbers(key, found, sensor.channels, gaps=True))
        return np.array(angles), np.array(readings)

    def _numbers(
        self, key: str, given: Any, names: tuple[str, ...], gaps: bool = False
    ) -> list[float]:
        """One number for each name."""
        expected = f"expected {len(names)} numbers: {', '.join(names)}"
        if not isinstance(given, list) or len(given) != len(names):
            raise self._error(key, expected)
        for number in given:
            missing = gaps and isinstance(number, float) and np.isnan(number)
            if not missing and not _is_number(number):
                raise self._error(key, f"{number!r}; {expected}")
        return [float(number) for number in given]

    def _check_keys(self, place: str, given: Any, known: tuple[str, ...]) -> None:
        if not isinstance(given, dict):
            raise self._error(place, "expected a table")
        for key in given:
            if key not in known:
                where = f"{place}: {key}" if place else key
                raise self._error(where, f"unknown; choose from {', '.join(known)}")

    def _one_of(self, key: str, given: Any, known: Mapping[str, Any]) -> str:
        if not isinstance(given, str) or given not in known:
            names = ", ".join(f'"{name}"' for name in known)
            raise self._error(key, f"{given!r}; choose from {names}")
        return given

    def _error(self, place: str, problem: str) -> FileFormatError:
        return FileFormatError(self._path, problem, place)


def _is_number(value: Any) -> bool:
    """A finite number of a usual size."""
    known = isinstance(value, int | float) and not isinstance(value, bool)
    return known and abs(value) < 1e9


def _fluid(density: float) -> str:
    """The name of a fluid, or its density."""
    for name, known in FLUIDS.items():
        if known == density:
            return f'"{name}"'
    return repr(density)


def _settings(sensor: Sensor) -> list[str]:
    """The lines of a sensor's settings."""
    lines = [f"noise = {sensor.noise.max():g}", f"gain = {sensor.gain.max():g}"]
    match sensor.kind:
        case "scales":
            assert sensor.positions is not None
            lines.append(f"placement = {sensor.placement:g}")
            lines += ["positions = ["]
            lines += [f"  {_list(point)}," for point in sensor.positions]
            lines += ["]", f"zeroed = {_is_zeroed(sensor)}"]
        case "weight":
            lines.append(f"zeroed = {_is_zeroed(sensor)}")
        case "force-torque":
            force, torque = np.split(sensor.noise, 2)
            lines[0] = f"force_noise = {force.max():g}"
            lines.append(f"torque_noise = {torque.max():g}")
        case "vehicle-tilt":
            lines += _vehicle(sensor)
        case _:
            lines.append(f"offset = {sensor.offset.max():g}")
    return lines


def _vehicle(sensor: Sensor) -> list[str]:
    """The lines of a vehicle that tilts."""
    carrier = sensor.carrier
    assert carrier is not None
    rpy = np.array(rpy_from_rotation(carrier.mount[:3, :3]))
    return [
        f"offset = {sensor.offset.max():g}",
        f"yaw = {sensor.placement:g}",
        "",
        "[settings.vehicle]  # without the arm; base_link stands at xyz, rpy",
        f"mass = {float(carrier.mass)!r}",
        f"com = {_list(carrier.com)}",
        f"volume = {float(carrier.volume)!r}",
        f"cob = {_list(carrier.cob)}",
        f"xyz = {_list(carrier.mount[:3, 3])}",
        f"rpy = {_list(rpy)}",
    ]


def _gravity(planned: Session) -> list[str]:
    """The line of gravity, which a tilting vehicle does not have."""
    if planned.sensor.carrier is not None:
        return []
    return [f"gravity = {_list(planned.motion.gravity)}  # in base_link (m/s^2)"]


def _is_zeroed(sensor: Sensor) -> str:
    return "false" if (sensor.offset == ANY_MASS).all() else "true"


def _list(numbers: FloatArray) -> str:
    """Numbers as a list in TOML; adding zero turns a negative zero into zero."""
    return f"[{', '.join(_digits(number) for number in numbers.tolist())}]"


def _digits(number: float) -> str:
    return "nan" if np.isnan(number) else f"{number + 0.0:.10g}"
