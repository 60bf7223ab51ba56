"""Two bodies of an arm and the joints between them, as arrays for a proof."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model._support.spatial import rotation_about, rotation_from_rpy
from alpha5_model.collision.bodies import CollisionBodies, shape_numbers
from alpha5_model.collision.coal_scene import coal_shape
from alpha5_model.collision.turning_radii import (
    joints_between,
    shape_radii,
    shape_rates,
)


class Joint(NamedTuple):
    """A joint, which turns a frame about its z axis.

    Attributes:
        placement: Pose of the frame at angle 0 in the frame before, (4, 4).
        lower, upper: Range of the angle [rad].
    """

    placement: FloatArray
    lower: float
    upper: float


class ShapeArrays(NamedTuple):
    """The n shapes of a body as arrays, in its frame.

    Attributes:
        centre: (n, 3).
        rotation: (n, 3, 3).
        half: Half edges of boxes; radius, radius and half length of cylinders, (n, 3).
        is_cylinder: (n,).
        solids: The same for coal.
    """

    centre: FloatArray
    rotation: FloatArray
    half: FloatArray
    is_cylinder: BoolArray
    solids: tuple[Any, ...]


@dataclass(frozen=True, eq=False)
class BodyPair:
    """Two bodies and what is between them.

    Attributes:
        names: Of their links; the first one carries the second.
        first, second: Their shapes, each in the frame of its body.
        joints: From the first body to the second, m of them.
        rates: Lipschitz constants of the shapes' distances, (first, second, m) [m/rad].
        second_radii: Largest distance of the second body's shapes from each axis,
            (second, m) [m].
    """

    names: tuple[str, str]
    first: ShapeArrays
    second: ShapeArrays
    joints: tuple[Joint, ...]
    rates: FloatArray
    second_radii: FloatArray

    @property
    def lower(self) -> FloatArray:
        """Lower ends of the joints' ranges, (m,)."""
        return np.array([joint.lower for joint in self.joints])

    @property
    def upper(self) -> FloatArray:
        """Upper ends of the joints' ranges, (m,)."""
        return np.array([joint.upper for joint in self.joints])


def body_pair(
    bodies: CollisionBodies,
    ranges: tuple[FloatArray, FloatArray],
    pair: tuple[int, int],
) -> BodyPair:
    """Two bodies of an arm.

    Args:
        bodies: Of the arm.
        ranges: Of all its joints, see `alpha5_model.collision.bodies.joint_ranges`.
        pair: Numbers of the bodies, of which the first carries the second.
    """
    one, other = pair
    lower, upper = ranges
    between = joints_between(bodies, pair)
    joints = [
        Joint(
            placement=bodies.bodies[number].placement,
            lower=float(lower[number - 1]),
            upper=float(upper[number - 1]),
        )
        for number in between
    ]
    return BodyPair(
        names=(bodies.names[one], bodies.names[other]),
        first=_shape_arrays(bodies, one),
        second=_shape_arrays(bodies, other),
        joints=tuple(joints),
        rates=shape_rates(bodies, pair),
        second_radii=shape_radii(bodies, other, between),
    )


def _shape_arrays(bodies: CollisionBodies, body: int) -> ShapeArrays:
    """Boxes and cylinders of a body as arrays."""
    numbers = shape_numbers(bodies)
    shapes = bodies.bodies[body].shapes
    of_body = numbers[numbers[:, 0] == body]
    return ShapeArrays(
        centre=np.array([shape.xyz for shape in shapes]),
        rotation=np.array([rotation_from_rpy(shape.rpy) for shape in shapes]),
        half=of_body[:, 2:5],
        is_cylinder=of_body[:, 1] != 0.0,
        solids=tuple(coal_shape(shape) for shape in shapes),
    )


def frames_along(joints: Sequence[Joint], q: FloatArray) -> FloatArray:
    """Poses in the first body of the frames that m joints turn.

    Args:
        joints: From the first body on.
        q: Their angles, (n, m) [rad].

    Returns:
        (n, m, 4, 4).
    """
    frame = np.broadcast_to(np.eye(4), (len(q), 4, 4))
    frames = np.empty((*q.shape, 4, 4))
    for i, joint in enumerate(joints):
        turn = np.zeros((len(q), 4, 4))
        turn[:, :3, :3] = rotation_about([0.0, 0.0, 1.0], q[:, i])
        turn[:, 3, 3] = 1.0
        frame = frame @ joint.placement @ turn
        frames[:, i] = frame
    return frames
