"""Motors from simulated currents, whose truth `motor_trials.py` makes by Pinocchio."""

from __future__ import annotations

import importlib.util
import sys
from dataclasses import asdict, replace
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.errors import InputError
from alpha5_model.numbers.pose import Pose

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "scripts" / "identification" / "motor_trials.py"
JOINTS = ("axis_e", "axis_d", "axis_c", "axis_b")


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


def names(found: Any) -> list[str]:
    """Of what the currents contradict."""
    return [one.name for one in found.problems if one.name != "uncertain"]


@pytest.fixture(scope="module")
def by_driver() -> Any:
    """A calibration of rough motors whose friction takes 43 mA."""
    return trials.found(BARE, trials.currents(BARE, trials.DRIVER, 1))


def test_motors_without_noise_are_found_exactly() -> None:
    exact = trials.smooth_currents(BARE, trials.DRIVER, 0, 0.0, 0.0)
    values, _ = trials.estimates(trials.found(BARE, exact))
    told = np.array([1, 2])
    expected = trials.truth(trials.DRIVER)
    assert values[told] == pytest.approx(expected[told], rel=2e-3)
    assert values[:, :3] == pytest.approx(expected[:, :3], abs=2e-4)


@pytest.mark.slow
@pytest.mark.parametrize("rho", [0.0, 0.95, 0.99])
def test_correlated_noise_hardly_harms_and_is_in_the_intervals(rho: float) -> None:
    """Against plain least squares, with the same columns."""
    true = trials.truth(trials.DRIVER)
    errors, plain, inside = [], [], []
    for seed in range(25):
        current = trials.smooth_currents(BARE, trials.DRIVER, seed, rho, 0.005)
        values, deviations = trials.estimates(trials.found(BARE, current))
        errors.append((values - true)[:, :3])
        plain.append((trials.plain(BARE, current) - true)[:, :3])
        inside.append((np.abs(values - true) < trials.WIDE * deviations)[:, :3])
    ratio = np.std(errors, axis=0) / np.std(plain, axis=0)
    assert (ratio < 1.5).all()
    # Three quantities of four joints, 25 times: 0.95 ± 0.03 by chance.
    assert 0.9 < np.mean(inside) < 0.99


@pytest.mark.slow
def test_friction_and_torque_per_ampere_of_rough_motors() -> None:
    """The truth has Stribeck's friction, ripple and drift."""
    found = trials.found(BARE, trials.currents(BARE, trials.TABLE_4, 0))
    values, deviations = trials.estimates(found)
    off = np.abs(values / trials.truth(trials.TABLE_4) - 1)
    assert (off[:3, :2] < 0.03).all(), "friction"
    assert (off[1:3, 3] < 0.2).all(), "torque per ampere, three deviations"
    assert [joint.known for joint in found.joints] == [False, True, True, False]
    assert "K_t gear 23.51 N m/A by the arm's record" in str(found)
    assert found.gravity_deviation > 0.02
    assert "masses of links: not told" in str(found)
    assert f"± {1e3 * trials.WIDE * deviations[1, 0]:.1f} mA" in str(found.joints[1])


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
    current = trials.currents(heavy, 2 * trials.TABLE_4, 5)
    with pytest.raises(InputError, match=r"friction takes 5\d\d mA of"):
        trials.found(heavy, current, arm, payload=True)


