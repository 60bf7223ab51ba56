"""Kitchen scales under an arm: three that carry its mount plate, or one alone."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import BoolArray, FloatArray, array, flag, frozen
from alpha5_model._support.spatial import rpy_from_rotation
from alpha5_model.errors import InputError
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.fluids import GRAVITY
from alpha5_model.planning.obstacles import Obstacle
from alpha5_model.studies.calibration.sensor import (
    LOADS,
    Loads,
    Own,
    Sensor,
    deviations,
    scaled,
)

#: What a scale shows is a force over this [m/s^2].
STANDARD_GRAVITY = float(np.linalg.norm(GRAVITY))
#: Corners of a triangle under base_link, all 0.18 m from its middle [m].
TRIANGLE = ((0.18, 0.0, -0.03), (-0.09, 0.156, -0.03), (-0.09, -0.156, -0.03))
#: Prior of what lies on scales beside the arm, if they were not zeroed [kg].
_ANY_MASS = 10.0
#: Scales that lie nearer to a line than this carry no moment about it [m].
_FLAT = 0.02
#: Scales whose plane is off by more are not under the arm: cosine of 15 degrees.
_LEVEL = np.cos(np.radians(15.0))
#: A scale carries at least this [kg].
_LEAST_LOAD = 0.02
#: The table that the scales stand on reaches beyond the arm [m].
_TABLE = (1.6, 1.6, 0.1)
#: Units of masses in files.
_MASSES = {"g": 1e-3, "kg": 1.0}


@dataclass(frozen=True, eq=False)
class Scales(Sensor):
    """Three scales; make them with `scales`."""

    kind = "scales"
    channels = ("scale_1", "scale_2", "scale_3")
    unit = ("kg",) * 3
    units = _MASSES
    guide = (
        "Set the arm on a plate on three scales, and the scales on a firm table. The",
        "positions are where the plate rests on them, in base_link. Move to each pose,",
        "wait until the scales are still, and write what they show. If a joint reports",
        "another angle, correct it. Write nan for a reading that you missed.",
    )
    alike = True

    positions: FloatArray
    noise: FloatArray
    placement: FloatArray
    zeroed: bool

    @property
    def deviation(self) -> FloatArray:
        return self.noise

    @cached_property
    def matrix(self) -> FloatArray:
        """What the scales carry by joint torques and load on the mount, (3, 10)."""
        return _support(self.positions)

    def own(self, moves: bool) -> tuple[Own, ...]:
        places = tuple(f"{channel}.{k}" for channel in self.channels for k in (1, 2))
        return (
            Own("gain", self.channels, self.gain),
            Own("offset", self.channels, _offset(self.noise, self.zeroed)),
            Own("placement", places, np.repeat(self.placement, 2)),
        )

    def read(self, loads: Loads, own: Mapping[str, FloatArray]) -> FloatArray:
        matrix = self.matrix
        if own["placement"].any():
            along = _axes(self.positions)[:2]
            moved = self.positions + own["placement"].reshape(3, 2) @ along
            matrix = _support(moved)
        return scaled(loads.total @ matrix.T, own)

    def check(self, gravity: FloatArray, density: float, moves: bool) -> None:
        down = -_axes(self.positions)[2]
        if down @ gravity <= _LEVEL * np.linalg.norm(gravity):
            expected = "gravity at a right angle to the plane of the scales, towards it"
            raise InputError("gravity", gravity.tolist(), expected)

    def obstacles(self) -> tuple[Obstacle, ...]:
        """The table that the scales stand on."""
        along, beside, normal = _axes(self.positions)
        rotation = np.column_stack([along, beside, normal])
        centre = self.positions.mean(axis=0) - normal * _TABLE[2] / 2
        return (Obstacle.box("table", _TABLE, centre, rpy_from_rotation(rotation)),)

    def holds(self, readings: FloatArray, ballast: float) -> BoolArray:
        """Whether every scale carries something, with ballast that rests evenly."""
        return np.asarray((readings + ballast / 3 > _LEAST_LOAD).all(axis=1))


@dataclass(frozen=True, eq=False)
class Weight(Sensor):
    """One scale; make it with `weight`."""

    kind = "weight"
    channels = ("scale",)
    unit = ("kg",)
    units = _MASSES
    guide = ("Set the arm on one scale and write what it shows in each pose.",)

    noise: FloatArray
    zeroed: bool

    @property
    def deviation(self) -> FloatArray:
        return self.noise

    def own(self, moves: bool) -> tuple[Own, ...]:
        return (
            Own("gain", self.channels, self.gain),
            Own("offset", self.channels, _offset(self.noise, self.zeroed)),
        )

    def read(self, loads: Loads, own: Mapping[str, FloatArray]) -> FloatArray:
        down = loads.gravity / np.linalg.norm(loads.gravity)
        weight = loads.total[:, 4:7] @ down / STANDARD_GRAVITY
        return scaled(weight[:, None], own)

    def check(self, gravity: FloatArray, density: float, moves: bool) -> None:
        if not gravity.any():
            raise InputError(
                "gravity", gravity.tolist(), "gravity that pulls somewhere"
            )


def scales(
    positions: ArrayLike = TRIANGLE,
    *,
    noise: ArrayLike = 0.0003,
    gain: ArrayLike = 0.001,
    placement: ArrayLike = 0.0,
    zeroed: bool = False,
) -> Scales:
    """Three scales under the mount plate. They read masses [kg].

    They stand on one table, and the plate rests on one point of each. ``noise``,
    ``gain`` and ``placement`` are one number each, or one for each scale.

    Args:
        positions: Of these points in base_link, (3, 3) [m].
        noise: Standard deviation of a reading [kg]. That of rounding to whole grams is
            0.29 g; scales that do not repeat a reading have more.
        gain: Standard deviation of the factor by which each scale is wrong.
        placement: That of the coordinates of the points [m].
        zeroed: Whether the scales showed 0 with the bare plate, to twice the noise. If
            not, what lies on them beside the arm is unknown.

    Raises:
        InputError: Not three points of a triangle, or numbers not above 0.

    Warns:
        ImplausibleWarning: A noise or placement that looks like g or mm.
    """
    points = array("positions", positions, 3, 3)
    sides = points - points[[1, 2, 0]]
    twice_area = np.linalg.norm(np.cross(sides[0], sides[1]))
    if twice_area <= _FLAT * np.linalg.norm(sides, axis=1).max():
        expected = f"three points at least {_FLAT:g} m off one line, in m"
        raise InputError("positions", points.tolist(), expected)
    made = Scales(
        gain=deviations("gain", gain, 3),
        positions=frozen(points.copy()),
        noise=deviations("noise", noise, 3, above_zero=True),
        placement=deviations("placement", placement, 3),
        zeroed=flag("zeroed", zeroed),
    )
    plausibility.check("noise", made.noise.max(), plausibility.SCALE_NOISE)
    plausibility.check("placement", made.placement.max(), plausibility.PLACEMENT)
    return made


def weight(
    *, noise: ArrayLike = 0.0003, gain: ArrayLike = 0.001, zeroed: bool = True
) -> Sensor:
    """One scale that carries the whole arm. It reads a mass [kg].

    Args:
        noise, gain, zeroed: As of `scales`.

    Raises:
        InputError: Numbers not above 0.

    Warns:
        ImplausibleWarning: A noise that looks like g.
    """
    made = Weight(
        gain=deviations("gain", gain, 1),
        noise=deviations("noise", noise, 1, above_zero=True),
        zeroed=flag("zeroed", zeroed),
    )
    plausibility.check("noise", made.noise.max(), plausibility.SCALE_NOISE)
    return made


def _offset(noise: FloatArray, zeroed: bool) -> FloatArray:
    """Standard deviations of what lies on scales beside the arm [kg]."""
    return 2.0 * noise if zeroed else np.full_like(noise, _ANY_MASS)


def _axes(positions: FloatArray) -> FloatArray:
    """Two axes in the plane of three points and its normal, as rows, (3, 3).

    The normal points to the side of the origin, or along z if the origin is in it.
    """
    first = positions[1] - positions[0]
    normal = np.cross(first, positions[2] - positions[0])
    height = -normal @ positions[0]
    upward = height if abs(height) > 1e-12 else normal[2]
    if upward < 0:
        normal = -normal
    normal /= np.linalg.norm(normal)
    along = first / np.linalg.norm(first)
    return np.array([along, np.cross(normal, along), normal])


def _support(positions: FloatArray) -> FloatArray:
    """What three supports carry, in kg, by joint torques and load, (3, 10).

    The forces N_i along the normal n balance the force F and the moment M of the arm:
    ``sum N_i = -n . F``, and about each axis e in the plane through the middle c,
    ``sum e . (p_i - c) x n N_i = -e . (M - c x F)``.
    """
    axes = _axes(positions)
    along, beside, normal = axes
    centre = positions.mean(axis=0)
    levers = np.cross(positions - centre, normal)
    balance = np.array([np.ones(3), levers @ along, levers @ beside])

    of_load = np.zeros((3, LOADS))
    of_load[0, 4:7] = -normal
    for row, axis in ((1, along), (2, beside)):
        of_load[row, 4:7] = np.cross(axis, centre)
        of_load[row, 7:] = -axis
    return np.asarray(np.linalg.solve(balance, of_load) / STANDARD_GRAVITY)
