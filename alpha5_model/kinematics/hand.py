"""The orientation of the hand, which theta_3 and a free theta_0 can change.

The rotation from the hand to a target is split into a twist about the wrist axis and a
swing of that axis (swing-twist decomposition, [Dobrowolski2015]). theta_3 can make the
twist. The swing remains: the angle between the wrist axis and its target.

References:
    [Dobrowolski2015] Swing-twist decomposition in Clifford algebra, arXiv:1506.05481.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import cross_matrix, wrap
from alpha5_model.kinematics.arm_shape import ArmShape
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.theory.dh.alpha5_table import alpha5_table
from alpha5_model.theory.dh.chain import DHChain
from alpha5_model.theory.dh.link import dh_transform


class Hand(NamedTuple):
    """The hand at the end of an arm.

    Attributes:
        chain: The arm.
        shape: Its lengths, zeros and limits.
        wrist_axis: Direction of joint 3's axis in the axes of the tcp, (3,), the same
            for every joint position.
    """

    chain: DHChain
    shape: ArmShape
    wrist_axis: FloatArray

    @classmethod
    def from_parameters(cls, parameters: Alpha5Parameters) -> Hand:
        """The hand of the arm that a record describes."""
        chain = DHChain(**alpha5_table(parameters))
        _, axes = chain.joint_axes(chain.home)
        rotation = chain.forward_kinematics(chain.home)[:3, :3]
        return cls(
            chain=chain,
            shape=ArmShape.from_parameters(parameters),
            wrist_axis=rotation.T @ axes[3],
        )

    def rotation(self, q: FloatArray) -> FloatArray:
        """Rotation matrices of the tcp, (..., 3, 3)."""
        return self.chain.forward_kinematics(q)[..., :3, :3]

    def turn_wrist(
        self, q: FloatArray, rotation: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Joint positions with the best theta_3.

        Args:
            q: (..., 4, 4) [rad]; not changed.
            rotation: Of the targets, (..., 3, 3).

        Returns:
            q with theta_3 within its limits, and the rotation error (..., 4) [rad].
        """
        middle = self.shape.middle[3]
        lower = self.shape.lower[3]
        upper = self.shape.upper[3]
        axis = self.wrist_axis

        turned = q.copy()
        turned[..., 3] = 0.0
        # The rotation from the hand to the target, in the axes of the tcp.
        inverse = np.swapaxes(self.rotation(turned), -1, -2)
        to_target = inverse @ rotation[..., None, :, :]

        swung_axis = to_target @ axis
        along = swung_axis @ axis
        across = np.linalg.norm(np.cross(axis, swung_axis), axis=-1)
        swing = np.arctan2(across, along)

        # The twist, which theta_3 should make.
        sine = np.einsum("...ij,ij->...", to_target, cross_matrix(axis))
        cosine = np.trace(to_target, axis1=-2, axis2=-1) - along
        wanted = wrap(np.arctan2(sine, cosine), middle)
        turned[..., 3] = np.clip(wanted, lower, upper)

        # cos(error / 2) = cos(swing / 2) cos(missed / 2). With the squared sines s and
        # m of the half angles, small errors keep their digits.
        missed = turned[..., 3] - wanted
        s = np.sin(swing / 2) ** 2
        m = np.sin(missed / 2) ** 2
        error = 2 * np.arctan2(np.sqrt(s + m - s * m), np.sqrt((1 - s) * (1 - m)))
        return turned, error

    def rotation_error(self, q: FloatArray, rotation: FloatArray) -> FloatArray:
        """Angles between the hand and targets (..., 3, 3), (...) [rad]."""
        inverse = np.swapaxes(self.rotation(q), -1, -2)
        to_target = inverse @ rotation
        skew = to_target - np.swapaxes(to_target, -1, -2)
        sine = np.linalg.norm(skew, axis=(-2, -1)) / math.sqrt(8.0)
        cosine = (np.trace(to_target, axis1=-2, axis2=-1) - 1.0) / 2.0
        return np.asarray(np.arctan2(sine, cosine))

    def wrist_of_rotation(self, rotation: FloatArray) -> FloatArray:
        """theta_3 with which joints 0 to 2 can make rotations (..., 3, 3), (...) [rad].

        The other one is half a turn off. link_4 is turned by ``Rz(azimuth) Ry(pitch)
        Rz(-psi) Rx(pi)``, whose psi is an Euler angle of the target.
        """
        tool = self.rotation_in_link_4
        turned = rotation @ tool.T @ np.diag([1.0, -1.0, -1.0])
        psi = np.arctan2(turned[..., 2, 1], turned[..., 2, 0])
        return np.asarray(psi - self.shape.wrist_offset)

    @property
    def rotation_in_link_4(self) -> FloatArray:
        """Axes of the tcp in link_4, (3, 3)."""
        wrist = self.chain.links[-1]
        to_last = dh_transform(0.0, wrist.d, wrist.a, wrist.alpha)
        return np.asarray((to_last @ self.chain.tool)[:3, :3])

    def yaws_with_wrist(self, q: FloatArray, rotation: FloatArray) -> list[FloatArray]:
        """Candidates for a free theta_0 at the theta_3 of q, one of them the best.

        Args:
            q: (..., 4) [rad].
            rotation: Of the targets, broadcasts to (..., 3, 3).

        Returns:
            Values of theta_0, (...) each.
        """
        lower = self.shape.lower[0]
        upper = self.shape.upper[0]
        inverse = np.swapaxes(self.rotation(q), -1, -2)
        wanted = wrap(
            q[..., 0] + _turn_about_z(rotation @ inverse), self.shape.middle[0]
        )
        ends = [np.full(q.shape[:-1], end) for end in (lower, upper)]
        return [np.clip(wanted, lower, upper), *ends]

    def yaw_candidates(self, q: FloatArray, rotation: FloatArray) -> list[FloatArray]:
        """Candidates for a free theta_0, one of them the best.

        cos(error / 2) is bilinear in the half angles of theta_0 and theta_3. Its one
        maximum has the wrist axis at the target's azimuth. If that is beyond a limit,
        one of the two joints is at a limit.

        Args:
            q: (N, 4, 4) [rad].
            rotation: Of the targets, (N, 3, 3).

        Returns:
            Values of theta_0, (N, 4) each.
        """
        lower = self.shape.lower[0]
        upper = self.shape.upper[0]

        turns = [self._turn_to_azimuth(q, rotation)]
        for wrist in (self.shape.lower[3], self.shape.upper[3]):
            turns.append(self._turn_with_wrist_at(wrist, q, rotation))

        candidates = []
        for turn in turns:
            wanted = wrap(q[..., 0] + turn, self.shape.middle[0])
            candidates.append(np.clip(wanted, lower, upper))
        for end in (lower, upper):
            candidates.append(np.full(q.shape[:-1], end))
        return candidates

    def _turn_to_azimuth(self, q: FloatArray, rotation: FloatArray) -> FloatArray:
        """Turns of theta_0 that put the wrist axis at the target's azimuth, (N, 4)."""
        wanted = rotation @ self.wrist_axis
        present = self.rotation(q) @ self.wrist_axis
        azimuth = np.arctan2(wanted[:, 1], wanted[:, 0])[:, None]
        turn: FloatArray = azimuth - np.arctan2(present[..., 1], present[..., 0])
        return turn

    def _turn_with_wrist_at(
        self, wrist: float, q: FloatArray, rotation: FloatArray
    ) -> FloatArray:
        """Turns about z that come closest to the target at a given theta_3, (N, 4)."""
        with_wrist = q.copy()
        with_wrist[..., 3] = wrist
        inverse = np.swapaxes(self.rotation(with_wrist), -1, -2)
        return _turn_about_z(rotation[:, None] @ inverse)


def _turn_about_z(rotation: FloatArray) -> FloatArray:
    """The turns about z that come closest to rotations (..., 3, 3), (...) [rad]."""
    sine = rotation[..., 1, 0] - rotation[..., 0, 1]
    cosine = rotation[..., 0, 0] + rotation[..., 1, 1]
    return np.asarray(np.arctan2(sine, cosine))
