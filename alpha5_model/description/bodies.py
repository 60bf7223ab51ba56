"""The arm as a tree of bodies: what every writer, YAML, MJCF and SDF, walks along.

Beside what URDF knows it holds the displaced volume and the centre of buoyancy of each body.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

from alpha5_model import __version__
from alpha5_model.checks import FloatArray, choice, frozen
from alpha5_model.description.frames import Placement, base_placement, joint_placements
from alpha5_model.jaws import GRIPPERS, JawBody, split_link_4
from alpha5_model.meshing.collision_shapes import Primitive, collision_primitives
from alpha5_model.meshing.materials import Material, material_of
from alpha5_model.parameters import Alpha5Parameters, JointRange, RigidBody
from alpha5_model.published import published


@dataclass(frozen=True)
class Mesh:
    """A visual mesh: file name without suffix, material, pose in the body."""

    name: str
    material: Material
    placement: Placement


@dataclass(frozen=True, eq=False)
class Body(RigidBody):
    """One rigid body in the tree.

    Attributes:
        placement: Parent body and pose in it, joint at zero.
        joint: About or along +z of the body; None for link_0, which is fixed in base_link.
        extent: Outer size along each axis, (3,) [m].
        meshes: What it looks like.
        shapes: What it collides with.
    """

    placement: Placement
    joint: JointRange | None
    extent: FloatArray
    meshes: tuple[Mesh, ...]
    shapes: tuple[Primitive, ...]


def arm_bodies(parameters: Alpha5Parameters, gripper: str) -> tuple[Body, ...]:
    """The bodies, each after its parent.

    Args:
        parameters: The arm's parameters.
        gripper: ``locked`` (link_0 to link_4) or ``jaws`` (adds rod and fingers).
    """
    moving = choice("gripper", gripper, GRIPPERS) == "jaws"
    jaws, arm_joints = split_link_4(parameters), parameters.joints[:4]
    hinges = {  # body -> its pose with its joint at zero, and the joint
        body.name: (_placement(body, joint), joint)
        for body, joint in zip(jaws.bodies[1:], jaws.joints, strict=True)
    }
    placements = [base_placement(parameters), *joint_placements(parameters).values()]
    joints: list[JointRange | None] = [None, *arm_joints]
    records: list[RigidBody] = list(parameters.links)
    if moving:
        records = [*parameters.links[:4], *jaws.bodies]
        placements += [placement for placement, _ in hinges.values()]
        joints += jaws.joints
    shapes = collision_primitives(gripper)
    bodies = []
    for record, placement, joint in zip(records, placements, joints, strict=True):
        meshes = {} if record.name == "jaw_rod" else {record.name: Placement(record.name)}
        if record.name == "link_4" and not moving:  # the closed fingers
            meshes |= {name: hinges[name][0] for name in ("finger_1", "finger_2")}
        bodies.append(
            Body(
                **{field.name: getattr(record, field.name) for field in fields(RigidBody)},
                placement=placement,
                joint=joint,
                extent=_extent(record, parameters),
                meshes=tuple(Mesh(name, material_of(name), at) for name, at in meshes.items()),
                shapes=shapes.get(record.name, ()),
            )
        )
    return tuple(bodies)


def provenance(parameters: Alpha5Parameters) -> dict[str, str]:
    """Where the numbers come from: document, package and corrections."""
    source = published().table_2.source
    return {
        "document": f"{source.publisher}, {source.document}, version {source.version}, {source.date}",
        "package": f"alpha5_model {__version__}",
        "corrections": ", ".join(parameters.corrections) or "none",
    }


def _placement(body: JawBody, joint: JointRange) -> Placement:
    x, y, z = body.origin.tolist()
    # Closed, the joint is at its lower limit; rod and fingers have +z along -z or across link_4's.
    return Placement("link_4", (x, y, z + joint.lower), (body.roll, 0.0, 0.0))


def _extent(record: RigidBody, parameters: Alpha5Parameters) -> FloatArray:
    jaws = parameters.jaws
    if record.name == "jaw_rod":
        return frozen([jaws.rod_diameter, jaws.rod_diameter, jaws.rod_length])
    if record.name.startswith("finger"):
        thickness = jaws.finger_volume / (jaws.finger_length * jaws.finger_width)
        return frozen([thickness, jaws.finger_length, jaws.finger_width])
    bounds = parameters.links[int(record.name[-1])].bounds
    return frozen(bounds[:, 1] - bounds[:, 0])
