"""Named poses of the arm, and the pairs of links that need no collision check."""

from __future__ import annotations

import math

from alpha5_model.checks import FloatArray, choice, frozen

#: Joint positions axis_e, axis_d, axis_c, axis_b [rad].
#:
#: - ``stow``: folded in front of the base, the pose in which the arm rests in pool recordings of 2023
#:   (hkolano/UVMS-SysID-with-EAs: 3.10, 0.078, 0.027, 1.61), a little rounded.
#: - ``home``: ready to work, upper arm 45 deg down, forearm level (the underarm pose of Figure 4).
#: - ``reach``: stretched out level.
NAMED_POSES: dict[str, tuple[float, float, float, float]] = {
    "stow": (math.pi, 0.08, 0.03, math.pi / 2),
    "home": (math.pi, math.pi / 4, 3 * math.pi / 4, math.pi / 2),
    "reach": (math.pi, math.pi / 2, math.pi, math.pi / 2),
}

#: Pairs that turn against each other at a joint; their collision bodies overlap there.
ADJACENT_PAIRS: tuple[tuple[str, str], ...] = (
    ("link_0", "link_1"),
    ("link_1", "link_2"),
    ("link_2", "link_3"),
    ("link_3", "link_4"),
    ("link_4", "finger_1"),
    ("link_4", "finger_2"),
)
#: Fingers that touch when the jaws close.
CLOSING_PAIRS: tuple[tuple[str, str], ...] = (("finger_1", "finger_2"),)
#: Pairs that no joint position brings together: links 1 and 3 are held apart by link 2.
NEVER_PAIRS: tuple[tuple[str, str], ...] = (
    ("link_1", "link_3"),
    ("link_3", "finger_1"),
    ("link_3", "finger_2"),
)


#: All of them: reason in the words of SRDF -> pairs.
UNCHECKED_PAIRS = {"Adjacent": ADJACENT_PAIRS, "Default": CLOSING_PAIRS, "Never": NEVER_PAIRS}


def named_pose(name: str) -> FloatArray:
    """A named pose as read-only array (4,) [rad].

    Raises:
        UnknownNameError: No pose of this name.
    """
    return frozen(NAMED_POSES[choice("pose", name, tuple(NAMED_POSES))])
