"""The analysis of a motion agrees with single states, energies and the formulas."""

from __future__ import annotations

import dataclasses
import json
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from reference import LOWER, UPPER
from shared_recordings import JOINT_STATES, needs_recordings

import alpha5_model as a5
from alpha5_model.dynamics.actuators import actuator
from alpha5_model.dynamics.load import arm_of
from alpha5_model.errors import InputError, OutputError, UnknownNameError
from alpha5_model.trajectory import columns

JAW_LOWER, JAW_UPPER = 0.0013, 0.0133
MOTOR_JOINTS = list(enumerate(("axis_e", "axis_d", "axis_c", "axis_b")))


def planned(count: int = 4001, duration: float = 6.0) -> a5.trajectory.Motion:
    """From rest to rest within the limits, smooth, at speeds the arm has."""
    t = np.linspace(0, duration, count)
    s = t / duration
    blend = s**3 * (10 - 15 * s + 6 * s**2)
    start = np.array([1.0, 0.4, 0.5, 2.0])
    end = np.array([2.4, 1.9, 2.0, 3.5])
    return a5.trajectory.motion(t, start + np.outer(blend, end - start))


@pytest.mark.parametrize("density", [a5.AIR, a5.SEA_WATER])
def test_work_at_the_joints_is_the_change_of_energy(density: float) -> None:
    """At each instant, the mechanical work done so far is the energy gained."""
    arm = a5.load(fluid_density=density)
    motion = planned()
    r = a5.trajectory.analyse(motion, arm, method="interpolate")
    power = r.mechanical_power.sum(axis=1)
    work_per_step = (power[1:] + power[:-1]) / 2 * np.diff(motion.time)
    work = np.concatenate([[0], np.cumsum(work_per_step)])
    at_start = arm.potential_energy(r.smooth.position[0])
    for k in range(0, 4001, 400):
        q = r.smooth.position[k]
        v = r.smooth.velocity[k]
        gained = arm.kinetic_energy(q, v) + arm.potential_energy(q) - at_start
        assert work[k] == pytest.approx(gained, abs=2e-6)
    assert np.abs(work).max() > 0.05


@pytest.mark.parametrize("gripper", ["locked", "jaws"])
def test_rows_agree_with_the_arm_one_state_at_a_time(gripper: str) -> None:
    motion = planned(41)
    if gripper == "jaws":
        rod = 0.007 + 0.005 * np.sin(motion.time)
        motion = a5.trajectory.motion(
            motion.time, np.column_stack([motion.position, rod])
        )
    r = a5.trajectory.analyse(motion, method="interpolate")
    assert r.arm.model.nv == (5 if gripper == "jaws" else 4)
    assert r.arm.fluid_density == a5.SEA_WATER
    for k in range(0, 41, 5):
        state = r.smooth.position[k], r.smooth.velocity[k], r.smooth.acceleration[k]
        np.testing.assert_allclose(
            r.torque[k], r.arm.inverse_dynamics(*state), atol=1e-13
        )
        np.testing.assert_allclose(
            r.base_wrench[k], r.arm.base_wrench(*state).vector, atol=1e-12
        )
        np.testing.assert_allclose(
            r.tcp[k], r.arm.forward_kinematics(state[0]).translation, atol=1e-14
        )
    np.testing.assert_allclose(
        r.inertia + r.coriolis + r.weight + r.buoyancy, r.torque, atol=1e-13
    )


# Table 4, typed from the document: R, F, eta, K_t, K_v, Gr.
TABLE_4 = [(3.22, 3.752e-3, 0.86, 0.0134, 0.0116, 1754.4)] * 3
TABLE_4 += [(38.6, 0.469e-3, 0.77, 0.0271, 0.0545, 340.4)]
RATED = [0.5235987755982988] * 3 + [0.8726646259971648]


