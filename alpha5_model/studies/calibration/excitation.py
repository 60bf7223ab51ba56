"""A motion that tells the most of an arm: a Fourier series for each joint.

References:
    [Swevers1997] Swevers, Ganseman, Tuekel, De Schutter, Van Brussel: Optimal robot
        excitation and identification, IEEE Transactions on Robotics and Automation
        13(5) (finite Fourier series).
    [Atkinson2007] Atkinson, Donev, Tobias: Optimum Experimental Designs, with SAS,
        section 10.2 (designs that are best for some combinations of the unknowns).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    FloatArray,
    count,
    frozen,
    generator,
    instance,
    real,
)
from alpha5_model._support.files import PathLike
from alpha5_model.errors import InputError
from alpha5_model.numbers.fluids import SEA_WATER
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.planning.motion_table import write_motion_table
from alpha5_model.planning.surroundings import Surroundings
from alpha5_model.studies.calibration.equations import Equations
from alpha5_model.studies.calibration.loads import load_slopes
from alpha5_model.studies.calibration.poses import FROM_LIMITS, TILT
from alpha5_model.studies.calibration.sensors import Sensor
from alpha5_model.studies.calibration.sessions import Session, session
from alpha5_model.studies.calibration.unknowns import NAMES, ArmUnknowns, arm_unknowns

#: Of the Fourier series.
_HARMONICS = 3
#: Samples of the motion per second, and readings of the sensor [Hz].
_RATE = 20.0
#: No motion is repeated after more than an hour [s].
_LONGEST = 3600.0
#: Samples that are looked at, and those of the motion that is checked.
_SAMPLES = 40
_CHECKED = 400
#: Joints whose torques at rest should be known: axis_d and axis_c.
_WANTED = slice(1, 3)
#: Random positions at which torques should be known.
_POSES = 100
#: Share of the speed limit that is used.
_OF_SPEED = 0.95
#: Motions drawn at random before the best one is varied.
_RANDOM = 100
#: Size of the first variations, and by what they grow and shrink.
_VARIATION = 0.3
_GROWTH = 1.5
_SHRINKING = 0.9**0.25


@dataclass(frozen=True, eq=False)
class Excitation:
    """A motion at even times that begins and ends at rest at the same place.

    Attributes:
        time: (N,) [s].
        position, velocity, acceleration: (N, 4) each [rad, rad/s, rad/s^2].
        evaluations: Motions that were compared.
        information: Natural logarithm of the factor by which the standard deviation of
            the torque at rest shrinks, over random positions; the sum over axis_d
            and axis_c.
    """

    time: FloatArray
    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    evaluations: int
    information: float

    def write(self, path: PathLike) -> Path:
        """Write time, positions, velocities and accelerations, as `a5.plan` does.

        Args:
            path: ``.csv``, ``-``, a device or a pipe.

        Raises:
            UnknownNameError: Another suffix.
            OutputError: The file cannot be written.
        """
        return write_motion_table(
            path,
            JOINT_NAMES[:4],
            time=self.time,
            position=self.position,
            velocity=self.velocity,
            acceleration=self.acceleration,
        )


def plan_excitation(
    sensor: Sensor,
    *,
    arm: Alpha5Parameters | None = None,
    fluid_density: float = SEA_WATER,
    gravity: ArrayLike | None = None,
    prior: str = "digits",
    duration: float = 20.0,
    evaluations: int = 400,
    seed: int = 0,
) -> Excitation:
    """A motion in which a sensor tells the most about an arm [Swevers1997].

    Each joint follows a Fourier series of three harmonics. Of random motions and
    variations of the best, this is the one after which the torques at rest of axis_d
    and axis_c are known best [Atkinson2007]. All stay within the limits with a margin
    of 3 deg, within 95 % of the rated speeds, and are proved free of self-collision.
    Lengths count as known.

    Args:
        sensor: From `force_torque` or `efforts`; scales need an arm at rest.
        arm: Record of an arm of your own; None for the catalogue's.
        fluid_density: [kg/m^3].
        gravity: In base_link, (3,) [m/s^2]; None for that of a level mount.
        prior: As of `fit`.
        duration: Of one period, at most an hour [s].
        evaluations: Motions to compare; more find better ones.
        seed: Of the random numbers.

    Raises:
        InputError: Scales, or not such numbers; a joint that cannot move as far as the
            margin; no motion free of self-collision.
    """
    chosen = instance("sensor", sensor, Sensor)
    if chosen.kind not in ("force-torque", "efforts"):
        expected = "a force-torque sensor or efforts: scales need an arm at rest"
        raise InputError("sensor", chosen.kind, expected)
    record = chosen_arm(arm)
    period = real("duration", duration, minimum=0.0, strict=True)
    if period > _LONGEST:
        raise InputError("duration", period, f"at most {_LONGEST:g} s")
    search = _Search(
        arm=record,
        period=period,
        rng=generator(seed),
    )
    unknowns = _without_lengths(arm_unknowns(record, prior, moving=True))
    still = session(
        chosen,
        search.random_positions(_POSES),
        fluid_density=fluid_density,
        gravity=gravity,
    )
    wanted = _Wanted(unknowns, still)

    def information(series: _Series) -> float:
        time = np.linspace(0.0, search.period, _SAMPLES, endpoint=False)
        q, v, a = series.at(time)
        read = session(
            chosen,
            q,
            v=v,
            a=a,
            fluid_density=fluid_density,
            gravity=gravity,
        )
        # As if all readings were taken at these times.
        return wanted.told(read, repeated=_RATE * search.period / _SAMPLES)

    best, told = search.best(information, count("evaluations", evaluations))
    samples = max(2, round(search.period * _RATE) + 1)
    time = np.linspace(0.0, search.period, samples)
    q, v, a = best.at(time)
    return Excitation(
        time=frozen(time),
        position=frozen(q),
        velocity=frozen(v),
        acceleration=frozen(a),
        evaluations=search.compared,
        information=told,
    )


class _Wanted:
    """The torques of axis_d and axis_c that hold the arm still, which should be known.

    Args:
        unknowns: The numbers of the arm.
        still: Positions at which the torques are wanted.
    """

    def __init__(self, unknowns: ArmUnknowns, still: Session) -> None:
        self._unknowns = unknowns
        slopes = load_slopes(unknowns, unknowns.middle, still.density, still.motion)
        scaled = slopes[:, _WANTED] * unknowns.deviation
        #: Mean squares of the slopes, for each joint, (2, 78, 78).
        self._squares = np.einsum("njk,njl->jkl", scaled, scaled) / len(scaled)
        self._before = np.trace(self._squares, axis1=1, axis2=2)

    def told(self, read: Session, repeated: float) -> float:
        """Logarithm by which the standard deviations shrink, over both joints.

        Args:
            read: A motion.
            repeated: How often each of its readings is taken.
        """
        equations = Equations(unknowns=self._unknowns, sessions=[read], tilt=TILT)
        slopes = equations.slopes(equations.middle, 0) / read.sensor.noise[:, None]
        scaled = (slopes * equations.deviation).reshape(-1, slopes.shape[-1])
        inner = np.eye(scaled.shape[1]) + repeated * scaled.T @ scaled
        covariance = np.linalg.inv(inner)[: len(NAMES), : len(NAMES)]
        after = np.einsum("jkl,kl->j", self._squares, covariance)
        # Without gravity there are no torques at rest.
        uncertain = self._before > 0
        shrinking = self._before[uncertain] / after[uncertain]
        return float(np.log(shrinking).sum()) / 2


@dataclass(frozen=True, eq=False)
class _Series:
    """Fourier series of the four joints, at rest at time 0.

    Attributes:
        middle: (4,) [rad].
        sines, cosines: Of the harmonics, (3, 4) each [rad].
        period: [s].
    """

    middle: FloatArray
    sines: FloatArray
    cosines: FloatArray
    period: float

    def at(self, time: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Positions, velocities and accelerations at times (N,), (N, 4) each."""
        rates = 2 * np.pi / self.period * np.arange(1, _HARMONICS + 1)
        sine = np.sin(np.outer(time, rates))
        cosine = np.cos(np.outer(time, rates))
        q = self.middle + sine @ self.sines + cosine @ self.cosines
        v = (cosine * rates) @ self.sines - (sine * rates) @ self.cosines
        a = -(sine * rates**2) @ self.sines - (cosine * rates**2) @ self.cosines
        return q, v, a


