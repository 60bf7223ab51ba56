"""Added mass and drag strips of each body, in SI units. Estimated, not published.

There are two sets, both in ``numbers/``. ``estimated`` is our own calculation, with
low, nominal and high values. ``supplementary`` are numbers by strip theory that
circulate.
`alpha5_model.water` computes with them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    FloatArray,
    array,
    choice,
    fill,
    frozen,
    instance,
    listed,
    real,
)
from alpha5_model._support.spatial import cross_matrix
from alpha5_model.errors import InputError
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.jaws import GRIPPERS, Gripper
from alpha5_model.numbers.parameters import in_si
from alpha5_model.numbers.printed import hydrodynamics as read
from alpha5_model.numbers.tables import BODY_NAMES, HydrodynamicRow

LEVELS = ("low", "nominal", "high")
SETS = ("estimated", "supplementary")
#: Added masses and damping are given for water of this density [kg/m^3]; those in
#: another fluid are in proportion to its density.
WATER_DENSITY = 1000.0
#: How far a matrix may be from symmetric and from positive semidefinite by rounding,
#: relative to its diagonal entries.
_ROUNDING = 1e-6


@dataclass(frozen=True, eq=False)
class DragStrip:
    """A straight piece of a slender body in the cross-flow principle (Morison).

    A length ds resists the water's velocity u across it with ``rho / 2 across diameter
    ds |u| u``, and likewise the velocity along it.

    Attributes:
        start, end: In the body's frame, (3,) [m].
        diameter: [m].
        across, along: Drag coefficients, both on ``diameter ds``.

    Raises:
        InputError: A coefficient or diameter below 0, or a strip without length.

    Warns:
        ImplausibleWarning: Lengths that seem to be in mm.
    """

    start: FloatArray
    end: FloatArray
    diameter: float
    across: float
    along: float = 0.0

    def __post_init__(self) -> None:
        for name in ("start", "end"):
            fill(self, **{name: frozen(array(name, getattr(self, name), 3))})
        for name in ("diameter", "across", "along"):
            fill(self, **{name: real(name, getattr(self, name), minimum=0.0)})
        for name in ("start", "end", "diameter"):
            plausibility.check(name, getattr(self, name), plausibility.VEHICLE_POSITION)
        if np.array_equal(self.start, self.end):
            raise InputError("end", self.end.tolist(), "a point other than start")


@dataclass(frozen=True, eq=False)
class BodyHydrodynamics:
    """Added mass and drag of one body, in its frame.

    Attributes:
        added_mass: Linear before angular, about the frame's origin, (6, 6) [kg, kg m,
            kg m^2], in water of `WATER_DENSITY`.
        strips: Along which the water drags.

    Raises:
        InputError: An added mass that is not symmetric, or has a negative eigenvalue.
    """

    added_mass: FloatArray
    strips: tuple[DragStrip, ...] = ()

    def __post_init__(self) -> None:
        strips = []
        for strip in listed("strips", self.strips, "DragStrips"):
            strips.append(instance("strips", strip, DragStrip))
        checked = frozen(added_mass(self.added_mass))
        fill(self, added_mass=checked, strips=tuple(strips))


#: Point and weight of the positive half of Gauss's quadrature, by its count of points.
#: NumPy's last bits depend on its version, and generated files contain them.
_POSITIVE_HALF = {
    4: (
        (0.33998104358485626, 0.6521451548625464),
        (0.8611363115940526, 0.34785484513745357),
    ),
    6: (
        (0.2386191860831969, 0.46791393457269104),
        (0.6612093864662645, 0.3607615730481387),
        (0.9324695142031519, 0.17132449237917027),
    ),
}


@cache
def gauss_rule(count: int) -> tuple[FloatArray, FloatArray]:
    """Ascending points of Gauss's quadrature on -1 to 1, and weights, (count,) each."""
    if count not in _POSITIVE_HALF:
        nodes, weights = np.polynomial.legendre.leggauss(count)
        return nodes, weights

    positive, half_weights = np.transpose(_POSITIVE_HALF[count])
    nodes = np.concatenate([-positive[::-1], positive])
    weights = np.concatenate([half_weights[::-1], half_weights])
    return nodes, weights


def gauss_count(strip: DragStrip) -> int:
    """Points of Gauss's quadrature on a strip: 4 up to 0.1 m, else 6.

    At any speed of the water and of this arm's joints they err by at most 5e-4 of the
    median torque of its drag.
    """
    return 6 if np.linalg.norm(strip.end - strip.start) > 0.1 else 4


