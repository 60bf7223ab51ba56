"""A motion of an arm of your own: its limits, torques, motors, mount and tool."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
import own_arm_dynamics as own
import pytest

import alpha5_model as a5
from alpha5_model import trajectory
from alpha5_model.cli import main
from alpha5_model.numbers.motors import Motors
from alpha5_model.numbers.parameters import Alpha5Parameters

EXAMPLE = Path(__file__).parents[2] / "examples" / "my_arm.toml"
TIME = np.linspace(0.0, 8.0, 161)


def swing(record: Alpha5Parameters) -> np.ndarray:
    """Positions within the limits, (N, 4)."""
    middle = np.array([(j.lower + j.upper) / 2 for j in record.joints[:4]])
    width = np.array([j.upper - j.lower for j in record.joints[:4]])
    phase = np.outer(TIME, [0.5, 0.7, 0.9, 1.1])
    return middle + 0.1 * width * np.sin(phase)


@pytest.mark.parametrize("record", own.RECORDS, ids=lambda record: record.name)
def test_its_torques_and_loads_are_newtons(record: Alpha5Parameters) -> None:
    motion = trajectory.motion(TIME, swing(record), arm=record)
    arm = a5.load(arm=record)
    analysis = trajectory.analyse(motion, arm, method="interpolate")
    smooth = analysis.smooth
    gravity = np.array([0.0, 0.0, -9.81])
    if record.mount is not None:
        gravity = record.mount.rotation.T @ gravity
    states = smooth.position, smooth.velocity, smooth.acceleration
    tau, wrench = own.inverse_dynamics(record, *states, a5.SEA_WATER, gravity)
    assert analysis.torque == pytest.approx(tau, abs=1e-11)
    assert analysis.base_wrench == pytest.approx(wrench, abs=1e-11)
    tip = [own.tcp(record, q)[:3, 3] for q in smooth.position]
    assert analysis.tcp == pytest.approx(np.array(tip), abs=1e-12)


def with_motors(**fields: Any) -> Alpha5Parameters:
    """The catalogue's arm with its own supply, drives and constants."""
    return dataclasses.replace(a5.parameters(), motors=Motors(**fields))


def test_its_motors_and_drives_are_those_of_the_record() -> None:
    inertias = (5e-7, None, 2e-7, None, None)
    limits = (1.0, 0.5, None, 2.0, None)
    record = with_motors(
        supply_voltage=23.0,
        current_limits=limits,
        rotor_inertias=inertias,
        constants="torque",
    )
    motion = trajectory.motion(TIME, swing(record))
    analysis = trajectory.analyse(motion, a5.load(arm=record), method="interpolate")
    assert analysis.supply_voltage == 23.0
    assert analysis.current_limits == limits[:4]
    assert analysis.current_limit is None

    # The current of a moving joint, from the equations of Table 4's motors.
    row = record.actuators[0]
    v = analysis.smooth.velocity[:, 0]
    acceleration = analysis.smooth.acceleration[:, 0]
    moving = analysis.smooth.direction[:, 0] != 0
    loss = row.efficiency ** -np.sign(analysis.torque[:, 0] * v)
    shaft = analysis.torque[:, 0] / row.gear_ratio * loss
    shaft = shaft + row.friction * np.sign(v) + 5e-7 * row.gear_ratio * acceleration
    current = shaft / row.torque_constant
    assert analysis.current[moving, 0] == pytest.approx(current[moving])
    volts = row.resistance * current + row.torque_constant * row.gear_ratio * v
    assert analysis.voltage[moving, 0] == pytest.approx(volts[moving])

    summary = trajectory.summary(analysis)
    margins = [joint["current_margin"] for joint in summary["joints"].values()]
    most = np.maximum(np.abs(analysis.current_lower), np.abs(analysis.current_upper))
    for k, limit in enumerate(limits[:4]):
        if limit is None:
            assert margins[k] is None
        else:
            assert margins[k] == pytest.approx(limit - most[:, k].max())
    assert np.isnan(analysis.torque_limits.upper[:, 2]).all()
    assert np.isfinite(analysis.torque_limits.upper[:, 1]).all()


