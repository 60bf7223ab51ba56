"""Plans at their edges: limits, peaks, room beside a line, retracted poses, meshes."""

from __future__ import annotations

import logging
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from own_arm import tips
from reference import LOWER, UPPER, dh_frames

import alpha5_model as a5
from alpha5_model.errors import (
    BlockedMotionError,
    FileFormatError,
    InputError,
    JointLimitError,
    MotionLimitError,
)
from alpha5_model.geometry.primitives import Primitive
from alpha5_model.planning import Mesh, Obstacle, plan
from alpha5_model.planning.goals import joint_position, other_wrists, target_of
from alpha5_model.planning.obstacle_file import read_obstacles
from alpha5_model.planning.replay import Peak, worst
from alpha5_model.planning.retracted import _radii, retracted_poses
from alpha5_model.planning.s_curve import JointLimits, sampled, travel_time
from alpha5_model.planning.surroundings import Surroundings

ARM = a5.parameters()
HOME = a5.named_pose("home")
POINT = [0.2, 0.2, 0.1]
HOLD = np.array(LOWER[:4]), np.array(UPPER[:4])


# --- goals ----------------------------------------------------------------------------


def test_a_millionth_of_a_radian_beyond_a_limit_is_the_limit() -> None:
    lower, upper = HOLD
    for k in range(4):
        for bound, way in ((lower, -1.0), (upper, 1.0)):
            q = np.array([3.0, 1.5, 1.5, 1.5])
            q[k] = bound[k] + way * 0.9e-6
            assert joint_position("q", q, ARM)[k] == bound[k]
            q[k] = bound[k] + way * 1.1e-6
            with pytest.raises(JointLimitError):
                joint_position("q", q, ARM)


def test_other_wrists_are_even_over_the_range_from_near_to_far() -> None:
    q0 = np.array([3.0, 1.5, 1.5, 0.8])
    choices = other_wrists(target_of(POINT), q0, ARM)
    angles = [choice[0].q[3] for choice in choices]
    assert [{goal.q[3] for goal in choice} for choice in choices] == [
        {angle} for angle in angles
    ]
    away = np.abs(np.array(angles) - 0.8)
    assert (np.diff(away) >= 0).all()
    assert np.ptp(np.diff(sorted(angles))) < 1e-12
    assert [min(angles), max(angles)] == pytest.approx([LOWER[3], UPPER[3]])
    assert len(angles) > 4


# --- time -----------------------------------------------------------------------------


def test_a_motion_is_slowed_down_no_more_than_a_tenth_too_much() -> None:
    free = plan(HOME, POINT)
    fastest = max(p.value for p in free.peaks if p.quantity == "voltage")
    for share in (0.9, 0.5):
        supply = share * fastest
        motion = plan(HOME, POINT, supply_voltage=supply, current_limit=1.0)
        assert motion.slowed > 1.0
        reached = np.abs(motion.analysis.voltage).max()
        assert 0.85 * supply < reached <= supply
        longest = motion.slowed * free.duration
        assert 0.9 * longest < motion.duration <= longest


def test_a_motion_is_slowed_down_to_a_tenth_at_most() -> None:
    """By a supply that it needs at 0.106 or at 0.096 of its speed."""
    fastest = np.array([joint.velocity for joint in ARM.joints[:4]])
    for times, refused in ((9.4, False), (10.4, True)):
        slow = plan(HOME, POINT, speed=fastest / times, acceleration=1 / times**2)
        supply = max(p.value for p in slow.peaks if p.quantity == "voltage")
        if not refused:
            motion = plan(HOME, POINT, supply_voltage=supply, current_limit=1.0)
            assert times <= motion.slowed <= 10.0
            continue
        with pytest.raises(MotionLimitError, match="voltage"):
            plan(HOME, POINT, supply_voltage=supply, current_limit=1.0)


def test_a_motion_lasts_a_day_at_most() -> None:
    with pytest.raises(InputError, match=f"at most {24 * 3600} s, got '2"):
        plan(HOME, POINT, speed=4e-6, acceleration=1.0)


