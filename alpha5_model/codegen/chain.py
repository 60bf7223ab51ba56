"""The joints and links of the arm as CasADi expressions: from one frame to the next."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import casadi
from casadi import SX, horzcat, vertcat, vertsplit

#: Cosine and sine of the twists before each link: every arm has them.
_TWISTS = ((1, 0), (0, 1), (-1, 0), (0, -1))
#: How many numbers the dimensions of an arm are.
DIMENSIONS = 24


class Dimensions(NamedTuple):
    """Where the joints and the tool of an arm are; numbers, or CasADi's symbols.

    Attributes:
        a_0, d_0: From joint 0 to joint 1 along x and z [m].
        a_1: From joint 1 to joint 2 along x [m].
        a_2: From joint 2 to joint 3 along x [m].
        cosines, sines: Of the constant parts of DH angles 0 to 3, 4 each.
        tool: Upper three rows of the tcp's pose in link_4, row by row, 12 [1 and m].
    """

    a_0: Any
    d_0: Any
    a_1: Any
    a_2: Any
    cosines: Sequence[Any]
    sines: Sequence[Any]
    tool: Sequence[Any]

    @classmethod
    def from_numbers(cls, numbers: Sequence[Any]) -> Dimensions:
        """The dimensions of a `Geometry`, (24,), or of symbols in their place."""
        a_0, d_0, a_1, a_2, *others = numbers
        return cls(
            a_0=a_0,
            d_0=d_0,
            a_1=a_1,
            a_2=a_2,
            cosines=others[:4],
            sines=others[4:8],
            tool=others[8:],
        )

    @property
    def origins(self) -> list[tuple[Any, Any, Any]]:
        """Origin of each link in the link before, of link 1 in base_link."""
        return [
            (0.0, 0.0, 0.0),
            (self.a_0, 0.0, self.d_0),
            (self.a_1, 0.0, 0.0),
            (self.a_2, 0.0, 0.0),
        ]


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
    offsets = zip(dimensions.cosines, dimensions.sines, strict=True)
    steps = []
    for angle, offset, origin, twist in zip(
        vertsplit(q), offsets, dimensions.origins, _TWISTS, strict=True
    ):
        # From cos(q) and sin(q), as q + offset would round large angles.
        cosine = casadi.cos(angle)
        sine = casadi.sin(angle)
        offset_cosine, offset_sine = offset
        twist_cosine, twist_sine = twist
        step = Turn(
            origin=vertcat(*origin),
            cosine=offset_cosine * cosine - offset_sine * sine,
            sine=offset_sine * cosine + offset_cosine * sine,
            twist_cosine=twist_cosine,
            twist_sine=twist_sine,
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
