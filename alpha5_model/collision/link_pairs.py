"""Which pairs of links are compared for self-collision, and which are left out, why."""

from __future__ import annotations

from itertools import pairwise

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
#: Gripper -> pairs that no joint position within the limits brings together, by the
#: proof of `alpha5_model.collision.touching_proof`: axis_d does not fold link 3 onto
#: the base, nor axis_c link 4 onto link 2. Fingers that move are links of their own,
#: and without them link 4 does not reach link 1. Some come within a millimetre, so the
#: package compares them all the same: for distances and margins, and beyond the limits.
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