def test_motors_case_by_case() -> None:
    r = a5.trajectory.analyse(planned(201), method="interpolate")
    seen = set()
    for k in range(201):
        for j, (resistance, friction, eta, k_t, k_v, gear) in enumerate(TABLE_4):
            tau = r.torque[k, j]
            v = r.smooth.velocity[k, j]
            if abs(v) < 0.002 * RATED[j]:
                # At rest, friction up to F holds a load of either sign: no current.
                case = "rest"
                assert abs(tau) * eta / gear < friction
                current = 0.0
                v = 0.0
            elif (tau > 0) == (v > 0):
                case = "driving"
                current = (tau / (gear * eta) + np.sign(v) * friction) / k_t
            else:
                case = "driven"
                current = (tau * eta / gear + np.sign(v) * friction) / k_t
            seen.add(case)
            assert r.current[k, j] == pytest.approx(current, rel=1e-12, abs=1e-15)
            voltage = resistance * current + k_v * gear * v
            assert r.voltage[k, j] == pytest.approx(voltage, rel=1e-12)
            assert r.electrical_power[k, j] == pytest.approx(
                voltage * current, rel=1e-12
            )
            assert r.friction[k, j] == pytest.approx(
                k_t * gear * current - tau, rel=1e-9, abs=1e-12
            )
    assert seen == {"rest", "driving", "driven"}
    assert (r.current_lower <= r.current).all()
    assert (r.current <= r.current_upper).all()
    assert (r.current_upper - r.current_lower).max() == pytest.approx(
        0.2 * 3.752e-3 / 0.0134
    )


def test_noise_does_not_turn_friction_round() -> None:
    """A joint that creeps forward needs a steady current, noisy as it is."""
    rng = np.random.default_rng(31)
    t = np.cumsum(rng.uniform(0.01, 0.03, 2000))
    q = 1.0 + 0.006 * t[:, None] * np.ones(4)
    v = 0.006 + rng.normal(scale=0.02, size=q.shape)
    r = a5.trajectory.analyse(a5.trajectory.motion(t, q, v))
    assert (r.smooth.velocity < 0).sum() > 1000
    assert (r.smooth.direction == 1).all()
    friction_current = np.array([3.752e-3 / 0.0134] * 3 + [0.469e-3 / 0.0271])
    assert (np.abs(r.current / friction_current - 1) < 0.3).all()
    still = a5.trajectory.analyse(a5.trajectory.motion(t, q[:1] + 0 * q, v - 0.006))
    assert (still.smooth.direction == 0).all()
    assert (still.current == 0).all()


def test_rotor_inertia_and_screw_lead_are_used_when_given() -> None:
    motion = planned(101)
    plain = a5.trajectory.analyse(motion, method="interpolate")
    heavy = a5.trajectory.analyse(
        motion,
        method="interpolate",
        actuators={"axis_d": actuator("axis_d", rotor_inertia=1e-6)},
    )
    moving = plain.current[:, 1] != 0
    added = 1e-6 * 1754.4 * plain.smooth.acceleration[:, 1] / 0.0134
    np.testing.assert_allclose(
        (heavy.current - plain.current)[moving, 1], added[moving], rtol=1e-9, atol=1e-12
    )
    np.testing.assert_array_equal(heavy.current[:, 0], plain.current[:, 0])
    rod = np.column_stack([motion.position, 0.007 + 0.001 * np.sin(motion.time)])
    jaw = a5.trajectory.motion(motion.time, rod)
    without = a5.trajectory.analyse(jaw)
    assert np.isnan(without.current[:, 4]).all()
    assert np.isfinite(without.current[:, :4]).all()
    assert a5.trajectory.summary(without)["joints"]["axis_a"]["current_peak"] is None
    lead = {"axis_a": actuator("axis_a", screw_lead=1e-3)}
    assert np.isfinite(a5.trajectory.analyse(jaw, actuators=lead).current).all()


@pytest.fixture(scope="module")
def driven() -> a5.trajectory.Analysis:
    """A planned motion with the limits of a drive that it passes."""
    return a5.trajectory.analyse(planned(801), supply_voltage=24.0, current_limit=0.3)


@pytest.fixture(scope="module")
def driven_summary(driven: a5.trajectory.Analysis) -> dict[str, Any]:
    summary = a5.trajectory.summary(driven)
    json.dumps(summary, allow_nan=False)
    return summary


