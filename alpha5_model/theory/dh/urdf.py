"""Joint axes of an arm from a Pinocchio model or a URDF, and URDF from its DH table."""

from __future__ import annotations

import math
import os
import xml.etree.ElementTree as ET
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

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

if TYPE_CHECKING:
    import pinocchio as pin

#: With 400 moving joints Pinocchio takes 4 GB; with 5000 links in a row it crashes.
MOST_JOINTS = 100
MOST_LINKS = 1000
#: A pitch above this makes a joint helical [m].
_HELICAL = 1e-12
#: Elements of a joint in a URDF that affect its motion.
_MOVING = ("origin", "parent", "child", "axis", "limit", "mimic")
_NO_INERTIA = dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), "0")


def pinocchio_axes(model: pin.Model, frame: str | None) -> dict[str, Any]:
    """The arguments of `DHChain.from_axes` for a pin.Model; see
    `DHChain.from_pinocchio`.
    """
    import pinocchio as pin

    tip = _tip(instance("model", model, pin.Model), frame)
    path = [j for j in model.supports[model.frames[tip].parentJoint] if j != 0]
    if not path:
        name = model.frames[tip].name
        raise InputError("frame", name, "a frame that a joint moves")
    data = model.createData()
    q = pin.neutral(model)
    jacobians = pin.computeJointJacobians(model, data, q).reshape(6, -1)
    pin.updateFramePlacements(model, data)
    points = []
    directions = []
    sigma = []
    for j in path:
        direction, slides = _axis(model, j, jacobians)
        points.append(data.oMi[j].translation)
        directions.append(direction)
        sigma.append(int(slides))
    return {
        "points": tuple(points),
        "directions": tuple(directions),
        "sigma": tuple(sigma),
        "limits": tuple(_limits(model, j) for j in path),
        "end_effector": data.oMf[tip].homogeneous,
        "q": np.zeros(len(path)),
        "name": model.name,
        "joint_names": tuple(model.names[j] for j in path),
    }


def _tip(model: pin.Model, frame: str | None) -> int:
    """Index of a frame; by default of the last body frame of the last joint."""
    if frame is None:
        last = [f for f in model.frames if f.parentJoint == model.njoints - 1]
        frame = last[-1].name
    names = [f.name for f in model.frames]
    if not isinstance(frame, str) or frame not in names:
        raise UnknownNameError("frame", frame, names)
    return int(model.getFrameId(frame))


def _axis(model: pin.Model, j: int, jacobians: FloatArray) -> tuple[FloatArray, bool]:
    """Direction of joint j's axis in the world, (3,), and whether the joint slides.

    Args:
        model: pin.Model.
        j: Index of the joint.
        jacobians: Of the joints in the world, (6, nv). The linear part is the velocity
            of the body's point at the world's origin.
    """
    joint = model.joints[j]
    linear = jacobians[:3, joint.idx_v]
    angular = jacobians[3:, joint.idx_v]
    helical = angular.any() and abs(linear @ angular) > _HELICAL
    if joint.nv != 1 or helical:
        expected = "a revolute or prismatic joint"
        raise InputError(model.names[j], joint.shortname(), expected)
    slides = not angular.any()
    return (linear if slides else angular), slides


def _limits(model: pin.Model, j: int) -> tuple[float, float]:
    """Limits of joint j; infinite for a continuous one (cosine and sine)."""
    joint = model.joints[j]
    lower = float(model.lowerPositionLimit[joint.idx_q])
    upper = float(model.upperPositionLimit[joint.idx_q])
    if joint.nq == 1 and lower < upper:
        return lower, upper
    return -math.inf, math.inf


def urdf_model(path: str | os.PathLike[str]) -> Any:
    """The pin.Model of a URDF file; see `DHChain.from_urdf`."""
    import pinocchio as pin

    from alpha5_model.description.reading import parse_urdf
    from alpha5_model.description.xml_reading import parse_xml

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


