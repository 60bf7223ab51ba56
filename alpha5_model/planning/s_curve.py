"""Straight joint lines in time: S-curves, from rest to rest.

All joints follow one parameter s from 0 to 1, so that they stay on the line. Its jerk
is constant in seven parts: speed builds up, stays and ends, and so does acceleration.
It is the fastest motion within bounds of speed, acceleration and jerk.

References:
    [Biagiotti2008] Biagiotti, Melchiorri: Trajectory Planning for Automatic Machines
        and Robots, section 3.4.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.errors import InputError

#: Time in which an acceleration builds up [s]: the jerk is the acceleration by it.
RAMP = 0.1


@dataclass(frozen=True, eq=False)
class JointLimits:
    """Bounds of the motion of the four joints.

    Attributes:
        speed: (4,) [rad/s].
        acceleration: (4,) [rad/s^2].
    """

    speed: FloatArray
    acceleration: FloatArray

    def slower(self, factor: float) -> JointLimits:
        """Those of the same motions in ``factor`` times the time, or a little less."""
        return JointLimits(
            speed=self.speed / factor, acceleration=self.acceleration / factor**2
        )


class Profile(NamedTuple):
    """The parameter at some times, (N,) each."""

    s: FloatArray
    rate: FloatArray
    acceleration: FloatArray


@dataclass(frozen=True)
class SCurve:
    """One parameter from 0 to 1.

    Attributes:
        jerk: [1/s^3].
        ramp: Time in which acceleration builds up or ends [s].
        rise: Time in which speed builds up or ends [s].
        cruise: Time at the highest speed [s].
    """

    jerk: float
    ramp: float
    rise: float
    cruise: float

    @property
    def duration(self) -> float:
        """[s]."""
        return 2 * self.rise + self.cruise

    @property
    def breaks(self) -> FloatArray:
        """Times at which the jerk changes, (8,) [s]."""
        first = np.array([0.0, self.ramp, self.rise - self.ramp, self.rise])
        return np.concatenate([first, self.duration - first[::-1]])

    def at(self, time: FloatArray) -> Profile:
        """The parameter at times from 0 to `duration`, (N,) [s]."""
        later = time > self.duration / 2
        # The second half is the first one, backwards.
        since_end = np.where(later, self.duration - time, time)
        first = self._first_half(since_end)
        return Profile(
            s=np.where(later, 1.0 - first.s, first.s),
            rate=first.rate,
            acceleration=np.where(later, -first.acceleration, first.acceleration),
        )

    def _first_half(self, time: FloatArray) -> Profile:
        """The parameter until the middle of the motion."""
        # Jerk sets in, ends, sets in backwards and ends: each adds its own cubic.
        starts = (0.0, self.ramp, self.rise - self.ramp, self.rise)
        signs = (1.0, -1.0, -1.0, 1.0)
        s = np.zeros(time.shape)
        rate = np.zeros(time.shape)
        acceleration = np.zeros(time.shape)
        for start, sign in zip(starts, signs, strict=True):
            since = np.maximum(time - start, 0.0)
            jerk = sign * self.jerk
            s += jerk * since**3 / 6
            rate += jerk * since**2 / 2
            acceleration += jerk * since
        return Profile(s=s, rate=rate, acceleration=acceleration)


def s_curve(speed: float, acceleration: float, jerk: float) -> SCurve:
    """The fastest S-curve of a parameter from 0 to 1, at rest at both ends.

    Args:
        speed: Bound of its rate, above 0 [1/s].
        acceleration: [1/s^2].
        jerk: [1/s^3].
    """
    ramp = min(acceleration / jerk, math.sqrt(speed / jerk))
    rise = ramp + speed / (jerk * ramp)
    cruise = 1.0 / speed - rise
    if cruise >= 0.0:
        return SCurve(jerk=jerk, ramp=ramp, rise=rise, cruise=cruise)

    # The highest speed is below its bound. So may be the acceleration.
    ramp = min(acceleration / jerk, (0.5 / jerk) ** (1 / 3))
    rise = (ramp + math.sqrt(ramp**2 + 4.0 / (jerk * ramp))) / 2
    return SCurve(jerk=jerk, ramp=ramp, rise=rise, cruise=0.0)


def line_curve(start: FloatArray, end: FloatArray, limits: JointLimits) -> SCurve:
    """The S-curve of a straight joint line, (4,) to (4,), which differ."""
    length = np.abs(end - start)
    moving = length > 0.0
    speed = float((limits.speed[moving] / length[moving]).min())
    acceleration = float((limits.acceleration[moving] / length[moving]).min())
    return s_curve(speed, acceleration, acceleration / RAMP)


class Samples(NamedTuple):
    """A motion at equal steps of time.

    Attributes:
        time: (N,) [s].
        position: (N, 4) [rad].
        velocity: (N, 4) [rad/s].
        acceleration: (N, 4) [rad/s^2].
    """

    time: FloatArray
    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray


#: Time between two samples [s], and their number if the motion takes too long for it.
STEP = 0.02
MOST_SAMPLES = 100_000
#: Samples of a motion that stays where it is.
_AT_REST = 5


class Times(NamedTuple):
    """When a motion is sampled.

    Attributes:
        at: Times within the motion, (N,) [s].
        stretch: So many times as long the motion takes, to end with a sample.
    """

    at: FloatArray
    stretch: float

    @classmethod
    def of(cls, duration: float, rate: float | None) -> Times:
        """The times of a motion of a duration [s].

        Args:
            duration: Above 0.
            rate: Samples per second; None for 50, or fewer if it takes long.

        Raises:
            InputError: That would be more than `MOST_SAMPLES`.
        """
        if rate is None:
            count = min(math.ceil(duration / STEP), MOST_SAMPLES)
            return cls(at=np.linspace(0.0, duration, count + 1), stretch=1.0)
        if not duration * rate <= MOST_SAMPLES:
            expected = f"at most {MOST_SAMPLES} samples of {duration:.3g} s"
            raise InputError("rate", rate, expected)
        count = math.ceil(duration * rate)
        at = np.linspace(0.0, duration, count + 1)
        return cls(at=at, stretch=count / (rate * duration))

    def samples(
        self, position: FloatArray, velocity: FloatArray, acceleration: FloatArray
    ) -> Samples:
        """A motion whose values at these times are given, stretched."""
        return Samples(
            time=self.at * self.stretch,
            position=position,
            velocity=velocity / self.stretch,
            acceleration=acceleration / self.stretch**2,
        )


def along(
    way: FloatArray, curves: Sequence[SCurve], begins: FloatArray, times: Times
) -> Samples:
    """Straight joint lines at some times; where two of them overlap, they add up.

    Args:
        way: Ends of the lines, (K, 4) [rad].
        curves: The lines in time, K - 1.
        begins: When each begins, (K - 1,) [s]. Only neighbours overlap.
        times: The last of them is the end of the motion.
    """
    time = times.at
    position = np.tile(way[0], (len(time), 1))
    velocity = np.zeros(position.shape)
    acceleration = np.zeros(position.shape)
    lines = zip(pairwise(way), curves, begins.tolist(), strict=True)
    for (start, end), curve, begin in lines:
        first, last = np.searchsorted(time, [begin, begin + curve.duration])
        profile = curve.at(time[first:last] - begin)
        position[first:last] += profile.s[:, None] * (end - start)
        position[last:] = end
        velocity[first:last] += profile.rate[:, None] * (end - start)
        acceleration[first:last] += profile.acceleration[:, None] * (end - start)
    # The last one may be later than the sum by rounding.
    position[-1] = way[-1]
    velocity[-1] = 0.0
    acceleration[-1] = 0.0
    return times.samples(position, velocity, acceleration)


def sampled(way: FloatArray, limits: JointLimits, rate: float | None = None) -> Samples:
    """Straight joint lines one after the other, at rest between them.

    Args:
        way: Their ends, (K, 4) [rad].
        limits: Of the joints.
        rate: Samples per second; None for 50, or fewer if the motion takes long.
    """
    moves = np.append(True, (way[1:] != way[:-1]).any(axis=1))
    ends = way[moves]
    curves = [line_curve(start, end, limits) for start, end in pairwise(ends)]
    until = [0.0]
    for curve in curves:
        until.append(until[-1] + curve.duration)
    duration = until[-1]
    if not curves:
        duration = (_AT_REST - 1) * (STEP if rate is None else 1.0 / rate)
    return along(ends, curves, np.array(until[:-1]), Times.of(duration, rate))


def travel_time(way: FloatArray, limits: JointLimits) -> float:
    """Duration of straight joint lines one after the other, way (K, 4) [s].

    It is inf if a joint moves whose speed is 0.
    """
    if (way[:, limits.speed == 0.0] != way[0, limits.speed == 0.0]).any():
        return math.inf
    return sum(
        line_curve(start, end, limits).duration
        for start, end in pairwise(way)
        if (start != end).any()
    )
