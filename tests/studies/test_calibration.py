"""Plans and fits, against Pinocchio, dense inverses and simulated arms."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from identification.calibration_trials import on_scales
from support.weighing import (
    DOWN,
    VEHICLE,
    loads,
    other_arm,
    random_q,
    trim,
    weighed,
)

import alpha5_model as a5
from alpha5_model.errors import ImplausibleWarning, InputError, UnknownNameError
from alpha5_model.numbers.covariance import WIDTH
from alpha5_model.numbers.pose import Pose
from alpha5_model.studies.arm_numbers import arm_numbers

calibrate = a5.calibrate
CELL = calibrate.force_torque()


# --- plans ----------------------------------------------------------------------------


@pytest.mark.parametrize("sensor", [calibrate.scales(), calibrate.efforts()])
def test_poses_that_can_be_taken(sensor: calibrate.Sensor) -> None:
    planned = calibrate.plan_poses(sensor, 8, seed=3)
    q = planned.q
    margin = np.radians(3.0)
    for angle, joint in zip(q.T, a5.parameters().joints, strict=False):
        assert angle.min() >= joint.lower + margin
        assert angle.max() <= joint.upper - margin
    assert not a5.load().in_collision(q).any()
    assert len(np.unique(q, axis=0)) == 8
    # The file has two decimals, and they are the whole angle.
    assert np.allclose(np.degrees(q), np.round(np.degrees(q), 2), rtol=0, atol=1e-9)
    if sensor.kind == "scales":
        assert on_scales(loads(a5.parameters(), a5.AIR, DOWN, q)).min() > 0.02
        arm = a5.load()
        corners = [
            arm.forward_kinematics(one, frame).translation[2]
            for one in q
            for frame in ("tcp", "link_3", "link_4")
        ]
        assert min(corners) > -0.03  # above the table


@pytest.mark.slow
def test_planned_poses_tell_more_than_random_ones() -> None:
    """What the docs promise of twelve poses on scales: 0.79 and 0.30 mN m are left."""
    left = []
    for planned in (
        calibrate.plan_poses(calibrate.scales()),
        calibrate.session(calibrate.scales(), random_q(12, seed=9)),
    ):
        exact = on_scales(loads(a5.parameters(), a5.AIR, DOWN, planned.q))
        found = calibrate.fit(calibrate.with_readings(planned, exact))
        assert found.problems == ()
        left.append(1e3 * found.torque_after)
    assert left[0][1] < 0.87
    assert left[0][2] < 0.33
    assert left[0][1] < left[1][1]


@pytest.mark.slow
def test_scales_beside_the_arm_have_no_poses() -> None:
    corners = calibrate.scales().positions + np.array([0.5, 0.0, 0.0])
    with pytest.raises(InputError, match="more ballast"):
        calibrate.plan_poses(calibrate.scales(corners))
    with pytest.warns(ImplausibleWarning, match="ballast"):
        planned = calibrate.plan_poses(calibrate.scales(corners), 3, ballast=200.0)
    assert len(planned.q) == 3


# --- fits -----------------------------------------------------------------------------


def predicted(session: calibrate.Session, record: Any, others: dict[str, float]) -> Any:
    """What a load cell shows of an arm with tilts, gains and offsets, by Pinocchio."""
    helper = np.eye(3)[np.abs(session.gravity).argmin()]
    first = np.cross(session.gravity, helper)
    first /= np.linalg.norm(first)
    axes = [first, np.cross(session.gravity, first) / np.linalg.norm(session.gravity)]
    about = others["0.tilt.1"] * axes[0] + others["0.tilt.2"] * axes[1]
    gravity = session.gravity + np.cross(about, session.gravity)
    gravity *= np.linalg.norm(session.gravity) / np.linalg.norm(gravity)
    load = loads(record, session.density, gravity, session.q)[:, 4:]
    gain = [others[f"0.gain.{channel}"] for channel in session.sensor.channels]
    offset = [others[f"0.offset.{channel}"] for channel in session.sensor.channels]
    return (1.0 + np.array(gain)) * load + offset


@pytest.mark.slow
def test_a_fit_is_the_most_probable_arm() -> None:
    """By Pinocchio's slopes of all numbers, and a dense inverse."""
    planned = calibrate.plan_poses(CELL, 10, fluid_density=a5.FRESH_WATER)
    session = weighed(planned, other_arm(5), 5)
    found = calibrate.fit(session)
    others = dict(zip(found.other_names, found.other_estimate.tolist(), strict=True))
    numbers = arm_numbers(found.arm)
    rows = [numbers.names.index(name) for name in found.names]
    noise = CELL.deviation

    def misfit(change: Any) -> Any:
        values = numbers.middle.copy()
        values[rows] += change[: len(rows)]
        more = change[len(rows) :].tolist()
        moved = {
            name: value + by
            for (name, value), by in zip(others.items(), more, strict=True)
        }
        read = predicted(session, numbers.record(values), moved)
        return ((session.readings - read) / noise).ravel()

    prior = np.concatenate([found.prior, np.repeat(0.0, len(others))])
    for k, name in enumerate(others, len(rows)):
        own = {"tilt": np.radians(0.5), "gain": 0.01, "offset": 10.0}
        prior[k] = own[name.split(".")[1]]
        if ".offset.M" in name:
            prior[k] = 1.0
    columns = []
    for k, size in enumerate(prior):
        step = np.zeros(len(prior))
        step[k] = 0.01 * min(size, 0.02)
        columns.append((misfit(step) - misfit(-step)) / (2 * step[k]))
    slopes = np.transpose(columns)
    information = slopes.T @ slopes + np.diag(prior**-2)
    deviation = np.sqrt(np.diag(np.linalg.inv(information)))
    ours = np.concatenate([found.deviation, found.other_deviation])
    np.testing.assert_allclose(ours, deviation, rtol=0.01)

    # At the most probable numbers, the sum of squares has no slope.
    before = arm_numbers(a5.parameters()).middle[rows]
    off = np.concatenate([found.estimate - before, found.other_estimate])
    gradient = slopes.T @ misfit(np.zeros(len(prior))) + off / prior**2
    step = np.linalg.solve(information, gradient)
    assert np.abs(step / deviation).max() < 0.02
    rest = misfit(np.zeros(len(prior)))
    squared = rest @ rest + np.sum((off / prior) ** 2)
    assert found.squared == pytest.approx(squared, rel=1e-3)


