"""What the page computes, against Pinocchio, coal and Newton-Euler of the record."""

from __future__ import annotations

import shutil
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import own_arm_dynamics as own
import page_script
import pytest
from pinocchio_collision import CollisionModel
from scipy.optimize import minimize

import alpha5_model as a5
from alpha5_model.numbers.fluids import FRESH_WATER, GRAVITY, SEA_WATER
from alpha5_model.numbers.hydrodynamics import LEVELS
from alpha5_model.viewer.build import build_scene

pytestmark = [
    pytest.mark.tools,
    pytest.mark.skipif(shutil.which("node") is None, reason="there is no node"),
]
MASS, COM, VOLUME = 0.3, (0.01, 0.0, 0.02), 5e-5
CURRENT = (0.3, -0.4, 0.2)
COUNT = 40


@dataclass
class Case:
    """A page, and the arm whose numbers it must have.

    Attributes:
        arm: With everything that the page has.
        shown: That the page is made of.
        options: Of `build_scene`.
        part: Entries of the page's state that are changed after it has opened.
        flows: Whether the current is counted.
    """

    arm: a5.Arm
    shown: a5.Arm
    options: dict[str, Any] = field(default_factory=dict)
    part: dict[str, Any] = field(default_factory=dict)
    flows: bool = False


def held(arm: a5.Arm) -> a5.Arm:
    return arm.with_payload(MASS, COM, volume=VOLUME)


def tilted(roll: float, pitch: float) -> np.ndarray:
    """Gravity in a base with this attitude."""
    x = np.array([1.0, 0.0, 0.0]), np.array([0.0, np.cos(roll), -np.sin(roll)])
    about_x = np.array([*x, [0.0, np.sin(roll), np.cos(roll)]])
    y = [np.cos(pitch), 0.0, np.sin(pitch)], [0.0, 1.0, 0.0]
    about_y = np.array([*y, [-np.sin(pitch), 0.0, np.cos(pitch)]])
    return (about_y @ about_x).T @ GRAVITY


def case(name: str) -> Case:
    payload = (MASS, COM, VOLUME)
    jaws = a5.load(gripper="jaws")
    if name == "locked":
        return Case(arm=a5.load(), shown=a5.load())
    if name == "fluid changed":
        fresh = a5.load(FRESH_WATER, gripper="jaws")
        return Case(arm=fresh, shown=jaws, part={"density": FRESH_WATER})
    if name == "mount changed":
        arm = a5.load(gravity=tilted(2.5, -0.6), gripper="jaws")
        return Case(arm=arm, shown=jaws, part={"attitude": [2.5, -0.6]})
    if name == "payload changed":
        part = {"payload": {"mass": MASS, "com": COM, "volume": VOLUME}}
        return Case(arm=held(jaws), shown=jaws, part=part)
    if name == "current on a mount":
        arm = a5.load(gravity=(3.0, -5.0, -7.0))
        options = {"payload": payload, "water_velocity": CURRENT}
        return Case(arm=held(arm), shown=arm, options=options, flows=True)
    seed = {"tool beside": 0, "spacer": 1, "own mount": 9}[name]
    arm = a5.load(gripper="jaws", arm=own.RECORDS[seed])
    return Case(arm=held(arm), shown=arm, options={"payload": payload})


NAMES = (
    "locked",
    "fluid changed",
    "mount changed",
    "payload changed",
    "current on a mount",
    "tool beside",
    "spacer",
    "own mount",
)


