"""Tables 2 and 3: tensors, masses, centres, sizes and densities against each other.

References:
    [ReachAlpha] Manufacturer's document, Section 2.1, Table 2, equations (1) and (2),
        and Section 2.2, Table 3.
    [Wensing2018], [Bhatia2000] See `alpha5_model.numbers.inertia`.
    [Aluminium] Density of aluminium, 2.70 kg/L: any handbook.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import cross_matrix, excess_of_box, rotation_about
from alpha5_model.numbers import inertia
from alpha5_model.numbers.fluids import GRAVITY, SEA_WATER
from alpha5_model.numbers.parameters import Alpha5Parameters, link_numbers
from alpha5_model.numbers.tables import BuoyancyRow, InertialRow, Published
from alpha5_model.proofs.audit.row import AuditRow, Figure, figure, judged, si

ALUMINIUM = 2700.0  # kg/m^3
G = -GRAVITY[2]  # m/s^2
#: Indices of the six entries of a symmetric tensor: xx, xy, xz, yy, yz, zz.
_UPPER = np.triu_indices(3)


def rows(printed: Published, parameters: Alpha5Parameters) -> list[AuditRow]:
    """The rows of Tables 2 and 3."""
    bodies = printed.table_2.rows
    waters = printed.table_3.rows
    boxes = [link.bounds for link in parameters.links]
    fastest = max(joint.velocity for joint in parameters.joints[:4])
    return [
        *(_parallel_axis(row, fastest) for row in bodies),
        *(_product_sign(row) for row in bodies),
        # The link with the longest lever shows most of equations (1) and (2).
        *_equations(bodies[4]),
        _rotation(parameters),
        *map(_implied_mass, bodies),
        *_missing_decimals(bodies),
        *(row for body in bodies for row in _possible(body)),
        *map(_com_inside, bodies, boxes),
        *map(_mass_spread, bodies, boxes),
        *_jaw_plane(printed),
        *_cobs_inside(printed, boxes),
        *map(_density, bodies, waters),
        _total_volume(printed, boxes),
    ]


class Body(NamedTuple):
    """The numbers of a row of Table 2, in SI units and URDF sign.

    Attributes:
        mass: [kg].
        com: P, (3,) [m].
        at_com: I_COM, (3, 3) [kg m^2].
        at_link: I_Link, (3, 3) [kg m^2].
    """

    mass: float
    com: FloatArray
    at_com: FloatArray
    at_link: FloatArray


def of_row(row: InertialRow, formula: Callable[[Body], Any]) -> Figure:
    """A formula of the numbers in a row of Table 2, and what rounding allows."""
    tensors = (row.inertia_com, row.inertia_link)
    entries = [tensor[i][j] for tensor in tensors for i, j in np.transpose(_UPPER)]

    def value(numbers: FloatArray) -> Any:
        upper = np.zeros((2, 3, 3))
        upper[:, *_UPPER] = numbers[4:].reshape(2, 6)
        diagonal = upper * np.eye(3)
        # SolidWorks' products have the opposite sign of URDF's.
        at_com, at_link = 2 * diagonal - upper - np.swapaxes(upper - diagonal, 1, 2)
        return formula(Body(numbers[0], numbers[1:4], at_com, at_link))

    return figure(value, [row.mass, *row.com, *entries])


def implied_mass(row: InertialRow) -> Figure:
    """The mass [kg] that fits I_COM and I_Link best, and what rounding allows."""
    return of_row(row, _mass)


def _mass(body: Body) -> float:
    """The mass m that minimizes |I_Link - I_COM - m (P.P E - P P^T)| [kg]."""
    per_mass = inertia.point_mass_tensor(1.0, body.com)
    difference = body.at_link - body.at_com
    return float(np.sum(per_mass * difference) / np.sum(per_mass * per_mass))


# --- Table 2: the tensors against each other, and against equations (1) and (2) -------


class _Entry(NamedTuple):
    """An entry of a tensor that should vanish.

    Attributes:
        figure: Its magnitude, and what rounding allows.
        name: ``xx`` to ``zz``.
        beyond: How many of the tensor's six entries are beyond their bounds.
    """

    figure: Figure
    name: str
    beyond: int


def _worst(row: InertialRow, residual: Callable[[Body], FloatArray]) -> _Entry:
    """The largest entry, among those beyond their bounds if there are any."""
    found = of_row(row, residual)
    size = np.abs(found.value[_UPPER])
    bound = found.bound[_UPPER]
    beyond = size > bound
    k = int(np.argmax(np.where(beyond, size, 0.0) if beyond.any() else size))
    i, j = (index[k] for index in _UPPER)
    return _Entry(
        figure=Figure(size[k], bound[k]),
        name="xyz"[i] + "xyz"[j],
        beyond=int(beyond.sum()),
    )


def _parallel_axis(row: InertialRow, fastest: float) -> AuditRow:
    """Whether I_Link is I_COM moved to the link frame.

    Args:
        fastest: The highest joint velocity [rad/s].
    """
    worst = _worst(row, _moved_to_link)
    return judged(
        f"parallel_axis.link_{row.link}",
        worst.figure,
        unit="kg mm^2",
        place=f"Section 2.1, Table 2, link {row.link}",
        says="I_COM and I_Link are one tensor in two frames",
        measures="largest difference between an entry of I_Link and of I_COM carried "
        "to the link frame",
        finding=f"{worst.beyond} of 6 entries are further apart than rounding allows. "
        f"The largest is {worst.name}.",
        used="I_COM",
        effect=worst.figure.value * fastest**2,
        cost="torque of this difference at the speed of the fastest joint",
    )


def _moved_to_link(body: Body) -> FloatArray:
    moved = inertia.tensor_at_origin(body.mass, body.com, body.at_com)
    return body.at_link - moved


def _product_sign(row: InertialRow) -> AuditRow:
    """The control of `_parallel_axis`: products in URDF's sign do not fit."""

    def residual(body: Body) -> FloatArray:
        at_com = inertia.flip_products(body.at_com)
        at_link = inertia.flip_products(body.at_link)
        return _moved_to_link(body._replace(at_com=at_com, at_link=at_link))

    worst = _worst(row, residual).figure
    return judged(
        f"product_sign.link_{row.link}",
        Figure(worst.value),
        expected=worst.bound,
        relation=">=",
        unit="kg mm^2",
        place=f"Section 2.1, Table 2, link {row.link}",
        says="products of inertia are positive (SolidWorks)",
        measures="the same difference if the products had the opposite sign, which "
        "rounding must not explain",
    )


