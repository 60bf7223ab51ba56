"""What an arm of your own changes, against formulas and brute force."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest
from fk import fk, sample

import alpha5_model as a5
from alpha5_model._support.spatial import rotation_from_rpy
from alpha5_model.dynamics.arm_changes import _candidates, arm_changes, largest
from alpha5_model.dynamics.load import arm_of
from alpha5_model.numbers.motors import Motors
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.pose import Pose
from alpha5_model.numbers.rigid_body import AttachedBody

ARM = a5.parameters()
RHO = 1025.0
G = 9.81


def sensor(**changes: Any) -> AttachedBody:
    values: dict[str, Any] = {
        "name": "sensor",
        "mass": 0.5,
        "com": np.array([0.001, 0.002, -0.003]),
        "inertia": np.diag([2e-5, 3e-5, 4e-5]),
        "volume": 1e-4,
        "cob": np.array([0.0, 0.001, 0.002]),
        "link": "link_4",
        "position": np.array([0.01, -0.02, -0.075]),
        "rotation": rotation_from_rpy((0.3, -0.4, 1.1)),
    }
    return AttachedBody(**{**values, **changes})


def by_key(own: Alpha5Parameters) -> dict[str, Any]:
    return {change.key: change for change in arm_changes(own, ARM)}


def test_the_catalogue_changes_nothing() -> None:
    assert arm_changes(ARM, ARM) == ()


@pytest.mark.slow
def test_a_weighed_link_costs_its_weight_times_its_lever() -> None:
    links = list(ARM.links)
    links[2] = dataclasses.replace(links[2], mass=0.341)
    found = by_key(dataclasses.replace(ARM, links=tuple(links)))
    assert found.keys() == {"links.link_2", "all"}
    change = found["links.link_2"]
    (difference,) = change.differences
    assert (difference.name, difference.printed, difference.own) == (
        "mass",
        ARM.links[2].mass,
        0.341,
    )
    x, y, _ = ARM.links[2].com
    # Within the limits of axis_d the link is level somewhere.
    expected = (ARM.links[2].mass - 0.341) * G * np.hypot(x, y)
    assert change.torque == pytest.approx(expected, rel=1e-4)
    assert change.tcp == 0.0
    assert found["all"].torque == change.torque


@pytest.mark.slow
def test_a_tool_is_compared_with_the_point_of_table_1() -> None:
    """Frame {5} in link_4: Tz(-180 mm) Rx(90 deg) Rz(-90 deg)."""
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_euler("XZ", [90.0, -90.0], degrees=True).as_matrix()
    longer = Pose(position=np.array([0.0, 0.0, -0.2]), rotation=turn.round(12))
    found = by_key(dataclasses.replace(ARM, tool=longer))
    (difference,) = found["tool"].differences
    assert difference.name == "position"
    assert difference.printed == pytest.approx([0.0, 0.0, -0.18], abs=1e-15)
    assert difference.own == pytest.approx([0.0, 0.0, -0.2])
    assert found["tool"].tcp == pytest.approx(0.02, rel=1e-9)


def test_a_length_moves_the_tcp_by_itself() -> None:
    rows = list(ARM.dh)
    rows[1] = dataclasses.replace(rows[1], a=rows[1].a + 2e-4)
    found = by_key(dataclasses.replace(ARM, dh=tuple(rows)))
    assert found.keys() == {"lengths.a_1", "all"}
    assert found["lengths.a_1"].tcp == pytest.approx(2e-4, rel=1e-9)
    assert found["lengths.a_1"].torque > 0.0


def test_a_zero_moves_the_tcp_by_the_chord_of_its_lever() -> None:
    rows = list(ARM.dh)
    angle = np.radians(0.4)
    rows[0] = dataclasses.replace(rows[0], theta_offset=rows[0].theta_offset + angle)
    found = by_key(dataclasses.replace(ARM, dh=tuple(rows)))
    assert found.keys() == {"zeros.axis_e", "all"}
    tips = fk(sample(200_000, seed=1))[:, :2, 3]
    lever = np.linalg.norm(tips, axis=1).max()
    chord = 2 * np.sin(angle / 2) * lever
    assert found["zeros.axis_e"].tcp == pytest.approx(chord, rel=2e-3)
    assert found["zeros.axis_e"].tcp >= chord - 1e-12
    # The yaw axis is vertical.
    assert found["zeros.axis_e"].torque == 0.0


def test_a_sensor_costs_its_weight_in_water_times_its_lever() -> None:
    own = dataclasses.replace(ARM, attached=(sensor(),))
    change = by_key(own)["attached.sensor"]
    assert change.tcp == 0.0
    # As a payload of the catalogue's arm, by brute force.
    held = loaded_catalogue()
    bare = a5.load()
    q = sample(20_000, seed=2)
    rest = np.zeros_like(q)
    with_it = held.inverse_dynamics_batch(q, rest, rest)
    without = bare.inverse_dynamics_batch(q, rest, rest)
    brute = np.abs(with_it - without).max()
    assert brute <= change.torque + 1e-12
    assert change.torque == pytest.approx(brute, rel=0.02)


def test_a_spacer_moves_the_tcp_by_itself() -> None:
    found = by_key(dataclasses.replace(ARM, attached=(sensor(spacer=0.022),)))
    assert found.keys() == {"attached.sensor", "all"}
    assert found["attached.sensor"].tcp == pytest.approx(0.022, rel=1e-9)


def test_an_upside_down_mount_turns_all_torques_round() -> None:
    turned = np.diag([1.0, -1.0, -1.0])
    mount = Pose(parent="rov", position=np.array([0.2, 0, 0]), rotation=turned)
    found = by_key(dataclasses.replace(ARM, mount=mount))
    q = sample(20_000, seed=3)
    rest = np.zeros_like(q)
    twice = 2 * np.abs(a5.load().inverse_dynamics_batch(q, rest, rest)).max()
    assert found["mount"].torque == pytest.approx(twice, rel=0.02)
    assert found["mount"].torque >= twice - 1e-12
    assert found["mount"].tcp == 0.0


def test_what_costs_nothing_is_named_all_the_same() -> None:
    joints = list(ARM.joints)
    joints[0] = dataclasses.replace(joints[0], lower=0.3, effort=1.5)
    own = dataclasses.replace(
        ARM, name="lab", joints=tuple(joints), motors=Motors(supply_voltage=24.0)
    )
    found = by_key(own)
    assert found.keys() == {"name", "joint_limits.axis_e", "motors", "all"}
    assert {(change.torque, change.tcp) for change in found.values()} == {(0.0, 0.0)}
    names = [d.name for d in found["joint_limits.axis_e"].differences]
    assert names == ["lower", "effort"]


def test_a_tool_and_corrections_are_changes() -> None:
    tool = Pose(position=np.array([0.03, 0.04, -0.18]), rotation=np.eye(3))
    found = by_key(dataclasses.replace(ARM, tool=tool))
    assert found["tool"].tcp == pytest.approx(0.05, rel=1e-9)
    assert {d.name for d in found["tool"].differences} == {"position", "rotation"}
    literal = by_key(a5.parameters(()))
    assert {d.name for d in literal["corrections"].differences} == {
        "corrections",
        "base_yaw",
    }


#: Fields that `arm check` does not look at, and why.
NOT_COMPARED = {
    "theta_c": "no key of an arm file sets it; a zero changes the rows of Table 1",
    "jaws": "no key of an arm file sets it",
    "measurements": "how well numbers are known",
    "covariance": "how well numbers are known",
}


def test_each_field_of_the_record_is_compared() -> None:
    own = dataclasses.replace(a5.parameters(()), attached=(sensor(),))
    # No public name has the fields of a part that is the same in both.
    compared = {name for _, change in _candidates(own, ARM) for name in change}
    names = {field.name for field in dataclasses.fields(ARM)}
    assert names == compared | set(NOT_COMPARED)
    assert not compared & set(NOT_COMPARED)


def loaded_catalogue() -> a5.Arm:
    """The catalogue's arm that holds the sensor as a payload on link_4."""
    body = sensor()
    r = body.rotation
    return a5.load().with_payload(
        body.mass,
        r @ body.com + body.position,
        r @ body.inertia @ r.T,
        volume=body.volume,
        cob=r @ body.cob + body.position,
        frame="link_4",
    )


