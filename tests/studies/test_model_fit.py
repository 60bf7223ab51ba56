"""Whether `identify` notices that the model does not fit, and how it takes the noise.

The recordings are Pinocchio's, of the drawn numbers; the fit uses the kernels.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.linalg import toeplitz
from scipy.optimize import minimize

import alpha5_model as a5
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Measurement
from alpha5_model.studies.uncertainty.arm_numbers import arm_numbers
from alpha5_model.studies.uncertainty.noise import (
    noise_of_channel,
    stationary,
    whitened,
)
from alpha5_model.studies.uncertainty.recorded import TORQUES
from alpha5_model.studies.uncertainty.unknowns import Unknowns

u = a5.uncertainty
SAMPLES = 500
STEP = 0.05
DEVIATION = 0.003


def swing() -> tuple[a5.trajectory.Motion, tuple[np.ndarray, ...]]:
    """A motion of sines, and its exact positions, velocities and accelerations."""
    time = STEP * np.arange(SAMPLES)
    slow = np.array([0.45, 0.3, 0.5, 0.25])
    fast = np.array([0.95, 1.3, 0.7, 1.1])
    middle = a5.named_pose("reach") + np.array([0.0, 0.5, -0.6, 0.0])
    first = np.outer(time, slow)
    second = np.outer(time, fast) + 1.0
    q = middle + 0.4 * np.sin(first) + 0.2 * np.sin(second)
    v = 0.4 * slow * np.cos(first) + 0.2 * fast * np.cos(second)
    a = -0.4 * slow**2 * np.sin(first) - 0.2 * fast**2 * np.sin(second)
    return a5.trajectory.motion(time, q), (q, v, a)


MOTION, STATES = swing()
#: Truths, with lengths of their own.
TRUTHS = u.sample(12, 5)


def torques(k: int, density: float = 1025.0, heavier: float = 1.0) -> np.ndarray:
    """Torques of truth k by Pinocchio, state by state, (N, 4)."""
    record = TRUTHS.parameters(k)
    links = list(record.links)
    links[2] = replace(links[2], mass=heavier * links[2].mass)
    arm = u.arm(replace(record, links=tuple(links)), density)
    rows = zip(*STATES, strict=True)
    return np.array([arm.inverse_dynamics(*row) for row in rows])


@pytest.fixture(scope="module")
def exact() -> np.ndarray:
    return torques(0)


def noise(seed: int, correlation: float = 0.0) -> np.ndarray:
    """First-order autoregressive noise with standard deviation DEVIATION, (N, 4)."""
    rng = np.random.default_rng(seed)
    driving = rng.normal(scale=DEVIATION, size=(SAMPLES, 4))
    out = driving.copy()
    for k in range(1, SAMPLES):
        driven = np.sqrt(1 - correlation**2) * driving[k]
        out[k] = correlation * out[k - 1] + driven
    return out


def fit(effort: np.ndarray) -> Any:
    return u.identify(replace(MOTION, effort=effort), method="interpolate")


def faulty(fault: str, exact: np.ndarray) -> tuple[np.ndarray, float]:
    """The recording with a fault, and the size that should be named."""
    velocity = STATES[1]
    time = MOTION.time
    if fault == "fluid":
        return torques(0, density=0.0), 0.0
    if fault == "mass of link_2":
        mass = TRUTHS.values[0, TRUTHS.names.index("link_2.mass")]
        printed = u.printed_numbers()["link_2.mass"].value
        return torques(0, heavier=1.2), 1.2 * mass / printed
    if fault == "delay":
        late = [np.interp(time - 0.04, time, one) for one in exact.T]
        return np.transpose(late), 0.04
    changed = {
        "millinewton": (1000.0 * exact, 1000.0),
        "sign": (-exact, -1.0),
        "scale": (1.05 * exact, 1.05),
        "offset": (exact + 0.01, 0.01),
        "Coulomb": (exact + 0.005 * np.sign(velocity), 0.005),
        "viscous": (exact + 0.02 * velocity, 0.02),
    }
    return changed[fault]


FAULTS = (
    "millinewton",
    "sign",
    "scale",
    "offset",
    "Coulomb",
    "viscous",
    "delay",
    "fluid",
    "mass of link_2",
)


@pytest.mark.slow
@pytest.mark.parametrize("fault", FAULTS)
def test_each_fault_is_named_first_with_its_size(fault: str, exact: np.ndarray) -> None:
    recorded, size = faulty(fault, exact)
    found = fit(recorded + noise(1))
    problem = found.problems[0]
    assert problem.name == fault.replace("millinewton", "scale")
    assert problem.rank == 1
    # A scale of 1000 carries the truth's numbers beyond the digits.
    allowed = 5 * problem.deviation + 0.04 * abs(size)
    assert (np.abs(problem.size - size) < allowed).all()
    assert str(found).startswith(f"problem 1: {problem}")
    gains = [one.gain for one in found.problems]
    assert gains == sorted(gains, reverse=True)


@pytest.mark.slow
def test_fresh_water_comes_before_a_scale_that_explains_as_much() -> None:
    """For sea water: a scale of 1.6 % gives almost the same efforts."""
    found = fit(torques(0, density=1000.0) + noise(5))
    fluid = next(one for one in found.problems if one.name == "fluid")
    scale = next(one for one in found.problems if one.of == ("recording",))
    assert found.problems[0] is fluid
    # By a free density the scale would come first: it explains more.
    off = (1000.0 - fluid.size[0]) / fluid.deviation[0]
    samples = 4 * SAMPLES
    explained = fluid.gain + off**2 + 2.0 * np.log(2)
    assert explained - np.log(samples) < scale.gain < fluid.gain
    assert abs(off) < 3


@pytest.mark.slow
@pytest.mark.parametrize("fault", ["millinewton", "sign", "mass of link_2"])
def test_faults_are_noticed_in_correlated_noise(fault: str, exact: np.ndarray) -> None:
    recorded, _ = faulty(fault, exact)
    found = fit(recorded + noise(2, correlation=0.95))
    assert found.problems[0].name == fault.replace("millinewton", "scale")
    assert any(one.name == "tables" for one in found.problems)
    assert "your data contradict the tables" in str(found)


@pytest.mark.slow
def test_a_heavier_link_is_pinned_and_its_interval_is_not_cut() -> None:
    found = fit(torques(0, heavier=1.2) + noise(1))
    assert "link_2.mass" in found.pinned
    assert "at a bound of their digits: " in str(found)
    below, above = found.estimate - found.lower, found.upper - found.estimate
    np.testing.assert_allclose(below, above, rtol=1e-6, atol=1e-15)
    cut = fit(torques(0) + noise(1))
    assert not cut.problems
    below, above = cut.estimate - cut.lower, cut.upper - cut.estimate
    assert (np.abs(below - above) > 1e-3 * (below + above)).any()


@pytest.mark.slow
@pytest.mark.parametrize("correlation", [0.0, 0.95])
def test_coverage_of_predicted_torques(correlation: float) -> None:
    """95 % intervals of static torques hold the truth; there is no false alarm."""
    poses = STATES[0][::100]
    still = np.zeros_like(poses)
    hits = []
    for k in range(6):
        found = fit(torques(k) + noise(10 + k, correlation))
        assert not found.problems
        true = u.arm(TRUTHS.parameters(k))
        exact = [true.hydrostatic_torque(pose) for pose in poses]
        predicted = found.fitted.torque(poses, still, still)
        error = np.abs(predicted.torque - exact)[:, 1:3]
        hits.append(error < 1.96 * predicted.deviation[:, 1:3])
    assert 0.88 < np.mean(hits) < 0.99


@pytest.mark.slow
def test_lengths_and_zeros_are_found_within_their_half_widths() -> None:
    """An arm whose a_1 and zero of axis_c are off, by Pinocchio."""
    half_widths = {"lengths.a_1": 2e-3, "zeros.axis_c": 0.02}
    measurements = tuple(
        Measurement(key=key, source="", half_width=half_width)
        for key, half_width in half_widths.items()
    )
    record = replace(a5.parameters(), measurements=measurements)
    rows = list(record.dh)
    rows[1] = replace(rows[1], a=rows[1].a + 1.2e-3)
    rows[2] = replace(rows[2], theta_offset=rows[2].theta_offset - 0.012)
    true = u.arm(replace(record, dh=tuple(rows)))
    effort = np.array(
        [true.inverse_dynamics(*row) for row in zip(*STATES, strict=True)]
    )
    arm = a5.load(arm=record)
    found = u.identify(
        replace(MOTION, effort=effort + noise(3) / 30), arm, method="interpolate"
    )
    assert not found.problems
    fitted = dict(zip(found.fitted.names, found.fitted.values, strict=True))
    deviation = dict(zip(found.fitted.names, found.fitted.deviation, strict=True))
    for name, true_value in (
        ("lengths.a_1", rows[1].a),
        ("zeros.axis_c", rows[2].theta_offset),
    ):
        assert abs(fitted[name] - true_value) < 3 * deviation[name]
    assert deviation["zeros.axis_c"] < half_widths["zeros.axis_c"] / 10
    zero = found.parameters.dh[2].theta_offset
    # The digits of the elbow turn it, too.
    allowed = 3 * deviation["zeros.axis_c"] + 1e-3
    assert zero == pytest.approx(rows[2].theta_offset, abs=allowed)


def test_the_columns_of_lengths_are_differences_of_torques() -> None:
    """Of arms that Pinocchio computes, whatever is held in the jaws."""
    payload = {"mass": 0.3, "volume": 1e-4, "com": [0.0, 0.02, 0.03]}
    arm = a5.load().with_payload(**payload)
    numbers = arm_numbers(arm.parameters, ())
    unknowns = Unknowns(numbers, arm)
    states = [np.ascontiguousarray(one[::50]) for one in STATES]
    rows = arm.regressor(*states).matrix @ unknowns.slope.T
    rows += unknowns.by_geometry(*states, TORQUES)
    at = unknowns.names.index("elbow.adjacent")
    values = dict(zip(numbers.names, numbers.middle, strict=True))
    ends = []
    for sign in (-1.0, 1.0):
        moved = values | {
            "elbow.adjacent": values["elbow.adjacent"] + sign * unknowns.half_width[at]
        }
        record = numbers.parameters(np.array(list(moved.values())))
        changed = a5.load(arm=record).with_payload(**payload)
        torque = [changed.inverse_dynamics(*row) for row in zip(*states, strict=True)]
        ends.append(np.array(torque))
    expected = (ends[1] - ends[0]) / 2
    np.testing.assert_allclose(rows[..., at], expected, atol=1e-9)
    assert np.abs(expected).max() > 1e-5


def test_a_short_recording_says_that_it_was_not_tested(exact: np.ndarray) -> None:
    time = MOTION.time[:12]
    few = a5.trajectory.motion(time, MOTION.position[:12], effort=exact[:12])
    found = u.identify(few, method="interpolate")
    assert [one.name for one in found.problems] == ["untested"]
    assert "too few samples (12)" in str(found)
    assert not found.correlation.any()


def covariance(partial: np.ndarray, count: int) -> np.ndarray:
    """Stationary covariance of noise driven by 1, from its power series."""
    coefficients = stationary(partial)
    response = np.zeros(4000)
    response[0] = 1.0
    for k in range(1, len(response)):
        for lag, one in enumerate(coefficients, 1):
            response[k] += one * response[k - lag] if k >= lag else 0.0
    lagged = [response[: len(response) - k] @ response[k:] for k in range(count)]
    return np.asarray(toeplitz(lagged))


@pytest.mark.slow
def test_the_noise_is_that_of_the_restricted_likelihood_with_full_matrices() -> None:
    rng = np.random.default_rng(4)
    partial = np.array([0.8, -0.3, 0.2])
    columns = np.column_stack([np.ones(80), np.sin(0.1 * np.arange(80))])
    lower = np.linalg.cholesky(covariance(partial, 80))
    measured = columns @ [2.0, -1.0] + lower @ rng.normal(size=80)

    def minus_log_likelihood(unbounded: np.ndarray) -> float:
        matrix = covariance(np.tanh(unbounded), 80)
        inverse = np.linalg.inv(matrix)
        squares = columns.T @ inverse @ columns
        best = np.linalg.solve(squares, columns.T @ inverse @ measured)
        left_over = measured - columns @ best
        rest = left_over @ inverse @ left_over
        logs = np.linalg.slogdet(matrix)[1] + np.linalg.slogdet(squares)[1]
        return float(78 * np.log(rest) + logs)

    start = np.arctanh(partial)
    theirs = minimize(minus_log_likelihood, start, method="Nelder-Mead").x
    ours = noise_of_channel(columns, np.zeros((80, 1)), measured)
    np.testing.assert_allclose(
        ours.coefficients, stationary(np.tanh(theirs)), atol=2e-3
    )
    # The mean of n independent samples has the variance gamma_0 / n.
    gamma = covariance(np.tanh(theirs), 2000)[0]
    correlated = (gamma[0] + 2 * gamma[1:].sum()) / gamma[0]
    assert ours.independent == pytest.approx(78 / correlated, rel=0.02)


def test_whitened_noise_is_what_drove_it() -> None:
    driving = np.random.default_rng(0).normal(size=(50, 2))
    coefficients = np.array([0.5, -0.2, 0.1])
    rows = driving.copy()
    for k in range(3, 50):
        rows[k] += coefficients @ rows[k - 3 : k][::-1]
    out = whitened(rows, coefficients)
    np.testing.assert_allclose(out[3:], driving[3:], atol=1e-12)
    assert np.isnan(out[:3]).all()
    assert np.array_equal(whitened(rows, np.zeros(3)), rows)


def test_a_recording_without_efforts_is_refused() -> None:
    with pytest.raises(InputError, match="recorded efforts"):
        u.identify(MOTION)
