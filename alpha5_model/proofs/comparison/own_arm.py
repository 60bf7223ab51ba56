"""Our own arm, which other models are compared with, also with other dimensions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import rotation_about, transform
from alpha5_model.description.reading import parse_urdf
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.numbers.inertia import second_moments
from alpha5_model.numbers.jaws import loaded_links
from alpha5_model.numbers.parameters import (
    Alpha5Parameters,
    LinkParameters,
    is_catalogue,
)
from alpha5_model.numbers.rigid_body import RigidBody
from alpha5_model.proofs.comparison.axis_lines import X, Y, Z, foot, z_axes
from alpha5_model.proofs.comparison.chains import AXES
from alpha5_model.proofs.comparison.four_joint_arm import FourJointArm, chain_poses
from alpha5_model.proofs.comparison.reduction import reduce_robot

#: The dimensions of our arm that may differ in another model: distances a and twists
#: alpha of consecutive axes, the offset d_1 of the elbow along axis_d, and its tilt
#: beta_1. axis_d and axis_c are parallel, so alpha_1 alone cannot describe every error
#: of their directions.
DIMENSIONS = ("a_0", "a_1", "a_2", "d_1", "alpha_0", "alpha_1", "alpha_2", "beta_1")
#: Indices in `DIMENSIONS`.
DISTANCES = slice(0, 3)
ELBOW_OFFSET = 3
TWISTS = slice(4, 7)
ELBOW_TILT = 7
#: The dimensions without any change.
AS_IT_IS = np.zeros(len(DIMENSIONS))


@dataclass(frozen=True, eq=False)
class OwnArm:
    """Our arm.

    A ``change`` of its dimensions is (8,) [m, rad], in order of `DIMENSIONS`.

    Attributes:
        parameters: Its numbers.
        reduced: Its URDF, generated from the numbers and read like any other.
    """

    parameters: Alpha5Parameters
    reduced: FourJointArm

    @cached_property
    def tool_pose(self) -> FloatArray:
        """Pose of our tcp, Table 1's {5}, in link_4, (4, 4)."""
        return self.reduced.link_poses[self.reduced.tool]

    @cached_property
    def frame_poses(self) -> dict[str, FloatArray]:
        """Link or DH frame -> its pose in the root at zero, (4, 4)."""
        bodies = self.reduced.poses(np.zeros(4))
        poses = {}
        for body, names in zip(bodies, self.reduced.links, strict=True):
            for name in names:
                poses[name] = body @ self.reduced.link_poses[name]
        return poses

    def frames(self, q: FloatArray, change: FloatArray = AS_IT_IS) -> FloatArray:
        """DH frames {0} to {3}, (..., 4, 4, 4), at q (..., 4), with changed dimensions.

        Their z axes are the joint axes. Each frame is already turned by its own joint.
        """
        placements = np.stack([np.eye(4), *self._links(change)])
        rows = self.parameters.dh[:4]
        offset = np.array([row.theta_offset for row in rows])
        axes = np.tile(Z, (4, 1))
        frames = chain_poses(placements, axes, q + offset)
        return frames[..., 1:, :, :]

    def _links(self, change: FloatArray) -> FloatArray:
        """Poses of the next joints in links 0 to 2, dimensions changed, (3, 4, 4)."""
        rows = self.parameters.dh[:3]
        a = np.array([row.a for row in rows])
        d = np.array([row.d for row in rows])
        alpha = np.array([row.alpha for row in rows])

        a += change[DISTANCES]
        d[1] += change[ELBOW_OFFSET]
        alpha += change[TWISTS]
        twist = rotation_about(X, alpha)
        tilt = rotation_about(Y, change[ELBOW_TILT])
        twist[1] = twist[1] @ tilt

        shift = np.column_stack([a, np.zeros(3), d])
        return transform(twist, shift)

    @cached_property
    def _bodies_in_frames(self) -> FloatArray:
        """Poses of the bodies 1 to 4 in the DH frames {0} to {3}, (4, 4, 4)."""
        zero = np.zeros(4)
        to_frames = np.linalg.inv(self.frames(zero))
        return np.asarray(to_frames @ self.reduced.poses(zero)[1:])

    def zero_poses(self, change: FloatArray) -> FloatArray:
        """Poses of the bodies at zero, (5, 4, 4), with changed dimensions.

        Each body moves with its own joint.
        """
        zero = np.zeros(4)
        poses = self.reduced.poses(zero)
        poses[1:] = self.frames(zero, change) @ self._bodies_in_frames
        return poses

    def with_dimensions(self, change: FloatArray) -> FourJointArm:
        """The arm with changed dimensions; each body moves with its own joint."""
        poses = self.zero_poses(change)
        placements = np.linalg.inv(poses[:-1]) @ poses[1:]
        return replace(self.reduced, placements=placements)

    def tips(self, q: FloatArray, change: FloatArray = AS_IT_IS) -> FloatArray:
        """Tips of the arm, (N, 3) [m], at q (N, 4), with changed dimensions.

        A tip lies on the wrist axis, d_3 from its common normal with axis_c.
        """
        lines = z_axes(self.frames(q, change))
        reach = self.parameters.dh[3].d
        return foot(lines, 3, 2) + reach * lines.directions[:, 3]


@lru_cache(maxsize=4)
def own_arm_of(parameters: Alpha5Parameters) -> OwnArm:
    """Our arm, from the catalogue's numbers with any corrections, or from others."""
    if is_catalogue(parameters):
        variant = Variant(dh_frames=True, corrections=parameters.corrections)
    else:
        variant = Variant(dh_frames=True, arm=parameters)
    text = urdf(variant)
    robot = parse_urdf(text)
    joints = tuple(robot.joints[axis] for axis in AXES)
    reduced = reduce_robot(robot, joints, parameters)
    return OwnArm(parameters=parameters, reduced=reduced)


@lru_cache(maxsize=4)
def compared_record(arm: Alpha5Parameters) -> Alpha5Parameters:
    """The record that other models are compared with.

    What is attached to a link, and the jaws that a spacer moves, are part of that link,
    as in a URDF. The mount is left out: a comparison aligns the bases.
    """
    if is_catalogue(arm):
        return arm
    pairs = zip(arm.links, loaded_links(arm), strict=True)
    links = [own if own is loaded else _widened(own, loaded) for own, loaded in pairs]
    return replace(arm, links=tuple(links), attached=(), mount=None)


def _widened(link: LinkParameters, loaded: RigidBody) -> LinkParameters:
    """A link with what it carries, its bounds wide enough for that."""
    spread = np.sqrt(3 * np.diag(second_moments(loaded.inertia)) / loaded.mass)
    ends = np.column_stack([loaded.com - spread, loaded.com + spread])
    return LinkParameters(
        name=link.name,
        mass=loaded.mass,
        com=loaded.com,
        inertia=loaded.inertia,
        volume=loaded.volume,
        cob=loaded.cob,
        bounds=np.column_stack(
            [
                np.minimum(link.bounds[:, 0], ends[:, 0]),
                np.maximum(link.bounds[:, 1], ends[:, 1]),
            ]
        ),
    )


@lru_cache(maxsize=4)
def random_positions(parameters: Alpha5Parameters, count: int) -> FloatArray:
    """Joint positions within our limits, (count, 4) [rad]; always the same."""
    joints = parameters.joints[:4]
    lower = [joint.lower for joint in joints]
    upper = [joint.upper for joint in joints]
    return np.random.default_rng(0).uniform(lower, upper, (count, 4))
