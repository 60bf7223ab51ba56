"""Calibration: poses, fits and files, against Pinocchio and simulated arms."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import FileFormatError, InputError, UnknownNameError
from alpha5_model.numbers.arm_file import arm_file
from alpha5_model.numbers.covariance import WIDTH
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.planning.surroundings import Surroundings
from alpha5_model.studies.calibration.equations import Equations
from alpha5_model.studies.calibration.fitting import estimate
from alpha5_model.studies.calibration.loads import Motion, load_slopes
from alpha5_model.studies.calibration.plan_file import SENSORS
from alpha5_model.studies.calibration.poses import TILT, _table
from alpha5_model.studies.calibration.possible_bodies import PossibleBodies
from alpha5_model.studies.calibration.sensors import (
    LOADS,
    placement_matrices,
    plane,
)
from alpha5_model.studies.calibration.unknowns import NAMES, arm_unknowns

calibrate = a5.calibrate
STILL = np.zeros(4)
GRAVITY = np.array([0.0, 0.0, -9.81])
SENSOR = {
    "scales": calibrate.scales(placement=0.001),
    "weight": calibrate.weight(),
    "force-torque": calibrate.force_torque(),
    "efforts": calibrate.efforts(),
}


@cache
def twelve_poses(prior: str = "digits") -> calibrate.Session:
    """On three scales; found once, which takes long without compiled kernels."""
    return calibrate.plan_poses(calibrate.scales(), prior=prior)


def random_q(count: int, seed: int = 0) -> Any:
    joints = a5.parameters().joints[:4]
    lower = [joint.lower for joint in joints]
    upper = [joint.upper for joint in joints]
    return np.random.default_rng(seed).uniform(lower, upper, (count, 4))


def true_arm(prior: str, rng: np.random.Generator) -> Alpha5Parameters:
    """An arm as the prior allows, with zeros of its joints."""
    unknowns = arm_unknowns(a5.parameters(), prior)
    change = np.clip(rng.normal(size=len(NAMES)), -2.0, 2.0) * unknowns.deviation
    return unknowns.record(unknowns.middle + change)


def weighed(
    planned: calibrate.Session, arm: Alpha5Parameters, rng: np.random.Generator
) -> Any:
    """Readings of Pinocchio's arm on a tilted mount, with gains, offsets and noise."""
    sensor = planned.sensor
    roll, pitch = rng.normal(size=2) * TILT
    tilt = np.array([[1, 0, pitch], [0, 1, -roll], [-pitch, roll, 1]])
    tilt, _ = np.linalg.qr(tilt)
    tilt *= np.sign(np.diag(tilt))
    gravity = tilt.T @ planned.motion.gravity
    body = a5.load(planned.density, gravity=gravity, arm=arm)
    loads = []
    for q in planned.motion.q:
        wrench = body.base_wrench(q, STILL, STILL).vector
        loads.append([*body.hydrostatic_torque(q), *wrench])
    matrix = sensor.matrix
    if sensor.positions is not None:
        places = rng.normal(size=6) * sensor.placement
        matrix = matrix + np.tensordot(places, placement_matrices(sensor), 1)
    gain = 1.0 + rng.normal(size=sensor.size) * sensor.gain
    offset = rng.normal(size=sensor.size) * np.minimum(sensor.offset, 0.5)
    noise = rng.normal(size=planned.readings.shape) * sensor.noise
    return gain * (np.array(loads) @ matrix.T) + offset + noise


# --- sensors --------------------------------------------------------------------------


