"""The mount of an arm: where base_link is fixed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from alpha5_model._support.checks import FloatArray, array, frozen, is_rotation
from alpha5_model.errors import InputError
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.names import plain_name


@dataclass(frozen=True, eq=False)
class Mount:
    """Pose of base_link in the frame that carries the arm. Arrays are read-only.

    Attributes:
        parent: Name of that frame, for example ``world`` or the vehicle's ``base``.
        position: Origin of base_link, (3,) [m].
        rotation: Axes of base_link, as columns, (3, 3).

    Raises:
        InputError: Not a plain name, a position and a rotation matrix.

    Warns:
        ImplausibleWarning: A position that seems to be in mm.
    """

    parent: str
    position: FloatArray
    rotation: FloatArray

    def __post_init__(self) -> None:
        plain_name("mount.parent", self.parent)
        position = frozen(array("mount.position", self.position, 3))
        rotation = frozen(array("mount.rotation", self.rotation, 3, 3))
        if not is_rotation(rotation):
            expected = "a rotation matrix, (3, 3)"
            raise InputError("mount.rotation", rotation.tolist(), expected)
        farthest = position[np.abs(position).argmax()]
        plausibility.check("mount.position", farthest, plausibility.VEHICLE_POSITION)
        object.__setattr__(self, "position", position)
        object.__setattr__(self, "rotation", rotation)
