"""Which pairs of links descriptions leave out, against coal's distances."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from coal_reference import CoalReference

import alpha5_model as a5
from alpha5_model.collision.link_pairs import (
    NEVER_PAIRS,
    NEVER_WITHIN_LIMITS,
    disabled_pairs,
)
from alpha5_model.numbers.parameters import Alpha5Parameters


def positions(arm: a5.Arm, count: int, wider: float = 0.0) -> np.ndarray:
    """Random ones within the limits, in half of which joints are at one."""
    rng = np.random.default_rng(50)
    lower, upper = arm.limits.lower.copy(), arm.limits.upper.copy()
    lower[:4] -= wider
    upper[:4] += wider
    q = rng.uniform(lower, upper, (count, len(lower)))
    ends = np.where(rng.random(q.shape) < 0.5, lower, upper)
    at_end = rng.random(q.shape) < 0.4
    at_end[: count // 2] = False
    return np.where(at_end, ends, q)


@pytest.mark.parametrize("gripper", NEVER_WITHIN_LIMITS)
def test_pairs_that_are_left_out_do_not_meet_within_the_limits(gripper: str) -> None:
    arm = a5.load(gripper=gripper)
    never = {frozenset(pair) for pair in NEVER_WITHIN_LIMITS[gripper]}
    least = least_distances(gripper, positions(arm, 200))
    assert all(least[pair] > 0.0 for pair in never)
    # Other pairs touch, and of these one does beyond the limits.
    assert min(least[pair] for pair in least.keys() - never) < -0.01
    wide = least_distances(gripper, positions(arm, 50, wider=0.5))
    assert wide[frozenset({"link_2", "link_4"})] < 0.0


def least_distances(gripper: str, rows: np.ndarray) -> dict[frozenset[str], float]:
    """The least distance of each pair of links by coal [m]."""
    reference = CoalReference(gripper)
    least: dict[frozenset[str], float] = {}
    for row in rows:
        for links, distance in reference.link_distances(row).items():
            pair = frozenset(links)
            least[pair] = min(least.get(pair, np.inf), distance)
    return least


def with_elbow(**limits: float) -> Alpha5Parameters:
    """The catalogue's arm with other limits of axis_c."""
    record = a5.parameters()
    joints = list(record.joints)
    joints[2] = replace(joints[2], **limits)
    return replace(record, joints=tuple(joints))


def test_an_arm_with_wider_limits_keeps_only_what_no_position_brings_together() -> None:
    never = set(NEVER_PAIRS)
    within = set(NEVER_WITHIN_LIMITS["jaws"])
    catalogue = a5.parameters()
    elbow = catalogue.joints[2]
    row = catalogue.dh[1]
    longer = (catalogue.dh[0], replace(row, a=row.a + 1e-3), *catalogue.dh[2:])
    turned = (catalogue.dh[0], replace(row, theta_offset=0.1), *catalogue.dh[2:])
    for arm, pairs in (
        (catalogue, never | within),
        (with_elbow(upper=elbow.upper - 0.1), never | within),
        (with_elbow(upper=elbow.upper + 1e-3), never),
        (with_elbow(lower=elbow.lower - 1e-3), never),
        (replace(catalogue, dh=longer), never),
        (replace(catalogue, dh=turned), never),
    ):
        assert set(disabled_pairs(arm, "jaws")["Never"]) == pairs