def sample_at(analysis: a5.trajectory.Analysis, peak: dict[str, Any]) -> int:
    """The number of the sample at the time of a peak."""
    return np.flatnonzero(analysis.smooth.time == peak["time_s"])[0]


@pytest.mark.parametrize(("k", "name"), MOTOR_JOINTS)
def test_margins_are_the_limits_minus_the_peaks(
    k: int,
    name: str,
    driven: a5.trajectory.Analysis,
    driven_summary: dict[str, Any],
) -> None:
    joint = driven_summary["joints"][name]
    torque_peak = np.abs(driven.torque[:, k]).max()
    assert abs(joint["torque_peak"]["value"]) == torque_peak
    assert joint["torque_margin"] == pytest.approx(9.0 - torque_peak)

    velocity_peak = np.abs(driven.smooth.velocity[:, k]).max()
    assert joint["velocity_margin"] == pytest.approx(RATED[k] - velocity_peak)

    upper_current_peak = np.abs(driven.current_upper[:, k]).max()
    assert joint["current_margin"] == pytest.approx(0.3 - upper_current_peak)

    voltage_peak = np.abs(driven.voltage[:, k]).max()
    assert joint["voltage_margin"] == pytest.approx(24.0 - voltage_peak)

    lowest = driven.motion.position[:, k].min()
    highest = driven.motion.position[:, k].max()
    assert joint["position_range"] == [lowest, highest]
    nearest = min(lowest - LOWER[k], UPPER[k] - highest)
    assert joint["position_margin"] == pytest.approx(nearest)


@pytest.mark.parametrize(("k", "name"), MOTOR_JOINTS)
def test_samples_beyond_the_drive_pass_its_current_or_its_voltage(
    k: int,
    name: str,
    driven: a5.trajectory.Analysis,
    driven_summary: dict[str, Any],
) -> None:
    """At rest friction holds, so no current is needed and no limit is passed."""
    joint = driven_summary["joints"][name]
    too_much_current = np.abs(driven.current[:, k]) > 0.3
    too_much_voltage = np.abs(driven.voltage[:, k]) > 24.0
    over = too_much_current | too_much_voltage
    assert joint["beyond_drive_limits"] == np.count_nonzero(over)
    assert (joint["drive_torque_margin"] < 0) == bool(over.any())

    below_upper = driven.torque_limits.upper - driven.torque
    above_lower = driven.torque - driven.torque_limits.lower
    left = np.minimum(below_upper, above_lower)
    assert joint["drive_torque_margin"] == np.nanmin(left[:, k])


@pytest.mark.parametrize(("k", "name"), MOTOR_JOINTS)
def test_peaks_are_the_largest_samples_of_their_curves(
    k: int,
    name: str,
    driven: a5.trajectory.Analysis,
    driven_summary: dict[str, Any],
) -> None:
    joint = driven_summary["joints"][name]
    curves = {
        "torque": driven.torque,
        "velocity": driven.smooth.velocity,
        "acceleration": driven.smooth.acceleration,
        "voltage": driven.voltage,
        "power": driven.electrical_power,
    }
    for key, curves_of_joints in curves.items():
        curve = curves_of_joints[:, k]
        peak = joint[f"{key}_peak"]
        at = sample_at(driven, peak)
        assert peak["value"] == curve[at]
        assert abs(curve[at]) == np.abs(curve).max()

    current_peak = joint["current_peak"]
    at = sample_at(driven, current_peak)
    assert current_peak["value"] == driven.current[at, k]
    assert current_peak["interval"] == [
        driven.current_lower[at, k],
        driven.current_upper[at, k],
    ]
    for cause in ("inertia", "coriolis", "weight", "buoyancy", "friction"):
        largest = np.abs(getattr(driven, cause)[:, k]).max()
        assert joint["causes_peak"][cause] == largest


