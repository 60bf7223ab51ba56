"""Base parameters from a recorded motion, within what the printed digits allow."""

from __future__ import annotations

from statistics import NormalDist
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, instance, shaped
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.kernel_numbers import arm_dimensions, arm_parameters
from alpha5_model.dynamics.load import load
from alpha5_model.dynamics.regression import NAMES, regressor_rows
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.studies.uncertainty import printed
from alpha5_model.studies.uncertainty.arm_numbers import ArmNumbers, arm_numbers
from alpha5_model.studies.uncertainty.digit_bounds import extremes, payload
from alpha5_model.studies.uncertainty.linear_maps import groups, split
from alpha5_model.studies.uncertainty.misfit import (
    Equations,
    Problem,
    Suspect,
    contradiction,
    named_causes,
    ranked,
    suspects,
    untested,
)
from alpha5_model.studies.uncertainty.noise import ORDER, noise_of_channel, whitened
from alpha5_model.studies.uncertainty.printed import Names
from alpha5_model.studies.uncertainty.sampling import DEVIATION
from alpha5_model.trajectory import Motion, smooth

#: Half width of a 95 % interval in standard deviations.
_WIDE = NormalDist().inv_cdf(0.975)
#: Least noise [N m, N]: a computed recording has none.
_LEAST_NOISE = 1e-12
#: Smaller gains are rounding errors, relative to the largest one.
_RANK = 1e-12
#: Gauss-Newton steps.
_STEPS = 4
#: Misfits that are smaller than this, relative to what is recorded, are no problem.
_HARMLESS = 1e-6
#: Times the digits' half width that numbers may be off when the noise is told.
_LOOSE = 20.0
#: Weight of the digits' middle where only their bounds should count.
_FAINT = 1e-3
#: Scaled numbers this close to a bound are at it.
_AT_BOUND = 1e-9


class Identification(NamedTuple):
    """Base parameters from data.

    See `alpha5_model.codegen.regrouping` for names and units.

    Attributes:
        names: Of the base parameters, (38,).
        estimate: (38,).
        lower, upper: 95 % intervals, (38,) each, cut to what the printed digits allow
            unless the data contradict the tables.
        covariance: (38, 38).
        supported: Which ones the data determine at least twice as closely as the
            printed digits, (38,) bool; about the others the data tell little.
        gains: For each independent combination of printed numbers, best first: its
            standard deviation by the digits over that by the data, (r,). Below 1 the
            digits tell more. The first over the last is the data's condition number.
        combinations: These combinations in base parameters, each one standard deviation
            by the digits long, (r, 38).
        noise: Standard deviation of the residuals of each torque, or of each component
            of the load [N m, N].
        parameters: The estimate as a parameter set of possible bodies.
        problems: Causes that explain what the model does not, the likeliest first; see
            `Problem`. Believe the estimate only if there are none.
        pinned: Names of the numbers that are at a bound of their interval.
        correlation: Coefficients of each channel's autoregressive noise, (n, 3).
    """

    names: tuple[str, ...]
    estimate: FloatArray
    lower: FloatArray
    upper: FloatArray
    covariance: FloatArray
    supported: Any
    gains: FloatArray
    combinations: FloatArray
    noise: FloatArray
    parameters: Alpha5Parameters
    problems: tuple[Problem, ...]
    pinned: tuple[str, ...]
    correlation: FloatArray

    def __str__(self) -> str:
        lines = [f"problem {problem.rank}: {problem}" for problem in self.problems]
        if self.pinned:
            lines.append(f"at a bound of their digits: {', '.join(self.pinned)}")
        rows = zip(
            self.names,
            self.estimate,
            self.lower,
            self.upper,
            self.supported,
            strict=True,
        )
        for name, estimate, lower, upper, supported in rows:
            by = "data" if supported else "digits"
            lines.append(f"{name:10} {estimate:+.6e} {lower:+.6e} {upper:+.6e} {by}")
        return "\n".join(lines)


