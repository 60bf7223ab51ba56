"""What a sensor is: it reads the loads of an arm, and names its own unknowns.

To add a sensor, write a file with a subclass of `Sensor` and the function that makes
it. Add this function to `alpha5_model.studies.calibration.sensors`, which makes it a
sensor of files and of the command, and to the public names of this package. An argument
whose default is one number takes one number for all channels, or one for each.

A sensor sees `Loads` only: joint torques and the load on the mount, with the gravity,
the joint velocities and the density of the session. For a sensor of anything else, such
as joint positions, extend `Loads`, and `Equations.loads` and `_slopes` in
`alpha5_model.studies.calibration.equations`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    BoolArray,
    FloatArray,
    bounded,
    float_array,
    frozen,
)
from alpha5_model.errors import InputError, ShapeError
from alpha5_model.numbers.fluids import GRAVITY
from alpha5_model.planning.obstacles import Obstacle

#: Joint torques and components of the load on the mount.
LOADS = 10


@dataclass(frozen=True, eq=False)
class Loads:
    """What an arm does to its joints and to its mount, in the states of a session.

    Attributes:
        still: Joint torques, then force and moment on the mount in base_link, of an arm
            at rest, (N, 10, 3), by gravity of 1 m/s^2 along each axis of base_link.
        moving: What motion adds, (N, 10).
        turn: Rotation from base_link to where the mount should have it, (3, 3).
        gravity: In base_link, (3,) [m/s^2].
        velocity: Of the joints, (N, 4) [rad/s].
        density: Of the fluid [kg/m^3].
    """

    still: FloatArray
    moving: FloatArray
    turn: FloatArray
    gravity: FloatArray
    velocity: FloatArray
    density: float

    @property
    def total(self) -> FloatArray:
        """Joint torques, force and moment in this gravity, (N, 10)."""
        return np.asarray(self.moving + self.still @ self.gravity)


class Own(NamedTuple):
    """Unknowns of a sensor in one session, all 0 if nothing is wrong.

    Attributes:
        name: Of them together, for example ``gain``.
        labels: Of each, for example the channels, (n,).
        deviation: Standard deviations before any reading, (n,).
    """

    name: str
    labels: tuple[str, ...]
    deviation: FloatArray


@dataclass(frozen=True, eq=False)
class Sensor(ABC):
    """A sensor that weighs an arm.

    Make one with a function such as `scales` or `force_torque`. Its fields are the
    arguments of that function, and the settings in a file.

    Attributes:
        kind: Its name in files and for the command, such as ``force-torque``.
        channels: Names of the readings, (k,).
        unit: Of the readings in the package, one for each, (k,).
        units: Units that a file may have, and their sizes; the first is usual.
        guide: What to do, for the head of a file.
        by_joint: Whether each channel is a joint's, and turns with its sign.
        alike: Whether the channels are alike, so that they may be mixed up.
    """

    kind: ClassVar[str]
    channels: ClassVar[tuple[str, ...]]
    unit: ClassVar[tuple[str, ...]]
    units: ClassVar[Mapping[str, float]]
    guide: ClassVar[tuple[str, ...]]
    by_joint: ClassVar[bool] = False
    alike: ClassVar[bool] = False

    gain: FloatArray

    @property
    @abstractmethod
    def deviation(self) -> FloatArray:
        """Standard deviations of the readings, (k,)."""

    @abstractmethod
    def own(self, moves: bool) -> tuple[Own, ...]:
        """What is unknown of the sensor itself.

        Args:
            moves: Whether the arm moves in the session.
        """

    @abstractmethod
    def read(self, loads: Loads, own: Mapping[str, FloatArray]) -> FloatArray:
        """Readings without noise, (N, k).

        Args:
            loads: Of the arm.
            own: Values of the unknowns of `own`, by their names, (n,) each.
        """

    def settings(self) -> dict[str, Any]:
        """Arguments that make this sensor again: what TOML has, and arrays."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    def usual_gravity(self) -> FloatArray:
        """Gravity in base_link if a session does not say it, (3,)."""
        return np.asarray(GRAVITY)

    def check(self, gravity: FloatArray, density: float, moves: bool) -> None:
        """Refuse a session that the sensor cannot be read in.

        Raises:
            InputError: Names the argument.
        """
        return

    def check_readings(self, readings: FloatArray) -> None:
        """Refuse readings (N, k) that cannot be, NaN apart.

        Raises:
            InputError: Names the reading.
        """
        return

    def obstacles(self) -> Sequence[Obstacle]:
        """What the arm must not touch beside itself."""
        return ()

    def holds(self, readings: FloatArray, ballast: float) -> BoolArray:
        """Whether readings (N, k) can be taken with some ballast [kg], (N,)."""
        return np.ones(len(readings), np.bool_)

    @property
    def size(self) -> int:
        """Number of its readings."""
        return len(self.channels)


def scaled(clean: FloatArray, own: Mapping[str, FloatArray]) -> FloatArray:
    """Readings (N, k) with the ``gain`` less 1 and the ``offset`` of each channel."""
    return np.asarray((1.0 + own["gain"]) * clean + own["offset"])


def deviations(
    name: str, value: ArrayLike, size: int, *, above_zero: bool = False
) -> FloatArray:
    """Standard deviations of some channels, one number for all or one for each, (k,).

    Raises:
        InputError: Not real numbers, or one below 0 (at it, if ``above_zero``).
        ShapeError: Another number of them.
    """
    given = bounded(name, float_array(name, value, ()))
    if given.shape not in ((), (size,)):
        raise ShapeError(name, given.shape, f"one number, or {size}")
    least = float(given.min())
    if least < 0.0 or (above_zero and least == 0.0):
        expected = f"numbers {'above' if above_zero else 'of at least'} 0"
        raise InputError(name, least, expected)
    return frozen(np.broadcast_to(given, size).copy())
