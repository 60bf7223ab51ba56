"""The trials of calibrations, a few of them."""

from __future__ import annotations

import re

import numpy as np
import pytest

import alpha5_model as a5


@pytest.mark.slow
def test_a_few_trials(capsys: pytest.CaptureFixture[str]) -> None:
    from studies import calibration_trials

    calibration_trials.main(["scales", "--prior", "digits", "--trials", "3"])
    text = capsys.readouterr().out
    assert text.startswith("scales, digits, white: 3 trials; coverage of torques ")
    (torques,) = re.findall(r"of torques ([\d.]+)%", text)
    assert float(torques) > 60.0
    assert "impossible bodies 0" in text
    d, c = map(float, re.findall(r"torque ([\d.]+) / ([\d.]+) mN m", text)[0])
    assert d < 1.0
    assert c < 0.6


@pytest.mark.slow
def test_a_wrong_covariance_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """With standard deviations a sixth of the right ones, coverage breaks down."""
    from studies import calibration_trials as trials

    right = trials.predicted_deviation
    monkeypatch.setattr(
        trials, "predicted_deviation", lambda *given: right(*given) / 6.0
    )
    sensor, density = trials.CASES["scales"]
    planned = a5.calibrate.plan_poses(sensor, fluid_density=density)
    rng = np.random.default_rng(0)
    found = [trials.trial(planned, "digits", rng).torques for _ in range(3)]
    assert (np.abs(found) < trials.WIDE).mean() < 0.6


def test_the_kinds_of_noise() -> None:
    from studies.calibration_trials import STEP, noisy

    rng = np.random.default_rng(1)
    clean = np.zeros((4000, 2)) + 0.013
    deviation = np.array([0.1, 0.2])
    error = noisy(clean, deviation, "ar", rng) - clean
    together = [np.corrcoef(one[1:], one[:-1])[0, 1] for one in error.T]
    np.testing.assert_allclose(together, 0.95, atol=0.02)
    np.testing.assert_allclose(error.std(axis=0), deviation, rtol=0.2)
    spread = rng.uniform(0.0, 9.0, (4000, 2))
    rounded = noisy(spread, deviation, "quantised", rng)
    np.testing.assert_allclose((rounded - spread).std(axis=0), deviation, rtol=0.03)
    assert len(np.unique(rounded[:, 1].round(9))) <= 9.0 / (STEP * 0.2) + 2
