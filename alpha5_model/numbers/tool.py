"""The tool point of an arm: where the tcp is in link_4."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray, array, frozen, is_rotation
from alpha5_model.errors import InputError
from alpha5_model.numbers import plausibility


@dataclass(frozen=True, eq=False)
class ToolPose:
    """Pose of the tcp in link_4, whose z axis is the wrist axis.

    The jaws are along -z. Table 1's tool point is ``(0, 0, -0.18)``. Arrays are
    read-only.

    Attributes:
        position: Origin of the tcp, (3,) [m].
        rotation: Axes of the tcp, as columns, (3, 3).

    Raises:
        InputError: Not a position and a rotation matrix.

    Warns:
        ImplausibleWarning: A position that seems to be in mm.
    """

    position: FloatArray
    rotation: FloatArray

    def __post_init__(self) -> None:
        position = frozen(array("tool.position", self.position, 3))
        rotation = frozen(array("tool.rotation", self.rotation, 3, 3))
        if not is_rotation(rotation):
            expected = "a rotation matrix, (3, 3)"
            raise InputError("tool.rotation", rotation.tolist(), expected)
        farthest = position[np.abs(position).argmax()]
        plausibility.check("tool.position", farthest, plausibility.POSITION)
        object.__setattr__(self, "position", position)
        object.__setattr__(self, "rotation", rotation)


def tool_of(record: Any) -> ToolPose:
    """The tool of an arm: its own, or Table 1's.

    Args:
        record: An `Alpha5Parameters`.
    """
    tool: ToolPose = record.tool or printed_tool(record.dh[3], record.dh[4])
    return tool


def printed_tool(wrist: Any, last: Any) -> ToolPose:
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
    return ToolPose(position=np.array([wrist.a, 0.0, wrist.d]), rotation=rotation + 0.0)


def _quarter_turns(angle: float) -> tuple[float, float]:
    """Cosine and sine of an angle, exact at multiples of a quarter turn."""
    quarters = angle / (math.pi / 2)
    if quarters == round(quarters):
        exact = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))
        return exact[round(quarters) % 4]
    return math.cos(angle), math.sin(angle)
