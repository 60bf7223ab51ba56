"""The numbers of an arm of your own: changes of one value, bounds and draws."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import own_arm_dynamics as own
import pytest

import alpha5_model as a5
from alpha5_model.numbers.motors import Motors
from alpha5_model.numbers.parameters import Alpha5Parameters, Measurement
from alpha5_model.studies.arm_numbers import arm_numbers

u = a5.uncertainty
MOTORS = Motors(
    supply_voltage=24.0,
    current_limits=(1.0, 1.5, 2.0, 2.5, 3.0),
    rotor_inertias=(None, 1e-6, 2e-6, None, None),
    viscous_frictions=(1e-6,) * 5,
)


def measured(seed: int, **half_widths: float) -> Alpha5Parameters:
    """A random arm with a mount, motors and measured values.

    Args:
        seed: Of the arm.
        half_widths: By key, with ``__`` for the dots.
    """
    measurements = [
        Measurement(key.replace("__", "."), half_width=width)
        for key, width in half_widths.items()
    ]
    return dataclasses.replace(
        own.random_record(seed),
        mount=own.random_mount(3),
        motors=MOTORS,
        measurements=tuple(measurements),
    )


def leaves(value: Any, name: str = "") -> dict[str, float]:
    """Every number of a record by its place."""
    if dataclasses.is_dataclass(value):
        parts = {f.name: getattr(value, f.name) for f in dataclasses.fields(value)}
    elif isinstance(value, tuple):
        parts = {str(k): one for k, one in enumerate(value)}
    elif isinstance(value, np.ndarray | float):
        numbers = np.asarray(value, float)
        return {
            f"{name}{list(at)}": float(numbers[at]) for at in np.ndindex(numbers.shape)
        }
    else:
        return {}
    found: dict[str, float] = {}
    for part, one in parts.items():
        found |= leaves(one, f"{name}.{part}")
    return found


def changes(before: Alpha5Parameters, after: Alpha5Parameters) -> dict[str, float]:
    """Place -> change, of all numbers that differ."""
    old = leaves(before)
    new = leaves(after)
    assert set(old) == set(new)
    return {
        name: new[name] - old[name]
        for name in old
        if not (new[name] == old[name] or np.isnan(old[name]))
    }


#: Name of a number -> the places of the record that it changes.
PLACES = {
    "attached.lamp.mass": [".attached.1.mass[]"],
    "attached.sensor.com.y": [".attached.0.com[1]"],
    "attached.sensor.inertia.xx": [".attached.0.inertia[0, 0]"],
    "attached.sensor.inertia.xz": [
        ".attached.0.inertia[0, 2]",
        ".attached.0.inertia[2, 0]",
    ],
    "attached.plate.volume": [".attached.2.volume[]"],
    "attached.lamp.cob.z": [".attached.1.cob[2]"],
    "attached.lamp.at.x": [".attached.1.position[0]"],
    "lengths.a_1": [".dh.1.a[]"],
    "zeros.axis_e": [".dh.0.theta_offset[]"],
    "zeros.axis_c": [".dh.2.theta_offset[]"],
    "joint_limits.axis_d.min_position": [".joints.1.lower[]"],
    "joint_limits.axis_b.max_position": [".joints.3.upper[]"],
    "joint_limits.axis_e.max_velocity": [".joints.0.velocity[]"],
    "joint_limits.axis_c.max_effort": [".joints.2.effort[]"],
    "tool.xyz.y": [".tool.position[1]"],
    "mount.xyz.z": [".mount.position[2]"],
    "motors.supply_voltage": [".motors.supply_voltage[]"],
    "motors.current_limit.axis_c": [".motors.current_limits.2[]"],
    "motors.rotor_inertia.axis_d": [".motors.rotor_inertias.1[]"],
    "motors.viscous_friction.axis_a": [".motors.viscous_frictions.4[]"],
}


def key_of(name: str) -> str:
    """The key of the arm file that a number is of."""
    stem, _, axes = name.rpartition(".")
    return stem if set(axes) <= {*"xyz"} else name


def changed(record: Alpha5Parameters, name: str, by: float) -> Alpha5Parameters:
    """The record with one of its numbers changed."""
    numbers = arm_numbers(record)
    values = numbers.middle.copy()
    values[numbers.names.index(name)] += by
    return numbers.record(values)


@pytest.mark.parametrize("name", PLACES)
def test_a_change_of_a_measured_number_changes_nothing_else(name: str) -> None:
    width = 1e-8 if "inertia" in name or "friction" in name else 1e-5
    record = measured(0, **{key_of(name).replace(".", "__"): width})
    numbers = arm_numbers(record)
    k = numbers.names.index(name)
    assert numbers.half_width[k] == width
    old = leaves(record)[PLACES[name][0]]
    if name.startswith("zeros."):
        row = int(PLACES[name][0].split(".")[2])
        old -= a5.parameters().dh[row].theta_offset
    assert numbers.middle[k] == pytest.approx(old, abs=1e-15)
    found = changes(record, changed(record, name, width))
    assert list(found) == PLACES[name]
    np.testing.assert_allclose([*found.values()], width, rtol=1e-6)


def test_a_value_for_all_joints_is_a_number_of_each(tmp_path: Path) -> None:
    file = tmp_path / "arm.toml"
    file.write_text(
        "format = 1\n[motors]\ncurrent_limit = {value = 1.0, half_width = 0.1}\n"
    )
    numbers = arm_numbers(a5.arm_file(file))
    names = [f"motors.current_limit.axis_{joint}" for joint in "edcba"]
    assert numbers.names[-5:] == tuple(names)
    assert (numbers.half_width[-5:] == 0.1).all()


def test_a_longer_spacer_lowers_the_tool() -> None:
    record = measured(1, attached__sensor__spacer=1e-4)
    found = changes(record, changed(record, "attached.sensor.spacer", 1e-4))
    assert found == {
        ".tool.position[2]": pytest.approx(-1e-4),
        ".attached.0.spacer[]": pytest.approx(1e-4),
    }


def test_the_elbow_is_a_length_and_an_angle() -> None:
    """40 mm and 145.3 mm: the hypotenuse is a_1, their angle turns both its ends."""
    record = a5.parameters()
    found = changed(record, "elbow.opposite", 5e-4)
    angle = np.arctan2(40.5, 145.3)
    assert found.dh[1].a == pytest.approx(np.hypot(0.0405, 0.1453), rel=1e-12)
    assert found.theta_c == pytest.approx(angle, rel=1e-12)
    for row in (1, 2):
        assert found.dh[row].theta_offset == pytest.approx(angle - np.pi / 2)
    measured_a_1 = measured(0, lengths__a_1=1e-3)
    turned = changed(measured_a_1, "elbow.opposite", 5e-4)
    assert turned.dh[1].a == measured_a_1.dh[1].a


def test_the_spread_is_that_of_the_sampled_results() -> None:
    for n in (2, 3):
        drawn = u.sample(n, 4)
        results = [u.reach(drawn.parameters(k)) for k in range(n)]
        found = u.spread(u.reach, n, 4)
        off = np.array(results) - sum(results) / n
        deviation = np.sqrt(off @ off / (n - 1))
        assert found.mean == pytest.approx(sum(results) / n, rel=1e-12)
        assert found.standard_deviation == pytest.approx(deviation, rel=1e-9)
        assert found.standard_error == pytest.approx(deviation / n**0.5, rel=1e-9)
    assert (
        drawn.parameters(np.int64(1)).links[2].mass == drawn.parameters(1).links[2].mass
    )
    assert np.array_equal(u.sample(3).values, u.sample(3, seed=0).values)


def test_a_measured_centre_of_buoyancy_needs_no_length() -> None:
    """The correction of link 3 has it from lengths, unless it is measured itself."""
    corrections = ("base_frame", "link3_cob")
    for measured_cob in (False, True):
        widths = {"links.link_3.mass": 1e-3, "links.link_2.cob": 1e-3}
        if measured_cob:
            widths["links.link_3.cob"] = 1e-3
        record = dataclasses.replace(
            a5.parameters(corrections),
            measurements=tuple(Measurement(k, half_width=w) for k, w in widths.items()),
        )
        for name, by in (("lengths.a_2", 1e-4), ("lengths.d_0", 1e-4)):
            other = changed(record, name, by)
            moved = other.links[3].cob - record.links[3].cob
            axis = 0 if name == "lengths.a_2" else 1
            sign = 1.0 if axis == 0 else -1.0
            expected = np.zeros(3) if measured_cob else sign * by * np.eye(3)[axis]
            np.testing.assert_allclose(moved, expected, atol=1e-12)
            assert np.array_equal(other.links[2].cob, record.links[2].cob)
        other = changed(record, "links.link_3.cob.y", 1e-4)
        moved = other.links[3].cob - record.links[3].cob
        np.testing.assert_allclose(moved, [0.0, 1e-4, 0.0], atol=1e-12)
