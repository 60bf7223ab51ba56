"""Mistakes of public models of the arm, made in a copy of our URDF."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable

import numpy as np
import reference

Defect = Callable[[ET.Element], None]


def inertial(root: ET.Element, link: str) -> ET.Element:
    return root.find(f"link[@name='{link}']/inertial")


def set_com(root: ET.Element, link: str, com) -> None:
    inertial(root, link).find("origin").set(
        "xyz", " ".join(repr(float(x)) for x in com)
    )


def set_inertia(root: ET.Element, link: str, tensor) -> None:
    element = inertial(root, link).find("inertia")
    for i, a in enumerate("xyz"):
        for j in range(i, 3):
            element.set(f"i{a}{'xyz'[j]}", repr(float(tensor[i][j])))


def table_com(i: int) -> np.ndarray:
    return np.array(reference.COM[i]) / 1e3


def table_inertia(i: int) -> np.ndarray:
    xx, yy, zz, xy, xz, yz = np.array(reference.INERTIA[i]) / 1e6
    return np.array([[xx, -xy, -xz], [-xy, yy, -yz], [-xz, -yz, zz]])


def no_inertial(root):
    link = root.find("link[@name='link_2']")
    link.remove(link.find("inertial"))


def wrong_side(root):
    set_com(root, "link_4", table_com(4) * [1, 1, -1])


def other_zero(root):
    """The link frames if the zero of axis_c is elsewhere, by theta_c - pi/2."""
    root.find("joint[@name='axis_c']/origin").set("rpy", "3.141592653589793 0.0 0.0")


def about_the_link_frame(root):
    p = table_com(3)
    shift = reference.MASS[3] * (p @ p * np.eye(3) - np.outer(p, p))
    set_inertia(root, "link_3", table_inertia(3) + shift)


def solidworks_sign(root):
    flipped = table_inertia(1)
    set_inertia(root, "link_1", np.diag(np.diag(flipped)) * 2 - flipped)


def zeroed_products(root):
    set_inertia(root, "link_2", np.diag(np.diag(table_inertia(2))))


def guessed_cylinder(root):
    r, length, mass = 0.02, 0.18, reference.MASS[4]
    across = mass * (3 * r**2 + length**2) / 12
    set_inertia(root, "link_4", np.diag([across, across, mass * r**2 / 2]))


def dummy_link(root):
    link = ET.SubElement(root, "link", name="dummy")
    body = ET.SubElement(link, "inertial")
    ET.SubElement(body, "mass", value="0.0001")
    ET.SubElement(
        body, "inertia", ixx="1e-4", iyy="1e-4", izz="1e-4", ixy="0", ixz="0", iyz="0"
    )
    joint = ET.SubElement(root, "joint", name="dummy_joint", type="fixed")
    ET.SubElement(joint, "parent", link="link_4")
    ET.SubElement(joint, "child", link="dummy")


def too_much_water(root):
    for element in root.iter("link"):
        for collision in element.findall("collision"):
            element.remove(collision)
    box = ET.SubElement(ET.SubElement(root.find("link"), "collision"), "geometry")
    ET.SubElement(box, "box", size="0.1 0.1 0.08")


def greedy_mimic(root):
    for name, lower, upper in (("rod", "0", "0.015"), ("finger", "0", "0.6")):
        ET.SubElement(root, "link", name=name)
        kind = "prismatic" if name == "rod" else "revolute"
        joint = ET.SubElement(root, "joint", name=f"{name}_joint", type=kind)
        ET.SubElement(joint, "parent", link="link_4")
        ET.SubElement(joint, "child", link=name)
        ET.SubElement(
            joint, "limit", lower=lower, upper=upper, effort="1", velocity="1"
        )
        if name == "finger":
            ET.SubElement(joint, "mimic", joint="rod_joint", multiplier="51")


def reversed_axis(root):
    root.find("joint[@name='axis_d']/axis").set("xyz", "0 0 -1")


def high_shoulder(root):
    root.find("joint[@name='axis_d']/origin").set("xyz", "0.02 0.0 0.047")


def wrong_mass(root):
    inertial(root, "link_0").find("mass").set("value", str(reference.MASS[1]))


def buoyancy_for_com(root):
    set_com(root, "link_0", [-0.053, -0.003, -0.001])


#: defect -> where it must be found, and words of the diagnosis
DEFECTS: dict[Defect, tuple[str, str]] = {
    no_inertial: ("link_2", "no <inertial>"),
    wrong_side: ("link_4", "z has the wrong sign"),
    other_zero: ("axis_c", "zero is shifted by"),
    about_the_link_frame: ("link_3", "about the link frame, not the COM"),
    solidworks_sign: ("link_1", "products of inertia have the SolidWorks sign"),
    zeroed_products: ("link_2", "the products of inertia are zeroed"),
    guessed_cylinder: ("link_4", "inertia differs, ixx is 0.000994"),
    dummy_link: ("link_4", "more than the whole arm"),
    too_much_water: ("volume", "0.800 L"),
    greedy_mimic: ("finger_joint", "beyond its own limit"),
    reversed_axis: ("axis_d", "turns the other way"),
    high_shoulder: ("axis_d", "up to 0.80 mm off"),
    wrong_mass: ("link_0", "that of link_1"),
    buoyancy_for_com: ("link_0", "the centre of buoyancy"),
}