def test_a_joint_that_cannot_move_may_rest() -> None:
    q = HOME + np.array([0.0, 0.2, -0.2, 0.1])
    limits = JointLimits(speed=np.array([0.0, 1, 1, 1]), acceleration=np.ones(4))
    assert travel_time(np.array([HOME, q]), limits) < np.inf
    assert travel_time(np.array([HOME, HOME, HOME + 0.1]), limits) == np.inf


def test_samples_are_at_most_a_fiftieth_of_a_second_apart() -> None:
    limits = JointLimits(speed=np.ones(4), acceleration=np.ones(4))
    for angle in (0.01, 0.5, 3.0):
        way = np.array([np.zeros(4), np.full(4, angle)])
        samples = sampled(way, limits)
        assert 0.019 < samples.time[1] <= 0.02
        assert len(samples.time) == np.ceil(travel_time(way, limits) / 0.02) + 1
    still = sampled(np.zeros((2, 4)), limits)
    assert still.time[1] == 0.02
    # An acceleration builds up in a tenth of a second.
    rising = sampled(np.array([np.zeros(4), np.ones(4)]), limits)
    early = rising.time < 0.1 - 1e-9
    expected = rising.time[early] / 0.1
    assert rising.acceleration[early, 0] == pytest.approx(expected, abs=1e-9)


def peak(value: float, limit: float, joint: str = "axis_d") -> Peak:
    return Peak(joint=joint, quantity="torque", value=value, limit=limit, unit="N m")


def test_the_worst_peak_is_farthest_beyond_its_limit() -> None:
    within = [peak(2.0, 2.0), peak(9.0, np.nan), peak(2.0 * (1 + 5e-10), 2.0)]
    assert worst(within) is None
    assert worst([peak(2.0 * (1 + 2e-9), 2.0)]) is not None
    far = peak(0.5, 0.2, "axis_b")
    assert worst([*within, peak(9.0, 5.0), far, peak(3.0, 2.0)]) is far
    none = peak(1e-6, 0.0, "axis_e")
    assert worst([far, none]) is none


# --- room beside a line ---------------------------------------------------------------


def test_room_beside_a_line_is_that_of_the_farthest_points() -> None:
    """Each joint needs its angle times the farthest distance from its axis."""
    rng = np.random.default_rng(1)
    farthest = np.zeros(4)
    for q in rng.uniform(*HOLD, (300, 4)):
        frames = dh_frames(q)
        tip = frames[-1][:3, 3]
        for joint in range(4):
            frame = frames[joint]
            off = np.cross(tip - frame[:3, 3], frame[:3, 2])
            farthest[joint] = max(farthest[joint], np.linalg.norm(off))
    alone = Surroundings(ARM)
    for joint, unit in enumerate(np.eye(4)):
        room = alone.with_room(0.01 * unit).margin / 0.01
        assert farthest[joint] < room < farthest[joint] + 0.06
    strayed = rng.uniform(0.0, 0.01, 4)
    parts = [alone.with_room(one).margin for one in np.diag(strayed)]
    wide = Surroundings(ARM, (), 0.02).with_room(strayed)
    assert wide.margin == pytest.approx(0.02 + sum(parts))


def buoy(q: Any, gap: float) -> Obstacle:
    """A sphere above the tip, with a gap between it and the arm."""
    centre = tips(ARM, q[None])[0] + np.array([0.0, 0.0, 0.1])
    small = Surroundings(ARM, [Obstacle.sphere("buoy", 0.01, centre)])
    (beside, _) = small._compared[1]
    return Obstacle.sphere("buoy", 0.01 + beside.nearest_pair(q)[0] - gap, centre)


def test_room_is_kept_to_obstacles_and_to_the_arm_itself() -> None:
    q = np.array([3.0, 1.5, 2.0, 1.0])
    distance, _ = Surroundings(ARM).nearest(q)
    post = buoy(q, 0.009)
    beside = Surroundings(ARM, [post], 0.004)
    near, names = beside.nearest(q)
    assert "buoy" in names
    unit = np.array([1.0, 0.0, 0.0, 0.0])
    per_radian = Surroundings(ARM).with_room(unit).margin
    for own, gap in ((Surroundings(ARM), distance), (beside, near - 0.004)):
        for share, hit in ((0.99, False), (1.01, True)):
            found = own.with_room(share * gap / per_radian * unit).contact(q)
            assert (found is not None) == hit
            assert found is None or found.share == 0.0
        assert own.contact(q) is None


