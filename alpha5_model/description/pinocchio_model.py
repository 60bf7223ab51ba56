"""A URDF of anyone as a Pinocchio model of what moves."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ET
from typing import Any

from alpha5_model._support.files import read_named
from alpha5_model.description.reading import parse_urdf
from alpha5_model.description.xml_reading import parse_xml
from alpha5_model.errors import FileFormatError

#: With 400 moving joints Pinocchio takes 4 GB; with 5000 links in a row it crashes.
MOST_JOINTS = 100
MOST_LINKS = 1000
#: Elements of a joint in a URDF that affect its motion.
_MOVING = ("origin", "parent", "child", "axis", "limit", "mimic")


def urdf_model(path: str | os.PathLike[str]) -> Any:
    """The pin.Model of a URDF file; see `alpha5_model.dh.DHChain.from_urdf`."""
    import pinocchio as pin

    text = read_named(path, "a URDF file")
    robot = parse_urdf(text, str(path))
    moving = sum(joint.kind != "fixed" for joint in robot.joints.values())
    _check_size(path, moving, len(robot.links))
    # Written anew, since Pinocchio reads no UTF-16.
    tree = parse_xml(text, str(path)).top
    _check_limits(path, tree)
    _keep_what_moves(tree)
    try:
        return pin.buildModelFromXML(ET.tostring(tree, encoding="unicode"))
    except (ValueError, RuntimeError) as error:
        raise FileFormatError(path, " ".join(str(error).split())) from None


def _check_size(path: str | os.PathLike[str], joints: int, links: int) -> None:
    """Refuse models that are too large for Pinocchio."""
    if joints > MOST_JOINTS:
        problem = f"expected at most {MOST_JOINTS} joints that move, got {joints}"
        why = "Pinocchio's memory grows with their cube"
        raise FileFormatError(path, f"{problem}: {why}")
    if links > MOST_LINKS:
        problem = f"expected at most {MOST_LINKS} links, got {links}"
        why = "Pinocchio's reader calls itself for each in a row"
        raise FileFormatError(path, f"{problem}: {why}")


def _check_limits(path: str | os.PathLike[str], robot: ET.Element) -> None:
    """Refuse joints without the limits that they need, which Pinocchio would print."""
    for joint in robot.findall("joint"):
        kind = joint.get("type")
        if kind in ("revolute", "prismatic") and joint.find("limit") is None:
            problem = f"the {kind} joint {joint.get('name')} has no <limit>"
            raise FileFormatError(path, problem)


def _keep_what_moves(robot: ET.Element) -> None:
    """Remove elements that do not affect motion.

    Pinocchio would warn about some of them, such as a texture's colour.
    """
    for element in robot:
        kept = _MOVING if element.tag == "joint" else ()
        element[:] = [child for child in element if child.tag in kept]
        for limit in element.findall("limit"):
            # Pinocchio requires these two, which move nothing.
            limit.attrib = {"effort": "0", "velocity": "0", **limit.attrib}