@pytest.mark.parametrize("density", [a5.AIR, a5.SEA_WATER])
def test_scales_carry_weight_less_buoyancy_by_the_lever_rule(density: float) -> None:
    """Each scale carries the share that is the barycentric coordinate of the force."""
    corners = np.array([[0.2, 0.05, -0.04], [-0.15, 0.2, -0.04], [-0.1, -0.22, -0.04]])
    sensor = calibrate.scales(corners)
    arm = a5.load(density)
    mass = sum(link.mass for link in a5.parameters().links)
    displaced = density * sum(link.volume for link in a5.parameters().links)
    for q in random_q(5):
        moment = mass * arm.center_of_mass(q) - displaced * arm.center_of_buoyancy(q)
        at = moment[:2] / (mass - displaced)
        shares = np.linalg.solve(np.vstack([corners[:, :2].T, np.ones(3)]), [*at, 1.0])
        wrench = arm.base_wrench(q, STILL, STILL).vector
        found = sensor.matrix @ [0.0, 0.0, 0.0, 0.0, *wrench]
        assert np.allclose(found, (mass - displaced) * shares, rtol=0, atol=1e-12)


def test_scales_under_an_arm_that_lies_on_its_side() -> None:
    """The plane of the scales may be any, as long as gravity presses on it."""
    gravity = np.array([0.0, -9.81, 0.0])
    corners = [[0.2, -0.05, 0.0], [-0.2, -0.05, 0.2], [-0.2, -0.05, -0.2]]
    sensor = calibrate.scales(corners)
    arm = a5.load(a5.AIR, gravity=gravity)
    q = random_q(1)[0]
    wrench = arm.base_wrench(q, STILL, STILL).vector
    found = sensor.matrix @ [0.0, 0.0, 0.0, 0.0, *wrench]
    centre = found @ np.array(corners) / found.sum()
    assert np.isclose(found.sum(), sum(link.mass for link in a5.parameters().links))
    assert np.allclose(centre[[0, 2]], arm.center_of_mass(q)[[0, 2]], atol=1e-12)


def test_a_moved_scale() -> None:
    sensor = calibrate.scales()
    assert sensor.positions is not None
    axes = plane(sensor.positions)
    step = 1e-6
    for number, slope in enumerate(placement_matrices(sensor)):
        scale, direction = divmod(number, 2)
        readings = []
        for sign in (1, -1):
            moved = sensor.positions.copy()
            moved[scale] += sign * step * axes[direction]
            readings.append(calibrate.scales(moved).matrix)
        by_steps = (readings[0] - readings[1]) / (2 * step)
        assert np.allclose(slope, by_steps, rtol=0, atol=1e-8)


@pytest.mark.parametrize(
    ("kind", "moves"),
    [
        ("scales", False),
        ("weight", False),
        ("force-torque", True),
        ("efforts", True),
    ],
)
def test_slopes_by_finite_differences(kind: str, moves: bool) -> None:
    rng = np.random.default_rng(1)
    q = random_q(3)
    rates = rng.normal(size=(2, 3, 4)) if moves else [None, None]
    sensor = SENSOR[kind]
    measured = calibrate.session(
        sensor,
        q,
        np.zeros((3, sensor.size)),
        fluid_density=1000.0,
        v=rates[0],
        a=rates[1],
    )
    unknowns = arm_unknowns(a5.parameters(), "loose", moving=moves)
    equations = Equations(unknowns, [measured], TILT)
    # Far from the prior, so that products of unknowns matter.
    width = np.minimum(equations.deviation, 0.01)
    values = equations.middle + 0.1 * width * rng.normal(size=len(width))
    slopes = equations.matrix(values)
    free = np.flatnonzero(equations.deviation)
    assert len(free) > 50
    for number in free:
        step = np.zeros(len(width))
        step[number] = max(0.01 * width[number], 1e-9)
        after, before = (equations.residuals(values + s) for s in (step, -step))
        by_steps = (before - after) / (2 * step[number])
        scale = max(np.abs(by_steps).max(), 1e-6)
        assert np.abs(slopes[:, number] - by_steps).max() < 2e-6 * scale


# --- plans ----------------------------------------------------------------------------


