"""The orientation of the hand, which theta_3 and a free theta_0 can change.

The rotation from the hand to a target is split into a twist about the wrist axis and a
swing of that axis (swing-twist decomposition, [Dobrowolski2015]). theta_3 can make the
twist. The swing remains: the angle between the wrist axis and its target.

References:
    [Dobrowolski2015] Swing-twist decomposition in Clifford algebra, arXiv:1506.05481.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import cross_matrix, wrap
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.theory.dh.chain import DHChain


class Hand(NamedTuple):
    """The hand at the end of an arm.

    Attributes:
        chain: The arm.
        geometry: Its lengths, zeros and limits.
        wrist_axis: Direction of joint 3's axis in the axes of the tcp, (3,), the same
            for every joint position.
    """

    chain: DHChain
    geometry: Geometry
    wrist_axis: FloatArray

    @classmethod
    def of(cls, record: Alpha5Parameters) -> Hand:
        """The hand of the arm that a record describes, made once.

        Raises:
            InputError: Not a vertical plane with two links in it.
        """
        return _hand(record)

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
        wanted = wrap(np.arctan2(sine, cosine), self.geometry.middle[3])
        turned[..., 3] = self._within(3, wanted)

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
        tool = np.array(self.geometry.tool)[:, :3]
        turned = rotation @ tool.T @ np.diag([1.0, -1.0, -1.0])
        psi = np.arctan2(turned[..., 2, 1], turned[..., 2, 0])
        return np.asarray(psi - self.geometry.wrist_offset)

    def yaws_with_wrist(self, q: FloatArray, rotation: FloatArray) -> list[FloatArray]:
        """Candidates for a free theta_0 at the theta_3 of q, one of them the best.

        Args:
            q: (..., 4) [rad].
            rotation: Of the targets, broadcasts to (..., 3, 3).

        Returns:
            Values of theta_0, (...) each.
        """
        return self._yaws(q, [self._turn_about_z(q, rotation)])

    def yaws(self, q: FloatArray, rotation: FloatArray) -> list[FloatArray]:
        """Candidates for a free theta_0 if theta_3 is free, too, one of them the best.

        cos(error / 2) is bilinear in the half angles of theta_0 and theta_3. Its one
        maximum has the wrist axis at the target's azimuth. If that is beyond a limit,
        one of the two joints is at a limit.

        Args:
            q: (N, 4, 4) [rad].
            rotation: Of the targets, (N, 3, 3).

        Returns:
            Values of theta_0, (N, 4) each.
        """
        wanted = rotation @ self.wrist_axis
        present = self.rotation(q) @ self.wrist_axis
        azimuth = np.arctan2(wanted[:, 1], wanted[:, 0])[:, None]
        turns = [azimuth - np.arctan2(present[..., 1], present[..., 0])]
        for wrist in (self.geometry.lower[3], self.geometry.upper[3]):
            at_limit = q.copy()
            at_limit[..., 3] = wrist
            turns.append(self._turn_about_z(at_limit, rotation[:, None]))
        return self._yaws(q, turns)

    def _yaws(self, q: FloatArray, turns: list[FloatArray]) -> list[FloatArray]:
        """theta_0 of q (..., 4) after turns (...), within its limits, and both ends."""
        candidates = []
        for turn in turns:
            wanted = wrap(q[..., 0] + turn, self.geometry.middle[0])
            candidates.append(self._within(0, wanted))
        for end in (self.geometry.lower[0], self.geometry.upper[0]):
            candidates.append(np.full(q.shape[:-1], end))
        return candidates

    def _turn_about_z(self, q: FloatArray, rotation: FloatArray) -> FloatArray:
        """The turns about z that bring the hand closest to targets, (...) [rad]."""
        needed = rotation @ np.swapaxes(self.rotation(q), -1, -2)
        sine = needed[..., 1, 0] - needed[..., 0, 1]
        cosine = needed[..., 0, 0] + needed[..., 1, 1]
        return np.asarray(np.arctan2(sine, cosine))

    def _within(self, joint: int, angle: FloatArray) -> FloatArray:
        """An angle within the limits of a joint."""
        return np.clip(angle, self.geometry.lower[joint], self.geometry.upper[joint])


@lru_cache(maxsize=64)
def _hand(record: Alpha5Parameters) -> Hand:
    chain = DHChain.alpha5(arm=record)
    _, axes = chain.joint_axes(chain.home)
    rotation = chain.forward_kinematics(chain.home)[:3, :3]
    return Hand(
        chain=chain, geometry=Geometry.of(record), wrist_axis=rotation.T @ axes[3]
    )