def _equations(row: InertialRow) -> list[AuditRow]:
    """Equations (1) and (2), which carry I_COM to I_Link, as printed."""

    def equal_terms(body: Body) -> FloatArray:
        p_p = (body.com @ body.com) * np.eye(3)
        return body.at_link - body.at_com - body.mass * (p_p - p_p.T)

    def plus_skew(body: Body) -> FloatArray:
        skew = cross_matrix(body.com)
        return body.at_link - body.at_com - body.mass * skew @ skew

    def from_link_frame(body: Body) -> FloatArray:
        moved = inertia.tensor_at_origin(body.mass, body.com, body.at_link)
        return moved - body.at_com

    judge = partial(judged, unit="kg mm^2", law=True)
    measures = "largest difference between the printed I_Link and that of the equation"
    return [
        judge(
            "equation_1.printed",
            _worst(row, equal_terms).figure,
            place=f"Section 2.1, equation (1), on link {row.link}",
            says="I_Link = I_COM + m[(P.P)E - (P.P)^T]",
            measures=measures,
            finding="(P.P)^T is a number, where a matrix is needed. Read as (P.P) E, "
            "it cancels the term before it.",
            used="the outer product P P^T",
            category="transcription",
        ),
        judge(
            "equation_2.printed",
            _worst(row, plus_skew).figure,
            place=f"Section 2.1, equation (2), on link {row.link}",
            says="I_Link = I_COM + m SKEW(P)^2",
            measures=measures,
            finding="SKEW(P)^2 is negative semidefinite, so the printed sign subtracts "
            "the parallel axis term.",
            used="- m SKEW(P)^2",
            category="transcription",
        ),
        judge(
            "equation_1.any_frame",
            _worst(row, from_link_frame).figure,
            place=f"Section 2.1, equation (1), on link {row.link}",
            says="I_A is the inertia with respect to {A}, any frame",
            measures="largest difference between the printed I_COM and that of the "
            "corrected equation, if {A} is the link frame",
            finding="From the link frame to the COM the term must be subtracted. The "
            "text is right if {A} is at the COM.",
            used="the equation with {A} at the COM",
            category="reading",
        ),
    ]


