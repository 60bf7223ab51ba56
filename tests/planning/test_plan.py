"""Planned motions: free by coal, within limits by replays, no slower than others."""

from __future__ import annotations

import contextlib
import dataclasses
import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import own_arm_dynamics as own
import pinocchio as pin
import pytest
from coal_world import CoalWorld, samples
from fk import fk, tip
from own_arm import tips, with_tool
from reference import LOWER, UPPER

import alpha5_model as a5
from alpha5_model.errors import (
    BlockedMotionError,
    InputError,
    JointLimitError,
    MotionLimitError,
    UnreachableError,
)
from alpha5_model.numbers.motors import Motors
from alpha5_model.planning import Obstacle, PlannedMotion, plan
from alpha5_model.planning.goals import goals, target_of
from alpha5_model.planning.s_curve import JointLimits, travel_time

HOME = a5.named_pose("home")
RATED = np.array([joint.velocity for joint in a5.parameters().joints[:4]])
LIMITS = JointLimits(speed=RATED, acceleration=np.ones(4))
HULL = Obstacle.box("hull", (0.457, 0.338, 0.254), (-0.2, 0.0, -0.14))
POST = Obstacle.cylinder("post", 0.03, 1.0, (0.22, 0.15, 0.0))
SCENE = (HULL, POST)


def targets(world: CoalWorld, count: int, seed: int) -> list[np.ndarray]:
    """Points that some branch reaches free, with the wrist of home."""
    rng = np.random.default_rng(seed)
    found: list[np.ndarray] = []
    while len(found) < count:
        point = rng.uniform(-0.4, 0.4, 3)
        solutions = a5.inverse_kinematics(point, HOME[3])
        q = solutions.q[solutions.within_limits]
        if any(world.distances(row).min() > 0.006 for row in q):
            found.append(point)
    return found


def is_free(world: CoalWorld, start: np.ndarray, end: np.ndarray, step: float) -> bool:
    """By coal, at steps of so many degrees."""
    return not any(map(world.touches, samples(start, end, math.radians(step))))


def check_replay(motion: PlannedMotion, folder: Path) -> None:
    """The file of a motion is within all limits, by the package's own analysis."""
    path = motion.write(folder / "motion.csv")
    read = a5.trajectory.read_motion(path, arm=motion.analysis.arm.parameters)
    assert np.array_equal(read.position, motion.position)
    replay = a5.trajectory.analyse(read, motion.analysis.arm, method="interpolate")
    joints = motion.analysis.arm.parameters.joints[:4]
    for k, joint in enumerate(joints):
        speed = np.abs(replay.smooth.velocity[:, k]).max()
        assert speed <= joint.velocity * (1 + 1e-9)
        assert np.abs(replay.torque[:, k]).max() <= joint.effort
        assert read.position[:, k].min() >= joint.lower - 1e-9
        assert read.position[:, k].max() <= joint.upper + 1e-9


def test_random_targets_of_the_arm_alone(tmp_path: Path) -> None:
    world = CoalWorld()
    q = HOME
    for point in targets(world, 12, seed=1):
        motion = plan(q, point)
        assert tip(motion.position[-1]) == pytest.approx(point, abs=1e-9)
        assert np.array_equal(motion.position[0], q)
        assert not motion.velocity[[0, -1]].any()
        for start, end in pairwise(motion.way):
            assert is_free(world, start, end, step=3)
        check_replay(motion, tmp_path)
        q = motion.position[-1]


