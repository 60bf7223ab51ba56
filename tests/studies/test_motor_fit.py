"""The parts of a fit of motors: what is used, the prior, and the judgement of a fit."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import InputError
from alpha5_model.numbers.measurement import Measurement
from alpha5_model.numbers.motors import Motors
from alpha5_model.studies.calibration import motor_currents
from alpha5_model.studies.calibration.motor_currents import (
    MotorCalibration,
    Payload,
    _averaged,
    _check_sign,
    _Fit,
    _fit,
    _motor,
    _nuisances,
    _prior,
    _weighed,
)
from alpha5_model.studies.calibration.motor_record import JointMotor, with_motors
from alpha5_model.studies.uncertainty.noise import ORDER

ARM = a5.load()
RECORD = ARM.parameters
AXIS_D = RECORD.joints[1]
TIME = np.arange(0.0, 50.0, 0.05)
RATE = 2 * np.pi * 0.09
VELOCITY = 0.9 * AXIS_D.velocity * np.sin(RATE * TIME + 0.3)
ACCELERATION = np.gradient(VELOCITY, TIME)
TORQUE = 0.8 * np.cos(RATE * TIME) + 0.4 * np.cos(0.71 * TIME)
PER_AMPERE = 24.0


def motion(velocity: Any = VELOCITY) -> Any:
    """Motion of all joints alike."""
    columns = np.tile(velocity[:, None], 4)
    slopes = np.tile(ACCELERATION[:, None], 4)
    return SimpleNamespace(time=TIME, velocity=columns, acceleration=slopes)


def current(forward: float = 0.1, backward: float = 0.08) -> Any:
    """Of a motor without noise."""
    friction = np.where(VELOCITY > 0, forward, -backward)
    return TORQUE / PER_AMPERE + friction + 0.02 * VELOCITY + 0.003 * ACCELERATION


def fitted(given: Any, velocity: Any = VELOCITY, of_payload: Any = None) -> _Fit:
    load = np.zeros_like(TIME) if of_payload is None else of_payload
    return _fit(motion(velocity), 1, given, TORQUE, load, ARM)


def test_a_current_without_noise_is_fitted_exactly() -> None:
    found = fitted(current())
    expected = [1 / PER_AMPERE, 0.1, 0.08, 0.02, 0.003, 0.0]
    assert found.values == pytest.approx(expected, abs=1e-5)
    assert found.noise < 1e-6
    deviation = np.sqrt(np.diag(found.covariance))
    assert (np.delete(deviation, [1, 2]) < 1e-5).all()
    # The current's zero, known to 2 mA, adds to one friction and takes from the other.
    assert deviation[1:3] == pytest.approx([0.002, 0.002], rel=0.01)
    assert found.covariance[1, 2] == pytest.approx(-(0.002**2), rel=0.01)


@pytest.mark.parametrize("kept", [57, 62])
def test_one_way_may_have_currents_only_early_on(kept: int) -> None:
    """The columns of its drift are zero in most rows, to rounding errors."""
    noisy = current() + 1e-4 * np.random.default_rng(0).normal(size=TIME.size)
    backward = np.flatnonzero(VELOCITY < 0)
    noisy[backward[kept:]] = np.nan
    found = fitted(noisy)
    assert found.values[:2] == pytest.approx([1 / PER_AMPERE, 0.1], rel=1e-3)
    assert found.noise == pytest.approx(1e-4, rel=0.05)


def test_drifts_and_the_friction_at_low_speed_have_their_own_columns() -> None:
    turn = np.pi * TIME / TIME[-1]
    way = np.sign(VELOCITY)
    drift = 0.01 * np.cos(turn) - 0.008 * np.cos(3 * turn)
    of_friction = 0.01 * np.cos(2 * turn) - 0.015 * np.cos(4 * turn)
    slow = 0.02 * np.exp(-np.abs(VELOCITY) / (0.1 * AXIS_D.velocity))
    found = fitted(current() + drift + way * (of_friction + slow))
    expected = [1 / PER_AMPERE, 0.1, 0.08, 0.02, 0.003, 0.0]
    assert found.values == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize("seconds", [60.0, 59.0, 20.0, 41.0])
def test_drifts_last_20_s_or_more(seconds: float) -> None:
    time = np.linspace(3.0, 3.0 + seconds, 400)
    velocity = np.where(np.arange(400) % 2, 0.2, -0.3)
    columns = _nuisances(time, velocity, AXIS_D).T
    most = (len(columns) - 2) // 2
    assert len(columns) == 2 * most + 2
    assert 2 * seconds / most >= 20.0 > 2 * seconds / (most + 1)
    way = np.sign(velocity)
    for k in range(most + 1):
        wave = np.cos(np.pi * k * (time - 3.0) / seconds)
        np.testing.assert_allclose(columns[k], wave, atol=1e-12)
        if k:
            np.testing.assert_allclose(columns[most + k], way * wave, atol=1e-12)


@pytest.mark.slow
def test_samples_below_015_of_the_rated_speed_are_left_out() -> None:
    clean = fitted(current()).values
    share = np.abs(VELOCITY) / AXIS_D.velocity
    wrong = current() + 5.0 * (share < 0.149)
    np.testing.assert_allclose(fitted(wrong).values, clean, rtol=1e-6, atol=1e-9)
    missing = np.where(share > 0.151, current(), np.nan)
    np.testing.assert_allclose(fitted(missing).values, clean, rtol=1e-6, atol=1e-6)
    just_above = current() + 5.0 * ((share > 0.15) & (share < 0.17))
    assert not np.allclose(fitted(just_above).values, clean, rtol=0.01)


@pytest.mark.parametrize(("sign", "way"), [(1.0, "forward"), (-1.0, "backward")])
def test_fifty_samples_in_each_direction(sign: float, way: str) -> None:
    fast = np.flatnonzero(sign * VELOCITY > 0.15 * AXIS_D.velocity)
    for count in (50, 49):
        given = current() + np.random.default_rng(2).normal(size=TIME.size) * 1e-4
        given[fast[count:]] = np.nan
        if count == 50:
            fitted(given)
            continue
        expected = f"axis_d with 49 samples {way} that are fast enough"
        with pytest.raises(InputError, match=expected) as caught:
            fitted(given)
        assert "50 above 0.0785 rad/s" in str(caught.value)


def test_the_jaw_rod_is_left_out() -> None:
    """Of a recording that has its position and current, too."""
    time = TIME[:500]
    turns = np.outer(time, 2 * np.pi * np.array([0.11, 0.09, 0.13, 0.17]))
    size = np.minimum([0.6, 0.8, 0.6, 0.7], 0.45 / (turns[1] / time[1]))
    q = np.array([3.0, 1.7, 1.7, 3.0]) + size * np.sin(turns)
    given = 0.05 * np.sign(np.cos(turns))
    given += 0.002 * np.random.default_rng(5).normal(size=given.shape)
    rod = np.linspace(0.0, 0.01, time.size)
    found = []
    for extra in ([], [rod]):
        recorded = a5.trajectory.motion(
            time, np.column_stack([q, *extra]), current=np.column_stack([given, *extra])
        )
        found.append(a5.calibrate.motors(recorded, method="interpolate"))
    assert found[0].joints == found[1].joints
    assert found[1].joints[1].friction_forward == pytest.approx(0.05, abs=0.01)


def test_the_fit_is_the_mean_over_all_likely_noise(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Its covariance is the mean one and that of the means, by normal equations."""
    rng = np.random.default_rng(8)
    rows = rng.normal(size=(60, 8))
    measured = rows @ rng.normal(size=8) + rng.normal(size=60)
    measured[7] = np.nan
    middle = rng.normal(size=8)
    deviation = rng.uniform(0.1, 1.0, 8)
    sizes = np.array([0.5, 1.0, 4.0])
    likely = np.column_stack([np.zeros((3, ORDER)), sizes])
    noise = SimpleNamespace(likely=likely, deviation=1.5)
    monkeypatch.setattr(motor_currents, "noise_of_channel", lambda *given: noise)
    found = _averaged(rows, measured, middle, deviation)

    used = np.isfinite(measured)
    means = []
    covariances = []
    for size in sizes:
        information = rows[used].T @ rows[used] / size**2 + np.diag(deviation**-2)
        target = rows[used].T @ measured[used] / size**2 + middle / deviation**2
        covariances.append(np.linalg.inv(information))
        means.append(covariances[-1] @ target)
    mean = np.mean(means, axis=0)
    spread = sum(np.outer(one - mean, one - mean) for one in means) / 3
    assert found.values == pytest.approx(mean[:6])
    expected = (np.mean(covariances, axis=0) + spread)[:6, :6]
    assert found.covariance == pytest.approx(expected)
    assert found.noise == 1.5