def _rotation(parameters: Alpha5Parameters) -> AuditRow:
    """Rotation of I_COM of links 1 to 4 from inertial frame {i} to DH frame {i}.

    The tensor that the equation gives, with R as the rotation that turns {i} into DH
    frame {i}, is carried back to {i}, where it must be the printed one.
    """
    tensors = np.array([link.inertia for link in parameters.links[1:]])
    turn = rotation_about((1, 0, 0), [row.alpha for row in parameters.dh[:4]])
    back = np.swapaxes(turn, 1, 2)
    in_dh_frame = turn @ tensors @ back
    difference = turn @ in_dh_frame @ back - tensors
    return judged(
        "equation_1.rotation",
        Figure(np.abs(difference).max()),
        unit="kg mm^2",
        place="Section 2.1, equation (1), rotation, links 1 to 4",
        says="R_A/B is the rotation from {A} to {B}",
        measures="largest error of an entry of I_COM after the rotation to DH frame "
        "{i}, if R turns {A} into {B}",
        finding="The equation is right if R maps coordinates in {A} to {B}.",
        used="R as the map of coordinates",
        category="reading",
    )


def _implied_mass(row: InertialRow) -> AuditRow:
    excess = of_row(row, lambda body: _mass(body) - body.mass)
    return judged(
        f"implied_mass.link_{row.link}",
        Figure(implied_mass(row).value, excess.bound),
        expected=row.mass.si,
        unit="kg",
        place=f"Section 2.1, Table 2, link {row.link}, mass",
        says=f"mass {row.mass}",
        measures="mass that carries I_COM to I_Link best (least squares), if COM and "
        "tensors are right",
        finding="The printed mass is right if the COM or a tensor is off.",
        used="the printed mass",
        effect=abs(excess.value) * G * _lever(row),
        cost="weight of the difference, times the lever of the COM",
        category="reading",
    )


def _lever(row: InertialRow) -> float:
    """Distance of the COM from the link frame [m]."""
    return float(np.linalg.norm(si(row.com)))


def _missing_decimals(rows: tuple[InertialRow, ...]) -> list[AuditRow]:
    """Masses with fewer decimals than those of the other links."""
    decimals = [len(row.mass.text.partition(".")[2]) for row in rows]
    usual = max(decimals)
    found = []
    for row, own in zip(rows, decimals, strict=True):
        if own == usual:
            continue
        finer = replace(row.mass, text=f"{row.mass.value:.{usual}f}")
        implied = implied_mass(row)
        found.append(
            judged(
                f"printed_digits.link_{row.link}",
                Figure(own),
                expected=usual,
                kind="observation",
                place=f"Section 2.1, Table 2, link {row.link}, mass",
                says=f"mass {row.mass}",
                measures="decimals of the printed mass, where the other links have "
                f"{usual}",
                finding=f"It may stand for {finer}: the two tensors give "
                f"{implied.value:.5f} ± {implied.bound:.5f} kg.",
                used=f"{row.mass}",
                effect=(row.mass.rounding - finer.rounding) * G * _lever(row),
                cost="weight of what the missing digit leaves open, times the lever "
                "of the COM",
            )
        )
    return found