def torque_deviation(found: calibrate.Calibration, q: Any, density: float) -> Any:
    """Of static torques by the covariance, each number moved in Pinocchio, (N, 2)."""
    covariance = found.arm.covariance
    assert covariance is not None
    numbers = arm_numbers(found.arm)
    columns = []
    for name, size in zip(covariance.names, covariance.deviation, strict=True):
        values = numbers.middle.copy()
        values[numbers.names.index(name)] += 0.1 * size
        torque = loads(numbers.record(values), density, DOWN, q)[:, 1:3]
        columns.append(
            (torque - loads(found.arm, density, DOWN, q)[:, 1:3]) / (0.1 * size)
        )
    slopes = np.stack(columns, axis=-1)
    return np.sqrt(np.einsum("njk,kl,njl->nj", slopes, covariance.matrix, slopes))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sensor", "prior"),
    [
        (calibrate.scales(), "digits"),
        (CELL, "loose"),
        (calibrate.efforts(), "digits"),
    ],
)
def test_a_known_arm_in_air_and_in_water(
    sensor: calibrate.Sensor, prior: str, tmp_path: Path
) -> None:
    """Torques that nobody measured lie in their intervals; so the file says."""
    truth = other_arm(1, size=0.05 if prior == "loose" else 0.002, zeros=1.5)
    sessions = []
    for seed, density in enumerate((a5.AIR, a5.FRESH_WATER)):
        planned = calibrate.plan_poses(
            sensor, fluid_density=density, prior=prior, seed=2
        )
        sessions.append(weighed(planned, truth, seed))
    found = calibrate.fit(sessions, prior=prior)
    assert found.problems == ()
    assert found.density == a5.FRESH_WATER
    q = random_q(30, seed=8)
    error = [
        loads(record, 1000.0, DOWN, q)[:, 1:3] - loads(truth, 1000.0, DOWN, q)[:, 1:3]
        for record in (found.arm, a5.parameters())
    ]
    deviation = torque_deviation(found, q, 1000.0)
    assert np.abs(error[0] / deviation).max() < 4.5
    assert np.linalg.norm(error[0]) < 0.7 * np.linalg.norm(error[1])
    remaining = np.sqrt((deviation**2).mean(axis=0))
    assert np.allclose(remaining, found.torque_after[1:3], rtol=0.4)

    found.write(tmp_path / "mine.toml")
    again = a5.arm_file(tmp_path / "mine.toml")
    same = loads(again, 1000.0, DOWN, q) - loads(found.arm, 1000.0, DOWN, q)
    assert np.abs(same).max() < 1e-12
    assert again.covariance is not None
    ours = found.arm.covariance
    assert ours is not None
    assert again.covariance.names == ours.names
    assert np.allclose(again.covariance.matrix, ours.matrix, rtol=0, atol=1e-12)
    half_widths = {one.key: one.half_width for one in found.arm.measurements}
    k = found.names.index("links.link_2.mass")
    assert half_widths["links.link_2.mass"] == pytest.approx(
        WIDTH * found.deviation[k], rel=1e-3
    )


