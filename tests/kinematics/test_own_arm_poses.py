"""Poses, paths, reach and singularities of arms of one's own."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from loops import each
from own_arm import limits, poses, random_arm, tips, turned_apart, with_tool, within

import alpha5_model as a5
from alpha5_model._support.spatial import rotation_about
from alpha5_model.errors import InputError
from alpha5_model.kinematics.pose import approach_directions
from alpha5_model.numbers.parameters import Alpha5Parameters

ON_AXIS = random_arm(np.random.default_rng(21), off_axis=False)
OFF_AXIS = random_arm(np.random.default_rng(22), off_axis=True)
ARMS = [ON_AXIS, OFF_AXIS]


def angle(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Angle between rotations (..., 3, 3), by the chord of their difference [rad]."""
    chord = np.linalg.norm(one - other, axis=(-2, -1))
    return np.asarray(2 * np.arcsin(np.minimum(chord / math.sqrt(8.0), 1.0)))


@pytest.mark.slow
@pytest.mark.parametrize("arm", ARMS)
def test_a_pose_that_can_be_attained_is_attained(arm: Alpha5Parameters) -> None:
    q = within(arm, 200, seed=1)
    target = poses(arm, q)
    s = a5.inverse_kinematics_pose(target, arm=arm)
    assert (s.exact & s.within_limits).any(axis=-1).all()
    best = s.best(q, allow_collision=True)
    assert poses(arm, best) == pytest.approx(target, abs=1e-8)
    own = turned_apart(s.q, q[:, None]) < 1e-6
    assert own.any(axis=-1).mean() > 0.98  # else another one is as good
    reached = poses(arm, np.nan_to_num(s.q))
    off = np.abs(reached[..., :3, 3] - target[:, None, :3, 3]).max(axis=-1)
    assert off[s.exists].max() < 1.1e-10  # a branch may end at the edge of reach
    error = angle(reached[..., :3, :3], target[:, None, :3, :3])
    assert s.rotation_error[s.exists] == pytest.approx(error[s.exists], abs=1e-8)


def fine_grid(arm: Alpha5Parameters, target: np.ndarray, steps: int) -> np.ndarray:
    """Least rotation error of each branch within the limits, (4,) [rad]."""
    lower, upper = limits(arm)
    wrists = np.linspace(lower[3], upper[3], steps)
    s = a5.inverse_kinematics(target[:3, 3], wrists, arm=arm)
    reached = poses(arm, np.nan_to_num(s.q))[..., :3, :3]
    error = angle(reached, target[:3, :3])
    return np.asarray(np.where(s.within_limits, error, np.inf).min(axis=0))


@pytest.mark.slow
def test_no_fine_grid_finds_a_better_orientation() -> None:
    arm = OFF_AXIS
    rng = np.random.default_rng(5)
    target = poses(arm, within(arm, 60, seed=6))
    axes = rng.normal(size=(60, 3))
    axes /= np.linalg.norm(axes, axis=-1, keepdims=True)
    target[:, :3, :3] = (
        rotation_about(axes, rng.uniform(0.1, 1.5, 60)) @ target[:, :3, :3]
    )
    s = a5.inverse_kinematics_pose(target, arm=arm)
    for i, one in enumerate(target):
        least = fine_grid(arm, one, 2001)
        found = np.where(s.within_limits[i], s.rotation_error[i], np.inf)
        assert (found <= least + 1e-6).all()


def test_a_pose_on_the_yaw_axis_is_found() -> None:
    """There only two wrist angles reach, and theta_0 is chosen."""
    arm = with_tool(0.02, 0.03, -0.2)
    lower, upper = limits(arm)
    wrist = math.atan2(-0.03, 0.02) - arm.dh[3].theta_offset + math.pi
    assert lower[3] < wrist < upper[3]
    s = a5.inverse_kinematics([0.0, 0.0, 0.2], wrist, arm=arm)
    q = s.q[s.within_limits][0]
    q[0] = 1.3
    pose = poses(arm, q)
    found = a5.inverse_kinematics_pose(pose, arm=arm)
    assert (found.exact & found.within_limits).any()
    assert poses(arm, found.best(q)) == pytest.approx(pose, abs=1e-8)


