"""Joint axes of a serial arm from a Pinocchio model or a URDF, and URDF from its DH table."""

from __future__ import annotations

import math
import os
import xml.etree.ElementTree as ET
from collections.abc import Iterable
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray, instance
from alpha5_model._support.files import read_named
from alpha5_model._support.spatial import rpy_from_rotation
from alpha5_model.errors import (
    FileFormatError,
    InputError,
    MissingParameterError,
    UnknownNameError,
)
from alpha5_model.theory.dh.link import DHLink

#: With 400 moving joints Pinocchio takes 4 GB; with 5000 links in a row it crashes.
MOST_JOINTS = 100
MOST_LINKS = 1000
#: What a joint of a URDF needs in order to move.
_MOVING = ("origin", "parent", "child", "axis", "limit", "mimic")
_NO_INERTIA = dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), "0")


def pinocchio_axes(model: Any, frame: str | None) -> dict[str, Any]:
    """What `DHChain.from_axes` needs to know of a pin.Model; see `DHChain.from_pinocchio`."""
    import pinocchio as pin

    names = [f.name for f in instance("model", model, pin.Model).frames]
    if frame is None:
        last = [f for f in model.frames if f.parentJoint == model.njoints - 1]
        frame = last[-1].name
    if not isinstance(frame, str) or frame not in names:
        raise UnknownNameError("frame", frame, names)
    tip = model.getFrameId(frame)
    path = [j for j in model.supports[model.frames[tip].parentJoint] if j != 0]
    if not path:
        raise InputError("frame", frame, "a frame that a joint moves")
    data = model.createData()
    q = pin.neutral(model)
    jacobians = pin.computeJointJacobians(model, data, q).reshape(6, -1)
    pin.updateFramePlacements(model, data)
    rows = []
    for j in path:
        joint = model.joints[j]
        # World Jacobian: linear is the velocity of the body's point at the world's origin.
        linear, angular = jacobians[:3, joint.idx_v], jacobians[3:, joint.idx_v]
        if joint.nv != 1 or (angular.any() and abs(linear @ angular) > 1e-12):
            raise InputError(
                model.names[j], joint.shortname(), "a revolute or prismatic joint"
            )
        slides, limits = not angular.any(), (-math.inf, math.inf)
        both = model.lowerPositionLimit, model.upperPositionLimit
        lower, upper = (float(each[joint.idx_q]) for each in both)
        if (
            joint.nq == 1 and lower < upper
        ):  # continuous: Pinocchio keeps cosine and sine
            limits = lower, upper
        direction = linear if slides else angular
        rows.append((data.oMi[j].translation, direction, int(slides), limits))
    table = "points", "directions", "sigma", "limits"
    drawn: dict[str, Any] = dict(zip(table, zip(*rows, strict=True), strict=True))
    drawn |= {"end_effector": data.oMf[tip].homogeneous, "q": np.zeros(len(path))}
    return drawn | {
        "name": model.name,
        "joint_names": tuple(model.names[j] for j in path),
    }


def urdf_model(path: str | os.PathLike[str]) -> Any:
    """The pin.Model of a URDF file; see `DHChain.from_urdf`."""
    import pinocchio as pin

    from alpha5_model.description.reading import parse_urdf
    from alpha5_model.description.xml_reading import parse_xml

    text = read_named(path, "a URDF file")
    robot = parse_urdf(text, str(path))
    moving = sum(joint.kind != "fixed" for joint in robot.joints.values())
    if moving > MOST_JOINTS:
        problem = f"expected at most {MOST_JOINTS} joints that move, got {moving}"
        raise FileFormatError(
            path, f"{problem}: Pinocchio's memory grows with their cube"
        )
    if len(robot.links) > MOST_LINKS:
        problem = f"expected at most {MOST_LINKS} links, got {len(robot.links)}"
        raise FileFormatError(
            path, f"{problem}: Pinocchio's reader calls itself for each in a row"
        )
    # Rewritten, since Pinocchio reads no UTF-16, and without what moves nothing: its parser would
    # print a warning about a texture's colour.
    tree = parse_xml(text, str(path)).top
    for element in tree:
        kept = _MOVING if element.tag == "joint" else ()
        element[:] = [child for child in element if child.tag in kept]
        for limit in element.findall(
            "limit"
        ):  # Pinocchio requires two values that move nothing
            limit.attrib = {"effort": "0", "velocity": "0", **limit.attrib}
    try:
        return pin.buildModelFromXML(ET.tostring(tree, encoding="unicode"))
    except (ValueError, RuntimeError) as error:
        raise FileFormatError(path, " ".join(str(error).split())) from None


