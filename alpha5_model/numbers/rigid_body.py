"""A rigid body in the water, and one that is fixed to a link of the arm."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from alpha5_model._support.checks import (
    FloatArray,
    array,
    choice,
    fill,
    frozen,
    is_rotation,
    plain_name,
    real,
)
from alpha5_model.errors import InputError
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.inertia import check_possible, combine
from alpha5_model.numbers.pose import Pose
from alpha5_model.numbers.tables import BODY_NAMES

#: The link with the jaws, the only one that a spacer lengthens.
_JAWS_LINK = "link_4"


@dataclass(frozen=True, eq=False)
class RigidBody:
    """Mass and displaced water of one body, in its own frame.

    Attributes:
        name: As the link of the URDF.
        mass: [kg].
        com: Centre of mass, (3,) [m].
        inertia: At the COM, URDF sign, (3, 3) [kg m^2].
        volume: Displaced volume [m^3].
        cob: Centre of buoyancy, (3,) [m].

    Raises:
        InputError: A negative mass or volume, or an inertia that no body can have.

    Warns:
        ImplausibleWarning: Numbers that seem to be in another unit.
    """

    #: Whether a mass without any inertia, a point, is possible.
    _may_be_a_point: ClassVar[bool] = False

    name: str
    mass: float
    com: FloatArray
    inertia: FloatArray
    volume: float
    cob: FloatArray

    @property
    def _place(self) -> str:
        """What errors call the body, before the name of a field."""
        return self.name

    def __post_init__(self) -> None:
        mass = real(f"{self._place}.mass", self.mass, minimum=0.0)
        com = frozen(array(f"{self._place}.com", self.com, 3))
        inertia = frozen(array(f"{self._place}.inertia", self.inertia, 3, 3))
        volume = real(f"{self._place}.volume", self.volume, minimum=0.0)
        cob = frozen(array(f"{self._place}.cob", self.cob, 3))
        if not self._may_be_a_point or np.any(inertia):
            check_possible(f"{self._place}.inertia", mass, com, inertia)
        plausibility.check_body(mass, com, inertia, volume, cob, f"{self._place}.")
        fill(self, mass=mass, com=com, inertia=inertia, volume=volume, cob=cob)

    def at(self, pose: Pose) -> Self:
        """The same body in the parent of a frame, which is its own until now.

        Args:
            pose: Of its own frame in the parent.
        """
        inertia = pose.rotation @ self.inertia @ pose.rotation.T
        return replace(
            self,
            com=pose.rotation @ self.com + pose.position,
            inertia=(inertia + inertia.T) / 2,
            cob=pose.rotation @ self.cob + pose.position,
        )


def joined(name: str, bodies: Sequence[RigidBody]) -> RigidBody:
    """One body of several that are rigidly joined, all given in one frame.

    Args:
        name: Of the result.
        bodies: At least one, with a mass.

    Raises:
        InputError: Their masses add up to zero.
    """
    mass, com, inertia = combine(
        masses=[body.mass for body in bodies],
        coms=[body.com for body in bodies],
        inertias=[body.inertia for body in bodies],
    )

    volumes = np.array([body.volume for body in bodies])
    volume = float(volumes.sum())
    cob = com
    if volume:
        cob = volumes @ np.array([body.cob for body in bodies]) / volume
    return RigidBody(
        name=name,
        mass=mass,
        com=com,
        inertia=(inertia + inertia.T) / 2,
        volume=volume,
        cob=cob,
    )


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

    @property
    def _place(self) -> str:
        """Its key in an arm file, ``attached.sensor``; errors name it."""
        return f"attached.{self.name}"

    @property
    def pose(self) -> Pose:
        """Of the body's frame in the link."""
        return Pose(position=self.position, rotation=self.rotation, parent=self.link)

    def __post_init__(self) -> None:
        plain_name("attached.name", self.name)
        super().__post_init__()
        choice(f"{self._place}.link", self.link, BODY_NAMES)
        position = frozen(array(f"{self._place}.position", self.position, 3))
        rotation = frozen(array(f"{self._place}.rotation", self.rotation, 3, 3))
        spacer = real(f"{self._place}.spacer", self.spacer, minimum=0.0)
        if not is_rotation(rotation):
            expected = "a rotation matrix, (3, 3)"
            raise InputError(f"{self._place}.rotation", rotation.tolist(), expected)
        farthest = position[np.abs(position).argmax()]
        plausibility.check(f"{self._place}.position", farthest, plausibility.POSITION)
        plausibility.check(f"{self._place}.spacer", spacer, plausibility.JAW_LENGTH)
        if spacer and self.link != _JAWS_LINK:
            expected = f"none on {self.link}: only {_JAWS_LINK} carries the jaws"
            raise InputError(f"{self._place}.spacer", spacer, expected)
        fill(self, position=position, rotation=rotation, spacer=spacer)

    def in_link(self) -> AttachedBody:
        """The same body, its frame that of the link."""
        body = self.at(self.pose)
        return replace(body, position=np.zeros(3), rotation=np.eye(3))