@pytest.mark.parametrize("arm", ARMS)
def test_poses_out_of_reach_do_not_exist(arm: Alpha5Parameters) -> None:
    target = np.eye(4)
    target[0, 3] = 0.9
    s = a5.inverse_kinematics_pose(target, arm=arm)
    assert not any(array.flags.writeable for array in s)
    assert not s.exists.any()
    assert np.isnan(s.q).all()
    assert np.isnan(s.rotation_error).all()


def test_the_wrist_axis_has_the_tools_own_orientation() -> None:
    """A tool on the wrist axis that is turned: the closed form, not the search."""
    record = with_tool(0.0, 0.0, -0.21)
    assert record.tool is not None
    axes = (
        rotation_about(np.array([0.6, 0.0, 0.8]), np.array(0.7)) @ record.tool.rotation
    )
    tool = type(record.tool)(position=record.tool.position, rotation=axes)
    arm = type(record)(**{**vars(record), "tool": tool})
    q = within(arm, 100, seed=4)
    s = a5.inverse_kinematics_pose(poses(arm, q), arm=arm)
    assert poses(arm, s.best(q, allow_collision=True)) == pytest.approx(
        poses(arm, q), abs=1e-8
    )


@pytest.mark.parametrize("arm", ARMS)
def test_a_path_goes_on_without_a_jump(arm: Alpha5Parameters) -> None:
    lower, upper = limits(arm)
    t = np.linspace(0.0, 1.0, 80)[:, None]
    middle = (lower + upper) / 2
    q = middle + 0.2 * (upper - lower) * np.sin(t * np.array([2.0, 3.0, 1.0, 2.0]))
    positions = tips(arm, q)
    path = a5.inverse_kinematics_path(
        positions, q[0], q[:, 3], arm=arm, allow_collision=True
    )
    assert tips(arm, path) == pytest.approx(positions, abs=1e-14)
    assert turned_apart(path, q).max() < 1e-8


def test_reach_of_own_lengths_is_that_of_the_inverse_kinematics() -> None:
    rng = np.random.default_rng(3)
    position = rng.uniform(-0.6, 0.6, (3000, 3))
    wrist = sum(limits(ON_AXIS))[3] / 2
    s = a5.inverse_kinematics(position, wrist, arm=ON_AXIS)
    reached = a5.reachable(position, arm=ON_AXIS)
    assert (reached == s.within_limits.any(axis=-1)).all()
    assert 0.05 < reached.mean() < 0.95


@pytest.mark.slow
def test_the_nearest_point_of_own_lengths_is_nearest() -> None:
    rng = np.random.default_rng(4)
    position = rng.uniform(-0.6, 0.6, (40, 3))
    cloud = tips(ON_AXIS, within(ON_AXIS, 200_000, seed=5))
    distance = a5.distance_to_reach(position, arm=ON_AXIS)
    nearest = a5.nearest_reachable(position, arm=ON_AXIS)
    off = np.linalg.norm(position - nearest, axis=-1)
    assert off == pytest.approx(distance, abs=1e-15)
    for i, target in enumerate(position):
        sampled = np.linalg.norm(cloud - target, axis=-1).min()
        assert distance[i] <= sampled + 1e-12
        assert sampled < distance[i] + 0.02
    inwards = nearest + 1e-9 * (cloud.mean(axis=0) - nearest)
    assert (a5.distance_to_reach(inwards, arm=ON_AXIS) < 1e-9).all()


def test_the_volume_of_own_lengths_is_that_of_its_points() -> None:
    rng = np.random.default_rng(6)
    position = rng.uniform(-0.62, 0.62, (200_000, 3))
    share = a5.reachable(position, arm=ON_AXIS).mean()
    assert a5.workspace.volume(arm=ON_AXIS) == pytest.approx(share * 1.24**3, rel=0.02)


