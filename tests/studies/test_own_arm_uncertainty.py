"""Half widths of an arm file replace the digits', in every result about uncertainty."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import own_arm_dynamics as own
import pytest

import alpha5_model as a5
from alpha5_model import uncertainty as u
from alpha5_model.numbers.parameters import Alpha5Parameters, Measurement
from alpha5_model.studies.uncertainty.digit_bounds import torque_margin

EXAMPLE = Path(__file__).parents[2] / "examples" / "my_arm.toml"
LINKS = [f"link_{i}" for i in range(5)]
QUANTITIES = ("mass", "com", "inertia", "volume", "cob")
DOWN = np.array([0.0, 0.0, -9.81])
#: Seeds of records: with tool anywhere, and with a spacer.
SEEDS = (0, 1)


def exact(record: Alpha5Parameters, **half_widths: float) -> Alpha5Parameters:
    """The record with no doubt about its bodies, except for some.

    Args:
        record: An arm.
        half_widths: By key, with ``__`` for the dots.
    """
    given = {f"links.{link}.{name}": 0.0 for link in LINKS for name in QUANTITIES}
    given |= {key.replace("__", "."): width for key, width in half_widths.items()}
    measurements = [Measurement(key, half_width=x) for key, x in given.items()]
    return dataclasses.replace(record, measurements=tuple(measurements))


def corners(
    record: Alpha5Parameters, where: str, name: str, half_width: float
) -> Iterator[Alpha5Parameters]:
    """The record with a value of a body at each corner of its interval.

    Args:
        record: An arm.
        where: ``links`` or ``attached``.
        name: Of the body and its field, with a dot.
        half_width: Of each number of the value.
    """
    body_name, field = name.split(".")
    bodies = list(getattr(record, where))
    i = [body.name for body in bodies].index(body_name)
    value = np.asarray(getattr(bodies[i], field), float)
    free = [at for at in np.ndindex(value.shape) if list(at) == sorted(at)]
    for signs in itertools.product((-1, 1), repeat=len(free)):
        change = np.zeros(value.shape)
        for at, sign in zip(free, signs, strict=True):
            change[at] = change[at[::-1]] = sign * half_width
        new = dataclasses.replace(bodies[i], **{field: value + change})
        changed = (*bodies[:i], new, *bodies[i + 1 :])
        yield dataclasses.replace(record, **{where: changed})


CASES = [
    *(("links", f"link_2.{quantity}") for quantity in QUANTITIES),
    *(("links", "link_0.mass"), ("links", "link_4.com"), ("links", "link_3.cob")),
    *(("attached", f"sensor.{quantity}") for quantity in QUANTITIES),
    *(("attached", f"lamp.{quantity}") for quantity in ("mass", "com")),
    ("attached", "sensor.position"),
]
WIDTHS = {
    "position": 2e-3,
    "mass": 2e-3,
    "com": 1e-3,
    "inertia": 2e-7,
    "volume": 3e-6,
    "cob": 1e-3,
}


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize(("where", "name"), CASES)
def test_a_half_width_widens_bounds_as_far_as_its_corners(
    where: str, name: str, seed: int
) -> None:
    """Newton's and Euler's equations at every corner, at rest and in motion."""
    field = name.split(".")[1]
    key = f"{where}.{'sensor.at' if field == 'position' else name}"
    width = WIDTHS[field]
    record = own.random_record(seed)
    q, v, a = own.states(record, 4)
    v[:2], a[:2] = 0.0, 0.0

    def half_width(arm: Alpha5Parameters) -> np.ndarray:
        found = u.bounds(q, v, a, a5.load(arm=arm))
        lower, upper = np.concatenate([found.torque, found.base_wrench], axis=-1)
        return np.asarray((upper - lower) / 2)

    wider = half_width(exact(record, **{key.replace(".", "__"): width}))
    wider = wider - half_width(exact(record))
    nominal = np.hstack(own.inverse_dynamics(record, q, v, a, a5.SEA_WATER, DOWN))
    farthest = np.zeros_like(nominal)
    for corner in corners(record, where, name, width):
        loads = np.hstack(own.inverse_dynamics(corner, q, v, a, a5.SEA_WATER, DOWN))
        farthest = np.maximum(farthest, np.abs(loads - nominal))
    assert farthest.max() > 1e-9
    slack = 1e-3 * farthest.max()
    np.testing.assert_allclose(wider, farthest, rtol=0.02, atol=slack)


def test_without_half_widths_the_digits_hold_about_its_own_values() -> None:
    """An arm of printed bodies with another mount has the catalogue's bounds."""
    q, v, a = [3.0, 1.2, 1.5, 0.3], [0.1, -0.2, 0.3, 0.4], [1.0, -1.0, 0.5, 0.2]
    heavier = dataclasses.replace(a5.parameters().links[2], mass=0.4)
    links = (*a5.parameters().links[:2], heavier, *a5.parameters().links[3:])
    record = dataclasses.replace(a5.parameters(), links=links)
    printed = u.bounds(q, v, a).torque
    found = u.bounds(q, v, a, a5.load(arm=record)).torque
    widths = found.upper - found.lower
    assert widths == pytest.approx(printed.upper - printed.lower, rel=0.05)
    middle = (found.upper + found.lower) / 2
    assert middle == pytest.approx(a5.load(arm=record).inverse_dynamics(q, v, a), 1e-4)


