"""An arm of four joints and five bodies: poses, gravity torques, mass matrix."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import moved, rotation_about, transform
from alpha5_model.description.urdf_robot import UrdfJoint
from alpha5_model.numbers.fluids import GRAVITY
from alpha5_model.numbers.inertia import rotate_tensor
from alpha5_model.proofs.comparison.axis_lines import AxisLines
from alpha5_model.proofs.comparison.poses import origin_of, rotation_of
from alpha5_model.proofs.comparison.printed_digits import Rounding

DOWN = np.array(GRAVITY)  # [m/s^2]


@dataclass(frozen=True, eq=False)
class FourJointArm:
    """Four revolute joints and five bodies; every other joint is frozen.

    Body 0 moves with the root, body i with joint i-1. The frame of body i is the child
    frame of its joint.

    Attributes:
        joints: The four joints, base to tip.
        placements: Pose of each joint's child in the body before it, at zero,
            (4, 4, 4).
        axes: Direction of each joint in its child frame, (4, 3).
        mass: Per body, (5,) [kg].
        com: Per body, in its frame, (5, 3) [m].
        inertia: Per body, at the COM, in its frame's axes, (5, 3, 3) [kg m^2].
        volume: Of all collision primitives [m^3].
        shape_centres: Their centroid per body, in its frame, (5, 3) [m]; NaN if none.
        links: Names of the links that make up each body.
        link_poses: Link -> its pose in the frame of its body, (4, 4).
        base_path: Links from the root to the one that axis_e turns in.
        foreign_links: Links that move with the root and are not the arm's: vehicle,
            platform, mount, another arm. They belong to no body.
        digits: How much the digits of the joint origins leave open.
        tool: Name of the link whose frame is the tool's; empty if there is none.
    """

    joints: tuple[UrdfJoint, ...]
    placements: FloatArray
    axes: FloatArray
    mass: FloatArray
    com: FloatArray
    inertia: FloatArray
    volume: float
    shape_centres: FloatArray
    links: tuple[tuple[str, ...], ...]
    link_poses: dict[str, FloatArray]
    base_path: tuple[str, ...]
    foreign_links: tuple[str, ...]
    digits: Rounding
    tool: str

    def poses(self, q: FloatArray) -> FloatArray:
        """Poses of the bodies in the root frame, (..., 5, 4, 4).

        Args:
            q: The arm's own angles, (..., 4) [rad].
        """
        return chain_poses(self.placements, self.axes, q)

    def _moving_poses(self, q: FloatArray) -> FloatArray:
        """Poses of the bodies 1 to 4 in the root frame, (..., 4, 4, 4)."""
        return self.poses(q)[..., 1:, :, :]

    def axis_lines(self, q: FloatArray) -> AxisLines:
        """The axes as lines in the root frame, (..., 4, 3), at angles q (..., 4)."""
        return self._lines(self._moving_poses(q))

    def _lines(self, poses: FloatArray) -> AxisLines:
        """The axes as lines, (..., 4, 3), if the moving bodies have these poses."""
        directions = rotation_of(poses) @ self.axes[..., None]
        return AxisLines(points=origin_of(poses), directions=directions[..., 0])

    def gravity_regressor(
        self, q: FloatArray, gravity: FloatArray = DOWN
    ) -> FloatArray:
        """Gravity torque in air per mass and first moment of each body [Atkeson1986].

        Args:
            q: The arm's own angles, (..., 4) [rad].
            gravity: In the root frame, (3,) [m/s^2].

        Returns:
            (..., 4, 4, 4): joint, moving body, and (mass [kg], first moment (3,) [kg m]
            in the body's frame).
        """
        poses = self._moving_poses(q)
        points, directions = self._lines(poses)
        from_joints = points[..., :, None, :]
        to_bodies = points[..., None, :, :]
        normals = np.cross(directions, gravity)
        levers = to_bodies - from_joints
        per_mass = np.sum(levers * normals[..., :, None, :], axis=-1)

        # All bodies' rotations side by side: one product instead of four.
        rotations = np.moveaxis(rotation_of(poses), -3, -2)
        side_by_side = rotations.reshape(*q.shape[:-1], 3, 12)
        per_moment = (normals @ side_by_side).reshape(*q.shape, 4, 3)

        regressor = np.empty((*q.shape, 4, 4))
        regressor[..., 0] = per_mass
        regressor[..., 1:] = per_moment
        carries = np.triu(np.ones((4, 4)))  # a joint carries the bodies behind it
        return regressor * carries[..., None]

    def gravity_torque(self, q: FloatArray, gravity: FloatArray = DOWN) -> FloatArray:
        """Torques that hold the weight in air, (..., 4) [N m].

        Args:
            q: The arm's own angles, (..., 4) [rad].
            gravity: In the root frame, (3,) [m/s^2].
        """
        first_moments = self.mass[:, None] * self.com
        bodies = np.column_stack([self.mass, first_moments])
        torques = self.gravity_regressor(q, gravity) * bodies[1:]
        return np.asarray(torques.sum(axis=(-2, -1)))

    def mass_matrix(self, q: FloatArray) -> FloatArray:
        """Joint-space inertia, (..., 4, 4) [kg m^2], at the angles q (..., 4).

        The sum over the bodies of J^T I J, with J (..., body, joint, 6) at the COM.
        """
        poses = self._moving_poses(q)
        points, directions = self._lines(poses)
        coms = moved(poses, self.com[1:])
        levers = coms[..., :, None, :] - points[..., None, :, :]

        turned_by = np.tril(np.ones((4, 4)))  # a body turns with the joints before it
        angular = directions[..., None, :, :] * turned_by[..., None]
        linear = np.cross(angular, levers)
        jacobian = np.concatenate([linear, angular], axis=-1)

        mass = self.mass[1:, None, None]
        inertia = rotate_tensor(rotation_of(poses), self.inertia[1:])
        momentum = np.concatenate([mass * linear, angular @ inertia], axis=-1)
        per_body = momentum @ np.swapaxes(jacobian, -1, -2)
        return np.asarray(per_body.sum(axis=-3))


def chain_poses(placements: FloatArray, axes: FloatArray, q: FloatArray) -> FloatArray:
    """Poses of the root and of what each joint carries, (..., N + 1, 4, 4).

    Args:
        placements: Pose of what a joint carries in what the one before it carries, at
            zero, (N, 4, 4).
        axes: Direction of each joint in the frame that it carries, (N, 3).
        q: Angles, (..., N) [rad].
    """
    steps = placements @ transform(rotation_about(axes, q))
    root = np.broadcast_to(np.eye(4), (*q.shape[:-1], 4, 4))
    poses = [root]
    for joint in range(len(axes)):
        poses.append(poses[-1] @ steps[..., joint, :, :])
    return np.stack(poses, axis=-3)
