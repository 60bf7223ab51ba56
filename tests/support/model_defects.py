"""Mistakes that are made in a copy of our URDF, to be found by `alpha5 compare`."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterable

import numpy as np
import pinocchio as pin
from urdf_edits import OWN

AXES = ("axis_e", "axis_d", "axis_c", "axis_b")
Defect = Callable[[ET.Element], None]


def rotation(rpy: Iterable[float]) -> np.ndarray:
    return pin.rpy.rpyToMatrix(*(float(x) for x in rpy))


def vector(text: str) -> np.ndarray:
    return np.array(text.split(), float)


def written(values: Iterable[float]) -> str:
    return " ".join(repr(float(x)) for x in values)


def origin_of(root: ET.Element, joint: str) -> ET.Element:
    return root.find(f"joint[@name='{joint}']/origin")


def put(joint: str, xyz: str = "", rpy: str = "") -> Defect:
    """Another origin."""

    def change(root: ET.Element) -> None:
        element = origin_of(root, joint)
        element.attrib.update({k: v for k, v in (("xyz", xyz), ("rpy", rpy)) if v})

    return change


def shift(joint: str, *by: float) -> Defect:
    """The origin moved in the parent's axes [m]."""

    def change(root: ET.Element) -> None:
        element = origin_of(root, joint)
        element.set("xyz", written(vector(element.get("xyz")) + by))

    return change


def turn(joint: str, *rpy: float) -> Defect:
    """The child turned in its own axes [rad]."""

    def change(root: ET.Element) -> None:
        element = origin_of(root, joint)
        whole = rotation(vector(element.get("rpy"))) @ rotation(rpy)
        element.set("rpy", written(pin.rpy.matrixToRpy(whole)))

    return change


def reverse(joint: str) -> Defect:
    def change(root: ET.Element) -> None:
        element = root.find(f"joint[@name='{joint}']/axis")
        element.set("xyz", written(-vector(element.get("xyz"))))

    return change


def limits(joint: str, **values: float) -> Defect:
    def change(root: ET.Element) -> None:
        element = root.find(f"joint[@name='{joint}']/limit")
        element.attrib.update({name: repr(value) for name, value in values.items()})

    return change


def in_degrees(joint: str) -> Defect:
    def change(root: ET.Element) -> None:
        element = root.find(f"joint[@name='{joint}']/limit")
        for name in ("lower", "upper", "velocity"):
            element.set(name, f"{math.degrees(float(element.get(name))):.2f}")

    return change


def inertial(link: str, tag: str, **values: str) -> Defect:
    def change(root: ET.Element) -> None:
        root.find(f"link[@name='{link}']/inertial/{tag}").attrib.update(values)

    return change


def without(link: str, tag: str) -> Defect:
    def change(root: ET.Element) -> None:
        element = root.find(f"link[@name='{link}']")
        for child in element.findall(tag):
            element.remove(child)

    return change


def no_inertials(root: ET.Element) -> None:
    for link in root.iter("link"):
        for child in link.findall("inertial"):
            link.remove(child)


def renamed_tool(root: ET.Element) -> None:
    """No frame that anybody would take for the tool's."""
    root.find("link[@name='tcp']").set("name", "lamp")
    root.find("joint[@name='tcp_fixed']/child").set("link", "lamp")


def mounted(root: ET.Element) -> None:
    ET.SubElement(root, "link", name="vehicle")
    joint = ET.SubElement(root, "joint", name="mount", type="fixed")
    ET.SubElement(joint, "parent", link="vehicle")
    ET.SubElement(joint, "child", link="base_link")
    ET.SubElement(joint, "origin", xyz="0.3 -0.2 0.5", rpy="0.3 -1.1 2.0")


def other_frames(root: ET.Element) -> None:
    """Move and turn the frame of link_3 about its joint axis; all else stays."""
    frame = pin.SE3(rotation((0, 0, 0.8)), np.array([0, 0, 0.011]))

    def moved(element: ET.Element, before: pin.SE3, after: pin.SE3) -> None:
        at = pin.SE3(
            rotation(vector(element.get("rpy", "0 0 0"))), vector(element.get("xyz"))
        )
        at = before * at * after
        element.set("xyz", written(at.translation))
        element.set("rpy", written(pin.rpy.matrixToRpy(at.rotation)))

    none = pin.SE3.Identity()
    moved(origin_of(root, "axis_c"), none, frame)
    moved(origin_of(root, "axis_b"), frame.inverse(), none)
    link = root.find("link[@name='link_3']")
    for tag in ("inertial", "visual", "collision"):
        for element in link.findall(f"{tag}/origin"):
            moved(element, frame.inverse(), none)


