"""The equations of a fit: those of all whitened rows, written out one below the other.

The recording is Pinocchio's, of a sampled arm, with correlated noise and gaps.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.optimize import lsq_linear

import alpha5_model as a5
from alpha5_model.codegen.regrouping import base_parameters
from alpha5_model.studies.uncertainty.arm_numbers import arm_numbers
from alpha5_model.studies.uncertainty.digit_bounds import payload
from alpha5_model.studies.uncertainty.fitting import System, Weights, lagged_products
from alpha5_model.studies.uncertainty.identification import possible_causes
from alpha5_model.studies.uncertainty.noise import noise_of_channel
from alpha5_model.studies.uncertainty.recorded import recording_of
from alpha5_model.studies.uncertainty.unknowns import Unknowns

u = a5.uncertainty
COUNT = 150
PAYLOAD = {"mass": 0.3, "volume": 1e-4, "com": [0.0, 0.02, 0.03]}
#: Standard deviation of a uniform distribution from -1 to 1.
UNIFORM = 3**-0.5


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


def test_the_noise_is_about_that_of_the_recording(case: Case) -> None:
    np.testing.assert_allclose(case.weights.deviation, 0.003, rtol=0.35)
    np.testing.assert_allclose(case.weights.correlation[:, 0], 0.6, atol=0.3)
    assert case.weights.likely.shape == (16, 4, 4)
    # A first-order channel has a quarter of its samples: 0.4 / 1.6.
    assert 0.1 < case.weights.independent / (4 * COUNT) < 0.6


@pytest.mark.slow
@pytest.mark.parametrize("suspected", [False, True])
def test_the_noise_is_that_beside_the_unknowns(case: Case, suspected: bool) -> None:
    """Beside all causes, too, and numbers twenty times beyond their digits, if so."""
    system = case.system
    count = system.unknowns.count
    about = columns(system, np.zeros(count))
    causes = about[..., count:-1] if suspected else about[..., :0]
    numbers = about[..., :count] * (20.0 if suspected else 1.0)
    found = system._weights(suspected)
    assert found.known
    independent = 0.0
    for k in range(4):
        one = noise_of_channel(causes[:, k], numbers[:, k], about[:, k, -1])
        np.testing.assert_allclose(found.correlation[k], one.coefficients, atol=1e-6)
        assert found.deviation[k] == pytest.approx(one.deviation, rel=1e-6)
        np.testing.assert_allclose(found.likely[:, k], one.likely, atol=1e-5)
        independent += one.independent
    assert found.independent == pytest.approx(independent, rel=1e-5)


@pytest.mark.parametrize(("share", "names"), [(1e-7, set()), (1e-4, {"Coulomb"})])
def test_a_millionth_of_what_is_recorded_is_no_misfit(
    case: Case, share: float, names: set[str]
) -> None:
    """A computed recording without noise, its friction off by a share of its size."""
    given = case.system.recording
    exact = case.arm.inverse_dynamics_batch(
        given.position, given.velocity, given.acceleration
    )
    off = share * exact.std(axis=0) * np.sign(given.velocity)
    unknowns, known = case.system.unknowns, case.system.known
    recording = given._replace(measured=exact + off)
    problems = System(recording, unknowns, known, case.system.causes)._problems()
    assert {one.name for one in problems[:1]} == names


def test_equations_have_the_squares_of_all_rows(case: Case) -> None:
    """Of the unknowns, the suspects, and what the best unknowns leave."""
    system = case.system
    triangle = system._triangle(case.weights)
    found = system._equations(triangle, case.weights.independent)
    count = system.unknowns.count
    prior = np.eye(count) / UNIFORM
    rows = whitened_rows(columns(system, np.zeros(count)), best_noise(case.weights))
    of_all = np.vstack([rows[:, :count], prior])
    target = np.append(rows[:, -1], np.zeros(count))
    z = lsq_linear(of_all, target, bounds=(-1, 1), method="bvls").x
    assert np.abs(z).max() > 0.01

    about = whitened_rows(columns(system, z), best_noise(case.weights))
    # What is to be explained is about 0, so that the intervals pull to their middles.
    about[:, -1] += about[:, :count] @ z
    ours = np.column_stack([found.restricted, found.of_suspects, found.rest])
    below = np.hstack([prior, np.zeros((count, ours.shape[1] - count))])
    theirs = np.vstack([about, below])
    size = np.linalg.norm(theirs, axis=0)
    size[size == 0.0] = 1.0  # the mass of link 0 moves no joint
    np.testing.assert_allclose(
        ours.T @ ours / np.outer(size, size),
        theirs.T @ theirs / np.outer(size, size),
        atol=1e-6,
    )
    assert found.samples == len(about) == 4 * (COUNT - 3) - 2 * 4
    assert found.independent == case.weights.independent


def test_the_squared_distance_is_what_the_digits_cost(case: Case) -> None:
    """Beyond the best base parameters of all, for numbers that are hardly held."""
    system = case.system
    found = system._equations(system._triangle(case.weights), 1.0)
    count = system.unknowns.count
    faint = 1e-3 * np.eye(count) / UNIFORM
    about = columns(system, np.zeros(count))
    rows = whitened_rows(about, best_noise(case.weights))
    of_all = np.vstack([rows[:, :count], faint])
    target = np.append(rows[:, -1], np.zeros(count))
    z = lsq_linear(of_all, target, bounds=(-1, 1), method="bvls").x
    present = np.isfinite(about[..., -1:])
    masked = np.where(present, system.recording.regressor, np.nan)
    regressor = whitened_rows(masked, best_noise(case.weights))
    left = rows[:, -1] - rows[:, :count] @ z
    free = np.linalg.lstsq(regressor, left, rcond=1e-12)[0]
    beyond = left - regressor @ free
    assert found.squared == pytest.approx(left @ left - beyond @ beyond, rel=0.02)
    assert found.rank == np.linalg.matrix_rank(regressor, tol=1e-10)


def test_the_covariance_is_a_mean_over_likely_noise(case: Case) -> None:
    """Of each covariance, and between the estimates."""
    system = case.system
    count = system.unknowns.count
    z = 0.3 * np.cos(np.arange(count))
    of_all = np.eye(count)
    factor = system._factor(of_all, case.weights, z)
    about = columns(system, z)
    about[..., -1] += about[..., :count] @ z
    covariances = []
    estimates = []
    for likely in case.weights.likely:
        rows = whitened_rows(about, likely)
        squares = rows[:, :count].T @ rows[:, :count] + 3.0 * np.eye(count)
        covariances.append(np.linalg.inv(squares))
        estimates.append(covariances[-1] @ rows[:, :count].T @ rows[:, -1])
    off = np.array(estimates) - np.mean(estimates, axis=0)
    expected = np.mean(covariances, axis=0) + off.T @ off / 16
    np.testing.assert_allclose(factor @ factor.T, expected, atol=1e-7)

    # Without likely noise, only the equations count.
    known = case.weights._replace(likely=case.weights.likely[:0])
    alone = system._factor(np.diag([2.0] * count), known, z)
    np.testing.assert_allclose(alone @ alone.T, np.eye(count) / 4.0, atol=1e-12)


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


def test_lagged_products_leave_out_what_is_missing() -> None:
    rows = np.random.default_rng(1).normal(size=(12, 2))
    rows[5, 1] = np.nan
    found = lagged_products(rows)
    assert found.shape == (4, 4, 2, 2)
    kept = [t for t in range(3, 12) if not 5 <= t <= 8]
    for i, j in np.ndindex(4, 4):
        expected = sum(np.outer(rows[t - i], rows[t - j]) for t in kept)
        np.testing.assert_allclose(found[i, j], expected)


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


def test_unknowns_are_all_that_a_recording_may_show(case: Case) -> None:
    """Of lengths those of the joints: the tool's and zeros of Table 1 move nothing."""
    unknowns = case.system.unknowns
    geometric = {unknowns.names[k] for k in unknowns.geometric}
    # d_3 moves the tool only.
    lengths = {"link_0.a", "link_0.d", "link_2.a"}
    assert geometric == {*lengths, "elbow.opposite", "elbow.adjacent"}
    bodies = {
        f"link_{link}.{quantity}"
        for link in range(5)
        for quantity in ("mass", "volume")
    }
    assert bodies <= set(unknowns.names)
    assert not any(name.startswith("actuator") for name in unknowns.names)
    assert unknowns.count == len(unknowns.names) == len(unknowns.half_width)