def test_an_attached_body_is_a_payload_of_its_link() -> None:
    own = arm_of(dataclasses.replace(ARM, attached=(sensor(),)))
    held = loaded_catalogue()
    rng = np.random.default_rng(4)
    q = sample(20, seed=5)
    v = rng.normal(size=q.shape)
    a = rng.normal(size=q.shape)
    for state in zip(q, v, a, strict=True):
        one = own.inverse_dynamics(*state)
        assert one == pytest.approx(held.inverse_dynamics(*state), abs=1e-14)
    batch = own.inverse_dynamics_batch(q, v, a)
    assert batch == pytest.approx(held.inverse_dynamics_batch(q, v, a), abs=1e-14)


def test_the_largest_value_is_found_inside_and_at_the_edge() -> None:
    lower = np.zeros(4)
    upper = np.array([6.0, 3.0, 3.0, 6.0])
    top = np.array([2.2, 1.3, 0.4, 5.1])

    def bowl(q: np.ndarray) -> np.ndarray:
        return np.asarray(3.0 - ((q - top) ** 2).sum(axis=-1))

    assert largest(bowl, lower, upper) == pytest.approx(3.0, abs=1e-4)
    edge = largest(lambda q: q[:, 0] + q[:, 2], lower, upper)
    assert edge == 9.0