# --- the prior ------------------------------------------------------------------------


def test_friction_is_expected_between_a_drivers_and_table_4s() -> None:
    """One standard deviation to both sides; 280 mA is the current by Table 4."""
    middle, deviation = _prior(RECORD, 1, 20, with_payload=False)
    actuator = RECORD.actuators[1]
    by_table = actuator.friction / actuator.torque_constant
    for k in (1, 2):
        assert middle[k] + deviation[k] == pytest.approx(by_table, rel=0.01)
        assert middle[k] - deviation[k] == pytest.approx(0.043, abs=0.004)
    assert not np.delete(middle, [0, 1, 2]).any()


def test_torque_per_ampere_is_as_uncertain_as_the_two_constants_differ() -> None:
    """Those of axis_b's motor differ most."""
    for k in range(4):
        actuator = RECORD.actuators[k]
        middle, deviation = _prior(RECORD, k, 20, with_payload=False)
        per_ampere = actuator.torque_constant * actuator.gear_ratio
        assert middle[0] == pytest.approx(1 / per_ampere)
        ratios = [a.torque_constant / a.voltage_constant for a in RECORD.actuators]
        assert deviation[0] / middle[0] == pytest.approx(1 - min(ratios), abs=0.01)


def test_a_measured_constant_is_known_to_its_half_width() -> None:
    """It is that of a 95 % interval."""
    constant = RECORD.actuators[1].torque_constant
    for half_width in (0.1 * constant, 0.0):
        measured = Measurement(
            key="motors.torque_constant.axis_d", source="a brake", half_width=half_width
        )
        record = replace(RECORD, measurements=(measured,))
        middle, deviation = _prior(record, 1, 20, with_payload=False)
        share = deviation[0] / middle[0]
        assert share == pytest.approx(half_width / constant / 1.96, abs=2e-6)
        assert share > 0
    others = _prior(record, 2, 20, with_payload=False)[1]
    assert others[0] == _prior(RECORD, 2, 20, with_payload=False)[1][0]


