"""A table of what the water does to each link, for simulators that have no water.

It holds volume and centre of buoyancy, which are published, and added mass and drag,
which are estimated. Points and moments are about the link's centre of mass, in the axes
of its frame, because physics engines apply external wrenches there.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import cross_matrix
from alpha5_model.description.bodies import Body, arm_bodies
from alpha5_model.description.digits import rounded
from alpha5_model.description.options import ArmOptions
from alpha5_model.description.xml import provenance
from alpha5_model.numbers.fluids import GRAVITY, SEA_WATER, density_of
from alpha5_model.numbers.hydrodynamics import (
    LEVELS,
    WATER_DENSITY,
    BodyHydrodynamics,
    DragStrip,
    gauss_points,
    hydrodynamics,
)

#: Decimal places of a number in SI units; what is smaller is rounding.
_PLACES = 15
#: What the keys mean, in the file itself.
_CONVENTIONS = {
    "axes": "those of the link's frame in urdf/alpha5.urdf",
    "com": "from the link's frame [m]",
    "center_of_buoyancy": "from the link's frame [m]",
    "center_of_buoyancy_from_com": "where the buoyancy acts, from the COM [m]",
    "added_mass": "linear before angular, about the COM [kg, kg m, kg m^2]",
    "quadratic_drag": (
        "wrench about the COM = -D (|nu| nu), nu the twist at the COM relative to the "
        "water, linear before angular; exact if nu has one component only"
    ),
    "strips": (
        "a length ds resists the water's velocity u across it with "
        "rho / 2 across diameter ds |u| u, and likewise along it; from the COM [m]"
    ),
}


@dataclass(frozen=True)
class WaterOptions(ArmOptions):
    """Options of the table, beside those of `ArmOptions`.

    What is attached to a link is part of its mass and volume; added mass and drag are
    the catalogue's, in the frames of the links.

    Attributes:
        fluid_density: [kg/m^3]; 0 is air. Given as for `alpha5_model.load`.
    """

    fluid_density: float = SEA_WATER

    def __post_init__(self) -> None:
        super().__post_init__()
        density = density_of(self.fluid_density)
        object.__setattr__(self, "fluid_density", density)


def water_files(options: WaterOptions | None = None) -> dict[str, bytes]:
    """``water.json``: see `water_table`."""
    text = json.dumps(water_table(options), indent=2, ensure_ascii=False)
    return {"water.json": f"{text}\n".encode()}


def water_table(options: WaterOptions | None = None) -> dict[str, Any]:
    """The table, in SI units.

    Added mass, drag coefficients and the matrices of quadratic drag are given as
    ``low``, ``nominal`` and ``high``, in the fluid of the options.

    Raises:
        Alpha5Error: See `WaterOptions`.
    """
    chosen = options or WaterOptions()
    arm = chosen.record
    water = {level: hydrodynamics(chosen.gripper, level) for level in LEVELS}
    links = {}
    for body in arm_bodies(arm, chosen.gripper):
        of_link = {
            level: bodies[body.name]
            for level, bodies in water.items()
            if body.name in bodies
        }
        links[body.name] = _link(body, of_link, chosen.fluid_density)
    return {
        "model": arm.name,
        "provenance": provenance(arm),
        "gripper": chosen.gripper,
        "fluid_density": chosen.fluid_density,
        "gravity": list(GRAVITY),
        "status": {
            "mass, com, volume, center_of_buoyancy": "published",
            "added_mass, quadratic_drag, strips": "estimated, not published",
        },
        "conventions": _CONVENTIONS,
        "links": links,
    }


def _link(
    body: Body, water: dict[str, BodyHydrodynamics], density: float
) -> dict[str, Any]:
    """The row of a link; ``water`` has its added mass and drag at each level."""

    def at_each_level(value: Callable[[BodyHydrodynamics], ArrayLike]) -> Any:
        return {level: _plain(value(data)) for level, data in water.items()}

    return {
        "mass": body.mass,
        "com": _plain(body.com),
        "volume": body.volume,
        "center_of_buoyancy": _plain(body.cob),
        "center_of_buoyancy_from_com": _plain(body.cob - body.com),
        "added_mass": at_each_level(
            lambda data: added_mass_at(data, body.com) * (density / WATER_DENSITY)
        ),
        "quadratic_drag": at_each_level(
            lambda data: quadratic_drag_at(data, body.com, density)
        ),
        "strips": _strips(water, body.com),
    }


def _strips(
    water: dict[str, BodyHydrodynamics], com: FloatArray
) -> list[dict[str, Any]]:
    """The strips of a link, whose coefficients alone differ between the levels."""
    rows = []
    for strips in zip(*(data.strips for data in water.values()), strict=True):
        levels = dict(zip(water, strips, strict=True))
        strip = levels["nominal"]
        rows.append(
            {
                "start_from_com": _plain(strip.start - com),
                "end_from_com": _plain(strip.end - com),
                "diameter": strip.diameter,
                "across": {level: at.across for level, at in levels.items()},
                "along": {level: at.along for level, at in levels.items()},
            }
        )
    return rows


def added_mass_at(water: BodyHydrodynamics, point: FloatArray) -> FloatArray:
    """Added mass about a point of the link, in its axes, (6, 6).

    With the twist nu at the point, the one at the link's frame is X nu.
    """
    to_origin = np.eye(6)
    to_origin[:3, 3:] = cross_matrix(point)
    return np.asarray(to_origin.T @ water.added_mass @ to_origin)


def quadratic_drag_at(
    water: BodyHydrodynamics, point: FloatArray, density: float
) -> FloatArray:
    """The matrix D with drag ``-D (|nu| nu)`` about a point of the link, (6, 6).

    Column j is the drag at unit speed of component j alone. For motions of several
    components at once D approximates the drag of the strips.
    """
    columns = []
    for twist in np.eye(6):
        columns.append(-_drag(water.strips, twist, point, density))
    return np.column_stack(columns)


def _drag(
    strips: Iterable[DragStrip], twist: FloatArray, center: FloatArray, density: float
) -> FloatArray:
    """Wrench about a center, at which the link has a twist in still water, (6,)."""
    total = np.zeros(6)
    for strip in strips:
        line = strip.end - strip.start
        length = float(np.linalg.norm(line))
        direction = line / length
        for point, share in gauss_points(strip):
            arm = point - center
            velocity = twist[:3] + np.cross(twist[3:], arm)
            along = direction * (direction @ velocity)
            across = velocity - along
            drag = strip.across * np.linalg.norm(across) * across
            drag += strip.along * np.linalg.norm(along) * along
            force = -density / 2 * strip.diameter * length * share * drag
            total += np.concatenate([force, np.cross(arm, force)])
    return total


def _plain(values: ArrayLike) -> Any:
    """Lists of numbers, without the noise of rounding.

    The numbers of a matrix have several units, so each is rounded by itself.
    """
    places = np.round(np.asarray(values, float), _PLACES)
    numbers = [float(rounded(number)) for number in places.ravel()]
    return np.reshape(numbers, places.shape).tolist()