def urdf_text(
    name: str, ends: Iterable[FloatArray], rows: Iterable[tuple[str, DHLink]]
) -> str:
    """The URDF of a DH chain: links ``base_link, frame_0, link_1, frame_1, ..., tool``.

    ``frame_j`` is DH frame {j}. Joint j turns about or slides along z of {j-1}, displaced by the
    constant part of its row; a and alpha follow it. Revolute joints without limits become
    ``continuous``. A DH table says nothing of mass, effort and speed: they are zero.

    Args:
        name: Of the robot.
        ends: Base and tool, as of `DHChain`, (4, 4).
        rows: Name and row of each joint, base to tip.

    Raises:
        MissingParameterError: A prismatic joint, or a revolute one limited on one side only, whose
            limits are not finite: URDF needs both.
    """
    robot = ET.Element("robot", name=name)
    base, tool = ((pose[:3, 3], rpy_from_rotation(pose[:3, :3])) for pose in ends)
    ET.SubElement(
        robot, "link", name="base_link"
    )  # KDL warns about any inertial on a root
    _joint(robot, "base", "fixed", ("base_link", "frame_0"), *base)
    last = "frame_0"
    for j, (joint, row) in enumerate(rows, start=1):
        bounded = math.isfinite(row.lower) and math.isfinite(row.upper)
        continuous = row.revolute and row.lower == -math.inf and row.upper == math.inf
        if not bounded and not continuous:
            raise MissingParameterError(
                "two finite limits", f"the URDF of joint {joint}"
            )
        kind = (
            "continuous" if continuous else "revolute" if row.revolute else "prismatic"
        )
        theta, d = (row.offset, row.d) if row.revolute else (row.theta, row.offset)
        link, frame = f"link_{j}", f"frame_{j}"
        moving = _joint(
            robot, joint, kind, (last, link), (0.0, 0.0, d), (0.0, 0.0, theta)
        )
        ET.SubElement(moving, "axis", xyz="0 0 1")
        limit = ET.SubElement(moving, "limit", effort="0", velocity="0")
        if not continuous:
            limit.attrib |= {"lower": repr(row.lower), "upper": repr(row.upper)}
        fixed = f"{link}_to_{frame}"
        _joint(
            robot,
            fixed,
            "fixed",
            (link, frame),
            (row.a, 0.0, 0.0),
            (row.alpha, 0.0, 0.0),
        )
        last = frame
    _joint(robot, "tool_joint", "fixed", (last, "tool"), *tool)
    ET.indent(robot)
    return ET.tostring(robot, encoding="unicode") + "\n"


def _joint(
    robot: ET.Element, name: str, kind: str, links: tuple[str, str], *at: Any
) -> ET.Element:
    """A joint and the link that follows it, at a position and at roll, pitch, yaw."""
    parent, child = links
    # Zeros are written out: some tools give a link without <inertial> a mass of 1 kg.
    inertial = ET.SubElement(ET.SubElement(robot, "link", name=child), "inertial")
    ET.SubElement(inertial, "mass", value="0")
    ET.SubElement(inertial, "inertia", _NO_INERTIA)
    joint = ET.SubElement(robot, "joint", name=name, type=kind)
    xyz, rpy = (" ".join(map(repr, map(float, x))) for x in at)
    ET.SubElement(joint, "origin", xyz=xyz, rpy=rpy)
    ET.SubElement(joint, "parent", link=parent)
    ET.SubElement(joint, "child", link=child)
    return joint