@pytest.mark.slow
def test_random_targets_beside_a_vehicle(tmp_path: Path) -> None:
    world = CoalWorld(obstacles=SCENE)
    kinds = set()
    q = HOME
    for point in targets(world, 25, seed=2):
        motion = plan(q, point, obstacles=SCENE)
        kinds.add(motion.kind)
        assert tip(motion.position[-1]) == pytest.approx(point, abs=1e-9)
        for row in motion.position[:: 1 + len(motion.time) // 8]:
            assert world.obstacle_distance(row) > 0.005 - 1e-5
        q = motion.position[-1]
    assert {"straight", "by retracted poses"} <= kinds
    check_replay(motion, tmp_path)


@pytest.mark.slow
def test_retracted_ways_are_free_at_a_tenth_of_a_degree() -> None:
    world = CoalWorld(obstacles=SCENE)
    start = np.array([4.5, 1.5, 2.6, 1.5])
    end = np.array([2.9, 1.5, 2.6, 1.5])
    assert not is_free(world, start, end, step=2)
    motion = plan(start, end, obstacles=SCENE)
    assert motion.kind == "by retracted poses"
    assert len(motion.way) > 2
    for one, other in pairwise(motion.way):
        assert is_free(world, one, other, step=0.1)
    on_way = [
        np.abs(motion.position - corner).max(axis=1).min() for corner in motion.way
    ]
    assert max(on_way) < 0.01


@pytest.mark.slow
def test_the_quickest_free_branch_by_brute_force() -> None:
    """Of all branches whose line coal finds free at steps of a degree."""
    world = CoalWorld(obstacles=[POST])
    others = 0
    for point in targets(world, 15, seed=4):
        solutions = a5.inverse_kinematics(point, HOME[3])
        times = []
        for q in solutions.q[solutions.within_limits]:
            near = world.distances(q).min() <= 0.005
            if not near and is_free(world, HOME, q, step=1):
                times.append(travel_time(np.array([HOME, q]), LIMITS))
        motion = plan(HOME, point, obstacles=[POST], margin=0.0, wrist=HOME[3])
        if motion.kind == "by retracted poses":
            continue
        assert motion.duration == pytest.approx(min(times), rel=1e-9)
        others += motion.kind == "another branch"
        assert motion.branch in a5.BRANCHES
    assert others


def test_the_other_way_round_the_gap_of_axis_e() -> None:
    """The gap is near theta_0 = 0. Across it, the arm facing away is quicker."""
    q0 = np.array([0.3, 1.6, 2.2, 1.5])
    azimuth = math.atan2(*tip(q0)[1::-1])
    beyond = azimuth - 0.6
    point = [0.12 * math.cos(beyond), 0.12 * math.sin(beyond), 0.2]
    motion = plan(q0, point)
    turn = abs(motion.way[-1][0] - q0[0])
    facing = a5.inverse_kinematics(point, q0[3])
    turns = np.abs(facing.q[facing.within_limits][:, 0] - q0[0])
    assert turns.max() > math.pi
    assert turn == pytest.approx(turns.min())
    assert "overarm" in str(motion.branch)


def test_a_pose_is_reached() -> None:
    q = np.array([2.0, 1.4, 2.0, 1.0])
    motion = plan(HOME, pin.SE3(fk(q)))
    assert fk(motion.position[-1]) == pytest.approx(fk(q), abs=1e-7)
    assert plan(HOME, fk(q)).way == pytest.approx(motion.way)


def test_joint_positions_are_reached() -> None:
    q = np.array([2.0, 1.4, 2.0, 1.0])
    motion = plan(HOME, q)
    assert np.array_equal(motion.position[-1], q)
    assert motion.branch is None
    still = plan(q, q)
    assert still.duration < 0.2
    assert not still.velocity.any()


def test_the_wrist_angle_is_that_of_the_start_or_as_given() -> None:
    point = [0.2, 0.1, 0.15]
    assert plan(HOME, point).way[-1][3] == HOME[3]
    assert plan(HOME, point, wrist=3.0).way[-1][3] == 3.0
    with pytest.raises(JointLimitError):
        plan(HOME, point, wrist=6.25)


def test_another_wrist_angle_if_that_of_the_start_is_not_free() -> None:
    """A narrow slot, which the closed jaws pass at some angles only."""
    point = tip(np.array([math.pi, 1.2, 2.4, 0.0]))
    start = np.array([2.0, 1.2, 2.4, 0.0])
    wide = start + np.array([0.0, 0.0, 0.0, math.pi / 2])
    for distance in np.linspace(0.01, 0.06, 51):
        sideways = np.array([0.0, distance, 0.0])
        walls = [
            Obstacle.box(f"wall {side}", (0.04, 0.002, 0.04), point + side * sideways)
            for side in (-1, 1)
        ]
        free = [reaches(q, point, walls, wrist=q[3]) for q in (start, wide)]
        if free[0] != free[1]:
            break
    else:
        pytest.fail("no slot for one wrist angle only")
    blocked = wide if free[0] else start
    motion = plan(blocked, point, obstacles=walls)
    assert motion.way[-1][3] != blocked[3]
    assert tip(motion.way[-1]) == pytest.approx(point, abs=1e-9)


def reaches(q0: np.ndarray, point: np.ndarray, walls: list, wrist: float) -> bool:
    """Whether a motion with this wrist angle at its end is found."""
    try:
        plan(q0, point, obstacles=walls, wrist=wrist)
    except BlockedMotionError:
        return False
    return True


def test_speed_and_acceleration_are_kept() -> None:
    motion = plan(HOME, [0.2, 0.2, 0.1], speed=0.2, acceleration=0.3)
    assert np.abs(motion.velocity).max() == pytest.approx(0.2)
    assert np.abs(motion.acceleration).max() <= 0.3 + 1e-9
    one = [0.1, 0.5, 0.5, 9.0]
    motion = plan(HOME, [0.2, 0.2, 0.1], speed=one, acceleration=[1, 2, 3, 4])
    assert (np.abs(motion.velocity).max(axis=0) <= np.minimum(one, RATED) + 1e-12).all()


def test_motors_slow_a_motion_down() -> None:
    """A supply at which the rated speed is out of reach."""
    point = [0.2, 0.2, 0.1]
    free = plan(HOME, point)
    voltage = {p.joint: p.value for p in free.peaks if p.quantity == "voltage"}
    supply = 0.8 * max(voltage.values())
    motion = plan(HOME, point, supply_voltage=supply, current_limit=1.0)
    assert motion.slowed > 1.0
    assert motion.duration > free.duration
    assert np.abs(motion.analysis.voltage).max() <= supply
    replay = a5.trajectory.analyse(
        motion.motion, method="interpolate", supply_voltage=supply, current_limit=1.0
    )
    assert np.abs(replay.voltage).max() <= supply
    limits = replay.torque_limits
    assert limits is not None
    assert (replay.torque <= limits.upper).all()
    assert (replay.torque >= limits.lower).all()


def test_a_limit_that_no_speed_keeps_is_named() -> None:
    with pytest.raises(MotionLimitError, match=r"axis_.: .* current of .* A") as caught:
        plan(HOME, [0.2, 0.2, 0.1], supply_voltage=24.0, current_limit=0.15)
    error = caught.value
    assert error.quantity == "current"
    assert error.value > error.bound == 0.15


def test_a_torque_that_no_speed_keeps_is_named() -> None:
    weak = [dataclasses.replace(j, effort=0.05) for j in a5.parameters().joints]
    record = dataclasses.replace(a5.parameters(), joints=tuple(weak))
    with pytest.raises(MotionLimitError, match=r"axis_d: .* torque .* N m") as caught:
        plan(HOME, [0.2, 0.2, 0.1], arm=record)
    assert caught.value.bound == 0.05


def test_a_joint_without_speed_cannot_move() -> None:
    fixed = dataclasses.replace(a5.parameters().joints[0], velocity=0.0)
    joints = (fixed, *a5.parameters().joints[1:])
    record = dataclasses.replace(a5.parameters(), joints=joints)
    with pytest.raises(InputError, match=r"axis_e\.velocity: expected a speed above"):
        plan(HOME, [0.2, 0.2, 0.1], arm=record)


def test_a_joint_without_speed_may_rest() -> None:
    """Nothing can be said of the slope of its positions: there is none."""
    fixed = dataclasses.replace(a5.parameters().joints[0], velocity=0.0)
    joints = (fixed, *a5.parameters().joints[1:])
    record = dataclasses.replace(a5.parameters(), joints=joints)
    goal = HOME + np.array([0.0, 0.2, 0.1, 0.3])
    motion = plan(HOME, goal.tolist(), arm=record)
    assert np.ptp(motion.position[:, 0]) == 0.0
    np.testing.assert_allclose(motion.position[-1], goal, rtol=0, atol=1e-9)


def test_peaks_say_what_is_left() -> None:
    motion = plan(HOME, [0.2, 0.2, 0.1], supply_voltage=24.0, current_limit=2.0)
    table = {(p.joint, p.quantity): p for p in motion.peaks}
    assert len(table) == 16
    for k, joint in enumerate(a5.parameters().joints[:4]):
        torque = table[joint.name, "torque"]
        assert torque.value == np.abs(motion.analysis.torque[:, k]).max()
        assert torque.limit == joint.effort
        assert table[joint.name, "voltage"].limit == 24.0
        assert table[joint.name, "current"].limit == 2.0
    assert not any(p.is_beyond for p in motion.peaks)
    unknown = plan(HOME, [0.2, 0.2, 0.1]).peaks
    limits = [p.limit for p in unknown if p.quantity in ("current", "voltage")]
    assert np.isnan(limits).all()


def test_what_blocks_is_named() -> None:
    wall = Obstacle.box("wall", (0.01, 2.0, 2.0), (0.3, 0.0, 0.0))
    inside = a5.inverse_kinematics([0.2, 0.1, 0.1]).best(HOME)
    with pytest.raises(BlockedMotionError, match="target is not free: wall and link_4"):
        plan(inside, [0.3, 0.0, 0.05], obstacles=[wall])
    with pytest.raises(BlockedMotionError, match="q0 is not free: wall and") as caught:
        plan(HOME, inside, obstacles=[wall])
    assert caught.value.names[0] == "wall"
    assert caught.value.distance <= 0.005
    # Too near to the yaw axis for any retracted pose.
    cage = [
        Obstacle.box(f"bar {side}", (0.01, 0.5, 2.0), (0.0, side * 0.31, 0.0))
        for side in (-1, 1)
    ]
    cage.append(Obstacle.box("bar 0", (0.01, 1.0, 1.0), (0.0, 0.0, 0.67)))
    start = np.array([math.pi, 1.5, 2.5, 1.5])
    message = r"on the straight line: bar -?[01] and link_. are"
    with pytest.raises(BlockedMotionError, match=message) as hit:
        plan(start, np.array([0.02, 1.5, 2.5, 1.5]), obstacles=cage)
    world = CoalWorld(obstacles=cage)
    assert world.obstacle_distance(hit.value.q) == pytest.approx(
        hit.value.distance, abs=1e-5
    )


def test_a_target_in_the_arm_itself_is_named() -> None:
    with pytest.raises(BlockedMotionError, match="link_0 and link_4"):
        plan(HOME, np.zeros(4) + 0.02)


def test_unreachable_targets_say_so() -> None:
    with pytest.raises(UnreachableError):
        plan(HOME, [1.0, 0.0, 0.0])
    with pytest.raises(JointLimitError, match="axis_e"):
        plan(HOME, [7.0, 1.0, 1.0, 1.0])
    with pytest.raises(JointLimitError, match="axis_c"):
        plan([1.0, 1.0, -0.2, 1.0], [0.2, 0.1, 0.1])


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 4])
def test_arms_of_ones_own(seed: int, tmp_path: Path) -> None:
    record = own.random_record(seed)
    world = CoalWorld(record, [POST])
    model = a5.load(arm=record)
    lower = np.array([joint.lower for joint in record.joints[:4]])
    upper = np.array([joint.upper for joint in record.joints[:4]])
    rng = np.random.default_rng(seed)
    free = []
    while len(free) < 4:
        q = rng.uniform(lower, upper)
        if world.distances(q).min() > 0.01:
            free.append(q)
    for start, end in pairwise(free):
        point = model.forward_kinematics(end).translation
        motion = plan(start, point, arm=record, obstacles=[POST], wrist=end[3])
        reached = model.forward_kinematics(motion.position[-1]).translation
        assert reached == pytest.approx(point, abs=1e-8)
        check_replay(motion, tmp_path)
        for one, other in pairwise(motion.way):
            assert is_free(world, one, other, step=5)


