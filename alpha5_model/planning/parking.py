"""`placements`: where to put the vehicle so that the arm reaches some points.

Poses of the vehicle are tried, and those from which a point is out of reach, or at
which something touches, are left out, the cheapest question first. What is left is
measured and ranked.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    BoolArray,
    FloatArray,
    array,
    bounded,
    count,
    float_array,
    frozen,
    real,
    rigid_transform,
)
from alpha5_model._support.spatial import inverse, moved, rotation_from_rpy, transform
from alpha5_model.dynamics.arm import Arm
from alpha5_model.errors import (
    InputError,
    NoPlacementError,
    ShapeError,
)
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.kinematics.half_plane import bounded_geometry
from alpha5_model.kinematics.ik import BRANCHES
from alpha5_model.kinematics.limits import within
from alpha5_model.kinematics.reach import distance_to_reach, reach_margin
from alpha5_model.kinematics.solver import solve
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.planning.obstacles import Obstacle, checked_obstacles
from alpha5_model.planning.placement_table import Placements
from alpha5_model.planning.planner import MARGIN, loaded_arm
from alpha5_model.planning.surroundings import Surroundings
from alpha5_model.planning.world import World
from alpha5_model.water.carrier import Carrier
from alpha5_model.water.trimmed_arm import TrimmedArm
from alpha5_model.water.vehicle import Vehicle, carrier_of, warn_upside_down

#: Of the grid: between places, and yaw angles in a turn.
SPACING = 0.1
YAWS = 12
#: A box is tried at its corners, and between them at most so far apart [m].
BOX_SPACING = 0.025
#: More poses, or points of boxes, are not meant.
_MOST = 1_000_000
#: Joint positions that are looked at together.
_BLOCK = 40_000


class _Task(NamedTuple):
    """What is asked of each pose.

    Attributes:
        asked: Names of the arguments that give the points.
        points: In the world, (T, 3) [m].
        record: Of the arm.
        geometry: Of the arm.
        carried: The arm itself, and the hull beside it.
        world: The obstacles.
        wrist: theta_3 [rad].
        clearance: That is kept to obstacles [m].
    """

    asked: str
    points: FloatArray
    record: Alpha5Parameters
    geometry: Geometry
    carried: Surroundings
    world: World
    wrist: float
    clearance: float


#: For what poses are left out, in this order.
_TOUCHING = (
    "hull or link_0 and an obstacle",
    "arm and itself or hull",
    "arm and an obstacle",
)


class _Found(NamedTuple):
    """Poses at which nothing touches; attributes as those of `Placements`.

    Attributes:
        row: Number of each pose, (N,).
        touching: How many other poses were left out for each of `_TOUCHING`, one row
            for each block.
    """

    row: np.ndarray
    q: FloatArray
    branch: np.ndarray
    clearance: FloatArray
    hull_clearance: FloatArray
    reach_margin: FloatArray
    touching: np.ndarray


def placements(
    targets: ArrayLike,
    *,
    arm: Alpha5Parameters | Arm | None = None,
    vehicle: Vehicle | Mapping[str, Any] | None = None,
    mount: ArrayLike | None = None,
    hull: Iterable[Obstacle] = (),
    obstacles: Iterable[Obstacle] = (),
    clearance: float = MARGIN,
    box: ArrayLike | None = None,
    wrist: float = 0.0,
    poses: ArrayLike | None = None,
    spacing: float = SPACING,
    yaws: int = YAWS,
    tilts: ArrayLike = ((0.0, 0.0),),
) -> Placements:
    """Poses of a vehicle from which its arm reaches all of some points.

    The world has z up, and its origin is near the points. At a pose that is returned,
    the arm has a joint position within its limits for each point, at which it does not
    touch itself and keeps 5 mm to the hull, and arm and hull keep the clearance to the
    obstacles. link_0 and the hull may touch. How the arm gets there is not looked at:
    see `alpha5_model.plan`.

    If several branches of the inverse kinematics are free at all points, the one with
    the greatest clearance is taken; if none is, the first that is free at each point.

    Args:
        targets: Of the tcp in the world, (3,) or (T, 3) [m].
        arm: Record of the arm, None for the catalogue's, in sea water. Or an `Arm` with
            closed jaws on a fixed base, in another fluid or with a payload; where its
            gravity points does not matter. The tool is on the wrist axis.
        vehicle: That carries the arm: an `alpha5_model.Vehicle`, or a table with
            ``mass``, ``com``, ``volume``, ``cob``, ``xyz`` and ``rpy`` as
            `alpha5_model.calibrate.vehicle_tilt` takes it. None if its weight is not
            known; it then has no `tilt`.
        mount: Pose of base_link in the vehicle's frame, (4, 4). None for that of the
            vehicle, or else of the arm's record, or else the identity.
        hull: Boxes, cylinders and spheres on the vehicle in base_link, as `plan` takes
            them.
        obstacles: Boxes, cylinders and spheres in the world.
        clearance: Distance that arm and hull keep to obstacles [m].
        box: Edges along the world's axes of a box about each target, all of which is to
            be reached, (3,) [m]. It is tried at its corners and at points of a grid
            that are at most 25 mm apart; what is between them is not proved.
        wrist: theta_3 at all points [rad].
        poses: x, y, z [m] and roll, pitch, yaw [rad] of the vehicle's frame in the
            world, that are tried, (6,) or (N, 6). None for a grid of places of
            base_link about the middle of the points.
        spacing: Between the places of the grid, along the world's axes [m].
        yaws: Yaw angles in the grid, evenly over a turn.
        tilts: Roll and pitch in the grid, (2,) or (K, 2) [rad].

    Returns:
        At least one pose, the best first.

    Raises:
        InputError: Arguments that are not as described, or points that are too far
            apart for any pose.
        NoPlacementError: No pose that was tried fits; it says what is possible.

    Warns:
        ImplausibleWarning: Points more than 2 m from the world's origin, a clearance of
            more than that, other numbers that seem to be in another unit, or a vehicle
            whose trim is upside down.
    """
    loaded = loaded_arm(arm)
    record = loaded.parameters
    carrier = None if vehicle is None else carrier_of("vehicle", vehicle)
    mounted = _mount(mount, carrier, record)
    on_vehicle = checked_obstacles(hull, "hull")
    in_world = checked_obstacles(obstacles)
    checked_obstacles((*on_vehicle, *in_world))
    task = _Task(
        asked="targets" if box is None else "targets, box",
        points=_points(targets, box),
        record=record,
        geometry=bounded_geometry(record),
        carried=Surroundings(record, on_vehicle, MARGIN),
        world=World(record, on_vehicle, in_world),
        wrist=_wrist(wrist, record),
        clearance=real("clearance", clearance, minimum=0.0),
    )
    plausibility.check("clearance", task.clearance, plausibility.POSITION)

    if poses is None:
        tried = _grid(task, mounted, spacing, yaws, tilts)
    else:
        tried = _given(poses)
    frames = _frames(tried)
    bases = frames @ mounted
    reaching = _reaching(task, bases)
    found = _free(task, bases, reaching)
    if not len(found.row):
        raise _no_placement(task, bases, reaching)

    base = bases[found.row]
    torque = _holding_torque(loaded, base, found.q)
    effort = np.array([joint.effort for joint in record.joints[:4]])
    tilt = np.full(len(base), math.nan)
    if carrier is not None:
        tilt = _tilt(loaded, carrier, frames[found.row], found.q)
    return Placements(
        points=frozen(task.points),
        pose=tried[found.row],
        base=base,
        q=found.q,
        branch=found.branch,
        clearance=found.clearance,
        hull_clearance=found.hull_clearance,
        reach_margin=found.reach_margin,
        torque=torque,
        holding=(np.abs(torque) / effort).max(axis=(1, 2)),
        tilt=tilt,
        hull=on_vehicle,
        world=in_world,
        tried=len(tried),
    ).ranked()


def _mount(
    given: ArrayLike | None, carrier: Carrier | None, record: Alpha5Parameters
) -> FloatArray:
    """Pose of base_link in the vehicle's frame, (4, 4).

    Raises:
        InputError: Not one rigid transform, or given beside a vehicle, which has one.
    """
    if given is not None and carrier is not None:
        expected = "None beside a vehicle, which has its own (xyz and rpy)"
        raise InputError("mount", given, expected)
    if given is not None:
        mount = rigid_transform("mount", given)
        plausibility.check("mount", mount[:3, 3], plausibility.VEHICLE_POSITION)
        return mount
    if carrier is not None:
        return carrier.mount
    return np.eye(4) if record.mount is None else record.mount.matrix


def _points(targets: ArrayLike, box: ArrayLike | None) -> FloatArray:
    """The points that are to be reached, (T, 3) [m]: targets, or a grid about each.

    Raises:
        InputError: Not points, none, or a box of another size.
    """
    given = bounded("targets", float_array("targets", targets, (3,)))
    points = given.reshape(-1, 3)
    if given.ndim > 2 or not len(points):
        raise ShapeError("targets", given.shape, "shape (3,) or (T, 3), T at least 1")
    farthest = points[np.linalg.norm(points, axis=1).argmax()]
    plausibility.check("targets", farthest, plausibility.POSITION)
    if box is None:
        return points

    edges = array("box", box, 3)
    if edges.min() < 0.0:
        raise InputError("box", edges.tolist(), "edges of at least 0")
    plausibility.check("box", edges, plausibility.POSITION)
    counts = np.ceil(edges / BOX_SPACING - 1e-9) + 1
    if counts.prod() * len(points) > _MOST:
        expected = f"edges with at most {_MOST} points {BOX_SPACING:g} m apart"
        raise InputError("box", edges.tolist(), expected)
    axes = [
        edge * np.linspace(-0.5, 0.5, int(n)) if n > 1 else np.zeros(1)
        for edge, n in zip(edges, counts, strict=True)
    ]
    offsets = np.array(list(product(*axes)))
    return np.asarray((points[:, None] + offsets).reshape(-1, 3))


def _wrist(given: float, record: Alpha5Parameters) -> float:
    """The wrist angle.

    Raises:
        JointLimitError: It is beyond the limits of axis_b.
    """
    wrist = np.array([real("wrist", given)])
    joint = record.joints[3]
    lower, upper = np.array([[joint.lower], [joint.upper]])
    return float(within([joint.name], wrist, lower, upper)[0])


def _given(poses: ArrayLike) -> FloatArray:
    """The poses that a caller gives, (N, 6).

    Raises:
        InputError: Not such poses, or none.
    """
    given = bounded("poses", float_array("poses", poses, (6,)))
    if given.ndim > 2 or not given.size:
        raise ShapeError("poses", given.shape, "shape (6,) or (N, 6), N at least 1")
    tried = given.reshape(-1, 6)
    largest = float(np.abs(tried[:, 3:]).max())
    plausibility.check("angles of poses", largest, plausibility.ANGLE)
    return tried


def _grid(
    task: _Task, mount: FloatArray, spacing: float, yaws: int, tilts: ArrayLike
) -> FloatArray:
    """Poses of the vehicle at which base_link is on a grid about the points, (N, 6).

    Raises:
        InputError: A grid of no size, or of too many poses; points that are too far
            apart for all of its places.
    """
    step = real("spacing", spacing, minimum=1e-3)
    turns = np.arange(count("yaws", yaws)) * (math.tau / yaws)
    given = float_array("tilts", tilts, (2,))
    if given.ndim > 2 or not given.size:
        raise ShapeError("tilts", given.shape, "shape (2,) or (K, 2), K at least 1")
    if np.abs(given).max() > math.pi / 2:
        expected = "roll and pitch of at most pi/2 (5 degrees are 0.087 rad)"
        raise InputError("tilts", given.tolist(), expected)

    geometry = task.geometry
    reach = geometry.a_0 + abs(geometry.d_0) + geometry.longest
    steps = math.ceil(reach / step)
    leanings = given.reshape(-1, 2)
    poses = (2 * steps + 1) ** 3 * len(turns) * len(leanings)
    if poses > _MOST:
        few = f"at most {_MOST} poses, not {poses:.3g}"
        expected = f"a wider grid, or fewer yaws or tilts: {few}"
        raise InputError("spacing", spacing, expected)

    low = task.points.min(axis=0)
    high = task.points.max(axis=0)
    along = step * np.arange(-steps, steps + 1)
    places = np.stack(np.meshgrid(along, along, along, indexing="ij"), axis=-1)
    places = (low + high) / 2 + places.reshape(-1, 3)
    for point in task.points:
        places = places[np.linalg.norm(places - point, axis=1) <= reach]
    if not len(places):
        away = np.linalg.norm(task.points - (low + high) / 2, axis=1).max()
        expected = f"points at most {reach:.3g} m, the arm's length, from their middle"
        raise InputError(task.asked, round(float(away), 3), expected)

    attitudes = np.array([(*lean, turn) for turn in turns for lean in leanings])
    # The vehicle is beside the place of base_link.
    offsets = _rotations(attitudes) @ mount[:3, 3]
    origins = places[:, None] - offsets
    angles = np.broadcast_to(attitudes, origins.shape)
    return np.concatenate([origins, angles], axis=-1).reshape(-1, 6)


def _rotations(rpy: FloatArray) -> FloatArray:
    """Rotations (N, 3, 3) of roll, pitch and yaw (N, 3) [rad]."""
    return np.moveaxis(rotation_from_rpy(rpy.T), -1, 0)


def _frames(poses: FloatArray) -> FloatArray:
    """Poses (N, 6) as transforms, (N, 4, 4)."""
    return transform(_rotations(poses[:, 3:]), poses[:, :3])


def _reaching(task: _Task, bases: FloatArray) -> np.ndarray:
    """Numbers of the bases from which each point is within the joint limits."""
    rows = np.arange(len(bases))
    for point in task.points:
        local = moved(inverse(bases[rows]), point)
        solved = solve(task.geometry, local, task.wrist, angles=False)
        rows = rows[solved.within_limits.any(axis=-1)]
    return rows


def _free(task: _Task, bases: FloatArray, rows: np.ndarray) -> _Found:
    """Those of some bases at which nothing touches, block by block."""
    size = max(1, _BLOCK // (len(BRANCHES) * len(task.points)))
    blocks = [rows[start : start + size] for start in range(0, len(rows), size)]
    parts = [_free_of_block(task, bases, block) for block in blocks or [rows]]
    return _Found(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))


def _free_of_block(task: _Task, bases: FloatArray, rows: np.ndarray) -> _Found:
    """`_free` for so many bases that fit into memory."""
    world = task.world
    counts = [len(rows)]
    rows = rows[~world.blocks_vehicle(bases[rows], task.clearance)]
    counts.append(len(rows))
    local = moved(inverse(bases[rows])[:, None], task.points)
    solved = solve(task.geometry, local, task.wrist)

    # Which branches are free at which point, (N, T, 4).
    free = solved.within_limits.copy()
    free[free] = ~task.carried.touches(solved.q[free])
    kept = _at_all_points(free)
    rows, local, q, free = rows[kept], local[kept], solved.q[kept], free[kept]
    counts.append(len(rows))

    states = (len(rows), free.shape[1] * len(BRANCHES))
    blocked = world.blocks_arm(
        bases[rows], q.reshape(*states, 4), free.reshape(states), task.clearance
    )
    free &= ~blocked.reshape(free.shape)
    kept = _at_all_points(free)
    rows, local, q, free = rows[kept], local[kept], q[kept], free[kept]
    counts.append(len(rows))

    branch, clearance = _chosen(world, bases[rows], q, free)
    return _Found(
        row=rows,
        q=np.take_along_axis(q, branch[..., None, None], axis=2)[:, :, 0],
        branch=branch,
        clearance=clearance,
        hull_clearance=world.vehicle_clearance(bases[rows]),
        reach_margin=reach_margin(task.geometry, local).min(axis=1),
        touching=-np.diff([counts]),
    )


def _at_all_points(free: BoolArray) -> BoolArray:
    """Where some branch of (N, T, 4) is free at each point, (N,)."""
    return np.asarray(np.logical_or.reduce(free, axis=2).all(axis=1))


def _chosen(
    world: World, bases: FloatArray, q: FloatArray, free: BoolArray
) -> tuple[np.ndarray, FloatArray]:
    """The branch for each point, (N, T), and the clearance of the arm, (N,) [m].

    Args:
        world: The obstacles.
        bases: (N, 4, 4).
        q: Of all branches, (N, T, 4, 4) [rad].
        free: Which branches are free, (N, T, 4); at each point one is.
    """
    at_all = np.logical_and.reduce(free, axis=1)
    clearances = np.full(at_all.shape, -math.inf)
    for number in range(len(BRANCHES)):
        rows = np.flatnonzero(at_all[:, number])
        clear = world.arm_clearance(bases[rows], q[rows, :, number])
        clearances[rows, number] = clear
    # Less than a micrometre must not decide.
    best = np.round(clearances, 6).argmax(axis=1)
    branch = np.repeat(best[:, None], free.shape[1], axis=1)
    clearance = clearances[np.arange(len(best)), best]

    mixed = np.flatnonzero(~at_all.any(axis=1))
    branch[mixed] = free[mixed].argmax(axis=2)
    chosen = np.take_along_axis(q[mixed], branch[mixed, :, None, None], axis=2)
    clearance[mixed] = world.arm_clearance(bases[mixed], chosen[:, :, 0])
    return branch, clearance


def _no_placement(
    task: _Task, bases: FloatArray, reaching: np.ndarray
) -> NoPlacementError:
    """Why there is none, and what is possible."""
    beyond = 0.0
    possible = math.nan
    touching = {}
    if not len(reaching):
        short = np.zeros(len(bases))
        for point in task.points:
            local = moved(inverse(bases), point)
            short = np.maximum(short, distance_to_reach(local, arm=task.record))
        beyond = float(short.min())
    else:
        found = _free(task._replace(clearance=0.0), bases, reaching)
        if len(found.row):
            kept = np.minimum(found.clearance, found.hull_clearance)
            possible = float(kept.max())
        sums = found.touching.sum(axis=0).tolist()
        touching = dict(zip(_TOUCHING, sums, strict=True))
    return NoPlacementError(
        tried=len(bases),
        reaching=len(reaching),
        beyond=beyond,
        needed=task.clearance,
        possible=possible,
        touching=touching,
    )


def _holding_torque(arm: Arm, bases: FloatArray, q: FloatArray) -> FloatArray:
    """Torque at rest in still water, (N, T, 4) [N m].

    It is linear in gravity, so three arms are enough for all attitudes.
    """
    strength = float(np.linalg.norm(arm.model.gravity.linear))
    down = -np.repeat(bases[:, 2, :3], q.shape[1], axis=0)
    states = q.reshape(-1, 4)
    rest = np.zeros_like(states)
    torque = np.zeros_like(states)
    for axis, share in zip(np.eye(3), down.T, strict=True):
        pulled = arm._in_gravity(strength * axis)
        torque += share[:, None] * pulled.inverse_dynamics_batch(states, rest, rest)
    return torque.reshape(q.shape)


def _tilt(arm: Arm, carrier: Carrier, frames: FloatArray, q: FloatArray) -> FloatArray:
    """Greatest angle of the vehicle's trim from its attitude in the world, (N,) [rad].

    Args:
        arm: What it carries.
        carrier: The vehicle.
        frames: Its poses, (N, 4, 4).
        q: Of the arm, (N, T, 4) [rad].
    """
    on_vehicle = TrimmedArm(carrier, arm.fluid_density, arm._in_gravity)
    roll, pitch = on_vehicle.trim(q.reshape(-1, 4)).T
    level = np.zeros_like(roll)
    upward = _rotations(np.column_stack([roll, pitch, level]))[:, 2]
    if (upward[:, 2] < 0.0).any():
        warn_upside_down()
    own = np.repeat(frames[:, 2, :3], q.shape[1], axis=0)
    sine = np.linalg.norm(np.cross(own, upward), axis=1)
    cosine = (own * upward).sum(axis=1)
    apart = np.arctan2(sine, cosine).reshape(q.shape[:2])
    return np.asarray(apart.max(axis=1))
