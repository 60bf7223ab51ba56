"""Poses of frames: of the mount, of the tool point, of attached bodies."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray, array, fill, frozen, is_rotation
from alpha5_model._support.spatial import Triple, rpy_from_rotation, transform
from alpha5_model.errors import InputError

#: Difference of a moved tool point that is rounding [m].
_SAME_POINT = 1e-12


@dataclass(frozen=True, eq=False)
class Pose:
    """Pose of a frame in its parent frame. Arrays are read-only.

    Attributes:
        position: Origin of the frame in the parent, (3,) [m].
        rotation: Axes of the frame in the parent, as columns, (3, 3).
        parent: Name of the parent, for example ``link_4``, or ``world``; empty if it
            goes without saying.

    Raises:
        InputError: Not a position and a rotation matrix.
    """

    position: FloatArray
    rotation: FloatArray
    parent: str = ""

    def __post_init__(self) -> None:
        position = frozen(array("position", self.position, 3))
        rotation = frozen(array("rotation", self.rotation, 3, 3))
        if not is_rotation(rotation):
            expected = "a rotation matrix, (3, 3)"
            raise InputError("rotation", rotation.tolist(), expected)
        fill(self, position=position, rotation=rotation)

    @property
    def matrix(self) -> FloatArray:
        """Maps coordinates in the frame to coordinates in the parent, (4, 4)."""
        return transform(self.rotation, self.position)

    @property
    def rpy(self) -> Triple:
        """URDF's fixed-axis roll, pitch, yaw [rad]."""
        return rpy_from_rotation(self.rotation)


def tool_of(record: Any) -> Pose:
    """The pose of the tcp in link_4, whose jaws are along -z.

    Args:
        record: An `Alpha5Parameters`. If it has no tool of its own, Table 1's is
            returned.
    """
    tool: Pose = record.tool or printed_tool(record.dh[3], record.dh[4])
    return tool


def has_own_tool_point(record: Any) -> bool:
    """Whether the tool point is not Table 1's, moved by the spacers if there are some.

    Args:
        record: An `Alpha5Parameters`.
    """
    if record.tool is None:
        return False
    moved = printed_tool(record.dh[3], record.dh[4]).position
    moved = moved - [0.0, 0.0, record.spacer]
    return bool(np.abs(record.tool.position - moved).max() > _SAME_POINT)


def printed_tool(wrist: Any, last: Any) -> Pose:
    """Table 1's tool point in link_4: ``Tz(d) Tx(a) Rx(alpha) Rz(theta)``.

    Args:
        wrist: The row of axis_b, a record of `DHParameters`.
        last: The fixed last row, a rotation about z.
    """
    about_x = _quarter_turns(wrist.alpha)
    about_z = _quarter_turns(last.theta_offset)
    rotation = np.array(
        [
            [about_z[0], -about_z[1], 0.0],
            [about_x[0] * about_z[1], about_x[0] * about_z[0], -about_x[1]],
            [about_x[1] * about_z[1], about_x[1] * about_z[0], about_x[0]],
        ]
    )
    # Adding zero turns negative zeros into zeros.
    position = np.array([wrist.a, 0.0, wrist.d])
    return Pose(position=position, rotation=rotation + 0.0)


def _quarter_turns(angle: float) -> tuple[float, float]:
    """Cosine and sine of an angle, exact at multiples of a quarter turn."""
    quarters = angle / (math.pi / 2)
    if quarters == round(quarters):
        exact = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))
        return exact[round(quarters) % 4]
    return math.cos(angle), math.sin(angle)
