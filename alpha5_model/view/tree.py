"""The joint tree of a URDF as the page in the browser needs it: parents, placements, axes."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray


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
    x, y, z = (float(v) for v in attributes.get("rpy", "0 0 0").split())
    matrix = np.eye(4)
    matrix[:3, :3] = _turn(z, 2) @ _turn(y, 1) @ _turn(x, 0)
    matrix[:3, 3] = [float(v) for v in attributes.get("xyz", "0 0 0").split()]
    return matrix


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


def _turn(angle: float, axis: int) -> FloatArray:
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[i, i] = matrix[j, j] = np.cos(angle)
    matrix[j, i] = np.sin(angle)
    matrix[i, j] = -matrix[j, i]
    return matrix


def joint_motion(joint: TreeJoint, source: float) -> FloatArray:
    """Transform (4, 4) that a joint makes when the joint that it follows is at ``source``."""
    position = joint.multiplier * source + joint.offset
    motion = np.eye(4)
    if joint.kind == "prismatic":
        motion[:3, 3] = position * joint.axis
    elif joint.kind == "revolute":
        x, y, z = joint.axis / np.linalg.norm(joint.axis)
        cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        motion[:3, :3] += np.sin(position) * cross + (1.0 - np.cos(position)) * (cross @ cross)
    return motion


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