def test_the_record_of_an_arm_has_its_motors() -> None:
    motors = Motors(supply_voltage=6.0, current_limits=(1.0,) * 5)
    record = dataclasses.replace(a5.parameters(), motors=motors)
    motion = plan(HOME, [0.2, 0.2, 0.1], arm=record)
    assert motion.slowed > 1.0
    assert np.abs(motion.analysis.voltage).max() <= 6.0


def test_an_arm_with_a_payload_in_air() -> None:
    arm = a5.load(a5.AIR).with_payload(0.5)
    motion = plan(HOME, [0.2, 0.2, 0.1], arm=arm)
    assert motion.analysis.arm is arm
    heavier = np.abs(motion.analysis.torque).max()
    assert heavier > 2 * np.abs(plan(HOME, [0.2, 0.2, 0.1]).analysis.torque).max()


BAD: list[tuple[dict[str, object], str]] = [
    ({"q0": [1.0, 1.0]}, "q0"),
    ({"q0": [[1.0, 1.0, 1.0, 1.0]]}, "q0: expected four joint positions"),
    ({"target": [1.0, 1.0]}, r"target: expected a point \(3,\)"),
    ({"target": "there"}, "target"),
    ({"target": np.ones((4, 4))}, "rigid"),
    ({"speed": 0.0}, "speed: expected one number above 0, or four"),
    ({"speed": [1, 1, 1]}, "speed"),
    ({"acceleration": [1, 1, 1, -1]}, "acceleration"),
    ({"speed": 1e-7}, "speed, acceleration: expected ones with which the motion"),
    ({"speed": 1e-300}, "speed: expected at least 1e-08"),
    ({"margin": -0.1}, "margin"),
    ({"wrist": 1.0, "target": HOME}, "wrist: expected no value"),
    ({"obstacles": 3}, "obstacles"),
    ({"obstacles": [3]}, r"obstacles\[0\]"),
    ({"obstacles": [POST, POST]}, "names that differ"),
    ({"arm": 3}, "arm"),
    ({"arm": a5.load(gripper="jaws")}, "closed jaws"),
    ({"arm": a5.load(floating_base=True)}, "fixed base"),
    ({"supply_voltage": 24.0}, "both or neither"),
]


