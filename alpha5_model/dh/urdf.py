"""URDF of a serial arm from its standard DH table."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Sequence

from alpha5_model.checks import FloatArray
from alpha5_model.dh.link import DHLink
from alpha5_model.errors import MissingParameterError
from alpha5_model.spatial import rpy_from_rotation

_NO_INERTIA = dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), "0")


def urdf_text(
    name: str, base: FloatArray, tool: FloatArray, rows: Iterable[tuple[str, DHLink]]
) -> str:
    """The URDF of a DH chain: links ``base_link, frame_0, link_1, frame_1, ..., tool``.

    ``frame_j`` is DH frame {j}. Joint j turns about or slides along z of {j-1}, displaced by the constant
    part of its row; a and alpha follow it. Revolute joints without limits become ``continuous``. A DH
    table says nothing of mass, effort and speed: they are zero.

    Args:
        name: Of the robot.
        base, tool: As of `DHChain`, (4, 4).
        rows: Name and row of each joint, base to tip.

    Raises:
        MissingParameterError: A prismatic joint, or a revolute one limited on one side only, whose
            limits are not finite: URDF needs both.
    """
    robot = ET.Element("robot", name=name)
    _massless_link(robot, "base_link")
    _joint(robot, "base", "fixed", ("base_link", "frame_0"), *_placement(base))
    last = "frame_0"
    for j, (joint, row) in enumerate(rows, start=1):
        bounded = math.isfinite(row.lower) and math.isfinite(row.upper)
        continuous = row.revolute and row.lower == -math.inf and row.upper == math.inf
        if not bounded and not continuous:
            raise MissingParameterError("two finite limits", f"the URDF of joint {joint}")
        kind = "continuous" if continuous else "revolute" if row.revolute else "prismatic"
        theta, d = (row.offset, row.d) if row.revolute else (row.theta, row.offset)
        link, frame = f"link_{j}", f"frame_{j}"
        moving = _joint(robot, joint, kind, (last, link), (0.0, 0.0, d), (0.0, 0.0, theta))
        ET.SubElement(moving, "axis", xyz="0 0 1")
        limit = ET.SubElement(moving, "limit", effort="0", velocity="0")
        if not continuous:
            limit.attrib |= {"lower": repr(row.lower), "upper": repr(row.upper)}
        fixed = f"{link}_to_{frame}"
        _joint(robot, fixed, "fixed", (link, frame), (row.a, 0.0, 0.0), (row.alpha, 0.0, 0.0))
        last = frame
    _joint(robot, "tool_joint", "fixed", (last, "tool"), *_placement(tool))
    ET.indent(robot)
    return ET.tostring(robot, encoding="unicode") + "\n"


def _joint(
    robot: ET.Element,
    name: str,
    kind: str,
    links: tuple[str, str],
    xyz: Sequence[float],
    rpy: Sequence[float],
) -> ET.Element:
    """A joint and the link that follows it."""
    _massless_link(robot, links[1])
    joint = ET.SubElement(robot, "joint", name=name, type=kind)
    origin = {key: " ".join(map(repr, map(float, x))) for key, x in (("xyz", xyz), ("rpy", rpy))}
    ET.SubElement(joint, "origin", origin)
    for end, link in zip(("parent", "child"), links, strict=True):
        ET.SubElement(joint, end, link=link)
    return joint


def _massless_link(robot: ET.Element, name: str) -> None:
    """Zeros are written out: some tools give a link without <inertial> a mass of 1 kg."""
    inertial = ET.SubElement(ET.SubElement(robot, "link", name=name), "inertial")
    ET.SubElement(inertial, "mass", value="0")
    ET.SubElement(inertial, "inertia", _NO_INERTIA)


def _placement(transform: FloatArray) -> tuple[Sequence[float], Sequence[float]]:
    """Position and fixed-axis roll, pitch, yaw."""
    return transform[:3, 3].tolist(), rpy_from_rotation(transform[:3, :3])
