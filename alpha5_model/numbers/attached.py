"""A body that is fixed to a link: a sensor, a camera, a payload."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from alpha5_model._support.checks import (
    FloatArray,
    array,
    choice,
    frozen,
    is_rotation,
    real,
)
from alpha5_model._support.spatial import moved, transform
from alpha5_model.errors import InputError
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.inertia import rotate_tensor
from alpha5_model.numbers.names import plain_name
from alpha5_model.numbers.rigid_body import RigidBody
from alpha5_model.numbers.tables import BODY_NAMES

#: The link with the jaws, the only one that a spacer lengthens.
_JAWS_LINK = "link_4"


@dataclass(frozen=True, eq=False)
class AttachedBody(RigidBody):
    """A body that is fixed to a link. Its inertia may be that of a point, zero.

    Attributes:
        link: Name of the link, ``link_0`` to ``link_4``.
        position: Origin of the body's frame in the link, (3,) [m].
        rotation: Axes of the body's frame in the link, as columns, (3, 3).
        spacer: On link_4: how far the body moves the jaws and the tool along -z, out
            towards the tip [m].

    Raises:
        InputError: Also not a plain name, a position and a rotation matrix, or a
            spacer below 0 or not on link_4.
        UnknownNameError: No such link.

    Warns:
        ImplausibleWarning: Also a position or spacer that seems to be in mm.
    """

    _may_be_a_point: ClassVar[bool] = True

    link: str
    position: FloatArray
    rotation: FloatArray
    spacer: float = 0.0

    def __post_init__(self) -> None:
        plain_name("attached.name", self.name)
        super().__post_init__()
        choice(f"link of {self.name}", self.link, BODY_NAMES)
        position = frozen(array(f"{self.name}.position", self.position, 3))
        rotation = frozen(array(f"{self.name}.rotation", self.rotation, 3, 3))
        spacer = real(f"{self.name}.spacer", self.spacer, minimum=0.0)
        if not is_rotation(rotation):
            expected = "a rotation matrix, (3, 3)"
            raise InputError(f"{self.name}.rotation", rotation.tolist(), expected)
        if spacer and self.link != _JAWS_LINK:
            expected = f"none on {self.link}: only {_JAWS_LINK} carries the jaws"
            raise InputError(f"{self.name}.spacer", spacer, expected)

        farthest = position[np.abs(position).argmax()]
        plausibility.check(f"{self.name}.position", farthest, plausibility.POSITION)
        plausibility.check(f"{self.name}.spacer", spacer, plausibility.JAW_LENGTH)
        object.__setattr__(self, "position", position)
        object.__setattr__(self, "rotation", rotation)
        object.__setattr__(self, "spacer", spacer)

    def in_link(self) -> AttachedBody:
        """The same body, its frame that of the link."""
        pose = transform(self.rotation, self.position)
        inertia = rotate_tensor(self.rotation, self.inertia)
        return replace(
            self,
            com=moved(pose, self.com),
            inertia=(inertia + inertia.T) / 2,
            cob=moved(pose, self.cob),
            position=np.zeros(3),
            rotation=np.eye(3),
        )