def test_a_line_of_the_tcp_strays_as_little_as_is_said() -> None:
    pytest.importorskip("toppra")
    from alpha5_model.planning.tcp_line import tcp_line

    start = a5.inverse_kinematics([0.12, 0.2, 0.1]).best(HOME)
    begin = np.array([0.12, 0.2, 0.1])
    end = np.array([0.14, 0.19, 0.1])
    line = tcp_line(start, begin, end, start[3], ARM)
    assert len(line.way) == 24
    share = np.linspace(0.0, 1.0, len(line.way))
    dense = np.linspace(0.0, 1.0, 40 * (len(share) - 1) + 1)
    straight = np.transpose([np.interp(dense, share, row) for row in line.way.T])
    off = np.abs(line._path(dense) - straight).max(axis=0)
    moving = off > 1e-12
    assert moving.sum() == 3
    ratio = line.deviation[moving] / off[moving]
    assert ratio.min() > 0.99
    assert ratio.max() < 1.2
    short = tcp_line(start, begin, begin + np.array([1e-3, 0.0, 0.0]), start[3], ARM)
    assert len(short.way) >= 20
    logger = logging.getLogger("toppra")
    logger.setLevel(logging.INFO)
    line.sampled(JointLimits(speed=np.ones(4), acceleration=np.ones(4)))
    assert logger.level == logging.INFO
    logger.setLevel(logging.NOTSET)
    fast = line.sampled(JointLimits(speed=np.ones(4), acceleration=np.ones(4)))
    assert 0.01 < fast.time[1] <= 0.02
    # The wrist stays, so it may have no speed.
    fixed = JointLimits(speed=np.array([1.0, 1, 1, 0]), acceleration=np.ones(4))
    assert line.sampled(fixed).position == pytest.approx(fast.position)


# --- retracted poses ------------------------------------------------------------------


def test_retracted_poses_need_the_least_room_of_an_even_grid() -> None:
    """Steps are a tenth of each range, and half a turn apart nothing touches."""
    poses = np.array(retracted_poses(ARM))
    lower, upper = HOLD
    steps = (poses - lower[1:3]) / (upper - lower)[1:3] * 10
    assert steps == pytest.approx(np.round(steps), abs=1e-9)
    assert steps.min() >= -1e-9
    assert steps.max() <= 10 + 1e-9
    assert len(np.unique(np.round(steps), axis=0)) == len(poses) > 20

    own = a5.load()
    yaws = np.linspace(lower[0], upper[0], 24)
    wrist = (lower[3] + upper[3]) / 2
    free = []
    radii = []
    for one in np.linspace(lower[1], upper[1], 11):
        for other in np.linspace(lower[2], upper[2], 11):
            q = np.array([[yaw, one, other, wrist] for yaw in yaws])
            if not np.all(own.in_collision(q)):
                free.append((one, other))
                radii.append(reach(q[0]))
    order = np.argsort(radii, kind="stable")[: len(poses)]
    needed = [radii[free.index(near)] for near in map(tuple, poses.tolist())]
    assert needed == pytest.approx([radii[k] for k in order], abs=1e-6)


def reach(q: Any) -> float:
    """Largest distance of the collision bodies from the yaw axis [m]."""
    from alpha5_model.collision.self_collision import self_collision

    return float(_radii(self_collision(ARM).bodies, q[None])[0])