@pytest.mark.parametrize("seed", SEEDS)
def test_samples_stay_in_their_intervals_and_in_the_bounds(seed: int) -> None:
    record = own.random_record(seed)
    widths = {
        "links.link_1.mass": 3e-3,
        "links.link_3.com": 1e-3,
        "attached.sensor.volume": 1e-6,
        "lengths.a_1": 1e-3,
        "lengths.a_2": 0.0,
        "zeros.axis_d": 0.01,
        "joint_limits.axis_c.max_position": 0.02,
        "motors.friction.axis_d": 1e-5,
    }
    measurements = tuple(Measurement(key, half_width=x) for key, x in widths.items())
    record = dataclasses.replace(record, measurements=measurements)
    drawn = u.sample(40, 5, arm=record)
    sets = [drawn.parameters(k) for k in range(40)]

    def of(get: Any) -> np.ndarray:
        return np.array([get(one) - get(record) for one in sets])

    differences = {
        "links.link_1.mass": of(lambda p: p.links[1].mass),
        "links.link_3.com": of(lambda p: p.links[3].com),
        "attached.sensor.volume": of(lambda p: p.attached[0].volume),
        "lengths.a_1": of(lambda p: p.dh[1].a),
        "lengths.a_2": of(lambda p: p.dh[2].a),
        "joint_limits.axis_c.max_position": of(lambda p: p.joints[2].upper),
        "motors.friction.axis_d": of(lambda p: p.actuators[1].friction),
    }
    for key, difference in differences.items():
        largest = np.abs(difference).max()
        assert 0.8 * widths[key] <= largest <= widths[key] * (1 + 1e-9), key
    # The printed theta_c is part of this angle, too.
    assert 0.008 < np.abs(of(lambda p: p.dh[1].theta_offset)).max() < 0.0135
    # What its digits leave open, below and above.
    digits = u.printed_numbers()["links.link_2.mass"]
    spread = np.ptp(of(lambda p: p.links[2].mass))
    assert spread > 0.8 * (digits.upper - digits.lower)
    if seed % 2:
        for one in sets:
            tip = one.dh[3].d - one.spacer
            assert one.tool.position[2] == pytest.approx(tip, abs=1e-12)
    # With its lengths, each set is an arm whose torques Newton computes.
    q, v, a = own.states(record, 2)
    for one in sets[:1]:
        tau, _ = own.inverse_dynamics(one, q, v, a, a5.SEA_WATER, DOWN)
        assert a5.load(arm=one).inverse_dynamics_batch(q, v, a) == pytest.approx(tau)


