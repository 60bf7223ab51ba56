"""The collision bodies of an arm: shapes, the chain that moves them, pairs to compare.

They are made from the record alone, so that inverse kinematics can ask about collisions
without Pinocchio. A URDF has fewer shapes (`alpha5_model.geometry.collision_shapes`).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np

from alpha5_model._support.checks import FloatArray, choice
from alpha5_model._support.spatial import pose, rotation_from_rpy
from alpha5_model.collision.link_pairs import unchecked_pairs
from alpha5_model.geometry.collision_shapes import collision_primitives
from alpha5_model.geometry.primitives import Primitive
from alpha5_model.numbers.jaws import GRIPPERS, Gripper, split_link_4
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.tables import BODY_NAMES


@dataclass(frozen=True, eq=False)
class Body:
    """One body of the chain.

    Attributes:
        name: Of its link.
        parent: Number of the body that carries it; -1 for the first.
        placement: Pose in the parent at joint position zero, (4, 4) [m]. The body turns
            about its z.
        shapes: In the body's frame.
    """

    name: str
    parent: int
    placement: FloatArray
    shapes: tuple[Primitive, ...]


@dataclass(frozen=True, eq=False)
class CollisionBodies:
    """What is compared for self-collision.

    Attributes:
        bodies: link_0 to link_4, with jaws also the fingers; each after its parent.
        pairs: Numbers of the bodies that are compared.
    """

    bodies: tuple[Body, ...]
    pairs: tuple[tuple[int, int], ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the bodies' links."""
        return tuple(body.name for body in self.bodies)

    @property
    def shapes(self) -> tuple[tuple[int, Primitive], ...]:
        """Every shape with the number of its body."""
        return tuple(
            (number, shape)
            for number, body in enumerate(self.bodies)
            for shape in body.shapes
        )


def collision_bodies(
    parameters: Alpha5Parameters, gripper: Gripper = "locked"
) -> CollisionBodies:
    """The collision bodies of an arm.

    Args:
        parameters: The arm's record.
        gripper: ``locked``: the closed fingers belong to link_4. ``jaws``: they turn.

    Raises:
        UnknownNameError: Another gripper.
    """
    choice("gripper", gripper, GRIPPERS)
    shapes = collision_primitives(gripper, parameters.spacer)
    placements = [np.eye(4), *_link_placements(parameters)]
    bodies = [
        Body(name=name, parent=number - 1, placement=placement, shapes=shapes[name])
        for number, (name, placement) in enumerate(
            zip(BODY_NAMES, placements, strict=True)
        )
    ]
    if gripper == "jaws":
        bodies += _fingers(parameters, shapes)
    return CollisionBodies(bodies=tuple(bodies), pairs=_pairs(bodies, parameters))


def _link_placements(parameters: Alpha5Parameters) -> list[FloatArray]:
    """Pose of links 1 to 4 in the link before, at joint position zero.

    Link i+1 is DH frame {i} turned by joint i (Section 2): what leads from it to the
    next joint is the rest of its DH row.
    """
    rows = parameters.dh
    shoulder = (0.0, 0.0, rows[0].theta_offset - parameters.base_yaw)
    placements = [pose((0.0, 0.0, 0.0), shoulder)]
    for row, following in pairwise(rows[:4]):
        after_row = pose((row.a, 0.0, row.d), (row.alpha, 0.0, 0.0))
        turn = pose((0.0, 0.0, 0.0), (0.0, 0.0, following.theta_offset))
        placements.append(after_row @ turn)
    return placements


def _fingers(
    parameters: Alpha5Parameters, shapes: dict[str, tuple[Primitive, ...]]
) -> list[Body]:
    jaws = split_link_4(parameters)
    link_4 = BODY_NAMES.index("link_4")
    return [
        Body(
            name=finger.name,
            parent=link_4,
            placement=pose(finger.origin, (finger.roll, 0.0, 0.0)),
            shapes=shapes[finger.name],
        )
        for finger in (jaws.finger_1, jaws.finger_2)
    ]


def _pairs(
    bodies: list[Body], parameters: Alpha5Parameters
) -> tuple[tuple[int, int], ...]:
    """Numbers of the bodies whose links are checked against each other."""
    left_out = {
        frozenset(pair)
        for pairs in unchecked_pairs(parameters).values()
        for pair in pairs
    }
    numbered = combinations(range(len(bodies)), 2)
    return tuple(
        (one, other)
        for one, other in numbered
        if frozenset((bodies[one].name, bodies[other].name)) not in left_out
    )


def carriers(bodies: CollisionBodies, body: int) -> list[int]:
    """Numbers of a body and of those that carry it, without the first."""
    found = []
    while body > 0:
        found.append(body)
        body = bodies.bodies[body].parent
    return found


def body_numbers(bodies: CollisionBodies) -> FloatArray:
    """Parent and placement of each body, (B, 13), as the compiled scene takes them."""
    return np.array(
        [[body.parent, *body.placement[:3].ravel()] for body in bodies.bodies]
    )


def shape_numbers(bodies: CollisionBodies) -> FloatArray:
    """Body, kind, half edges and pose of each shape, (S, 17), for the compiled scene.

    A cylinder has its radius twice and half its length.
    """
    rows = []
    for number, shape in bodies.shapes:
        is_round = shape.kind == "cylinder"
        if is_round:
            radius, length = shape.size
            half = [radius, radius, length / 2]
        else:
            half = [edge / 2 for edge in shape.size]
        placement = np.eye(4)[:3]
        placement[:, :3] = rotation_from_rpy(shape.rpy)
        placement[:, 3] = shape.xyz
        rows.append([number, is_round, *half, *placement.ravel()])
    return np.array(rows, np.float64).reshape(-1, 17)


def body_poses(bodies: CollisionBodies, angles: FloatArray) -> list[FloatArray]:
    """Poses (4, 4) of all bodies in link_0 at the angles of all but the first, (B-1,).

    A finger's angle is that of its own hinge.
    """
    poses = [np.eye(4)]
    for body, angle in zip(bodies.bodies[1:], angles, strict=True):
        turned = body.placement @ pose((0.0, 0.0, 0.0), (0.0, 0.0, float(angle)))
        poses.append(poses[body.parent] @ turned)
    return poses
