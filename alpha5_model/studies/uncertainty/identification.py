"""Base parameters from a recorded motion, within what the printed digits allow."""

from __future__ import annotations

from statistics import NormalDist
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, instance
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.load import load
from alpha5_model.dynamics.regression import NAMES
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.studies.uncertainty import printed
from alpha5_model.studies.uncertainty.arm_numbers import arm_numbers
from alpha5_model.studies.uncertainty.digit_bounds import extremes, payload
from alpha5_model.studies.uncertainty.fitted_numbers import (
    FittedNumbers,
    fitted_numbers,
)
from alpha5_model.studies.uncertainty.fitting import RANK, Fit, System
from alpha5_model.studies.uncertainty.misfit import Problem, Suspect, suspects
from alpha5_model.studies.uncertainty.printed import Names
from alpha5_model.studies.uncertainty.recorded import Recording, recording_of
from alpha5_model.studies.uncertainty.sampling import DEVIATION
from alpha5_model.studies.uncertainty.unknowns import Unknowns
from alpha5_model.trajectory import Motion

#: Half width of a 95 % interval in standard deviations.
_WIDE = NormalDist().inv_cdf(0.975)
#: Scaled numbers this close to a bound are at it.
_AT_BOUND = 1e-9


class Identification(NamedTuple):
    """Base parameters from data.

    See `alpha5_model.codegen.regrouping` for names and units.

    Attributes:
        names: Of the base parameters, (38,).
        estimate: (38,).
        lower, upper: 95 % intervals, (38,) each, cut to what the printed digits allow
            unless there are `problems`: data that contradict the tables say so.
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
        fitted: The numbers behind the estimate, lengths and zeros included; it
            predicts torques with their uncertainty.
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
    fitted: FittedNumbers

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
    distribution; it determines what the data do not. Lengths, zeros and the turn of the
    mount change the regressor, too: they count to first order.

    The noise of each channel is autoregressive of order 3, by restricted maximum
    likelihood. Its coefficients are uncertain, so that intervals and tests are means
    over 16 draws of them. To test the model, it is the noise about the best fit of all
    causes in `Problem` and of numbers far beyond their intervals, so that a misfit is
    not taken for noise. Samples are taken as evenly spaced. With too few samples, noise
    is white, of the size of the residuals. Recordings that the model does not fit have
    `problems`.

    Args:
        motion: From `alpha5_model.trajectory`; the jaw rod is left out.
        arm: Its fluid, gravity, payload and corrections are taken as known; None for
            the bare arm in sea water. The half widths of an arm of your own replace
            those of the digits. Zeros and mount are known unless its file gives them a
            half width.
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
    recording = recording_of(motion, arm, wrench, smoothing)

    numbers = arm_numbers(arm.parameters, chosen)
    unknowns = Unknowns(numbers, arm)
    carried = payload(arm, numbers)
    causes = possible_causes(recording, unknowns, carried, arm.fluid_density)
    fit = System(recording, unknowns, carried, causes).fitted()
    fitted = fitted_numbers(arm, unknowns, fit.z, fit.factor, carried)

    bare = load(arm.fluid_density, arm=arm.parameters)
    every_one = np.eye(len(NAMES))[None]
    known = payload(bare, numbers)
    digit_limits = extremes(every_one, known, arm.fluid_density, numbers)
    return _identification(unknowns, fit, fitted, digit_limits[:, 0])


def possible_causes(
    recording: Recording, unknowns: Unknowns, carried: FloatArray, density: float
) -> tuple[Suspect, ...]:
    """What may be wrong with a recording, or with the arm that made it.

    Args:
        recording: Of efforts or loads.
        unknowns: The printed numbers.
        carried: Base parameters of the payload, (38,).
        density: Of the fluid [kg/m^3].
    """
    return suspects(
        regressor=recording.regressor,
        time=recording.time,
        velocity=recording.velocity,
        nominal=unknowns.base_parameters(np.zeros(unknowns.count)) + carried,
        by_density=unknowns.by_density(),
        by_mass=unknowns.by_mass(),
        density=density,
    )


def _identification(
    unknowns: Unknowns, fit: Fit, fitted: FittedNumbers, digit_limits: FloatArray
) -> Identification:
    """The base parameters of a fit, with their intervals.

    Args:
        unknowns: The printed numbers.
        fit: Their best values.
        fitted: The same, for the user.
        digit_limits: Lowest and highest base parameters by the digits, lengths apart,
            (2, 38).
    """
    slope = unknowns.slope
    estimate = unknowns.base_parameters(fit.z)
    deviations = fit.factor.T @ slope
    covariance = deviations.T @ deviations
    half_width = _WIDE * np.sqrt(np.diag(covariance))
    by_digits = _WIDE * DEVIATION * np.linalg.norm(slope, axis=0)
    lower = estimate - half_width
    upper = estimate + half_width
    by_geometry = unknowns.spread_by_geometry()
    if {problem.name for problem in fit.problems} <= {"untested"}:
        least, most = digit_limits
        lower, upper = np.clip([lower, upper], least - by_geometry, most + by_geometry)
    at_bound = np.flatnonzero(np.abs(fit.z) >= 1.0 - _AT_BOUND)

    _, gains, directions = np.linalg.svd(fit.of_data * DEVIATION, full_matrices=False)
    determined = gains > gains[0] * RANK
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
        fitted=fitted,
    )
