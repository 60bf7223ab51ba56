"""Lines in space, and the fit of one arm's axes to another's, from any start."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from urdf_edits import OWN

import alpha5_model as a5
from alpha5_model.description.reading import parse_urdf
from alpha5_model.proofs.comparison.alignment import Alignment
from alpha5_model.proofs.comparison.axis_fit import (
    AxisFit,
    Linearized,
    _angle_about,
    _base_frame,
    _residual,
)
from alpha5_model.proofs.comparison.axis_lines import (
    AxisLines,
    axis_shape,
    cross,
    foot,
    twists,
)
from alpha5_model.proofs.comparison.chains import find_chains
from alpha5_model.proofs.comparison.line_screws import POSE_UNKNOWNS
from alpha5_model.proofs.comparison.own_arm import own_arm_of
from alpha5_model.proofs.comparison.placement import _by_base_or_shoulder, _on_z_axis
from alpha5_model.proofs.comparison.reduction import reduce_robot

RECORD = a5.parameters()
#: Lengths of few digits: no alignment fits it exactly.
ROUNDED = OWN.replace("0.1507053084665567", "0.151").replace("0.0462", "0.046")


def lines(rng: np.random.Generator, *shape: int) -> AxisLines:
    directions = rng.normal(size=(*shape, 3))
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    return AxisLines(points=rng.normal(size=(*shape, 3)), directions=directions)


@pytest.mark.parametrize("seed", range(3))
def test_the_foot_is_the_point_nearest_to_the_other_line(seed: int) -> None:
    """By least squares: the shortest step from one line to the other."""
    two = lines(np.random.default_rng(seed), 5, 2)
    feet = foot(two, 0, 1)
    for k in range(5):
        points, directions = two.points[k], two.directions[k]
        steps = np.column_stack([directions[0], -directions[1]])
        along, _ = np.linalg.lstsq(steps, points[1] - points[0], rcond=None)[0]
        assert feet[k] == pytest.approx(points[0] + along * directions[0])


def test_parallel_lines_have_a_foot_too() -> None:
    z = np.array([0.0, 0.0, 1.0])
    two = AxisLines(
        points=np.array([[0.1, 0.2, 0.3], [1.0, 0.0, 0.0]]), directions=np.array([z, z])
    )
    assert foot(two, 0, 1)[:2] == pytest.approx([0.1, 0.2])
    shape = axis_shape(AxisLines(points=np.eye(4, 3), directions=np.tile(z, (4, 1))))
    assert np.isfinite(shape).all()


def test_the_shape_of_axes_by_hand() -> None:
    """Two right angles, a slant, and the second and third axis parallel."""
    slant = 0.4
    directions = np.array(
        [[0, 0, 1], [0, -1, 0], [0, 1, 0], [math.cos(slant), math.sin(slant), 0]]
    )
    points = np.array([[0, 0, 7.0], [2, 3, 0.5], [2, 9, 1.5], [1.0, 5, 1.8]])
    shape = axis_shape(AxisLines(points=points, directions=directions))
    # The last axis meets the plane y = const. of its own foot on the third one.
    third = foot(AxisLines(points=points, directions=directions), 2, 3)
    offset = abs(third[1])
    expected = [2.0, 1.0, 0.3, offset, math.pi / 2, 0.0, math.pi / 2 - slant]
    assert shape == pytest.approx(expected)
    turned = pin.exp3(np.array([0.3, -0.8, 0.5]))
    moved = AxisLines(points=points @ turned.T + 0.2, directions=directions @ turned.T)
    assert axis_shape(moved) == pytest.approx(shape)
    assert twists(moved) == pytest.approx(shape[4:])


def test_the_cross_product() -> None:
    rng = np.random.default_rng(0)
    a, b = rng.normal(size=(2, 4, 5, 3))
    assert cross(a, b) == pytest.approx(np.cross(a, b))


def test_a_base_frame_needs_no_second_direction() -> None:
    z = np.array([0.6, 0.0, 0.8])
    for second in (np.array([0.0, 1.0, 0.0]), z, -z, np.array([0.8, 0.0, 0.6])):
        two = AxisLines(points=np.zeros((2, 3)), directions=np.array([z, second]))
        frame = _base_frame(two)
        assert frame[:, 2] == pytest.approx(z)
        assert frame.T @ frame == pytest.approx(np.eye(3))
        assert np.linalg.det(frame) == pytest.approx(1.0)
        # axis_d lies in the y-z plane.
        assert second @ frame[:, 0] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("angle", [-3.0, -1.0, 0.5, 3.1])
def test_the_angle_about_an_axis_that_turns_one_vector_to_another(angle: float) -> None:
    axis = np.array([2.0, -1.0, 2.0]) / 3
    start = np.array([0.3, 0.5, -0.2])
    end = 1.7 * pin.exp3(axis * angle) @ start + 0.4 * axis
    assert _angle_about(axis, start, end) == pytest.approx(angle)


def test_a_residual_of_lines() -> None:
    """The mean over all entries, and over the angles of the lines."""
    error = np.array([[3e-3, 0, 0, 0, 4e-3, 0], [0, 0, 0, 0, 0, 2e-3]])
    of_entries = math.sqrt((9 + 16 + 4) / 12) * 1e-3
    of_angles = math.sqrt((16 + 4) / 2) * 1e-3
    assert _residual(error.ravel()) == pytest.approx((of_entries, of_angles))


def fit_of(text: str) -> AxisFit:
    robot = parse_urdf(text)
    chain = find_chains(robot, RECORD)[0]
    arm = reduce_robot(robot, chain.joints, RECORD)
    return AxisFit(our_arm=own_arm_of(RECORD), their_arm=arm)


@pytest.mark.parametrize(
    ("text", "far", "most"),
    [
        (OWN, 0.0, 3),
        (OWN, 0.5, 8),
        (OWN, 3.0, 30),
        (ROUNDED, 0.0, 6),
        (ROUNDED, 3.0, 30),
    ],
)
def test_a_fit_finds_the_same_from_any_start_in_few_steps(
    text: str, far: float, most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    fit = fit_of(text)
    best = fit.fit(Alignment(), POSE_UNKNOWNS)
    rng = np.random.default_rng(1)
    base = np.eye(4)
    base[:3, :3] = pin.rpy.rpyToMatrix(*(far * rng.uniform(-1, 1, 3)))
    base[:3, 3] = far * rng.uniform(-0.3, 0.3, 3)
    start = Alignment(base=base, zero=far * np.array([0.0, 0.5, -0.4, 0.0]))

    count = 0
    linearized = AxisFit.linearized

    def counted(self: AxisFit, alignment: Alignment) -> Linearized:
        nonlocal count
        count += 1
        return linearized(self, alignment)

    monkeypatch.setattr(AxisFit, "linearized", counted)
    found = fit.fit(start, POSE_UNKNOWNS)
    assert count <= most
    assert found.base == pytest.approx(best.base, abs=1e-7)
    assert found.zero == pytest.approx(best.zero, abs=1e-7)
    assert found.residual == pytest.approx(best.residual, abs=1e-9)
    # No small change of the pose fits better.
    for step in 1e-5 * np.eye(3):
        nudged = found.base.copy()
        nudged[:3, 3] += step
        other = linearized(fit, Alignment(base=nudged, zero=found.zero))
        assert other.squared_error > linearized(fit, found).squared_error


# --- where the bodies are


def test_an_axis_comes_onto_z_by_the_shortest_turn() -> None:
    rng = np.random.default_rng(5)
    for _ in range(5):
        pose = np.eye(4)
        pose[:3, :3] = pin.exp3(rng.normal(size=3))
        pose[:3, 3] = rng.normal(size=3)
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        moved = _on_z_axis(pose, axis)
        assert moved[:3, :3] @ axis == pytest.approx([0, 0, 1], abs=1e-12)
        assert moved[:3, 3] == pytest.approx([0, 0, pose[2, 3]])
        turn = moved[:3, :3] @ pose[:3, :3].T
        angle = math.acos((pose[:3, :3] @ axis)[2])
        assert np.linalg.norm(pin.log3(turn)) == pytest.approx(angle)
        assert _on_z_axis(moved, axis) == pytest.approx(moved, abs=1e-12)


@pytest.mark.parametrize("height", [0.02, -0.03])
@pytest.mark.parametrize("by", ["base", "shoulder"])
def test_link_1_stands_where_its_com_fits(by: str, height: float) -> None:
    """Their base_link is too high: link 1 may have moved with it, or not."""
    own = own_arm_of(RECORD)
    com = own.reduced.com.copy()
    if by == "base":
        com[1, 2] += height
    theirs: Any = SimpleNamespace(com=com)
    placed = _by_base_or_shoulder(own, theirs, np.eye(4), height)
    expected = np.eye(4)
    expected[2, 3] = -height if by == "base" else 0.0
    assert placed == pytest.approx(expected)
