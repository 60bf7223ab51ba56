"""Does the model fit a recording? Named causes why it may not, with their sizes.

References:
    [Rao1948] Rao: Large sample tests of statistical hypotheses concerning several
    parameters, Proceedings of the Cambridge Philosophical Society 44(1).
    [Schwarz1978] Schwarz: Estimating the dimension of a model, Annals of Statistics
    6(2).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers.fluids import AIR, FRESH_WATER, SEA_WATER
from alpha5_model.numbers.tables import JOINT_NAMES

#: A misfit that is less probable than this without a cause is reported.
SIGNIFICANCE = 1e-4
#: Standard deviations by which a factor must be negative to be a wrong sign.
_CERTAIN = 4.0
#: Parts of a column that the fit explains up to this share are not told apart.
_UNSEEN = 1e-6
#: Columns below this share of the largest one are rounding errors.
_ROUNDING = 1e-14
#: A joint that is slower rests: what is left is rounding, whose sign says nothing
#: [rad/s].
_AT_REST = 1e-12
#: Fluids that are taken for one another.
_FLUIDS = (AIR, FRESH_WATER, SEA_WATER)
_COMPONENTS = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")


class Problem(NamedTuple):
    """A cause that explains what the model does not.

    Attributes:
        name: "scale", "sign", "offset", "Coulomb", "viscous", "delay", "fluid",
            "mass of link_2" and so on; "tables" if no numbers within the digits fit;
            "untested" if there are too few samples to know the noise.
        of: What the sizes belong to: joints, components of the load, or a link, (k,).
        size: (k,). A scale and a sign: recorded over computed. An offset [N m, N].
            Coulomb friction [N m], viscous friction [N m s/rad], a delay [s]. A fluid:
            its density [kg/m^3]. A mass: true over printed. Tables: the squared misfit
            over what noise explains. Untested: the number of samples.
        deviation: Standard deviation of each size, (k,); NaN for tables and untested.
        unit: Of size, "" for none.
        gain: Squared misfit, in standard deviations of the noise, that the cause takes
            away, less ``k log(samples)`` [Schwarz1978]; -inf for tables and untested.
            A fluid that has a name costs less than a free density. The largest is rank
            1.
        rank: From 1. Only the first is likely to be the cause: others often explain a
            part of the same misfit.
    """

    name: str
    of: tuple[str, ...]
    size: FloatArray
    deviation: FloatArray
    unit: str
    gain: float
    rank: int

    def __str__(self) -> str:
        if self.name == "untested":
            return f"too few samples ({self.size.item():.0f}): the model was not tested"
        if self.name == "tables":
            return (
                "your data contradict the tables: the best numbers within the digits "
                f"leave {self.size.item():.3g} times the misfit that noise explains"
            )
        unit = f" {self.unit}" if self.unit else ""
        parts = [
            f"{of} {size:.4g} ± {deviation:.2g}{unit}"
            for of, size, deviation in zip(
                self.of, self.size, self.deviation, strict=True
            )
        ]
        return f"{self.name}: {', '.join(parts)}"


class Suspect(NamedTuple):
    """A cause, and how the recording changes with its size.

    Attributes:
        name, of, unit: As of `Problem`.
        columns: Change of the recorded channels by a size of 1, (N, n, k).
        without: Size if the cause is absent: 1 for a factor, or the fluid's density.
        usual: Sizes that a single cause often has: the densities of other fluids.
    """

    name: str
    of: tuple[str, ...]
    unit: str
    columns: FloatArray
    without: float = 0.0
    usual: tuple[float, ...] = ()


def suspects(
    regressor: FloatArray,
    time: FloatArray,
    velocity: FloatArray,
    nominal: FloatArray,
    by_density: FloatArray,
    by_mass: FloatArray,
    density: float,
) -> tuple[Suspect, ...]:
    """The causes that a recording can tell, of efforts (n = 4) or loads (n = 6).

    Args:
        regressor: (N, n, 38).
        time: (N,) [s].
        velocity: Of the joints, (N, 4) [rad/s].
        nominal: Base parameters by the tables, (38,).
        by_density: Their derivative by the fluid's density, (38,).
        by_mass: Their derivative by each link's mass over the printed one, (5, 38).
        density: Of the fluid [kg/m^3].
    """
    computed = regressor @ nominal
    efforts = computed.shape == velocity.shape
    channels = JOINT_NAMES[:4] if efforts else _COMPONENTS
    ones = np.ones_like(computed)
    later = -np.gradient(computed, time, axis=0)[..., None]
    units = "N m" if efforts else "N, N m"
    by_density_column = (regressor @ by_density)[..., None]

    def each(name: str, unit: str, rows: FloatArray, without: float = 0.0) -> Suspect:
        """A cause with a size for each channel."""
        return Suspect(
            name=name, of=channels, unit=unit, columns=_each(rows), without=without
        )

    def single(
        name: str, of: str, unit: str, columns: FloatArray, without: float = 0.0
    ) -> Suspect:
        """A cause with one size."""
        return Suspect(name=name, of=(of,), unit=unit, columns=columns, without=without)

    found = [
        single("scale", "recording", "", computed[..., None], without=1.0),
        each("scale", "", computed, without=1.0),
        each("offset", units, ones),
        single("delay", "recording", "s", later),
        Suspect(
            name="fluid",
            of=("density",),
            unit="kg/m^3",
            columns=by_density_column,
            without=density,
            usual=tuple(other for other in _FLUIDS if other != density),
        ),
    ]
    if efforts:
        moving = np.abs(velocity) > _AT_REST
        direction = np.where(moving, np.sign(velocity), 0.0)
        found.append(each("Coulomb", "N m", direction))
        found.append(each("viscous", "N m s/rad", velocity))
    for link, slope in enumerate(by_mass):
        columns = (regressor @ slope)[..., None]
        name = f"link_{link}"
        found.append(single(f"mass of {name}", name, "", columns, without=1.0))
    return tuple(found)


def _each(rows: FloatArray) -> FloatArray:
    """One column for each channel, (N, n) to (N, n, n)."""
    return np.asarray(rows[..., None] * np.eye(rows.shape[1]))


class Equations(NamedTuple):
    """Least-squares equations of a recording, divided by the noise.

    Attributes:
        restricted: By the unknowns, with the equations of the digits below, (m, count).
        of_suspects: By all columns of the suspects, (m, s).
        rest: What is to be explained, (m,).
        squared: Least squared distance of base parameters within the digits from the
            best unrestricted ones, in standard deviations of the noise.
        rank: Independent combinations of base parameters that the recording tells.
        samples: Measured values.
        independent: Of them, those that the noise leaves independent.
    """

    restricted: FloatArray
    of_suspects: FloatArray
    rest: FloatArray
    squared: float
    rank: int
    samples: int
    independent: float


class _Score(NamedTuple):
    """How much a cause explains.

    Attributes:
        kept: Columns of the cause that the unknowns do not explain, (k,).
        size: By least squares, (k,).
        deviation: Of the sizes, (k,).
        squared: Misfit that it takes away, in standard deviations of the noise.
    """

    kept: Any
    size: FloatArray
    deviation: FloatArray
    squared: float


def named_causes(
    likely: Sequence[Equations], causes: tuple[Suspect, ...]
) -> Iterator[Problem]:
    """Score tests of each cause alone [Rao1948], without rank.

    Args:
        likely: The equations by the best estimate of the noise, then by other noise
            that the recording does not rule out. The chance of a misfit without a
            cause is the mean over all of them.
        causes: To be tested.
    """
    scores = [_scores(equations, causes) for equations in likely]
    for cause, of_cause in zip(causes, zip(*scores, strict=True), strict=True):
        best = of_cause[0]
        if not best.kept.size:
            continue
        chances = [
            _chance(score.squared, score.kept.size, equations.independent)
            for score, equations in zip(of_cause, likely, strict=True)
        ]
        if np.mean(chances) > SIGNIFICANCE:
            continue
        size = cause.without + best.size
        yield Problem(
            name=_name(cause, size + _CERTAIN * best.deviation),
            of=tuple(cause.of[k] for k in best.kept),
            size=size,
            deviation=best.deviation,
            unit=cause.unit,
            gain=_gain(cause, best, likely[0].samples),
            rank=0,
        )


def _gain(cause: Suspect, score: _Score, samples: int) -> float:
    """What a cause explains, less what as many free sizes do by chance [Schwarz1978].

    A usual size is not free, only one of some. Without this, water of another kind
    could not be told from a scale that is off by as much.
    """
    free = score.squared - score.kept.size * np.log(samples)
    gains = [float(free)]
    for usual in cause.usual:
        (off,) = (usual - cause.without - score.size) / score.deviation
        gains.append(float(score.squared - off**2 - 2.0 * np.log(len(cause.usual))))
    return max(gains)


def _scores(equations: Equations, causes: tuple[Suspect, ...]) -> list[_Score]:
    """What each cause alone explains of the rest."""
    basis, _ = np.linalg.qr(equations.restricted)
    columns = equations.of_suspects
    unexplained = columns - basis @ (basis.T @ columns)
    rest = equations.rest - basis @ (basis.T @ equations.rest)
    length = np.linalg.norm(unexplained, axis=0)
    size = np.linalg.norm(columns, axis=0)
    seen = (length > _UNSEEN * size) & (size > _ROUNDING * size.max())
    scores = []
    first = 0
    for cause in causes:
        kept = np.flatnonzero(seen[first : first + len(cause.of)])
        of_cause = unexplained[:, first + kept]
        left, singular, right = np.linalg.svd(of_cause, full_matrices=False)
        explained = left.T @ rest
        inverse = right.T / singular
        score = _Score(
            kept=kept,
            size=inverse @ explained,
            deviation=np.linalg.norm(inverse, axis=1),
            squared=float(explained @ explained),
        )
        scores.append(score)
        first += len(cause.of)
    return scores


def _chance(squared: float, count: int, independent: float) -> float:
    """Chance of a squared misfit this large by noise alone; 1 if nothing explains it.

    The size of slow noise is known from the independent samples only, so that F's
    distribution replaces that of chi-squared.
    """
    from scipy.stats import f

    if not count:
        return 1.0
    return float(f.sf(squared / count, count, independent))


def _name(cause: Suspect, highest: FloatArray) -> str:
    """The cause's name; a scale that is negative is a wrong sign."""
    return "sign" if cause.name == "scale" and (highest < 0).any() else cause.name


def contradiction(likely: Sequence[Equations]) -> Iterator[Problem]:
    """Whether numbers within the digits leave more than noise explains, without rank.

    Args:
        likely: As of `named_causes`.
    """
    best = likely[0]
    if not best.rank:  # as of a recording without weight or motion
        return
    chances = [_chance(one.squared, one.rank, one.independent) for one in likely]
    if np.mean(chances) > SIGNIFICANCE:
        return
    yield Problem(
        name="tables",
        of=("tables",),
        size=np.array([best.squared / best.rank]),
        deviation=np.array([np.nan]),
        unit="",
        gain=-np.inf,
        rank=0,
    )


def untested(samples: int) -> Problem:
    """The problem of a recording whose noise cannot be told."""
    return Problem(
        name="untested",
        of=("samples",),
        size=np.array([float(samples)]),
        deviation=np.array([np.nan]),
        unit="",
        gain=-np.inf,
        rank=1,
    )


def ranked(problems: Iterable[Problem]) -> tuple[Problem, ...]:
    """The problems, the likeliest first; "tables" comes last."""
    order = sorted(problems, key=lambda problem: -problem.gain)
    return tuple(one._replace(rank=k) for k, one in enumerate(order, 1))
