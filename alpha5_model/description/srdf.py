"""Semantic description: groups, named poses and the pairs of links that need no collision check."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from alpha5_model.checks import choice
from alpha5_model.description.poses import NAMED_POSES, UNCHECKED_PAIRS
from alpha5_model.jaws import GRIPPERS
from alpha5_model.parameters import JointRange, parameters


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
