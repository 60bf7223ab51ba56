"""Placements of a vehicle, by numerical searches, coal and Pinocchio."""

from __future__ import annotations

import dataclasses
import math
from functools import cache
from typing import NamedTuple

import coal
import numpy as np
import pinocchio as pin
import pytest
from coal_world import CoalWorld, obstacle_geometry
from fk import STRETCHED, tip
from own_arm import with_tool
from reference import LOWER, UPPER

import alpha5_model as a5
from alpha5_model.errors import (
    ImplausibleWarning,
    InputError,
    JointLimitError,
    NoPlacementError,
    UnknownNameError,
)
from alpha5_model.planning import Obstacle, Placements, placements
from alpha5_model.water.vehicle import carrier_of

MOUNT = np.eye(4)
MOUNT[:3, :3] = pin.rpy.rpyToMatrix(0.1, -0.2, 0.4)
MOUNT[:3, 3] = 0.2, 0.05, 0.14
HULL = (
    Obstacle.box("rov", (0.3, 0.25, 0.2), (-0.2, 0.0, -0.13), (0.0, 0.1, 0.2)),
    Obstacle.sphere("lamp", 0.04, (0.0, 0.15, 0.0)),
)
WORLD = (
    Obstacle.box("wall", (0.1, 3.0, 2.0), (0.62, 0.0, 0.0), (0.0, 0.0, 0.2)),
    Obstacle.cylinder("pipe", 0.03, 2.0, (0.3, 0.0, -0.4), (math.pi / 2, 0.0, 0.0)),
    Obstacle.sphere("buoy", 0.06, (0.35, 0.4, 0.2)),
)
VALVE = np.array([0.45, 0.1, 0.1])
VEHICLE = {
    "mass": 13.5,
    "com": [0.0, 0.01, 0.0],
    "volume": 0.0134,
    "cob": [0.01, 0.0, 0.06],
    "xyz": MOUNT[:3, 3].tolist(),
    "rpy": [0.1, -0.2, 0.4],
}
#: coal's distances are this exact [m].
EXACT = 2e-6


def random_poses(count: int, seed: int) -> np.ndarray:
    """Tilted poses of the vehicle with base_link before the valve, (count, 6)."""
    rng = np.random.default_rng(seed)
    place = VALVE + rng.uniform((-0.4, -0.3, -0.3), (0.1, 0.3, 0.1), (count, 3))
    tilts = rng.uniform(-0.3, 0.3, (count, 2))
    poses = np.column_stack([place, tilts, rng.uniform(-4.0, 4.0, count)])
    for pose in poses:
        pose[:3] -= pin.rpy.rpyToMatrix(*pose[3:]) @ MOUNT[:3, 3]
    return poses


def base_of(pose: np.ndarray, mount: np.ndarray = MOUNT) -> pin.SE3:
    """base_link in the world for a pose of the vehicle (6,)."""
    frame = pin.SE3(pin.rpy.rpyToMatrix(*pose[3:]), pose[:3])
    return frame * pin.SE3(mount)


def seeds() -> np.ndarray:
    """Joint positions from which a search finds every branch, (S, 3)."""
    axes = [np.linspace(LOWER[j], UPPER[j], n) for j, n in enumerate((7, 4, 4))]
    return np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 3)


def searched(target: np.ndarray) -> np.ndarray:
    """All joint positions within the limits that reach a point, by Newton, (K, 4)."""
    q = np.zeros((len(seeds()), 4))
    q[:, :3] = seeds()
    step = 1e-6
    for _ in range(25):
        off = tip(q) - target
        columns = []
        for joint in range(3):
            moved = q.copy()
            moved[:, joint] += step
            columns.append((tip(moved) - tip(q)) / step)
        jacobian = np.stack(columns, axis=-1)
        square = jacobian.swapaxes(1, 2) @ jacobian + 1e-9 * np.eye(3)
        slope = (jacobian.swapaxes(1, 2) @ off[..., None])[..., 0]
        change = np.linalg.solve(square, slope[..., None])[..., 0]
        q[:, :3] -= np.clip(change, -0.3, 0.3)
    exact = np.linalg.norm(tip(q) - target, axis=1) < 1e-9
    turns = np.round((q - (LOWER + UPPER) / 2) / math.tau)
    turns[:, 3] = 0.0
    q -= math.tau * turns
    found: list[np.ndarray] = []
    for row in q[exact & ((q >= LOWER - 1e-9) & (q <= UPPER + 1e-9)).all(axis=1)]:
        if all(np.abs(row - other).max() > 1e-5 for other in found):
            found.append(row)
    return np.array(found).reshape(-1, 4)


