"""Motors and gearboxes agree with Table 4's formulas and with a simulation."""

from __future__ import annotations

import contextlib

import numpy as np
import pytest
from loops import each

import alpha5_model as a5
from alpha5_model import actuators
from alpha5_model.errors import (
    InputError,
    MissingParameterError,
    ShapeError,
    UnknownNameError,
)

# Table 4, typed from the document, in SI: R, L, F, tolerance, eta, K_t, K_v, Gr.
BIG = (3.22, 231e-6, 3.752e-3, 0.10, 0.86, 0.0134, 0.0116, 1754.4)
SMALL = (38.6, 1280e-6, 0.469e-3, 0.15, 0.77, 0.0271, 0.0545, 340.4)
TABLE_4 = {"axis_e": BIG, "axis_d": BIG, "axis_c": BIG, "axis_b": SMALL}
REVOLUTE = tuple(TABLE_4)


def states(count: int = 400, seed: int = 4) -> tuple[np.ndarray, np.ndarray]:
    """Joint torques and velocities in all four quadrants, some exactly at rest."""
    rng = np.random.default_rng(seed)
    velocity = rng.uniform(-0.6, 0.6, count)
    velocity[::10] = 0.0
    return rng.uniform(-3, 3, count), velocity


def current_by_cases(
    row: tuple[float, ...], torque: float, velocity: float, efficiency: str = "gearbox"
) -> float:
    _, _, friction, _, eta, k_t, _, gear = row
    if efficiency == "motor":  # then nothing is lost in the gearbox
        eta = 1.0
    if velocity == 0:
        return torque / gear / k_t
    driving = (torque > 0) == (velocity > 0)
    shaft = torque / (gear * eta) if driving else torque * eta / gear
    return (shaft + (friction if velocity > 0 else -friction)) / k_t


@each("efficiency", actuators.EFFICIENCIES)
@each("joint", REVOLUTE)
def test_current_in_four_quadrants(joint: str, efficiency: str) -> None:
    torque, velocity = states()
    motor = a5.actuators.actuator(joint, efficiency=efficiency)
    expected = [
        current_by_cases(TABLE_4[joint], t, v, efficiency)
        for t, v in zip(torque, velocity, strict=True)
    ]
    np.testing.assert_allclose(motor.current(torque, velocity), expected, rtol=1e-13)
    np.testing.assert_allclose(
        motor.torque(expected, velocity), torque, rtol=1e-9, atol=1e-12
    )


@pytest.mark.parametrize("joint", REVOLUTE)
def test_without_the_gearboxs_loss_its_heat_is_zero(joint: str) -> None:
    eta = TABLE_4[joint][4]
    torque, velocity = states()
    plain = actuators.actuator(joint)
    lossless = actuators.actuator(joint, efficiency="motor")
    assert (plain.efficiency, plain.gear_efficiency) == ("gearbox", eta)
    assert (lossless.efficiency, lossless.gear_efficiency) == ("motor", 1.0)
    np.testing.assert_allclose(lossless.power(torque, velocity).gear, 0.0, atol=1e-15)
    assert (plain.power(torque, velocity).gear[velocity != 0] > 0).all()


@pytest.mark.parametrize("joint", REVOLUTE)
def test_without_the_gearboxs_loss_weight_and_friction_are_held(joint: str) -> None:
    _, _, friction, _, _, k_t, _, gear = TABLE_4[joint]
    lossless = actuators.actuator(joint, efficiency="motor")
    weight = 2 / gear
    currents = ((weight - friction) / k_t, (weight + friction) / k_t)
    assert tuple(lossless.holding_current(2.0)) == pytest.approx(currents)
    motor_torque = k_t * 0.05
    torques = ((motor_torque - friction) * gear, (motor_torque + friction) * gear)
    assert tuple(lossless.holding_torque(0.05)) == pytest.approx(torques)


@pytest.mark.parametrize("joint", REVOLUTE)
def test_stall_torques_at_full_voltage_differ_by_the_efficiency(joint: str) -> None:
    """At rest both motors hold the same; as soon as they turn, eta is between them."""
    resistance, _, friction, _, eta, k_t, _, gear = TABLE_4[joint]
    plain = actuators.actuator(joint)
    lossless = actuators.actuator(joint, efficiency="motor")
    ends = [motor.torque_limits(0.0, 24.0, 100.0).upper for motor in (plain, lossless)]
    assert ends == pytest.approx([k_t * 24 / resistance * gear] * 2)
    ends = [
        motor.torque_limits(1e-12, 24.0, 100.0).upper for motor in (plain, lossless)
    ]
    stalled = (k_t * 24 / resistance - friction) * gear
    assert ends == pytest.approx([stalled * eta, stalled])