def urdf_text(
    name: str, ends: Iterable[FloatArray], rows: Iterable[tuple[str, DHLink]]
) -> str:
    """The URDF of a DH chain: links ``base_link, frame_0, link_1, frame_1, ..., tool``.

    ``frame_j`` is DH frame {j}. Joint j turns about or slides along z of {j-1},
    displaced by the constant part of its row; a and alpha follow it. Revolute joints
    without limits become ``continuous``. A DH table has no mass, effort and
    speed: they are zero.

    Args:
        name: Of the robot.
        ends: Base and tool, as of `DHChain`, (4, 4).
        rows: Name and row of each joint, base to tip.

    Raises:
        MissingParameterError: A prismatic joint, or a revolute one limited on one side
            only, whose limits are not finite: URDF needs both.
    """
    robot = ET.Element("robot", name=name)
    base, tool = ends
    # No <inertial>: KDL warns about any on a root.
    ET.SubElement(robot, "link", name="base_link")
    _add_joint(
        robot,
        name="base",
        kind="fixed",
        parent="base_link",
        child="frame_0",
        xyz=base[:3, 3],
        rpy=rpy_from_rotation(base[:3, :3]),
    )
    last = "frame_0"
    for j, (joint, row) in enumerate(rows, start=1):
        last = _add_row(robot, joint, row, last, j)
    _add_joint(
        robot,
        name="tool_joint",
        kind="fixed",
        parent=last,
        child="tool",
        xyz=tool[:3, 3],
        rpy=rpy_from_rotation(tool[:3, :3]),
    )
    ET.indent(robot)
    return ET.tostring(robot, encoding="unicode") + "\n"


def _add_row(robot: ET.Element, joint: str, row: DHLink, last: str, j: int) -> str:
    """Add the joint, the link and the frame of row j; returns the name of the frame."""
    link = f"link_{j}"
    frame = f"frame_{j}"
    kind = _kind(joint, row)
    theta, d = (row.offset, row.d) if row.revolute else (row.theta, row.offset)
    moving = _add_joint(
        robot,
        name=joint,
        kind=kind,
        parent=last,
        child=link,
        xyz=(0.0, 0.0, d),
        rpy=(0.0, 0.0, theta),
    )
    ET.SubElement(moving, "axis", xyz="0 0 1")
    limit = ET.SubElement(moving, "limit", effort="0", velocity="0")
    if kind != "continuous":
        limit.attrib |= {"lower": repr(row.lower), "upper": repr(row.upper)}
    _add_joint(
        robot,
        name=f"{link}_to_{frame}",
        kind="fixed",
        parent=link,
        child=frame,
        xyz=(row.a, 0.0, 0.0),
        rpy=(row.alpha, 0.0, 0.0),
    )
    return frame


def _kind(joint: str, row: DHLink) -> str:
    """URDF's type of a joint."""
    if row.revolute and row.lower == -math.inf and row.upper == math.inf:
        return "continuous"
    if not (math.isfinite(row.lower) and math.isfinite(row.upper)):
        raise MissingParameterError("two finite limits", f"the URDF of joint {joint}")
    return "revolute" if row.revolute else "prismatic"


def _add_joint(
    robot: ET.Element,
    *,
    name: str,
    kind: str,
    parent: str,
    child: str,
    xyz: Iterable[float],
    rpy: Iterable[float],
) -> ET.Element:
    """Add a joint, at a position and at roll, pitch, yaw, and the link after it."""
    # Zeros are written out: some tools give a link without <inertial> a mass of 1 kg.
    inertial = ET.SubElement(ET.SubElement(robot, "link", name=child), "inertial")
    ET.SubElement(inertial, "mass", value="0")
    ET.SubElement(inertial, "inertia", _NO_INERTIA)
    joint = ET.SubElement(robot, "joint", name=name, type=kind)
    ET.SubElement(joint, "origin", xyz=_xml_numbers(xyz), rpy=_xml_numbers(rpy))
    ET.SubElement(joint, "parent", link=parent)
    ET.SubElement(joint, "child", link=child)
    return joint


def _xml_numbers(values: Iterable[float]) -> str:
    return " ".join(repr(float(value)) for value in values)
