"""What sensors read of an arm, against statics by Pinocchio."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from identification.calibration_trials import CORNERS, HEIGHT, on_scales
from support.weighing import (
    DOWN,
    VEHICLE,
    loads,
    random_q,
    rotation,
    trim,
)

import alpha5_model as a5
from alpha5_model.errors import InputError, ShapeError

calibrate = a5.calibrate
ARM = a5.parameters()
WATER = a5.FRESH_WATER


def given(
    density: float, q: Any, gravity: Any = DOWN, v: Any = None, a: Any = None
) -> calibrate.Loads:
    """Loads by Pinocchio, as sensors take them."""
    still = [loads(ARM, density, unit, q) for unit in np.eye(3)]
    moving = np.zeros((len(q), 10))
    if v is not None:
        moving = loads(ARM, density, np.zeros(3), q, v, a)
    return calibrate.Loads(
        still=np.stack(still, axis=-1),
        moving=moving,
        turn=np.eye(3),
        gravity=np.asarray(gravity, float),
        velocity=np.zeros_like(q) if v is None else v,
        density=density,
    )


def own(sensor: calibrate.Sensor, moves: bool = False, **values: Any) -> dict[str, Any]:
    """Unknowns of a sensor, 0 but those that are given."""
    zeros = {one.name: np.zeros(len(one.labels)) for one in sensor.own(moves)}
    assert values.keys() <= zeros.keys()
    return {**zeros, **{name: np.asarray(one) for name, one in values.items()}}


@pytest.mark.parametrize("density", [a5.AIR, a5.SEA_WATER])
def test_scales_carry_shares_by_the_lever_rule(density: float) -> None:
    q = random_q(6)
    gravity = [0.2, -0.1, -9.8]
    load = loads(ARM, density, gravity, q)
    at = given(density, q, gravity)
    sensor = calibrate.scales()
    plain = sensor.read(at, own(sensor))
    assert np.allclose(plain, on_scales(load), rtol=0, atol=1e-12)
    read = sensor.read(at, own(sensor, gain=[0.1, 0.0, -0.1], offset=[1.0, 2.0, 3.0]))
    expected = on_scales(load) * [1.1, 1.0, 0.9] + [1.0, 2.0, 3.0]
    assert np.allclose(read, expected, rtol=0, atol=1e-12)
    # Scales that stand elsewhere on the table, as one pair of numbers for each.
    along = CORNERS[1] - CORNERS[0]
    along = along / np.linalg.norm(along)
    axes = np.array([along, [-along[1], along[0]]])
    places = np.array([[0.004, -0.002], [0.0, 0.003], [-0.005, 0.0]])
    moved = sensor.read(at, own(sensor, placement=places.ravel()))
    expected = on_scales(load, CORNERS + places @ axes)
    assert np.allclose(moved, expected, rtol=0, atol=1e-12)


def test_scales_beside_an_arm_that_hangs_on_a_wall() -> None:
    """The plane of the scales may be any, as long as gravity presses on it."""
    gravity = np.array([0.0, -9.81, 0.0])
    corners = np.array([[0.2, -0.05, 0.0], [-0.2, -0.05, 0.2], [-0.2, -0.05, -0.2]])
    sensor = calibrate.scales(corners)
    q = random_q(1)
    read = sensor.read(given(a5.AIR, q, gravity), own(sensor))[0]
    centre = read @ corners / read.sum()
    assert np.isclose(read.sum(), sum(link.mass for link in ARM.links))
    of_mass = a5.load(a5.AIR).center_of_mass(q[0])
    assert np.allclose(centre[[0, 2]], of_mass[[0, 2]], atol=1e-12)


def test_one_scale_shows_the_net_mass_along_gravity() -> None:
    sensor = calibrate.weight()
    net = sum(link.mass - WATER * link.volume for link in ARM.links)
    for gravity in (DOWN, [9.81, 0.0, 0.0], [3.0, 4.0, -8.0]):
        read = sensor.read(given(WATER, random_q(2), gravity), own(sensor))
        strength = np.linalg.norm(gravity) / 9.81
        assert np.allclose(read, net * strength, rtol=1e-12)


def test_a_load_cell_and_efforts_of_an_arm_that_moves() -> None:
    q = random_q(5)
    v, a = np.random.default_rng(1).normal(size=(2, 5, 4))
    v[0, 0] = 0.0
    load = loads(ARM, WATER, DOWN, q, v, a)
    cell = calibrate.force_torque()
    read = cell.read(given(WATER, q, DOWN, v, a), own(cell, moves=True))
    assert np.allclose(read, load[:, 4:], rtol=0, atol=1e-12)
    efforts = calibrate.efforts()
    rubbing = own(efforts, True, Coulomb=[0.1, 0.2, 0.3, 0.4], viscous=np.ones(4))
    read = efforts.read(given(WATER, q, DOWN, v, a), rubbing)
    friction = [0.1, 0.2, 0.3, 0.4] * np.sign(v) + v
    assert np.allclose(read, load[:, :4] + friction, rtol=0, atol=1e-12)
    assert "Coulomb" not in own(efforts)


def test_a_vehicle_tilts_until_all_moments_balance() -> None:
    sensor = calibrate.vehicle_tilt(VEHICLE)
    q = random_q(4, seed=2)
    gravity = rotation(VEHICLE["rpy"]).T @ DOWN
    at = given(WATER, q, gravity)
    for yaw in (0.0, 0.3):
        read = sensor.read(at, own(sensor, yaw=[yaw]))
        expected = [trim(ARM, WATER, one, VEHICLE, yaw) for one in q]
        assert np.allclose(read, expected, rtol=0, atol=1e-9)
    assert np.ptp(read, axis=0).max() > 0.05  # the arm tilts it by degrees
    vehicle = a5.Vehicle(
        mass=VEHICLE["mass"],
        com=VEHICLE["com"],
        inertia=0.2 * np.eye(3),
        volume=VEHICLE["volume"],
        cob=VEHICLE["cob"],
        mount=np.block(
            [
                [rotation(VEHICLE["rpy"]), np.reshape(VEHICLE["xyz"], (3, 1))],
                [np.zeros((1, 3)), np.ones((1, 1))],
            ]
        ),
    )
    again = calibrate.vehicle_tilt(vehicle)
    assert np.allclose(again.read(at, own(sensor, yaw=[0.3])), read, rtol=0, atol=1e-12)


def test_what_a_sensor_may_be() -> None:
    """A wrong argument is named; 0 is a gain's deviation, but no noise's."""
    good = {
        calibrate.scales: {"noise": 0, "gain": 1, "placement": 1},
        calibrate.weight: {"noise": 0, "gain": 1},
        calibrate.force_torque: {"force_noise": 0, "torque_noise": 0, "gain": 1},
        calibrate.efforts: {"noise": 0, "gain": 1, "offset": 1},
        lambda **g: calibrate.vehicle_tilt(VEHICLE, **g): {
            **{"noise": 0, "gain": 1, "offset": 1, "yaw": 1},
        },
    }
    failures = []
    for make, arguments in good.items():
        for name, may_be_zero in arguments.items():
            for value in (-0.5, np.nan, [1.0] * 7, *([] if may_be_zero else [0.0])):
                try:
                    make(**{name: value})  # type: ignore[operator]
                except InputError as error:
                    if error.name != name:
                        failures.append((make, name, value, error))
                else:
                    failures.append((make, name, value))
            make(**{name: 0.0 if may_be_zero else 1e-12})  # type: ignore[operator]
    assert failures == []
    for corners in ([[0, 0, 0], [0.1, 0, 0], [0.2, 0.001, 0]], np.zeros((3, 3))):
        with pytest.raises(InputError, match="positions"):
            calibrate.scales(corners)
    with pytest.raises(ShapeError, match="gain"):
        calibrate.scales(gain=[0.1, 0.2])


def test_sessions_that_cannot_be_are_refused() -> None:
    q = np.ones((2, 4))
    tilt = calibrate.vehicle_tilt(VEHICLE)
    top_heavy = calibrate.vehicle_tilt({**VEHICLE, "com": [0.0, 0.0, 0.05]})
    wrong: list[tuple[str, Any, dict[str, Any]]] = [
        ("gravity", calibrate.scales(), {"gravity": (0.0, 9.81, 0.0)}),
        ("gravity", calibrate.weight(), {"gravity": (0.0, 0.0, 0.0)}),
        ("gravity", tilt, {"gravity": DOWN, "fluid_density": WATER}),
        ("v, a", tilt, {"v": q, "fluid_density": WATER}),
        ("vehicle", tilt, {"fluid_density": a5.AIR}),
        ("vehicle", top_heavy, {"fluid_density": WATER}),
        ("readings", tilt, {"readings": 12.0 + q[:, :2], "fluid_density": WATER}),
        ("readings", calibrate.weight(), {"readings": np.ones((3, 1))}),
        ("readings", calibrate.weight(), {"readings": [[np.inf], [1.0]]}),
        ("readings", calibrate.weight(), {"readings": [["1"], [1.0]]}),
        ("v", calibrate.efforts(), {"v": np.ones((2, 3))}),
        ("a", calibrate.efforts(), {"a": np.ones((1, 4))}),
        ("fluid_density", calibrate.efforts(), {"fluid_density": -1.0}),
    ]
    failures = []
    for name, sensor, options in wrong:
        try:
            calibrate.session(sensor, q, **options)
        except InputError as error:
            if error.name != name:
                failures.append((name, error))
        else:
            failures.append((name, "not refused"))
    assert failures == []
    for positions in (np.ones(4), np.empty((0, 4)), np.ones((5001, 4))):
        with pytest.raises(ShapeError, match="q"):
            calibrate.session(calibrate.weight(), positions)
    steep = np.array([[1.56, np.nan], [0.0, -1.56]])
    read = calibrate.session(tilt, q, steep, fluid_density=WATER)
    np.testing.assert_array_equal(read.readings, steep)
    assert calibrate.scales().positions[0, 2] == HEIGHT
