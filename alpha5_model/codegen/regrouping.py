"""The fewest numbers that fix the joint torques of the arm and the load on its mount.

The arm is on a fixed base. A body's mass m, its moment m c_z and its second moment
along the axis of its joint act in the same way if they belong to the link before, so
they are handed down to that link [Khalil2002]. Each moving link keeps two first moments
and the other second moments. link_0, which does not move, has only weight. In a fluid,
the weight of the displaced fluid counts against that of the body: net mass and net
moments, ``m - rho V`` and ``m c - rho V b``, are numbers of their own and are handed
down in the same way.

References:
    [Khalil2002] Khalil, Dombre: Modeling, Identification and Control of Robots, section
        9.4.
    [Wensing2018] Wensing, Kim, Slotine: Linear matrix inequalities for physically
        consistent inertial parameter identification, IEEE RA-L 3(1) (a body's numbers
        in one matrix).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import pose
from alpha5_model.numbers.fluids import GRAVITY, SEA_WATER
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.rigid_body import RigidBody

MOVING_LINKS = (1, 2, 3, 4)
#: Entries of a symmetric matrix without zz, by name.
SECOND = {"xx": (0, 0), "yy": (1, 1), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}


def _units() -> dict[str, str]:
    """`BASE_PARAMETERS`."""
    units = {"link_0.n": "kg"}
    for axis in "xyz":
        units[f"link_0.n{axis}"] = "kg m"

    for link in MOVING_LINKS:
        # Link 1 turns about its z only: of xx and yy, only their sum counts.
        second_moments = ("izz", "xz", "yz") if link == 1 else tuple(SECOND)
        for name in second_moments:
            units[f"link_{link}.{name}"] = "kg m^2"
        for name in ("hx", "hy", "nx", "ny"):
            units[f"link_{link}.{name}"] = "kg m"

    for axis in "xyz":
        units[f"gravity.{axis}"] = "m/s^2"
    return units


#: Name -> unit, in order. All are in the axes of their link and contain what the links
#: beyond hand down. ``xx`` to ``yz`` are second moments, sums of ``m x x`` to
#: ``m y z``; ``izz`` is ``xx + yy``. ``hx`` and ``hy`` are first moments. ``n`` is the
#: net mass, and ``nx`` to ``nz`` are its first moments.
BASE_PARAMETERS = _units()


def base_parameters(
    links: Sequence[RigidBody],
    fluid_density: float = SEA_WATER,
    gravity: ArrayLike = GRAVITY,
    *,
    parameters: Alpha5Parameters,
) -> FloatArray:
    """Values of `BASE_PARAMETERS`.

    Args:
        links: link_0, in the axes of base_link, to link_4, each with all that is fixed
            to it; ``parameters.links`` for the bare arm.
        fluid_density: [kg/m^3].
        gravity: In base_link, (3,) [m/s^2].
        parameters: The arm's parameters; only its dimensions are used.

    Returns:
        (41,).
    """
    bodies = [
        moments(link.mass, link.com, link.inertia, link.volume, link.cob, fluid_density)
        for link in links
    ]
    return regrouped(np.array(bodies), gravity, parameters)


def regrouped(
    moments_of_links: Sequence[FloatArray] | FloatArray,
    gravity: ArrayLike,
    parameters: Alpha5Parameters,
) -> FloatArray:
    """Values of `BASE_PARAMETERS`, linear in the moments of the links.

    Args:
        moments_of_links: What `moments` returns for each link, base to tip, (2, 4, 4)
            each.
        gravity: In base_link, (3,) [m/s^2].
        parameters: The arm's parameters; only its dimensions are used.

    Returns:
        (41,).
    """
    values = {}
    for axis, component in zip("xyz", np.asarray(gravity), strict=True):
        values[f"gravity.{axis}"] = component

    link_0, *moving_links = moments_of_links
    handed_down = np.zeros_like(link_0)
    for link, to_link_before in inwards(parameters):
        own = handed_down + moving_links.pop()
        values |= _values_of_link(link, *own)
        on_axis = _on_the_joint_axis(own)
        handed_down = to_link_before @ on_axis @ to_link_before.T
    values |= _values_of_link(0, *(handed_down + link_0))
    return np.array([values[name] for name in BASE_PARAMETERS])


def inwards(parameters: Alpha5Parameters) -> list[tuple[int, FloatArray]]:
    """The moving links from tip to base, each with its pose in the link before.

    The poses (4, 4) are those of joints that are not turned. Link 1 has the origin and
    the z axis of base_link.
    """
    poses = [np.eye(4)]
    for row in parameters.dh[:3]:
        poses.append(pose((row.a, 0.0, row.d), (row.alpha, 0.0, 0.0)))
    return [*zip(MOVING_LINKS, poses, strict=True)][::-1]


def _values_of_link(link: int, mass: FloatArray, net: FloatArray) -> dict[str, float]:
    """All moments of a link, by their names in `BASE_PARAMETERS`, and some more."""
    values = {
        f"link_{link}.n": net[3, 3],
        f"link_{link}.izz": mass[0, 0] + mass[1, 1],
    }
    for name, at in SECOND.items():
        values[f"link_{link}.{name}"] = mass[at]
    for row, axis in enumerate("xyz"):
        values[f"link_{link}.h{axis}"] = mass[row, 3]
        values[f"link_{link}.n{axis}"] = net[row, 3]
    return values


def _on_the_joint_axis(moments: FloatArray) -> FloatArray:
    """What of the moments (2, 4, 4) lies on the z axis: no x, no y."""
    on_axis = moments.copy()
    on_axis[:, :2] = 0.0
    on_axis[:, :, :2] = 0.0
    return on_axis


def moments(
    mass: Any,
    com: Any,
    inertia: Any,
    volume: Any,
    cob: Any,
    fluid_density: Any,
    stack: Callable[[Any, float], Any] = np.append,
) -> tuple[Any, Any]:
    """Zeroth, first and second moments of a body's mass and of its net mass.

    Each is one matrix P (4, 4), with the second moments, the first moments in the last
    row and column, and the mass [Wensing2018]. With T the body's pose in another frame,
    ``T P T^T`` are the moments there. The 3x3 block of the net matrix has no meaning
    and is not read. All numbers are NumPy's or CasADi's.

    Args:
        mass: [kg].
        com: Centre of mass, (3,) [m].
        inertia: At the COM, (3, 3) [kg m^2].
        volume: Displaced volume [m^3].
        cob: Centre of buoyancy, (3,) [m].
        fluid_density: [kg/m^3].
        stack: Appends a number to a column.
    """
    centre = stack(com, 1.0).reshape((4, 1))
    centroid = stack(cob, 1.0).reshape((4, 1))

    of_mass = mass * (centre @ centre.T)
    net = of_mass - fluid_density * volume * (centroid @ centroid.T)

    trace = inertia[0, 0] + inertia[1, 1] + inertia[2, 2]
    of_mass[:3, :3] += trace / 2 * np.eye(3) - inertia
    return of_mass, net