def test_the_arm_file_gives_the_fitted_currents(by_driver: Any, tmp_path: Path) -> None:
    record = a5.arm_file(by_driver.write(tmp_path / "arm.toml"))
    for joint in by_driver.joints:
        motor = a5.actuators.actuator(joint.name, arm=record)
        for sign, dry in ((1, joint.friction_forward), (-1, joint.friction_backward)):
            expected = (
                0.3 / joint.torque_per_ampere
                + sign * dry
                + sign * 0.2 * max(joint.viscous, 0.0)
                + 0.5 * max(joint.armature, 0.0)
            )
            assert motor.current(0.3, sign * 0.2, 0.5) == pytest.approx(
                expected, rel=1e-12
            )
    half_width = {one.key: one.half_width for one in record.measurements}
    axis_d = by_driver.joints[1]
    per_ampere = axis_d.torque_per_ampere / record.actuators[1].gear_ratio
    expected = 1.96 * axis_d.relative_deviation * per_ampere
    assert half_width["motors.torque_constant.axis_d"] == pytest.approx(expected)
    assert "motors.torque_constant.axis_e" not in half_width


def test_a_calibrated_arm_keeps_each_joints_value(tmp_path: Path) -> None:
    """If its own file gave one measured value for all joints."""
    keys = ("viscous_friction", "rotor_inertia", "friction", "friction_tolerance")
    keys += ("efficiency", "friction_backward")
    lines = [f'{key} = {{value = 1e-6, source = "sheet"}}\n' for key in keys]
    file = tmp_path / "own.toml"
    file.write_text(f"format = 1\n[motors]\n{''.join(lines)}")
    record = a5.arm_file(file)
    current = trials.smooth_currents(BARE, trials.DRIVER, 3, 0.5, 0.002)
    found = trials.found(BARE, current, a5.load(arm=record)).parameters
    file.write_text(a5.arm_file_text(found))
    back = a5.arm_file(file)
    assert asdict(back.motors) == asdict(found.motors)
    for one, other in zip(back.actuators, found.actuators, strict=True):
        assert asdict(one) == asdict(other)
    measured = [one.key for one in found.measurements]
    assert sorted(one.key for one in back.measurements) == sorted(measured)
    sourced = {one.key for one in back.measurements if one.source == "sheet"}
    assert sourced == {f"motors.{key}.axis_a" for key in keys}, "not calibrated"


def test_a_torque_constant_of_all_joints_is_known_for_each(tmp_path: Path) -> None:
    number = "{value = 0.0134, half_width = 1.34e-5}"
    by_joint = ", ".join(f"{joint} = {number}" for joint in (*JOINTS, "axis_a"))
    current = trials.smooth_currents(BARE, trials.DRIVER, 3, 0.5, 0.002)
    found = []
    for given in (number, f"{{{by_joint}}}"):
        file = tmp_path / "own.toml"
        file.write_text(f"format = 1\n[motors]\ntorque_constant = {given}\n")
        arm = a5.load(arm=a5.arm_file(file))
        found.append(trials.found(BARE, current, arm))
    assert found[0].joints == found[1].joints
    for joint, row in zip(found[0].joints, found[0].parameters.actuators, strict=False):
        assert joint.known
        assert joint.relative_deviation < 1.01e-3 / trials.WIDE
        assert row.torque_constant == pytest.approx(0.0134, rel=2e-3)


def test_currents_of_another_recording_fit_after_the_calibration(
    by_driver: Any,
) -> None:
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


def test_the_jaw_rod_is_left_out() -> None:
    """Of a recording that has its position and current, too."""
    current = trials.smooth_currents(BARE, trials.DRIVER, 3, 0.5, 0.002)
    rod = np.linspace(0.0, 0.01, len(BARE.time))
    found = []
    for extra in ([], [rod]):
        columns = [np.column_stack([given, *extra]) for given in (BARE.q, current)]
        motion = a5.trajectory.motion(BARE.time, columns[0], current=columns[1])
        found.append(a5.calibrate.motors(motion, a5.load(), method="interpolate"))
    assert found[0].joints == found[1].joints


# --- what is wrong with a recording ---------------------------------------------------