def test_a_payload_of_a_kilogram_is_likely_or_there_is_none() -> None:
    per_ampere = 1 / _prior(RECORD, 1, 20, with_payload=True)[0][0]
    with_one = _prior(RECORD, 1, 20, with_payload=True)[1]
    without = _prior(RECORD, 1, 20, with_payload=False)[1]
    assert with_one[5] * per_ampere == pytest.approx(1.0)
    assert 0 < without[5] * per_ampere < 1e-6
    assert np.array_equal(np.delete(with_one, 5), np.delete(without, 5))


def test_a_zero_drifts_less_than_friction_and_both_by_little() -> None:
    _, deviation = _prior(RECORD, 1, 20, with_payload=False)
    assert 0 < deviation[6] < deviation[7] < 0.05
    assert np.ptp(np.delete(deviation, [0, 1, 2, 5, 6])) == 0.0
    assert len(deviation) == 20


# --- the judgement --------------------------------------------------------------------


def fit(values: Any, deviation: Any = 0.001, together: float = 0.0) -> _Fit:
    covariance = np.diag(np.broadcast_to(deviation, 6) ** 2).astype(float)
    covariance[1, 2] = covariance[2, 1] = together
    return _Fit(values=np.array(values, float), covariance=covariance, noise=0.004)


def test_friction_that_drives_a_joint_is_refused_beyond_four_deviations() -> None:
    for together in (0.0, 0.2, -0.2):
        spread = np.sqrt(0.5**2 + 1.0**2 + 2 * together)
        for share, refused in ((-3.9, False), (-4.1, True)):
            sum_of_both = share * spread
            values = [0.04, sum_of_both + 0.01, -0.01, 0.0, 0.0, 0.0]
            one = fit(values, [0.001, 0.5, 1.0, 1.0, 1.0, 1.0], together)
            if not refused:
                _check_sign(one, "axis_c")
                continue
            said = f"axis_c with a friction of {500 * sum_of_both:.0f} mA"
            with pytest.raises(InputError, match=said):
                _check_sign(one, "axis_c")


