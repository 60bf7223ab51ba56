"""What an analysis warns of, and its figures by their definitions."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from reference import LOWER, UPPER

import alpha5_model as a5
from alpha5_model.trajectory import columns

JOINTS = ("axis_e", "axis_d", "axis_c", "axis_b", "axis_a")
ROD = (0.0013, 0.0133)
RATED = (math.radians(30), math.radians(30), math.radians(30), math.radians(50), 0.003)
RANGES = [*zip(LOWER, UPPER, strict=True), ROD]


def resting(count: int = 40, step: float = 0.02) -> tuple[np.ndarray, np.ndarray]:
    """Times and positions of an arm that rests in the middle of its ranges."""
    middle = np.array([(low + high) / 2 for low, high in RANGES])
    return step * np.arange(count), np.tile(middle, (count, 1))


# --- checks of a motion ---------------------------------------------------------------


def test_of_a_repeated_time_the_first_sample_counts() -> None:
    t, q = resting(10)
    q += np.arange(10)[:, None] * 1e-5
    v = 1e-3 * np.arange(50.0).reshape(10, 5)
    t[4] = t[3]
    motion = a5.trajectory.motion(t, q, v)
    kept = [0, 1, 2, 3, 5, 6, 7, 8, 9]
    np.testing.assert_array_equal(motion.position, q[kept])
    np.testing.assert_array_equal(motion.velocity, v[kept])
    np.testing.assert_array_equal(motion.time, t[kept])
    assert [str(w) for w in motion.warnings] == [
        "time repeated, sample dropped: 1 x, first: sample 4"
    ]
    for array in (motion.time, motion.position, motion.velocity):
        assert array is not None
        assert not array.flags.writeable


# --- smoothing ------------------------------------------------------------------------


# --- analysis -------------------------------------------------------------------------


def test_the_rod_is_left_out_with_its_warnings() -> None:
    t, q = resting()
    q[20:, 4] = 0.02
    q[20:, 1] += 2.0
    v = 1e-3 * np.ones_like(q)
    motion = a5.trajectory.motion(t, q, v)
    assert {w.text.split()[0] for w in motion.warnings} == {"axis_a", "axis_d"}
    r = a5.trajectory.analyse(motion, a5.load())
    assert r.motion.joints == JOINTS[:4]
    np.testing.assert_array_equal(r.motion.position, q[:, :4])
    np.testing.assert_array_equal(r.motion.velocity, v[:, :4])
    assert r.motion.ignored == ("axis_a",)
    assert {w.text.split()[0] for w in r.warnings if w.kind != "velocity"} == {"axis_d"}


@pytest.mark.parametrize("rest", [True, False])
def test_limits_hold_a_resting_joint_and_drive_a_moving_one(rest: bool) -> None:
    """The torque limits follow from Table 4's figures of the big motors."""
    resistance = 3.22
    friction = 3.752e-3
    eta = 0.86
    k_t = 0.0134
    k_v = 0.0116
    gear = 1754.4
    t = 0.02 * np.arange(100)
    q = resting(100)[1][:, :4]
    if not rest:
        q += 0.2 * t[:, None]
    for volt, ampere in ((24.0, 0.5), (5.0, 0.5)):
        motion = a5.trajectory.motion(t, q)
        r = a5.trajectory.analyse(
            motion, method="interpolate", supply_voltage=volt, current_limit=ampere
        )
        assert (r.supply_voltage, r.current_limit) == (volt, ampere)
        assert r.torque_limits is not None
        if rest:
            most = min(ampere, volt / resistance)
            # The load drives motor and friction backwards through the gear.
            held = (k_t * most + friction) * gear / eta
            np.testing.assert_allclose(r.torque_limits.upper[:, :3], held, rtol=1e-9)
            np.testing.assert_allclose(r.torque_limits.lower[:, :3], -held, rtol=1e-9)
        else:
            most = min(ampere, (volt - k_v * gear * 0.2) / resistance)
            driven = (k_t * most - friction) * gear
            np.testing.assert_allclose(
                r.torque_limits.upper[:, :3], eta * driven, rtol=1e-9
            )


# --- tables and sentences -------------------------------------------------------------