class _Search:
    """Looks for the best series.

    Attributes:
        period: [s].
        compared: How many series were compared.
    """

    def __init__(
        self,
        arm: Alpha5Parameters,
        period: float,
        rng: np.random.Generator,
    ) -> None:
        joints = arm.joints[:4]
        for joint in joints:
            if not joint.upper - joint.lower > 2.0 * FROM_LIMITS:
                limits = (joint.lower, joint.upper)
                expected = f"limits more than {2.0 * FROM_LIMITS:.3g} rad apart"
                raise InputError(joint.name, limits, expected)
        self.period = period
        self.compared = 0
        self._rng = rng
        self._lower = np.array([joint.lower for joint in joints]) + FROM_LIMITS
        self._upper = np.array([joint.upper for joint in joints]) - FROM_LIMITS
        self._speed = _OF_SPEED * np.array([joint.velocity for joint in joints])
        self._surroundings = Surroundings(arm)

    def random_positions(self, size: int) -> FloatArray:
        """Positions within the limits, the same for all seeds, (size, 4)."""
        fixed = np.random.default_rng(0)
        return fixed.uniform(self._lower, self._upper, (size, 4))

    def best(
        self, information: Callable[[_Series], float], evaluations: int
    ) -> tuple[_Series, float]:
        """The series that tells the most, and how much.

        Raises:
            InputError: None is free of self-collision.
        """
        found: _Series | None = None
        told = -np.inf
        genes = np.zeros((2 * _HARMONICS + 1, 4))
        size = _VARIATION
        for number in range(evaluations):
            random = number < min(_RANDOM, evaluations // 2 + 1) or found is None
            step = self._rng.normal(size=genes.shape)
            tried = step if random else genes + size * step
            series = self._possible(tried)
            self.compared += 1
            value = -np.inf if series is None else information(series)
            better = value > told and series is not None and self._is_free(series)
            if better:
                found, told, genes = series, value, tried
            if not random:
                size *= _GROWTH if better else _SHRINKING
                size = max(size, 0.02)
        if found is None:
            expected = "more: none was free of self-collision"
            raise InputError("evaluations", evaluations, expected)
        return found, told

    def _possible(self, genes: FloatArray) -> _Series | None:
        """A series within limits and speeds, or None if it surely collides.

        Args:
            genes: Of size 1: sines, cosines and the place in the range, (7, 4).
        """
        number = np.arange(1, _HARMONICS + 1)[:, None]
        sines = genes[:_HARMONICS] / number
        cosines = genes[_HARMONICS:-1] / number
        # The velocity at time 0, the sum of all n sines, is 0.
        sines[0] = -(number[1:] * sines[1:]).sum(axis=0)

        time = np.linspace(0.0, self.period, _CHECKED + 1)
        shape = _Series(
            middle=np.zeros(4), sines=sines, cosines=cosines, period=self.period
        )
        q, v, _ = shape.at(time)
        reach = np.ptp(q, axis=0)
        room = self._upper - self._lower
        by_speed = self._speed / np.abs(v).max(axis=0)
        scale = np.minimum(by_speed, room / reach)
        share = 0.5 + 0.5 * np.tanh(genes[-1])
        start = self._lower + share * (room - scale * reach)
        middle = start - scale * q.min(axis=0)
        series = _Series(
            middle=middle,
            sines=scale * sines,
            cosines=scale * cosines,
            period=self.period,
        )
        touches = self._surroundings.touches(series.at(time)[0][::8])
        return None if touches.any() else series

    def _is_free(self, series: _Series) -> bool:
        """Whether the whole motion is proved free of self-collision."""
        time = np.linspace(0.0, self.period, _CHECKED + 1)
        q, _, a = series.at(time)
        # Between two samples, a curve is this near to the straight line.
        strayed = np.abs(a).max(axis=0) * 1.05 * (time[1] ** 2) / 8
        wider = self._surroundings.with_room(strayed)
        return all(wider.obstruction(start, end) is None for start, end in pairwise(q))


def _without_lengths(unknowns: ArmUnknowns) -> ArmUnknowns:
    """The same unknowns with known lengths, which take most of the time."""
    deviation = unknowns.deviation.copy()
    deviation[-4:] = 0.0
    return ArmUnknowns(
        arm=unknowns.arm,
        middle=unknowns.middle,
        deviation=deviation,
        prior=unknowns.prior,
    )