def test_a_motor_has_the_coefficients_of_its_fit() -> None:
    deviation = np.array([0.001, 0.011, 0.012, 0.013, 0.014, 0.015])
    found = _motor(fit([0.05, 0.1, 0.08, 0.02, 0.003, 0.0], deviation), 1, RECORD)
    assert found._replace(torque_per_ampere=0.0, relative_deviation=0.0) == JointMotor(
        name="axis_d",
        friction_forward=0.1,
        friction_backward=0.08,
        friction_deviation=0.012,
        viscous=0.02,
        viscous_deviation=0.013,
        armature=0.003,
        armature_deviation=0.014,
        torque_per_ampere=0.0,
        relative_deviation=0.0,
        known=True,
        noise=0.004,
    )
    assert found.torque_per_ampere == pytest.approx(20.0)
    assert found.relative_deviation == pytest.approx(0.02)
    against = _motor(fit([0.05, 0.1, 0.08, -0.02, -0.003, 0.0], deviation), 1, RECORD)
    assert against.viscous == against.armature == 0.0
    forward = deviation[[0, 2, 1, 3, 4, 5]]
    wide = _motor(fit([0.05, 0.1, 0.08, 0.02, 0.003, 0.0], forward), 1, RECORD)
    assert wide.friction_deviation == pytest.approx(0.012)


def test_an_uncertain_torque_per_ampere_is_that_of_the_record() -> None:
    actuator = RECORD.actuators[1]
    table = actuator.torque_constant * actuator.gear_ratio
    for scale, deviation, known in (
        (0.05, 0.0124, True),
        (0.05, 0.0126, False),
        (-0.05, 0.001, False),
    ):
        found = _motor(fit([scale, 0.1, 0.1, 0.0, 0.0, 0.0], deviation), 1, RECORD)
        assert found.known is known
        assert found.torque_per_ampere == pytest.approx(1 / scale if known else table)
        assert found.relative_deviation == pytest.approx(deviation / abs(scale))


def motors(friction: float = 0.1) -> tuple[JointMotor, ...]:
    return tuple(
        _motor(fit([0.05, friction - 0.01 * k, 0.2, 0.02, 0.003, 0.0]), k, RECORD)
        for k in range(4)
    )


def test_a_payload_is_the_mean_of_the_joints_by_their_certainty() -> None:
    """With the error of a ratio, by finite differences."""
    fits = []
    masses = []
    variances = []
    rng = np.random.default_rng(1)
    for size in (0.3, 0.34, 0.28, 0.4):
        scale = rng.uniform(0.04, 0.06)
        covariance = np.zeros((6, 6))
        root = rng.normal(size=(2, 2)) * 0.0008
        covariance[np.ix_([0, 5], [0, 5])] = root @ root.T
        values = np.array([scale, 0.1, 0.1, 0.0, 0.0, size * scale])
        fits.append(_Fit(values=values, covariance=covariance, noise=0.0))
        masses.append(size)
        h = 1e-7
        ratio = [
            ((size * scale + dp) / (scale + ds) - (size * scale - dp) / (scale - ds))
            / (2 * h)
            for ds, dp in ((h, 0.0), (0.0, h))
        ]
        variances.append(np.array(ratio) @ root @ root.T @ ratio)
    weights = 1 / np.array(variances)
    found = _weighed(fits, motors())
    assert found.mass == pytest.approx(weights @ masses / weights.sum())
    assert found.deviation == pytest.approx(1 / np.sqrt(weights.sum()), rel=1e-6)