@pytest.fixture
def analysis() -> a5.trajectory.Analysis:
    """One joint in motion, with the limits of a drive."""
    t, q = resting(30)
    q[:, 1] += 0.2 * np.sin(3 * t)
    motion = a5.trajectory.motion(t, q)
    return a5.trajectory.analyse(motion, supply_voltage=24.0, current_limit=1.0)


def test_columns_by_name(analysis: a5.trajectory.Analysis) -> None:
    r = analysis
    table = columns(r)
    assert r.torque_limits is not None
    for k, name in enumerate(JOINTS):
        for suffix, values in (
            ("pos", r.smooth.position),
            ("vel", r.smooth.velocity),
            ("acc", r.smooth.acceleration),
            ("torque", r.torque),
            ("torque_inertia", r.inertia),
            ("torque_coriolis", r.coriolis),
            ("torque_weight", r.weight),
            ("torque_buoyancy", r.buoyancy),
            ("mechanical_power", r.mechanical_power),
        ):
            np.testing.assert_array_equal(table.pop(f"{name}_{suffix}"), values[:, k])
        # The rod's motor cannot be computed without a screw lead.
        if name != "axis_a":
            for suffix, values in (
                ("torque_friction", r.friction),
                ("current", r.current),
                ("current_lower", r.current_lower),
                ("current_upper", r.current_upper),
                ("voltage", r.voltage),
                ("electrical_power", r.electrical_power),
                ("torque_min", r.torque_limits.lower),
                ("torque_max", r.torque_limits.upper),
            ):
                column = table.pop(f"{name}_{suffix}")
                np.testing.assert_array_equal(column, values[:, k])
    for k, axis in enumerate("xyz"):
        force = table.pop(f"base_force_{axis}")
        np.testing.assert_array_equal(force, r.base_wrench[:, k])
        moment = table.pop(f"base_moment_{axis}")
        np.testing.assert_array_equal(moment, r.base_wrench[:, 3 + k])
        np.testing.assert_array_equal(table.pop(f"tcp_{axis}"), r.tcp[:, k])
    assert list(table) == ["time_secs"]


def test_energies_peaks_and_missing_motors_in_the_record() -> None:
    """One joint feeds back, one draws, and the rod's motor cannot be computed."""
    t, q = resting(3000, step=0.002)
    q[:, 1] += 0.4 * np.sin(2 * t)
    r = a5.trajectory.analyse(a5.trajectory.motion(t, q), method="interpolate")
    power = r.electrical_power.copy()
    power[:, 1] = 3 * np.sin(5 * t)
    power[:, 0] = -1.0
    r = replace(r, electrical_power=power)
    s = a5.trajectory.summary(r)
    total = np.nansum(power, axis=1)
    assert s["energy"]["electrical_peak_w"] == total.max()
    assert s["energy"]["drawn_j"] == pytest.approx(np.trapezoid(total.clip(0), t))
    assert s["energy"]["fed_back_j"] == pytest.approx(np.trapezoid((-total).clip(0), t))
    assert s["joints"]["axis_d"]["energy_drawn_j"] == pytest.approx(
        np.trapezoid(power[:, 1].clip(0), t)
    )
    rod = s["joints"]["axis_a"]
    for key in (
        "current_peak",
        "current_rms",
        "voltage_peak",
        "power_peak",
        "energy_drawn_j",
        "current_margin",
        "voltage_margin",
        "drive_torque_margin",
        "beyond_drive_limits",
    ):
        assert rod[key] is None
    assert rod["causes_peak"]["friction"] is None
    # Table 4's constants contradict each other by (K_v - K_t) gear current speed.
    current_speed = r.current * r.smooth.signed_velocity
    big_motors = (0.0116 - 0.0134) * 1754.4 * current_speed[:, :3]
    wrist = (0.0545 - 0.0271) * 340.4 * current_speed[:, 3]
    expected = np.trapezoid(big_motors.sum(axis=1) + wrist, t)
    assert s["energy"]["contradiction_j"] == pytest.approx(expected, rel=1e-9)
    assert abs(expected) > 1e-3
    json.dumps(s, allow_nan=False)