def _possible(row: InertialRow) -> list[AuditRow]:
    """The smallest principal second moment of both tensors; no body has one below 0."""

    def at_com(body: Body) -> FloatArray:
        return body.at_com

    def from_link(body: Body) -> FloatArray:
        return inertia.tensor_at_com(body.mass, body.com, body.at_link)

    found = []
    tensors = (("com", "I_COM", at_com), ("link", "I_Link", from_link))
    for name, title, tensor in tensors:

        def smallest(body: Body, tensor: Any = tensor) -> Any:
            return inertia.principal_moments(inertia.second_moments(tensor(body)))[0]

        found.append(
            judged(
                f"possible_{name}.link_{row.link}",
                of_row(row, smallest),
                relation=">=",
                unit="kg mm^2",
                law=True,
                place=f"Section 2.1, Table 2, link {row.link}, {title}",
                says=f"{title} is the tensor of a body",
                measures="smallest principal second moment of mass about the COM",
            )
        )
    return found


# --- Tables 2 and 3: the bodies against their sizes -----------------------------------


def _com_inside(row: InertialRow, bounds: FloatArray) -> AuditRow:
    return judged(
        f"com_inside.link_{row.link}",
        figure(partial(excess_of_box, bounds=bounds), row.com),
        relation="<=",
        unit="mm",
        place=f"Section 2.1, Table 2, link {row.link}, COM",
        says="COM in the inertial frame of Section 2",
        measures="how far the COM lies outside the body's bounding box (0 if inside)",
    )


def _mass_spread(row: InertialRow, bounds: FloatArray) -> AuditRow:
    """Whether the mass is spread no farther than the body's bounds allow.

    Along each axis its standard deviation is at most sqrt((max - c) (c - min)).
    """

    def spread(body: Body) -> FloatArray:
        """Standard deviation along each axis and its excess, (2, 3) [m]."""
        moments = np.diag(inertia.second_moments(body.at_com))
        # Below 0 the tensor is impossible, which is another row's matter.
        deviation = np.sqrt(np.maximum(moments / body.mass, 0.0))
        below = body.com - bounds[:, 0]
        above = bounds[:, 1] - body.com
        room = np.maximum([below, above], 0.0)
        return np.array([deviation, deviation - np.sqrt(room.prod(axis=0))])

    found = of_row(row, spread)
    deviation, excess = found.value
    bound = found.bound[1]
    k = int(np.argmax(excess - bound))
    return judged(
        f"mass_spread.link_{row.link}",
        Figure(deviation[k], bound[k]),
        expected=deviation[k] - excess[k],
        relation="<=",
        unit="mm",
        kind="observation",
        place=f"Section 2.1, Table 2, link {row.link}, I_COM",
        says="I_COM about the COM",
        measures=f"standard deviation of the mass along {'xyz'[k]}, compared with the "
        "most that the bounding box allows",
        finding="Part of this mass turns inside the neighbour's housing.",
        used="the printed tensor",
    )