def test_a_payload_that_is_too_uncertain_is_refused() -> None:
    """Three deviations must tell 100 g from none."""
    for gram, refused in ((33.0, False), (34.0, True), (734.0, True)):
        each = 2 * gram / 1e3 * 0.05
        fits = [fit([0.05, 0.1, 0.1, 0, 0, 0.0], [0, 0, 0, 0, 0, each])] * 4
        if not refused:
            assert _weighed(fits, motors()).deviation == pytest.approx(gram / 1e3)
            continue
        with pytest.raises(InputError) as caught:
            _weighed(fits, motors(0.734))
        said = "friction takes 734 mA of the current and varies"
        assert f"± {gram:.0f} g: {said}" in str(caught.value)
        assert "currents that tell it to ± 33 g or less" in str(caught.value)


def test_what_is_printed() -> None:
    first, second = motors()[:2]
    second = second._replace(
        known=False, torque_per_ampere=23.509, viscous=0.8, friction_deviation=0.7
    )
    made = MotorCalibration(
        joints=(first._replace(relative_deviation=0.0234), second),
        payload=Payload(mass=2.3004, deviation=1.5072),
        parameters=RECORD,
        gravity_deviation=0.05432,
    )
    assert str(made) == (
        "axis_e: friction 100.0 and 200.0 ± 1.0 mA, viscous 20.0 mA s/rad, "
        "K_t gear 20.00 N m/A ± 2 %\n"
        "axis_d: friction 90.0 and 200.0 ± 700.0 mA, viscous 800.0 mA s/rad, "
        "K_t gear 23.51 N m/A by Table 4\n"
        "payload 2300 ± 1507 g\n"
        "masses of links: not told, gravity is known to 5.4 %"
    )
    assert "payload" not in str(made._replace(payload=None))


def test_a_record_with_motors() -> None:
    first, second, third, fourth = motors()
    joints = (
        first._replace(friction_forward=-0.01, friction_backward=-0.02),
        second._replace(friction_deviation=0.02),
        third._replace(known=False),
        fourth._replace(relative_deviation=0.7),
    )
    kept = Measurement(key="links.link_2.mass", source="scales", half_width=0.001)
    replaced = Measurement(key="motors.friction.axis_c", source="old", half_width=0.1)
    voltage = replace(
        RECORD,
        motors=Motors(constants="voltage", rotor_inertias=(1e-6,) * 5),
        measurements=(kept, replaced),
    )
    record = with_motors(voltage, joints, "sway.csv")
    assert record.motors.constants == "printed"
    assert with_motors(RECORD, joints, "").motors.constants == "printed"
    for k, joint in enumerate(joints):
        actuator = record.actuators[k]
        gear = actuator.gear_ratio
        constant = joint.torque_per_ampere / gear
        forward = max(joint.friction_forward, 0.0)
        assert actuator.torque_constant == pytest.approx(constant)
        assert actuator.friction == pytest.approx(constant * forward)
        assert actuator.efficiency == 1.0
        backward = record.motors.backward_frictions[k]
        assert backward == pytest.approx(constant * max(joint.friction_backward, 0.0))
        viscous = record.motors.viscous_frictions[k]
        assert viscous == pytest.approx(constant * joint.viscous / gear)
        rotor = record.motors.rotor_inertias[k]
        assert rotor == pytest.approx(constant * joint.armature / gear)
    assert record.actuators[4] == RECORD.actuators[4]
    assert record.motors.rotor_inertias[4] == 1e-6
    tolerance = [one.friction_tolerance for one in record.actuators[:2]]
    assert tolerance == [1.0, pytest.approx(1.96 * 0.02 / 0.09)]
    found = {one.key: one for one in record.measurements}
    assert sorted(found) == [
        "links.link_2.mass",
        "motors.torque_constant.axis_b",
        "motors.torque_constant.axis_d",
        "motors.torque_constant.axis_e",
    ]
    of_d = found["motors.torque_constant.axis_d"]
    constant = record.actuators[1].torque_constant
    assert of_d.source == "currents of sway.csv"
    assert of_d.half_width == pytest.approx(1.96 * 0.02 * constant)
    of_b = found["motors.torque_constant.axis_b"]
    assert of_b.half_width == pytest.approx(record.actuators[3].torque_constant)