@pytest.mark.parametrize("end", [0, 1])
def test_the_interval_of_energy_is_that_of_the_extremes_of_friction(
    end: int, driven: a5.trajectory.Analysis, driven_summary: dict[str, Any]
) -> None:
    energy = driven_summary["energy"]["drawn_interval_j"]
    assert len(energy) == 2
    extreme = {name: actuator(name).extremes()[end] for _, name in MOTOR_JOINTS}
    other = a5.trajectory.analyse(driven.motion, actuators=extreme)
    drawn = a5.trajectory.summary(other)["energy"]["drawn_j"]
    assert energy[end] == pytest.approx(drawn, rel=1e-9)


@pytest.fixture(scope="module")
def jaws_in_motion() -> a5.trajectory.Analysis:
    """A straight motion of the arm with jaws, with two gaps."""
    t = np.concatenate([[3.0], np.arange(3.5, 9.0, 0.01), [10.25]])
    start = np.array([1.0, 0.4, 0.5, 2.0, 0.003])
    way = np.array([1.4, 1.5, 1.5, 1.5, 0.009])
    q = start + np.outer((t - 3) / 7.25, way)
    motion = a5.trajectory.motion(t, q)
    arm = a5.load(fluid_density=1003.0, gripper="jaws", gravity=(0.5, 0, -9.7))
    return a5.trajectory.analyse(motion, arm, bandwidth=3.0, constants="torque")


def test_summary_of_energies_and_of_the_mount(
    jaws_in_motion: a5.trajectory.Analysis,
) -> None:
    r = jaws_in_motion
    s = a5.trajectory.summary(r)
    t = r.motion.time
    power = np.nansum(r.electrical_power, axis=1)
    energy = s["energy"]
    assert energy["electrical_peak_w"] == power.max()
    fed_back = np.trapezoid(np.clip(-power, 0, None), t)
    assert energy["fed_back_j"] == pytest.approx(fed_back)
    work = np.trapezoid(r.mechanical_power.sum(axis=1), t)
    assert energy["mechanical_j"] == pytest.approx(work, rel=1e-12)
    for key, columns_ in (
        ("force_peak_n", slice(0, 3)),
        ("moment_peak_nm", slice(3, 6)),
    ):
        size = np.linalg.norm(r.base_wrench[:, columns_], axis=1)
        peak = s["mount"][key]
        assert (peak["value"], peak["time_s"]) == (size.max(), t[size.argmax()])


def test_speeds_beyond_the_rating_are_said_as_limits_are() -> None:
    t = np.linspace(0, 1, 101)
    speed = np.array([0.6, 0.5, 0.52, 0.88])
    motion = a5.trajectory.motion(
        t, 1.2 + np.outer(t, speed), np.ones((101, 1)) * speed
    )
    r = a5.trajectory.analyse(motion, method="interpolate")
    s = a5.trajectory.summary(r)
    over = {name: j["beyond_rated_velocity"] for name, j in s["joints"].items()}
    assert over == {"axis_e": 101, "axis_d": 0, "axis_c": 0, "axis_b": 101}
    text = a5.trajectory.text(r)
    assert (
        "limit: axis_e is beyond its rated speed of 0.5236 rad/s "
        "in 101 samples, up to 0.6\n" in text
    )
    assert text.count("is beyond its rated speed") == 2


def test_a_planned_motion_at_rated_speed_is_not_beyond_it(tmp_path: Path) -> None:
    planned = a5.plan(a5.named_pose("home"), [0.15, 0.20, 0.10])
    planned.write(tmp_path / "motion.csv")
    motion = a5.trajectory.read_motion(tmp_path / "motion.csv")
    s = a5.trajectory.summary(a5.trajectory.analyse(motion, method="interpolate"))
    assert s["joints"]["axis_c"]["velocity_margin"] == 0.0
    assert {j["beyond_rated_velocity"] for j in s["joints"].values()} == {0}


def test_constants_change_what_they_should() -> None:
    runs = {
        c: a5.trajectory.analyse(planned(101), constants=c)
        for c in ("printed", "torque", "voltage")
    }
    np.testing.assert_array_equal(runs["printed"].current, runs["torque"].current)
    ratio = runs["voltage"].current[:, 3] / np.where(
        runs["printed"].current[:, 3] == 0, np.nan, runs["printed"].current[:, 3]
    )
    np.testing.assert_allclose(ratio[~np.isnan(ratio)], 0.0271 / 0.0545, rtol=1e-12)
    unexplained = {
        c: a5.trajectory.summary(r)["energy"]["contradiction_j"]
        for c, r in runs.items()
    }
    assert unexplained["torque"] == unexplained["voltage"] == 0.0
    assert unexplained["printed"] < -1e-3