def swaying(record: Alpha5Parameters) -> trajectory.Analysis:
    """A sway in air that turns the rotors of a record without friction."""
    frictionless = [dataclasses.replace(row, friction=0.0) for row in record.actuators]
    record = dataclasses.replace(record, actuators=tuple(frictionless))
    middle = np.array([3.2, 1.2, 1.2, 3.1])
    sway = 0.1 * np.sin(np.outer(TIME, [1.5, 2.0, 2.5, 1.0]))
    motion = trajectory.motion(TIME, middle + sway, arm=record)
    return trajectory.analyse(motion, a5.load(a5.AIR, arm=record), method="interpolate")


def test_the_limits_of_a_drive_leave_room_for_the_rotor() -> None:
    """Samples beyond the limits are those whose current or voltage is too large."""
    record = with_motors(
        supply_voltage=24.0, current_limits=(0.02,) * 5, rotor_inertias=(5e-7,) * 5
    )
    analysis = swaying(record)
    joints = trajectory.summary(analysis)["joints"]
    moving = analysis.smooth.direction != 0
    too_much = (np.abs(analysis.current) > 0.02) | (np.abs(analysis.voltage) > 24.0)
    for k, figures in enumerate(joints.values()):
        assert figures["beyond_drive_limits"] == np.count_nonzero(too_much[:, k])
        assert (figures["drive_torque_margin"] < 0) == (figures["current_margin"] < 0)
    assert 0 < too_much[:, 2].sum() < moving[:, 2].sum()


def test_what_turns_a_rotor_is_no_friction() -> None:
    """Against the powers of `Actuator.power`, which are heat and kinetic energy."""
    inertias = (5e-7, 1e-7, None, 2e-7, None)
    analysis = swaying(with_motors(rotor_inertias=inertias))
    assert [*analysis.causes()][-2:] == ["rotor", "friction"]
    moving = analysis.smooth.direction != 0
    for k, motor in enumerate(analysis.actuators):
        at = moving[:, k]
        v = analysis.smooth.velocity[at, k]
        a = None if inertias[k] is None else analysis.smooth.acceleration[at, k]
        power = motor.power(analysis.torque[at, k], v, a)
        heat = power.friction + power.gear
        assert analysis.friction[at, k] * v == pytest.approx(heat, abs=1e-12)
        assert analysis.rotor[at, k] * v == pytest.approx(power.rotor, abs=1e-12)
    assert (analysis.rotor[~moving] == 0.0).all()
    assert (analysis.rotor[:, 2] == 0.0).all()

    printed = trajectory.text(analysis, verbose=True)
    rows = printed[printed.index("largest torque by cause") :].splitlines()[1:]
    assert rows[0].split()[-2:] == ["rotor", "friction"]
    assert max(map(len, rows[: rows.index("")])) <= 80
    assert "they are in the current, not in the torque" in printed
    peak = trajectory.summary(analysis)["joints"]["axis_d"]["causes_peak"]["rotor"]
    assert peak == np.abs(analysis.rotor[:, 1]).max()


def test_without_a_rotor_inertia_no_rotor_is_a_cause() -> None:
    analysis = swaying(with_motors())
    assert analysis.rotor is None
    assert "rotor" not in analysis.causes()
    assert "rotor" not in trajectory.text(analysis, verbose=True)