@pytest.mark.parametrize(("changes", "message"), BAD, ids=range(len(BAD)))
def test_bad_input(changes: dict[str, object], message: str) -> None:
    given: dict[str, object] = {"q0": HOME, "target": [0.2, 0.1, 0.1]}
    with pytest.raises(InputError, match=message):
        plan(**(given | changes))  # type: ignore[arg-type]


def test_limits_are_those_of_the_reference() -> None:
    """The joint range of the plan's checks, against the retyped table."""
    for k in range(4):
        for bound in (LOWER[k] - 1e-3, UPPER[k] + 1e-3):
            q = np.array([3.0, 1.5, 1.5, 1.5])
            q[k] = bound
            with pytest.raises(JointLimitError):
                plan(HOME, q)


def test_the_file_is_a_motion_and_nothing_else(tmp_path: Path) -> None:
    motion = plan(HOME, [0.2, 0.1, 0.1])
    path = motion.write(tmp_path / "motion.csv")
    head, *rows = path.read_text().splitlines()
    assert head.split(",")[:4] == [
        "time_secs",
        "axis_e_pos",
        "axis_e_vel",
        "axis_e_acc",
    ]
    table = np.array([row.split(",") for row in rows], float)
    assert np.array_equal(table[:, 0], motion.time)
    assert np.array_equal(table[:, 1::3], motion.position)
    assert np.array_equal(table[:, 2::3], motion.velocity)
    assert np.array_equal(table[:, 3::3], motion.acceleration)
    with pytest.raises(ValueError, match="motion format"):
        motion.write(tmp_path / "motion.txt")


