"""Lines in space, and the fit of one arm's axes to another's, from any start."""

from __future__ import annotations

import math

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
)
from alpha5_model.proofs.comparison.axis_lines import (
    AxisLines,
    axis_shape,
    foot,
    twists,
)
from alpha5_model.proofs.comparison.chains import find_chains
from alpha5_model.proofs.comparison.line_screws import POSE_UNKNOWNS
from alpha5_model.proofs.comparison.own_arm import own_arm_of
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
