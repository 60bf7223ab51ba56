"""Read any URDF as plain records, and say where it is broken.

Pinocchio's reader is not used here: this one has to cope with any file, name the line of an error, and keep
what Pinocchio drops (missing inertials, collision shapes, mimic joints).
"""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import read_named
from alpha5_model._support.spatial import pose, rotation_about, transform
from alpha5_model.description.xml_reading import parse_xml
from alpha5_model.errors import FileFormatError

#: No SI quantity of a robot is this large or this small; beyond, squares and quotients overflow.
ABSURD, TINY = 1e12, 1e-100
#: How many files write the limits of wheels and propellers, which have none: as 1e16 or infinity.
NO_LIMIT = re.compile(r"\s*[+-]?(\d[.\d]*e\+?[1-9]\d+|inf(inity)?)\s*$", re.IGNORECASE)

#: The largest public robots have a few hundred links.
MOST_LINKS = 10_000

LIMITS = ("lower", "upper", "velocity", "effort")
JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
#: Kind of shape -> its attributes, and how many numbers each holds.
_SIZES: dict[str, dict[str, int]] = {
    "box": {"size": 3},
    "sphere": {"radius": 1},
    "mesh": {},
}
_SIZES |= {kind: {"radius": 1, "length": 1} for kind in ("cylinder", "capsule")}


@dataclass(frozen=True, eq=False)
class UrdfShape:
    """A ``<visual>`` or ``<collision>`` element.

    Attributes:
        link: Name of the link that carries it.
        index: Its number among the link's elements of its kind.
        kind: ``box``, ``cylinder``, ``capsule``, ``sphere`` or ``mesh``.
        size: Edges x, y, z; radius and length; radius; nothing for a mesh [m].
        file: File name of a mesh.
        placement: Pose in the link, (4, 4).
        color: Red, green, blue, alpha, each 0 to 1; empty without a colour of its own.
    """

    link: str
    index: int
    kind: str
    size: tuple[float, ...]
    file: str
    placement: FloatArray
    color: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class UrdfLink:
    """A link.

    Attributes:
        name: Its name.
        mass: [kg]; None without an ``<inertial>``.
        com: In the link frame, (3,) [m].
        inertia: At the COM, in the link's axes, (3, 3) [kg m^2].
        volume: Of all collision primitives, summed [m^3].
        shape_centre: Their centroid in the link frame, (3,) [m]; zero without any.
        meshes: File names of collision meshes, whose volume is not counted.
        files: File names of all meshes.
    """

    name: str
    mass: float | None
    com: FloatArray
    inertia: FloatArray
    volume: float
    shape_centre: FloatArray
    meshes: tuple[str, ...]
    files: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class UrdfJoint:
    """A joint.

    Attributes:
        name, kind, parent, child: As written; kind is the attribute ``type``.
        transform: Pose of the child in the parent at position zero, (4, 4).
        axis: Unit vector in the child's frame, (3,).
        lower, upper: Limits [rad or m]; None where there is none.
        velocity, effort: Limits [rad/s, N m] or [m/s, N]; None where there is none.
        mimic: Joint that it follows by ``multiplier * position + offset``; None if none.
        multiplier, offset: 1 and 0 if it follows none.
        printed: The texts of xyz and rpy of its ``<origin>``: how many digits they have.
    """

    name: str
    kind: str
    parent: str
    child: str
    transform: FloatArray
    axis: FloatArray
    lower: float | None = None
    upper: float | None = None
    velocity: float | None = None
    effort: float | None = None
    mimic: str | None = None
    multiplier: float = 1.0
    offset: float = 0.0
    printed: tuple[str, str] = ("", "")

    @property
    def source(self) -> str:
        """Name of the joint whose position it follows: itself, or the one it mimics."""
        return self.mimic or self.name

    def motion(self, position: float) -> FloatArray:
        """What the joint adds to `transform` at a position [rad or m], (4, 4)."""
        if self.kind == "prismatic":
            return transform(translation=position * self.axis)
        turns = self.kind in ("revolute", "continuous")
        return transform(rotation_about(self.axis, position) if turns else None)


@dataclass(frozen=True, eq=False)
class UrdfRobot:
    """A tree of links; ``joints`` from the root outwards, each after the joint before it."""

    name: str
    root: str
    links: dict[str, UrdfLink]
    joints: dict[str, UrdfJoint]


def read_urdf(path: str | Path) -> UrdfRobot:
    """Read a URDF file.

    Raises:
        InputError, MissingFileError, FileFormatError: See `read_named`.
        FileFormatError: Not a URDF; the message names the line and what is wrong.
    """
    return parse_urdf(read_named(path, "a URDF file"), str(path))