def gauss_points(
    strip: DragStrip, count: int | None = None
) -> list[tuple[FloatArray, float]]:
    """Points of Gauss's quadrature along a strip, (3,) [m], each with its share.

    If there is no count, it is that of `gauss_count`.
    """
    line = strip.end - strip.start
    twice_middle = strip.start + strip.end
    nodes, weights = gauss_rule(gauss_count(strip) if count is None else count)
    points: list[tuple[FloatArray, float]] = []
    for node, weight in zip(nodes, weights, strict=True):
        point = (twice_middle + node * line) / 2
        points.append((point, weight / 2))
    return points


def added_mass(matrix: ArrayLike) -> FloatArray:
    """Check an added mass.

    Returns:
        The symmetric part, (6, 6).

    Raises:
        InputError: Not symmetric, or with a negative eigenvalue; ShapeError: not (6,
            6).
    """
    given = array("added_mass", matrix, 6, 6)
    symmetric: FloatArray = (given + given.T) / 2

    # Entries are in kg and in kg m^2, so they are compared in units of their diagonal.
    diagonal = np.sqrt(np.abs(np.diag(given)))
    scale = np.where(diagonal > 0, diagonal, 1.0)
    relative = given / np.outer(scale, scale)
    if np.abs(relative - relative.T).max() > _ROUNDING:
        raise InputError("added_mass", given.tolist(), "a symmetric matrix")
    eigenvalues = np.linalg.eigvalsh((relative + relative.T) / 2)
    if eigenvalues.min() < -_ROUNDING:
        raise InputError("added_mass", given.tolist(), "no negative eigenvalue")
    return symmetric


def hydrodynamics(
    gripper: Gripper = "locked", level: str = "nominal", numbers: str = "estimated"
) -> dict[str, BodyHydrodynamics]:
    """Added mass and drag of each body of the arm.

    Args:
        gripper: ``locked`` (link_4 with closed jaws) or ``jaws`` (wrist and fingers,
            each alone).
        level: ``low``, ``nominal`` or ``high`` end of the interval.
        numbers: ``estimated`` or ``supplementary``.

    Returns:
        Name of the link -> its added mass and drag; links that the set does not contain
        are left out.

    Raises:
        UnknownNameError: No such gripper, level or set.
    """
    column = LEVELS.index(choice("level", level, LEVELS))
    rows = read(choice("set", numbers, SETS))
    choice("gripper", gripper, GRIPPERS)
    # Link -> its row in the file.
    names = {name: name for name in BODY_NAMES}
    if gripper == "jaws":
        names |= {"link_4": "wrist", "finger_1": "finger_1", "finger_2": "finger_2"}

    bodies = {}
    for link, name in names.items():
        if name in rows:
            bodies[link] = _body(rows[name], column)
    return bodies


def _body(row: HydrodynamicRow, column: int) -> BodyHydrodynamics:
    """A row of the file in SI units, at one of the `LEVELS`."""
    strips = []
    for strip in row.strips:
        strips.append(
            DragStrip(
                start=in_si(strip.start),
                end=in_si(strip.end),
                diameter=in_si(strip.diameter),
                across=in_si(strip.across[column]),
                along=in_si(strip.along[column]),
            )
        )
    matrix = np.array(in_si(row.added_mass))
    shape = (row.shape_low, None, row.shape_high)[column]
    if shape is not None:
        matrix = scaled_at_centre(matrix, np.array(in_si(shape)))
    factor = row.added_mass_factor[column].si
    return BodyHydrodynamics(added_mass=matrix * factor, strips=tuple(strips))


def scaled_at_centre(matrix: FloatArray, shares: FloatArray) -> FloatArray:
    """An added mass that is larger or smaller for some motions, (6, 6).

    About its centre, where moving and turning are least coupled, each entry is
    multiplied by the geometric mean of the shares of its two motions.

    Args:
        matrix: (6, 6).
        shares: Of the motions along and about the axes, (6,).
    """
    if (shares == 1.0).all():
        return matrix
    to_origin = np.eye(6)
    to_origin[:3, 3:] = cross_matrix(centre_of_added_mass(matrix))
    to_centre = np.linalg.inv(to_origin)
    at_centre = to_origin.T @ matrix @ to_origin
    scaled = at_centre * np.sqrt(np.outer(shares, shares))
    moved = to_centre.T @ scaled @ to_centre
    return np.asarray((moved + moved.T) / 2)


def centre_of_added_mass(matrix: FloatArray) -> FloatArray:
    """The point about which moving and turning are least coupled, (3,) [m].

    If all added mass were at a point r, the coupling would be ``-A_11 [r]x``. This is
    the r that comes closest (least squares).

    Args:
        matrix: Added mass about the origin, (6, 6).
    """
    moving = matrix[:3, :3]
    unit_couplings = [(-moving @ cross_matrix(axis)).ravel() for axis in np.eye(3)]
    coupling = matrix[:3, 3:].ravel()
    centre, *_ = np.linalg.lstsq(np.transpose(unit_couplings), coupling, rcond=None)
    return np.asarray(centre)