def states(arm: a5.Arm, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Random poses, and points in and out of reach."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(arm.limits.lower, arm.limits.upper, (COUNT, len(arm.joint_names)))
    reached = [arm.forward_kinematics(row).translation for row in q[::2]]
    anywhere = rng.uniform(-0.6, 0.6, (COUNT - len(reached), 3))
    return q, np.concatenate([reached, anywhere])


def close(found: Any, wanted: Any, tolerance: float = 1e-12) -> None:
    np.testing.assert_allclose(np.array(found, float), wanted, rtol=0.0, atol=tolerance)


@pytest.mark.parametrize("name", NAMES)
def test_poses_torques_and_loads_are_pinocchios(name: str, tmp_path: Path) -> None:
    one = case(name)
    q, points = states(one.shown, NAMES.index(name))
    scene = build_scene(one.shown, **one.options)
    still = np.zeros(q.shape[1])
    for row, found in zip(
        q, page_script.computed(scene, tmp_path, q, points, one.part), strict=True
    ):
        base = np.array(found["poses"]["base_link"])
        # Gravity points down in the picture.
        gravity = np.array(one.arm.model.gravity.linear)
        close(base[:, :3] @ gravity, [0.0, 0.0, -np.linalg.norm(gravity)])
        for link, pose in found["poses"].items():
            if link == "world":
                continue
            wanted = one.arm.forward_kinematics(row, frame=link).homogeneous
            close(pose, base @ wanted)
        if one.flows:
            levels = [one.arm.with_hydrodynamics(CURRENT, level) for level in LEVELS]
            each = [arm.inverse_dynamics(row, still, still)[:4] for arm in levels]
            wanted = np.stack([np.min(each, axis=0), each[1], np.max(each, axis=0)])
        else:
            wanted = np.tile(one.arm.hydrostatic_torque(row)[:4], (3, 1))
        close(found["torques"], wanted.T)
        load = one.arm.base_wrench(row, still, still)
        close(found["rest"], [load.linear, load.angular])
        least = np.linalg.svd(one.arm.jacobian(row)[:3, :4], compute_uv=False)[-1]
        close(found["weakest"], least, 1e-9)


def test_another_density_is_seen(tmp_path: Path) -> None:
    """Negative control: 1 kg/m^3 more is another torque."""
    arm = a5.load()
    q, points = states(arm, 1)
    found = page_script.computed(
        build_scene(arm), tmp_path, q, points, {"density": SEA_WATER + 1}
    )
    values = np.array([[t[1] for t in one["torques"]] for one in found])
    wanted = np.array([arm.hydrostatic_torque(row) for row in q])
    assert np.abs(values - wanted).max() > 1e-4


@pytest.mark.parametrize("seed", [0, 1, 9])
def test_an_own_arm_is_that_of_its_record(seed: int, tmp_path: Path) -> None:
    """Frames, tool and torques by Newton-Euler of the record alone."""
    record = own.RECORDS[seed]
    arm = a5.load(arm=record)
    q, _, _ = own.states(record, 10)
    still = np.zeros_like(q)
    mounted = np.eye(3) if record.mount is None else record.mount.rotation
    wanted, _ = own.inverse_dynamics(
        record, q, still, still, SEA_WATER, mounted.T @ GRAVITY
    )
    rotations, origins = own.link_frames(record, q)
    answers = page_script.computed(
        build_scene(arm), tmp_path, q, np.zeros((10, 3)), None
    )
    for i, found in enumerate(answers):
        base = np.array(found["poses"]["base_link"])
        for link in range(5):
            pose = np.array(found["poses"][f"link_{link}"])
            close(pose[:, :3], base[:, :3] @ rotations[link, i])
            close(pose[:, 3], base[:, :3] @ origins[link, i])
        close(found["poses"]["tcp"], base @ own.tcp(record, q[i]))
        close([t[1] for t in found["torques"]], wanted[i])


@pytest.mark.parametrize("name", ["locked", "tool beside", "spacer"])
def test_solutions_and_nearest_points(name: str, tmp_path: Path) -> None:
    arm = case(name).shown
    record = arm.parameters
    rng = np.random.default_rng(3)
    anywhere = rng.normal((0.0, 0.0, 0.1), 0.35, (40, 3))
    near_axis_and_folded = rng.normal((0.0, 0.0, 0.05), 0.06, (60, 3))
    beyond_axis_e = np.outer(rng.uniform(-1.5, 1.5, 20), [0.4, -0.025, 0.1])
    q, points = states(arm, 3)
    points = np.concatenate([points, anywhere, near_axis_and_folded, beyond_axis_e])
    q = np.tile(q, (4, 1))
    on_axis = name != "tool beside"
    limits = arm.limits.lower[:4] - 1e-9, arm.limits.upper[:4] + 1e-9
    answers = page_script.computed(build_scene(arm), tmp_path, q, points)
    for row, point, found in zip(q, points, answers, strict=True):
        solved = a5.inverse_kinematics(point, row[3], arm=record)
        close(found["solutions"]["q"], solved.q, 1e-9)
        assert found["solutions"]["exists"] == solved.exists.tolist()
        assert found["solutions"]["within_limits"] == solved.within_limits.tolist()
        for branch, way in enumerate(found["reach"]):
            turned = np.array(way["q"])
            assert ((limits[0] <= turned) & (turned <= limits[1])).all()
            place = arm.forward_kinematics([*turned, *row[4:]]).translation
            close(np.linalg.norm(place - point), way["away"], 1e-9)
            assert (way["away"] == 0.0) == bool(solved.within_limits[branch])
            if solved.within_limits[branch]:
                close(turned, solved.q[branch], 1e-9)
        if on_axis:
            away = min(way["away"] for way in found["reach"])
            close(away, a5.distance_to_reach(point, arm=record), 1e-9)


@pytest.mark.slow
def test_the_nearest_point_of_a_tool_beside_the_axis(tmp_path: Path) -> None:
    """Against descents from the best points of a grid."""
    record = own.RECORDS[0]
    arm = a5.load(arm=record)
    rng = np.random.default_rng(4)
    points = rng.uniform(-0.6, 0.6, (12, 3))
    q = rng.uniform(arm.limits.lower, arm.limits.upper, (12, 4))
    answers = page_script.computed(build_scene(arm), tmp_path, q, points)
    for row, point, found in zip(q, points, answers, strict=True):
        away = min(way["away"] for way in found["reach"])
        assert away == pytest.approx(searched(record, point, row[3]), abs=1e-6)


def searched(record: Any, point: np.ndarray, wrist: float) -> float:
    """Least distance to a point at an angle of axis_b."""
    lower, upper = own.own_arm.limits(record)
    axes = [np.linspace(a, b, 25) for a, b in zip(lower[:3], upper[:3], strict=True)]
    grid = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 3)
    q = np.column_stack([grid, np.full(len(grid), wrist)])

    def square(turned: np.ndarray) -> float:
        tip = own.own_arm.tips(record, np.array([*turned, wrist]))
        return float(np.sum((tip - point) ** 2))

    gaps = np.linalg.norm(own.own_arm.tips(record, q) - point, axis=1)
    bounds = list(zip(lower[:3], upper[:3], strict=True))
    ends = [
        minimize(
            square, start, bounds=bounds, method="L-BFGS-B", options={"ftol": 1e-16}
        ).fun
        for start in grid[np.argsort(gaps)[:12]]
    ]
    return float(np.sqrt(min(ends)))


@pytest.mark.parametrize("name", ["fluid changed", "spacer"])
def test_links_that_touch_are_those_of_coal(name: str, tmp_path: Path) -> None:
    arm = case(name).shown
    rng = np.random.default_rng(6)
    q = rng.uniform(arm.limits.lower, arm.limits.upper, (250, len(arm.joint_names)))
    answers = page_script.computed(build_scene(arm), tmp_path, q, np.zeros((250, 3)))
    coal = CollisionModel(arm.model, arm.parameters)
    count = 0
    for row, found in zip(q, answers, strict=True):
        if abs(coal.clearance(row).distance) < 1e-6:
            continue
        pairs = {frozenset(pair) for pair in found["touching"]}
        assert pairs == {frozenset(pair) for pair in coal.colliding_links(row)}
        count += bool(pairs)
    assert count > 5
