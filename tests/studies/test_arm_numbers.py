"""The numbers of an arm of your own: half widths, changes of one value, and draws."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import own_arm_dynamics as own
import pytest

import alpha5_model as a5
from alpha5_model.numbers.measurement import Measurement
from alpha5_model.numbers.motors import Motors
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.studies.uncertainty import linear_maps, sampling
from alpha5_model.studies.uncertainty.arm_numbers import ArmNumbers, arm_numbers
from alpha5_model.studies.uncertainty.measured import other_numbers, with_changes

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
    "motors.current_limit": [f".motors.current_limits.{k}[]" for k in range(5)],
    "motors.current_limit.axis_c": [".motors.current_limits.2[]"],
    "motors.rotor_inertia.axis_d": [".motors.rotor_inertias.1[]"],
    "motors.viscous_friction.axis_a": [".motors.viscous_frictions.4[]"],
}


def key_of(name: str) -> str:
    """The key of the arm file that a number is of."""
    stem, _, axes = name.rpartition(".")
    return stem if set(axes) <= {*"xyz"} else name


@pytest.mark.filterwarnings("ignore::alpha5_model.errors.ImplausibleWarning")
@pytest.mark.parametrize("name", PLACES)
def test_a_change_of_a_measured_number_changes_nothing_else(name: str) -> None:
    width = 1e-8 if "inertia" in name or "friction" in name else 1e-5
    record = measured(0, **{key_of(name).replace(".", "__"): width})
    numbers = {one.name: one for one in other_numbers(record)}
    assert numbers[name].half_width == width
    old = leaves(record)
    assert numbers[name].value == old[PLACES[name][0]]
    found = changes(record, with_changes(record, {name: width}))
    assert list(found) == PLACES[name]
    np.testing.assert_allclose([*found.values()], width, rtol=1e-6)


def test_a_longer_spacer_lowers_the_tool() -> None:
    record = measured(1, attached__sensor__spacer=1e-4)
    found = changes(record, with_changes(record, {"attached.sensor.spacer": 1e-4}))
    assert found == {
        ".attached.0.spacer[]": pytest.approx(1e-4),
        ".tool.position[2]": pytest.approx(-1e-4),
    }


def half_width_of(record: Alpha5Parameters) -> dict[str, float]:
    numbers = arm_numbers(record)
    return dict(zip(numbers.names, numbers.half_width.tolist(), strict=True))


def test_the_nearest_key_of_a_motor_counts() -> None:
    record = measured(
        0, motors__gear_ratio=0.5, motors__gear_ratio__axis_d=0.1, lengths__a_2=2e-3
    )
    found = half_width_of(record)
    ratios = [found[f"actuator_{k}.gear_ratio"] for k in range(5)]
    assert ratios == [0.5, 0.1, 0.5, 0.5, 0.5]
    assert found["link_2.a"] == 2e-3
    assert found["link_3.d"] == pytest.approx(5e-4)


@pytest.mark.parametrize("tolerance", [0.0, 0.05, 0.5])
def test_friction_is_known_by_its_tolerance_or_its_digits(tolerance: float) -> None:
    """Whatever is wider; the friction of each motor is its own."""
    record = own.random_record(0)
    actuators = [
        dataclasses.replace(row, friction=(k + 1) * 1e-4, friction_tolerance=tolerance)
        for k, row in enumerate(record.actuators)
    ]
    found = half_width_of(dataclasses.replace(record, actuators=tuple(actuators)))
    for k in range(5):
        name = f"actuator_{k}.friction"
        text, unit = (u.printed_numbers()[name].printed.text, "Nmm")
        assert u.printed_numbers()[name].printed.unit == unit
        digit = 10.0 ** -len(text.partition(".")[2]) / 2 * 1e-3
        expected = max(digit, tolerance * (k + 1) * 1e-4)
        assert found[name] == pytest.approx(expected, rel=1e-9)


def test_a_centre_of_mass_stays_in_the_bounds_of_its_body() -> None:
    """At an end of them it is inside, where a known one may be."""
    record = own.random_record(0)
    link = record.links[2]
    bounds = np.array([link.com - 2e-4, link.com + 1e-4]).T
    bounds[1] = link.com[1]  # known, and at both ends
    tight = dataclasses.replace(link, bounds=bounds)
    links = (*record.links[:2], tight, *record.links[3:])
    record = dataclasses.replace(
        record,
        links=links,
        measurements=(Measurement("links.link_2.com", half_width=0.0),),
    )
    numbers = arm_numbers(record)
    sets = np.tile(numbers.middle, (7, 1))
    of_com = [numbers.names.index(f"link_2.com.{axis}") for axis in "xyz"]
    steps = np.zeros((7, 3))
    steps[1:, 0] = [0.9e-4, 1.1e-4, -1.9e-4, -2.1e-4, 0.0, 0.0]
    steps[5:, 2] = [0.9e-4, 1.1e-4]
    sets[:, of_com] += steps
    expected = [True, True, False, True, False, True, False]
    on_the_edge = numbers.bodies(sets)[:, 2, 2] == link.com[1]
    found = numbers.possible(sets)
    assert on_the_edge.all()
    assert found.tolist() == expected


@pytest.mark.parametrize(
    ("change", "is_possible"),
    [
        ({}, True),
        ({10: 0.0}, True),  # no volume, as of a thin frame
        ({10: -1e-9}, False),
        ({0: 0.0}, False),
        ({4: 0.0, 5: 0.0, 6: 0.0}, False),  # a flat body
        ({4: 1e-12, 5: 0.0, 6: 0.0}, True),
    ],
)
def test_a_body_has_mass_and_width_but_need_not_displace(
    change: dict[int, float], is_possible: bool
) -> None:
    second = [1e-4, 0.0, 0.0, 1e-4, 0.0, 1e-4]
    body = np.array([0.3, 0.1, 0.0, 0.0, *second, 1e-4, 0.1, 0.0, 0.0])
    bodies = np.tile(body, (1, 2, 1))
    for column, value in change.items():
        bodies[0, 1, column] = value
    assert linear_maps.possible(bodies).tolist() == [is_possible]


def test_sets_of_an_arm_with_printed_bodies_keep_the_rest_of_it() -> None:
    joints = [
        dataclasses.replace(joint, effort=0.5 * joint.effort)
        for joint in a5.parameters().joints
    ]
    record = dataclasses.replace(
        a5.parameters(), name="mine", mount=own.random_mount(1), joints=tuple(joints)
    )
    one = u.sample(1, arm=record).parameters(0)
    plain = u.sample(1).parameters(0)
    assert (one.name, one.mount, one.joints) == ("mine", record.mount, record.joints)
    assert leaves(one.links) == leaves(plain.links)
    assert one.links[2].mass != record.links[2].mass


def test_a_draw_is_tried_so_many_times(monkeypatch: pytest.MonkeyPatch) -> None:
    tried: list[int] = []

    def never(self: ArmNumbers, sets: np.ndarray) -> np.ndarray:
        tried.append(len(sets))
        return np.arange(len(sets)) < (len(tried) == 2)

    monkeypatch.setattr(sampling, "_MOST_ROUNDS", 4)
    monkeypatch.setattr(ArmNumbers, "possible", never)
    expected = "1 possible sets in 4 rounds"
    with pytest.raises(a5.errors.InputError, match=expected):
        u.sample(3)
    assert tried == [3, 3, 2, 2]


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


def test_bounds_allow_for_the_rounding_of_all_torques() -> None:
    """The first joint carries no weight; its torque is that of rounding."""
    q = np.array([[0.3, 1.2, 1.5, 0.4], [2.0, 0.7, 2.2, 1.0]])
    rest = np.zeros((2, 4))
    found = u.bounds(q, rest, rest).torque
    assert (found.lower[:, 0] < 0.0).all()
    assert (found.upper[:, 0] > 0.0).all()
    assert found.upper[:, 0].max() < 1e-12


def test_bounds_with_jaws_move_all_quantities_by_the_jaws() -> None:
    """The widths are those without; the middles are what the arm itself has."""
    jaws = a5.load(gripper="jaws").with_payload(0.2, (0.0, 0.01, 0.02))
    q = np.array([0.3, 1.2, 1.5, 0.4, 0.005])
    v = np.array([0.4, -0.6, 0.5, 0.3, 0.01])
    a = np.array([1.0, 0.5, -0.8, 0.2, 0.02])
    found = u.bounds(q, v, a, jaws)
    narrow = u.bounds(q[:4], v[:4], a[:4], a5.load())
    plain = a5.load()
    shifts = (
        jaws.base_wrench(q, v, a).vector
        - plain.base_wrench(q[:4], v[:4], a[:4]).vector,
        jaws.kinetic_energy(q, v) - plain.kinetic_energy(q[:4], v[:4]),
        jaws.potential_energy(q) - plain.potential_energy(q[:4]),
    )
    for ours, theirs, shift in zip(found[1:], narrow[1:], shifts, strict=True):
        np.testing.assert_allclose(ours, np.array(theirs) + shift, atol=1e-10)


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
        numbers = arm_numbers(record)
        for name, axis in (("link_2.a", 0), ("link_0.d", 1)):
            values = numbers.middle.copy()
            values[numbers.names.index(name)] += 1e-4
            moved = np.abs(
                numbers.parameters(values).links[3].cob - record.links[3].cob
            )
            expected = np.zeros(3) if measured_cob else 1e-4 * np.eye(3)[axis]
            np.testing.assert_allclose(moved, expected, atol=1e-12)
            rest = numbers.parameters(values).links[2]
            assert np.array_equal(rest.cob, record.links[2].cob)
        near = numbers.names.index("link_3.cob.y")
        values = numbers.middle.copy()
        values[near] += 1e-4
        moved = numbers.parameters(values).links[3].cob - record.links[3].cob
        assert np.abs(moved).sum() == pytest.approx(1e-4, rel=1e-6)


def test_the_five_largest_effects_come_first() -> None:
    effects = np.array([[1.0, 0.0], [-5.0, 3.0], [2.0, -3.0], [0.5, 4.0]])
    effects = np.vstack([effects, [[-4.0, 0.1], [0.2, 0.2], [3.0, 0.3]]])
    found = u.Sensitivity(tuple("abcdefg"), np.zeros(2), effects)
    assert [name for name, _ in found.most(0)] == ["b", "e", "g", "c", "a"]
    assert dict(found.most(1, count=3)) == {"d": 4.0, "b": 3.0, "c": -3.0}
    assert found.half_width.tolist() == [15.7, pytest.approx(10.6)]
