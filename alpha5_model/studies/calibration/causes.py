"""Does the model fit the readings? Named causes why it may not.

With the readings' residuals r about the prior, in standard deviations of the noise, and
A the slopes by all unknowns in those of the prior, ``r^T S^-1 r`` with ``S = 1 + A
A^T`` is chi-squared if nothing is wrong. A cause changes the readings by columns C: it
takes away the part of r that C explains [Rao1948]. Swapped scales and other fluids have
a change of a known size instead.

References:
    [Rao1948] Rao: Large sample tests of statistical hypotheses concerning several
        parameters, Proceedings of the Cambridge Philosophical Society 44(1).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import permutations
from typing import NamedTuple, Self

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.errors import InputError
from alpha5_model.numbers.fluids import AIR, FRESH_WATER, SEA_WATER
from alpha5_model.numbers.tables import BODY_NAMES, JOINT_NAMES
from alpha5_model.studies.arm_numbers import OF_BODIES, PER_BODY
from alpha5_model.studies.calibration.equations import Equations, Noise

#: A misfit that is less probable without a cause is reported.
_SIGNIFICANCE = 1e-4
#: The same of what one cause explains. There are many, and slopes are not constant.
_OF_CAUSE = 1e-6
#: Factors of units that people mix up -> what was done.
_UNITS = {
    1000.0: "1000 times too large: thousandths of the unit?",
    0.001: "1000 times too small: another unit?",
    9.80665: "9.81 times too large: newtons for kilograms?",
    1 / 9.80665: "9.81 times too small: kilograms for newtons?",
    2.204623: "2.2 times too large: pounds for kilograms?",
    35.27396: "35 times too large: ounces for kilograms?",
    0.0352740: "28 times too small: ounces for grams?",
    -1.0: "of the other sign",
}
#: How near a factor must be to one of `_UNITS`, and to a change of a known size.
_NEAR = 0.05
#: Fluids that are taken for one another.
_FLUIDS = {"air": AIR, "fresh water": FRESH_WATER, "sea water": SEA_WATER}
#: Slopes say nothing of zeros that are further off [rad].
_FARTHEST_ZERO = np.radians(45.0)
#: Step of the time by which readings are late [s].
_DELAY = 1e-3
#: Readings are not late by more [s].
_LONGEST_DELAY = 1.0
#: A cause of which the unknowns leave less than this share cannot be told.
_UNSEEN = 1e-4
#: Causes that are listed at most: all but the first often explain a part of it.
_MOST = 5
#: A link of a third or of three times its mass is another link.
_OTHER_MASS = 3.0
#: Correlated noise of this many times the stated one is a misfit.
_NOISY = 3.0


@dataclass(frozen=True, eq=False)
class Problem:
    """Something that the readings contradict.

    Attributes:
        name: ``unit``, ``scale``, ``reading``, ``pose``, ``tare``, ``channels``,
            ``fluid``, ``delay``, ``zero``, ``mass of link_2`` and so on;
            ``unexplained`` if no known cause explains the misfit.
        message: What it is, in words.
        session: Of the readings; empty for what all sessions share.
        gain: By how much the squared misfit, in standard deviations, shrinks if the
            cause is taken into account, less what chance explains with as many free
            numbers.
        rank: From 1, the likeliest first. Only the first is likely to be the cause.
    """

    name: str
    message: str
    session: str
    gain: float
    rank: int = 0

    def __str__(self) -> str:
        where = f" ({self.session})" if self.session else ""
        return f"{self.name}{where}: {self.message}"


class Linear(NamedTuple):
    """The readings as linear equations of the unknowns, about some values.

    ``A = left * s @ directions.T`` are the slopes in standard deviations of noise and
    prior.

    Attributes:
        values: Where, (K,).
        noise: Of each session.
        slopes: By the unknowns, in standard deviations of the noise, (m, K).
        rest: Read less predicted by the middle of the unknowns, in those, (m,).
        left: (m, r).
        singular: s, (r,).
        directions: (K, r).
    """

    values: FloatArray
    noise: Sequence[Noise]
    slopes: FloatArray
    rest: FloatArray
    left: FloatArray
    singular: FloatArray
    directions: FloatArray

    @classmethod
    def about(
        cls,
        equations: Equations,
        values: FloatArray,
        slopes: Sequence[FloatArray],
        noise: Sequence[Noise],
    ) -> Self:
        """The equations about some values.

        Args:
            equations: All readings.
            values: (K,).
            slopes: Of each session's readings there, (N, k, K).
            noise: Of each session.
        """
        rows = equations.rows(slopes, noise)
        rest = equations.rows(equations.residuals(values), noise)
        scaled = rows * equations.deviation
        left, singular, right = np.linalg.svd(scaled, full_matrices=False)
        return cls(
            values=values,
            noise=noise,
            slopes=rows,
            rest=rest - rows @ (equations.middle - values),
            left=left,
            singular=singular,
            directions=right.T,
        )

    @property
    def share(self) -> FloatArray:
        """How much of each combination's variance the readings take away, (r,)."""
        return np.asarray(self.singular**2 / (1.0 + self.singular**2))

    def white(self, columns: FloatArray) -> FloatArray:
        """``S^-1/2`` times columns (m, ...)."""
        shrunk = 1.0 - 1.0 / np.sqrt(1.0 + self.singular**2)
        return np.asarray(columns - (self.left * shrunk) @ (self.left.T @ columns))


