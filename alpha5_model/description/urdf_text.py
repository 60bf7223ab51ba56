"""What a URDF's text says: links and joints as numbers, read without any robotics library."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.errors import FileFormatError, MissingFileError

_ZERO = "0 0 0"
_ENTRIES = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


@dataclass(frozen=True, eq=False)
class InertialText:
    """An ``<inertial>`` element.

    Attributes:
        mass: [kg].
        xyz, rpy: Pose of the COM frame in the link's frame, (3,) [m], [rad].
        inertia: (3, 3) about the COM, in the COM frame's axes [kg m^2].
    """

    mass: float
    xyz: FloatArray
    rpy: FloatArray
    inertia: FloatArray


@dataclass(frozen=True, eq=False)
class JointText:
    """A ``<joint>`` element.

    Attributes:
        name, kind, parent, child: As written; kind is the attribute ``type``.
        axis: (3,); the default of the format is (1, 0, 0).
        origin: Pose of the child in the parent at position zero, (4, 4).
        limits: ``lower``, ``upper``, ``velocity``, ``effort``, those that are written.
        mimic: Joint, multiplier and offset, if it follows another.
    """

    name: str
    kind: str
    parent: str
    child: str
    axis: FloatArray
    origin: FloatArray
    limits: dict[str, float]
    mimic: tuple[str, float, float] | None


@dataclass(frozen=True, eq=False)
class UrdfText:
    """A URDF file.

    Attributes:
        path: Where it was read from.
        prefix: What stands before ``base_link``.
        links: Name -> its inertial element; None if it has none.
        joints: Name -> joint.
    """

    path: Path
    prefix: str
    links: dict[str, InertialText | None]
    joints: dict[str, JointText]


def read_urdf(path: str | os.PathLike[str]) -> UrdfText:
    """Read the links and joints of a URDF.

    Raises:
        MissingFileError: No such file.
        FileFormatError: Not XML, not a robot, two elements of one name, or text where a number
            belongs; the message names the place.
    """
    file = Path(path)
    if not file.is_file():
        raise MissingFileError(path, "a URDF file")
    try:
        root = ElementTree.fromstring(file.read_bytes())
    except ElementTree.ParseError as error:
        raise FileFormatError(path, f"not XML: {error}") from None
    if root.tag != "robot":
        raise FileFormatError(path, f"expected <robot>, got <{root.tag}>")
    reader = _Reader(file)
    links: dict[str, InertialText | None] = {}
    joints: dict[str, JointText] = {}
    for element in root.findall("link"):
        name = reader.name(element, links)
        links[name] = reader.inertial(element, f"link {name}")
    for element in root.findall("joint"):
        name = reader.name(element, joints)
        joints[name] = reader.joint(element, name)
    base = [name for name in links if name.endswith("base_link")]
    prefix = base[0].removesuffix("base_link") if len(base) == 1 else ""
    return UrdfText(file, prefix, links, joints)


def pose(xyz: FloatArray, rpy: FloatArray) -> FloatArray:
    """Transform of a URDF ``<origin>``: fixed-axis roll, pitch, yaw, (4, 4)."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    out = np.eye(4)
    out[:3, :3] = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    out[:3, 3] = xyz
    return out


class _Reader:
    def __init__(self, path: Path) -> None:
        self.path = path

    def name(self, element: ElementTree.Element, known: object) -> str:
        name = element.get("name")
        if not name:
            raise FileFormatError(self.path, f"a {element.tag} without a name")
        if isinstance(known, dict) and name in known:
            raise FileFormatError(self.path, "stands twice", f"{element.tag} {name}")
        return name

    def numbers(self, text: str, count: int, place: str) -> FloatArray:
        try:
            values = np.array([float(part) for part in text.split()])
        except ValueError:
            values = np.empty(0)
        if values.shape != (count,) or not np.isfinite(values).all():
            expected = "a number" if count == 1 else f"{count} numbers"
            raise FileFormatError(self.path, f"expected {expected}, got {text!r}", place)
        return values

    def number(self, element: ElementTree.Element, key: str, place: str) -> float:
        text = element.get(key)
        if text is None:
            raise FileFormatError(self.path, f"{key} is missing", place)
        return float(self.numbers(text, 1, f"{place}, {key}")[0])

    def origin(self, element: ElementTree.Element, place: str) -> tuple[FloatArray, FloatArray]:
        origin = element.find("origin")
        given = {} if origin is None else origin.attrib
        xyz, rpy = (self.numbers(given.get(k, _ZERO), 3, f"{place}, {k}") for k in ("xyz", "rpy"))
        return xyz, rpy

    def inertial(self, link: ElementTree.Element, place: str) -> InertialText | None:
        element = link.find("inertial")
        if element is None:
            return None
        mass, inertia = element.find("mass"), element.find("inertia")
        if mass is None or inertia is None:
            raise FileFormatError(self.path, "an inertial without mass or inertia", place)
        xx, xy, xz, yy, yz, zz = (self.number(inertia, key, place) for key in _ENTRIES)
        xyz, rpy = self.origin(element, place)
        tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        return InertialText(self.number(mass, "value", place), xyz, rpy, tensor)

    def joint(self, element: ElementTree.Element, name: str) -> JointText:
        place = f"joint {name}"
        ends = {}
        for end in ("parent", "child"):
            found = element.find(end)
            if found is None or not found.get("link"):
                raise FileFormatError(self.path, f"no {end} link", place)
            ends[end] = str(found.get("link"))
        axis, limit, mimic = (element.find(tag) for tag in ("axis", "limit", "mimic"))
        given = "1 0 0" if axis is None else axis.get("xyz", "1 0 0")
        keys = [] if limit is None else limit.attrib
        return JointText(
            name=name,
            kind=element.get("type", ""),
            parent=ends["parent"],
            child=ends["child"],
            axis=self.numbers(given, 3, f"{place}, axis"),
            origin=pose(*self.origin(element, place)),
            limits={} if limit is None else {key: self.number(limit, key, place) for key in keys},
            mimic=None
            if mimic is None
            else (
                mimic.get("joint", ""),
                float(self.numbers(mimic.get("multiplier", "1"), 1, place)[0]),
                float(self.numbers(mimic.get("offset", "0"), 1, place)[0]),
            ),
        )
