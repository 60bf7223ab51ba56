"""The fewest numbers that fix the torques and the load on the mount of the arm on a fixed base.

What lies on the axis of a joint moves with the link before just as well: a body's mass m, its moment m c_z and
its second moment along the axis are handed down to that link [Khalil2002]. Of each moving link two first
moments and the other second moments are left; link_0, which does not move, has only weight. In a fluid the
weight is less by that of the displaced fluid: net mass and moments, ``m - rho V`` and ``m c - rho V b``, are
numbers of their own, handed down in the same way.

In moving water, the part of an added mass that a rigid body can have, ``[[m 1, -[h]x], [[h]x, I]]``, acts as one
would, but has no weight: it joins the base parameters. What is left are ``[[B, C], [C, 0]]``, both symmetric, B
without its last entry; they and the strips are numbers of their own.

References:
    [Khalil2002] Khalil, Dombre: Modeling, Identification and Control of Robots, section 9.4.
    [Wensing2018] Wensing, Kim, Slotine: Linear matrix inequalities for physically consistent inertial
        parameter identification, IEEE RA-L 3(1) (a body's numbers in one matrix).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray
from alpha5_model.fluids import GRAVITY, SEA_WATER
from alpha5_model.hydrodynamics import DragStrip
from alpha5_model.parameters import RigidBody, parameters
from alpha5_model.spatial import pose

_SECOND = {"xx": (0, 0), "yy": (1, 1), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}
_FIRST = ("hx", "hy", "nx", "ny")
#: Name -> unit, in order. In the axes of each link, with what the links beyond hand down: ``xx`` to ``yz`` are
#: second moments, sums of ``m x x`` to ``m y z``; ``hx``, ``hy`` first moments; ``n``, ``nx`` to ``nz`` the net mass
#: and its first moments. Link 1 turns about its z only: there ``izz = xx + yy`` is all that counts of the two.
BASE_PARAMETERS: dict[str, str] = {
    "link_0.n": "kg",
    **{f"link_0.n{axis}": "kg m" for axis in "xyz"},
    **{
        f"link_{i}.{name}": unit
        for i in (1, 2, 3, 4)
        for names, unit in (
            (("izz", "xz", "yz") if i == 1 else tuple(_SECOND), "kg m^2"),
            (_FIRST, "kg m"),
        )
        for name in names
    },
    **{f"gravity.{axis}": "m/s^2" for axis in "xyz"},
}

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


def base_parameters(
    links: Sequence[RigidBody], fluid_density: float = SEA_WATER, gravity: ArrayLike = GRAVITY
) -> FloatArray:
    """Values of `BASE_PARAMETERS`.

    Args:
        links: link_0, in the axes of base_link, to link_4, each with all that is fixed to it;
            ``parameters().links`` for the bare arm.
        fluid_density: [kg/m^3].
        gravity: In base_link, (3,) [m/s^2].

    Returns:
        (41,).
    """
    bodies = [
        np.array(moments(x.mass, x.com, x.inertia, x.volume, x.cob, fluid_density)) for x in links
    ]
    return regrouped(bodies, gravity)


def regrouped(moments: Sequence[FloatArray] | FloatArray, gravity: ArrayLike) -> FloatArray:
    """Values of `BASE_PARAMETERS`, linear in what each link has of mass and net mass, (2, 4, 4) each."""
    values = dict(zip((f"gravity.{axis}" for axis in "xyz"), np.asarray(gravity), strict=True))
    rows, handed = parameters().dh, np.zeros((2, 4, 4))
    for i in (4, 3, 2, 1, 0):
        mass, net = left = handed + moments[i]
        values |= {f"link_{i}.n": net[3, 3], f"link_{i}.izz": mass[0, 0] + mass[1, 1]}
        values |= {f"link_{i}.{name}": mass[at] for name, at in _SECOND.items()}
        for k, axis in enumerate("xyz"):
            values |= {f"link_{i}.h{axis}": mass[k, 3], f"link_{i}.n{axis}": net[k, 3]}
        left[:, :2], left[:, :, :2] = 0.0, 0.0
        if i > 1:
            row = rows[i - 2]
            before = pose((row.a, 0.0, row.d), (row.alpha, 0.0, 0.0))
            left = before @ left @ before.T
        handed = left
    return np.array([values[name] for name in BASE_PARAMETERS])


def moments(*body: Any, stack: Any = np.append) -> tuple[Any, Any]:
    """Mass, first and second moments of a body and of its net mass in one matrix each, (4, 4).

    They are P; with T the body's pose in another frame they are ``T P T^T`` there.

    Args:
        body: Mass, COM, inertia, volume, COB, and density of the fluid, NumPy's or CasADi's.
        stack: Puts one number below others.
    """
    mass, com, inertia, volume, cob, density = body
    centre, centroid = stack(com, 1.0).reshape((4, 1)), stack(cob, 1.0).reshape((4, 1))
    total = mass * (centre @ centre.T)
    net = total - density * volume * (centroid @ centroid.T)
    total[:3, :3] += (inertia[0, 0] + inertia[1, 1] + inertia[2, 2]) / 2 * np.eye(3) - inertia
    return total, net


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
    rigid_parts, values = np.zeros((5, 2, 4, 4)), dict.fromkeys(WATER_PARAMETERS, 0.0)
    free = dict(enumerate(STRIPS))
    for link, (matrix, own) in enumerate(zip(added_mass, strips, strict=True), 1):
        heavy, coupling, inertia = matrix[:3, :3], matrix[:3, 3:], matrix[3:, 3:]
        mass, turned = heavy[2, 2], (coupling.T - coupling) / 2  # [h]x
        rigid = rigid_parts[link, 0]
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
    return regrouped(rigid_parts, np.zeros(3)), np.array([*values.values()])