def cut_digits_of_pi(root: ET.Element) -> None:
    """Write pi and pi/2 with two decimals in every origin."""
    for origin in root.iter("origin"):
        rpy = origin.get("rpy")
        rpy = rpy.replace("3.141592653589793", "3.14")
        origin.set("rpy", rpy.replace("1.5707963267948966", "1.57"))


def all_limits_in_degrees(root: ET.Element) -> None:
    for axis in AXES:
        in_degrees(axis)(root)


DEFECTS: dict[str, Defect] = {
    "tool on the other side": put("tcp_fixed", xyz="0 0 0.18"),
    "tool too far": put("tcp_fixed", xyz="0 0 -0.25"),
    "tool beside": shift("tcp_fixed", 0.03, 0.01, 0),
    "tool at the finger tips": put("tcp_fixed", xyz="0 0 -0.22275"),
    "tool turned": turn("tcp_fixed", 0.3, -0.2, 0.1),
    "tool with other axes": put("tcp_fixed", rpy="0 0 0"),
    "no tool": renamed_tool,
    "axis_e turned about z": turn("axis_e", 0, 0, math.pi),
    "axis_d turned about z": turn("axis_d", 0, 0, math.pi),
    "axis_c turned about z": turn("axis_c", 0, 0, math.pi),
    "axis_c turned about x": turn("axis_c", math.pi, 0, 0),
    "axis_c turned about y": turn("axis_c", 0, math.pi, 0),
    "axis_d turned about x": turn("axis_d", math.pi, 0, 0),
    "axis_b turned about x": turn("axis_b", math.pi, 0, 0),
    "axis_b turned about y": turn("axis_b", 0, math.pi, 0),
    "axis_e turned about x": turn("axis_e", math.pi, 0, 0),
    "zero of axis_e": turn("axis_e", 0, 0, 0.7),
    "zero of axis_d": turn("axis_d", 0, 0, -0.4),
    "zero of axis_c": turn("axis_c", 0, 0, 1.9),
    "zero of axis_b": turn("axis_b", 0, 0, 0.5),
    "axis_e reversed": reverse("axis_e"),
    "axis_d reversed": reverse("axis_d"),
    "axis_c reversed": reverse("axis_c"),
    "axis_b reversed": reverse("axis_b"),
    "shoulder aside": shift("axis_d", 0.004, 0, 0),
    "shoulder on the other side": shift("axis_d", -0.04, 0, 0),
    "shoulder high": shift("axis_d", 0, 0, 0.012),
    "shoulder skew": shift("axis_d", 0, 0.006, 0),
    "base high": shift("axis_e", 0, 0, 0.0008),
    "base aside": shift("axis_e", 0.01, -0.02, 0.015),
    "base tilted": turn("axis_e", 0.05, -0.08, 0),
    "link_0 elsewhere": shift("link_0_fixed", 0.02, 0, 0.01),
    "elbow too far": shift("axis_c", 0.01, 0, 0),
    "elbow off the plane": shift("axis_c", 0, 0, 0.007),
    "elbow tilted": turn("axis_c", 0.02, 0.03, 0),
    "wrist too far": shift("axis_b", 0.003, 0, 0),
    "wrist on the other side": shift("axis_b", -0.04, 0, 0),
    "wrist along": shift("axis_b", 0, -0.01, 0),
    "wrist tilted": turn("axis_b", 0.02, 0, 0),
    "short pi": cut_digits_of_pi,
    "limits": limits("axis_d", lower=0.0, upper=3.8),
    "limits in degrees": in_degrees("axis_e"),
    "limits of all in degrees": all_limits_in_degrees,
    "mass": inertial("link_2", "mass", value="0.5"),
    "COM on the other side": inertial(
        "link_4", "origin", xyz="-3e-05 -0.001482 0.100881"
    ),
    "tensor": inertial("link_3", "inertia", ixy="-2.1363e-05"),
    "turned tensor": inertial("link_2", "origin", rpy="0.4 0.2 -0.6"),
    "link without inertial": without("link_1", "inertial"),
    "no inertials": no_inertials,
    "mounted": mounted,
    "other frames": other_frames,
}


def damaged(*names: str) -> ET.Element:
    root = ET.fromstring(OWN)
    for name in names:
        DEFECTS[name](root)
    return root
