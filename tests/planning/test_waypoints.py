"""Waypoints of files, and motions that rest at each: free by coal, within limits."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import yaml
from coal_world import CoalWorld, samples
from fk import fk, tip
from motion_checks import at, check_limits

import alpha5_model as a5
from alpha5_model.errors import (
    Alpha5Error,
    FileFormatError,
    InputError,
    JointLimitError,
    MissingFileError,
    UnreachableError,
)
from alpha5_model.planning import Obstacle, read_waypoints

HOME = a5.named_pose("home")
POINTS = np.array([[0.2, 0.1, 0.1], [0.15, 0.2, 0.1], [0.25, -0.1, 0.05]])
#: The last of these is beyond the gap of axis_e from the first.
POSITIONS = np.array([[3.6, 0.6, 1.0, 1.5], [4.0, 1.2, 1.9, 0.5], [0.4, 1.4, 2.4, 2.0]])
JOINTS = ("axis_e", "axis_d", "axis_c", "axis_b")
HULL = Obstacle.box("hull", (0.457, 0.338, 0.254), (-0.2, 0.0, -0.14))
POST = Obstacle.cylinder("post", 0.03, 1.0, (0.22, 0.15, 0.0))


def table(folder: Path, header: str, rows: np.ndarray) -> Path:
    path = folder / "waypoints.csv"
    lines = [",".join(map(repr, row)) for row in np.asarray(rows).tolist()]
    path.write_text("\n".join([header, *lines]) + "\n", "utf-8")
    return path


def message(rows: np.ndarray, names: tuple[str, ...] = JOINTS) -> dict:
    """A JointTrajectory as ROS 2 prints one."""
    return {
        "header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "base_link"},
        "joint_names": list(names),
        "points": [
            {"positions": row, "time_from_start": {"sec": k, "nanosec": 0}}
            for k, row in enumerate(np.asarray(rows).tolist())
        ],
    }


def values(path: Path, **options: object) -> np.ndarray:
    return np.array([target.value for target in read_waypoints(path, **options)])


def test_the_tip_rests_at_each_point() -> None:
    motion = a5.plan(HOME, POINTS[-1], through=POINTS[:-1])
    assert [stop.place for stop in motion.stops] == [
        *("through[0]", "through[1]", "target")
    ]
    times = [stop.time for stop in motion.stops]
    assert times == sorted(times)
    assert times[-1] == motion.duration
    for stop, point in zip(motion.stops, POINTS, strict=True):
        assert tip(stop.q) == pytest.approx(point, abs=1e-9)
        # Within a step of a rest nothing moves by more than a t^2 / 2.
        assert at(motion, stop.time) == pytest.approx(stop.q, abs=1e-5)
        near = np.abs(motion.time - stop.time).argmin()
        assert np.abs(motion.velocity[near]).max() < 0.01
    check_limits(motion, acceleration=1.0)


def test_it_is_the_motions_one_after_the_other() -> None:
    single = []
    q = HOME
    for point in POINTS:
        single.append(a5.plan(q, point))
        q = single[-1].way[-1]
    motion = a5.plan(HOME, POINTS[-1], through=POINTS[:-1])
    ends = np.cumsum([part.duration for part in single])
    assert [stop.time for stop in motion.stops] == pytest.approx(ends)
    for stop, part in zip(motion.stops, single, strict=True):
        assert stop.q == pytest.approx(part.way[-1])


@pytest.mark.slow
def test_ways_beside_obstacles_are_free_at_a_twentieth_of_a_degree() -> None:
    world = CoalWorld(obstacles=[HULL, POST])
    through = [[0.3, 0.05, 0.1], [0.05, 0.25, 0.2]]
    target = [2.9, 1.5, 2.6, 1.5]
    straight = samples(HOME, np.array(target), math.radians(1))
    assert not any(map(world.touches, straight))
    motion = a5.plan(HOME, target, through=through, obstacles=[HULL, POST])
    assert "by retracted poses" in motion.kind
    assert "straight" in motion.kind
    # No joint is faster than the rated speed of axis_b.
    count = math.ceil(motion.duration * math.radians(50) / math.radians(0.05))
    path = at(motion, np.linspace(0.0, motion.duration, count + 1))
    assert np.degrees(np.abs(np.diff(path, axis=0)).max()) < 0.05
    assert not any(map(world.touches, path))
    check_limits(motion, acceleration=1.0)
    assert np.abs(at(motion, motion.stops[1].time) - motion.stops[1].q).max() < 1e-4


def test_a_rate_stretches_the_stops_too() -> None:
    motion = a5.plan(HOME, POINTS[-1], through=POINTS[:-1], rate=2.0)
    free = a5.plan(HOME, POINTS[-1], through=POINTS[:-1])
    ratio = motion.duration / free.duration
    assert ratio > 1.0
    for one, other in zip(motion.stops, free.stops, strict=True):
        assert one.time == pytest.approx(ratio * other.time)


def test_waypoints_where_the_arm_is_already() -> None:
    still = a5.plan(HOME, HOME, through=[HOME])
    assert [stop.time for stop in still.stops] == [still.duration] * 2
    assert not still.velocity.any()
    twice = a5.plan(HOME, POINTS[0], through=[HOME, POINTS[0]])
    assert twice.stops[0].time == 0.0
    assert twice.stops[1].time == twice.stops[2].time == twice.duration


def test_every_kind_of_target() -> None:
    q = np.array([2.0, 1.4, 2.0, 1.0])
    motion = a5.plan(HOME, HOME, through=[POINTS[0], pin.SE3(fk(q)), q])
    assert fk(motion.stops[1].q) == pytest.approx(fk(q), abs=1e-7)
    assert motion.stops[1].rotation_error == pytest.approx(0.0, abs=1e-7)
    assert motion.branch is None
    turned = fk(q)
    turned[:3, :3] = pin.exp3(np.array([0.3, 0.2, 0.1])) @ turned[:3, :3]
    stop = a5.plan(HOME, turned).stops[0]
    apart = np.linalg.norm(pin.log3(turned[:3, :3].T @ fk(stop.q)[:3, :3]))
    assert stop.rotation_error == pytest.approx(apart)
    assert apart > 0.05


def test_tables_of_joint_positions(tmp_path: Path) -> None:
    bare = values(table(tmp_path, ",".join(JOINTS), POSITIONS))
    assert bare == pytest.approx(POSITIONS)
    degrees = np.degrees(POSITIONS[:, ::-1])
    header = ",".join(f"{joint}_pos [deg]" for joint in reversed(JOINTS))
    assert values(table(tmp_path, header, degrees)) == pytest.approx(POSITIONS)
    header = ",".join(reversed(JOINTS))
    path = table(tmp_path, header, degrees)
    assert values(path, degrees=True) == pytest.approx(POSITIONS)
    joints = dict(zip(JOINTS, ("-j1", "j2", "j3", "j4"), strict=True))
    path = table(tmp_path, "j1,j2,j3,j4", POSITIONS * [-1, 1, 1, 1])
    assert values(path, joints=joints) == pytest.approx(POSITIONS)


def test_tables_of_points_and_poses(tmp_path: Path) -> None:
    header = "x [mm],y [mm],z [mm]"
    found = read_waypoints(table(tmp_path, header, 1e3 * POINTS))
    assert {target.kind for target in found} == {"position"}
    assert [target.value for target in found] == pytest.approx(POINTS)
    assert found[1].place.endswith("waypoints.csv, line 3")

    poses = np.array([fk(q) for q in POSITIONS])
    euler = [pin.rpy.matrixToRpy(pose[:3, :3]) for pose in poses]
    rows = np.hstack([poses[:, :3, 3], np.degrees(euler)])
    header = "x,y,z,roll [deg],pitch [deg],yaw [deg]"
    assert values(table(tmp_path, header, rows)) == pytest.approx(poses, abs=1e-9)
    coeffs = [pin.Quaternion(pose[:3, :3].copy()).coeffs() for pose in poses]
    rows = np.hstack([np.array(coeffs)[:, [3, 0, 1, 2]], poses[:, :3, 3]])
    path = table(tmp_path, "qw,qx,qy,qz,x,y,z", rows)
    assert values(path) == pytest.approx(poses, abs=1e-9)


def test_messages_of_joint_trajectories(tmp_path: Path) -> None:
    order = (2, 0, 3, 1)
    names = tuple(JOINTS[k] for k in order)
    said = message(POSITIONS[:, order], names)
    for around in (said, {"trajectory": said}, {"goal": {"trajectory": said}}):
        (tmp_path / "goal.json").write_text(json.dumps(around), "utf-8")
        (tmp_path / "goal.yaml").write_text(yaml.safe_dump(around), "utf-8")
        echoed = f"{yaml.safe_dump(around)}---\n"  # as ros2 topic echo prints it
        (tmp_path / "echoed.yaml").write_text(echoed, "utf-8")
        for name in ("goal.json", "goal.yaml", "echoed.yaml"):
            assert values(tmp_path / name) == pytest.approx(POSITIONS)


def test_what_is_written_is_the_message(tmp_path: Path) -> None:
    motion = a5.plan(HOME, POINTS[0])
    loaded = [
        json.loads(motion.write(tmp_path / "motion.json").read_text("utf-8")),
        yaml.safe_load(motion.write(tmp_path / "motion.yaml").read_text("utf-8")),
    ]
    for said in loaded:
        assert said["joint_names"] == list(JOINTS)
        points = said["points"]
        for name, expected in (
            ("positions", motion.position),
            ("velocities", motion.velocity),
            ("accelerations", motion.acceleration),
        ):
            assert np.array([p[name] for p in points]) == pytest.approx(expected)
        since = [p["time_from_start"] for p in points]
        assert all(0 <= s["nanosec"] < 1e9 for s in since)
        times = [s["sec"] + 1e-9 * s["nanosec"] for s in since]
        assert times == pytest.approx(motion.time, abs=1e-9)
    assert values(tmp_path / "motion.yaml") == pytest.approx(motion.position)


def test_the_bus_in_the_arms_own_units(tmp_path: Path) -> None:
    own = tmp_path / "own.toml"
    own.write_text("format = 1\n[signs]\naxis_b = -1\n", "utf-8")
    record = a5.arm_file(own)
    motion = a5.plan(HOME, POINTS[0], wrist=2.0, arm=record)
    path = motion.write_bus(tmp_path / "bus.csv")
    read = np.genfromtxt(path, delimiter=",", names=True)
    assert read.dtype.names == (
        *("time_secs", "device_5_rad", "device_4_rad", "device_3_rad", "device_2_rad"),
    )
    assert read["device_5_rad"] == pytest.approx(motion.position[:, 0])
    assert read["device_2_rad"] == pytest.approx(-motion.position[:, 3])
    path = motion.write(tmp_path / "motion.json")
    assert values(path, arm=record) == pytest.approx(motion.position)


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("w.csv", "x,y,z\n200,100,100\n", "x [mm]"),
        ("w.csv", "x,y,z\n0.2,0.1,inf\n", "line 2, column 3"),
        ("w.csv", "x,y,z\n", "no waypoints"),
        ("w.csv", "x,y\n0.1,0.1\n", "no column z"),
        ("w.csv", "x,y,z,frame_id\n0.2,0.1,0.1,odom\n", "base_link"),
        ("w.csv", "x,y,z,roll,pitch,yaw\n0.2,0.1,0.1,0,90,0\n", "roll [deg]"),
        ("w.csv", "x,y,z,roll,pitch\n0.2,0.1,0.1,0,1\n", "no column yaw"),
        ("w.csv", "x,y,z,qx,qy,qz,qw\n0.2,0.1,0.1,0,0,0,2\n", "length 1"),
        ("w.csv", "x,y,z,axis_e\n0.2,0.1,0.1,1\n", "axis_e"),
        ("w.csv", "axis_e,axis_d,axis_c,axis_b\n180,90,90,0\n", "[deg]"),
        ("w.csv", "axis_e,axis_d,axis_c\n1,1,1\n", "axis_b"),
        ("w.csv", "a,b\n1,2\n", "or x, y, z"),
        ("w.csv", "axis_e,axis_d,axis_c,axis_b,axis_a\n1,1,1,1,0.005\n", "jaws"),
        ("w.csv", "x,y,z,qx,qy,qz,qw\n0.2,0.1,0.1,0,0,0,2\n", "line 2, column 4"),
        ("w.csv", "x,y,z,roll,pitch,yaw\n0.2,0.1,0.1,0,90,0\n", "line 2, column 5"),
        ("w.json", json.dumps(message([[1, 2, None, 1]])), "axis_c"),
        ("w.json", '{"points": [], "points": [], "joint_names": []}', "'points'"),
        ("w.yaml", "joint_names: []\npoints: []\npoints: []\n", "line 3"),
        ("w.json", json.dumps({"joint_names": [], "points": {}}), "JointTrajectory"),
        ("w.json", json.dumps(message([[1, 2, "x", 1]])), "points[0]"),
        ("w.json", json.dumps(message([[1, 2, 1]])), "points[0]"),
        ("w.json", "[" * 100_000, "not JSON"),
        ("w.yaml", "a: [1, 2", "not YAML"),
        ("w.yaml", "joint_names: []\n---\njoint_names: []\n", "holds 2 documents"),
        ("w.yaml", "a: &a [1]\nb: *a\n", "alias"),
    ],
)
def test_mistakes_of_files(name: str, content: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_text(content, "utf-8")
    with pytest.raises(FileFormatError) as caught:
        read_waypoints(path)
    assert said in str(caught.value)


def test_closed_jaws_pass(tmp_path: Path) -> None:
    rows = np.column_stack([POSITIONS, np.full(3, 0.0013)])
    path = table(tmp_path, ",".join([*JOINTS, "axis_a"]), rows)
    assert values(path) == pytest.approx(POSITIONS)


def test_mistakes_of_arguments(tmp_path: Path) -> None:
    with pytest.raises(MissingFileError, match="waypoints"):
        read_waypoints(tmp_path / "none.csv")
    with pytest.raises(MissingFileError):
        read_waypoints(tmp_path / "none.yaml")
    (tmp_path / "binary.csv").write_bytes(b"\0\xff\1")
    with pytest.raises(FileFormatError, match="of waypoints"):
        read_waypoints(tmp_path / "binary.csv")
    with pytest.raises(UnreachableError, match=r"through\[1\]: ") as caught:
        a5.plan(HOME, POINTS[0], through=[POINTS[1], [0.9, 0.0, 0.0]])
    assert caught.value.distance > 0.4
    (far,) = read_waypoints(table(tmp_path, "x,y,z", [[0.9, 0.0, 0.0]]))
    with pytest.raises(UnreachableError, match=r"waypoints\.csv, line 2: "):
        a5.plan(HOME, far)
    with pytest.raises(JointLimitError, match=r"through\[0\]: "):
        a5.plan(HOME, POINTS[0], through=[[180.0, 90.0, 90.0, 0.0]])
    for wrong, error in ((5, InputError), ([[1.0, 2.0]], InputError)):
        with pytest.raises(error) as refused:
            a5.plan(HOME, POINTS[0], through=wrong)
        assert refused.value.name.startswith("through")
    with pytest.raises(InputError, match="through"):
        a5.plan(HOME, POINTS[0], through=POINTS[:1], line=True)
    with pytest.raises(Alpha5Error, match="wrist"):
        a5.plan(HOME, HOME, through=[HOME], wrist=1.0)
