"""The inertials that another model writes, and how many digits they have."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers.inertia import combine
from alpha5_model.proofs.comparison.poses import carried_to, origin_of, rotation_of
from alpha5_model.proofs.comparison.printed_digits import last_place

#: How closely a hypothesis must match a number: half of its last digit, but at least
#: the first and at most the second of these.
MASS_DIGITS = (5e-5, 5e-4)  # [kg]
COM_DIGITS = (1e-4, 5e-4)  # [m]
INERTIA_DIGITS = (1e-3, 1e-2)  # of the largest entry
#: A link frame this close to ours was meant to be ours; the rest is an error of the
#: geometry.
SAME_FRAME = (0.002, 0.02)  # [m], [rad]
#: A lighter link is a dummy: some tools ask for a mass on every link.
TOKEN_MASS = 1e-3  # [kg]


@dataclass(frozen=True, eq=False)
class Inertial:
    """The inertial of one link of the other model, or of several links together.

    Attributes:
        link: Its name; empty for several links.
        mass: [kg].
        com: In its own frame, (3,) [m].
        inertia: At the COM, in its own axes, (3, 3) [kg m^2].
        pose: transform_link_to_ours, (4, 4).
    """

    link: str
    mass: float
    com: FloatArray
    inertia: FloatArray
    pose: FloatArray

    def in_our_frame(self) -> Inertial:
        """The same, in our link frame."""
        com, inertia = carried_to(self.pose, self.com, self.inertia)
        return replace(self, com=com, inertia=inertia, pose=np.eye(4))

    @property
    def meant_in_our_frame(self) -> bool:
        """Whether its frame was meant to be ours."""
        length, angle = SAME_FRAME
        near = np.linalg.norm(origin_of(self.pose)) < length
        aligned = np.trace(rotation_of(self.pose)) > 1 + 2 * np.cos(angle)
        return bool(near and aligned)

    @property
    def mass_digits(self) -> float:
        """How closely a hypothesis must match the mass [kg]."""
        return self._half_last_digit(MASS_DIGITS, self.mass)

    @property
    def com_digits(self) -> float:
        """How closely a hypothesis must match the COM [m]."""
        return self._half_last_digit(COM_DIGITS, *self.com)

    @property
    def inertia_digits(self) -> float:
        """How closely a hypothesis must match the tensor [kg m^2]."""
        low, high = np.array(INERTIA_DIGITS) * np.abs(self.inertia).max()
        return self._half_last_digit((low, high), *self.inertia.ravel())

    def _half_last_digit(self, limits: tuple[float, float], *numbers: float) -> float:
        """Half of the finest last place of the numbers, within the limits.

        For several links together it is the lower limit: their sum has no digits.
        """
        places = [last_place(repr(float(x))) for x in numbers if x]
        if not self.link or not places:
            return limits[0]
        return float(np.clip(0.5 * min(places), *limits))


def solid_links(written: Sequence[Inertial]) -> list[Inertial]:
    """The links that are not dummies."""
    return [link for link in written if abs(link.mass) > TOKEN_MASS]


def subjects(written: Sequence[Inertial]) -> list[Inertial]:
    """The inertials that a printed number may have been written for, dummies left out.

    Returns:
        The whole body and its heaviest link; only that link if it is the only one, or
        if all masses add up to zero; none if all links are dummies.
    """
    solid = solid_links(written)
    solid.sort(key=lambda link: -abs(link.mass))
    masses = [link.mass for link in solid]
    if len(solid) < 2 or sum(masses) == 0:
        return solid[:1]

    placed = [link.in_our_frame() for link in solid]
    mass, com, inertia = combine(
        masses,
        [link.com for link in placed],
        [link.inertia for link in placed],
    )
    whole = Inertial(link="", mass=mass, com=com, inertia=inertia, pose=np.eye(4))
    return [whole, solid[0]]