def test_the_radius_of_a_pose_is_that_of_its_farthest_corner() -> None:
    """The tip of the arm is on the last body: the radius is a little larger."""
    rng = np.random.default_rng(2)
    for q in rng.uniform(*HOLD, (30, 4)):
        tip = dh_frames(q)[-1][:3, 3]
        assert reach(q) > np.hypot(tip[0], tip[1]) - 0.03
        turned = q + np.array([0.7, 0.0, 0.0, 0.0])
        assert reach(turned) == pytest.approx(reach(q), rel=1e-9)
    stretched = np.array([3.0, 1.8, 3.3, 1.0])
    tip = dh_frames(stretched)[-1][:3, 3]
    assert reach(stretched) < np.hypot(tip[0], tip[1]) + 0.15


# --- obstacles ------------------------------------------------------------------------

CORNERS = np.array([[0.0, 0, 0], [100, 0, 0], [0, 100, 0]])


def stl(count: int, rest: bytes = b"") -> bytes:
    row = struct.pack("<12fH", 0, 0, 1, *CORNERS.ravel(), 0)
    return b"solid by hand".ljust(80) + struct.pack("<I", count) + row * count + rest


def test_a_mesh_in_metres(tmp_path: Path) -> None:
    (tmp_path / "frame.stl").write_bytes(stl(1))
    path = tmp_path / "scene.toml"
    path.write_text("[frame]\nmesh = 'frame.stl'", "utf-8")
    (frame,) = read_obstacles(path)
    assert isinstance(frame.shape, Mesh)
    assert frame.shape.vertices == pytest.approx(CORNERS)
    assert not frame.shape.triangles.flags.writeable
    for content in (stl(0), stl(1, b"\0"), stl(2)[:-50]):
        (tmp_path / "frame.stl").write_bytes(content)
        with pytest.raises(FileFormatError, match="no binary STL"):
            read_obstacles(path)
    path.write_text("[frame]\nmesh = 'frame.stl'\nscale = -0.5", "utf-8")
    with pytest.raises(InputError, match=r"frame\.scale"):
        read_obstacles(path)


def test_files_that_are_too_large(tmp_path: Path) -> None:
    """1 MiB of obstacles, 256 MiB of a mesh."""
    path = tmp_path / "scene.toml"
    text = "[a]\nbox = [1, 1, 1]\n#"
    path.write_text(text.ljust(1 << 20, "-"), "utf-8")
    assert len(read_obstacles(path)) == 1
    path.write_text(text.ljust((1 << 20) + 1, "-"), "utf-8")
    with pytest.raises(FileFormatError):
        read_obstacles(path)
    path.write_text("[a]\nmesh = 'big.stl'", "utf-8")
    with (tmp_path / "big.stl").open("wb") as file:
        file.truncate((1 << 28) + 1)
    with pytest.raises(FileFormatError) as caught:
        read_obstacles(path)
    assert "no binary STL" not in str(caught.value)


@pytest.mark.parametrize("size", [0.0, -0.5])
def test_sizes_are_above_zero(size: float) -> None:
    for make in (
        lambda: Obstacle.sphere("s", size),
        lambda: Obstacle.cylinder("c", size, 1.0),
        lambda: Obstacle.cylinder("c", 1.0, size),
        lambda: Obstacle.box("b", (1.0, 1.0, size)),
    ):
        with pytest.raises(InputError, match="expected a number above 0"):
            make()
    shape = Obstacle.box("b", (1e-3, 1e-3, 1e-3)).shape
    assert isinstance(shape, Primitive)
    assert shape.xyz == (0.0, 0.0, 0.0)


def test_the_first_wrong_vertex_is_named() -> None:
    points = np.zeros((3, 3))
    for wrong, value in (([0, -1, 9], "-1"), ([9, -1, 0], "9"), ([0, 2.5, 1], "2.5")):
        with pytest.raises(InputError, match=f"whole numbers from 0 to 2, got {value}"):
            Obstacle.mesh("m", points, [[0, 1, 2], wrong])


def test_a_margin_is_5_mm_if_it_is_not_told() -> None:
    with pytest.raises(BlockedMotionError, match="q0 is not free"):
        plan(HOME, HOME, obstacles=[buoy(HOME, 0.0045)])
    assert plan(HOME, HOME, obstacles=[buoy(HOME, 0.0055)]).kind == "straight"