def test_causes_of_mass_and_density_are_differences_of_base_parameters(
    case: Case,
) -> None:
    unknowns = case.system.unknowns
    record = a5.parameters()
    plain = base_parameters(record.links, parameters=record)[:38]
    denser = base_parameters(record.links, 1026.0, parameters=record)[:38]
    np.testing.assert_allclose(unknowns.by_density(), denser - plain, atol=1e-12)
    slopes = unknowns.by_mass()
    for k, link in enumerate(record.links):
        # Twice the mass at the same centre, with the same tensor there.
        links = list(record.links)
        links[k] = replace(link, mass=2.0 * link.mass)
        heavier = base_parameters(links, parameters=record)[:38]
        np.testing.assert_allclose(slopes[k], heavier - plain, atol=1e-12)


def test_what_an_identification_says_of_its_fit(case: Case) -> None:
    found = u.identify(case.motion, case.arm, method="interpolate")
    unknowns = case.system.unknowns
    fitted = found.fitted
    off = np.abs(fitted.values - unknowns.middle) / unknowns.half_width
    at_end = np.isclose(off, 1.0, rtol=0.0, atol=1e-8)
    assert found.pinned == tuple(np.array(fitted.names)[at_end].tolist())
    assert set(found.pinned) < set(fitted.names)

    by_data = np.sqrt(np.diag(found.covariance))
    by_digits = UNIFORM * np.linalg.norm(unknowns.slope, axis=0)
    assert np.array_equal(found.supported, 2.0 * by_data < by_digits)
    assert 0 < found.supported.sum() < 38
    inside = found.supported & (np.abs(found.estimate) > 0)
    assert (found.upper - found.lower)[inside].max() > 0
    assert (found.upper - found.lower <= 2 * 1.96 * by_data + 1e-12).all()

    z = (fitted.values - unknowns.middle) / unknowns.half_width
    rows = whitened_rows(columns(case.system, z), best_noise(case.weights))
    of_data = rows[:, : unknowns.count]
    squares, directions = np.linalg.eigh(of_data.T @ of_data)
    gains = np.sqrt(squares[::-1][:8]) * UNIFORM
    np.testing.assert_allclose(found.gains[:8], gains, rtol=1e-4)
    # Each combination is a deviation by the digits long.
    best = UNIFORM * directions[:, -1] @ unknowns.slope
    side = np.sign(best @ found.combinations[0])
    size = np.abs(best).max()
    np.testing.assert_allclose(found.combinations[0], side * best, atol=0.01 * size)
