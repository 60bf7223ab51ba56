"""Does the model fit the readings? Named causes why it may not.

With the readings' residuals r about the prior, in standard deviations of the noise, and
A the slopes by all unknowns in those of the prior, ``r^T S^-1 r`` with ``S = 1 + A
A^T`` is chi-squared if nothing is wrong. A cause changes the readings by columns C: it
takes away the part of r that C explains [Rao1948]. Other causes change the readings
themselves, such as two poses in the wrong order.

References:
    [Rao1948] Rao: Large sample tests of statistical hypotheses concerning several
        parameters, Proceedings of the Cambridge Philosophical Society 44(1).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations, permutations
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers.fluids import AIR, FRESH_WATER, SEA_WATER
from alpha5_model.numbers.tables import BODY_NAMES, JOINT_NAMES
from alpha5_model.studies.calibration.equations import Equations
from alpha5_model.studies.calibration.fitting import Estimate
from alpha5_model.studies.calibration.sessions import Session
from alpha5_model.studies.calibration.unknowns import OF_BODIES, PER_BODY

#: A misfit that is less probable without a cause is reported.
SIGNIFICANCE = 1e-4
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
#: How near a factor must be to one of `_UNITS`.
_NEAR = 0.05


#: Readings in the right order leave less than this times the expected misfit; slopes
#: far from the true arm add to it.
_FITS = 3.0
#: A density that is further from that of air and waters is no fluid's [kg/m^3].
_SAME_FLUID = 150.0


@dataclass(frozen=True, eq=False)
class Problem:
    """Something that the readings contradict.

    Attributes:
        name: ``unit``, ``scale``, ``reading``, ``pose``, ``order``, ``channels``,
            ``fluid``, ``zero``, ``mass of link_2`` and so on; ``unexplained`` if no
            known cause explains the misfit.
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


class _Innovation(NamedTuple):
    """What the readings say beyond the prior, made white.

    Attributes:
        whiten: W with ``W S W^T = 1``, (m, m).
        rest: W r, (m,).
    """

    whiten: FloatArray
    rest: FloatArray

    @property
    def squared(self) -> float:
        """Of the misfit."""
        return float(self.rest @ self.rest)

    def explained(self, columns: FloatArray) -> tuple[FloatArray, float]:
        """Sizes of columns (m, k), and how much of the squared misfit they explain."""
        white = self.whiten @ columns
        sizes, *_ = np.linalg.lstsq(white, self.rest, rcond=None)
        return np.asarray(sizes, float), float(np.sum((white @ sizes) ** 2))


def problems(equations: Equations, found: Estimate) -> tuple[Problem, ...]:
    """What speaks against readings, the likeliest first; empty if nothing does."""
    from scipy.stats import chi2

    misfit = bool(chi2.sf(found.squared, found.readings) < SIGNIFICANCE)
    named = _named(equations, found.values, misfit)
    if misfit:
        # Wrong readings may lead so far that the slopes there mean nothing.
        before = _named(equations, equations.middle, misfit)
        named = min(named, before, key=lambda one: one.unexplained)
    listed = list(named.problems)
    if misfit and not listed:
        ratio = found.squared / found.readings
        message = (
            f"the best numbers leave {ratio:.3g} times the squared misfit that noise "
            "and the prior explain, and no known cause does"
        )
        listed.append(
            Problem(name="unexplained", message=message, session="", gain=0.0)
        )
    order = sorted(listed, key=lambda problem: -problem.gain)
    return tuple(replace(one, rank=rank) for rank, one in enumerate(order, 1))


class _Named(NamedTuple):
    """Causes that are found about a point.

    Attributes:
        problems: Without ranks.
        unexplained: Squared misfit that the best of them leaves.
    """

    problems: tuple[Problem, ...]
    unexplained: float


def _named(equations: Equations, point: FloatArray, misfit: bool) -> _Named:
    """The causes of a misfit, all slopes taken at a point."""
    innovation = _innovation(equations, point)
    found = (
        *_of_sessions(equations, innovation, misfit),
        *_of_arm(equations, innovation, point),
    )
    best = max((one.gain for one in found), default=0.0)
    return _Named(problems=found, unexplained=innovation.squared - best)