class Judged(NamedTuple):
    """What a joint position at a pose is by coal: least distances [m]."""

    itself: float
    hull: float
    world: float


class Brute:
    """Pinocchio's and coal's distances at a pose; the world moves past the base."""

    def __init__(self) -> None:
        self.arm = CoalWorld(obstacles=[*HULL, *WORLD])
        bodies = self.arm.geometry.geometryObjects
        count = len(bodies)
        self.first = count - len(WORLD)
        pairs = [pair.second for pair in self.arm.geometry.collisionPairs]
        obstacle = np.array(pairs) - (self.first - len(HULL))
        self.kind = np.digitize(obstacle, [0, len(HULL)])
        self.own = [bodies[k] for k in range(self.first) if self.fixed(bodies[k])]
        self.poses = [obstacle_geometry(obstacle)[1] for obstacle in WORLD]

    @staticmethod
    def fixed(body: pin.GeometryObject) -> bool:
        return body.parentJoint == 0

    def stand(self, base: pin.SE3) -> None:
        for number, pose in enumerate(self.poses):
            body = self.arm.geometry.geometryObjects[self.first + number]
            body.placement = base.inverse() * pose

    def vehicle(self) -> float:
        """Distance of hull and link_0 from the world."""
        distances = []
        for number in range(len(WORLD)):
            thing = self.arm.geometry.geometryObjects[self.first + number]
            for part in self.own:
                result = coal.DistanceResult()
                placed = [
                    coal.Transform3s(x.placement.rotation, x.placement.translation)
                    for x in (part, thing)
                ]
                coal.distance(
                    part.geometry,
                    placed[0],
                    thing.geometry,
                    placed[1],
                    coal.DistanceRequest(),
                    result,
                )
                distances.append(result.min_distance)
        return min(distances)

    def judged(self, q: np.ndarray) -> Judged:
        distances = self.arm.distances(q)
        return Judged(*(float(distances[self.kind == k].min()) for k in range(3)))


def check_by_brute_force(count: int, seed: int, clearance: float) -> int:
    """Compare each of many poses; returns how many fit."""
    poses = random_poses(count, seed)
    found = placements(
        VALVE,
        mount=MOUNT,
        hull=HULL,
        obstacles=WORLD,
        poses=poses,
        clearance=clearance,
    )
    rows = {tuple(pose): row for row, pose in enumerate(found.pose)}
    assert len(rows) == len(found)
    brute = Brute()
    for pose in poses:
        base = base_of(pose)
        row = rows.get(tuple(pose))
        local = base.actInv(VALVE)
        solutions = searched(local)
        if not len(solutions):
            assert row is None
            continue
        brute.stand(base)
        vehicle = brute.vehicle()
        judged = [brute.judged(q) for q in solutions]
        room = [
            min(j.itself, j.hull - 0.005, j.world - clearance, vehicle - clearance)
            for j in judged
        ]
        best = max(room, default=-1.0)
        if abs(best) < EXACT:
            continue
        assert (row is not None) == (best > 0.0), pose
        if row is None:
            continue
        assert found.base[row] == pytest.approx(base.homogeneous, abs=1e-12)
        q = found.q[row, 0]
        assert tip(q) == pytest.approx(local, abs=1e-9)
        chosen = [k for k, s in enumerate(solutions) if np.abs(s - q).max() < 1e-6]
        assert len(chosen) == 1
        assert room[chosen[0]] > 0.0
        world = judged[chosen[0]].world
        assert found.clearance[row] == pytest.approx(world, abs=EXACT)
        assert found.hull_clearance[row] == pytest.approx(vehicle, abs=EXACT)
    return len(found)


def test_random_poses_by_brute_force() -> None:
    assert check_by_brute_force(15, seed=1, clearance=0.01) > 0


@pytest.mark.slow
def test_hundreds_of_random_poses_by_brute_force() -> None:
    assert check_by_brute_force(400, seed=2, clearance=0.01) > 30