def test_a_target_on_the_yaw_axis_keeps_theta_0() -> None:
    q0 = np.array([2.5, 1.2, 1.6, 0.4])
    heights = np.linspace(-0.3, 0.45, 200)
    points = np.column_stack([np.zeros((200, 2)), heights])
    reached = points[a5.reachable(points)]
    assert len(reached)
    for found in goals(target_of("target", reached[0]), q0, None, a5.parameters()):
        assert found.q[0] == q0[0]
        assert tip(found.q) == pytest.approx(reached[0], abs=1e-9)


def test_a_tool_beside_the_wrist_axis_reaches_at_another_wrist_angle() -> None:
    """Points that positions of the whole range reach, by the DH product."""
    arm = with_tool(0.06, 0.0, -0.18)
    rng = np.random.default_rng(4)
    lower = [joint.lower for joint in arm.joints[:4]]
    upper = [joint.upper for joint in arm.joints[:4]]
    found = 0
    for point in tips(arm, rng.uniform(lower, upper, (20, 4))):
        with contextlib.suppress(BlockedMotionError):
            motion = plan(HOME, point, arm=arm)
            assert tips(arm, motion.position[-1:])[0] == pytest.approx(point, abs=1e-9)
            found += 1
    assert found > 15


@pytest.mark.parametrize("line", [False, True])
def test_samples_at_a_wanted_rate_keep_the_limits(line: bool) -> None:
    start = a5.inverse_kinematics([0.10, 0.25, 0.05]).best(HOME)
    target = [0.30, -0.10, 0.15]
    motion = plan(start, target, rate=100.0, line=line, speed=0.3, acceleration=0.5)
    assert np.diff(motion.time) == pytest.approx(0.01, abs=1e-12)
    assert np.abs(np.diff(motion.position, axis=0)).max() <= 0.3 * 0.01 * (1 + 1e-9)
    assert np.abs(motion.velocity).max() <= 0.3
    assert np.abs(motion.acceleration).max() <= 0.5
    # Velocity is the slope of position, also after the motion was made longer.
    slope = np.gradient(motion.position, motion.time, axis=0)
    assert np.abs(slope - motion.velocity)[2:-2].max() < 3e-3
    usual = plan(start, target, line=line, speed=0.3, acceleration=0.5)
    assert 0.0 <= motion.duration - usual.duration < 0.01 + 1e-9


