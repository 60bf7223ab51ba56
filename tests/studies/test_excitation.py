"""Exciting motions: what one tells, by dense matrices, and which may be asked for."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import InputError
from alpha5_model.studies.calibration.equations import Equations
from alpha5_model.studies.calibration.loads import load_slopes
from alpha5_model.studies.calibration.poses import TILT
from alpha5_model.studies.calibration.unknowns import arm_unknowns

calibrate = a5.calibrate
ARM = a5.parameters()
JOINTS = ARM.joints[:4]
MARGIN = np.radians(3.0)
LOWER = np.array([joint.lower for joint in JOINTS]) + MARGIN
UPPER = np.array([joint.upper for joint in JOINTS]) - MARGIN


def spread(unknowns: Any, read: Any, still: Any, repeated: float) -> Any:
    """Deviations of the wanted torques before and after readings, (2, 2)."""
    slopes = load_slopes(unknowns, unknowns.middle, still.density, still.motion)
    equations = Equations(unknowns, [read], TILT)
    free = equations.deviation > 0
    prior = np.diag(equations.deviation[free] ** 2)
    rows = equations.slopes(equations.middle, 0) / read.sensor.noise[:, None]
    rows = rows.reshape(-1, len(equations.names))[:, free]
    after = np.linalg.inv(np.linalg.inv(prior) + repeated * rows.T @ rows)
    wide = np.zeros((len(slopes), 10, len(equations.names)))
    wide[..., :78] = slopes
    found = []
    for covariance in (prior, after):
        torque = wide[:, 1:3][..., free]
        variance = np.einsum("njk,kl,njl->nj", torque, covariance, torque)
        found.append(np.sqrt(variance.mean(axis=0)))
    return np.array(found)


def known_lengths() -> Any:
    unknowns = arm_unknowns(ARM, moving=True)
    unknowns.deviation[-4:] = 0.0
    return unknowns


@pytest.mark.slow
def test_information_of_a_planned_motion() -> None:
    """As if it were read 20 times a second, over positions within the limits."""
    sensor = calibrate.efforts()
    planned = calibrate.plan_excitation(sensor, evaluations=1, duration=15.0)
    assert planned.time == pytest.approx(np.linspace(0.0, 15.0, 301))
    rows = slice(0, 300, 5)
    read = calibrate.session(
        sensor,
        planned.position[rows],
        v=planned.velocity[rows],
        a=planned.acceleration[rows],
        fluid_density=a5.SEA_WATER,
    )
    q = np.random.default_rng(0).uniform(LOWER, UPPER, (100, 4))
    still = calibrate.session(sensor, q, fluid_density=a5.SEA_WATER)
    before, after = spread(known_lengths(), read, still, 5.0)
    expected = np.log(before / after).sum()
    assert planned.information == pytest.approx(expected, rel=0.005)


def test_periods_are_above_zero_and_at_most_an_hour() -> None:
    for wrong in (0.0, 3600.5):
        with pytest.raises(InputError, match="duration"):
            calibrate.plan_excitation(calibrate.efforts(), duration=wrong)
    short = calibrate.plan_excitation(calibrate.efforts(), duration=0.01, evaluations=2)
    assert short.time == pytest.approx([0.0, 0.01])


def test_without_gravity_nothing_is_learnt_of_torques_at_rest() -> None:
    sensor = calibrate.efforts()
    planned = calibrate.plan_excitation(sensor, gravity=(0, 0, 0), evaluations=2)
    assert planned.information == 0.0