def _innovation(equations: Equations, point: FloatArray) -> _Innovation:
    """Residuals about the prior, linear about a point."""
    slopes = equations.matrix(point)
    rest = equations.residuals(point) - slopes @ (equations.middle - point)
    scaled = slopes * equations.deviation
    spread = np.eye(len(rest)) + scaled @ scaled.T
    whiten = np.linalg.inv(np.linalg.cholesky(spread))
    return _Innovation(whiten=whiten, rest=whiten @ rest)


def _limit(tests: int, free: int = 1) -> float:
    """What free numbers explain by chance in the best of some tests."""
    from scipy.stats import chi2

    return float(chi2.isf(_OF_CAUSE / tests, free))


# --- causes in one session ------------------------------------------------------------


def _of_sessions(
    equations: Equations, innovation: _Innovation, misfit: bool
) -> Iterator[Problem]:
    """Causes that are one session's."""
    first = 0
    for number, session in enumerate(equations.sessions):
        read = np.isfinite(session.readings)
        rows = slice(first, first + int(read.sum()))
        first = rows.stop
        part = _Part(equations, innovation, number, rows)
        yield from part.scale()
        yield from part.fluid()
        yield from part.readings()
        yield from part.poses()
        if misfit and read.all():
            yield from part.orders()


class _Part:
    """The tests of one session."""

    def __init__(
        self,
        equations: Equations,
        innovation: _Innovation,
        number: int,
        rows: slice,
    ) -> None:
        self.session: Session = equations.sessions[number]
        self._innovation = innovation
        self._rows = rows
        self._number = number
        self._predicted = equations.predicted(equations.middle, number)
        self._by_density = equations.by_density(equations.middle, number)
        self._read = np.isfinite(self.session.readings)

    def scale(self) -> Iterator[Problem]:
        """One factor for all readings: another unit, another sign."""
        sizes, gain = self._explained(self._predicted[..., None])
        factor = 1.0 + sizes.item()
        if gain < _limit(1):
            return
        for unit, words in _UNITS.items():
            if abs(factor / unit - 1.0) < _NEAR:
                yield self._problem("unit", f"the readings are {words}", gain)
                return
        message = f"all readings are {factor:.4g} times what they should be"
        yield self._problem("scale", message, gain)

    def fluid(self) -> Iterator[Problem]:
        """Another fluid than the one that was given."""
        session = self.session
        sizes, gain = self._explained(self._by_density[..., None])
        if gain < _limit(1):
            return
        density = session.density + sizes.item()
        fluids = {"air": AIR, "fresh water": FRESH_WATER, "sea water": SEA_WATER}
        near = min(fluids, key=lambda name: abs(fluids[name] - density))
        if abs(fluids[near] - density) > _SAME_FLUID:
            return
        message = (
            f"the readings are those of a fluid of {density:.0f} kg/m^3 ({near}?), "
            f"not of {session.density:.0f}"
        )
        yield self._problem("fluid", message, gain)

    def readings(self) -> Iterator[Problem]:
        """Single readings that are far from what all others say."""
        places = np.argwhere(self._read)
        white = self._innovation.whiten[:, self._rows]
        length = np.linalg.norm(white, axis=0)
        along = (white.T @ self._innovation.rest) / length
        worst = int(np.abs(along).argmax())
        gain = float(along[worst] ** 2)
        if gain < _limit(len(along)):
            return
        pose, channel = places[worst]
        sensor = self.session.sensor
        off = along[worst] / length[worst] * sensor.noise[channel]
        message = (
            f"{sensor.channels[channel]} in pose {pose + 1} is off by {off:+.4g} "
            f"{sensor.unit[channel]}, by what all others say"
        )
        yield self._problem("reading", message, gain, len(along))

    def poses(self) -> Iterator[Problem]:
        """A pose whose readings are all far off: it is not the one that is noted."""
        count, size = self._read.shape
        found = []
        alone = []
        for pose in range(count):
            columns = np.zeros((count, size, size))
            columns[pose] = np.eye(size) * self.session.sensor.noise[:, None]
            found.append(self._explained(columns)[1])
            one_by_one = np.moveaxis(columns, -1, 0)[..., None]
            alone.append(max(self._explained(one)[1] for one in one_by_one))
        worst = int(np.argmax(found))
        # One wrong reading does not make a wrong pose.
        if found[worst] - alone[worst] >= _limit(count, size):
            message = f"pose {worst + 1} was another one than is noted"
            yield self._problem("pose", message, found[worst], count, size)

    def orders(self) -> Iterator[Problem]:
        """Readings that fit far better in another order, of poses or of channels."""
        before = self._innovation.squared
        tried = [*self._other_orders(), *self._other_channels()]
        squared = [self._squared(readings) for _, _, readings in tried]
        best = int(np.argmin(squared))
        fits = squared[best] < _FITS * len(self._innovation.rest)
        if fits and before - squared[best] > _limit(len(tried)):
            name, message, _ = tried[best]
            yield self._problem(name, message, before - squared[best], len(tried))

    def _other_orders(self) -> Iterator[tuple[str, str, FloatArray]]:
        """Other orders of the poses, with their names and words."""
        readings = self.session.readings
        count = len(readings)
        for one, other in combinations(range(count), 2):
            rows = np.arange(count)
            rows[[one, other]] = other, one
            message = f"poses {one + 1} and {other + 1} are in the wrong order"
            yield "order", message, readings[rows]
        for by in (1, -1):
            message = f"the readings are {'early' if by == 1 else 'late'} by one pose"
            yield "order", message, np.roll(readings, by, axis=0)
        yield "order", "the readings are in the reverse order", readings[::-1]

    def _other_channels(self) -> Iterator[tuple[str, str, FloatArray]]:
        """Other orders of three scales."""
        sensor = self.session.sensor
        if sensor.kind != "scales":
            return
        for order in permutations(range(3)):
            if order != (0, 1, 2):
                names = ", ".join(sensor.channels[k] for k in order)
                message = f"the scales are mixed up: what is noted is {names}"
                yield "channels", message, self.session.readings[:, np.argsort(order)]

    def _squared(self, readings: FloatArray) -> float:
        """Squared misfit with other readings."""
        change = (readings - self.session.readings) / self.session.sensor.noise
        rest = (
            self._innovation.rest
            + self._innovation.whiten[:, self._rows] @ (change[self._read])
        )
        return float(rest @ rest)

    def _explained(self, columns: FloatArray) -> tuple[FloatArray, float]:
        """Of columns (N, k, c) in the sensor's units."""
        scaled = columns / self.session.sensor.noise[:, None]
        whole = np.zeros((len(self._innovation.rest), columns.shape[-1]))
        whole[self._rows] = scaled[self._read]
        return self._innovation.explained(whole)

    def _problem(
        self, name: str, message: str, gain: float, tests: int = 1, free: int = 1
    ) -> Problem:
        chance = free * np.log(len(self._innovation.rest)) + 2.0 * np.log(tests)
        return Problem(
            name=name,
            message=message,
            session=self.session.name,
            gain=float(gain - chance),
        )


# --- causes that all sessions share ---------------------------------------------------


def _of_arm(
    equations: Equations, innovation: _Innovation, point: FloatArray
) -> Iterator[Problem]:
    """Masses and zeros that are further off than the prior allows."""
    slopes = equations.matrix(point)
    chance = float(np.log(len(innovation.rest)))
    for link, name in enumerate(BODY_NAMES):
        row = link * PER_BODY
        sizes, gain = innovation.explained(slopes[:, [row]])
        if gain > _limit(len(BODY_NAMES)):
            mass = equations.middle[row] + sizes.item()
            message = f"{mass:.4g} kg instead of {equations.middle[row]:.4g}"
            yield Problem(
                name=f"mass of {name}",
                message=message,
                session="",
                gain=gain - chance,
            )
    for joint, name in enumerate(JOINT_NAMES[:4]):
        row = OF_BODIES + joint
        sizes, gain = innovation.explained(slopes[:, [row]])
        if gain > _limit(4):
            off = np.degrees(sizes.item())
            message = f"{name} reports {-off:+.3g} deg too much"
            yield Problem(name="zero", message=message, session="", gain=gain - chance)
