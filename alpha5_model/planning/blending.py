"""Joint lines whose corners are passed without a stop.

A line begins before the one ahead of it has ended, and their motions add up, as in
[Siciliano2009]_. The longer both last together, the farther the arm passes the corner.
At each corner the time is the longest at which the arm is not too far from the corner,
no joint is faster or accelerates more than it may, and the way is proved free. Where
two lines overlap, the jerk may be twice that of one.

The way around a corner is proved free as straight joint lines between some of its
positions. Between two of them it is off by at most ``max |a| h^2 / 8``.

.. [Siciliano2009] Siciliano, Sciavicco, Villani, Oriolo: Robotics, chapter 4.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.batch import frame_positions
from alpha5_model.planning.replay import ROUNDING
from alpha5_model.planning.s_curve import (
    JointLimits,
    Samples,
    SCurve,
    Times,
    along,
    line_curve,
    travel_time,
)
from alpha5_model.planning.surroundings import Surroundings

#: The time of an overlap is halved so often.
_HALVINGS = 8
#: Straight joint lines that stand for the way around a corner.
_CHORDS = 32
#: Jerks of a line set in, end and change sign eight times, and two lines overlap.
_JERKS = 16


class _Motion(NamedTuple):
    """Joints at some times, (N, 4) each [rad, rad/s, rad/s^2]."""

    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray


@dataclass(frozen=True, eq=False)
class _Corner:
    """Where one line ends and the next begins.

    Attributes:
        q: (4,) [rad].
        before, after: How far the joints move on each line, (4,) [rad].
        ending, beginning: The lines in time.
    """

    q: FloatArray
    before: FloatArray
    after: FloatArray
    ending: SCurve
    beginning: SCurve

    def around(self, overlap: float, time: FloatArray) -> _Motion:
        """The motion while both lines last.

        Args:
            overlap: How long they do [s].
            time: Since the second line began, (N,) [s].
        """
        ending = self.ending.at(self.ending.duration - overlap + time)
        beginning = self.beginning.at(time)
        left = (ending.s - 1.0)[:, None] * self.before
        return _Motion(
            position=self.q + left + beginning.s[:, None] * self.after,
            velocity=ending.rate[:, None] * self.before
            + beginning.rate[:, None] * self.after,
            acceleration=ending.acceleration[:, None] * self.before
            + beginning.acceleration[:, None] * self.after,
        )

    def breaks(self, overlap: float) -> FloatArray:
        """Times between which the jerk is constant, (N,) [s]."""
        ending = self.ending.breaks - (self.ending.duration - overlap)
        times = np.concatenate([[0.0, overlap], ending, self.beginning.breaks])
        return np.unique(times.clip(0.0, overlap))


@dataclass(frozen=True, eq=False)
class BlendedLines:
    """Straight joint lines that overlap in time.

    Attributes:
        way: Their ends, (K, 4) [rad]; two neighbours differ.
        curves: The lines in time, K - 1.
        begins: When each begins, (K - 1,) [s].
        passes: When the arm is nearest to each end, (K,) [s].
        away: How far the tcp, or any point of a link, is from its place there at most,
            (K,) [m].
    """

    way: FloatArray
    curves: tuple[SCurve, ...]
    begins: FloatArray
    passes: FloatArray
    away: FloatArray

    def sampled(self, slowed: float, rate: float | None) -> Samples:
        """The motion at equal steps of time.

        Args:
            slowed: So many times as long it takes.
            rate: Samples per second; None for 50, or fewer if the motion takes long.
        """
        times = Times.of(slowed * float(self.passes[-1]), rate)
        # Stretched as a motion that has to end with a sample.
        stretched = Times(at=times.at / slowed, stretch=slowed * times.stretch)
        return along(self.way, self.curves, self.begins, stretched)


def blended(
    way: FloatArray,
    limits: JointLimits,
    blend: float,
    arm: Arm,
    surroundings: Surroundings,
    rate: float | None,
) -> BlendedLines:
    """Straight joint lines that overlap as long as they may.

    Args:
        way: Their ends, (K, 4), K at least 2; two neighbours differ [rad].
        limits: Of the joints; those that move have speeds above 0.
        blend: How far the tcp, and any point of a link, may be from its place at a
            corner when it passes it [m].
        arm: For its tcp.
        surroundings: In which the lines are free.
        rate: Samples per second, for what is interpolated between them; None for 50.
    """
    times = Times.of(travel_time(way, limits), rate)
    rules = _Rules(
        limits=limits,
        blend=blend,
        arm=arm,
        surroundings=surroundings,
        step=float(times.at[1]) * times.stretch,
    )
    curves = [line_curve(start, end, limits) for start, end in pairwise(way)]
    begins = [0.0]
    passes = [0.0]
    away = [0.0]
    for k, q in enumerate(way[1:-1], start=1):
        corner = _Corner(
            q=q,
            before=q - way[k - 1],
            after=way[k + 1] - q,
            ending=curves[k - 1],
            beginning=curves[k],
        )
        overlap = rules.longest(corner)
        since, distance = rules.passed(corner, overlap) if overlap else (0.0, 0.0)
        begins.append(begins[-1] + corner.ending.duration - overlap)
        passes.append(begins[-1] + since)
        away.append(distance)
    passes.append(begins[-1] + curves[-1].duration)
    away.append(0.0)
    return BlendedLines(
        way=way,
        curves=tuple(curves),
        begins=np.array(begins),
        passes=np.array(passes),
        away=np.array(away),
    )


@dataclass(frozen=True, eq=False)
class _Rules:
    """How a corner may be passed; attributes as the arguments of `blended`.

    Attributes:
        step: Time between two samples [s].
    """

    limits: JointLimits
    blend: float
    arm: Arm
    surroundings: Surroundings
    step: float

    def longest(self, corner: _Corner) -> float:
        """The longest overlap that may be [s]; 0.0 if there is none."""
        # Half of each line is left for the corner at its other end.
        most = min(corner.ending.duration, corner.beginning.duration) / 2
        if self._may(corner, most):
            return most
        longest = 0.0
        for _ in range(_HALVINGS):
            most /= 2
            if self._may(corner, longest + most):
                longest += most
        return longest

    def passed(self, corner: _Corner, overlap: float) -> tuple[float, float]:
        """When the arm is nearest to a corner [s], and how far it then is [m].

        It is the largest distance of the tcp, or of any point of a link, from its place
        at the corner, or more.
        """
        time = np.linspace(0.0, overlap, _CHORDS + 1)
        position = corner.around(overlap, time).position
        tips = frame_positions(self.arm, np.vstack([position, corner.q]))
        of_tcp = np.linalg.norm(tips[:-1] - tips[-1], axis=1)
        strayed = np.abs(position - corner.q) + self._interpolation(corner)
        distance = np.maximum(of_tcp, self.surroundings.displacement(strayed))
        nearest = int(distance.argmin())
        return float(time[nearest]), float(distance[nearest])

    def _may(self, corner: _Corner, overlap: float) -> bool:
        return (
            self._is_within_limits(corner, overlap)
            and self.passed(corner, overlap)[1] <= self.blend
            and self._is_free(corner, overlap)
        )

    def _is_within_limits(self, corner: _Corner, overlap: float) -> bool:
        """Whether no joint is faster, or accelerates more, than it may."""
        breaks = corner.breaks(overlap)
        motion = corner.around(overlap, breaks)
        # Accelerations are straight lines between the breaks.
        first, last = motion.acceleration[:-1], motion.acceleration[1:]
        turns = first * last < 0.0
        share = np.divide(first, first - last, out=np.zeros_like(first), where=turns)
        since = share * np.diff(breaks)[:, None]
        fastest = motion.velocity[:-1] + first * since / 2
        speeds = np.abs(np.concatenate([motion.velocity, fastest]))
        most = self.limits.acceleration * (1.0 + ROUNDING)
        return bool(
            (speeds <= self.limits.speed * (1.0 + ROUNDING)).all()
            and (np.abs(motion.acceleration) <= most).all()
        )

    def _is_free(self, corner: _Corner, overlap: float) -> bool:
        """Whether the way around a corner is proved free."""
        motion = corner.around(overlap, corner.breaks(overlap))
        bend = np.abs(motion.acceleration).max(axis=0)
        strayed = bend * (overlap / _CHORDS) ** 2 / 8 + self._interpolation(corner)
        with_room = self.surroundings.with_room(strayed)
        time = np.linspace(0.0, overlap, _CHORDS + 1)
        position = corner.around(overlap, time).position
        return all(
            with_room.obstruction(start, end) is None
            for start, end in pairwise(position)
        )

    def _interpolation(self, corner: _Corner) -> FloatArray:
        """How far cubics between samples are from the motion at most, (4,) [rad].

        One step of the jerk adds up to ``jerk h^3 / 192``: a cubic with its slopes at
        both ends is a clamped beam, which a force bends so far.
        """
        jerk = np.maximum(
            corner.ending.jerk * np.abs(corner.before),
            corner.beginning.jerk * np.abs(corner.after),
        )
        return np.asarray(_JERKS * jerk * self.step**3 / 192)