@pytest.mark.parametrize("joint", REVOLUTE)
def test_an_unknown_owner_of_the_efficiency_is_refused(joint: str) -> None:
    plain = actuators.actuator(joint)
    with pytest.raises(
        UnknownNameError, match="efficiency 'best'; choose from gearbox, motor"
    ):
        actuators.actuator(joint, efficiency="best")
    with pytest.raises(UnknownNameError, match="gearbox, motor"):
        actuators.Actuator(joint, plain.parameters, efficiency="best")


@each("constants", actuators.CONSTANTS)
@each("joint", REVOLUTE)
def test_torque_and_voltage_are_inverted(joint: str, constants: str) -> None:
    motor = actuators.actuator(joint, constants, rotor_inertia=4e-7)
    torque, velocity = states()
    acceleration = np.random.default_rng(1).uniform(-5, 5, torque.shape)
    for a in (None, acceleration):
        current = motor.current(torque, velocity, a)
        np.testing.assert_allclose(
            motor.torque(current, velocity, a), torque, rtol=1e-10, atol=1e-12
        )
    np.testing.assert_allclose(
        motor.speed(motor.voltage(current, velocity), current),
        velocity,
        rtol=1e-9,
        atol=1e-12,
    )


@each("constants", actuators.CONSTANTS)
@each("joint", REVOLUTE)
def test_power_is_accounted_for(joint: str, constants: str) -> None:
    motor = actuators.actuator(joint, constants, rotor_inertia=4e-7)
    torque, velocity = states()
    p = motor.power(torque, velocity, acceleration=np.cos(torque))
    parts = p.mechanical + p.copper + p.friction + p.gear + p.rotor + p.contradiction
    np.testing.assert_allclose(p.electrical, parts, rtol=1e-12, atol=1e-12)
    for heat in (p.copper, p.friction, p.gear):
        assert (heat >= -1e-15).all()
    moving = velocity != 0
    if constants == "printed":
        assert np.abs(p.contradiction[moving]).min() > 0
    else:
        np.testing.assert_array_equal(p.contradiction, 0.0)


def test_constants_contradict_each_other_and_the_choice_is_obeyed() -> None:
    for joint, (_, _, _, _, _, k_t, k_v, _) in TABLE_4.items():
        assert actuators.actuator(joint).constants_ratio == pytest.approx(
            k_t / k_v, rel=1e-14
        )
        chosen = {
            c: (m.torque_constant, m.back_emf_constant)
            for c in actuators.CONSTANTS
            for m in (actuators.actuator(joint, c),)
        }
        assert chosen == {
            "printed": (pytest.approx(k_t), pytest.approx(k_v)),
            "torque": (pytest.approx(k_t), pytest.approx(k_t)),
            "voltage": (pytest.approx(k_v), pytest.approx(k_v)),
        }


@pytest.mark.parametrize("joint", ["axis_d", "axis_b"])
@pytest.mark.parametrize("load", [0.4, -0.4])
def test_steady_state_of_a_simulated_motor(joint: str, load: float) -> None:
    """A motor integrated in time settles at the speed and current of the algebra."""
    from scipy.integrate import solve_ivp

    resistance, inductance, friction, _, eta, k_t, k_v, gear = TABLE_4[joint]
    voltage = 12.0
    rotor_inertia = 4e-7

    def rates(_: float, state: np.ndarray) -> list[float]:
        current, speed = state
        gear_input = load / (gear * eta) if load > 0 else load * eta / gear
        # The motor turns forward throughout, so friction keeps its sign.
        shaft_torque = k_t * current - friction - gear_input
        winding_voltage = voltage - resistance * current - k_v * speed
        return [winding_voltage / inductance, shaft_torque / rotor_inertia]

    no_load_speed = voltage / k_v
    run = solve_ivp(
        rates, (0, 1.0), [0.0, no_load_speed], method="LSODA", rtol=1e-10, atol=1e-10
    )
    current, speed = run.y[:, -1]
    motor = actuators.actuator(joint)
    assert (run.y[1] > 0).all()
    assert motor.current(load, speed / gear) == pytest.approx(current, rel=1e-6)
    assert motor.speed(voltage, current) == pytest.approx(speed / gear, rel=1e-6)