def _jaw_plane(printed: Published) -> list[AuditRow]:
    """Plane and mass of the closed fingers, from the tensor about the wrist axis."""
    jaws = printed.supplementary.jaws
    names = ("pivot_offset", "finger_density", "finger_volume", "second_finger_volume")
    fingers = [jaws[name].quantity for name in names]
    offset = fingers[0].si
    (xx, xy, _), (_, yy, _), _ = printed.table_2.rows[4].inertia_com

    # The direction of the greatest spread of mass, from x of {4}. The products of
    # inertia have the document's sign.
    direction = figure(lambda x: np.arctan2(2 * x[2], x[1] - x[0]) / 2, [xx, yy, xy])
    plane = jaws["sdk_plane"].quantity
    spread = figure(lambda x: x[1] - x[0], [xx, yy])
    # I_yy - I_xx of two point masses at the pivots, with the masses of the fingers.
    points = figure(lambda x: x[0] ** 2 * x[1] * (x[2] + x[3]), fingers)

    judge = partial(
        judged,
        kind="observation",
        place="Section 2.1, Table 2, link 4, I_COM",
        says="link 4 includes interlocking jaws in the closed position",
    )
    return [
        judge(
            "jaw_plane.direction",
            Figure(direction.value, direction.bound + plane.rounding),
            expected=plane.si,
            unit="deg",
            measures="angle from x of {4} to the line through both fingers, by the "
            "principal axes, compared with the manufacturer's URDF",
            finding="No source settles where axis_b is zero.",
            used="the principal axes",
        ),
        judge(
            "jaw_plane.spread",
            Figure(spread.value, points.bound + spread.bound),
            expected=points.value,
            unit="kg mm^2",
            measures="I_yy - I_xx, compared with the estimated fingers as point "
            f"masses at ±{fingers[0]}",
            finding=f"Two of {1e3 * spread.value / (2 * offset**2):.3g} g each would "
            "give the printed difference.",
            used="the estimated masses",
        ),
    ]


def _cobs_inside(printed: Published, boxes: list[FloatArray]) -> list[AuditRow]:
    """How far each centre of buoyancy is from its body's bounds."""
    rows = printed.table_3.rows
    corrected = [numbers["cob"] for numbers in link_numbers(printed, ("link3_cob",))]
    return list(map(_cob_inside, rows, boxes, corrected))


def _cob_inside(row: BuoyancyRow, bounds: FloatArray, corrected: Any) -> AuditRow:
    """The row of one centre of buoyancy.

    Args:
        corrected: The centre after the correction `link3_cob`, which moves that of
            link 3 only, (3,) [m].
    """
    finding = "A centroid cannot be outside."
    used = "the printed COB"
    moved = float(np.linalg.norm(corrected - si(row.cob)))
    if moved:
        there = ", ".join(f"{1e3 * x:.1f}" for x in corrected)
        side = "outside" if excess_of_box(corrected, bounds) else "inside"
        finding += (
            " Link 1 is the same kind of part as link 3. Read in link 1's frame and "
            f"carried to link 3's, the COB is ({there}) mm, {side}."
        )
        used += "; the correction link3_cob on request"
    x, y, z = (number.text for number in row.cob)
    return judged(
        f"cob_inside.link_{row.link}",
        figure(partial(excess_of_box, bounds=bounds), row.cob),
        relation="<=",
        unit="mm",
        law=True,
        place=f"Section 2.2, Table 3, link {row.link}",
        says=f"COB ({x}, {y}, {z}) mm",
        measures="how far the COB lies outside the body's bounding box (0 if inside)",
        finding=finding,
        used=used,
        effect=moved * SEA_WATER * row.volume.si * G if moved else None,
        cost="buoyancy, times the distance to the corrected COB",
    )


def _density(inertial: InertialRow, row: BuoyancyRow) -> AuditRow:
    return judged(
        f"density.link_{row.link}",
        figure(lambda x: x[0] / x[1], [inertial.mass, row.volume]),
        expected=ALUMINIUM,
        relation="<=",
        unit="kg/L",
        kind="observation",
        place=f"Tables 2 and 3, link {row.link}",
        says=f"{inertial.mass} in {row.volume}",
        measures="mean density, compared with that of solid aluminium",
        finding="Some of the mass sits in volume that Table 3 counts for another link.",
        used="the printed mass and volume",
    )


def _total_volume(printed: Published, boxes: list[FloatArray]) -> AuditRow:
    return judged(
        "total.volume",
        figure(np.sum, [row.volume for row in printed.table_3.rows]),
        expected=sum(float(np.prod(np.diff(box))) for box in boxes),
        relation="<=",
        unit="L",
        law=True,
        place="Section 2.2, Table 3, volume",
        says="the volumes are those of the five bodies",
        measures="sum of the volumes, compared with that of the bodies' bounding boxes",
    )
