"""The arm as a tree of bodies: what the writers of formats other than URDF walk along.

The tree holds the same numbers as ``xacro/parameters.yaml`` and, beside them, what URDF has no
place for: the displaced volume and the centre of buoyancy of each body.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from alpha5_model.checks import FloatArray, choice, frozen
from alpha5_model.description.bodies.materials import Material, material_of
from alpha5_model.description.frames import Placement
from alpha5_model.description.parameter_file import parameter_tree
from alpha5_model.description.variants import GRIPPERS
from alpha5_model.jaws import JawBody, split_link_4
from alpha5_model.parameters import Alpha5Parameters, LinkParameters


@dataclass(frozen=True)
class Mimic:
    """``angle = offset + multiplier * leader`` [rad, rad/m]."""

    leader: str
    multiplier: float
    offset: float


@dataclass(frozen=True)
class Joint:
    """A joint about or along +z of its child; [rad, rad/s, N m] or [m, m/s, N].

    Attributes:
        name: ``axis_e`` to ``axis_a``, ``finger_1_joint``, ``finger_2_joint``.
        kind: ``revolute`` or ``prismatic``.
        mimic: What the joint follows; None if it has its own actuator.
    """

    name: str
    kind: str
    lower: float
    upper: float
    velocity: float
    effort: float
    mimic: Mimic | None = None


@dataclass(frozen=True)
class Mesh:
    """A visual mesh: file name without suffix, material, pose in the body."""

    name: str
    material: Material
    placement: Placement


@dataclass(frozen=True)
class Shape:
    """A collision primitive: ``box`` (full sizes), ``cylinder`` (radius, length), ``sphere``."""

    kind: str
    size: tuple[float, ...]
    placement: Placement


@dataclass(frozen=True, eq=False)
class Body:
    """One rigid body.

    Attributes:
        name: As the link of the URDF.
        placement: Parent body and pose in it, joint at zero.
        joint: None for link_0, which is fixed in base_link.
        mass: [kg].
        com: (3,) [m].
        inertia: At the COM, URDF sign, (3, 3) [kg m^2].
        volume: Displaced volume [m^3].
        cob: Centre of buoyancy, (3,) [m].
        extent: Outer size along each axis, (3,) [m].
        meshes: What it looks like.
        shapes: What it collides with.
    """

    name: str
    placement: Placement
    joint: Joint | None
    mass: float
    com: FloatArray
    inertia: FloatArray
    volume: float
    cob: FloatArray
    extent: FloatArray
    meshes: tuple[Mesh, ...]
    shapes: tuple[Shape, ...]


def arm_bodies(parameters: Alpha5Parameters, gripper: str) -> tuple[Body, ...]:
    """The bodies, each after its parent.

    Args:
        parameters: The arm's parameters.
        gripper: ``locked`` (link_0 to link_4) or ``jaws`` (adds rod and fingers).
    """
    choice("gripper", gripper, GRIPPERS)
    tree = parameter_tree(parameters)
    joints, links = dict(tree["joints"]), dict(tree["links"])
    records: list[LinkParameters | JawBody] = list(parameters.links)
    closed = ("finger_1", "finger_2") if gripper == "locked" else ()
    if gripper == "jaws":
        joints.update(tree["jaws"]["joints"])
        links.update(tree["jaws"]["links"])
        records = [*parameters.links[:4], *split_link_4(parameters).bodies]
    by_child = {joint["child"]: (name, joint) for name, joint in joints.items()}
    bodies = []
    for record in records:
        name, data = by_child.get(record.name, ("", tree["frames"]["link_0"]))
        meshes = [_mesh(record.name)] if record.name != "jaw_rod" else []
        if record.name == "link_4":
            at = {j["child"]: _placement(j) for j in tree["jaws"]["joints"].values()}
            meshes += [_mesh(finger, at[finger]) for finger in closed]
        bodies.append(
            Body(
                name=record.name,
                placement=_placement(data),
                joint=_joint(name, data) if name else None,
                mass=record.mass,
                com=record.com,
                inertia=record.inertia,
                volume=record.volume,
                cob=record.cob,
                extent=_extent(record, parameters),
                meshes=tuple(meshes),
                shapes=tuple(_shape(shape) for shape in links[record.name]["collision"]),
            )
        )
    return tuple(bodies)


def _extent(record: LinkParameters | JawBody, parameters: Alpha5Parameters) -> FloatArray:
    jaws = parameters.jaws
    if record.name == "jaw_rod":
        return frozen([jaws.rod_diameter, jaws.rod_diameter, jaws.rod_length])
    if record.name.startswith("finger"):
        thickness = jaws.finger_volume / (jaws.finger_length * jaws.finger_width)
        return frozen([thickness, jaws.finger_length, jaws.finger_width])
    bounds = parameters.links[int(record.name[-1])].bounds
    return frozen(bounds[:, 1] - bounds[:, 0])


def _joint(name: str, data: dict[str, Any]) -> Joint:
    mimic = None
    if "multiplier" in data:
        mimic = Mimic("axis_a", data["multiplier"], data["offset"])
    return Joint(
        name=name,
        kind="prismatic" if name == "axis_a" else "revolute",
        lower=data["lower"],
        upper=data["upper"],
        velocity=data["velocity"],
        effort=data["effort"],
        mimic=mimic,
    )


def _mesh(name: str, placement: Placement | None = None) -> Mesh:
    return Mesh(name, material_of(name), placement or Placement(name))


def _shape(data: dict[str, Any]) -> Shape:
    return Shape(data["kind"], tuple(data["size"]), _placement({"parent": "", **data}))


def _placement(data: dict[str, Any]) -> Placement:
    x, y, z = data["xyz"]
    roll, pitch, yaw = data["rpy"]
    return Placement(data["parent"], (x, y, z), (roll, pitch, yaw))
