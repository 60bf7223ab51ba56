"""Corners that a motion passes without a stop: how far, how fast, free of collision.

Distances are those of the tests' own forward kinematics, limits are checked by finite
differences, and collisions by coal at every twentieth of a degree.
"""

from __future__ import annotations

import math
from functools import cache
from types import SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest
from coal_world import CoalWorld
from fk import fk
from motion_checks import at, check_limits
from own_arm import with_tool

import alpha5_model as a5
from alpha5_model.errors import BlockedMotionError, ImplausibleWarning, InputError
from alpha5_model.planning import Obstacle, PlannedMotion

HOME = a5.named_pose("home")
#: The joints go on turning the same way at the first corner, and back at the second.
GENTLE = np.array([3.3, 1.0, 2.1, 1.2])
SHARP = np.array([3.9, 1.4, 1.8, 0.8])
END = np.array([3.4, 1.8, 2.2, 0.4])
#: Of the hand, beside the tcp, in its frame [m].
FINGER = np.array([0.03, 0.0, 0.0, 1.0])
LIMITS = a5.load().limits


@cache
def random_ways(count: int) -> list[np.ndarray]:
    """Ways through five free positions, with free lines between them."""
    rng = np.random.default_rng(5)
    found: list[np.ndarray] = []
    while len(found) < count:
        way = rng.uniform(LIMITS.lower, LIMITS.upper, (5, 4))
        try:
            motion = a5.plan(way[0], way[-1], through=way[1:-1])
        except BlockedMotionError:
            continue
        if len(motion.way) == len(way):
            found.append(way)
    return found


def passed_by(motion: PlannedMotion) -> list[float]:
    """How far tcp and finger are from their places when targets are passed [m]."""
    distances = []
    for stop in motion.stops:
        poses = [fk(at(motion, stop.time)), fk(stop.q)]
        apart = [
            np.linalg.norm((poses[0] @ point - poses[1] @ point)[:3])
            for point in (np.array([0.0, 0.0, 0.0, 1.0]), FINGER)
        ]
        distances.append(float(max(apart)))
    return distances


@pytest.mark.parametrize("rate", [None, 8.0])
@pytest.mark.parametrize("blend", [0.002, 0.02, 0.1])
def test_targets_are_passed_within_the_distance(blend: float, rate: float | None):
    sooner = []
    for way in random_ways(4):
        options = {"through": way[1:-1], "rate": rate}
        motion = a5.plan(way[0], way[-1], blend=blend, **options)
        resting = a5.plan(way[0], way[-1], **options)
        for distance, stop in zip(passed_by(motion), motion.stops, strict=True):
            assert distance <= stop.away + 1e-6
            assert stop.away <= blend
        assert motion.stops[-1].away == 0.0
        assert motion.position[-1] == pytest.approx(way[-1], abs=1e-12)
        sooner.append(resting.duration - motion.duration)
        if rate is None:
            check_limits(motion, acceleration=1.0)
    assert min(sooner) >= -1e-9
    assert max(sooner) > 0.2


def test_no_stop_where_the_joints_go_on() -> None:
    motion = a5.plan(HOME, SHARP, through=[GENTLE], blend=0.05)
    resting = a5.plan(HOME, SHARP, through=[GENTLE])

    def slowest(motion: PlannedMotion) -> float:
        """Between the first and the last half second [rad/s]."""
        inner = (motion.time > 0.5) & (motion.time < motion.duration - 0.5)
        return float(np.abs(motion.velocity[inner]).max(axis=1).min())

    assert slowest(resting) < 0.02
    assert slowest(motion) > 0.1


def test_without_it_the_arm_rests() -> None:
    plain = a5.plan(HOME, END, through=[GENTLE, SHARP])
    zero = a5.plan(HOME, END, through=[GENTLE, SHARP], blend=0.0)
    assert (plain.position == zero.position).all()
    assert [stop.away for stop in plain.stops] == [0.0] * 3


def test_there_and_back_it_reaches_the_corner() -> None:
    motion = a5.plan(HOME, HOME, through=[GENTLE], blend=0.1)
    assert passed_by(motion)[0] < 1e-3
    assert np.abs(motion.position - GENTLE).max(axis=1).min() < 2e-3
    check_limits(motion, acceleration=1.0)


def test_the_check_sees_lines_that_overlap_too_long() -> None:
    """Half of each line, without regard to accelerations, where joints turn back."""
    one, other = a5.plan(HOME, GENTLE, rate=50.0), a5.plan(GENTLE, HOME, rate=50.0)
    overlap = len(one.time) // 2
    position = np.vstack(
        [one.position, np.tile(GENTLE, (len(other.time) - overlap, 1))]
    )
    velocity = np.vstack([one.velocity, np.zeros((len(other.time) - overlap, 4))])
    position[-len(other.time) :] += other.position - GENTLE
    velocity[-len(other.time) :] += other.velocity
    naive = SimpleNamespace(
        time=0.02 * np.arange(len(position)), position=position, velocity=velocity
    )
    with pytest.raises(AssertionError):
        check_limits(naive, acceleration=1.0)