def identify(
    motion: Motion,
    arm: Arm | None = None,
    *,
    wrench: ArrayLike | None = None,
    alternatives: Names = (),
    **smoothing: Any,
) -> Identification:
    """Identify base parameters from a motion with its efforts or the load on the mount.

    The unknowns are the printed numbers, scaled so that their intervals are -1 to 1.
    Torques and loads are linear in the base parameters, and these are nearly linear in
    the numbers: a few Gauss-Newton steps find the solution. No number leaves its
    interval, in which every body is possible, so the result is physically consistent.
    The intervals count as one more measurement, with the variance 1/3 of a uniform
    distribution; it determines what the data do not.

    The noise of each channel is autoregressive of order 3, by restricted maximum
    likelihood about the best fit of all causes in `Problem` and of numbers far beyond
    their intervals, so that a misfit is not taken for noise. Samples are taken as
    evenly spaced there. With too few samples it is white, of the size of the residuals.
    Recordings that the model does not fit have `problems`.

    Args:
        motion: From `alpha5_model.trajectory`; the jaw rod is left out.
        arm: Its fluid, gravity, payload and corrections are taken as known; None for
            the bare arm in sea water. The half widths of an arm of your own replace
            those of the digits; its lengths, zeros, mount and tool are known.
        wrench: Force and moment on the mount in base_link, (N, 6) [N, N m]; None for
            the motion's efforts.
        alternatives: Names of `ALTERNATIVES` to believe.
        smoothing: As of `alpha5_model.trajectory.smooth`.

    Raises:
        InputError: A motion without efforts, no wrench either, or arrays that do not
            fit; an arm on a floating base or with jaws that move; alternatives for an
            arm of your own.
    """
    chosen = printed.believed(alternatives)
    arm = load() if arm is None else instance("arm", arm, Arm)
    gravity = arm_parameters(arm)[-3:]
    dimensions = arm_dimensions(arm)
    recording = _recording(motion, gravity, dimensions, wrench, smoothing)

    numbers = arm_numbers(arm.parameters, chosen)
    unknowns = _Unknowns(numbers, arm.fluid_density)
    carried = payload(arm, numbers)
    causes = suspects(
        regressor=recording.regressor,
        time=recording.time,
        velocity=recording.velocity,
        nominal=unknowns.base_parameters(np.zeros(unknowns.count)) + carried,
        by_density=unknowns.by_density(),
        by_mass=unknowns.by_mass(),
        density=arm.fluid_density,
    )
    fit = _fitted(recording, unknowns, carried, causes)
    bare = load(arm.fluid_density, arm=arm.parameters)
    every_one = np.eye(len(NAMES))[None]
    known = payload(bare, numbers)
    digit_limits = extremes(every_one, known, arm.fluid_density, numbers)
    return _identification(unknowns, fit, digit_limits[:, 0])


class _Recording(NamedTuple):
    """Measured torques or loads, and their regressor.

    Attributes:
        regressor: (N, n, 38).
        measured: Torques or loads, (N, n); NaN for what is missing.
        time: (N,) [s].
        velocity: Of the joints, (N, 4) [rad/s].
    """

    regressor: FloatArray
    measured: FloatArray
    time: FloatArray
    velocity: FloatArray


def _recording(
    motion: Motion,
    gravity: FloatArray,
    dimensions: FloatArray,
    wrench: ArrayLike | None,
    smoothing: dict[str, Any],
) -> _Recording:
    """The load on the mount if it is given; otherwise the motion's efforts."""
    smoothed = smooth(instance("motion", motion, Motion), **smoothing)
    q = np.array(smoothed.position[:, :4])
    v = np.array(smoothed.velocity[:, :4])
    a = np.array(smoothed.acceleration[:, :4])
    both = regressor_rows(q, v, a, gravity, dimensions)
    if wrench is not None:
        measured = shaped("wrench", wrench, (len(q), 6))
        return _Recording(
            regressor=both[:, 4:], measured=measured, time=smoothed.time, velocity=v
        )
    if motion.effort is not None:
        measured = motion.effort[:, :4]
        return _Recording(
            regressor=both[:, :4], measured=measured, time=smoothed.time, velocity=v
        )
    expected = "one with recorded efforts, or a wrench"
    raise InputError("motion", motion.source, expected)