#: Key of a measured value beside the bodies -> how a record has it.
OTHERS: dict[str, Any] = {
    "attached.sensor.at": lambda p: p.attached[0].position,
    "attached.sensor.mass": lambda p: p.attached[0].mass,
    "attached.sensor.spacer": lambda p: p.attached[0].spacer,
    "lengths.a_0": lambda p: p.dh[0].a,
    "lengths.d_0": lambda p: p.dh[0].d,
    "lengths.a_1": lambda p: p.dh[1].a,
    "lengths.a_2": lambda p: p.dh[2].a,
    "lengths.d_3": lambda p: p.dh[3].d,
    "zeros.axis_b": lambda p: p.dh[3].theta_offset,
    "tool.xyz": lambda p: p.tool.position,
    "mount.xyz": lambda p: p.mount.position,
    "joint_limits.axis_a.max_effort": lambda p: p.joints[4].effort,
    "joint_limits.axis_e.min_position": lambda p: p.joints[0].lower,
    "joint_limits.axis_d.max_velocity": lambda p: p.joints[1].velocity,
    "motors.supply_voltage": lambda p: p.motors.supply_voltage,
    "motors.current_limit.axis_b": lambda p: p.motors.current_limits[3],
    "motors.rotor_inertia.axis_c": lambda p: p.motors.rotor_inertias[2],
    "motors.torque_constant.axis_d": lambda p: p.actuators[1].torque_constant,
    "motors.gear_ratio.axis_e": lambda p: p.actuators[0].gear_ratio,
}


@pytest.mark.slow
@pytest.mark.parametrize("key", OTHERS)
def test_sensitivity_moves_a_measured_value_by_its_half_width(key: str) -> None:
    record = own.random_record(1 if "spacer" in key or "sensor" in key else 0)
    motors = a5.numbers.motors.Motors(
        supply_voltage=24.0, current_limits=(1.0,) * 5, rotor_inertias=(1e-6,) * 5
    )
    width = 1e-7 if "inertia" in key else 1e-4
    record = dataclasses.replace(
        record,
        mount=own.random_mount(3),
        motors=motors,
        measurements=(Measurement(key, half_width=width),),
    )
    get = OTHERS[key]
    found = u.sensitivity(lambda p: np.asarray(get(p), float), arm=record)
    assert found.nominal == pytest.approx(np.asarray(get(record), float), abs=1e-15)
    assert found.half_width == pytest.approx(
        np.full(np.shape(get(record)), width), rel=1e-6
    )


@pytest.mark.slow
@pytest.mark.parametrize("key", ["tool.rpy", "mount.rpy", "attached.sensor.rpy"])
def test_sensitivity_turns_a_measured_orientation(key: str) -> None:
    record = dataclasses.replace(
        own.random_record(0),
        mount=own.random_mount(3),
        measurements=(Measurement(key, half_width=1e-3),),
    )

    def rotation(p: Alpha5Parameters) -> np.ndarray:
        pose: Any = p.attached[0]
        if not key.startswith("attached"):
            pose = getattr(p, key.split(".")[0])
        return np.array(pose.rotation)

    found = u.sensitivity(rotation, arm=record)
    by_name = dict(zip(found.names, found.effects, strict=True))
    for axis in "xyz":
        turn = by_name[f"{key}.{axis}"] @ rotation(record).T
        assert np.linalg.norm(turn) == pytest.approx(2**0.5 * 1e-3, rel=1e-4)


def test_the_margin_of_any_gripper_and_mount_is_that_of_the_record() -> None:
    record = a5.arm_file(EXAMPLE)
    q, v, a = [3.0, 1.2, 1.5, 0.3], [0.1, -0.2, 0.3, 0.4], [1.0, -1.0, 0.5, 0.2]
    arm = a5.load(arm=record)
    bounds = u.bounds(q, v, a, arm).torque
    margin = torque_margin(arm, q, v, a)
    assert margin + arm.inverse_dynamics(q, v, a) == pytest.approx(
        np.array(bounds), abs=1e-12
    )
    jaws = a5.load(gripper="jaws", arm=record)
    of_jaws = torque_margin(jaws, [*q, 0.0], [*v, 0.0], [*a, 0.0])
    assert of_jaws[:, :4] == pytest.approx(margin, abs=1e-12)
