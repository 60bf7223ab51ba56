"""The joints and links of the arm as CasADi expressions: from one frame to the next."""

from __future__ import annotations

import math
from typing import NamedTuple

import casadi
from casadi import SX, horzcat, vertcat, vertsplit

from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Alpha5Parameters


class Turn(NamedTuple):
    """The step from a frame to the next link.

    It goes along x and z of the frame, turns about x by a multiple of pi/2 (the twist),
    then about z (the joint).

    Attributes:
        origin: Of the link in the frame before, (3, 1).
        cosine, sine: Of the angle about z.
        twist_cosine, twist_sine: Of the angle about x.
    """

    origin: SX
    cosine: SX
    sine: SX
    twist_cosine: int
    twist_sine: int

    def outward(self, vector: SX) -> SX:
        """A vector of the frame before in the axes of the link."""
        x, y, z = vertsplit(vector)
        twisted_y = self.twist_cosine * y + self.twist_sine * z
        twisted_z = self.twist_cosine * z - self.twist_sine * y
        return vertcat(
            self.cosine * x + self.sine * twisted_y,
            self.cosine * twisted_y - self.sine * x,
            twisted_z,
        )

    def inward(self, vector: SX) -> SX:
        """A vector of the link in the axes of the frame before."""
        x, y, z = vertsplit(vector)
        turned_x = self.cosine * x - self.sine * y
        turned_y = self.sine * x + self.cosine * y
        return vertcat(
            turned_x,
            self.twist_cosine * turned_y - self.twist_sine * z,
            self.twist_sine * turned_y + self.twist_cosine * z,
        )

    def pose(self) -> SX:
        """Pose of the link in the frame before, (4, 4)."""
        axes = [self.inward(axis) for axis in casadi.horzsplit(SX.eye(3))]
        last_row = SX([[0.0, 0.0, 0.0, 1.0]])
        return vertcat(horzcat(*axes, self.origin), last_row)


def turns(q: SX, parameters: Alpha5Parameters) -> list[Turn]:
    """The five steps from base to link 1, from each link to the next, and to the tcp.

    Args:
        q: (4, 1).
        parameters: The arm's parameters; only its dimensions are used.

    Raises:
        InputError: The arm has another tool than Table 1's.
    """
    if parameters.tool is not None:
        expected = "the tool point of Table 1, for which equations are generated"
        raise InputError("tool", parameters.tool.position, expected)
    angles = [(casadi.cos(angle), casadi.sin(angle)) for angle in vertsplit(q)]
    angles.append((SX(1.0), SX(0.0)))  # the tcp does not turn

    steps = []
    origin = [0.0, 0.0, 0.0]
    twist = 0.0
    for row, (cosine, sine) in zip(parameters.dh, angles, strict=True):
        # From cos(q) and sin(q), as q + offset would round large angles.
        offset_cosine = _exact(math.cos(row.theta_offset))
        offset_sine = _exact(math.sin(row.theta_offset))
        step = Turn(
            origin=SX(origin),
            cosine=offset_cosine * cosine - offset_sine * sine,
            sine=offset_sine * cosine + offset_cosine * sine,
            twist_cosine=round(math.cos(twist)),
            twist_sine=round(math.sin(twist)),
        )
        steps.append(step)

        origin = [row.a, 0.0, row.d]
        twist = row.alpha
    return steps


def _exact(value: float) -> float:
    """A sine or cosine, exact for multiples of pi/2."""
    nearest = float(round(value))
    return nearest if abs(value - nearest) < 1e-15 else value


def link_poses(q: SX, parameters: Alpha5Parameters) -> list[SX]:
    """Poses in base_link of link 1 to link 4 and of the tcp, (4, 4) each."""
    poses = []
    pose = SX.eye(4)
    for step in turns(q, parameters):
        pose = pose @ step.pose()
        poses.append(pose)
    return poses
