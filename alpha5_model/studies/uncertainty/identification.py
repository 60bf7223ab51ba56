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
from alpha5_model.studies.uncertainty.linear_maps import groups
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


class Identification(NamedTuple):
    """Base parameters from data.

    See `alpha5_model.codegen.regrouping` for names and units.

    Attributes:
        names: Of the base parameters, (38,).
        estimate: (38,).
        lower, upper: 95 % intervals, (38,) each, cut to what the printed digits allow.
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
    distribution; it determines what the data do not. Noise is taken as white, and its
    size is estimated from the residuals.

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
    fit = _fitted(recording, unknowns, payload(arm, numbers))
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
    """

    regressor: FloatArray
    measured: FloatArray


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
        return _Recording(regressor=both[:, 4:], measured=measured)
    if motion.effort is not None:
        return _Recording(regressor=both[:, :4], measured=motion.effort[:, :4])
    expected = "one with recorded efforts, or a wrench"
    raise InputError("motion", motion.source, expected)


class _Unknowns:
    """The printed numbers z that base parameters depend on, each scaled to -1 to 1.

    Attributes:
        count: Number of unknowns.
        slope: Derivative of the base parameters by each, at z = 0, (count, 38).
    """

    def __init__(self, numbers: ArmNumbers, density: float) -> None:
        self._numbers = numbers
        self._by_moments = numbers.grouping(density)
        half = numbers.half_width
        matters = half * np.abs(numbers.to_bodies).any(axis=(1, 2)) > 0
        self._scaled = np.diag(half)[matters]
        self.count = len(self._scaled)
        unit = np.eye(self.count)
        self.slope = (self.base_parameters(unit) - self.base_parameters(-unit)) / 2

    def base_parameters(self, z: FloatArray) -> FloatArray:
        """Base parameters at z (..., count), without gravity, (..., 38)."""
        return groups(self._numbers.bodies(self._values(z)), self._by_moments)

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
        of_data: Weighted least-squares equations of the recording, (38 + 1, count).
        of_all: The same, with the equations of the digits below them.
    """

    z: FloatArray
    noise: FloatArray
    of_data: FloatArray
    of_all: FloatArray


def _fitted(recording: _Recording, unknowns: _Unknowns, known: FloatArray) -> _Fit:
    """Fit the unknowns by weighted least squares within their intervals.

    Args:
        recording: What was measured.
        unknowns: The printed numbers.
        known: Base parameters of the payload, (38,).
    """
    from scipy.optimize import lsq_linear

    regressor, measured = recording
    present = np.isfinite(measured)
    augmented = np.concatenate([regressor, measured[..., None]], axis=-1)
    by_digits = np.eye(unknowns.count) / DEVIATION

    z = np.zeros(unknowns.count)
    noise = np.ones(measured.shape[1])
    for _ in range(_STEPS):
        weighted = augmented / noise[:, None]
        triangle = np.asarray(np.linalg.qr(weighted[present], mode="r"))
        by_base_parameters = triangle[:, :-1]
        of_data = by_base_parameters @ unknowns.slope.T
        at_zero = unknowns.base_parameters(z) + known - z @ unknowns.slope
        rest = triangle[:, -1] - by_base_parameters @ at_zero

        of_all = np.vstack([of_data, by_digits])
        target = np.append(rest, np.zeros(unknowns.count))
        z = lsq_linear(of_all, target, bounds=(-1.0, 1.0), method="bvls").x
        left_over = measured - regressor @ (unknowns.base_parameters(z) + known)
        noise = np.sqrt(np.nanmean(left_over**2, axis=0)) + _LEAST_NOISE
    return _Fit(z=z, noise=noise, of_data=of_data, of_all=of_all)


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
    covariance = slope.T @ np.linalg.inv(fit.of_all.T @ fit.of_all) @ slope
    half_width = _WIDE * np.sqrt(np.diag(covariance))
    by_digits = _WIDE * DEVIATION * np.linalg.norm(slope, axis=0)
    lower, upper = np.clip(
        [estimate - half_width, estimate + half_width], *digit_limits
    )

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
    )
