"""Motors from simulated currents, whose truth `motor_trials.py` makes by Pinocchio."""

from __future__ import annotations

import importlib.util
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.errors import InputError
from alpha5_model.numbers.arm_writing import arm_file_text

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "scripts" / "identification" / "motor_trials.py"


def loaded() -> ModuleType:
    """The script as a module."""
    spec = importlib.util.spec_from_file_location("motor_trials", SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["motor_trials"] = module
    spec.loader.exec_module(module)
    return module


trials = loaded()
BARE = trials.sway()


@pytest.fixture(scope="module")
def by_driver() -> Any:
    """A calibration of an arm whose friction takes 43 mA."""
    return trials.found(BARE, trials.currents(BARE, trials.DRIVER, 1))


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1])
def test_friction_and_torque_per_ampere_of_rough_motors(seed: int) -> None:
    """The truth has Stribeck's friction, ripple and drift."""
    found = trials.found(BARE, trials.currents(BARE, trials.TABLE_4, seed))
    off = np.abs(trials.errors(found, trials.TABLE_4))
    assert (off[:3, :2] < 0.03).all(), "friction"
    assert (off[1:3, 2] < 0.2).all(), "torque per ampere, three deviations"
    for joint, static in zip(found.joints, trials.TABLE_4, strict=True):
        assert abs(joint.friction_forward - static) < 4 * joint.friction_deviation
    assert [joint.known for joint in found.joints] == [False, True, True, False]
    assert "K_t gear 23.51 N m/A by Table 4" in str(found)
    assert found.gravity_deviation > 0.05
    assert "masses of links: not told" in str(found)


@pytest.mark.slow
def test_a_payload_is_weighed_with_little_friction_only(by_driver: Any) -> None:
    heavy = trials.sway(trials.MASS)
    arm = a5.load(arm=by_driver.parameters)
    current = trials.currents(heavy, trials.DRIVER, 5)
    found = trials.found(heavy, current, arm, payload=True)
    error = abs(found.payload.mass - trials.MASS)
    assert error < 3 * found.payload.deviation < 0.1
    assert f"payload {1e3 * found.payload.mass:.0f} ± " in str(found)

    rough = trials.found(BARE, trials.currents(BARE, trials.TABLE_4, 1))
    arm = a5.load(arm=rough.parameters)
    current = trials.currents(heavy, trials.TABLE_4, 5)
    with pytest.raises(InputError, match=r"friction takes 28\d mA of"):
        trials.found(heavy, current, arm, payload=True)


@pytest.mark.slow
def test_the_arm_file_gives_the_fitted_currents(by_driver: Any, tmp_path: Path) -> None:
    path = tmp_path / "arm.toml"
    path.write_text(arm_file_text(by_driver.parameters))
    record = a5.arm_file(path)
    for joint in by_driver.joints:
        motor = a5.actuators.actuator(joint.name, arm=record)
        for sign, dry in ((1, joint.friction_forward), (-1, joint.friction_backward)):
            expected = (
                0.3 / joint.torque_per_ampere
                + sign * dry
                + sign * 0.2 * joint.viscous
                + 0.5 * joint.armature
            )
            assert motor.current(0.3, sign * 0.2, 0.5) == pytest.approx(
                expected, rel=1e-12
            )
    constant = {one.key: one.half_width for one in record.measurements}
    axis_d = by_driver.joints[1]
    per_ampere = axis_d.torque_per_ampere / record.actuators[1].gear_ratio
    expected = 1.96 * axis_d.relative_deviation * per_ampere
    assert constant["motors.torque_constant.axis_d"] == pytest.approx(expected)
    assert "motors.torque_constant.axis_e" not in constant


def test_currents_of_a_trajectory_fit_after_the_calibration(by_driver: Any) -> None:
    """Another recording of the same motors."""
    current = trials.currents(BARE, trials.DRIVER, 9)
    motion = a5.trajectory.motion(BARE.time, BARE.q, current=current)
    left = {}
    for name, record in (("tables", a5.parameters()), ("own", by_driver.parameters)):
        arm = a5.load(arm=record)
        analysis = a5.trajectory.analyse(motion, arm, method="interpolate")
        moving = np.abs(BARE.v[:, 1]) > 0.1
        difference = (analysis.current - current)[moving, 1]
        left[name] = float(np.sqrt(np.mean(difference**2)))
    assert left["own"] < 0.01
    assert left["tables"] > 0.2


def test_recordings_that_tell_nothing_are_refused() -> None:
    current = trials.currents(BARE, trials.TABLE_4, 0)
    motion = a5.trajectory.motion(BARE.time, BARE.q, current=current)
    with pytest.raises(InputError, match="the sign of the motion"):
        trials.found(BARE, -current)
    with pytest.raises(InputError, match="one with recorded currents"):
        a5.calibrate.motors(replace(motion, current=None))
    still = np.repeat(BARE.q[:1], len(BARE.q), axis=0)
    at_rest = replace(motion, position=still)
    with pytest.raises(InputError, match="axis_e with 0 samples forward"):
        a5.calibrate.motors(at_rest, method="interpolate")


@pytest.mark.slow
def test_the_command_writes_an_arm_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    names = ("axis_e", "axis_d", "axis_c", "axis_b")
    header = [
        "time_secs",
        *(f"{n}_pos" for n in names),
        *(f"{n}_current_A" for n in names),
    ]
    current = trials.currents(BARE, trials.DRIVER, 2)
    rows = np.column_stack([BARE.time, BARE.q, current])
    recording = tmp_path / "sway.csv"
    np.savetxt(recording, rows, delimiter=",", header=",".join(header), comments="")
    made = tmp_path / "arm.toml"
    words = ["calibrate", "motors", str(recording), "--fluid", "sea"]
    assert main([*words, "--output", str(made)]) == 0
    printed = capsys.readouterr().out
    assert "axis_d: friction 4" in printed
    assert main([*words[:-2], "--output", str(tmp_path / "same.toml")]) == 0
    assert (tmp_path / "same.toml").read_bytes() == made.read_bytes()
    assert "masses of links: not told" in printed
    record = a5.arm_file(made)
    constant = record.actuators[1].torque_constant
    static = record.actuators[1].friction / constant
    assert static == pytest.approx(0.043, abs=0.006)
    assert main(["calibrate", "motors", str(recording), str(made)]) == 2
