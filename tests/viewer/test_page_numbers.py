"""Solutions, nearest points and contacts of the page, against Python and coal."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import own_arm_dynamics as own
import page_script
import pytest
from pinocchio_collision import CollisionModel
from scipy.optimize import minimize

import alpha5_model as a5
from alpha5_model.viewer.build import build_scene

pytestmark = [
    pytest.mark.tools,
    pytest.mark.skipif(shutil.which("node") is None, reason="there is no node"),
]
COUNT = 40


def arm_of(name: str) -> a5.Arm:
    if name == "locked":
        return a5.load()
    if name == "jaws":
        return a5.load(gripper="jaws")
    seed = {"tool beside": 0, "spacer": 1}[name]
    return a5.load(gripper="jaws", arm=own.RECORDS[seed])


def states(arm: a5.Arm, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Random poses, and points in and out of reach."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(arm.limits.lower, arm.limits.upper, (COUNT, len(arm.joint_names)))
    reached = [arm.forward_kinematics(row).translation for row in q[::2]]
    anywhere = rng.uniform(-0.6, 0.6, (COUNT - len(reached), 3))
    return q, np.concatenate([reached, anywhere])


def close(found: Any, wanted: Any, tolerance: float = 1e-12) -> None:
    np.testing.assert_allclose(np.array(found, float), wanted, rtol=0.0, atol=tolerance)


@pytest.mark.parametrize("name", ["locked", "tool beside", "spacer"])
def test_solutions_and_nearest_points(name: str, tmp_path: Path) -> None:
    arm = arm_of(name)
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
        least = np.linalg.svd(arm.jacobian(row)[:3, :4], compute_uv=False)[-1]
        close(found["weakest"], least, 1e-9)
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


@pytest.mark.parametrize("name", ["jaws", "spacer"])
def test_links_that_touch_are_those_of_coal(name: str, tmp_path: Path) -> None:
    arm = arm_of(name)
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