def motion(count: int = 500) -> dict[str, Any]:
    """A motion of sines at 20 Hz: q, v, a."""
    rates = np.array([[0.45, 0.3, 0.5, 0.25], [0.95, 1.3, 0.7, 1.1]])
    size = np.array([[0.4], [0.2]])
    angle = 0.05 * np.arange(count)[:, None, None] * rates + [[0.0], [1.0]]
    middle = a5.named_pose("reach") + np.array([0.0, 0.5, -0.6, 0.0])
    return {
        "q": middle + (size * np.sin(angle)).sum(axis=1),
        "v": (size * rates * np.cos(angle)).sum(axis=1),
        "a": (-size * rates**2 * np.sin(angle)).sum(axis=1),
    }


@pytest.mark.slow
def test_a_recording_whose_noise_drifts() -> None:
    """Its size and correlation are found; white noise would promise too much."""
    planned = calibrate.session(CELL, **motion(), fluid_density=a5.SEA_WATER)
    truth = other_arm(4)
    clean = weighed(planned, truth, 4, noise=0.0).readings
    rng = np.random.default_rng(6)
    drift = rng.normal(size=clean.shape)
    for k in range(1, len(drift)):
        drift[k] = 0.95 * drift[k - 1] + np.sqrt(1 - 0.95**2) * drift[k]
    read = calibrate.with_readings(planned, clean + CELL.deviation * drift)
    found = calibrate.fit(read, correlated=True)
    assert found.problems == ()
    assert found.correlation[0] == pytest.approx(0.95, abs=0.06)
    assert found.noise[0] == pytest.approx(CELL.deviation, rel=0.5)
    white = calibrate.fit(read)
    assert (found.torque_after[1:3] > 1.5 * white.torque_after[1:3]).all()
    q = random_q(30, seed=8)
    error = loads(found.arm, 1025.0, DOWN, q) - loads(truth, 1025.0, DOWN, q)
    assert np.abs(error[:, 1:3] / torque_deviation(found, q, 1025.0)).max() < 4.0


@pytest.mark.slow
def test_friction_and_inertia_of_an_arm_that_moves() -> None:
    rng = np.random.default_rng(6)
    q = random_q(60, seed=6)
    v, a = rng.normal(size=(2, 60, 4))
    sensor = calibrate.efforts(noise=1e-4)
    planned = calibrate.session(sensor, q, v=v, a=a)
    readings = weighed(planned, a5.parameters(), 3).readings
    friction = 0.3 * np.sign(v) + 0.1 * v
    found = calibrate.fit(
        calibrate.with_readings(planned, readings + friction), prior="loose"
    )
    assert found.problems == ()
    number = found.names.index("links.link_2.inertia.zz")
    assert found.deviation[number] < 0.9 * found.prior[number]
    others = dict(zip(found.other_names, found.other_estimate, strict=True))
    assert np.isclose(others["0.Coulomb.axis_d"], 0.3, atol=0.01)
    assert np.isclose(others["0.viscous.axis_c"], 0.1, atol=0.01)