class _Unknowns:
    """The printed numbers z that base parameters depend on, each scaled to -1 to 1.

    Attributes:
        count: Number of unknowns.
        names: Of the numbers, (count,).
        slope: Derivative of the base parameters by each, at z = 0, (count, 38).
    """

    def __init__(self, numbers: ArmNumbers, density: float) -> None:
        self._numbers = numbers
        self._density = density
        self._by_moments = numbers.grouping(density)
        half = numbers.half_width
        matters = half * np.abs(numbers.to_bodies).any(axis=(1, 2)) > 0
        self._scaled = np.diag(half)[matters]
        self.names = tuple(np.array(numbers.names)[matters].tolist())
        self.count = len(self._scaled)
        unit = np.eye(self.count)
        self.slope = (self.base_parameters(unit) - self.base_parameters(-unit)) / 2

    def base_parameters(self, z: FloatArray) -> FloatArray:
        """Base parameters at z (..., count), without gravity, (..., 38)."""
        return groups(self._numbers.bodies(self._values(z)), self._by_moments)

    def by_density(self) -> FloatArray:
        """Derivative by the fluid's density, without attached payloads, (38,)."""
        bodies = self._numbers.bodies(self._numbers.middle)
        denser = self._numbers.grouping(self._density + 1.0)
        return groups(bodies, denser) - groups(bodies, self._by_moments)

    def by_mass(self) -> FloatArray:
        """Derivative by each link's mass over its own, (5, 38)."""
        bodies = self._numbers.bodies(self._numbers.middle)
        mass = split(bodies).mass
        nominal = groups(bodies, self._by_moments)
        slopes = []
        for link in range(5):
            heavier = bodies.copy()
            heavier[link, 0] += mass[link]
            slopes.append(groups(heavier, self._by_moments) - nominal)
        return np.array(slopes)

    def parameter_set(self, z: FloatArray) -> Alpha5Parameters:
        """The arm's parameters with these numbers."""
        return self._numbers.parameters(self._values(z))

    def _values(self, z: FloatArray) -> FloatArray:
        """The numbers, (..., K)."""
        return self._numbers.middle + z @ self._scaled


class _Fit(NamedTuple):
    """The unknowns that fit a recording best.

    Attributes:
        z: (count,).
        noise: Standard deviation of the residuals, (n,).
        of_data: Weighted least-squares equations of the recording, (m, count).
        of_all: The same, with the equations of the digits below them.
        correlation: Coefficients of the channels' noise, (n, 3).
        problems: Causes that explain what the fit does not.
    """

    z: FloatArray
    noise: FloatArray
    of_data: FloatArray
    of_all: FloatArray
    correlation: FloatArray
    problems: tuple[Problem, ...]


class _Weights(NamedTuple):
    """What makes the noise of the channels white and of size 1.

    Attributes:
        correlation: Coefficients of the channels' noise, (n, 3).
        deviation: Standard deviation of the white noise that drives it, (n,).
        known: Whether it is; else it is the size of the residuals.
        independent: Samples of all channels that this noise leaves independent.
    """

    correlation: FloatArray
    deviation: FloatArray
    known: bool
    independent: float


class _Triangle(NamedTuple):
    """Whitened rows of a recording, reduced by a QR factorization.

    Attributes:
        by_base_parameters: (m, 38).
        by_suspects: (m, s).
        measured: (m,).
        samples: Rows that were reduced.
    """

    by_base_parameters: FloatArray
    by_suspects: FloatArray
    measured: FloatArray
    samples: int


