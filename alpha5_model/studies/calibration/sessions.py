"""What was measured: one sensor in one fluid, at some joint positions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    FloatArray,
    array,
    float_array,
    frozen,
    instance,
    shaped,
)
from alpha5_model.errors import InputError
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.fluids import AIR, GRAVITY, density_of
from alpha5_model.studies.calibration.loads import Motion
from alpha5_model.studies.calibration.sensors import STANDARD_GRAVITY, Sensor
from alpha5_model.studies.calibration.tilt_sensor import (
    check_floats,
    check_readings,
)


@dataclass(frozen=True, eq=False)
class Session:
    """Readings of one sensor in one fluid; make one with `session`.

    Attributes:
        sensor: What was read.
        density: Of the fluid [kg/m^3].
        motion: Joint positions as the joints report them, and gravity in base_link.
        readings: In the sensor's units, (N, k); NaN for what is not read.
        name: For messages, for example its file's.
    """

    sensor: Sensor
    density: float
    motion: Motion
    readings: FloatArray
    name: str = "session"

    @property
    def is_read(self) -> bool:
        """Whether there is any reading."""
        return bool(np.isfinite(self.readings).any())


def session(
    sensor: Sensor,
    q: ArrayLike,
    readings: ArrayLike | None = None,
    *,
    fluid_density: float = AIR,
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
        fluid_density: [kg/m^3]; air by default.
        v, a: Rates of joints that move, (N, 4); None for an arm at rest.
        gravity: In base_link, (3,) [m/s^2]. None for that of a level mount. If a
            vehicle's tilt is read, it must be None: that of a level vehicle.
        name: For messages.

    Raises:
        InputError: Not such numbers, scales that do not lie level, or an arm that moves
            on a vehicle whose tilt is read.
    """
    chosen = instance("sensor", sensor, Sensor)
    positions = _rows("q", q)
    count = len(positions)
    still = np.zeros_like(positions)
    pull = _gravity(chosen, gravity)
    empty = np.full((count, chosen.size), np.nan)
    found = empty if readings is None else _with_gaps(readings, empty.shape)
    made = Session(
        sensor=chosen,
        density=density_of(fluid_density),
        motion=Motion(
            q=positions,
            v=still if v is None else shaped("v", v, (count, 4)),
            a=still if a is None else shaped("a", a, (count, 4)),
            gravity=frozen(pull),
        ),
        readings=frozen(found),
        name=name,
    )
    _check_level(made)
    _check_floats(made)
    return made


def with_readings(planned: Session, readings: FloatArray) -> Session:
    """The same poses with readings (N, k); NaN for one that is missing.

    Raises:
        InputError: Not a session, or numbers of another shape.
    """
    poses = instance("planned", planned, Session)
    found = _with_gaps(readings, poses.readings.shape)
    made = replace(poses, readings=frozen(found))
    _check_floats(made)
    return made


def _gravity(sensor: Sensor, given: ArrayLike | None) -> FloatArray:
    """Gravity in base_link."""
    if sensor.carrier is not None:
        if given is not None:
            expected = "none: the vehicle's tilt says where gravity pulls"
            raise InputError("gravity", np.asarray(given).tolist(), expected)
        return np.asarray(sensor.carrier.mount[:3, :3].T @ GRAVITY)
    chosen = GRAVITY if given is None else given
    pull = array("gravity", chosen, 3)
    plausibility.check_gravity(chosen, pull)
    return pull


def _check_floats(made: Session) -> None:
    """Refuse a vehicle that cannot float upright, or whose arm moves."""
    carrier = made.sensor.carrier
    if carrier is None:
        return
    check_floats(carrier, made.density)
    check_readings(made.readings)
    if not made.motion.rests:
        raise InputError("v, a", "an arm that moves", "an arm at rest")


def _rows(name: str, value: ArrayLike) -> FloatArray:
    """At least one row of four angles."""
    rows = float_array(name, value, (4,))
    if rows.ndim != 2 or not len(rows):
        raise InputError(name, rows.tolist(), "at least one pose, (N, 4)")
    return np.ascontiguousarray(rows)


def _with_gaps(value: ArrayLike, shape: tuple[int, ...]) -> FloatArray:
    """Numbers of a shape, of which some may be NaN."""
    plain = isinstance(value, list | tuple) or type(value) is np.ndarray
    given = _as_array(value) if plain else None
    if given is None or given.dtype.kind != "f" or not np.isnan(given).any():
        return shaped("readings", value, shape)
    gaps = np.isnan(given)
    found = shaped("readings", np.where(gaps, 0.0, given), shape).copy()
    found[gaps] = np.nan
    return found


def _as_array(value: ArrayLike) -> Any:
    """An array; None of what is none."""
    try:
        return np.asarray(value)
    except (TypeError, ValueError):
        return None


#: Scales whose plane is off by more are not under the arm: cosine of 15 degrees.
_LEVEL = np.cos(np.radians(15.0))


def _check_level(made: Session) -> None:
    """Refuse scales that gravity does not press on."""
    sensor = made.sensor
    if sensor.kind not in ("scales", "weight"):
        return
    pull = made.motion.gravity
    # The readings of a force along gravity add up to what it weighs.
    load = np.zeros(sensor.matrix.shape[1])
    load[4:7] = pull
    total = (sensor.matrix @ load).sum() * STANDARD_GRAVITY
    if total <= _LEVEL * np.linalg.norm(pull):
        expected = "gravity at a right angle to the plane of the scales, towards them"
        raise InputError("gravity", pull.tolist(), expected)