def parse_urdf(text: str | bytes, origin: str = "URDF") -> UrdfRobot:
    """Read the text of a URDF; ``origin`` names it in errors."""
    return _Reader(text, origin).robot()


def urdf_shapes(text: str | bytes, element: str = "visual") -> tuple[UrdfShape, ...]:
    """Read the shapes of a URDF's text, link by link.

    Args:
        text: The URDF.
        element: ``visual`` or ``collision``.

    Raises:
        FileFormatError: Not a URDF; the message names the line and what is wrong.
    """
    return tuple(_Reader(text, "URDF").shapes(element))


class _Reader:
    def __init__(self, text: str | bytes, origin: str) -> None:
        self.origin = origin
        tree = parse_xml(text, origin)
        self.top = tree.top
        self.lines = tree.lines

    def fail(self, element: ET.Element, problem: str) -> FileFormatError:
        return FileFormatError(self.origin, problem, f"line {self.lines[element]}")

    def attribute(self, element: ET.Element, name: str) -> str:
        value = element.get(name)
        if value is None:
            raise self.fail(element, f"<{element.tag}> has no attribute {name!r}")
        return value

    def numbers(
        self, element: ET.Element, name: str, count: int, default: str = ""
    ) -> list[float]:
        text = element.get(name, default) if default else self.attribute(element, name)
        values: list[float] = []
        if (
            text.isascii() and "_" not in text
        ):  # Python reads more as numbers, URDF readers do not
            with suppress(ValueError):
                values = [float(part) for part in text.split()]
        if len(values) != count or not all(
            v == 0 or TINY < abs(v) < ABSURD for v in values
        ):
            expected = "a finite number" if count == 1 else f"{count} finite numbers"
            shown = text if len(text) < 40 else text[:37] + "..."
            raise self.fail(
                element, f"<{element.tag} {name}>: expected {expected}, got {shown!r}"
            )
        return values

    def number(self, element: ET.Element, name: str) -> float:
        return self.numbers(element, name, 1)[0]

    def pose(self, element: ET.Element) -> FloatArray:
        """The <origin> of an element, (4, 4)."""
        origin = element.find("origin")
        if origin is None:
            return np.eye(4)
        return pose(
            *(self.numbers(origin, name, 3, "0 0 0") for name in ("xyz", "rpy"))
        )

    def robot(self) -> UrdfRobot:
        if self.top.tag != "robot":
            raise self.fail(self.top, f"expected <robot>, got <{self.top.tag}>")
        count = len(self.top.findall("link"))
        if count > MOST_LINKS:
            raise self.fail(
                self.top, f"expected at most {MOST_LINKS} links, got {count}"
            )
        links: dict[str, UrdfLink] = {}
        for element in self.top.findall("link"):
            link = self.link(element)
            if link.name in links:
                raise self.fail(element, f"link {link.name!r} is there twice")
            links[link.name] = link
        joints: dict[str, UrdfJoint] = {}
        parents, children = set[str](), dict[str, list[UrdfJoint]]()
        for element in self.top.findall("joint"):
            joint = self.joint(element)
            if joint.name in joints:
                raise self.fail(element, f"joint {joint.name!r} is there twice")
            for end in (joint.parent, joint.child):
                if end not in links:
                    raise self.fail(element, f"joint {joint.name!r}: no link {end!r}")
            if joint.child in parents:
                raise self.fail(element, f"link {joint.child!r} has two parents")
            parents.add(joint.child)
            children.setdefault(joint.parent, []).append(joint)
            joints[joint.name] = joint
        if not links:
            raise self.fail(self.top, "there is no <link>")
        roots = [name for name in links if name not in parents]
        if len(roots) != 1:
            words = (
                f"{len(roots)} root links: {', '.join(roots[:4])}"
                if roots
                else "no root link"
            )
            raise self.fail(self.top, f"expected one tree of links, found {words}")
        ordered, outwards = {}, [roots[0]]
        for link_name in outwards:
            for joint in children.get(link_name, ()):
                ordered[joint.name] = joint
                outwards.append(joint.child)
        if len(ordered) != len(joints):
            raise self.fail(self.top, "the joints form a loop")
        return UrdfRobot(self.top.get("name", ""), roots[0], links, ordered)

    def link(self, element: ET.Element) -> UrdfLink:
        collisions = element.findall("collision")
        shapes = [self.geometry(collision) for collision in collisions]
        volumes = [_volume(kind, *size) for kind, size, _ in shapes]
        volume = sum(volumes, 0.0)
        centre = np.zeros(3)
        if volume > 0:
            centres = [self.pose(collision)[:3, 3] for collision in collisions]
            centre = np.average(centres, axis=0, weights=volumes)
        mass, com, inertia = None, np.zeros(3), np.zeros((3, 3))
        inertial = element.find("inertial")
        if inertial is not None:
            mass_element, tensor = inertial.find("mass"), inertial.find("inertia")
            if mass_element is None or tensor is None:
                raise self.fail(inertial, "<inertial> needs <mass> and <inertia>")
            mass = self.number(mass_element, "value")
            pose = self.pose(inertial)
            six = [
                self.number(tensor, f"i{axes}")
                for axes in ("xx", "xy", "xz", "yy", "yz", "zz")
            ]
            rotation, com = pose[:3, :3], pose[:3, 3]
            inertia = (
                rotation @ np.take(six, [[0, 1, 2], [1, 3, 4], [2, 4, 5]]) @ rotation.T
            )
        files = tuple(self.attribute(mesh, "filename") for mesh in element.iter("mesh"))
        name, meshes = (
            self.attribute(element, "name"),
            tuple(file for *_, file in shapes if file),
        )
        return UrdfLink(name, mass, com, inertia, volume, centre, meshes, files)

    def geometry(self, element: ET.Element) -> tuple[str, list[float], str]:
        """Kind, size and file name of a visual's or collision's shape; see `UrdfShape`."""
        shape = element.find("geometry/*")
        if shape is None:
            raise self.fail(element, f"<{element.tag}> has no geometry")
        if shape.tag not in _SIZES:
            raise self.fail(shape, f"unknown shape <{shape.tag}>")
        sizes = _SIZES[shape.tag].items()
        size = [
            number
            for name, count in sizes
            for number in self.numbers(shape, name, count)
        ]
        return (
            shape.tag,
            size,
            self.attribute(shape, "filename") if shape.tag == "mesh" else "",
        )

    def shapes(self, element: str) -> Iterator[UrdfShape]:
        for link in self.top.findall("link"):
            for index, item in enumerate(link.findall(element)):
                kind, size, file = self.geometry(item)
                color = item.find("material/color")
                rgba = [] if color is None else self.numbers(color, "rgba", 4)
                name, placement = self.attribute(link, "name"), self.pose(item)
                yield UrdfShape(
                    name, index, kind, tuple(size), file, placement, tuple(rgba)
                )

    def joint(self, element: ET.Element) -> UrdfJoint:
        name, kind = self.attribute(element, "name"), self.attribute(element, "type")
        if kind not in JOINT_TYPES:
            raise self.fail(element, f"joint {name!r}: unknown type {kind!r}")
        more: dict[str, Any] = {}
        for tag in ("parent", "child"):
            end = element.find(tag)
            if end is None:
                raise self.fail(element, f"joint {name!r} has no <{tag}>")
            more[tag] = self.attribute(end, "link")
        axis = np.array([1.0, 0.0, 0.0])
        line = element.find("axis")
        if line is not None and kind not in (
            "fixed",
            "floating",
        ):  # those have none: often 0 0 0
            axis = np.array(self.numbers(line, "xyz", 3))
            length = float(np.linalg.norm(axis))
            if not 0 < length < math.inf:
                raise self.fail(line, f"joint {name!r}: the axis has no direction")
            axis = axis / length
        limit, mimic, origin = (
            element.find(tag) for tag in ("limit", "mimic", "origin")
        )
        if limit is not None:
            for key in LIMITS[2 if kind == "continuous" else 0 :]:
                if key in limit.attrib and not NO_LIMIT.match(limit.attrib[key]):
                    more[key] = self.number(limit, key)
        if mimic is not None:
            factors = (key for key in ("multiplier", "offset") if key in mimic.attrib)
            more |= {key: self.number(mimic, key) for key in factors}
            more["mimic"] = self.attribute(mimic, "joint")
        if origin is not None:
            more["printed"] = (origin.get("xyz", ""), origin.get("rpy", ""))
        return UrdfJoint(name, kind, transform=self.pose(element), axis=axis, **more)


def _volume(kind: str, *size: float) -> float:
    """Volume of a shape with these sizes; none of a mesh, whose file is not read."""
    if kind == "box":
        return math.prod(size)
    r, length = (*size, 0.0, 0.0)[:2]
    ball = 0.0 if kind == "cylinder" else 4 / 3 * math.pi * (r * r * r)
    return math.pi * (r * r) * length + ball
