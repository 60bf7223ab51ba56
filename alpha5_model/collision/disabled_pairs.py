"""Pairs of links whose contact other programs need not check: for SRDF and MJCF."""

from __future__ import annotations

from alpha5_model.collision.bodies import collision_bodies, joint_ranges
from alpha5_model.collision.cells_file import digest
from alpha5_model.collision.link_pairs import (
    NEVER_WITHIN_LIMITS,
    Pairs,
    unchecked_pairs,
)
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters


def disabled_pairs(arm: Alpha5Parameters, gripper: str) -> dict[str, Pairs]:
    """Pairs of links, by the reason in the words of SRDF.

    ``Never`` are those that cannot meet within the joint limits. For an arm of your own
    that is proven with its lengths, zeros, limits and spacer.

    Args:
        arm: Record of the arm.
        gripper: ``locked``, in which link_4 has the closed fingers, or ``jaws``.
    """
    unchecked = unchecked_pairs(arm)
    never = [*unchecked.get("Never", ()), *_never_within_limits(arm, gripper)]
    pairs = {**unchecked, "Never": tuple(sorted(never))}
    if gripper == "jaws":
        return pairs
    return {reason: _without_fingers(those) for reason, those in pairs.items()}


def _never_within_limits(arm: Alpha5Parameters, gripper: str) -> Pairs:
    """The pairs of `NEVER_WITHIN_LIMITS` for which the proof holds for an arm."""
    if _moves_as_the_catalogues(arm, gripper):
        return NEVER_WITHIN_LIMITS[gripper]

    # Only other arms need a proof, and coal for it.
    from alpha5_model.collision.touching_proof import never_within_limits

    return never_within_limits(arm, gripper)


def _moves_as_the_catalogues(arm: Alpha5Parameters, gripper: str) -> bool:
    """Whether an arm has the catalogue's bodies, within the catalogue's limits."""
    catalogue = parameters()
    if arm is catalogue:
        return True
    lower, upper = joint_ranges(arm, gripper)
    lowest, highest = joint_ranges(catalogue, gripper)
    is_inside = bool((lower >= lowest).all() and (upper <= highest).all())
    of_arm = digest(collision_bodies(arm, gripper))
    return is_inside and of_arm == digest(collision_bodies(catalogue, gripper))


def _without_fingers(pairs: Pairs) -> Pairs:
    return tuple(pair for pair in pairs if "finger" not in f"{pair[0]} {pair[1]}")
