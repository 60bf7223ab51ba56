"""The kinematics of one record give the catalogue's answers, or its own."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import JointLimitError
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.kinematics.ik import Solutions
from alpha5_model.kinematics.pose import PoseSolutions, approach_directions
from alpha5_model.numbers.parameters import Alpha5Parameters

TARGETS = np.random.default_rng(2).uniform(-0.3, 0.3, (60, 3))
REFERENCE = [1.0, 2.0, 1.5, 0.5]


def with_row(index: int, **changes: float) -> Alpha5Parameters:
    """The catalogue's record with a row of Table 1 changed."""
    record = a5.parameters()
    rows = list(record.dh)
    rows[index] = replace(rows[index], **changes)
    return replace(record, dh=tuple(rows))


def with_joint(index: int, **changes: object) -> Alpha5Parameters:
    """The catalogue's record with a joint changed."""
    record = a5.parameters()
    joints = list(record.joints)
    joints[index] = replace(joints[index], **changes)
    return replace(record, joints=tuple(joints))


def longer() -> Alpha5Parameters:
    return with_row(1, a=a5.parameters().dh[1].a + 0.05)


def wider() -> Alpha5Parameters:
    return with_joint(2, upper=a5.parameters().joints[2].upper + 0.1)


def test_the_geometry_of_another_arm_is_its_own() -> None:
    ours = Geometry.of(a5.parameters())
    geometry = Geometry.of(longer())
    assert geometry.l_1 == pytest.approx(ours.l_1 + 0.05, abs=1e-15)
    assert geometry.longest == pytest.approx(ours.longest + 0.05, abs=1e-15)
    assert geometry.l_2 == ours.l_2
    assert Geometry.of(wider()).upper[2] == ours.upper[2] + 0.1


def test_an_arm_of_the_same_lengths_answers_as_the_catalogue() -> None:
    record = a5.parameters()
    links = (*record.links[:4], replace(record.links[4], mass=0.5))
    arm = replace(record, links=links)
    poses = a5.dh.DHChain.alpha5().forward_kinematics(
        np.random.default_rng(3).uniform(0.5, 3.0, (20, 4))
    )
    inside = TARGETS[a5.reachable(TARGETS)]
    for ours, theirs in (
        (
            a5.inverse_kinematics(TARGETS, 0.4, arm=arm),
            a5.inverse_kinematics(TARGETS, 0.4),
        ),
        (a5.inverse_kinematics_pose(poses, arm=arm), a5.inverse_kinematics_pose(poses)),
    ):
        for one, other in zip(ours, theirs, strict=True):
            np.testing.assert_array_equal(one, other)
    np.testing.assert_array_equal(
        a5.inverse_kinematics(inside, arm=arm).best(REFERENCE, allow_collision=True),
        a5.inverse_kinematics(inside).best(REFERENCE, allow_collision=True),
    )
    np.testing.assert_array_equal(
        approach_directions(TARGETS, arm=arm).directions,
        approach_directions(TARGETS).directions,
    )
    np.testing.assert_array_equal(
        a5.nearest_reachable(TARGETS, arm=arm), a5.nearest_reachable(TARGETS)
    )
    assert a5.workspace.volume(arm=arm) == a5.workspace.volume()


def test_the_public_functions_keep_the_limits_unless_told_otherwise() -> None:
    space = a5.workspace
    for function in (space.cross_section_area, space.volume, space.boundary):
        assert function() == function(limits=True) != function(limits=False)
    for function in (a5.reachable, a5.distance_to_reach):
        kept = function(TARGETS)
        np.testing.assert_array_equal(kept, function(TARGETS, True))
        assert not np.array_equal(kept, function(TARGETS, False))


def test_a_refusal_names_the_joint_of_the_arm_that_was_solved() -> None:
    arm = with_joint(3, name="left_axis_b")
    with pytest.raises(JointLimitError, match="left_axis_b"):
        a5.inverse_kinematics([0.2, 0.0, 0.1], 6.25, arm=arm).best(REFERENCE)
    with pytest.raises(JointLimitError, match=r"^axis_b"):
        a5.inverse_kinematics([0.2, 0.0, 0.1], 6.25).best(REFERENCE)


@pytest.mark.parametrize(("wrist", "bound"), [(6.22, 6.2), (-0.02, 0.0)])
def test_a_refusal_names_the_limit_that_is_passed(wrist: float, bound: float) -> None:
    with pytest.raises(JointLimitError) as caught:
        a5.inverse_kinematics([0.2, 0.0, 0.1], wrist).best(REFERENCE)
    assert (caught.value.value, caught.value.bound) == pytest.approx((wrist, bound))


def test_the_first_target_without_a_solution_is_named() -> None:
    targets = [[0.2, 0.0, 0.1], [0.9, 0.0, 0.1], [0.2, 0.1, 0.1], [0.8, 0.0, 0.1]]
    with pytest.raises(a5.UnreachableError, match="row 1") as caught:
        a5.inverse_kinematics(targets).best(REFERENCE)
    assert caught.value.position == pytest.approx(targets[1])


@pytest.mark.parametrize(
    ("solve", "kind"),
    [
        (lambda: a5.inverse_kinematics([0.2, 0.0, 0.1]), Solutions),
        (lambda: a5.inverse_kinematics(TARGETS), Solutions),
        (lambda: a5.inverse_kinematics_pose(np.eye(4)), PoseSolutions),
    ],
)
def test_solutions_are_of_the_public_class_and_can_be_pickled(
    solve: Callable[[], Solutions | PoseSolutions], kind: type
) -> None:
    solutions = solve()
    assert type(solutions) is kind
    assert len(solutions) == len(kind._fields)
    assert not hasattr(solutions, "__dict__")
    again = pickle.loads(pickle.dumps(solutions))
    assert type(again) is kind
    for one, other in zip(solutions, again, strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize(
    "solve",
    [
        lambda arm: a5.inverse_kinematics(TARGETS, arm=arm),
        lambda arm: a5.inverse_kinematics_pose(np.eye(4)[None], arm=arm),
    ],
)
@pytest.mark.parametrize(
    "remade",
    [
        lambda s: s._replace(position=s.position),
        lambda s: type(s)(*(array[0] for array in s)),
        lambda s: s._make(s),
        copy.copy,
        copy.deepcopy,
        lambda s: pickle.loads(pickle.dumps(s)),
    ],
)
def test_solutions_keep_their_arm(
    solve: Callable[[Alpha5Parameters], Any], remade: Callable[[Any], Any]
) -> None:
    for arm in (a5.parameters(), longer()):
        solutions = solve(arm)
        assert isinstance(solutions, Solutions | PoseSolutions)
        again = remade(solutions)
        assert solutions.arm is arm
        assert again.arm.dh[1].a == arm.dh[1].a
        assert again.collides.shape == again.exists.shape


def test_one_row_of_a_batch_chooses_as_the_batch() -> None:
    arm = longer()
    batch = a5.inverse_kinematics(TARGETS, arm=arm)
    solved = batch.within_limits.any(axis=-1)
    batch = type(batch)(*(array[solved] for array in batch))
    row = type(batch)(*(array[2] for array in batch))
    best = batch.best(REFERENCE, allow_collision=True)
    np.testing.assert_array_equal(row.best(REFERENCE, allow_collision=True), best[2])
