"""The numbers that moving water adds to the base parameters: added mass and drag.

A rigid body can have the part ``[[m 1, -[h]x], [[h]x, I]]`` of an added mass. This part
acts as such a body would, but has no weight: it joins the base parameters. The rest is
``[[B, C], [C, 0]]``, both symmetric, B without its last entry. A multiple of
diag(1, 1, 0) in B or C turns with the joint and is handed down to the link before, as
the moments of bodies are (`alpha5_model.codegen.regrouping`), so that B_yy = 0 and
C_zz = C_xx + C_yy. B, C and the strips are numbers of their own.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import cross_matrix
from alpha5_model.codegen.regrouping import (
    MOVING_LINKS,
    SECOND,
    inwards,
    regrouped,
)
from alpha5_model.numbers.hydrodynamics import DragStrip, gauss_count
from alpha5_model.numbers.parameters import Alpha5Parameters


class StripKind(NamedTuple):
    """A strip that the formulas know.

    Attributes:
        link: The link that carries it, 1 to 4.
        axis: The axis of that link that it runs along, 0 to 2.
        points: Number of Gauss's points on it.
    """

    link: int
    axis: int
    points: int


STRIPS = (
    StripKind(link=1, axis=2, points=4),
    StripKind(link=2, axis=0, points=6),
    StripKind(link=3, axis=1, points=4),
    StripKind(link=4, axis=2, points=6),
    StripKind(link=4, axis=2, points=4),
)

#: Entries of B, by name; C has those of second moments.
_ENTRIES_OF_B = {"xx": (0, 0), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}
#: Numbers of a strip -> unit: its middle, half its length, drag across and along.
_STRIP_UNITS = {
    "x": "m",
    "y": "m",
    "z": "m",
    "half": "m",
    "across": "N s^2/m^2",
    "along": "N s^2/m^2",
}


def _units() -> dict[str, str]:
    """`WATER_PARAMETERS`."""
    units = {}
    for link in MOVING_LINKS:
        for name in _ENTRIES_OF_B:
            units[f"link_{link}.b{name}"] = "kg"
    for link in MOVING_LINKS:
        for name in SECOND:
            units[f"link_{link}.c{name}"] = "kg m"
    for place in range(len(STRIPS)):
        for name, unit in _STRIP_UNITS.items():
            units[f"strip_{place}.{name}"] = unit
    return units


#: Name -> unit, in order: B of each link, C of each link, then the strips.
WATER_PARAMETERS = _units()


def water_parameters(
    added_mass: FloatArray,
    strips: Sequence[Sequence[DragStrip]],
    density: float,
    parameters: Alpha5Parameters,
) -> tuple[FloatArray, FloatArray] | None:
    """What moving water adds to the base parameters, and the `WATER_PARAMETERS`.

    Args:
        added_mass: Of link 1 to link 4, about their origins, in this water, (4, 6, 6).
        strips: Of each of these links, in its axes.
        density: Of the water [kg/m^3].
        parameters: The arm's parameters; only its dimensions are used.

    Returns:
        What is added to the base parameters, (41,), and the values of
        `WATER_PARAMETERS`, (60,). None if a link has other strips than `STRIPS`.
    """
    drag = _values_of_strips(strips, density)
    if drag is None:
        return None

    values = dict.fromkeys(WATER_PARAMETERS, 0.0) | drag
    rigid_parts: list[FloatArray] = []
    handed_down = np.zeros((6, 6))
    for link, to_link_before in inwards(parameters):
        total = added_mass[link - 1] + handed_down
        turning = _turning_with_the_joint(total)
        own = total - turning

        rigid_parts.insert(0, _rigid_part(own))
        values |= _values_of_link(link, own)
        handed_down = _in_link_before(turning, to_link_before)

    of_links = [np.zeros((4, 4)), *rigid_parts]
    weightless = [np.stack([part, np.zeros_like(part)]) for part in of_links]
    added = regrouped(weightless, np.zeros(3), parameters)
    return added, np.array([values[name] for name in WATER_PARAMETERS])


def _turning_with_the_joint(added_mass: FloatArray) -> FloatArray:
    """The multiples of diag(1, 1, 0) in the blocks B and C, (6, 6)."""
    of_b = added_mass[1, 1] - added_mass[2, 2]
    of_c = (added_mass[0, 3] + added_mass[1, 4] - added_mass[2, 5]) / 2
    return np.kron([[of_b, of_c], [of_c, 0.0]], np.diag([1.0, 1.0, 0.0]))


def _rigid_part(added_mass: FloatArray) -> FloatArray:
    """The moments (4, 4) of the rigid body in an added mass (6, 6)."""
    coupling = added_mass[:3, 3:]
    inertia = added_mass[3:, 3:]
    first_moments = (coupling.T - coupling) / 2  # [h]x
    mass = added_mass[2, 2]

    h = [[first_moments[2, 1]], [first_moments[0, 2]], [first_moments[1, 0]]]
    second_moments = np.trace(inertia) / 2 * np.eye(3) - inertia
    return np.block([[second_moments, np.array(h)], [np.transpose(h), mass]])


def _values_of_link(link: int, added_mass: FloatArray) -> dict[str, float]:
    """B and C of an added mass (6, 6), by their names in `WATER_PARAMETERS`."""
    coupling = added_mass[:3, 3:]
    b = added_mass[:3, :3] - added_mass[2, 2] * np.eye(3)
    c = (coupling + coupling.T) / 2

    values = {}
    for name, at in _ENTRIES_OF_B.items():
        values[f"link_{link}.b{name}"] = b[at]
    for name, at in SECOND.items():
        values[f"link_{link}.c{name}"] = c[at]
    return values


def _in_link_before(added_mass: FloatArray, to_link_before: FloatArray) -> FloatArray:
    """An added mass (6, 6) of a link in the frame of the link before.

    Args:
        added_mass: In the link.
        to_link_before: Pose (4, 4) of the link in the link before.
    """
    back = np.linalg.inv(to_link_before)
    rotation = back[:3, :3]
    twist = np.kron(np.eye(2), rotation)
    twist[:3, 3:] = cross_matrix(back[:3, 3]) @ rotation
    return np.asarray(twist.T @ added_mass @ twist)


def _values_of_strips(
    strips: Sequence[Sequence[DragStrip]], density: float
) -> dict[str, float] | None:
    """Numbers of the strips, by their names; None if one is not in `STRIPS`."""
    free = dict(enumerate(STRIPS))
    values: dict[str, float] = {}
    for link in (4, 3, 2, 1):
        for strip in strips[link - 1]:
            kind = _kind(link, strip)
            places = [place for place, known in free.items() if known == kind]
            if not places:
                return None

            place = places[0]
            del free[place]
            values |= _values_of_strip(place, strip, density)
    return values


def _half_lengths(strip: DragStrip) -> FloatArray:
    """Half of what the strip runs along each axis, (3,)."""
    return np.asarray(np.abs(strip.end - strip.start) / 2)


def _kind(link: int, strip: DragStrip) -> StripKind | None:
    """The kind of a strip of a link; None if it does not run along an axis."""
    half_lengths = _half_lengths(strip)
    if np.count_nonzero(half_lengths) > 1:
        return None
    return StripKind(
        link=link, axis=int(half_lengths.argmax()), points=gauss_count(strip)
    )


def _values_of_strip(place: int, strip: DragStrip, density: float) -> dict[str, float]:
    """Numbers of one strip, by their names in `WATER_PARAMETERS`."""
    x, y, z = (strip.start + strip.end) / 2
    half = _half_lengths(strip).max()
    face = density * strip.diameter * half
    return {
        f"strip_{place}.x": x,
        f"strip_{place}.y": y,
        f"strip_{place}.z": z,
        f"strip_{place}.half": half,
        f"strip_{place}.across": strip.across * face,
        f"strip_{place}.along": strip.along * face,
    }
