"""Our URDF otherwise written, but the same arm: other zeros, names and vehicles."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET

import numpy as np
from urdf_edits import OWN


def matrix(rpy) -> np.ndarray:
    (a, b, c) = rpy
    x = np.array(
        [[1, 0, 0], [0, math.cos(a), -math.sin(a)], [0, math.sin(a), math.cos(a)]]
    )
    y = np.array(
        [[math.cos(b), 0, math.sin(b)], [0, 1, 0], [-math.sin(b), 0, math.cos(b)]]
    )
    z = np.array(
        [[math.cos(c), -math.sin(c), 0], [math.sin(c), math.cos(c), 0], [0, 0, 1]]
    )
    return z @ y @ x


def rpy_of(r: np.ndarray) -> str:
    angles = (
        math.atan2(r[2, 1], r[2, 2]),
        math.asin(max(-1.0, min(1.0, -r[2, 0]))),
        math.atan2(r[1, 0], r[0, 0]),
    )
    return " ".join(repr(float(a)) for a in angles)


def reverse(joint: ET.Element) -> None:
    joint.find("axis").set("xyz", "0 0 -1")
    limit = joint.find("limit")
    lower, upper = limit.get("lower"), limit.get("upper")
    limit.set("lower", repr(-float(upper)))
    limit.set("upper", repr(-float(lower)))


def shift_zero(joint: ET.Element, angle: float) -> None:
    """Where our joint is at zero, this one is at `angle`."""
    angle = float(angle)
    origin, sign = joint.find("origin"), float(joint.find("axis").get("xyz").split()[2])
    turn = matrix((0, 0, -sign * angle))
    origin.set(
        "rpy", rpy_of(matrix([float(x) for x in origin.get("rpy").split()]) @ turn)
    )
    limit = joint.find("limit")
    for end in ("lower", "upper"):
        limit.set(end, repr(float(limit.get(end)) + angle))


def dressed(text: str, prefix: str, xyz=None, rpy=None) -> ET.Element:
    """Every name behind a prefix, and the arm on a vehicle if a pose is given."""
    root = ET.fromstring(text)
    for element in root.iter():
        if element.tag in ("link", "joint"):
            element.set("name", prefix + element.get("name"))
        elif element.tag in ("parent", "child"):
            element.set("link", prefix + element.get("link"))
    # A mounted root is no root any more: xacro writes its zeros, which PyBullet needs.
    zeros = ET.SubElement(root.find(f"link[@name='{prefix}base_link']"), "inertial")
    ET.SubElement(zeros, "mass", value="0")
    ET.SubElement(
        zeros, "inertia", dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), "0")
    )
    if xyz is not None:
        ET.SubElement(root, "link", name="vehicle")
        mount = ET.SubElement(root, "joint", name="mount", type="fixed")
        ET.SubElement(mount, "parent", link="vehicle")
        ET.SubElement(mount, "child", link=f"{prefix}base_link")
        pose = (" ".join(repr(float(x)) for x in numbers) for numbers in (xyz, rpy))
        ET.SubElement(mount, "origin", dict(zip(("xyz", "rpy"), pose, strict=True)))
    return root


def inertial_of(mass: float) -> str:
    inertia = "<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/>"
    return f"<inertial><mass value='{mass}'/>{inertia}</inertial>"


def with_vehicle(mass: float, arms: int = 1) -> str:
    """Our arm on a vehicle with two thrusters and a camera, or two arms on it."""
    body = inertial_of(mass)
    text = (
        f"<robot name='uvms'><link name='world'/><link name='hull'>{body}</link>"
        "<joint name='free' type='floating'>"
        "<parent link='world'/><child link='hull'/></joint>"
    )
    for i, kind in enumerate(("continuous", "revolute")):
        limit = "<limit lower='-1e16' upper='1e16' effort='1' velocity='1'/>"
        text += (
            f"<link name='t{i}'>{body}</link><joint name='thruster{i}' type='{kind}'>"
            f"<parent link='hull'/><child link='t{i}'/>"
            f"<origin xyz='0 {i} 0'/>{limit}</joint>"
        )
    for i in range(arms):
        root = dressed(OWN, f"arm{i}_")
        text += "".join(
            ET.tostring(element, encoding="unicode")
            for element in root
            if element.tag in ("link", "joint")
        )
        text += (
            f"<joint name='mount{i}' type='fixed'>"
            f"<parent link='hull'/><child link='arm{i}_base_link'/>"
            f"<origin xyz='0.2 {i}.5 -0.1' rpy='0.3 0 1'/></joint>"
        )
    return text + "</robot>"