def test_a_corner_beside_an_obstacle_is_passed_nearer() -> None:
    """A ball that the hand touches if it cuts the corner, but not if it rests there."""
    ball = Obstacle.sphere("ball", 0.002, (0.3421, 0.0783, 0.0546))
    world = CoalWorld(obstacles=[ball])
    options = {"through": [GENTLE], "margin": 0.0005}

    def touches(motion: PlannedMotion) -> bool:
        count = math.ceil(motion.duration * math.radians(50) / math.radians(0.25))
        path = at(motion, np.linspace(0.0, motion.duration, count))
        return any(map(world.touches, path))

    wide = a5.plan(HOME, SHARP, blend=0.1, **options)
    assert touches(wide)
    assert not touches(a5.plan(HOME, SHARP, obstacles=[ball], **options))

    motion = a5.plan(HOME, SHARP, obstacles=[ball], blend=0.1, **options)
    assert motion.kind == "straight"
    assert not touches(motion)
    assert 0.0 < motion.stops[0].away < wide.stops[0].away
    check_limits(motion, acceleration=1.0)


@pytest.mark.slow
def test_corners_beside_obstacles_are_free_at_a_twentieth_of_a_degree() -> None:
    hull = Obstacle.box("hull", (0.457, 0.338, 0.254), (-0.2, 0.0, -0.14))
    post = Obstacle.cylinder("post", 0.03, 1.0, (0.22, 0.15, 0.0))
    world = CoalWorld(obstacles=[hull, post])
    through = [[0.3, 0.05, 0.1], [0.05, 0.25, 0.2]]
    target = [2.9, 1.5, 2.6, 1.5]
    for blend in (0.01, 0.2):
        motion = a5.plan(
            HOME, target, through=through, obstacles=[hull, post], blend=blend
        )
        assert max(stop.away for stop in motion.stops) > 0.005
        count = math.ceil(motion.duration * math.radians(50) / math.radians(0.05))
        path = at(motion, np.linspace(0.0, motion.duration, count))
        assert not any(map(world.touches, path))
        check_limits(motion, acceleration=1.0)


def test_a_tool_beyond_the_jaws_is_the_tcp() -> None:
    arm = a5.load(arm=with_tool(0.0, 0.0, -0.33))
    motion = a5.plan(HOME, END, through=[GENTLE, SHARP], arm=arm, blend=0.02)
    for stop in motion.stops:
        poses = [arm.forward_kinematics(q) for q in (at(motion, stop.time), stop.q)]
        apart = np.linalg.norm(poses[0].translation - poses[1].translation)
        assert apart <= stop.away + 1e-6
    assert 0.005 < max(stop.away for stop in motion.stops) <= 0.02


def test_slow_motors_stretch_the_same_path() -> None:
    options = {"through": [GENTLE, SHARP], "blend": 0.03}
    fast = a5.plan(HOME, END, **options)
    voltage = max(p.value for p in fast.peaks if p.quantity == "voltage")
    slow = a5.plan(
        HOME, END, supply_voltage=0.7 * voltage, current_limit=1.0, **options
    )
    assert slow.slowed > 1.0
    assert slow.duration == pytest.approx(slow.slowed * fast.duration)
    assert not any(peak.is_beyond for peak in slow.peaks)
    for one, other in zip(fast.stops, slow.stops, strict=True):
        assert other.time == pytest.approx(slow.slowed * one.time)
        assert other.away == one.away
    shares = np.linspace(0.0, 1.0, 200)
    path = at(fast, shares * fast.duration)
    assert at(slow, shares * slow.duration) == pytest.approx(path, abs=1e-5)


def test_targets_where_the_arm_is_already() -> None:
    still = a5.plan(HOME, HOME, through=[HOME], blend=0.01)
    assert not still.velocity.any()
    twice = a5.plan(HOME, END, through=[HOME, GENTLE, GENTLE], blend=0.01)
    assert twice.stops[0].time == 0.0
    assert twice.stops[1].time == twice.stops[2].time
    assert twice.stops[1].away > 0.0


def test_poses_are_passed_too() -> None:
    motion = a5.plan(HOME, END, through=[pin.SE3(fk(GENTLE))], blend=0.02)
    assert fk(motion.stops[0].q) == pytest.approx(fk(GENTLE), abs=1e-7)
    assert passed_by(motion)[0] <= 0.02


def test_mistakes_of_the_distance() -> None:
    for wrong in (-0.01, math.nan, "2 cm", [0.01]):
        with pytest.raises(InputError) as refused:
            a5.plan(HOME, END, through=[GENTLE], blend=wrong)
        assert refused.value.name == "blend"
    with pytest.raises(InputError) as refused:
        a5.plan(HOME, [0.25, 0.0, 0.1], line=True, blend=0.01)
    assert refused.value.name == "blend"
    with pytest.warns(ImplausibleWarning, match="blend"):
        a5.plan(HOME, END, through=[GENTLE], blend=20.0)
