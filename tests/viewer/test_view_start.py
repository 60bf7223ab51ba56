"""Where the arm of a scene starts if only a target is given."""

from __future__ import annotations

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import SelfCollisionError
from alpha5_model.viewer.build import build_scene

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
