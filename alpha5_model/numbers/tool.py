"""The tool point of an arm: where the tcp is in link_4."""

from __future__ import annotations

from dataclasses import dataclass

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