@pytest.mark.parametrize(
    "bad", [" ", "24", [24.0], np.zeros((2, 2)), np.zeros(0), abs, math.nan]
)
def test_a_supply_or_a_limit_that_is_no_number_is_refused(bad: object) -> None:
    m = planned(101)
    for supply, limit in ((bad, 1.0), (24.0, bad), (bad, None), (None, bad)):
        with pytest.raises(InputError, match=r"supply_voltage|current_limit"):
            a5.trajectory.analyse(m, supply_voltage=supply, current_limit=limit)


def test_what_does_not_fit_is_refused() -> None:
    motion = planned(51)
    for call, message in (
        (lambda: a5.trajectory.analyse(motion, a5.load(gripper="jaws")), "axis_a"),
        (
            lambda: a5.trajectory.analyse(motion, a5.load(floating_base=True)),
            "fixed base",
        ),
        (lambda: a5.trajectory.analyse(motion, supply_voltage=24.0), "both or neither"),
        (
            lambda: a5.trajectory.analyse(
                motion, supply_voltage=24.0, current_limit=0.0
            ),
            "above 0",
        ),
    ):
        with pytest.raises(InputError, match=message):
            call()
    with pytest.raises(UnknownNameError):
        a5.trajectory.analyse(motion, actuators={"axis_a": actuator("axis_a")})
    with pytest.raises(UnknownNameError):
        a5.trajectory.analyse(motion, constants="best")


def test_locked_arm_leaves_the_jaw_rod_out() -> None:
    m = planned(51)
    five = a5.trajectory.motion(
        m.time, np.column_stack([m.position, np.full(51, 0.0013)])
    )
    four = a5.trajectory.analyse(m)
    r = a5.trajectory.analyse(five, a5.load(gripper="locked"))
    np.testing.assert_array_equal(r.torque, four.torque)
    assert "axis_a" in r.motion.ignored
    # Jaws closed and still: the same arm.
    np.testing.assert_allclose(
        a5.trajectory.analyse(five).torque[:, :4], four.torque, atol=1e-12
    )


def test_tables_hold_every_column_and_can_be_read_again(tmp_path: Path) -> None:
    r = a5.trajectory.analyse(planned(41), supply_voltage=24.0, current_limit=1.0)
    table = columns(r)
    a5.trajectory.write(r, tmp_path / "t.csv")
    header, *rows = (tmp_path / "t.csv").read_text().splitlines()
    assert header.split(",") == list(table)
    back = np.array([[float(x) for x in row.split(",")] for row in rows])
    np.testing.assert_allclose(
        back, np.stack(list(table.values()), axis=1), rtol=1e-8, atol=1e-12
    )
    again = a5.trajectory.read_motion(tmp_path / "t.csv")
    np.testing.assert_allclose(again.position, r.smooth.position, rtol=1e-8)
    a5.trajectory.write(r, tmp_path / "t.json")
    record = json.loads((tmp_path / "t.json").read_text())
    assert record["summary"] == a5.trajectory.summary(r)
    assert record["columns"] == {
        name: column.tolist() for name, column in table.items()
    }
    with pytest.raises(UnknownNameError, match=r"\.csv, \.json"):
        a5.trajectory.write(r, tmp_path / "t.xlsx")
    (tmp_path / "folder.csv").mkdir()
    with pytest.raises(OutputError):
        a5.trajectory.write(r, tmp_path / "folder.csv")
    broken = dataclasses.replace(
        r, torque=np.where(np.arange(41)[:, None] == 7, np.nan, r.torque)
    )
    with pytest.raises(ValueError, match="not JSON compliant"):
        a5.trajectory.write(broken, tmp_path / "broken.json")
    assert sorted(p.name for p in tmp_path.iterdir()) == [
        "folder.csv",
        "t.csv",
        "t.json",
    ]