def problems(
    equations: Equations,
    linear: tuple[Linear, Linear],
    squared: float,
    correlated: bool,
) -> tuple[Problem, ...]:
    """What speaks against readings, the likeliest first; empty if nothing does.

    Args:
        equations: All readings.
        linear: Them about the middle of the prior, and about the fit.
        squared: Misfit of the fit.
        correlated: Whether its noise was estimated.
    """
    from scipy.stats import chi2

    prior, fitted = linear
    readings = len(fitted.rest)
    if correlated:
        rest = equations.rows(
            equations.residuals(fitted.values), equations.stated_noise()
        )
        excess = float(np.sqrt(np.mean(rest**2)))
        misfit = excess > _NOISY
        words = f"{excess:.3g} times the noise that the sensor states"
    else:
        misfit = bool(chi2.sf(squared, readings) < _SIGNIFICANCE)
        words = f"{squared / readings:.3g} times the squared misfit that noise and the "
        words += "prior explain"

    score = _Score(equations, fitted)
    if misfit:
        # Wrong readings may lead so far that the slopes there mean nothing.
        before = _Score(equations, prior)
        score = min(score, before, key=lambda one: one.unexplained)
    named = score.problems
    if misfit and not named:
        message = f"the best numbers leave {words}, and no known cause does"
        named = [Problem("unexplained", message, session="", gain=0.0)]
    order = sorted(named, key=lambda problem: -problem.gain)[:_MOST]
    return tuple(replace(one, rank=rank) for rank, one in enumerate(order, 1))


