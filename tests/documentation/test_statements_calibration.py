"""What the guide on calibration says of each sensor is computed again."""

from __future__ import annotations

import re
import runpy
from typing import Any

import numpy as np
import pytest
from pages import DOCS, REPOSITORY

import alpha5_model as a5
from alpha5_model.studies.calibration.equations import Equations
from alpha5_model.studies.calibration.loads import Motion, load_slopes
from alpha5_model.studies.calibration.poses import TILT
from alpha5_model.studies.calibration.unknowns import NAMES, arm_unknowns

calibrate = a5.calibrate
GUIDE = (DOCS / "guides" / "calibration.md").read_text("utf-8")
PRIORS = ("digits", "loose")
#: The vehicle of the guide, whose arm hangs before it.
VEHICLE = {
    "mass": 11.5,
    "com": [0.0, 0.0, -0.02],
    "volume": 0.0115,
    "cob": [0.0, 0.0, 0.03],
    "xyz": [0.2, 0.0, -0.1],
}
#: First cell of the table -> sensor and fluid; None before any reading.
ROWS: dict[str, tuple[Any, float]] = {
    "none: before any reading, in air": (None, a5.AIR),
    "three scales that show grams": (calibrate.scales(), a5.AIR),
    "the same, their places known to 0.5 mm": (
        calibrate.scales(placement=0.0005),
        a5.AIR,
    ),
    "three scales that show tenths of a gram": (calibrate.scales(noise=3e-5), a5.AIR),
    "one scale": (calibrate.weight(), a5.AIR),
    "none: before any reading, in sea water": (None, a5.SEA_WATER),
    "force-torque sensor in sea water, 3 mN·m, gain 1 %": (
        calibrate.force_torque(),
        a5.SEA_WATER,
    ),
    "efforts without friction in sea water, 3 mN·m, gain 1 %": (
        calibrate.efforts(),
        a5.SEA_WATER,
    ),
    "tilt of a vehicle in sea water, 0.1°, its stiffness known to 2 %": (
        calibrate.vehicle_tilt(VEHICLE, noise=np.radians(0.1)),
        a5.SEA_WATER,
    ),
}


def remaining(sensor: Any, density: float, prior: str) -> Any:
    """Standard deviation of the torques of axis_d and axis_c [mN m]."""
    unknowns = arm_unknowns(a5.parameters(), prior)
    joints = a5.parameters().joints[:4]
    lower = [joint.lower for joint in joints]
    upper = [joint.upper for joint in joints]
    q = np.random.default_rng(0).uniform(lower, upper, (200, 4))
    motion = Motion(q=q, v=0 * q, a=0 * q, gravity=np.array([0.0, 0.0, -9.81]))
    slopes = load_slopes(unknowns, unknowns.middle, density, motion)[:, 1:3]
    if sensor is None:
        variance = ((slopes * unknowns.deviation) ** 2).sum(axis=-1)
        return 1e3 * np.sqrt(variance.mean(axis=0))

    planned = calibrate.plan_poses(sensor, fluid_density=density, prior=prior)
    read = calibrate.with_readings(planned, np.zeros(planned.readings.shape))
    equations = Equations(unknowns, [read], TILT)
    scaled = equations.matrix(equations.middle) * equations.deviation
    covariance = np.linalg.inv(np.eye(scaled.shape[1]) + scaled.T @ scaled)
    of_arm = slopes * unknowns.deviation
    of_arm_covariance = covariance[: len(NAMES), : len(NAMES)]
    variance = np.einsum("njk,kl,njl->nj", of_arm, of_arm_covariance, of_arm)
    return 1e3 * np.sqrt(variance.mean(axis=0))


@pytest.mark.slow
@pytest.mark.parametrize("cell", ROWS)
def test_what_a_sensor_tells(cell: str) -> None:
    (row,) = re.findall(rf"\| {re.escape(cell)} \| (.*) \|", GUIDE)
    said = [part.strip() for part in row.split("|")]
    found = np.concatenate([remaining(*ROWS[cell], prior) for prior in PRIORS])
    assert [f"{x:.1f}" for x in found] == said


def test_the_table_has_no_other_rows() -> None:
    assert len(re.findall(r"(?m)(?: \| \d+\.\d){4} \|$", GUIDE)) == len(ROWS)


def test_every_problem_has_its_row() -> None:
    source = (
        REPOSITORY / "alpha5_model" / "studies" / "calibration" / "problems.py"
    ).read_text("utf-8")
    named = set(re.findall(r'(?:_problem\(|name=f?|yield )"([a-z ]+)', source))
    assert {"unit", "scale", "reading", "order"} <= named
    for name in named:
        assert f"`{name.strip()}" in GUIDE, name


def test_the_example(capsys: pytest.CaptureFixture[str]) -> None:
    path = REPOSITORY / "examples" / "calibrate_with_scales.py"
    runpy.run_path(str(path), run_name="__main__")
    text = capsys.readouterr().out
    assert "problem" not in text
    found = re.findall(r"axis_d ([\d.]+) mN m off, axis_c ([\d.]+)", text)
    printed, calibrated = np.array(found, float)
    assert (printed > 8.0).all()
    assert (calibrated < 2.0).all()
