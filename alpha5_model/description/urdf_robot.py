"""A robot as a URDF describes it: links, joints and shapes as plain records."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import rotation_about, transform


@dataclass(frozen=True, eq=False)
class UrdfShape:
    """A ``<visual>`` or ``<collision>`` element.

    Attributes:
        link: Name of the link that carries it.
        index: Its number among the link's elements of its kind.
        kind: ``box``, ``cylinder``, ``capsule``, ``sphere`` or ``mesh``.
        size: Edges x, y, z of a box; radius and length of a cylinder or capsule; radius
            of a sphere; empty for a mesh [m].
        file: File name of a mesh.
        placement: Pose in the link, (4, 4).
        color: Red, green, blue, alpha, each 0 to 1; empty if the element has none.
    """

    link: str
    index: int
    kind: str
    size: tuple[float, ...]
    file: str
    placement: FloatArray
    color: tuple[float, ...]

    @property
    def volume(self) -> float:
        """[m^3]; 0 for a mesh, whose file is not read."""
        if self.kind == "box":
            return math.prod(self.size)
        if self.kind == "mesh":
            return 0.0
        radius = self.size[0]
        length = self.size[1] if self.kind in ("cylinder", "capsule") else 0.0
        tube = math.pi * (radius * radius) * length
        ball = 4 / 3 * math.pi * (radius * radius * radius)
        return tube if self.kind == "cylinder" else tube + ball


@dataclass(frozen=True, eq=False)
class UrdfLink:
    """A link.

    Attributes:
        name: Its name.
        mass: [kg]; None without an ``<inertial>``.
        com: In the link frame, (3,) [m].
        inertia: At the COM, in the link's axes, (3, 3) [kg m^2].
        volume: Sum of the volumes of all collision primitives [m^3].
        shape_centre: Their centroid in the link frame, (3,) [m]; zero without any.
        meshes: File names of collision meshes, whose volume is not counted.
        files: File names of all meshes.
        scales: File name -> the scale that is written for it, if there is one.
    """

    name: str
    mass: float | None
    com: FloatArray
    inertia: FloatArray
    volume: float
    shape_centre: FloatArray
    meshes: tuple[str, ...]
    files: tuple[str, ...]
    scales: Mapping[str, tuple[float, ...]] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class UrdfJoint:
    """A joint.

    Attributes:
        name, kind, parent, child: As written; kind is the attribute ``type``.
        transform: Pose of the child in the parent at position zero, (4, 4).
        axis: Unit vector in the child's frame, (3,).
        lower, upper: Limits [rad or m]; None if there is none.
        velocity, effort: Limits [rad/s, N m] or [m/s, N]; None if there is none.
        acceleration, deceleration, jerk: Limits of URDF 1.2 [rad/s^2, rad/s^3] or
            [m/s^2, m/s^3]; None if there is none, or in a file of an earlier version.
        mimic: Joint that it follows by ``multiplier * position + offset``; None if
            none.
        multiplier, offset: 1 and 0 if it follows none.
        printed: The texts of xyz and rpy of its ``<origin>``, which show the number of
            digits; no rpy if a quaternion is read in its place.
        limit: The attributes of its ``<limit>``, as text; None without one.
        dynamics: Those of its ``<dynamics>``: ``damping`` and ``friction``; None
            without one.
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
    acceleration: float | None = None
    deceleration: float | None = None
    jerk: float | None = None
    mimic: str | None = None
    multiplier: float = 1.0
    offset: float = 0.0
    printed: tuple[str, str] = ("", "")
    limit: Mapping[str, str] | None = None
    dynamics: Mapping[str, float] | None = None

    @property
    def source(self) -> str:
        """Name of the joint whose position it follows: itself, or the one it mimics."""
        return self.mimic or self.name

    def motion(self, position: float) -> FloatArray:
        """Transform by a motion from zero to a position [rad or m], (4, 4).

        It acts in the child's frame: the pose is ``transform @ motion(position)``.
        """
        if self.kind == "prismatic":
            return transform(translation=position * self.axis)
        turns = self.kind in ("revolute", "continuous")
        return transform(rotation_about(self.axis, position) if turns else None)


@dataclass(frozen=True)
class Remark:
    """Something that a URDF has and that its readers take differently.

    Attributes:
        kind: ``doubled``: an element that may be there once, of which the first was
            read; ``macro``, ``expression``: unexpanded xacro; ``quaternion``: a
            ``quat_xyzw`` that turns; ``capsule``: such a shape; ``shapes``: a second
            one in a ``<geometry>``; ``number``: one that urdfdom cannot read, infinite
            or with a space behind it.
        where: Name of the link or joint, or ``robot``.
        text: The element's tag, or what is written.
        line: Where it is in the file.
    """

    kind: str
    where: str
    text: str
    line: int


@dataclass(frozen=True, eq=False)
class UrdfRobot:
    """A tree of links.

    Attributes:
        name: Empty if there is none.
        root: Name of the root link.
        links: By name, in the order of the file.
        joints: By name, from the root outwards, each after the joint before it.
        version: The version of URDF, as written; empty stands for 1.0.
        remarks: What its readers take differently, in the order of the file.
    """

    name: str
    root: str
    links: dict[str, UrdfLink]
    joints: dict[str, UrdfJoint]
    version: str = ""
    remarks: tuple[Remark, ...] = ()