@pytest.mark.parametrize("joint", REVOLUTE)
def test_holding_interval_is_where_a_pushed_joint_stays(joint: str) -> None:
    """Beyond the interval, the motor overcomes friction and gear in one direction."""
    _, _, friction, _, eta, k_t, _, gear = TABLE_4[joint]
    motor = actuators.actuator(joint)
    torque, _ = states()
    currents = np.linspace(-1.5, 1.5, 601) * (friction + 3 / (gear * eta)) / k_t
    low, high = motor.holding_current(torque)
    for tau, lowest, highest in zip(torque, low, high, strict=True):
        driving = tau / (gear * eta)
        driven = tau * eta / gear
        rises = k_t * currents - friction > (driving if tau > 0 else driven)
        falls = k_t * currents + friction < (driven if tau > 0 else driving)
        inside = (currents >= lowest) & (currents <= highest)
        np.testing.assert_array_equal(inside, ~(rises | falls))


@pytest.mark.parametrize("joint", REVOLUTE)
def test_holding_currents_and_holding_torques_agree(joint: str) -> None:
    _, _, friction, _, eta, k_t, _, gear = TABLE_4[joint]
    motor = actuators.actuator(joint)
    torque, _ = states()
    currents = np.linspace(-1.5, 1.5, 11) * (friction + 3 / (gear * eta)) / k_t
    low, high = motor.holding_current(torque)
    for current in currents:
        t_low, t_high = motor.holding_torque(current)
        held_by_current = (low <= current) & (current <= high)
        held_by_torque = (t_low <= torque) & (torque <= t_high)
        np.testing.assert_array_equal(held_by_current, held_by_torque)


def test_friction_alone_holds_the_arm() -> None:
    """F Gr of the big motors is 6.6 N m, far above the arm's largest gravity torque."""
    motor = actuators.actuator("axis_d")
    assert motor.joint_friction == pytest.approx(3.752e-3 * 1754.4)
    low, high = motor.holding_current(1.4)
    assert low < 0 < high
    assert motor.holding_current(20.0).lower > 0


@each("rotor_inertia", [None, 4e-7])
@each("joint", REVOLUTE)
def test_limits_are_the_edge_of_what_voltage_and_current_allow(
    joint: str, rotor_inertia: float | None
) -> None:
    motor = actuators.actuator(joint, rotor_inertia=rotor_inertia)
    supply, limit = 18.0, 0.3
    torque, velocity = states()
    acceleration = None if rotor_inertia is None else 5 * np.cos(7 * torque)
    low, high = motor.torque_limits(velocity, supply, limit, acceleration)
    current = motor.current(torque, velocity, acceleration)
    allowed = (np.abs(current) <= limit) & (
        np.abs(motor.voltage(current, velocity)) <= supply
    )
    assert 0 < allowed.sum() < allowed.size
    np.testing.assert_array_equal((low <= torque) & (torque <= high), allowed)
    too_fast = motor.torque_limits(100.0, supply, limit)
    assert np.isnan(too_fast.lower)
    assert np.isnan(too_fast.upper)


def test_tolerance_of_friction_becomes_an_interval() -> None:
    torque, velocity = states()
    for joint, row in TABLE_4.items():
        motor = actuators.actuator(joint)
        low, high = motor.current_interval(torque, velocity)
        nominal = motor.current(torque, velocity)
        half_width = np.where(velocity == 0, 0.0, row[3] * row[2] / row[5])
        np.testing.assert_allclose(high - nominal, half_width, atol=1e-14)
        np.testing.assert_allclose(nominal - low, half_width, atol=1e-14)
        rng = np.random.default_rng(2)
        for factor in rng.uniform(1 - row[3], 1 + row[3], 20):
            changed = list(row)
            changed[2] *= factor
            cases = zip(torque, velocity, strict=True)
            i = np.array([current_by_cases(tuple(changed), t, v) for t, v in cases])
            assert ((i >= low - 1e-12) & (i <= high + 1e-12)).all()


