"""A URDF of anyone as a Pinocchio model of what moves."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ET
from typing import Any

from alpha5_model._support.files import read_named
from alpha5_model.description.reading import parse_urdf
from alpha5_model.description.urdf_robot import UrdfRobot
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
    _check(path, robot)
    # Written anew, since Pinocchio reads no UTF-16 and no blank line at the beginning.
    tree = parse_xml(text, str(path)).top
    _keep_what_moves(tree)
    try:
        return pin.buildModelFromXML(ET.tostring(tree, encoding="unicode"))
    except (ValueError, RuntimeError) as error:
        raise FileFormatError(path, " ".join(str(error).split())) from None


def _check(path: str | os.PathLike[str], robot: UrdfRobot) -> None:
    """Refuse models that are too large for Pinocchio, or lack limits.

    Pinocchio would print a refusal of the latter.
    """
    joints = [joint for joint in robot.joints.values() if joint.kind != "fixed"]
    if len(joints) > MOST_JOINTS:
        problem = f"expected at most {MOST_JOINTS} joints that move, got {len(joints)}"
        why = "Pinocchio's memory grows with their cube"
        raise FileFormatError(path, f"{problem}: {why}")
    if len(robot.links) > MOST_LINKS:
        problem = f"expected at most {MOST_LINKS} links, got {len(robot.links)}"
        why = "Pinocchio's reader calls itself for each in a row"
        raise FileFormatError(path, f"{problem}: {why}")
    for joint in joints:
        if joint.kind in ("revolute", "prismatic") and joint.limit is None:
            problem = f"the {joint.kind} joint {joint.name} has no <limit>"
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
            limit.attrib |= {"effort": "0", "velocity": "0"}