class _Linear(NamedTuple):
    """The recording as linear equations of the unknowns, about one of their values.

    Attributes:
        of_data: (m, count).
        rest: (m,).
    """

    of_data: FloatArray
    rest: FloatArray


def _fitted(
    recording: _Recording,
    unknowns: _Unknowns,
    known: FloatArray,
    causes: tuple[Suspect, ...],
) -> _Fit:
    """Fit the unknowns by weighted least squares within their intervals.

    Args:
        recording: What was measured.
        unknowns: The printed numbers.
        known: Base parameters of the payload, (38,).
        causes: What else may change the recording.
    """
    columns = np.concatenate([cause.columns for cause in causes], axis=-1)
    weights = _weights(recording, columns, unknowns.slope)
    by_digits = np.eye(unknowns.count) / DEVIATION
    target_of_digits = np.zeros(unknowns.count)

    z = np.zeros(unknowns.count)
    for _ in range(_STEPS):
        triangle = _triangle(recording, columns, weights)
        linear = _linear(triangle, unknowns, known, z)
        of_all = np.vstack([linear.of_data, by_digits])
        z = _within_bounds(of_all, np.append(linear.rest, target_of_digits))
        fitted = recording.regressor @ (unknowns.base_parameters(z) + known)
        noise = np.sqrt(np.nanmean((recording.measured - fitted) ** 2, axis=0))
        noise = noise + _LEAST_NOISE
        if not weights.known:
            weights = weights._replace(deviation=noise)

    problems = _problems(recording, columns, weights, unknowns, known, z, causes)
    return _Fit(
        z=z,
        noise=noise,
        of_data=linear.of_data,
        of_all=of_all,
        correlation=weights.correlation,
        problems=problems,
    )


def _within_bounds(equations: FloatArray, target: FloatArray) -> FloatArray:
    """The scaled numbers within -1 to 1 that solve equations best, (count,)."""
    from scipy.optimize import lsq_linear

    found = lsq_linear(equations, target, bounds=(-1.0, 1.0), method="bvls")
    return np.asarray(found.x)


def _weights(recording: _Recording, columns: FloatArray, slope: FloatArray) -> _Weights:
    """Noise of each channel about the best fit without the digits' restrictions."""
    by_unknowns = _LOOSE * recording.regressor @ slope.T
    noise = [
        noise_of_channel(columns[:, k], by_unknowns[:, k], recording.measured[:, k])
        for k in range(recording.measured.shape[1])
    ]
    deviation = np.array([one.deviation for one in noise])
    if np.isnan(deviation).any():
        shape = (len(noise), ORDER)
        ones = np.ones(len(noise))
        return _Weights(
            correlation=np.zeros(shape), deviation=ones, known=False, independent=0.0
        )
    return _Weights(
        correlation=np.array([one.coefficients for one in noise]),
        deviation=deviation + _LEAST_NOISE,
        known=True,
        independent=sum(one.independent for one in noise),
    )


def _triangle(
    recording: _Recording, columns: FloatArray, weights: _Weights
) -> _Triangle:
    """The recording's equations, whitened and reduced."""
    parts = [recording.regressor, columns, recording.measured[..., None]]
    rows = np.concatenate(parts, axis=-1)
    of_channels = [
        whitened(rows[:, k], weights.correlation[k]) / deviation
        for k, deviation in enumerate(weights.deviation.tolist())
    ]
    every_row = np.concatenate(of_channels)
    complete = every_row[np.isfinite(every_row).all(axis=1)]
    triangle = np.asarray(np.linalg.qr(complete, mode="r"))
    count = recording.regressor.shape[-1]
    return _Triangle(
        by_base_parameters=triangle[:, :count],
        by_suspects=triangle[:, count:-1],
        measured=triangle[:, -1],
        samples=len(complete),
    )


