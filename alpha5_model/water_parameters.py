"""Moving water in the numbers that the generated formulas take: what is left of its added mass, and its strips.

The part of an added mass that a rigid body can have, ``[[m 1, -[h]x], [[h]x, I]]``, acts as one would, but has no
weight: it joins the base parameters. What is left are ``[[B, C], [C, 0]]``, both symmetric, B without its last entry.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from alpha5_model.base_parameters import regrouped
from alpha5_model.checks import FloatArray
from alpha5_model.hydrodynamics import DragStrip

_ENTRIES = {"xx": (0, 0), "xy": (0, 1), "xz": (0, 2), "yy": (1, 1), "yz": (1, 2), "zz": (2, 2)}
#: The link that carries a strip, and the axis of that link that it runs along.
STRIPS = ((1, 2), (2, 0), (3, 1), (4, 2), (4, 2))
#: Name -> unit, in order: B and C of each link, then of each strip its middle, half its length, drag across and along.
WATER_PARAMETERS: dict[str, str] = {
    **{f"link_{i}.b{name}": "kg" for i in (1, 2, 3, 4) for name in [*_ENTRIES][:5]},
    **{f"link_{i}.c{name}": "kg m" for i in (1, 2, 3, 4) for name in _ENTRIES},
    **{
        f"strip_{k}.{name}": unit
        for k in range(len(STRIPS))
        for name, unit in (
            *((name, "m") for name in ("x", "y", "z", "half")),
            *((name, "N s^2/m^2") for name in ("across", "along")),
        )
    },
}


def water_parameters(
    added_mass: FloatArray, strips: Sequence[Sequence[DragStrip]], density: float
) -> tuple[FloatArray, FloatArray] | None:
    """What moving water adds to the base parameters, (41,), and the values of `WATER_PARAMETERS`.

    Args:
        added_mass: Of link 1 to link 4, about their origins, in this water, (4, 6, 6).
        strips: Of each of these links, in its axes.
        density: Of the water [kg/m^3].

    Returns:
        None if a link has other strips than `STRIPS`.
    """
    moments, values = np.zeros((5, 2, 4, 4)), dict.fromkeys(WATER_PARAMETERS, 0.0)
    free = dict(enumerate(STRIPS))
    for link, (matrix, own) in enumerate(zip(added_mass, strips, strict=True), 1):
        heavy, coupling, inertia = matrix[:3, :3], matrix[:3, 3:], matrix[3:, 3:]
        mass, turned = heavy[2, 2], (coupling.T - coupling) / 2  # [h]x
        rigid = moments[link, 0]
        rigid[:3, :3] = np.trace(inertia) / 2 * np.eye(3) - inertia
        rigid[:3, 3] = rigid[3, :3] = turned[2, 1], turned[0, 2], turned[1, 0]
        rigid[3, 3] = mass
        left = {"b": heavy - mass * np.eye(3), "c": (coupling + coupling.T) / 2}
        for key in WATER_PARAMETERS:
            body, _, name = key.partition(".")
            if body == f"link_{link}":
                values[key] = left[name[0]][_ENTRIES[name[1:]]]
        for strip in own:
            half = np.abs(strip.end - strip.start) / 2
            kind = link, int(half.argmax())
            place = next((k for k, free_kind in free.items() if free_kind == kind), None)
            if place is None or np.count_nonzero(half) > 1:
                return None
            del free[place]
            face = density * strip.diameter * half.max()
            numbers = (
                *(strip.start + strip.end) / 2,
                half.max(),
                strip.across * face,
                strip.along * face,
            )
            names = [key for key in WATER_PARAMETERS if key.startswith(f"strip_{place}.")]
            values |= zip(names, numbers, strict=True)
    return regrouped(moments, np.zeros(3)), np.array([*values.values()])
