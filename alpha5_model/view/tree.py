"""The joint tree of a URDF as the page in the browser needs it: parents, placements, axes."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.spatial import pose, rotation_about, transform


@dataclass(frozen=True, eq=False)
class TreeJoint:
    """A joint and the child link that it moves, ``T_child = T_parent placement motion(q)``.

    Attributes:
        name: Name of the joint.
        parent, child: Names of the links.
        placement: Child in parent at position zero, (4, 4).
        kind: ``revolute``, ``prismatic`` or ``fixed``.
        axis: Unit axis in the child's frame, (3,).
        lower, upper: Range [rad or m].
        source: Name of the joint whose position it follows: itself, or the one it mimics.
        multiplier, offset: Position as a linear function of the source's.
    """

    name: str
    parent: str
    child: str
    placement: FloatArray
    kind: str
    axis: FloatArray
    lower: float
    upper: float
    source: str
    multiplier: float
    offset: float


def joint_tree(urdf: str) -> tuple[TreeJoint, ...]:
    """Joints of a URDF text, every parent before its children."""
    found = [_joint(element) for element in ElementTree.fromstring(urdf).iter("joint")]
    pending = [joint for joint in found if joint is not None]
    known = {joint.parent for joint in pending} - {joint.child for joint in pending}
    ordered: list[TreeJoint] = []
    while pending:
        ready = [joint for joint in pending if joint.parent in known]
        ordered += ready
        known |= {joint.child for joint in ready}
        pending = [joint for joint in pending if joint not in ready]
    return tuple(ordered)


def origin_matrix(element: ElementTree.Element | None) -> FloatArray:
    """Transform (4, 4) of a URDF ``origin`` element; the identity if there is none."""
    attributes = {} if element is None else element.attrib
    xyz, rpy = ([float(v) for v in attributes.get(k, "0 0 0").split()] for k in ("xyz", "rpy"))
    return pose(xyz, rpy)


def _joint(element: ElementTree.Element) -> TreeJoint | None:
    parent, child = element.find("parent"), element.find("child")
    if parent is None or child is None:  # a joint of a ros2_control block
        return None
    axis, limit, mimic = element.find("axis"), element.find("limit"), element.find("mimic")
    name, kind = element.attrib["name"], element.attrib["type"]
    bounds = {} if limit is None else limit.attrib
    follows = {} if mimic is None else mimic.attrib
    return TreeJoint(
        name=name,
        parent=parent.attrib["link"],
        child=child.attrib["link"],
        placement=origin_matrix(element.find("origin")),
        kind="revolute" if kind == "continuous" else kind,
        axis=np.array(
            [float(v) for v in ("1 0 0" if axis is None else axis.attrib["xyz"]).split()]
        ),
        lower=float(bounds.get("lower", 0.0)),
        upper=float(bounds.get("upper", 0.0)),
        source=follows.get("joint", name),
        multiplier=float(follows.get("multiplier", 1.0)),
        offset=float(follows.get("offset", 0.0)),
    )


def joint_motion(joint: TreeJoint, source: float) -> FloatArray:
    """Transform (4, 4) that a joint makes when the joint that it follows is at ``source``."""
    position = joint.multiplier * source + joint.offset
    if joint.kind == "prismatic":
        return transform(translation=position * joint.axis)
    turns = joint.kind == "revolute"
    return transform(rotation_about(joint.axis, position) if turns else None)


def tree_as_json(joints: tuple[TreeJoint, ...]) -> list[dict[str, Any]]:
    """The tree for the page; matrices in column-major order, as three.js stores them."""
    return [
        {
            "name": joint.name,
            "parent": joint.parent,
            "child": joint.child,
            "placement": joint.placement.T.ravel().tolist(),
            "kind": joint.kind,
            "axis": joint.axis.tolist(),
            "lower": joint.lower,
            "upper": joint.upper,
            "source": joint.source,
            "multiplier": joint.multiplier,
            "offset": joint.offset,
        }
        for joint in joints
    ]
