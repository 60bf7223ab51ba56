"""Read any URDF as plain records, with errors that name the line.

URDF 1.0, 1.1 and 1.2 are read as urdfdom 6 and Pinocchio 4.1 read them. Neither is used
here: this reader accepts what they refuse, names the line of an error, and keeps what
they drop (missing inertials, limits as written, digits, mimic joints).
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import cross_matrix, pose, transform
from alpha5_model.description.urdf_remarks import floats, is_macro, remarks_of
from alpha5_model.description.urdf_robot import (
    UrdfJoint,
    UrdfLink,
    UrdfRobot,
    UrdfShape,
)
from alpha5_model.description.xml_reading import parse_xml
from alpha5_model.errors import FileFormatError

#: Bounds of the size of numbers. No SI quantity of a robot is beyond them, and squares
#: and quotients would overflow.
ABSURD = 1e12
TINY = 1e-100
#: A limit such as 1e16 or infinity, which many files write for wheels and propellers
#: without limits.
NO_LIMIT = re.compile(r"\s*[+-]?(\d[.\d]*e\+?[1-9]\d+|inf(inity)?)\s*$", re.IGNORECASE)

#: The largest public robots have a few hundred links.
MOST_LINKS = 10_000

LIMITS = ("lower", "upper", "velocity", "effort")
#: Limits that URDF has since version 1.2.
LATER_LIMITS = ("acceleration", "deceleration", "jerk")
JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
#: Kind of shape -> its attributes, and how many numbers each holds.
_SIZES: dict[str, dict[str, int]] = {
    "box": {"size": 3},
    "sphere": {"radius": 1},
    "mesh": {},
    "cylinder": {"radius": 1, "length": 1},
    "capsule": {"radius": 1, "length": 1},
}


def parse_urdf(text: str | bytes, origin: str = "URDF") -> UrdfRobot:
    """Read the text of a URDF; ``origin`` names it in errors.

    Raises:
        FileFormatError: Not a URDF; the message names the line and what is wrong.
    """
    return _Reader(text, origin).robot()


def urdf_shapes(text: str | bytes, element: str = "visual") -> tuple[UrdfShape, ...]:
    """Read the shapes of a URDF's text, link by link.

    Args:
        text: The URDF.
        element: ``visual`` or ``collision``.

    Raises:
        FileFormatError: Not a URDF; the message names the line and what is wrong.
    """
    reader = _Reader(text, "URDF")
    shapes: list[UrdfShape] = []
    for link in reader.top.findall("link"):
        shapes += reader.shapes(link, element)
    return tuple(shapes)


class _Inertial(NamedTuple):
    """The ``<inertial>`` of a link; see `UrdfLink`."""

    mass: float | None
    com: FloatArray
    inertia: FloatArray


class _Reader:
    """Reads the elements of one file; an error names the line of its element."""

    def __init__(self, text: str | bytes, origin: str) -> None:
        self.origin = origin
        tree = parse_xml(text, origin)
        self.top = tree.top
        self.lines = tree.lines
        self.version = _version(self.top.get("version", ""))

    def fail(self, element: ET.Element, problem: str) -> FileFormatError:
        return FileFormatError(self.origin, problem, f"line {self.lines[element]}")

    # --- attributes

    def attribute(self, element: ET.Element, name: str) -> str:
        value = element.get(name)
        if value is None:
            raise self.fail(element, f"<{element.tag}> has no attribute {name!r}")
        if "".join(value.splitlines()) != value:
            # It could pose as another line of what is printed about the file.
            problem = f"<{element.tag} {name}>: {value[:80]!r} has a line end"
            raise self.fail(element, problem)
        return value

    def number(self, element: ET.Element, name: str) -> float:
        (value,) = self.numbers(element, name, 1)
        return value

    def numbers(
        self, element: ET.Element, name: str, count: int, default: str = ""
    ) -> list[float]:
        text = element.get(name, default) if default else self.attribute(element, name)
        values = floats(text)
        plausible = all(v == 0 or TINY < abs(v) < ABSURD for v in values)
        if len(values) != count or not plausible:
            expected = "a finite number" if count == 1 else f"{count} finite numbers"
            shown = text if len(text) < 40 else text[:37] + "..."
            problem = f"<{element.tag} {name}>: expected {expected}, got {shown!r}"
            if is_macro(text):
                problem += ", which is xacro: expand the file first"
            raise self.fail(element, problem)
        return values

    def pose(self, element: ET.Element) -> FloatArray:
        """The ``<origin>`` of an element, (4, 4)."""
        origin = element.find("origin")
        if origin is None:
            return np.eye(4)
        xyz = self.numbers(origin, "xyz", 3, default="0 0 0")
        if not self.has_quaternion(origin):
            return pose(xyz, self.numbers(origin, "rpy", 3, default="0 0 0"))

        if "rpy" in origin.attrib:
            problem = "<origin> has rpy and quat_xyzw, only one is allowed"
            raise self.fail(origin, problem)
        quaternion = np.array(self.numbers(origin, "quat_xyzw", 4))
        length = float(np.linalg.norm(quaternion))
        if length == 0:
            raise self.fail(origin, "<origin quat_xyzw>: four zeros are no rotation")
        *axis, w = quaternion / length
        k = cross_matrix(axis)
        return transform(np.eye(3) + 2.0 * (w * k + k @ k), xyz)

    def has_quaternion(self, origin: ET.Element) -> bool:
        """Whether an origin has a quaternion that counts, as it does since URDF 1.1."""
        return self.version >= (1, 1) and "quat_xyzw" in origin.attrib

    # --- the robot

    def robot(self) -> UrdfRobot:
        if self.top.tag != "robot":
            raise self.fail(self.top, f"expected <robot>, got <{self.top.tag}>")
        links = self.all_links()
        joints = self.all_joints(links)
        root = self.root(links, joints)
        return UrdfRobot(
            name=self.attribute(self.top, "name") if "name" in self.top.attrib else "",
            root=root,
            links=links,
            joints=self.outwards(root, joints),
            version=self.top.get("version", ""),
            remarks=tuple(remarks_of(self.top, self.lines)),
        )

    def all_links(self) -> dict[str, UrdfLink]:
        elements = self.top.findall("link")
        if len(elements) > MOST_LINKS:
            problem = f"expected at most {MOST_LINKS} links, got {len(elements)}"
            raise self.fail(self.top, problem)
        links: dict[str, UrdfLink] = {}
        for element in elements:
            link = self.link(element)
            if link.name in links:
                raise self.fail(element, f"link {link.name!r} is there twice")
            links[link.name] = link
        return links

    def all_joints(self, links: dict[str, UrdfLink]) -> dict[str, UrdfJoint]:
        """The joints in the order of the file; no link has two parents."""
        joints: dict[str, UrdfJoint] = {}
        children = set()
        for element in self.top.findall("joint"):
            joint = self.joint(element)
            if joint.name in joints:
                raise self.fail(element, f"joint {joint.name!r} is there twice")
            for end in (joint.parent, joint.child):
                if end not in links:
                    raise self.fail(element, f"joint {joint.name!r}: no link {end!r}")
            if joint.child in children:
                raise self.fail(element, f"link {joint.child!r} has two parents")
            children.add(joint.child)
            joints[joint.name] = joint
        return joints

    def root(self, links: Iterable[str], joints: dict[str, UrdfJoint]) -> str:
        """The one link that no joint carries."""
        if not links:
            raise self.fail(self.top, "there is no <link>")
        children = {joint.child for joint in joints.values()}
        roots = [name for name in links if name not in children]
        if len(roots) == 1:
            return roots.pop()
        found = "no root link"
        if roots:
            found = f"{len(roots)} root links: {', '.join(roots[:4])}"
        raise self.fail(self.top, f"expected one tree of links, found {found}")

    def outwards(self, root: str, joints: dict[str, UrdfJoint]) -> dict[str, UrdfJoint]:
        """The joints from the root outwards, each after the joint before it."""
        carried_by: dict[str, list[UrdfJoint]] = {}
        for joint in joints.values():
            carried_by.setdefault(joint.parent, []).append(joint)

        ordered: dict[str, UrdfJoint] = {}
        links = [root]
        for link in links:
            for joint in carried_by.get(link, ()):
                ordered[joint.name] = joint
                links.append(joint.child)
        if len(ordered) != len(joints):
            raise self.fail(self.top, "the joints form a loop")
        return ordered

    # --- links

    def link(self, element: ET.Element) -> UrdfLink:
        shapes = self.shapes(element, "collision")
        volume = sum((shape.volume for shape in shapes), 0.0)
        centre = np.zeros(3)
        if volume > 0:
            centres = [shape.placement[:3, 3] for shape in shapes]
            weights = [shape.volume for shape in shapes]
            centre = np.average(centres, axis=0, weights=weights)

        inertial = self.inertial(element)
        files = []
        scales = {}
        for mesh in element.iter("mesh"):
            files.append(self.attribute(mesh, "filename"))
            if "scale" in mesh.attrib:
                scales[files[-1]] = tuple(floats(mesh.attrib["scale"]))
        return UrdfLink(
            name=self.attribute(element, "name"),
            mass=inertial.mass,
            com=inertial.com,
            inertia=inertial.inertia,
            volume=volume,
            shape_centre=centre,
            meshes=tuple(shape.file for shape in shapes if shape.file),
            files=tuple(files),
            scales=scales,
        )

    def inertial(self, link: ET.Element) -> _Inertial:
        element = link.find("inertial")
        if element is None:
            return _Inertial(mass=None, com=np.zeros(3), inertia=np.zeros((3, 3)))
        mass = element.find("mass")
        tensor = element.find("inertia")
        if mass is None or tensor is None:
            raise self.fail(element, "<inertial> needs <mass> and <inertia>")

        kilograms = self.number(mass, "value")
        placement = self.pose(element)
        rotation = placement[:3, :3]
        return _Inertial(
            mass=kilograms,
            com=placement[:3, 3],
            inertia=rotation @ self.tensor(tensor) @ rotation.T,
        )

    def tensor(self, element: ET.Element) -> FloatArray:
        """The ``<inertia>`` of an inertial, in the axes of its ``<origin>``, (3, 3)."""
        xx, xy, xz, yy, yz, zz = (
            self.number(element, name)
            for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
        )
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    def shapes(self, link: ET.Element, tag: str) -> list[UrdfShape]:
        """The ``<visual>`` or ``<collision>`` elements of a link."""
        name = self.attribute(link, "name")
        shapes = []
        for index, element in enumerate(link.findall(tag)):
            shapes.append(self.shape(element, name, index))
        return shapes

    def shape(self, element: ET.Element, link: str, index: int) -> UrdfShape:
        shape = element.find("geometry/*")
        if shape is None:
            raise self.fail(element, f"<{element.tag}> has no geometry")
        if shape.tag not in _SIZES:
            raise self.fail(shape, f"unknown shape <{shape.tag}>")
        size: list[float] = []
        for name, count in _SIZES[shape.tag].items():
            size += self.numbers(shape, name, count)
        color = element.find("material/color")
        return UrdfShape(
            link=link,
            index=index,
            kind=shape.tag,
            size=tuple(size),
            file=self.attribute(shape, "filename") if shape.tag == "mesh" else "",
            placement=self.pose(element),
            color=() if color is None else tuple(self.numbers(color, "rgba", 4)),
        )

    # --- joints

    def joint(self, element: ET.Element) -> UrdfJoint:
        name = self.attribute(element, "name")
        kind = self.attribute(element, "type")
        if kind not in JOINT_TYPES:
            raise self.fail(element, f"joint {name!r}: unknown type {kind!r}")
        limit = element.find("limit")
        optional: dict[str, Any] = {
            **self.limits(element, kind),
            **self.mimic(element),
        }
        origin = element.find("origin")
        if origin is not None:
            rpy = "" if self.has_quaternion(origin) else origin.get("rpy", "")
            optional["printed"] = (origin.get("xyz", ""), rpy)
        return UrdfJoint(
            name=name,
            kind=kind,
            parent=self.end_of_joint(element, name, "parent"),
            child=self.end_of_joint(element, name, "child"),
            transform=self.pose(element),
            axis=self.axis(element, name, kind),
            limit=None if limit is None else limit.attrib,
            dynamics=self.dynamics(element),
            **optional,
        )

    def end_of_joint(self, joint: ET.Element, name: str, tag: str) -> str:
        """Name of the joint's parent or child."""
        end = joint.find(tag)
        if end is None:
            raise self.fail(joint, f"joint {name!r} has no <{tag}>")
        return self.attribute(end, "link")

    def axis(self, joint: ET.Element, name: str, kind: str) -> FloatArray:
        """Unit vector of the joint's axis, along x if none is written, (3,)."""
        element = joint.find("axis")
        # Fixed and floating joints have no axis: often 0 0 0 is written.
        if element is None or kind in ("fixed", "floating"):
            return np.array([1.0, 0.0, 0.0])
        axis = np.array(self.numbers(element, "xyz", 3))
        length = float(np.linalg.norm(axis))
        if length == 0:
            raise self.fail(element, f"joint {name!r}: the axis has no direction")
        return axis / length

    def limits(self, joint: ET.Element, kind: str) -> dict[str, float]:
        """The limits in the file; a continuous joint has no ``lower`` and ``upper``."""
        element = joint.find("limit")
        if element is None:
            return {}
        names = list(LIMITS[2:] if kind == "continuous" else LIMITS)
        if self.version >= (1, 2):
            names += LATER_LIMITS
        limits = {}
        for name in names:
            text = element.get(name)
            if text is not None and not NO_LIMIT.match(text):
                limits[name] = self.number(element, name)
        return limits

    def dynamics(self, joint: ET.Element) -> dict[str, float] | None:
        """Damping and friction, if they are written."""
        element = joint.find("dynamics")
        if element is None:
            return None
        names = [name for name in ("damping", "friction") if name in element.attrib]
        return {name: self.number(element, name) for name in names}

    def mimic(self, joint: ET.Element) -> dict[str, Any]:
        """The joint that this one follows, with multiplier and offset if given."""
        element = joint.find("mimic")
        if element is None:
            return {}
        mimic: dict[str, Any] = {}
        for name in ("multiplier", "offset"):
            if name in element.attrib:
                mimic[name] = self.number(element, name)
        mimic["mimic"] = self.attribute(element, "joint")
        return mimic


def _version(text: str) -> tuple[int, ...]:
    """The version of URDF; 1.0 if there is none, or none of the form ``1.0``."""
    match = re.fullmatch(r"(\d{1,4})\.(\d{1,4})", text)
    return tuple(map(int, match.groups())) if match else (1, 0)