def test_approach_directions_are_along_the_wrist_axis() -> None:
    q = within(ON_AXIS, 30, seed=7)
    found = approach_directions(tips(ON_AXIS, q), arm=ON_AXIS)
    ours = -poses(ON_AXIS, q)[..., :3, :3] @ ON_AXIS.tool.rotation.T[:, 2]  # type: ignore[union-attr]
    gap = np.abs(found.directions - ours[:, None]).max(axis=-1)
    assert np.nanmin(gap, axis=-1).max() < 1e-8


@pytest.mark.parametrize("arm", ARMS)
def test_manipulability_is_that_of_finite_differences(arm: Alpha5Parameters) -> None:
    q = within(arm, 50, seed=8)
    h = 1e-6
    columns = [
        (tips(arm, q + h * one) - tips(arm, q - h * one)) / (2 * h) for one in np.eye(4)
    ]
    jacobian = np.stack(columns, axis=-1)
    square = np.linalg.det(jacobian @ jacobian.swapaxes(-1, -2))
    expected = np.sqrt(np.maximum(square, 0.0))
    ours = a5.workspace.manipulability(q, arm=arm)
    assert ours == pytest.approx(expected, rel=1e-6, abs=1e-9)


def test_singular_joint_positions_of_a_tool_beside_the_axis() -> None:
    """The determinant of joints 0 to 2 vanishes where the sets say."""
    q = within(OFF_AXIS, 50, seed=9)
    for name in ("stretched", "folded"):
        off = getattr(a5.workspace.singularities(q, arm=OFF_AXIS), name)
        at = q - off[:, None] * np.array([0.0, 0.0, 1.0, 0.0])
        assert np.abs(determinant(at)).max() < 1e-9
    assert np.abs(determinant(q)).max() > 1e-4
    r = a5.workspace.singularities(q, arm=OFF_AXIS).yaw_axis
    w = np.sqrt(np.square(tips(OFF_AXIS, q)[:, :2]).sum(axis=-1) - r**2)
    same_wrist = q * np.array([0.0, 0.0, 0.0, 1.0])
    at_zero = a5.workspace.singularities(same_wrist, arm=OFF_AXIS).yaw_axis
    radius = np.square(tips(OFF_AXIS, same_wrist)[:, :2]).sum(axis=-1)
    assert w == pytest.approx(np.sqrt(radius - at_zero**2), abs=1e-9)


def determinant(q: np.ndarray) -> np.ndarray:
    """Of the linear Jacobian of joints 0 to 2, by differences."""
    h = 1e-6
    columns = [
        (tips(OFF_AXIS, q + h * one) - tips(OFF_AXIS, q - h * one)) / (2 * h)
        for one in np.eye(4)[:3]
    ]
    return np.asarray(np.linalg.det(np.stack(columns, axis=-1)))


#: What is not bounded by arcs, or has infinitely many answers, for such a tool.
REFUSED: dict[str, Callable[[Any], Any]] = {
    "reachable": lambda arm: a5.reachable([0.2, 0.0, 0.1], arm=arm),
    "distance": lambda arm: a5.distance_to_reach([0.2, 0.0, 0.1], arm=arm),
    "nearest": lambda arm: a5.nearest_reachable([0.2, 0.0, 0.1], arm=arm),
    "boundary": lambda arm: a5.workspace.boundary(arm=arm),
    "in_half_plane": lambda arm: a5.workspace.in_half_plane(
        np.array([0.2]), np.array([0.1]), arm=arm
    ),
    "area": lambda arm: a5.workspace.cross_section_area(arm=arm),
    "volume": lambda arm: a5.workspace.volume(arm=arm),
    "share": lambda arm: a5.workspace.sampled_share(
        lambda q: q[:, 0] > 0.0, samples=10, arm=arm
    ),
    "elbow angles": lambda arm: a5.workspace.singular_elbow_angles(arm=arm),
    "approach": lambda arm: approach_directions([0.2, 0.0, 0.1], arm=arm),
}


@each("name", REFUSED)
def test_what_is_not_exact_beside_the_axis_is_refused(name: str) -> None:
    with pytest.raises(
        InputError, match=r"tool: expected a tool point on the wrist axis"
    ):
        REFUSED[name](OFF_AXIS)
    REFUSED[name](ON_AXIS)
