"""The arm as a tree of bodies, from which YAML, MJCF, SDF and GLB are written.

In addition to the data of a URDF link, a body has its displaced volume and its centre
of buoyancy.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import combinations_with_replacement

from alpha5_model._support.checks import choice
from alpha5_model._support.spatial import Placement
from alpha5_model.description.digits import rounded
from alpha5_model.description.frames import base_placement, joint_placements
from alpha5_model.geometry.collision_shapes import exported_primitives
from alpha5_model.geometry.primitives import Primitive
from alpha5_model.numbers.jaws import (
    GRIPPERS,
    Gripper,
    Jaws,
    loaded_links,
    split_link_4,
)
from alpha5_model.numbers.parameters import Alpha5Parameters, JointRange
from alpha5_model.numbers.rigid_body import RigidBody
from alpha5_model.numbers.tables import BODY_NAMES

#: Bodies that are drawn; the rod is not.
MESHES = (*BODY_NAMES, "finger_1", "finger_2")


@dataclass(frozen=True, eq=False)
class Body(RigidBody):
    """One rigid body in the tree.

    Attributes:
        placement: Parent body, and pose in it with the joint at zero.
        joint: Joint about or along +z of the body; None for link_0, which is fixed in
            base_link.
        meshes: Name of a visual mesh -> its pose in the body.
        shapes: Collision shapes for other programs.
    """

    placement: Placement
    joint: JointRange | None
    meshes: dict[str, Placement]
    shapes: tuple[Primitive, ...]

    @property
    def moments(self) -> dict[str, float]:
        """Upper half of the tensor, ``ixx`` to ``izz`` as in URDF and SDF [kg m^2]."""
        moments = {}
        for i, j in combinations_with_replacement(range(3), 2):
            name = f"i{'xyz'[i]}{'xyz'[j]}"
            moments[name] = float(self.inertia[i, j])
        return moments


def arm_bodies(
    parameters: Alpha5Parameters, gripper: Gripper, meshes: Iterable[str] | None = None
) -> tuple[Body, ...]:
    """The bodies of the arm, each after its parent and with what is attached to it.

    Args:
        parameters: The arm's parameters.
        gripper: ``locked`` (link_0 to link_4) or ``jaws`` (adds rod and fingers).
        meshes: File names of the meshes that exist; others are left out. None for all.
    """
    choice("gripper", gripper, GRIPPERS)
    jaws = split_link_4(parameters)
    hinges = _closed_hinges(jaws)
    drawn = _drawn_meshes(gripper, hinges, MESHES if meshes is None else meshes)
    shapes = exported_primitives(gripper, parameters.spacer)

    links = [_written(link, parameters) for link in loaded_links(parameters)]
    placements = [base_placement(parameters), *joint_placements(parameters)]
    joints: list[JointRange | None] = [None, *parameters.joints[:4]]
    if gripper == "jaws":
        links[4:] = [_written(body, parameters) for body in jaws.bodies]
        placements += hinges.values()
        joints += jaws.joints

    bodies = []
    for record, placement, joint in zip(links, placements, joints, strict=True):
        body = Body(
            name=record.name,
            mass=record.mass,
            com=record.com,
            inertia=record.inertia,
            volume=record.volume,
            cob=record.cob,
            placement=placement,
            joint=joint,
            meshes=drawn.get(record.name, {}),
            shapes=shapes.get(record.name, ()),
        )
        bodies.append(body)
    return tuple(bodies)


def _written(body: RigidBody, parameters: Alpha5Parameters) -> RigidBody:
    """A body as files have it: a link of the record as it is, a computed one rounded.

    Wrist, rod and fingers are computed, and so are links with something attached.
    """
    if body in parameters.links:
        return body
    return RigidBody(
        name=body.name,
        mass=float(rounded(body.mass)),
        com=rounded(body.com),
        inertia=rounded(body.inertia),
        volume=float(rounded(body.volume)),
        cob=rounded(body.cob),
    )


def _closed_hinges(jaws: Jaws) -> dict[str, Placement]:
    """Poses in link_4 of the rod and the fingers, joints at zero."""
    hinges = {}
    for body, joint in zip(jaws.bodies[1:], jaws.joints, strict=True):
        x, y, z = body.origin.tolist()
        # A closed joint is at its lower limit. Rod and fingers have +z along -z of
        # link_4 or across it.
        hinges[body.name] = Placement(
            parent="link_4",
            xyz=(x, y, z + joint.lower),
            rpy=(body.roll, 0.0, 0.0),
        )
    return hinges


def _drawn_meshes(
    gripper: Gripper, hinges: Mapping[str, Placement], files: Iterable[str]
) -> dict[str, dict[str, Placement]]:
    """Body -> its meshes and their poses in it, if their files exist."""
    drawn = {name: {name: Placement(name)} for name in MESHES}
    if gripper == "locked":
        drawn["link_4"] |= {
            "finger_1": hinges["finger_1"],
            "finger_2": hinges["finger_2"],
        }

    existing = {file.removesuffix(".obj") for file in files}
    for body, meshes in drawn.items():
        drawn[body] = {name: at for name, at in meshes.items() if name in existing}
    return drawn
