"""The semantic description: groups, named poses, and the pairs of links that need no collision check."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from itertools import pairwise

from alpha5_model.checks import FloatArray, choice, frozen
from alpha5_model.jaws import GRIPPERS
from alpha5_model.parameters import JointRange, parameters
from alpha5_model.published.tables import BODY_NAMES

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
NEVER_PAIRS: Pairs = (("link_1", "link_3"), ("link_3", "finger_1"), ("link_3", "finger_2"))
#: All of them: reason in the words of SRDF -> pairs.
UNCHECKED_PAIRS = {"Adjacent": ADJACENT_PAIRS, "Default": CLOSING_PAIRS, "Never": NEVER_PAIRS}


def named_pose(name: str) -> FloatArray:
    """A named pose as read-only array (4,) [rad].

    Raises:
        UnknownNameError: No pose of this name.
    """
    return frozen(NAMED_POSES[choice("pose", name, tuple(NAMED_POSES))])


def srdf(gripper: str = "locked") -> str:
    """Text of the SRDF that belongs to the URDF with this gripper.

    Raises:
        UnknownNameError: Another gripper than ``locked`` or ``jaws``.
    """
    jaws = choice("gripper", gripper, GRIPPERS) == "jaws"
    return "\n".join(
        ['<?xml version="1.0"?>', '<robot name="alpha5">', *_body(jaws), "</robot>", ""]
    )


def _body(jaws: bool) -> Iterator[str]:
    *arm, rod = parameters(()).joints
    yield '  <group name="arm">'
    yield '    <chain base_link="base_link" tip_link="tcp"/>'
    yield "  </group>"
    if jaws:
        yield '  <group name="gripper">'
        yield f'    <joint name="{rod.name}"/>'
        yield "  </group>"
        yield '  <end_effector name="jaws" parent_link="link_4" group="gripper" parent_group="arm"/>'
    for pose, q in NAMED_POSES.items():
        yield from _state(pose, "arm", arm, q)
    if jaws:
        yield from _state("closed", "gripper", [rod], [rod.lower])
        yield from _state("open", "gripper", [rod], [rod.upper])
        for finger in ("finger_1", "finger_2"):
            yield f'  <passive_joint name="{finger}_joint"/>'
    for reason, pairs in UNCHECKED_PAIRS.items():
        for one, other in pairs:
            if jaws or not any(name.startswith("finger") for name in (one, other)):
                yield f'  <disable_collisions link1="{one}" link2="{other}" reason="{reason}"/>'


def _state(
    pose: str, group: str, joints: Iterable[JointRange], q: Iterable[float]
) -> Iterator[str]:
    yield f'  <group_state name="{pose}" group="{group}">'
    for joint, position in zip(joints, q, strict=True):
        yield f'    <joint name="{joint.name}" value="{position!r}"/>'
    yield "  </group_state>"