def test_what_is_too_near_is_seen() -> None:
    """The brute force says no to poses that another clearance allows."""
    poses = random_poses(20, seed=6)
    brute = Brute()
    wide = placements(VALVE, mount=MOUNT, hull=HULL, obstacles=WORLD, poses=poses)
    brute.stand(base_of(wide.pose[0]))
    near = brute.judged(wide.q[0, 0]).world
    least = min(near, brute.vehicle())
    one = {"mount": MOUNT, "hull": HULL, "obstacles": WORLD, "poses": wide.pose[0]}
    assert len(placements(VALVE, clearance=least - 1e-5, **one)) == 1
    with pytest.raises(NoPlacementError) as caught:
        placements(VALVE, clearance=least + 1e-5, **one)
    assert caught.value.possible == pytest.approx(least, abs=EXACT)
    assert caught.value.reaching == caught.value.tried == 1


def in_pose(
    points: np.ndarray, facing: bool, upper_limits: np.ndarray = UPPER
) -> np.ndarray:
    """Which points (N, 3) an arm that faces them, or turns away, reaches, (N,).

    By the triangle of Section 1.3, within the limits of theta_0 to theta_2.
    """
    upper, lower = math.hypot(0.040, 0.1453), math.hypot(0.020, 0.180)
    r = np.hypot(points[:, 0], points[:, 1]) * (1 if facing else -1) - 0.020
    z = points[:, 2] - 0.0462
    turn = np.arctan2(points[:, 1], points[:, 0]) - math.pi * facing
    reached = np.zeros(len(points), bool)
    far = np.hypot(r, z)
    with np.errstate(invalid="ignore"):
        inner = np.arccos((far**2 + upper**2 - lower**2) / (2 * far * upper))
        bend = np.arccos((far**2 - upper**2 - lower**2) / (2 * upper * lower))
    for elbow in (1, -1):
        first = np.arctan2(z, r) - elbow * inner
        q = [
            turn,
            first - math.atan2(0.040, 0.1453) + math.pi / 2,
            STRETCHED - elbow * bend,
        ]
        inside = np.isfinite(first)
        for angle, low, high in zip(q, LOWER, upper_limits, strict=False):
            inside &= (angle - low) % math.tau <= high - low
        reached |= inside
    return reached


def test_the_triangle_reaches_what_joints_reach() -> None:
    rng = np.random.default_rng(3)
    q = rng.uniform(LOWER, UPPER, (500, 4))
    points = tip(q)
    radius = points[:, 0] * -np.cos(q[:, 0]) + points[:, 1] * -np.sin(q[:, 0])
    for facing in (True, False):
        assert in_pose(points[(radius > 0) == facing], facing).all()