def test_winding_sees_the_rate_of_current() -> None:
    motor = actuators.actuator("axis_b")
    assert motor.voltage(0.0, 0.0, current_rate=100.0) == pytest.approx(0.128)


def test_jaw_needs_its_screw_and_acceleration_its_rotor() -> None:
    with pytest.raises(MissingParameterError, match="screw_lead"):
        actuators.actuator("axis_a").current(1.0)
    # One turn of the output moves the rod by the lead: force * lead = torque * 2 pi.
    jaw = actuators.actuator("axis_a", screw_lead=1e-3)
    force = jaw.torque(0.05)
    assert force * 1e-3 == pytest.approx(0.05 * 0.0271 * 348.7 * 2 * np.pi)
    with pytest.raises(MissingParameterError, match="rotor_inertia"):
        actuators.actuator("axis_e").torque_limits(0.0, 24.0, 1.0, acceleration=1.0)
    with pytest.raises(MissingParameterError, match="rotor_inertia"):
        actuators.actuator("axis_e").current(1.0, 0.1, acceleration=1.0)
    motor = actuators.actuator("axis_e", rotor_inertia=1e-6)
    added = motor.current(1.0, 0.1, acceleration=2.0) - motor.current(1.0, 0.1)
    assert added == pytest.approx(1e-6 * 1754.4 * 2.0 / 0.0134)


@each(
    ("call", "error"),
    [
        (lambda: actuators.actuator("axis_f"), UnknownNameError),
        (lambda: actuators.actuator("axis_e", "best"), UnknownNameError),
        (lambda: actuators.actuator("axis_e", rotor_inertia=-1.0), InputError),
        (lambda: actuators.actuator("axis_a", screw_lead=0.0), InputError),
        (lambda: actuators.actuator("axis_e").current([1.0, float("nan")]), InputError),
        (lambda: actuators.actuator("axis_e").current("much"), InputError),
        (lambda: actuators.actuator("axis_e").torque_limits(0.0, 0.0, 1.0), InputError),
        (
            lambda: actuators.actuator("axis_e").torque_limits(0.0, 24.0, -1.0),
            InputError,
        ),
        (
            lambda: actuators.actuator("axis_e").current(np.zeros(2), np.zeros(3)),
            ShapeError,
        ),
        (
            lambda: actuators.actuator("axis_e").voltage(0.0, np.zeros(2), np.zeros(3)),
            ShapeError,
        ),
        (
            lambda: actuators.actuator("axis_e", rotor_inertia=1e-6).power(
                np.zeros(2), np.zeros(2), np.zeros(3)
            ),
            ShapeError,
        ),
    ],
)
def test_what_cannot_be_used_is_refused(call, error) -> None:
    with pytest.raises(error):
        call()


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::alpha5_model.errors.ImplausibleWarning")
@each("joint", ["axis_e", "axis_a"])
@each("screw_lead", [1e-51, 1e-3, 2e51])
@each("rotor_inertia", [0.0, 1e-6, 2e51])
def test_no_number_overflows(
    joint: str, screw_lead: float, rotor_inertia: float
) -> None:
    motor = actuators.actuator(
        joint, rotor_inertia=rotor_inertia, screw_lead=screw_lead
    )
    numbers = [0.0, 1.0, -1e-300, 2e51, -2e51]
    rows = np.array(np.meshgrid(numbers, numbers, numbers)).reshape(3, -1)
    answers = 0
    for state in rows.T:
        for method, count in (
            (motor.current, 3),
            (motor.torque, 3),
            (motor.voltage, 3),
            (motor.speed, 2),
            (motor.holding_current, 1),
            (motor.holding_torque, 1),
            (motor.power, 3),
        ):
            # A quotient of two large numbers may itself be too large.
            with contextlib.suppress(InputError):
                result = method(*state[:count])
                parts = (
                    tuple(vars(result).values())
                    if isinstance(result, actuators.ActuatorPower)
                    else result
                )
                assert np.isfinite(parts).all()
                answers += 1
    assert answers > len(rows.T)
    for method in (motor.current, motor.torque, motor.voltage, motor.power):
        for place in range(3):
            given = [1.0, 1.0, 1.0]
            given[place] = 1e52
            with pytest.raises(InputError, match="overflow"):
                method(*given)
    for number in numbers:
        with contextlib.suppress(InputError):
            assert not np.isinf(motor.torque_limits(number, 24.0, 2.0)).any()
