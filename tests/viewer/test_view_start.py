"""Where the arm of a scene starts if only a target is given."""

from __future__ import annotations

import numpy as np
import own_arm_dynamics as own
import pytest

import alpha5_model as a5
from alpha5_model.errors import SelfCollisionError
from alpha5_model.viewer.build import _beside, build_scene

HOME = a5.named_pose("home")


def only_colliding(points: np.ndarray) -> np.ndarray:
    """The first of some points that the arm reaches in self-collision only, (3,)."""
    for point in points:
        found = a5.inverse_kinematics(point, HOME[3])
        reaches = found.within_limits
        if reaches.any() and found.collides[reaches].all():
            return point
    raise AssertionError


def test_a_target_that_is_reached_only_in_self_collision_is_still_reached() -> None:
    arm = a5.load(gripper="jaws")
    rng = np.random.default_rng(3)
    point = only_colliding(rng.uniform(-0.2, 0.2, (4000, 3)))
    with pytest.raises(SelfCollisionError):
        a5.inverse_kinematics(point, HOME[3]).best(HOME)
    scene = build_scene(arm, target=point)
    tcp = arm.forward_kinematics(scene.q, "tcp").translation
    np.testing.assert_allclose(tcp, point, atol=1e-9)
    assert scene.q[4] == arm.limits.lower[4]  # the jaws are closed


def test_a_tool_beside_the_wrist_axis_turns_as_little_as_needed() -> None:
    """In steps of a ninetieth of its range; not at all if the target is in reach."""
    record = own.RECORDS[0]
    low = record.joints[3].lower
    step = (record.joints[3].upper - low) / 90
    wrists = low + step * np.arange(91)
    rng = np.random.default_rng(5)
    turned = []
    for point in rng.uniform(-0.3, 0.3, (30, 3)):
        found = _beside(record, point, HOME)
        tried = [HOME[3], *wrists]
        solutions = [a5.inverse_kinematics(point, wrist, arm=record) for wrist in tried]
        free = [bool((each.within_limits & ~each.collides).any()) for each in solutions]
        away = np.abs(np.array(tried) - HOME[3])
        if any(free):
            assert found is not None
            least = away[np.array(free)].min()
            assert abs(found[3] - HOME[3]) == pytest.approx(least, abs=1e-12)
            turned.append(least)
        elif found is not None:
            assert a5.inverse_kinematics(
                point, found[3], arm=record
            ).within_limits.any()
    assert min(turned) == 0.0
    assert max(turned) > 10 * step
