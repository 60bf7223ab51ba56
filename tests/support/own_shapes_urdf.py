"""The committed URDF with the shapes that the package compares, in place of its own."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

from alpha5_model._support.paths import JAWS_URDF_PATH, URDF_PATH
from alpha5_model.geometry.collision_shapes import collision_primitives
from alpha5_model.geometry.primitives import Primitive

#: Element of a shape -> its attributes, each with so many numbers.
_ATTRIBUTES = {"box": {"size": 3}, "cylinder": {"radius": 1, "length": 1}}


def urdf_with_own_shapes(gripper: str = "locked") -> str:
    """Text of the URDF, for Pinocchio to read."""
    path = JAWS_URDF_PATH if gripper == "jaws" else URDF_PATH
    root = ET.fromstring(Path(path).read_text("utf-8"))
    own = collision_primitives(gripper)
    for link in root.iter("link"):
        for element in link.findall("collision"):
            link.remove(element)
        for shape in own.get(str(link.get("name")), ()):
            _add(link, shape)
    return ET.tostring(root, encoding="unicode")


def _add(link: ET.Element, shape: Primitive) -> None:
    collision = ET.SubElement(link, "collision")
    place = " ".join(map(repr, shape.xyz))
    angles = " ".join(map(repr, shape.rpy))
    ET.SubElement(collision, "origin", xyz=place, rpy=angles)
    numbers = list(map(repr, shape.size))
    attributes = {}
    for name, count in _ATTRIBUTES[shape.kind].items():
        attributes[name] = " ".join(numbers[:count])
        numbers = numbers[count:]
    body = ET.SubElement(collision, "geometry")
    ET.SubElement(body, shape.kind, attributes)
