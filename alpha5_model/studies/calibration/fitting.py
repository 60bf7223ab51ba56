"""The most probable numbers of an arm, by what was known and what was measured.

Each unknown x has a value m and a standard deviation s before the readings. The fit has
the least sum of squares of ``(x - m) / s`` and of the readings' misfits, each over its
noise. Readings are linear in the unknowns but for small products, so that their slopes
are taken at the middle first, then where that led.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import (
    BoolArray,
    FloatArray,
    flag,
    instance,
    listed,
    real,
)
from alpha5_model._support.files import PathLike
from alpha5_model._support.writing import atomic_write
from alpha5_model.errors import InputError
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.arm_writing import arm_file_text
from alpha5_model.numbers.covariance import Covariance
from alpha5_model.numbers.parameters import (
    Alpha5Parameters,
    Measurement,
    chosen_arm,
)
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.studies.arm_numbers import OF_BODIES, PER_BODY, load_slopes
from alpha5_model.studies.calibration.ar1 import ROUNDS, correlation, whitened
from alpha5_model.studies.calibration.causes import Linear, Problem, problems
from alpha5_model.studies.calibration.equations import (
    TILT,
    ZEROS,
    Equations,
    Noise,
    prior_numbers,
)
from alpha5_model.studies.calibration.possible_bodies import possible_values
from alpha5_model.studies.calibration.sessions import Session

#: The search goes no further from the prior, in its standard deviations, so that even
#: wrong readings leave an arm.
_FARTHEST = 12.0
#: A fit that moves less than this, in standard deviations, needs no new slopes.
_SETTLED = 0.01
#: Step of the derivatives of possible values, in those.
_STEP = 1e-4
#: Directions whose variance shrinks by less than this share are left out.
_LEAST_GAIN = 1e-6
#: Readings of a channel, less what was fitted to them, that tell their noise.
_LEAST_FREEDOM = 20
#: Random poses over which the remaining torque is averaged.
_POSES = 200
#: A number is said to be learnt if its standard deviation shrinks below this share.
_LEARNT = 0.5


@dataclass(frozen=True, eq=False)
class Calibration:
    """What measurements say of an arm. `print` shows the problems first.

    Attributes:
        arm: Its record, with half widths (sqrt(3) standard deviations) and covariance.
        problems: What the readings contradict, the likeliest first; see `Problem`.
            Believe the arm only if there are none.
        names: Of the numbers that were unknown, (K,), by their keys in an arm file.
        estimate: Their values, SI units, (K,); zeros as in the arm file.
        prior, deviation: Their standard deviations before and after, (K,).
        other_names, other_estimate, other_deviation: The same of tilts, gains, offsets
            and so on, each with the number of its session, (n,).
        noise: Standard deviation of each channel of each session: the sensor's, or if
            it is correlated, that of the readings, (k,) each.
        correlation: Of the noise of a reading and the next, (k,) each.
        squared: Least sum of squared misfits and changes, each in standard deviations;
            near ``readings`` if the model holds.
        readings: Number of readings.
        density: Of the fluid of the next two [kg/m^3].
        torque_before, torque_after: Standard deviation of the torques that hold the arm
            still at reported joint positions, averaged over poses, (4,) [N m].
    """

    arm: Alpha5Parameters
    problems: tuple[Problem, ...]
    names: tuple[str, ...]
    estimate: FloatArray
    prior: FloatArray
    deviation: FloatArray
    other_names: tuple[str, ...]
    other_estimate: FloatArray
    other_deviation: FloatArray
    noise: tuple[FloatArray, ...]
    correlation: tuple[FloatArray, ...]
    squared: float
    readings: int
    density: float
    torque_before: FloatArray
    torque_after: FloatArray

    def text(self) -> str:
        """The arm file."""
        notes = [f"problem {one.rank}: {one}" for one in self.problems]
        return arm_file_text(self.arm, notes)

    def write(self, path: PathLike) -> None:
        """Write the arm file, which `alpha5_model.arm_file` reads.

        Raises:
            OutputError: It cannot be written.
        """
        atomic_write(path, self.text())

    def __str__(self) -> str:
        lines = [f"problem {one.rank}: {one}" for one in self.problems]
        if self.problems:
            lines.append("")
        lines.append(
            f"{self.readings} readings, squared misfit {self.squared:.4g} "
            f"({self.readings} expected)"
        )
        lines.append(
            "torque that holds the arm, one standard deviation, "
            f"fluid of {self.density:g} kg/m^3"
        )
        torques = zip(JOINT_NAMES, self.torque_before, self.torque_after, strict=False)
        for joint, before, after in torques:
            lines.append(f"  {joint}: {1e3 * before:.3f} -> {1e3 * after:.3f} mN m")
        lines.append("learnt most")
        share = self.deviation / self.prior
        for k in np.argsort(share, kind="stable"):
            if share[k] < _LEARNT:
                known = f"± {self.deviation[k]:.2g} (before {self.prior[k]:.2g})"
                lines.append(f"  {self.names[k]}: {self.estimate[k]:.6g} {known}")
        return "\n".join(lines)

    def __repr__(self) -> str:
        return f"<Calibration: {len(self.problems)} problems, {self.readings} readings>"


def fit(
    sessions: Session | Iterable[Session],
    *,
    arm: Alpha5Parameters | None = None,
    prior: str = "digits",
    zeros: float = ZEROS,
    tilt: float = TILT,
    correlated: bool = False,
) -> Calibration:
    """Fit an arm's bodies, zeros and lengths to readings.

    The result is the most probable arm: the least sum of squares of the readings'
    misfits and of the changes from what was known before, each in standard deviations.
    Tilt of the mount, gains, offsets and places of the sensor are unknown in each
    session. The bodies found are physically possible, and their centres of mass lie
    within the bounds.

    Args:
        sessions: From `session` or `read_session`; for example one in air and one in
            water.
        arm: Record of the arm before; None for the catalogue's.
        prior: ``digits``: its numbers are as good as their printed digits, or as the
            half widths of its file. ``loose``: masses and volumes are known to 10 %,
            centres to 5 mm, one standard deviation each.
        zeros: Standard deviation of the zeros of the joints [rad].
        tilt: That of the tilt of the mount about two axes [rad].
        correlated: Whether a reading shares noise with the one before it, as in a
            recording. Then size and correlation of each channel's noise are estimated,
            too, from readings at even times.

    Raises:
        InputError: Nothing is read, or the arm is calibrated already.
        UnknownNameError: No such prior.

    Warns:
        ImplausibleWarning: Two sessions have the same poses and readings.
    """
    given = [sessions] if isinstance(sessions, Session) else sessions
    measured = [
        instance("sessions", one, Session)
        for one in listed("sessions", given, "sessions")
    ]
    if not any(one.is_read for one in measured):
        expected = "at least one session with readings"
        raise InputError("sessions", [one.name for one in measured], expected)
    _warn_of_copies(measured)
    flag("correlated", correlated)
    own = chosen_arm(arm)
    moves = any(one.moves for one in measured)
    numbers = prior_numbers(own, prior, zeros, moves)
    equations = Equations(numbers, measured, real("tilt", tilt, minimum=0.0))

    found = estimated(equations, correlated)
    deviation = found.deviation(equations.deviation)
    free = np.flatnonzero(equations.deviation)
    of_arm = free[free < equations.of_arm]
    others = free[free >= equations.of_arm]
    record = _calibrated(own, equations, found, prior == "loose")
    before, after = _torques(equations, found, measured[-1])
    return Calibration(
        arm=record,
        problems=problems(equations, found.linear, found.squared, correlated),
        names=tuple(equations.names[k] for k in of_arm),
        estimate=found.values[of_arm],
        prior=equations.deviation[of_arm],
        deviation=deviation[of_arm],
        other_names=tuple(equations.names[k] for k in others),
        other_estimate=found.values[others],
        other_deviation=deviation[others],
        noise=tuple(one.deviation for one in found.noise),
        correlation=tuple(one.correlation for one in found.noise),
        squared=found.squared,
        readings=len(found.linear[-1].rest),
        density=measured[-1].density,
        torque_before=before,
        torque_after=after,
    )


def _warn_of_copies(sessions: Sequence[Session]) -> None:
    """Warn of sessions with the same readings: a file may have been given twice."""
    seen: dict[bytes, str] = {}
    for one in sessions:
        content = one.q.tobytes() + one.readings.tobytes()
        if one.is_read and content in seen:
            same = f"{one.name} has the poses and readings of {seen[content]}"
            plausibility.warn(f"sessions: {same}, which count twice")
        seen[content] = one.name


class Estimate(NamedTuple):
    """The most probable unknowns, and how well they are known.

    Attributes:
        values: (K,).
        squared: Least sum of squares of residuals and of changes from the prior, each
            in standard deviations. If the model holds, it is chi-squared with as many
            degrees of freedom as there are readings.
        factor: With the prior's standard deviations D, the covariance is
            ``D (1 - F F^T) D``, (K, r).
        noise: Of each session.
        linear: The equations about the middle, and about the values.
    """

    values: FloatArray
    squared: float
    factor: FloatArray
    noise: Sequence[Noise]
    linear: tuple[Linear, Linear]

    def deviation(self, prior: FloatArray) -> FloatArray:
        """Standard deviations, (K,), by those of the prior."""
        left = 1.0 - (self.factor**2).sum(axis=1)
        return np.asarray(prior * np.sqrt(np.maximum(left, 0.0)))


def estimated(equations: Equations, correlated: bool = False) -> Estimate:
    """The most probable unknowns of some readings."""
    from scipy.optimize import least_squares

    middle, deviation = equations.middle, equations.deviation
    chosen = np.flatnonzero(deviation)
    noise = equations.stated_noise()

    def values_of(z: FloatArray) -> FloatArray:
        free = np.zeros(len(middle))
        free[chosen] = z
        return possible_values(equations.numbers.arm, middle, deviation, free)

    def misfit(z: FloatArray) -> FloatArray:
        values = values_of(z)
        change = (values - middle)[chosen] / deviation[chosen]
        rows = equations.rows(equations.residuals(values), noise)
        return np.concatenate([rows, change])

    z = np.zeros(len(chosen))
    values = middle
    slopes = of_middle = equations.slopes(middle)
    for turn in range(ROUNDS):
        by_free = np.empty((len(middle), len(z)))
        for k, step in enumerate(_STEP * np.eye(len(z))):
            by_free[:, k] = (values_of(z + step) - values_of(z - step)) / (2 * _STEP)
        change = by_free[chosen] / deviation[chosen, None]
        matrix = np.vstack([-equations.rows(slopes, noise) @ by_free, change])
        # Only the part along the columns changes, as far as the slopes do not.
        basis, triangle = np.linalg.qr(matrix)
        search = least_squares(
            lambda z, basis=basis: basis.T @ misfit(z),
            z,
            lambda _, triangle=triangle: triangle,
            bounds=(-_FARTHEST, _FARTHEST),
            xtol=1e-8,
            ftol=1e-8,
            gtol=None,
            max_nfev=50,
        )
        moved = np.abs(search.x - z).max()
        z = search.x
        values = values_of(z)
        if turn and moved < _SETTLED and not correlated:
            break
        try:
            slopes = equations.slopes(values)
        except InputError:
            break  # wild readings lead to the edge of what is possible
        if correlated:
            noise = _estimated_noise(equations, values, slopes, noise)

    squared = float(np.sum(misfit(z) ** 2))
    linear = (
        Linear.about(equations, middle, of_middle, noise),
        Linear.about(equations, values, slopes, noise),
    )
    share = linear[1].share
    kept = share > _LEAST_GAIN
    factor = linear[1].directions[:, kept] * np.sqrt(share[kept])
    told = _is_told(factor)
    for first in range(0, OF_BODIES, PER_BODY):
        # Moments of inertia are possible together only.
        inertia = slice(first + 4, first + 10)
        told[inertia] = told[inertia].any()
    values = np.where(told, values, middle)
    return Estimate(
        values=values,
        squared=squared,
        factor=factor,
        noise=noise,
        linear=linear,
    )


def _estimated_noise(
    equations: Equations,
    values: FloatArray,
    slopes: Sequence[FloatArray],
    before: Sequence[Noise],
) -> list[Noise]:
    """Size and correlation of each channel's noise, by what a fit leaves.

    Where readings are too few for the unknowns, the noise is what the sensor states.

    Args:
        equations: All readings.
        values: The fit, (K,).
        slopes: Of each session's readings, (N, k, K).
        before: The noise that was fitted with.
    """
    scaled = equations.rows(slopes, before) * equations.deviation
    _, singular, combinations = np.linalg.svd(scaled, full_matrices=False)
    # What the readings tell less of than the prior was hardly fitted to them.
    fitted = equations.deviation[:, None] * combinations[singular > 1.0].T

    found = []
    stated = equations.stated_noise()
    for rest, by, (deviation, rho) in zip(
        equations.residuals(values), slopes, stated, strict=True
    ):
        for channel in range(rest.shape[1]):
            steps = np.flatnonzero(np.isfinite(rest[:, channel]))
            columns = by[steps, channel] @ fitted
            freedom = len(steps) - columns.shape[1]
            if freedom < _LEAST_FREEDOM:
                continue
            left = rest[steps, channel]
            rho[channel] = correlation(left, columns, steps)
            chance = whitened(left, rho[channel], steps)
            size = np.sqrt(chance @ chance / freedom)
            deviation[channel] = size / np.sqrt(1.0 - rho[channel] ** 2)
        found.append(Noise(deviation, rho))
    return found


def _is_told(factor: FloatArray) -> BoolArray:
    """Which unknowns the readings say anything of, (K,)."""
    return np.asarray((factor**2).sum(axis=1) > _LEAST_GAIN)


def _calibrated(
    arm: Alpha5Parameters, equations: Equations, found: Estimate, loose: bool
) -> Alpha5Parameters:
    """The arm's record with its new numbers, their half widths and covariance."""
    of_arm = equations.of_arm
    deviation = equations.deviation[:of_arm]
    factor = found.factor[:of_arm]
    known = np.flatnonzero((deviation > 0.0) & (_is_told(factor) | loose))
    left, singular, _ = np.linalg.svd(factor[known], full_matrices=False)
    kept = singular**2 > _LEAST_GAIN
    covariance = Covariance(
        names=tuple(equations.names[k] for k in known),
        deviation=deviation[known],
        factor=left[:, kept] * singular[kept],
    )
    sources = [f"{one.sensor.kind}, {one.name}" for one in equations.sessions]
    source = f"calibrated: {', '.join(sources)}"
    half_widths = covariance.half_widths
    others = [one for one in arm.measurements if one.key not in half_widths]
    measured = [
        Measurement(key=key, source=source, half_width=half_width)
        for key, half_width in half_widths.items()
    ]
    return replace(
        equations.numbers.record(found.values[:of_arm]),
        corrections=arm.corrections,
        measurements=(*others, *measured),
        covariance=covariance,
    )


def _torques(
    equations: Equations, found: Estimate, session: Session
) -> tuple[FloatArray, FloatArray]:
    """Standard deviations of static torques, root mean square over poses, (4,) each."""
    of_arm = equations.of_arm
    numbers = equations.numbers
    joints = numbers.arm.joints[:4]
    lower = [joint.lower for joint in joints]
    upper = [joint.upper for joint in joints]
    q = np.random.default_rng(0).uniform(lower, upper, (_POSES, 4))
    rest = np.zeros_like(q)
    slopes = load_slopes(numbers, session.density, session.gravity, q, rest, rest)
    scaled = slopes[:, :4] * equations.deviation[:of_arm]
    before = (scaled**2).sum(axis=-1)
    told = ((scaled @ found.factor[:of_arm]) ** 2).sum(axis=-1)
    after = np.maximum(before - told, 0.0)
    return np.sqrt(before.mean(axis=0)), np.sqrt(after.mean(axis=0))