@pytest.mark.parametrize(
    ("made", "read"), [(a5.AIR, a5.SEA_WATER), (a5.SEA_WATER, a5.AIR)]
)
def test_another_fluid_is_named_and_written(
    made: float, read: float, tmp_path: Path
) -> None:
    motion = trials.sway(density=made)
    current = trials.smooth_currents(motion, trials.DRIVER, 2, 0.9, 0.002)
    found = trials.found(motion, current, a5.load(read))
    assert names(found) == ["fluid"]
    assert found.contradicted
    assert str(found).startswith("fluid: ")
    assert "# fluid: " in found.write(tmp_path / "arm.toml").read_text()
    assert not names(trials.found(motion, current, a5.load(made)))


def test_gravity_of_the_other_direction_is_named() -> None:
    hanging = trials.sway(gravity=9.81)
    current = trials.smooth_currents(hanging, trials.DRIVER, 2, 0.9, 0.002)
    assert names(trials.found(hanging, current)) == ["gravity"]


@pytest.mark.parametrize("order", [[0, 2, 1, 3], [3, 1, 2, 0], [1, 2, 3, 0]])
@pytest.mark.parametrize("static", [trials.DRIVER, trials.TABLE_4])
def test_currents_in_other_columns_are_refused(order: list[int], static: Any) -> None:
    current = trials.currents(BARE, static, 4)[:, order]
    with pytest.raises(InputError, match="order of their joints") as caught:
        trials.found(BARE, current)
    assert f"those of {', '.join(JOINTS[k] for k in order)}" in str(caught.value)


def test_an_estimate_that_is_not_told_is_said_first() -> None:
    """By noise that is larger than the friction."""
    current = trials.smooth_currents(BARE, 0.02 * trials.DRIVER, 1, 0.95, 0.02)
    found = trials.found(BARE, current)
    assert not found.contradicted
    first = str(found).splitlines()[0]
    assert first.startswith("uncertain: the ± exceeds the friction forward of axis_e")
    assert f"# {first}" in found.text()


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


# --- the command ----------------------------------------------------------------------


def recording(path: Path, motion: Any, seed: int) -> Path:
    """A file of a motion and its currents."""
    header = [f"{n}_pos" for n in JOINTS] + [f"{n}_current_A" for n in JOINTS]
    current = trials.currents(motion, trials.DRIVER, seed)
    rows = np.column_stack([motion.time, motion.q, current])
    names = ",".join(["time_secs", *header])
    np.savetxt(path, rows, delimiter=",", header=names, comments="")
    return path


@pytest.mark.slow
def test_the_command_writes_an_arm_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    given = recording(tmp_path / "sway.csv", BARE, 2)
    made = tmp_path / "arm.toml"
    words = ["calibrate", "motors", str(given), "--fluid", "sea"]
    assert main([*words, "--output", str(made)]) == 0
    printed = capsys.readouterr().out
    assert "axis_d: friction 4" in printed
    record = a5.arm_file(made)
    constant = record.actuators[1].torque_constant
    static = record.actuators[1].friction / constant
    assert static == pytest.approx(0.043, abs=0.006)
    assert main(["calibrate", "motors", str(given), str(made)]) == 2

    capsys.readouterr()
    assert main(words[:-2]) == 1, "air is the fluid of all of calibrate"
    assert capsys.readouterr().out.startswith("fluid: ")


@pytest.mark.slow
def test_gravity_of_the_command_is_in_base_link_whatever_the_mount(
    tmp_path: Path,
) -> None:
    """A hanging arm, with and without the mount that says so."""
    given = recording(tmp_path / "hang.csv", trials.sway(gravity=9.81), 2)
    mount = Pose(parent="frame", position=np.zeros(3), rotation=np.diag([1.0, -1, -1]))
    own = tmp_path / "own.toml"
    own.write_text(a5.arm_file_text(replace(a5.parameters(), mount=mount)))
    words = ["calibrate", "motors", str(given), "--fluid", "sea"]
    down = ["--gravity", "0 0 9.81"]
    for options in (down, [*down, "--arm", str(own)], ["--arm", str(own)]):
        assert main([*words, *options]) == 0
    assert main(words) == 1