def _linear(
    triangle: _Triangle, unknowns: _Unknowns, known: FloatArray, z: FloatArray
) -> _Linear:
    """The equations of the unknowns, linear about z."""
    at_zero = unknowns.base_parameters(z) + known - z @ unknowns.slope
    return _Linear(
        of_data=triangle.by_base_parameters @ unknowns.slope.T,
        rest=triangle.measured - triangle.by_base_parameters @ at_zero,
    )


def _problems(
    recording: _Recording,
    columns: FloatArray,
    weights: _Weights,
    unknowns: _Unknowns,
    known: FloatArray,
    z: FloatArray,
    causes: tuple[Suspect, ...],
) -> tuple[Problem, ...]:
    """What the fit does not explain, and by which cause it could be explained."""
    if not weights.known:
        return (untested(len(recording.measured)),)
    size = np.sqrt(np.nanmean(recording.measured**2, axis=0))
    deviation = np.maximum(weights.deviation, _HARMLESS * size)
    triangle = _triangle(recording, columns, weights._replace(deviation=deviation))
    linear = _linear(triangle, unknowns, known, z)

    zeros = np.zeros((unknowns.count, columns.shape[-1]))
    by_digits = np.eye(unknowns.count) / DEVIATION
    no_prior = np.zeros(unknowns.count)
    equations = Equations(
        restricted=np.vstack([linear.of_data, by_digits]),
        of_suspects=np.vstack([triangle.by_suspects, zeros]),
        rest=np.append(linear.rest, no_prior),
        samples=triangle.samples,
        independent=weights.independent,
    )
    named = list(named_causes(equations, causes))

    # The last rows of the triangle are what no base parameters can explain.
    singular = np.linalg.svd(triangle.by_base_parameters, compute_uv=False)
    rank = int((singular > _RANK * singular[0]).sum())
    faint = np.vstack([linear.of_data, _FAINT * by_digits])
    best = _within_bounds(faint, np.append(linear.rest, no_prior))
    basis = np.linalg.svd(triangle.by_base_parameters, full_matrices=False)[0]
    distance = basis[:, :rank].T @ (linear.rest - linear.of_data @ best)
    named += contradiction(float(distance @ distance), rank, weights.independent)
    return ranked(named)


def _identification(
    unknowns: _Unknowns, fit: _Fit, digit_limits: FloatArray
) -> Identification:
    """The base parameters of a fit, with their intervals.

    Args:
        unknowns: The printed numbers.
        fit: Their best values.
        digit_limits: Lowest and highest base parameters by the digits, (2, 38).
    """
    slope = unknowns.slope
    estimate = unknowns.base_parameters(fit.z)
    triangle = np.asarray(np.linalg.qr(fit.of_all, mode="r"))
    deviations = np.linalg.solve(triangle.T, slope)
    covariance = deviations.T @ deviations
    half_width = _WIDE * np.sqrt(np.diag(covariance))
    by_digits = _WIDE * DEVIATION * np.linalg.norm(slope, axis=0)
    lower = estimate - half_width
    upper = estimate + half_width
    if not any(problem.name == "tables" for problem in fit.problems):
        lower, upper = np.clip([lower, upper], *digit_limits)
    at_bound = np.flatnonzero(np.abs(fit.z) >= 1.0 - _AT_BOUND)

    _, gains, directions = np.linalg.svd(fit.of_data * DEVIATION, full_matrices=False)
    determined = gains > gains[0] * _RANK
    return Identification(
        names=NAMES,
        estimate=estimate,
        lower=lower,
        upper=upper,
        covariance=covariance,
        supported=2 * half_width < by_digits,
        gains=gains[determined],
        combinations=DEVIATION * directions[determined] @ slope,
        noise=fit.noise,
        parameters=unknowns.parameter_set(fit.z),
        problems=fit.problems,
        pinned=tuple(unknowns.names[k] for k in at_bound),
        correlation=fit.correlation,
    )