class _Score:
    """Causes of a misfit, with all slopes taken at one point.

    Attributes:
        problems: The causes that explain more than chance, without ranks.
        unexplained: Squared misfit that the best of them leaves.
    """

    def __init__(self, equations: Equations, linear: Linear) -> None:
        self._equations = equations
        self._linear = linear
        self._rest = linear.white(linear.rest)
        self.problems: list[Problem] = []
        for number, session in enumerate(equations.sessions):
            if session.is_read:
                self._factors(number)
                self._fluids(number)
                if session.sensor.alike:
                    self._swapped(number)
                if session.moves:
                    self._delay(number)
                if not linear.noise[number].correlation.any():
                    self._single_readings(number)
        self._of_arm()
        best = max((one.gain for one in self.problems), default=0.0)
        self.unexplained = float(self._rest @ self._rest) - best

    # --- causes of a known shape ------------------------------------------------------

    def _factors(self, number: int) -> None:
        """One factor for all readings, or for one channel: another unit or sign."""
        session = self._equations.sessions[number]
        predicted = self._equations.predicted(self._equations.middle, number)
        channels = np.eye(session.sensor.size)
        parts = [("the readings are", "all readings are", np.ones(session.sensor.size))]
        if session.sensor.size > 1:
            for channel, one in zip(session.sensor.channels, channels, strict=True):
                parts.append(
                    (f"those of {channel} are", f"those of {channel} are", one)
                )
        for of_unit, of_scale, part in parts:
            size, gain = self._explained(self._rows(number, predicted * part))
            factor = 1.0 + size
            if gain < _limit(len(parts)):
                continue
            unit = [w for unit, w in _UNITS.items() if abs(factor / unit - 1) < _NEAR]
            if unit:
                self._add("unit", f"{of_unit} {unit[0]}", gain, number, len(parts))
            elif factor > 0.0:
                words = f"{of_scale} {factor:.4g} times what they should be"
                self._add("scale", words, gain, number, len(parts))

    def _fluids(self, number: int) -> None:
        """Another fluid than the one that was given."""
        equations = self._equations
        session = equations.sessions[number]
        predicted = equations.predicted(equations.middle, number)
        for name, density in _FLUIDS.items():
            try:
                session.sensor.check(session.gravity, density, session.moves)
            except InputError:
                continue  # a vehicle does not float in air
            if density != session.density:
                other = equations.predicted(equations.middle, number, density)
                words = f"the readings are those of {name} ({density:g} kg/m^3)"
                words += f", not of a fluid of {session.density:g} kg/m^3"
                change = self._rows(number, other - predicted)
                self._add_known("fluid", words, change, number, len(_FLUIDS))

    def _swapped(self, number: int) -> None:
        """Readings of like channels that are mixed up."""
        session = self._equations.sessions[number]
        if not np.isfinite(session.readings).all():
            return
        orders = [*permutations(range(session.sensor.size))][1:]
        for order in orders:
            names = ", ".join(session.sensor.channels[k] for k in order)
            words = f"the channels are mixed up: what is noted is {names}"
            right = session.readings[:, np.argsort(order)]
            change = self._rows(number, session.readings - right)
            self._add_known("channels", words, change, number, len(orders))

    def _delay(self, number: int) -> None:
        """Readings that are late."""
        equations = self._equations
        session = equations.sessions[number]
        earlier = replace(
            session,
            q=session.q - _DELAY * session.v,
            v=session.v - _DELAY * session.a,
        )
        sessions = [*equations.sessions]
        sessions[number] = earlier
        late = Equations(equations.numbers, sessions)
        middle = equations.middle
        change = late.predicted(middle, number) - equations.predicted(middle, number)
        size, gain = self._explained(self._rows(number, change / _DELAY))
        if gain > _limit(1) and abs(size) < _LONGEST_DELAY:
            self._add("delay", f"the readings are late by {size:.3g} s", gain, number)

    # --- readings that are wrong each by itself ---------------------------------------

    def _single_readings(self, number: int) -> None:
        """A wrong reading, a wrong pose, or a sensor that was zeroed in the middle.

        Of unit columns e, all ``e^T S^-1 e`` and ``e^T S^-1 r`` are made at once; steps
        are sums of them. A group counts only if it explains more than its best channel.
        """
        linear = self._linear
        session = self._equations.sessions[number]
        sensor = session.sensor
        read = np.isfinite(session.readings)
        rows = self._equations.rows_of(number)
        poses, channels = self._equations.places(number)
        along = np.zeros(read.shape)
        along[poses, channels] = linear.white(self._rest)[rows]
        by = np.zeros((*read.shape, len(linear.singular)))
        by[poses, channels] = linear.left[rows] * np.sqrt(linear.share)
        # From each pose on: sums over the later ones.
        steps = [
            np.cumsum(x[::-1], axis=0)[::-1] for x in (along, by, read.astype(float))
        ]

        size, gain = _alone(along, by, read.astype(float))
        pose, channel = divmod(int(gain.argmax()), sensor.size)
        if gain[pose, channel] > _limit(gain.size):
            off = size[pose, channel] * sensor.deviation[channel]
            words = f"{sensor.channels[channel]} in pose {pose + 1} is off by "
            words += f"{off:+.4g} {sensor.unit[channel]}, by what all others say"
            self._add("reading", words, gain[pose, channel], number, gain.size)

        together = _together(along, by, read.astype(float))
        pose = int(np.argmax(together))
        extra = together[pose] - gain[pose].max()
        if sensor.size > 1 and extra > _limit(len(read), sensor.size - 1):
            words = f"pose {pose + 1} was another one than is noted"
            tests = len(read)
            self._add("pose", words, together[pose], number, tests, sensor.size)

        # One reading before or after is a wrong reading, not a step.
        inner = slice(2, len(read) - 1)
        size, gain = (part[inner] for part in _alone(*steps))
        if not gain.size:
            return
        pose, channel = divmod(int(gain.argmax()), sensor.size)
        if gain[pose, channel] > _limit(gain.size):
            jump = size[pose, channel] * sensor.deviation[channel]
            words = f"{sensor.channels[channel]} was zeroed again from pose {pose + 3} "
            words += f"on: from there it shows {jump:+.4g} {sensor.unit[channel]}"
            self._add("tare", words, gain[pose, channel], number, gain.size)
        together = _together(*steps)[inner]
        pose = int(np.argmax(together))
        extra = together[pose] - gain[pose].max()
        if sensor.size > 1 and extra > _limit(len(read), sensor.size - 1):
            words = f"the sensor was zeroed again from pose {pose + 3} on"
            tests = len(read)
            self._add("tare", words, together[pose], number, tests, sensor.size)

    # --- causes that all sessions share -----------------------------------------------

    def _of_arm(self) -> None:
        """Masses and zeros that are further off than the prior allows."""
        middle = self._equations.middle
        slopes = self._linear.slopes
        for link, name in enumerate(BODY_NAMES):
            row = link * PER_BODY
            size, gain = self._explained(slopes[:, row])
            mass = middle[row] + size
            likely = 1.0 / _OTHER_MASS < mass / middle[row] < _OTHER_MASS
            if gain > _limit(len(BODY_NAMES)) and likely:
                words = f"{mass:.4g} kg instead of {middle[row]:.4g}"
                self._add(f"mass of {name}", words, gain)
        for joint, name in enumerate(JOINT_NAMES[:4]):
            size, gain = self._explained(slopes[:, OF_BODIES + joint])
            if gain > _limit(4) and abs(size) < _FARTHEST_ZERO:
                words = f"{name} reports {-np.degrees(size):+.3g} deg too much"
                self._add("zero", words, gain)

    # --- scores -----------------------------------------------------------------------

    def _rows(self, number: int, values: FloatArray) -> FloatArray:
        """A change of a session's readings (N, k) in the rows of all, (m,)."""
        changes = [np.zeros(one.readings.shape) for one in self._equations.sessions]
        changes[number] = values
        return self._equations.rows(changes, self._linear.noise)

    def _explained(self, column: FloatArray) -> tuple[float, float]:
        """Size of a column (m,), and the squared misfit that it takes away."""
        white = self._linear.white(column)
        squared = float(white @ white)
        if squared <= _UNSEEN**2 * float(column @ column):
            return 0.0, 0.0
        along = float(white @ self._rest)
        return along / squared, along**2 / squared

    def _add_known(
        self, name: str, words: str, change: FloatArray, number: int, tests: int
    ) -> None:
        """A cause whose change of the readings (m,) is known, if it explains them."""
        size, gain = self._explained(change)
        white = self._linear.white(change)
        squared = float(white @ white)
        left = squared * (size - 1.0) ** 2
        near = abs(size - 1.0) < _NEAR or left < _limit(1)
        if near and gain - left > _limit(tests):
            self._add(name, words, gain - left, number, tests, free=0)

    def _add(
        self,
        name: str,
        words: str,
        gain: float,
        number: int | None = None,
        tests: int = 1,
        free: int = 1,
    ) -> None:
        """A problem; chance explains as much as free numbers, the best of some tests."""
        chance = free * np.log(len(self._rest)) + 2.0 * np.log(tests)
        session = "" if number is None else self._equations.sessions[number].name
        self.problems.append(Problem(name, words, session, float(gain - chance)))


def _limit(tests: int, free: int = 1) -> float:
    """What free numbers explain by chance in the best of some tests."""
    from scipy.stats import chi2

    return float(chi2.isf(_OF_CAUSE / tests, free))


def _alone(
    along: FloatArray, by: FloatArray, count: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Sizes of single columns, and what each explains, (N, k) both.

    Args:
        along: ``e^T S^-1 r`` of each column, (N, k).
        by, count: ``e^T S^-1 e`` is ``count - by^T by``, (N, k, r) and (N, k).
    """
    squared = count - (by**2).sum(axis=-1)
    seen = squared > _UNSEEN**2 * count
    size = np.divide(along, squared, out=np.zeros_like(along), where=seen)
    return size, size * along


def _together(along: FloatArray, by: FloatArray, count: FloatArray) -> FloatArray:
    """What the columns of all channels explain together, (N,); see `_alone`."""
    unit = np.eye(along.shape[1])
    squared = count[..., None] * unit - by @ by.swapaxes(1, 2)
    squared += (count[..., None] == 0.0) * unit
    size = np.linalg.solve(squared, along[..., None])[..., 0]
    return np.asarray((size * along).sum(axis=1))
