"""Which pairs of links are compared for self-collision, and which are left out, why."""

from __future__ import annotations

from itertools import pairwise

from alpha5_model.numbers.jaws import Gripper
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters
from alpha5_model.numbers.tables import BODY_NAMES

Pairs = tuple[tuple[str, str], ...]
#: Pairs that turn against each other at a joint; their collision bodies overlap there.
ADJACENT_PAIRS: Pairs = (
    *pairwise(BODY_NAMES),
    ("link_4", "finger_1"),
    ("link_4", "finger_2"),
)
#: Fingers that touch when the jaws close.
CLOSING_PAIRS: Pairs = (("finger_1", "finger_2"),)
#: Pairs that no joint position brings together: links 1 and 3 are held apart by link 2.
NEVER_PAIRS: Pairs = (
    ("link_1", "link_3"),
    ("link_3", "finger_1"),
    ("link_3", "finger_2"),
)
#: Gripper -> pairs that no joint position within the catalogue's limits brings
#: together: axis_d does not fold link 3 onto the base, nor axis_c link 4 onto link 2.
#: Fingers that move are links of their own, and without them link 4 does not reach link
#: 1. Some come within a millimetre, so the package compares them all the same: for
#: distances and margins, and beyond the limits. ``tests/collision`` looks for contacts.
NEVER_WITHIN_LIMITS: dict[str, Pairs] = {
    "locked": (("link_0", "link_3"), ("link_2", "link_4")),
    "jaws": (
        ("link_0", "link_3"),
        ("link_1", "link_4"),
        ("link_2", "link_4"),
        ("link_2", "finger_1"),
        ("link_2", "finger_2"),
    ),
}
#: Pair of links -> shapes of the second that meet the first within the catalogue's
#: limits. The others of link 2 pass the base beside the shoulder, some always within
#: 13 mm of it. ``tests/collision`` proves it.
MEETING_SHAPES: dict[tuple[str, str], tuple[int, ...]] = {("link_0", "link_2"): (0,)}
#: Sum of the changes of lengths with which `NEVER_PAIRS` cannot meet either [m]: with
#: Table 1's lengths they are more than this apart.
_KEPT_APART = 0.04


def unchecked_pairs(arm: Alpha5Parameters) -> dict[str, Pairs]:
    """Pairs of links that are never compared, by the reason in the words of SRDF.

    A change of a length moves links against each other by no more than itself. If the
    changes add up to 40 mm or more, the pairs that never meet are checked, too.
    """
    pairs = {"Adjacent": ADJACENT_PAIRS, "Default": CLOSING_PAIRS}
    change = 0.0
    for own, printed in zip(arm.dh[:3], parameters().dh, strict=False):
        change += abs(own.a - printed.a) + abs(own.d - printed.d)
    if change < _KEPT_APART:
        pairs["Never"] = NEVER_PAIRS
    return pairs


def disabled_pairs(arm: Alpha5Parameters, gripper: Gripper) -> dict[str, Pairs]:
    """Pairs of links whose contact other programs need not check, for SRDF and MJCF.

    Args:
        arm: Record of the arm. ``Never`` has the pairs that the joint limits keep apart
            only if it has the catalogue's lengths, zeros and spacer, and no wider
            limits.
        gripper: ``locked``, in which link_4 has the closed fingers, or ``jaws``.

    Returns:
        Pairs by the reason in the words of SRDF.
    """
    pairs = unchecked_pairs(arm)
    if _moves_as_the_catalogues(arm):
        never = (*pairs["Never"], *NEVER_WITHIN_LIMITS[gripper])
        pairs["Never"] = tuple(sorted(never))
    if gripper == "jaws":
        return pairs
    return {reason: _without_fingers(those) for reason, those in pairs.items()}


def meeting_shapes(arm: Alpha5Parameters, pair: tuple[str, str]) -> tuple[int, ...]:
    """Numbers of the shapes of a pair's second link that can meet the first one.

    Empty for all of them: another pair, or an arm that has not the catalogue's lengths,
    zeros, spacer and limits.
    """
    if not _moves_as_the_catalogues(arm):
        return ()
    return MEETING_SHAPES.get(pair, ())


def _moves_as_the_catalogues(arm: Alpha5Parameters) -> bool:
    """Whether an arm has the catalogue's bodies, within the catalogue's limits."""
    catalogue = parameters()
    same = (
        arm.dh[:4] == catalogue.dh[:4]
        and arm.spacer == catalogue.spacer
        and arm.base_yaw == catalogue.base_yaw
    )
    return same and all(
        known.lower <= joint.lower and joint.upper <= known.upper
        for joint, known in zip(arm.joints, catalogue.joints, strict=True)
    )


def _without_fingers(pairs: Pairs) -> Pairs:
    return tuple(pair for pair in pairs if "finger" not in f"{pair[0]} {pair[1]}")
