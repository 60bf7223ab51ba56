"""The fewest numbers that fix the torques and the load on the mount of the arm on a fixed base.

What lies on the axis of a joint moves with the link before just as well: a body's mass m, its moment m c_z and
its second moment along the axis are handed down to that link [Khalil2002]. Of each moving link two first
moments and the other second moments are left; link_0, which does not move, has only weight. In a fluid the
weight is less by that of the displaced fluid: net mass and moments, ``m - rho V`` and ``m c - rho V b``, are
numbers of their own, handed down in the same way.

In moving water, the part of an added mass that a rigid body can have, ``[[m 1, -[h]x], [[h]x, I]]``, acts as one
would, but has no weight: it joins the base parameters. What is left are ``[[B, C], [C, 0]]``, both symmetric, B
without its last entry. Of both a multiple of diag(1, 1, 0) turns with the joint and is handed down, too, so that
B_yy = 0 and C_zz = C_xx + C_yy. They and the strips are numbers of their own.

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

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import cross_matrix, pose
from alpha5_model.numbers.fluids import GRAVITY, SEA_WATER
from alpha5_model.numbers.hydrodynamics import DragStrip, gauss_count
from alpha5_model.numbers.parameters import RigidBody, parameters

#: Entries of a symmetric matrix without zz.
SECOND = {"xx": (0, 0), "yy": (1, 1), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}
#: Name -> unit, in order. In the axes of each link, with what the links beyond hand down: ``xx`` to ``yz`` are
#: second moments, sums of ``m x x`` to ``m y z``; ``hx``, ``hy`` first moments; ``n``, ``nx`` to ``nz`` the net mass
#: and its first moments. Link 1 turns about its z only: there ``izz = xx + yy`` is all that counts of the two.
BASE_PARAMETERS = {"link_0.n": "kg"} | {f"link_0.n{axis}": "kg m" for axis in "xyz"}
for _i in (1, 2, 3, 4):
    _names = ("izz", "xz", "yz") if _i == 1 else tuple(SECOND)
    BASE_PARAMETERS |= {f"link_{_i}.{name}": "kg m^2" for name in _names}
    BASE_PARAMETERS |= {
        f"link_{_i}.{name}": "kg m" for name in ("hx", "hy", "nx", "ny")
    }
BASE_PARAMETERS |= {f"gravity.{axis}": "m/s^2" for axis in "xyz"}

#: Entries of B; C has those of second moments.
_B = {"xx": (0, 0), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}
#: The link that carries a strip, the axis of that link that it runs along, and Gauss's points on it.
STRIPS = ((1, 2, 4), (2, 0, 6), (3, 1, 4), (4, 2, 6), (4, 2, 4))
_STRIP = dict.fromkeys(("x", "y", "z", "half"), "m")
_STRIP |= dict.fromkeys(("across", "along"), "N s^2/m^2")
#: Name -> unit, in order: B and C of each link, then of each strip its middle, half its length, drag across and along.
WATER_PARAMETERS = {f"link_{i}.b{name}": "kg" for i in (1, 2, 3, 4) for name in _B}
WATER_PARAMETERS |= {
    f"link_{i}.c{name}": "kg m" for i in (1, 2, 3, 4) for name in SECOND
}
for _k in range(len(STRIPS)):
    WATER_PARAMETERS |= {f"strip_{_k}.{name}": unit for name, unit in _STRIP.items()}


def base_parameters(
    links: Sequence[RigidBody],
    fluid_density: float = SEA_WATER,
    gravity: ArrayLike = GRAVITY,
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
        moments(x.mass, x.com, x.inertia, x.volume, x.cob, fluid_density) for x in links
    ]
    return regrouped(np.array(bodies), gravity)


def regrouped(
    moments: Sequence[FloatArray] | FloatArray, gravity: ArrayLike
) -> FloatArray:
    """Values of `BASE_PARAMETERS`, linear in what each link has of mass and net mass, (2, 4, 4) each."""
    values = dict(
        zip((f"gravity.{axis}" for axis in "xyz"), np.asarray(gravity), strict=True)
    )
    rows, handed = parameters().dh, np.zeros((2, 4, 4))
    for i in (4, 3, 2, 1, 0):
        mass, net = left = handed + moments[i]
        values |= {f"link_{i}.n": net[3, 3], f"link_{i}.izz": mass[0, 0] + mass[1, 1]}
        values |= {f"link_{i}.{name}": mass[at] for name, at in SECOND.items()}
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
    total[:3, :3] += (inertia[0, 0] + inertia[1, 1] + inertia[2, 2]) / 2 * np.eye(
        3
    ) - inertia
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
    free, handed = dict(enumerate(STRIPS)), np.zeros((6, 6))
    for link in (4, 3, 2, 1):
        matrix = added_mass[link - 1] + handed
        of_b = matrix[1, 1] - matrix[2, 2]
        of_c = (matrix[0, 3] + matrix[1, 4] - matrix[2, 5]) / 2
        turning = np.kron([[of_b, of_c], [of_c, 0.0]], np.diag([1.0, 1.0, 0.0]))
        matrix = matrix - turning
        heavy, coupling, inertia = matrix[:3, :3], matrix[:3, 3:], matrix[3:, 3:]
        mass, turned = heavy[2, 2], (coupling.T - coupling) / 2  # [h]x
        rigid = rigid_parts[link, 0]
        rigid[:3, :3] = np.trace(inertia) / 2 * np.eye(3) - inertia
        rigid[:3, 3] = rigid[3, :3] = turned[2, 1], turned[0, 2], turned[1, 0]
        rigid[3, 3] = mass
        left, even = heavy - mass * np.eye(3), (coupling + coupling.T) / 2
        values |= {f"link_{link}.b{name}": left[at] for name, at in _B.items()}
        values |= {f"link_{link}.c{name}": even[at] for name, at in SECOND.items()}
        if link > 1:
            row = parameters().dh[link - 2]
            back = np.linalg.inv(pose((row.a, 0.0, row.d), (row.alpha, 0.0, 0.0)))
            twist = np.kron(np.eye(2), back[:3, :3])
            twist[:3, 3:] = cross_matrix(back[:3, 3]) @ back[:3, :3]
            handed = twist.T @ turning @ twist
        for strip in strips[link - 1]:
            ends = np.abs(strip.end - strip.start) / 2
            kind, half = (link, int(ends.argmax()), gauss_count(strip)), ends.max()
            place = next(
                (k for k, free_kind in free.items() if free_kind == kind), None
            )
            if place is None or np.count_nonzero(ends) > 1:
                return None
            del free[place]
            face = density * strip.diameter * half
            drag = half, strip.across * face, strip.along * face
            names = (f"strip_{place}.{name}" for name in _STRIP)
            values |= zip(names, (*(strip.start + strip.end) / 2, *drag), strict=True)
    return regrouped(rigid_parts, np.zeros(3)), np.array([*values.values()])