@pytest.mark.parametrize("kind", SENSOR)
def test_poses_that_can_be_taken(kind: str) -> None:
    planned = calibrate.plan_poses(SENSOR[kind], 8, seed=3)
    q = planned.motion.q
    margin = np.radians(3.0)
    for angle, joint in zip(q.T, a5.parameters().joints, strict=False):
        assert angle.min() >= joint.lower + margin
        assert angle.max() <= joint.upper - margin
    assert not a5.load().in_collision(q).any()
    assert len(np.unique(q, axis=0)) == 8
    if kind == "scales":
        beside = Surroundings(a5.parameters(), _table(planned.sensor))
        assert min(beside.nearest(one)[0] for one in q) >= 0.0
        loads = [a5.load(a5.AIR).base_wrench(one, STILL, STILL).vector for one in q]
        readings = np.array(loads) @ planned.sensor.matrix[:, 4:].T
        assert readings.min() > 0.02


def remaining(planned: calibrate.Session, prior: str) -> Any:
    """Standard deviation of static torques after readings, by a dense inverse."""
    unknowns = arm_unknowns(a5.parameters(), prior)
    read = calibrate.with_readings(planned, np.zeros(planned.readings.shape))
    equations = Equations(unknowns, [read], TILT)
    free = equations.deviation > 0
    slopes = equations.matrix(equations.middle)[:, free]
    information = slopes.T @ slopes + np.diag(equations.deviation[free] ** -2)
    covariance = np.linalg.inv(information)
    q = random_q(100, seed=5)
    motion = Motion(q=q, v=0.0 * q, a=0.0 * q, gravity=GRAVITY)
    torque = load_slopes(unknowns, unknowns.middle, planned.density, motion)[:, :4]
    wide = np.zeros((100, 4, len(free)))
    wide[..., : len(NAMES)] = torque
    slopes = wide[..., free]
    variance = np.einsum("njk,kl,njl->nj", slopes, covariance, slopes)
    return 1e3 * np.sqrt(variance.mean(axis=0))


@pytest.mark.parametrize(
    ("prior", "d", "c"), [("digits", 1.0, 0.6), ("loose", 1.6, 1.1)]
)
def test_twelve_poses_on_three_scales(prior: str, d: float, c: float) -> None:
    planned = twelve_poses(prior)
    after = remaining(planned, prior)
    assert after[1] < d
    assert after[2] < c
    at_random = calibrate.session(planned.sensor, random_q(12, seed=9))
    assert after[1] < remaining(at_random, prior)[1]


@pytest.mark.slow
def test_scales_beside_the_arm_have_no_poses() -> None:
    corners = calibrate.scales().positions + np.array([0.5, 0.0, 0.0])
    with pytest.raises(InputError, match="scales further apart, or more ballast"):
        calibrate.plan_poses(calibrate.scales(corners))
    planned = calibrate.plan_poses(calibrate.scales(corners), 3, ballast=200.0)
    assert len(planned.motion.q) == 3


@pytest.mark.parametrize("kind", ["force-torque", "efforts"])
def test_an_exciting_motion_can_be_made(kind: str, tmp_path: Path) -> None:
    planned = calibrate.plan_excitation(SENSOR[kind], evaluations=12, seed=1)
    joints = a5.parameters().joints
    for k, joint in enumerate(joints[:4]):
        angle = planned.position[:, k]
        assert angle.min() > joint.lower + 0.05
        assert angle.max() < joint.upper - 0.05
        assert 0.5 * joint.velocity < np.abs(planned.velocity[:, k]).max()
        assert np.abs(planned.velocity[:, k]).max() <= 0.95 * joint.velocity + 1e-9
    assert np.allclose(planned.position[0], planned.position[-1])
    assert np.allclose(planned.velocity[[0, -1]], 0.0, atol=1e-12)
    dense = np.linspace(0.0, planned.time[-1], 4001)
    columns = [np.interp(dense, planned.time, angle) for angle in planned.position.T]
    assert not a5.load().in_collision(np.column_stack(columns)).any()
    by_steps = np.gradient(planned.position, planned.time, axis=0)
    assert np.allclose(by_steps[2:-2], planned.velocity[2:-2], atol=0.01)
    of_velocity = np.gradient(planned.velocity, planned.time, axis=0)
    assert np.allclose(of_velocity[2:-2], planned.acceleration[2:-2], atol=0.01)

    planned.write(tmp_path / "motion.csv")
    again = a5.trajectory.read_motion(tmp_path / "motion.csv")
    assert np.array_equal(again.position[:, :4], planned.position)


