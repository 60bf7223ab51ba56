"""The joints and links of the arm as CasADi expressions: from one frame to the next."""

from __future__ import annotations

from typing import NamedTuple

import casadi
from casadi import SX, horzcat, vertcat, vertsplit

from alpha5_model.codegen.dimensions import Dimensions, QuarterTurns


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


def turns(q: SX, dimensions: Dimensions) -> list[Turn]:
    """The four steps from base to link 1, and from each link to the next.

    Args:
        q: (4, 1).
        dimensions: Of the arm.
    """
    no_twist = QuarterTurns(cosine=1, sine=0)
    twists = (no_twist, *dimensions.twists)
    offsets = zip(dimensions.cosines, dimensions.sines, strict=True)
    steps = []
    for angle, offset, origin, twist in zip(
        vertsplit(q), offsets, dimensions.origins, twists, strict=True
    ):
        # From cos(q) and sin(q), as q + offset would round large angles.
        cosine = casadi.cos(angle)
        sine = casadi.sin(angle)
        offset_cosine, offset_sine = offset
        step = Turn(
            origin=vertcat(*origin),
            cosine=offset_cosine * cosine - offset_sine * sine,
            sine=offset_sine * cosine + offset_cosine * sine,
            twist_cosine=twist.cosine,
            twist_sine=twist.sine,
        )
        steps.append(step)
    return steps


def link_poses(q: SX, dimensions: Dimensions) -> list[SX]:
    """Poses in base_link of link 1 to link 4 and of the tcp, (4, 4) each."""
    poses = []
    pose = SX.eye(4)
    for step in turns(q, dimensions):
        pose = pose @ step.pose()
        poses.append(pose)
    return [*poses, pose @ tool_pose(dimensions)]


def tool_pose(dimensions: Dimensions) -> SX:
    """Pose of the tcp in link_4, (4, 4)."""
    tool = dimensions.tool
    rows = [horzcat(*tool[start : start + 4]) for start in (0, 4, 8)]
    return vertcat(*rows, SX([[0.0, 0.0, 0.0, 1.0]]))
