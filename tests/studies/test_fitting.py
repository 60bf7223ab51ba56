"""A fit is the best one, by all whitened rows, written out one below the other.

The recording is Pinocchio's, of a sampled arm, with correlated noise and gaps.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.studies.uncertainty.arm_numbers import arm_numbers
from alpha5_model.studies.uncertainty.digit_bounds import payload
from alpha5_model.studies.uncertainty.fitting import System, Weights
from alpha5_model.studies.uncertainty.identification import possible_causes
from alpha5_model.studies.uncertainty.recorded import recording_of
from alpha5_model.studies.uncertainty.unknowns import Unknowns

u = a5.uncertainty
COUNT = 150
PAYLOAD = {"mass": 0.3, "volume": 1e-4, "com": [0.0, 0.02, 0.03]}


def motion() -> tuple[a5.trajectory.Motion, list[np.ndarray]]:
    time = 0.05 * np.arange(COUNT)
    rate = np.array([0.9, 0.7, 1.1, 0.8])
    angle = np.outer(time, rate) + np.arange(4)
    q = np.array([3.0, 1.7, 1.7, 3.0]) + 0.4 * np.sin(angle)
    v = 0.4 * rate * np.cos(angle)
    a = -0.4 * rate**2 * np.sin(angle)
    return a5.trajectory.motion(time, q), [q, v, a]


def noise(scale: float) -> np.ndarray:
    """First-order autoregressive noise, (N, 4)."""
    rng = np.random.default_rng(5)
    out = rng.normal(scale=scale, size=(COUNT, 4))
    for k in range(1, COUNT):
        out[k] += 0.6 * out[k - 1]
    return out


@dataclass(frozen=True)
class Case:
    """A recording, and the system of its fit."""

    arm: a5.Arm
    motion: a5.trajectory.Motion
    system: System
    weights: Weights


@pytest.fixture(scope="module")
def case() -> Case:
    moved, states = motion()
    drawn = u.sample(1, 8).parameters(0)
    effort = u.arm(drawn).with_payload(**PAYLOAD).inverse_dynamics_batch(*states)
    effort = effort + noise(0.003)
    effort[[20, 77], [0, 2]] = np.nan
    recorded = replace(moved, effort=effort)
    arm = a5.load().with_payload(**PAYLOAD)
    recording = recording_of(recorded, arm, None, {"method": "interpolate"})
    numbers = arm_numbers(arm.parameters)
    unknowns = Unknowns(numbers, arm)
    known = payload(arm, numbers)
    causes = possible_causes(recording, unknowns, known, arm.fluid_density)
    system = System(recording, unknowns, known, causes)
    return Case(arm, recorded, system, system._weights(suspected=False))


def columns(system: System, z: np.ndarray) -> np.ndarray:
    """Unknowns, suspects and rest about z, (N, n, count + s + 1)."""
    recording = system.recording
    states = recording.position, recording.velocity, recording.acceleration
    geometry = system.unknowns.by_geometry(*states, recording.channels)
    slopes = []
    for k in range(system.unknowns.count):
        step = np.zeros_like(z)
        step[k] = 1.0
        ends = [system.unknowns.base_parameters(side * step) for side in (-1, 1)]
        slopes.append((ends[1] - ends[0]) / 2)
    of_unknowns = recording.regressor @ np.transpose(slopes) + geometry
    suspects = np.concatenate([cause.columns for cause in system.causes], axis=-1)
    at = system.unknowns.base_parameters(z) + system.known
    rest = recording.measured - recording.regressor @ at - geometry @ z
    return np.concatenate([of_unknowns, suspects, rest[..., None]], axis=-1)


def whitened_rows(rows: np.ndarray, noise_of_channels: np.ndarray) -> np.ndarray:
    """Rows of all channels less what the three before predict, without gaps.

    Args:
        rows: (N, n, k).
        noise_of_channels: (n, 4): coefficients, then the deviation.
    """
    found = []
    for k, (*coefficients, deviation) in enumerate(noise_of_channels):
        for t in range(3, len(rows)):
            row = rows[t, k].copy()
            for lag, coefficient in enumerate(coefficients, 1):
                row -= coefficient * rows[t - lag, k]
            if np.isfinite(row).all():
                found.append(row / deviation)
    return np.array(found)


def best_noise(weights: Weights) -> np.ndarray:
    return np.column_stack([weights.correlation, weights.deviation])


@pytest.mark.slow
def test_a_fit_is_the_best_within_the_digits(case: Case) -> None:
    """No other numbers within them fit better, and the noise is what they leave."""
    system = case.system
    fit = system.fitted()
    assert fit.problems == ()
    assert np.abs(fit.z).max() <= 1.0
    count = system.unknowns.count

    def misfit(z: np.ndarray) -> float:
        rows = whitened_rows(columns(system, z)[..., -1:], best_noise(case.weights))
        return float(rows[:, 0] @ rows[:, 0] + 3.0 * z @ z)

    best = misfit(fit.z)
    rng = np.random.default_rng(3)
    for _ in range(12):
        other = np.clip(fit.z + 0.02 * rng.normal(size=count), -1.0, 1.0)
        assert misfit(other) > best
    left = columns(system, fit.z)[..., -1]
    rms = np.sqrt(np.nanmean(left**2, axis=0))
    np.testing.assert_allclose(fit.noise, rms, rtol=1e-9)
    np.testing.assert_array_equal(fit.correlation, case.weights.correlation)


@pytest.mark.slow
def test_the_prediction_is_that_of_the_fitted_numbers(case: Case) -> None:
    """By Pinocchio, with the lengths that the fit has found."""
    found = u.identify(case.motion, case.arm, method="interpolate")
    drawn = u.arm(found.parameters).with_payload(**PAYLOAD)
    _, states = motion()
    some = [one[::30] for one in states]
    predicted = found.fitted.torque(*some)
    exact = drawn.inverse_dynamics_batch(*some)
    # Lengths and zeros count to first order.
    np.testing.assert_allclose(predicted.torque, exact, atol=2e-5)
    deviation = np.sqrt(np.diag(found.fitted.covariance))
    np.testing.assert_allclose(found.fitted.deviation, deviation)
    one = found.fitted.torque(*(rows[0] for rows in some))
    np.testing.assert_allclose(one.torque, predicted.torque[:1])
    np.testing.assert_allclose(one.deviation, predicted.deviation[:1])
    shown = set(re.findall(r"[(,] ?(\w+)=", repr(found.fitted)))
    assert shown == {"names", "values", "covariance"}