@pytest.mark.slow
def test_the_stiffness_of_a_vehicle() -> None:
    """What the facts give, over the gain."""
    facts = {**VEHICLE, "com": [0.01, 0.0, -0.02], "cob": [0.0, 0.01, 0.035]}
    stiffer = {**facts, "cob": [0.0, 0.01, 0.045]}
    q = random_q(15, seed=3)
    readings = [trim(a5.parameters(), 1000.0, one, stiffer) for one in q]
    tilt = calibrate.vehicle_tilt(facts, noise=1e-4, gain=0.5, yaw=0.5)
    found = calibrate.fit(
        calibrate.session(tilt, q, readings, fluid_density=1000.0), zeros=1e-6
    )
    others = dict(zip(found.other_names, found.other_estimate, strict=True))
    lever = [
        1000.0 * one["volume"] * one["cob"][2] - one["mass"] * one["com"][2]
        for one in (facts, stiffer)
    ]
    gain = 1.0 + others["0.gain.roll"]
    # The arm's own lever counts in both.
    assert gain == pytest.approx(lever[0] / lever[1], rel=0.1)
    assert abs(others["0.yaw"]) < 0.05


def test_weight_alone_tells_the_whole_mass() -> None:
    heavy = np.full((2, 1), sum(link.mass for link in a5.parameters().links) + 0.02)
    session = calibrate.session(calibrate.weight(noise=1e-4), random_q(2), heavy)
    found = calibrate.fit(session, prior="loose")
    assert found.problems == ()
    total = sum(link.mass for link in found.arm.links)
    assert np.isclose(total, heavy[0, 0], atol=0.003)


@pytest.mark.slow
def test_wild_readings_leave_possible_bodies() -> None:
    rng = np.random.default_rng(5)
    q, v, a = rng.uniform(0.3, 3.0, (3, 20, 4))
    planned = calibrate.session(CELL, q, v=v, a=a)
    for size in (1.0, 50.0, 1e4):
        wild = size * rng.normal(size=(20, 6))
        found = calibrate.fit(calibrate.with_readings(planned, wild), prior="loose")
        assert found.problems
        assert str(found).startswith("problem 1: ")
        assert found.text().startswith("# problem 1: ")
        for link in found.arm.links:
            assert link.mass > 0
            assert link.volume > 0
            assert (link.bounds[:, 0] <= link.com).all()
            assert (link.com <= link.bounds[:, 1]).all()
            second = np.trace(link.inertia) / 2 * np.eye(3) - link.inertia
            assert np.linalg.eigvalsh(second).min() > 0


def test_what_is_refused() -> None:
    planned = calibrate.plan_poses(calibrate.efforts(), 2)
    read = calibrate.with_readings(planned, np.ones((2, 4)))
    for wrong in (planned, [], [read, 3]):
        with pytest.raises(InputError, match="sessions"):
            calibrate.fit(wrong)  # type: ignore[arg-type]
    with pytest.raises(UnknownNameError, match="prior"):
        calibrate.fit(read, prior="tight")
    with pytest.raises(InputError, match="arm"):
        calibrate.fit(read, arm=calibrate.fit(read).arm)
    for name in ("zeros", "tilt", "correlated"):
        with pytest.raises(InputError, match=name):
            calibrate.fit(read, **{name: -0.5})  # type: ignore[arg-type]
    with pytest.raises(InputError, match="poses"):
        calibrate.plan_poses(calibrate.efforts(), 0)
    known = calibrate.fit(read, zeros=0.0, tilt=0.0)
    assert not any(name.startswith("zeros") for name in known.names)
    assert not any("tilt" in name for name in known.other_names)


def test_gravity_is_in_base_link() -> None:
    """It is not turned by the mount of the arm's file."""
    mount = Pose(
        position=np.zeros(3), rotation=np.diag([1.0, -1.0, -1.0]), parent="world"
    )
    turned = replace(a5.parameters(), mount=mount)
    q = random_q(3)
    side = np.array([9.81, 0.0, 0.0])
    exact = loads(a5.parameters(), a5.AIR, side, q)[:, 4:]
    session = calibrate.session(CELL, q, exact, gravity=side)
    assert calibrate.fit(session, arm=turned).squared < 1e-6
