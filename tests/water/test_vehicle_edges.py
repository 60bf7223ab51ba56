"""A vehicle's record at the edges of what it may be, and trims without a moment."""

from __future__ import annotations

import inspect
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import alpha5_model as a5
from alpha5_model.errors import InputError
from alpha5_model.water.carrier import read_carrier

Q = np.array([3.0, 0.9, 2.1, 0.4])
BODY: dict[str, Any] = {
    "mass": 13.5,
    "com": np.array([0.01, 0.02, -0.03]),
    "inertia": np.diag([0.26, 0.23, 0.37]),
    "volume": 0.0134,
    "cob": np.array([0.0, -0.01, 0.02]),
}
TABLE = {"mass": 11.5, "com": [0, 0, -0.02], "volume": 0.0115, "cob": [0, 0, 0.03]}


def test_the_arguments_of_a_vehicle_are_shown() -> None:
    """Also with its deprecated argument."""
    names = list(inspect.signature(a5.Vehicle).parameters)
    damping = ["linear_damping", "quadratic_damping"]
    expected = ["mass", "com", "inertia", "volume", "cob", "added_mass", *damping]
    assert names == [*expected, "mount"]


def test_a_vehicle_without_water_has_none() -> None:
    vehicle = a5.Vehicle(**BODY)
    assert np.array_equal(vehicle.added_mass, np.zeros((6, 6)))
    assert np.array_equal(vehicle.linear_damping, np.zeros(6))
    assert np.array_equal(vehicle.quadratic_damping, np.zeros(6))
    assert np.array_equal(vehicle.mount, np.eye(4))


@pytest.mark.parametrize(
    ("changes", "name"),
    [
        ({"mass": -0.5}, "mass"),
        ({"volume": -0.5}, "volume"),
        ({"linear_damping": [0, 0, 0, 0, 0, -1e-9]}, "linear_damping"),
        ({"quadratic_damping": [0, -1e-9, 0, 0, 0, 0]}, "quadratic_damping"),
        ({"added_mass": np.zeros(5)}, "added_mass"),
    ],
)
def test_what_no_vehicle_has(changes: dict[str, Any], name: str) -> None:
    with pytest.raises(InputError, match=f"^{name}: expected"):
        a5.Vehicle(**{**BODY, **changes})


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"mass": -0.5}, "rov.mass: expected"),
        ({"volume": -0.5}, "rov.volume: expected"),
        ({"com": [0, 0]}, "rov.com: expected"),
        ({"cob": [0, 0, np.nan]}, "rov.cob"),
        ({"xyz": [0, 0]}, "rov.xyz: expected"),
        ({"rpy": [0, 0, 0, 0]}, "rov.rpy: expected"),
    ],
)
def test_a_table_of_a_vehicle(changes: dict[str, Any], message: str) -> None:
    found = read_carrier("rov", TABLE)
    assert np.array_equal(found.mount, np.eye(4))
    assert (found.mass, found.volume) == (11.5, 0.0115)
    assert read_carrier("rov", {**TABLE, "mass": 0.5}).mass == 0.5
    with pytest.raises(InputError, match=message):
        read_carrier("rov", {**TABLE, **changes})


# --- trim -----------------------------------------------------------------------------


@pytest.mark.filterwarnings("ignore:gravity")
def test_a_trim_where_z_points_down() -> None:
    """In a world whose gravity is along +z, the vehicle rests upside down."""
    for gravity in (-9.81, 9.81):
        system = a5.load(gravity=(0.0, 0.0, gravity)).on_vehicle(a5.Vehicle(**BODY))
        trim = system.trim(Q)
        world = np.eye(4)
        world[:3, :3] = trim.rotation_vehicle_to_world
        load = pin.Force(system.hydrostatic_torque(system.configuration(world, Q))[:6])
        np.testing.assert_allclose(load.angular, np.zeros(3), atol=1e-10)
        held = trim.rotation_vehicle_to_world @ load.linear
        weight = -np.sign(gravity) * trim.net_weight
        np.testing.assert_allclose(held, [0.0, 0.0, weight], atol=1e-10)
        assert trim.righting_moment > 0


@pytest.mark.parametrize("gravity", [(1.0, 0, -9.0), (0, 1.0, -9.0), (0, 0, 0)])
def test_a_trim_needs_gravity_along_z(gravity: tuple[float, ...]) -> None:
    system = a5.load(gravity=gravity).on_vehicle(a5.Vehicle(**BODY))
    with pytest.raises(InputError, match="gravity along the world's z"):
        system.trim(Q)


def test_a_vehicle_without_a_righting_moment() -> None:
    """Its centre of mass is moved until the moment is gone."""
    system = a5.load().on_vehicle(a5.Vehicle(**BODY))
    trim = system.trim(Q)
    lever = trim.righting_moment * trim.rotation_vehicle_to_world[2] / 9.81
    for rest, refused in ((0.0, True), (1e-5, False)):
        com = BODY["com"] + (1.0 - rest) * lever / BODY["mass"]
        system = a5.load().on_vehicle(a5.Vehicle(**{**BODY, "com": com}))
        if refused:
            with pytest.raises(InputError, match="expected a righting moment"):
                system.trim(Q)
            continue
        moment = system.trim(Q).righting_moment
        assert moment == pytest.approx(rest * trim.righting_moment, rel=1e-3)