@pytest.mark.parametrize("turn", [UPPER[0], 2.0, 4.0])
def test_the_reach_margin_by_sampling(turn: float) -> None:
    """Also with an axis_e that turns less than half a turn, and a little more."""
    first, *others = a5.parameters().joints
    joints = (dataclasses.replace(first, upper=turn), *others)
    arm = dataclasses.replace(a5.parameters(), joints=joints)
    limits = np.array([turn, *UPPER[1:]])
    rng = np.random.default_rng(4)
    found = placements(VALVE, arm=arm, mount=MOUNT, poses=random_poses(400, seed=5))
    assert len(found) > 30
    ball = rng.normal(size=(6000, 3))
    ball /= np.linalg.norm(ball, axis=1, keepdims=True)

    def reached(points: np.ndarray) -> np.ndarray:
        return in_pose(points, True, limits) | in_pose(points, False, limits)

    for row in range(0, len(found), 1 + len(found) // 30):
        local = base_of(found.pose[row]).actInv(VALVE)
        margin = found.reach_margin[row]
        within = rng.uniform(0.2, 1, (6000, 1)) ** 0.3
        assert reached(local + 0.9999 * margin * ball * within).all()
        assert not reached(local + (1.03 * margin + 1e-6) * ball).all()


def test_torque_and_tilt_are_those_of_one_arm_on_its_vehicle() -> None:
    points = [VALVE, VALVE - [0.0, 0.05, 0.05]]
    arm = a5.load(a5.FRESH_WATER).with_payload(0.2, volume=1e-5)
    poses = random_poses(300, seed=7)
    found = placements(points, arm=arm, vehicle=VEHICLE, poses=poses)
    vehicle = a5.Vehicle(
        mass=13.5,
        com=VEHICLE["com"],
        inertia=np.diag([0.26, 0.23, 0.37]),
        volume=0.0134,
        cob=VEHICLE["cob"],
        mount=MOUNT,
    )
    system = arm.on_vehicle(vehicle)
    effort = [joint.effort for joint in a5.parameters().joints[:4]]
    for row in range(0, len(found), 1 + len(found) // 8):
        base = base_of(found.pose[row])
        there = a5.load(a5.FRESH_WATER, gravity=a5.gravity_in_base(base.rotation))
        there = there.with_payload(0.2, volume=1e-5)
        shares, tilts = [], []
        for point, q in enumerate(found.q[row]):
            torque = there.hydrostatic_torque(q)
            assert found.torque[row, point] == pytest.approx(torque, abs=1e-9)
            shares.append(np.abs(torque / effort).max())
            trim = system.trim(q).rotation_vehicle_to_world
            frame = pin.rpy.rpyToMatrix(*found.pose[row, 3:])
            tilts.append(math.acos(min(1.0, trim[2] @ frame[2])))
        assert found.holding[row] == pytest.approx(max(shares), abs=1e-9)
        assert found.tilt[row] == pytest.approx(max(tilts), abs=1e-6)
    same = placements(points, arm=arm, vehicle=vehicle, poses=poses)
    assert same.tilt == pytest.approx(found.tilt, abs=1e-12)


@cache
def of_a_grid() -> Placements:
    return placements(
        VALVE, hull=HULL, obstacles=WORLD, vehicle=VEHICLE, spacing=0.15, yaws=4
    )


def test_the_rank_is_from_the_least_distance_up() -> None:
    found = of_a_grid()
    assert len(found) > 5
    ranks = []
    for row in range(len(found)):
        distances = (found.clearance, found.hull_clearance, found.reach_margin)
        steps = sorted(math.floor(d[row] * 100 + 1e-6) for d in distances)
        share = math.floor(found.holding[row] * 100 + 1e-6)
        tilt = math.floor(found.tilt[row] * 1000 + 1e-6)
        ranks.append([*(-step for step in steps), share, tilt])
    assert ranks == sorted(ranks)


def test_another_order() -> None:
    found = of_a_grid()
    lightest = found.take(np.argsort(found.holding))
    assert (np.diff(lightest.holding) >= 0).all()
    assert sorted(map(tuple, lightest.pose)) == sorted(map(tuple, found.pose))
    assert lightest.tried == found.tried
    with pytest.raises(InputError, match=r"^rows:"):
        found.take([len(found)])


def test_the_grid_is_about_the_points() -> None:
    """base_link stands on a grid about the valve; every yaw and tilt is tried."""
    tilts = [(0.0, 0.0), (0.2, -0.1)]
    found = placements(VALVE, mount=MOUNT, spacing=0.15, yaws=4, tilts=tilts)
    off = (found.base[:, :3, 3] - VALVE) / 0.15
    assert np.abs(off - np.round(off)).max() < 1e-9
    attitudes = {tuple(np.round(angles, 9)) for angles in found.pose[:, 3:]}
    turns = np.round(np.arange(4) * math.pi / 2, 9)
    assert attitudes == {(*tilt, turn) for tilt in tilts for turn in turns}


def test_a_box_is_reached_with_one_branch_where_there_is_one() -> None:
    edges = np.array([0.1, 0.02, 0.0])
    found = placements(VALVE, box=edges, spacing=0.15, yaws=2)
    assert len(found.points) == 5 * 2
    assert np.ptp(found.points, axis=0) == pytest.approx(edges)
    assert found.points.mean(axis=0) == pytest.approx(VALVE)
    for row in range(len(found)):
        to_base = np.linalg.inv(found.base[row])
        local = found.points @ to_base[:3, :3].T + to_base[:3, 3]
        assert tip(found.q[row]) == pytest.approx(local, abs=1e-9)
        solutions = a5.inverse_kinematics(local)
        free = solutions.within_limits & ~solutions.collides
        if free.all(axis=0).any():
            assert len(set(found.branches(row))) == 1


def test_plans_lead_to_the_best_pose() -> None:
    found = of_a_grid()
    around = found.obstacles()
    assert [o.name for o in around] == [o.name for o in (*HULL, *WORLD)]
    q = found.q[0, 0]
    lifted = q + np.array([0.0, 0.05, 0.0, 0.0])
    motion = a5.plan(lifted, q, obstacles=around)
    assert motion.clearance.distance > 0.0049
    wall = next(o for o in around if o.name == "wall")
    seen = base_of(found.pose[0]).inverse() * obstacle_geometry(WORLD[0])[1]
    assert wall.shape.xyz == pytest.approx(seen.translation, abs=1e-12)


def test_the_table(tmp_path) -> None:
    found = of_a_grid()
    path = found.write(tmp_path / "all.csv")
    table = np.genfromtxt(path, delimiter=",", names=True, dtype=None, encoding=None)
    assert np.array_equal(table["clearance_m"], found.clearance)
    assert np.array_equal(table["yaw_rad"], found.pose[:, 5])
    assert np.array_equal(table["axis_d_rad"], found.q[:, 0, 1])
    assert list(table["branch"]) == [found.branches(k)[0] for k in range(len(found))]
    with pytest.raises(UnknownNameError):
        found.write(tmp_path / "all.xlsx")


def test_coal_alone_says_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the compiled kernels."""
    from alpha5_model.collision import self_collision
    from alpha5_model.planning import surroundings

    arguments = {"mount": MOUNT, "hull": HULL, "obstacles": WORLD}
    arguments["poses"] = random_poses(40, seed=1)
    compiled = placements(VALVE, **arguments)
    surroundings._beside.cache_clear()
    self_collision.self_collision.cache_clear()
    monkeypatch.setattr(self_collision, "module", object)
    by_coal = placements(VALVE, **arguments)
    surroundings._beside.cache_clear()
    self_collision.self_collision.cache_clear()
    assert np.array_equal(by_coal.pose, compiled.pose)
    assert by_coal.clearance == pytest.approx(compiled.clearance, abs=EXACT)
    assert by_coal.hull_clearance == pytest.approx(compiled.hull_clearance, abs=EXACT)


def test_an_arm_of_ones_own_with_a_mount() -> None:
    mount = a5.parameters().mount
    assert mount is None
    from alpha5_model.numbers.pose import Pose

    placed = Pose(position=MOUNT[:3, 3], rotation=MOUNT[:3, :3], parent="vehicle")
    own = dataclasses.replace(a5.parameters(), mount=placed)
    poses = random_poses(100, seed=8)
    found = placements(VALVE, arm=own, poses=poses)
    same = placements(VALVE, mount=MOUNT, poses=poses)
    assert found.pose == pytest.approx(same.pose, abs=1e-12)
    assert found.torque == pytest.approx(same.torque, abs=1e-9)


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("targets", {"targets": np.zeros((0, 3))}),
        ("targets", {"targets": [0.1, 0.2, math.nan]}),
        ("targets", {"targets": [0.1, 0.2]}),
        ("targets", {"targets": [[0.0, 0.0, 0.0], [1.5, 0.0, 0.0]]}),
        ("box", {"box": [0.1, -0.1, 0.1]}),
        ("targets, box", {"box": [1.9, 0.6, 0.0]}),
        ("clearance", {"clearance": -0.01}),
        ("clearance", {"clearance": math.inf}),
        ("poses", {"poses": np.zeros((0, 6))}),
        ("poses", {"poses": np.zeros((2, 4))}),
        ("spacing", {"spacing": 0.0}),
        ("spacing", {"spacing": 0.005}),
        ("yaws", {"yaws": 0}),
        ("tilts", {"tilts": [5.0, 0.0]}),
        ("tilts", {"tilts": []}),
        ("mount", {"mount": np.zeros((4, 4))}),
        ("mount", {"mount": MOUNT, "vehicle": VEHICLE}),
        ("vehicle.cob", {"vehicle": {"mass": 1.0, "com": [0, 0, 0], "volume": 0.1}}),
        ("hull[0]", {"hull": ["box"]}),
        ("obstacles", {"obstacles": [WORLD[0], WORLD[0]]}),
        ("obstacles", {"hull": [WORLD[0]], "obstacles": [WORLD[0]]}),
        ("tool", {"arm": with_tool(0.03, 0.0, -0.18)}),
    ],
)
def test_what_cannot_be_used(name: str, arguments: dict) -> None:
    with pytest.raises(InputError) as caught:
        placements(**{"targets": VALVE, **arguments})
    assert caught.value.name.startswith(name)


def test_a_mesh_is_refused() -> None:
    corners = [[0.5, 0.0, 0.0], [0.5, 0.1, 0.0], [0.5, 0.0, 0.1]]
    mesh = Obstacle.mesh("frame", corners, [[0, 1, 2]])
    for argument in ("hull", "obstacles"):
        with pytest.raises(InputError, match=argument):
            placements(VALVE, **{argument: [mesh]})


def test_other_units_are_noticed() -> None:
    with pytest.warns(ImplausibleWarning, match="if it is in mm"):
        placements([450.0, 100.0, 100.0], spacing=0.2, yaws=1)
    with (
        pytest.warns(ImplausibleWarning, match="if it is in mm"),
        pytest.raises(NoPlacementError),
    ):
        placements(VALVE, obstacles=WORLD, clearance=5.0, spacing=0.2, yaws=1)
    with (
        pytest.warns(ImplausibleWarning, match="if it is in deg"),
        pytest.raises(NoPlacementError),
    ):
        placements(VALVE, poses=[1.4, 0.0, 0.0, 0.0, 0.0, 90.0])
    with pytest.raises(JointLimitError):
        placements(VALVE, wrist=90.0)


@pytest.mark.parametrize(
    ("changes", "remedy"),
    [
        ({"volume": 13.4}, "vehicle.volume: .* write 0.0134"),
        ({"mass": 13500}, "vehicle.*volume: .* write 13.5"),
        ({"com": [0, 10, 0]}, "vehicle.com: .* if it is in mm"),
        ({"xyz": [200, 50, 140]}, "vehicle.xyz: .* if it is in mm"),
        ({"rpy": [0, 0, 90]}, "vehicle.rpy: .* if it is in deg"),
    ],
)
def test_other_units_of_a_vehicles_table_are_noticed(
    changes: dict[str, object], remedy: str
) -> None:
    with pytest.warns(ImplausibleWarning, match=remedy):
        carrier_of("vehicle", {**VEHICLE, **changes})


def test_rows_that_are_not_there() -> None:
    found = placements(VALVE, spacing=0.2, yaws=1)
    for wrong in (len(found), 0.0, True, "best", None):
        for method in (found.branches, found.obstacles):
            with pytest.raises(InputError) as caught:
                method(wrong)
            assert caught.value.name == "row"


def test_a_wish_that_no_pose_fulfils_says_how_far_off_it_is() -> None:
    pose = [1.0, 0.1, 0.1, 0.0, 0.0, 0.0]
    with pytest.raises(NoPlacementError) as caught:
        placements(VALVE, poses=pose)
    short = float(a5.distance_to_reach(VALVE - pose[:3]))
    assert caught.value.beyond == pytest.approx(short)
    assert (caught.value.tried, caught.value.reaching) == (1, 0)
    with pytest.raises(NoPlacementError) as caught:
        placements(VALVE, obstacles=WORLD, clearance=0.3, spacing=0.2, yaws=2)
    possible = caught.value.possible
    nearer = {"clearance": 0.999 * possible, "spacing": 0.2, "yaws": 2}
    assert len(placements(VALVE, obstacles=WORLD, **nearer))


def test_a_valve_inside_the_wall_is_never_free() -> None:
    inside = Obstacle.box("rock", (0.2, 0.2, 0.2), tuple(VALVE))
    with pytest.raises(NoPlacementError) as caught:
        placements(VALVE, obstacles=[inside], spacing=0.2, yaws=2)
    assert math.isnan(caught.value.possible)
    # Each pose is counted once, with what touches there.
    counts = caught.value.touching
    assert sum(counts.values()) == caught.value.reaching > 0
    assert caught.value.reaching


def test_an_obstacle_that_only_the_jaws_are_near() -> None:
    """Nothing is skipped for being far from link_0."""
    target = [0.34, 0.0, 0.05]
    wall = Obstacle.box("wall", (0.1, 0.3, 0.3), (-0.45, 0.0, 0.0))
    pebble = Obstacle.sphere("pebble", 0.01, (0.40, 0.03, 0.05))
    stand = {"poses": np.zeros(6), "obstacles": [wall, pebble]}
    found = placements(target, **stand)
    by_coal = CoalWorld(obstacles=[pebble]).obstacle_distance(found.q[0, 0])
    assert by_coal < 0.05
    assert found.clearance[0] == pytest.approx(by_coal, abs=EXACT)
    with pytest.raises(NoPlacementError):
        placements(target, clearance=by_coal + 1e-3, **stand)