@pytest.mark.slow
def test_more_evaluations_tell_more_and_scales_are_refused() -> None:
    few = calibrate.plan_excitation(SENSOR["efforts"], evaluations=4)
    more = calibrate.plan_excitation(SENSOR["efforts"], evaluations=30)
    assert more.information > few.information
    assert few.evaluations == 4
    assert more.evaluations >= 30
    with pytest.raises(InputError, match="scales need an arm at rest"):
        calibrate.plan_excitation(SENSOR["scales"])
    with pytest.raises(InputError, match="evaluations"):
        calibrate.plan_excitation(SENSOR["efforts"], evaluations=0)
    with pytest.raises(InputError, match="duration: expected at most 3600 s, got"):
        calibrate.plan_excitation(SENSOR["efforts"], duration=1e9)


# --- fits -----------------------------------------------------------------------------


def torque_deviation(found: calibrate.Calibration, q: Any, density: float) -> Any:
    """Standard deviation of static torques by the covariance, (N, 4)."""
    covariance = found.arm.covariance
    assert covariance is not None
    unknowns = arm_unknowns(a5.parameters())
    values = unknowns.middle.copy()
    values[[NAMES.index(name) for name in found.names]] = found.estimate
    place = [NAMES.index(name) for name in covariance.names]
    motion = Motion(q=q, v=0.0 * q, a=0.0 * q, gravity=GRAVITY)
    slopes = load_slopes(unknowns, values, density, motion)[:, :4, place]
    variance = np.einsum("njk,kl,njl->nj", slopes, covariance.matrix, slopes)
    return np.sqrt(variance)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "prior"),
    [("scales", "digits"), ("force-torque", "loose"), ("efforts", "digits")],
)
def test_a_known_arm(kind: str, prior: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(len(kind) + len(prior))
    truth = true_arm(prior, rng)
    sessions = []
    for density in (a5.AIR, a5.FRESH_WATER):
        planned = calibrate.plan_poses(
            SENSOR[kind], fluid_density=density, prior=prior, seed=2
        )
        readings = weighed(planned, truth, rng)
        sessions.append(calibrate.with_readings(planned, readings))
    found = calibrate.fit(sessions, prior=prior)
    assert found.problems == ()
    assert found.density == a5.FRESH_WATER
    assert (found.torque_after < found.torque_before + 1e-12).all()

    # Torques that nobody measured, at the angles that the joints report.
    q = random_q(50, seed=8)
    deviation = torque_deviation(found, q, 1000.0)[:, 1:3]
    error = torques(found.arm, q) - torques(truth, q)
    assert np.abs(error[:, 1:3] / deviation).max() < 4.5
    remaining_torque = np.sqrt((deviation**2).mean(axis=0))
    assert np.allclose(remaining_torque, found.torque_after[1:3], rtol=0.3)

    # The file gives the same arm.
    found.write(tmp_path / "mine.toml")
    again = arm_file(tmp_path / "mine.toml")
    assert np.abs(torques(again, q) - torques(found.arm, q)).max() < 1e-12
    ours = found.arm.covariance
    assert again.covariance is not None
    assert ours is not None
    assert again.covariance.names == ours.names
    assert np.allclose(again.covariance.matrix, ours.matrix, rtol=0, atol=1e-12)


def torques(arm: Alpha5Parameters, q: Any) -> Any:
    """In fresh water, (N, 4)."""
    loaded = a5.load(1000.0, arm=arm)
    return np.array([loaded.hydrostatic_torque(one) for one in q])


def test_the_covariance_is_that_of_the_normal_equations() -> None:
    rng = np.random.default_rng(4)
    planned = calibrate.plan_poses(SENSOR["scales"])
    readings = weighed(planned, true_arm("digits", rng), rng)
    read = calibrate.with_readings(planned, readings)
    equations = Equations(arm_unknowns(a5.parameters()), [read], TILT)
    found = estimate(equations)
    free = equations.deviation > 0
    slopes = equations.matrix(found.values)[:, free] * equations.deviation[free]
    inverse = np.linalg.inv(np.eye(int(free.sum())) + slopes.T @ slopes)
    factor = found.factor[free]
    assert np.allclose(np.eye(len(inverse)) - factor @ factor.T, inverse, atol=3e-6)
    # At the most probable values, the sum of squares has no slope.
    change = (found.values - equations.middle)[free] / equations.deviation[free]
    slope = change - slopes.T @ equations.residuals(found.values)
    steep = 1.0 + np.linalg.norm(slopes, axis=0)
    assert np.abs(slope / steep).max() < 1e-3


def test_wild_readings_leave_possible_bodies() -> None:
    rng = np.random.default_rng(5)
    planned = calibrate.plan_poses(SENSOR["force-torque"], prior="loose")
    wild = 50.0 * rng.normal(size=planned.readings.shape)
    found = calibrate.fit(calibrate.with_readings(planned, wild), prior="loose")
    assert found.problems
    for link in found.arm.links:
        assert link.mass > 0
        assert link.volume > 0
        assert link.bounds is not None
        assert (link.bounds[:, 0] < link.com).all()
        assert (link.com < link.bounds[:, 1]).all()
        second = np.trace(link.inertia) / 2 * np.eye(3) - link.inertia
        assert np.linalg.eigvalsh(second).min() > 0


def test_the_slopes_of_possible_bodies_are_differences() -> None:
    """Away from the middle, too, where triangles and exponentials have grown."""
    arm = a5.parameters()
    unknowns = arm_unknowns(arm, "loose", moving=True)
    bodies = PossibleBodies(arm, unknowns.middle, unknowns.deviation)
    free = np.random.default_rng(8).normal(size=len(NAMES))
    step = 1e-5
    columns = [
        (bodies.values(free + step * one) - bodies.values(free - step * one)) / step / 2
        for one in np.eye(len(NAMES))
    ]
    slopes = bodies.slopes(free)
    scale = np.abs(slopes).max(axis=1, keepdims=True) + 1e-12
    np.testing.assert_allclose(slopes / scale, np.transpose(columns) / scale, atol=1e-7)


@pytest.mark.slow
def test_moving_arms_tell_moments_of_inertia_of_possible_bodies() -> None:
    rng = np.random.default_rng(6)
    q = random_q(40, seed=6)
    v, a = rng.normal(size=(2, 40, 4))
    sensor = calibrate.efforts(noise=1e-4)
    arm = a5.load(a5.AIR)
    clean = np.array(
        [arm.inverse_dynamics(*rows) for rows in zip(q, v, a, strict=True)]
    )
    friction = 0.3 * np.sign(v) + 0.1 * v
    readings = clean + friction + 1e-4 * rng.normal(size=clean.shape)
    read = calibrate.session(sensor, q, readings, v=v, a=a)
    found = calibrate.fit(read, prior="loose")
    assert found.problems == ()
    number = found.names.index("links.link_2.inertia.zz")
    assert found.deviation[number] < 0.9 * found.prior[number]
    others = dict(zip(found.other_names, found.other_estimate, strict=True))
    assert np.isclose(others["0.Coulomb.axis_d"], 0.3, atol=0.01)
    assert np.isclose(others["0.viscous.axis_c"], 0.1, atol=0.01)


def test_weight_alone_tells_the_whole_mass() -> None:
    planned = calibrate.session(calibrate.weight(noise=1e-4), random_q(2))
    heavy = np.full((2, 1), sum(link.mass for link in a5.parameters().links) + 0.02)
    found = calibrate.fit(calibrate.with_readings(planned, heavy), prior="loose")
    assert found.problems == ()
    total = sum(link.mass for link in found.arm.links)
    assert np.isclose(total, heavy[0, 0], atol=0.003)
    with pytest.raises(InputError, match="pulls somewhere"):
        calibrate.weight(gravity=[5e-324, 0.0, 0.0])


# --- problems -------------------------------------------------------------------------

FAULTS = {
    "unit": lambda y: 1000.0 * y,
    "scale": lambda y: 1.05 * y,
    "reading": lambda y: y + 0.02 * (np.arange(36).reshape(12, 3) == 10),
    "pose": lambda y: y + np.outer(np.arange(12) == 4, [0.05, -0.04, -0.01]),
    "order": lambda y: y[[0, 1, 7, 3, 4, 5, 6, 2, 8, 9, 10, 11]],
    "channels": lambda y: y[:, [1, 0, 2]],
}


@pytest.fixture(scope="module")
def readings_of_an_arm() -> tuple[calibrate.Session, Any]:
    rng = np.random.default_rng(7)
    planned = twelve_poses()
    return planned, weighed(planned, true_arm("digits", rng), rng)


@pytest.mark.slow
@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_named_first(
    name: str, readings_of_an_arm: tuple[calibrate.Session, Any]
) -> None:
    planned, readings = readings_of_an_arm
    assert calibrate.fit(calibrate.with_readings(planned, readings)).problems == ()
    faulty = calibrate.with_readings(planned, FAULTS[name](readings))
    found = calibrate.fit(faulty)
    assert found.problems[0].name == name
    changed = (faulty.readings - readings) / planned.sensor.noise
    assert 9.0 < found.problems[0].gain < 1.5 * (changed**2).sum()
    assert str(found).startswith(f"problem 1: {name} (session): ")
    assert found.text().startswith(f"# problem 1: {name}")


@pytest.mark.slow
def test_late_and_reversed_readings_are_out_of_order(
    readings_of_an_arm: tuple[calibrate.Session, Any],
) -> None:
    planned, readings = readings_of_an_arm
    for wrong, words in (
        (np.roll(readings, 1, axis=0), "late by one pose"),
        (readings[::-1], "in the reverse order"),
    ):
        found = calibrate.fit(calibrate.with_readings(planned, wrong))
        assert words in found.problems[0].message


def test_the_wrong_fluid_is_named() -> None:
    rng = np.random.default_rng(8)
    planned = calibrate.plan_poses(
        SENSOR["force-torque"], 6, fluid_density=a5.FRESH_WATER
    )
    readings = weighed(planned, true_arm("digits", rng), rng)
    said = replace(planned, density=a5.AIR)
    found = calibrate.fit(calibrate.with_readings(said, readings))
    assert found.problems[0].name == "fluid"
    assert "fresh water" in found.problems[0].message


@pytest.mark.slow
def test_a_heavier_link_contradicts_the_digits() -> None:
    rng = np.random.default_rng(9)
    arm = a5.parameters()
    links = list(arm.links)
    links[2] = replace(links[2], mass=1.2 * links[2].mass)
    planned = twelve_poses()
    readings = weighed(planned, replace(arm, links=tuple(links)), rng)
    found = calibrate.fit(calibrate.with_readings(planned, readings))
    assert found.problems[0].name == "mass of link_2"
    assert (
        "0.456 kg" in found.problems[0].message or "0.45" in found.problems[0].message
    )


def test_a_zero_beyond_its_prior_is_named() -> None:
    rng = np.random.default_rng(10)
    unknowns = arm_unknowns(a5.parameters())
    values = unknowns.middle.copy()
    values[NAMES.index("zeros.axis_d")] = np.radians(-8.0)
    planned = twelve_poses()
    readings = weighed(planned, unknowns.record(values), rng)
    found = calibrate.fit(calibrate.with_readings(planned, readings))
    assert found.problems[0].name == "zero"
    assert "axis_d reports +" in found.problems[0].message


# --- files ----------------------------------------------------------------------------


@pytest.mark.parametrize("kind", SENSOR)
def test_a_plan_reads_back(kind: str, tmp_path: Path) -> None:
    planned = calibrate.session(SENSOR[kind], random_q(4), fluid_density=a5.SEA_WATER)
    readings = np.arange(4.0 * planned.sensor.size).reshape(4, -1) / 7
    readings[1] = np.nan
    path = tmp_path / "plan.toml"
    path.write_text(
        calibrate.session_text(calibrate.with_readings(planned, readings)), "utf-8"
    )
    again = calibrate.read_session(path)
    assert np.allclose(again.readings, readings, rtol=1e-9, equal_nan=True)
    assert np.allclose(again.motion.q, planned.motion.q, atol=np.radians(0.006))
    assert again.density == planned.density
    for name in ("kind", "channels", "placement"):
        assert getattr(again.sensor, name) == getattr(planned.sensor, name)
    for name in ("matrix", "noise", "gain", "offset"):
        ours = getattr(planned.sensor, name)
        assert np.allclose(getattr(again.sensor, name), ours, rtol=1e-5, atol=1e-12)
    # A vehicle's tilt has tests of its own.
    assert SENSORS.keys() == SENSOR.keys() | {"vehicle-tilt"}


GOOD = """format = 1
sensor = "scales"
[[pose]]
angles = [10, 90, 90, 0]
readings = [500, 400, 372]
"""
#: What is replaced, by what, and the message after the file's name.
WRONG_FILES = (
    ("format = 1", "format = 2", ", format: this version reads format = 1"),
    ("format = 1", "", ", format: missing"),
    ('"scales"', '"scale"', ", sensor: 'scale'; choose from"),
    ('"scales"', "3", ", sensor: 3; choose from"),
    ("angles", "angle", ", pose 1: angle: unknown; choose from angles, readings"),
    ("[10, 90, 90, 0]", "[10, 90, 90]", ", pose 1: angles: expected 4 numbers: axis_e"),
    ("[10, 90, 90, 0]", "[10, 90, 90, nan]", ", pose 1: angles: nan; expected"),
    ("[500, 400, 372]", "[500, 400]", ", pose 1: readings: expected 3 numbers"),
    ("[500, 400, 372]", "[500, 400, '372']", ", pose 1: readings: '372'; expected"),
    ("[500, 400, 372]", "[500, 400, inf]", ", pose 1: readings: inf; expected"),
    ("[[pose]]", 'unit = "oz"\n[[pose]]', ', unit: \'oz\'; choose from "g", "kg"'),
    ("[[pose]]", 'fluid = "oil"\n[[pose]]', ", fluid: 'oil'; choose from \"air\""),
    ("[[pose]]", "fluid = -3\n[[pose]]", "fluid_density: expected"),
    ("[[pose]]", "gravity = [9.81, 0, 0]\n[[pose]]", "gravity at a right angle"),
    ("[[pose]]", "[settings]\nnoise = 0\n[[pose]]", ", settings: noise: expected"),
    ("[[pose]]", "[settings]\nnosie = 1\n[[pose]]", "settings: nosie: unknown"),
    ("[[pose]]", "[settings]\npositions = [[0,0,0],[1,0,0],[2,0,0]]\n[[pose]]", "line"),
    ("[[pose]]", "[poses]", ", poses: unknown; choose from format, sensor"),
)


@pytest.mark.parametrize(("old", "new", "message"), WRONG_FILES)
def test_a_wrong_file_gets_one_line(
    old: str, new: str, message: str, tmp_path: Path
) -> None:
    path = tmp_path / "plan.toml"
    path.write_text(GOOD, "utf-8")
    assert calibrate.read_session(path).readings[0, 0] == 0.5
    path.write_text(GOOD.replace(old, new, 1), "utf-8")
    with pytest.raises(FileFormatError) as caught:
        calibrate.read_session(path)
    assert message in str(caught.value)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


# --- refusals -------------------------------------------------------------------------


def test_what_is_refused() -> None:
    planned = calibrate.plan_poses(SENSOR["efforts"], 2)
    with pytest.raises(InputError, match="at least one session with readings"):
        calibrate.fit(planned)
    with pytest.raises(InputError, match="sessions"):
        calibrate.fit([])
    read = calibrate.with_readings(planned, np.ones((2, 4)))
    with pytest.raises(UnknownNameError, match="choose from digits, loose"):
        calibrate.fit(read, prior="tight")
    with pytest.raises(InputError, match="fit all sessions together"):
        calibrate.fit(read, arm=calibrate.fit(read).arm)
    with pytest.raises(InputError, match="at least 1"):
        calibrate.plan_poses(SENSOR["efforts"], 0)
    with pytest.raises(InputError, match="gravity at a right angle"):
        calibrate.session(calibrate.scales(), random_q(1), gravity=(0.0, 9.81, 0.0))
    with pytest.raises(InputError, match="three points"):
        calibrate.scales([[0, 0, 0], [0.1, 0.0, 0.0], [0.2, 0.001, 0.0]])
    with pytest.raises(InputError, match="readings"):
        calibrate.session(SENSOR["weight"], random_q(2), np.ones((3, 1)))
    with pytest.raises(InputError, match="at least one pose"):
        calibrate.session(SENSOR["weight"], np.empty((0, 4)))
    assert LOADS == 10


# --- the covariance in the rest of the package ----------------------------------------


def calibrated(prior: str) -> calibrate.Calibration:
    rng = np.random.default_rng(11)
    planned = twelve_poses(prior)
    readings = weighed(planned, true_arm(prior, rng), rng)
    return calibrate.fit(calibrate.with_readings(planned, readings), prior=prior)


@pytest.mark.slow
def test_bounds_are_those_of_the_ellipsoid() -> None:
    found = calibrated("loose")
    q = random_q(3, seed=12)
    loaded = a5.load(a5.AIR, arm=found.arm)
    lower, upper = a5.uncertainty.bounds(q, 0 * q, 0 * q, loaded).torque
    ours = WIDTH * torque_deviation(found, q, a5.AIR)
    assert np.allclose((upper - lower) / 2, ours, rtol=1e-5, atol=1e-9)
    # One by one, the numbers leave far more.
    without = a5.load(a5.AIR, arm=replace(found.arm, covariance=None))
    lower, upper = a5.uncertainty.bounds(q, 0 * q, 0 * q, without).torque
    assert ((upper - lower)[:, 1] / 2 > 10.0 * ours[:, 1]).all()


@pytest.mark.slow
def test_samples_and_spread_use_the_covariance() -> None:
    found = calibrated("digits")
    arm = found.arm
    assert arm.covariance is not None
    q = random_q(1, seed=12)

    def torque(record: Alpha5Parameters) -> Any:
        return a5.uncertainty.arm(record, a5.AIR).hydrostatic_torque(q[0])[1:3]

    spread = a5.uncertainty.spread(torque, n=200, arm=arm).standard_deviation
    assert np.allclose(spread, torque_deviation(found, q, a5.AIR)[0, 1:3], rtol=0.2)
    without = replace(arm, covariance=None)
    alone = a5.uncertainty.spread(torque, n=50, arm=without).standard_deviation
    assert alone[0] > 1.5 * spread[0]

    drawn = a5.uncertainty.sample(4000, arm=arm, distribution="normal")
    names = ["zeros.axis_d", "links.link_2.mass"]
    printed = [name.removeprefix("links.") for name in names]
    columns = [drawn.values[:, drawn.names.index(name)] for name in printed]
    place = [arm.covariance.names.index(name) for name in names]
    ours = arm.covariance.matrix[np.ix_(place, place)]
    size = np.sqrt(np.outer(np.diag(ours), np.diag(ours)))
    assert (np.abs(np.cov(columns) - ours) < 0.08 * size).all()