def test_efforts_that_are_the_motors_leave_nothing(tmp_path: Path) -> None:
    """Of currents times K_t and gear, friction and rotor are subtracted."""
    record = with_motors(rotor_inertias=(5e-7,) * 5)
    computed = swaying(record)
    effort = [
        motor.torque_constant * motor.ratio * current
        for motor, current in zip(computed.actuators, computed.current.T, strict=True)
    ]
    motion = dataclasses.replace(computed.motion, effort=np.transpose(effort))
    found = trajectory.analyse(motion, computed.arm, method="interpolate")
    record_of_file = trajectory.read_motion(
        trajectory.write(found, tmp_path / "own.csv")
    )
    assert not record_of_file.warnings
    for joint in trajectory.summary(found)["joints"].values():
        assert joint["effort"]["difference_rms"] > 1e-3
        assert joint["effort"]["difference_rms_with_friction"] < 1e-10


@pytest.mark.slow
def test_arguments_win_over_the_record() -> None:
    record = with_motors(supply_voltage=23.0, current_limits=(1.0,) * 5)
    arm = a5.load(arm=record)
    motion = trajectory.motion(TIME, swing(record))
    analysis = trajectory.analyse(
        motion, arm, supply_voltage=20.0, current_limit=0.7, constants="voltage"
    )
    assert analysis.supply_voltage == 20.0
    assert analysis.current_limits == (0.7,) * 4
    assert analysis.current_limit == 0.7
    assert {motor.constants for motor in analysis.actuators} == {"voltage"}
    # One of the two is enough if the record has the other.
    assert trajectory.analyse(motion, arm, current_limit=0.6).supply_voltage == 23.0
    plain = a5.load(arm=with_motors(supply_voltage=23.0))
    with pytest.raises(a5.errors.InputError, match="both or neither"):
        trajectory.analyse(motion, plain, supply_voltage=20.0)


def recording(folder: Path, record: Alpha5Parameters) -> Path:
    """A file with the swing."""
    file = folder / "swing.csv"
    names = ",".join(f"axis_{joint}_pos" for joint in "edcb")
    table = np.column_stack([TIME, swing(record)])
    np.savetxt(file, table, delimiter=",", header=f"time,{names}", comments="")
    return file


@pytest.mark.slow
def test_the_command_says_which_arm_and_has_its_limits(
    tmp_path: Path, capsys: Any
) -> None:
    record = a5.arm_file(EXAMPLE)
    file = recording(tmp_path, record)
    words = ["trajectory", str(file), "--arm", str(EXAMPLE)]
    assert main([*words, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["model"]["arm"] == "alpha5_lab_2"
    assert found["model"]["gravity"] == pytest.approx([0.0, 0.0, 9.81])
    assert found["motors"]["supply_voltage"] == 24.0
    assert found["motors"]["current_limits"]["axis_b"] == 1.0
    shoulder = found["joints"]["axis_e"]
    peak = abs(shoulder["velocity_peak"]["value"])
    assert shoulder["velocity_margin"] == pytest.approx(np.radians(20) - peak)
    peak = abs(shoulder["torque_peak"]["value"])
    assert shoulder["torque_margin"] == pytest.approx(1.5 - peak)

    words = [*words, "--verbose"]
    assert main([*words, "--mount", "0 0 0", "--constants", "voltage"]) == 0
    printed = capsys.readouterr().out
    assert "model: alpha5_lab_2, locked gripper" in printed
    assert "gravity (0, 0, -9.81)" in printed
    assert "torque limits are those of alpha5_lab_2" in printed
    assert "used here: voltage" in printed


def test_a_record_is_the_arm_that_it_loads() -> None:
    """``arm=`` takes a record or an arm, here as in `alpha5_model.plan`."""
    record = own.RECORDS[0]
    motion = trajectory.motion(TIME, swing(record), arm=record)
    of_record = trajectory.analyse(motion, record)
    of_arm = trajectory.analyse(motion, a5.load(arm=record))
    np.testing.assert_allclose(of_record.torque, of_arm.torque, rtol=1e-12)

    q = swing(record)[:3]
    bounds = [
        a5.uncertainty.bounds(q, 0 * q, 0 * q, arm) for arm in (record, of_arm.arm)
    ]
    np.testing.assert_allclose(bounds[0].torque.upper, bounds[1].torque.upper)