def test_a_rate_with_too_many_samples() -> None:
    for rate in (0.0, -5.0, 1e9, math.nan):
        with pytest.raises(InputError) as caught:
            plan(HOME, [0.2, 0.2, 0.1], rate=rate)
        assert caught.value.name == "rate"


def test_arrays_of_a_motion_cannot_be_written() -> None:
    motion = plan(HOME, [0.2, 0.2, 0.1])
    for array in (motion.time, motion.position, motion.velocity, motion.acceleration):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0.0


def test_the_least_clearance_is_named() -> None:
    motion = plan(HOME, [0.05, 0.25, 0.20], obstacles=SCENE)
    world = CoalWorld(obstacles=SCENE)
    distances = [world.obstacle_distance(q) for q in motion.position]
    clearance = motion.clearance
    assert clearance is not None
    assert clearance.distance == pytest.approx(min(distances), abs=2e-6)
    assert clearance.sample == int(np.argmin(distances))
    assert clearance.obstacle in {"hull", "post"}
    assert clearance.distance >= 0.005
    assert plan(HOME, [0.2, 0.2, 0.1]).clearance is None


@pytest.mark.parametrize("name", ["speed", "acceleration"])
def test_a_limit_that_overflows_is_refused(name: str) -> None:
    with pytest.raises(InputError) as caught:
        plan(HOME, [0.2, 0.2, 0.1], **{name: 1e308})
    assert caught.value.name == name