def test_import_stays_light() -> None:
    script = (
        "import sys; "
        "from alpha5_model.trajectory import read_motion; "
        "print(*sys.modules)"
    )
    root = Path(a5.__file__).parent.parent
    done = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        text=True,
        check=True,
        cwd=root,
    )
    assert {"pinocchio", "scipy", "matplotlib"}.isdisjoint(done.stdout.split())


@needs_recordings
@pytest.mark.parametrize("path", JOINT_STATES, ids=lambda p: getattr(p, "stem", "none"))
def test_recordings_end_to_end(path: Path) -> None:
    r = a5.trajectory.analyse(
        a5.trajectory.read_motion(path),
        supply_voltage=24.0,
        current_limit=1.0,
    )
    s = a5.trajectory.summary(r)
    assert s["warnings"] == []
    moves = np.ptp(r.motion.position[:, :4], axis=0) > 0.1
    for k, name in enumerate(("axis_e", "axis_d", "axis_c", "axis_b")):
        j = s["joints"][name]
        # In water, the arm's own weight takes less than 1 N m at any joint.
        # Friction alone takes 0.28 A of a big motor.
        assert abs(j["torque_peak"]["value"]) < 1.0
        assert j["torque_margin"] > 8.0
        assert j["velocity_margin"] > 0
        if moves[k]:
            low, high = j["current_peak"]["interval"]
            assert (
                low < abs(j["current_peak"]["value"]) < high
                or low < j["current_peak"]["value"] < high
            )
            assert j["current_margin"] > 0.6
    if not moves.any():
        assert s["energy"]["drawn_j"] == 0.0
        assert np.abs(r.inertia[:, :4]).max() < 2e-3
    text = a5.trajectory.text(r)
    for name in r.smooth.joints:
        assert name in text


def test_motors_and_rated_speeds_are_those_of_the_arms_record() -> None:
    """Twice the friction of axis_d's motor, and an axis_d that counts as at rest."""
    p = a5.parameters()
    motor = dataclasses.replace(p.actuators[1], friction=2 * p.actuators[1].friction)
    fast = dataclasses.replace(p.joints[1], velocity=4 * p.joints[1].velocity)
    actuators = (p.actuators[0], motor, *p.actuators[2:])
    joints = (p.joints[0], fast, *p.joints[2:])
    time = np.linspace(0.0, 3.0, 60)
    swing = np.array([0.3, 0.003, 0.3, 0.3])  # rest is slower than 0.001 rad/s
    motion = a5.trajectory.motion(time, 1.5 + np.sin(time)[:, None] * swing)
    catalogue = a5.trajectory.analyse(motion)

    with_motor = dataclasses.replace(p, actuators=actuators)
    own = a5.trajectory.analyse(motion, arm_of(with_motor))
    assert own.actuators[1].parameters is motor
    np.testing.assert_array_equal(own.current[:, 0], catalogue.current[:, 0])
    moving = own.smooth.direction[:, 1] != 0
    assert moving.sum() > 40
    more = np.abs(own.friction[moving, 1]) / np.abs(catalogue.friction[moving, 1])
    assert more.min() > 1.2

    with_speed = dataclasses.replace(p, joints=joints)
    resting = a5.trajectory.analyse(motion, arm_of(with_speed)).smooth
    assert not resting.direction[:, 1].any()
    np.testing.assert_array_equal(
        resting.direction[:, 0], catalogue.smooth.direction[:, 0]
    )


def test_an_arm_in_moving_water_is_refused() -> None:
    """The current is an argument, so the arm's water would count twice or never."""
    time = np.linspace(0.0, 1.0, 20)
    position = np.outer(np.sin(time), [0.1, 0.2, 0.3, 0.4]) + 1.0
    motion = a5.trajectory.motion(time, position)
    wet = a5.load().with_hydrodynamics((0.1, 0.0, 0.0))
    with pytest.raises(
        a5.errors.InputError, match=r"still water .*got .HydrodynamicArm"
    ):
        a5.trajectory.analyse(motion, wet)
