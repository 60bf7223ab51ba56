"""Tables 2 and 3: tensors, equations, masses, centres, sizes and densities against each other.

References:
    [ReachAlpha] Manufacturer's document, Section 2.1, Table 2, equations (1) and (2), and Section
        2.2, Table 3.
    [Wensing2018], [Bhatia2000] See `alpha5_model.inertia`.
    [Aluminium] Density of aluminium, 2.70 kg/L: any handbook.
"""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from functools import partial
from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.consistency.row import (
    ARITHMETIC,
    GRAVITY,
    MM,
    AuditRow,
    audited,
    excess_of_box,
    figure,
    rounding_bound,
    si,
)
from alpha5_model.fluids import SEA_WATER
from alpha5_model.inertia import (
    flip_products,
    point_mass_tensor,
    principal_moments,
    second_moments,
    tensor_at_com,
    tensor_at_origin,
)
from alpha5_model.parameters import Alpha5Parameters, LinkParameters, convert
from alpha5_model.published.quantity import Quantity
from alpha5_model.published.tables import BuoyancyRow, InertialRow, Published
from alpha5_model.spatial import cross_matrix, rotation_about

ALUMINIUM = 2700.0  # kg/m^3
_UPPER = tuple((i, j) for i in range(3) for j in range(i, 3))


def audit(printed: Published, p: Alpha5Parameters) -> list[AuditRow]:
    """The rows of Tables 2 and 3."""
    links = list(zip(printed.table_2.rows, p.links, strict=True))
    fastest = max(joint.velocity for joint in p.joints[:4])
    corrected = convert(printed, ("link3_cob",)).links
    return [
        *(audited("parallel_axis", of=row, **_worst(_residual, row)) for row, _ in links),
        *(_product_sign(row, fastest) for row, _ in links),
        *_equations(printed.table_2.rows[4]),
        *_rotation(printed.table_2.rows[1:], p),
        *(_implied_mass(row) for row, _ in links),
        _total_mass(printed.table_2.rows),
        *(_possible(row, name) for row, _ in links for name in ("com", "link")),
        *(_com_inside(row, link.bounds) for row, link in links),
        *(_mass_spread(row, link.bounds) for row, link in links),
        *_jaw_plane(printed),
        *map(_cob_inside, printed.table_3.rows, p.links, corrected),
        *map(_density, printed.table_2.rows, printed.table_3.rows),
        *_totals(printed, p),
    ]


def _inputs(row: InertialRow) -> list[Quantity]:
    """Mass, COM (3), I_COM (6) and I_Link (6) as printed."""
    tensors = (row.inertia_com, row.inertia_link)
    return [row.mass, *row.com, *(t[i][j] for t in tensors for i, j in _UPPER)]


def _read(x: FloatArray) -> tuple[float, FloatArray, FloatArray, FloatArray]:
    """Mass [kg], COM [m], I_COM and I_Link [kg m^2] in URDF sign, from SI inputs."""
    tensors = np.zeros((2, 3, 3))
    for k, (i, j) in enumerate(_UPPER):
        tensors[:, i, j] = tensors[:, j, i] = x[4 + k], x[10 + k]
    at_com, at_link = flip_products(tensors)
    return float(x[0]), x[1:4], at_com, at_link


def _residual(x: FloatArray) -> FloatArray:
    mass, com, at_com, at_link = _read(x)
    return at_link - tensor_at_origin(mass, com, at_com)


def _worst(residual: Callable[[FloatArray], FloatArray], row: InertialRow) -> dict[str, Any]:
    """The largest entry of a tensor, among those beyond their bound if there are any.

    Returns:
        For `audited`: its size, what rounding allows, its name, and how many of the six entries are
        beyond.
    """
    inputs = _inputs(row)
    size, bound = np.abs(residual(si(inputs))), rounding_bound(residual, inputs)
    beyond = size > bound
    i, j = divmod(int(np.argmax(np.where(beyond, size, 0.0) if beyond.any() else size)), 3)
    count = int(beyond[np.triu_indices(3)].sum())
    return {
        "measured": size[i, j],
        "bound": bound[i, j],
        "entry": "xyz"[i] + "xyz"[j],
        "beyond": count,
    }


def _product_sign(row: InertialRow, fastest: float) -> AuditRow:
    """The control: with the products read in URDF sign, the same residual must be out of bounds."""

    def opposite(x: FloatArray) -> FloatArray:
        mass, com, at_com, at_link = _read(x)
        return flip_products(at_link) - tensor_at_origin(mass, com, flip_products(at_com))

    worst = _worst(opposite, row)
    effect = 2 * np.abs(si(_inputs(row))[[5, 6, 8]]).max() * fastest**2
    return audited("product_sign", worst["measured"], worst["bound"], of=row, effect=effect)


def _equations(row: InertialRow) -> list[AuditRow]:
    """Equations (1) and (2), as printed and as they must be, on the link with the longest lever."""
    forms: dict[str, Callable[[float, FloatArray], FloatArray]] = {
        "equation_1.printed": lambda m, p: m * ((p @ p) * np.eye(3) - (p @ p).T * np.eye(3)),
        "equation_1.corrected": lambda m, p: m * ((p @ p) * np.eye(3) - np.outer(p, p)),
        "equation_2.printed": lambda m, p: m * cross_matrix(p) @ cross_matrix(p),
        "equation_2.corrected": lambda m, p: -m * cross_matrix(p) @ cross_matrix(p),
    }

    def residual(x: FloatArray, claim: str) -> FloatArray:
        mass, com, at_com, at_link = _read(x)
        if claim == "equation_1.any_frame":  # {A} at the link frame, {B} at the COM
            return tensor_at_origin(mass, com, at_link) - at_com
        return at_link - at_com - forms[claim](mass, com)

    return [
        audited(claim, link=row.link, **_worst(partial(residual, claim=claim), row))
        for claim in (*forms, "equation_1.any_frame")
    ]


def _rotation(rows: tuple[InertialRow, ...], p: Alpha5Parameters) -> list[AuditRow]:
    """I_COM of links 1 to 4 carried from inertial frame {i} into the axes of DH frame {i}.

    Moments and products about the axes of {i} do not depend on the frame in which they are
    computed.
    """
    tensors = np.array([_read(si(_inputs(row)))[2] for row in rows])
    # Turns frame {i} into DH frame {i}; its transpose maps coordinates from {i} to DH {i}.
    turn = rotation_about((1, 0, 0), [row.alpha for row in p.dh[:4]])
    back = np.swapaxes(turn, 1, 2)
    found = []
    for name, one, other in (("rotation", turn, back), ("rotation_of_coordinates", back, turn)):
        miss = np.abs(turn @ (one @ tensors @ other) @ back - tensors).max()
        found.append(audited(f"equation_1.{name}", miss, bound=ARITHMETIC, link="1 to 4"))
    return found


def _implied_mass(row: InertialRow) -> AuditRow:
    implied = _mass(si(_inputs(row)))
    excess, bound = figure(lambda x: _mass(x) - x[0], _inputs(row))
    effect = abs(excess) * GRAVITY * float(np.linalg.norm(si(row.com)))
    return audited("implied_mass", implied, row.mass.si, bound, of=row, effect=effect)


def implied_mass(row: InertialRow) -> tuple[float, float]:
    """The mass [kg] that best carries I_COM to I_Link, and how far digits may move it."""
    return figure(_mass, _inputs(row))


def _mass(x: FloatArray) -> float:
    """The m that minimizes |I_Link - I_COM - m (P.P E - P P^T)|."""
    _, com, at_com, at_link = _read(x)
    term = point_mass_tensor(1.0, com)
    return float(np.sum(term * (at_link - at_com)) / np.sum(term * term))


def _total_mass(rows: tuple[InertialRow, ...]) -> AuditRow:
    inputs = [q for row in rows for q in _inputs(row)]
    implied = sum(_mass(si(_inputs(row))) for row in rows)

    def difference(x: FloatArray) -> float:
        return float(sum(_mass(y) - y[0] for y in x.reshape(len(rows), -1)))

    total = sum((row.mass.value for row in rows), start=Decimal(0))
    _, bound = figure(difference, inputs)
    return audited("total.mass", implied, float(total), bound, total=total)


def _possible(row: InertialRow, name: str) -> AuditRow:
    def smallest(x: FloatArray) -> float:
        mass, com, at_com, at_link = _read(x)
        tensor = at_com if name == "com" else tensor_at_com(mass, com, at_link)
        return float(principal_moments(second_moments(tensor))[0])

    value, bound = figure(smallest, _inputs(row))
    return audited(f"possible_{name}", value, bound=bound, of=row)


def _com_inside(row: InertialRow, bounds: FloatArray) -> AuditRow:
    value, bound = figure(lambda x: excess_of_box(x, bounds), row.com)
    return audited("com_inside", value, bound=bound, of=row)


def _mass_spread(row: InertialRow, bounds: FloatArray) -> AuditRow:
    """Along each axis the standard deviation of the mass is at most sqrt((max-c)(c-min))."""
    inputs = _inputs(row)

    def spread(x: FloatArray) -> FloatArray:
        """Standard deviation of the mass along each axis [m]; 0 where the tensor is impossible."""
        mass, _, at_com, _ = _read(x)
        return np.asarray(np.sqrt(np.maximum(np.diag(second_moments(at_com)) / mass, 0.0)))

    def excess(x: FloatArray) -> FloatArray:
        low, high = np.maximum(x[1:4] - bounds[:, 0], 0.0), np.maximum(bounds[:, 1] - x[1:4], 0.0)
        return np.asarray(spread(x) - np.sqrt(low * high))

    value, bound = excess(si(inputs)), rounding_bound(excess, inputs)
    k = int(np.argmax(value - bound))
    size = spread(si(inputs))[k]
    more = "; part of this mass turns inside the neighbour's housing" * bool(value[k] > bound[k])
    expected, axis = size - value[k], "xyz"[k]
    return audited("mass_spread", size, expected, bound[k], of=row, axis=axis, more=more)


def _jaw_plane(printed: Published) -> list[AuditRow]:
    """The plane through the wrist axis that holds the closed fingers, and how much they weigh."""
    row, jaws = printed.table_2.rows[4], printed.supplementary.jaws
    names = ("pivot_offset", "finger_volume", "second_finger_volume", "finger_density", "sdk_plane")
    *finger, sdk = (jaws[name].quantity for name in names)
    offset, *volumes, density = finger
    xx, yy, xy = row.inertia_com[0][0], row.inertia_com[1][1], row.inertia_com[0][1]

    def direction(x: FloatArray) -> float:
        """Of the greatest spread of mass, from x of {4} [rad]; products in the document's sign."""
        return float(np.arctan2(2 * x[2], x[1] - x[0]) / 2)

    def points(x: FloatArray) -> float:
        """I_yy - I_xx of two points of the fingers' masses at the pivots."""
        return float(x[0] ** 2 * (x[1] + x[2]) * x[3])

    angle, rounding = figure(direction, [xx, yy, xy])
    spread, digits = figure(lambda x: x[1] - x[0], [xx, yy])
    expected, bound = figure(points, finger)
    masses = (f"{1e3 * volume.si * density.si:.3g}" for volume in volumes)
    words: dict[str, Any] = {"offset": offset, "estimated": " and ".join(masses)}
    words["implied"] = f"{1e3 * spread / (2 * offset.si**2):.3g}"
    return [
        audited("jaw_plane.direction", angle, sdk.si, rounding + sdk.rounding),
        audited("jaw_plane.spread", spread, expected, bound + digits, **words),
    ]


def _cob_inside(row: BuoyancyRow, link: LinkParameters, corrected: LinkParameters) -> AuditRow:
    measured, bound = figure(partial(excess_of_box, bounds=link.bounds), row.cob)
    words: dict[str, Any] = {"cob": f"({', '.join(c.text for c in row.cob)})", "more": ""}
    effect = None
    if moved := float(np.linalg.norm(corrected.cob - si(row.cob))):
        effect = moved * SEA_WATER * row.volume.si * GRAVITY
        x, y, z = corrected.cob / MM
        side = "outside" if excess_of_box(corrected.cob, link.bounds) else "inside"
        words["more"] = (
            f"; read in link 1's frame, which holds the same kind of part, and carried to link 3's it "
            f"is ({x:.1f}, {y:.1f}, {z:.1f}) mm, {side}; the effect is the buoyancy at the distance "
            "between the two"
        )
    return audited("cob_inside", measured, bound=bound, of=row, effect=effect, **words)


def _density(inertial: InertialRow, row: BuoyancyRow) -> AuditRow:
    value, bound = figure(lambda x: x[0] / x[1], [inertial.mass, row.volume])
    heavy = value - bound > ALUMINIUM
    more = "; some of the mass sits in volume that the table counts elsewhere" * heavy
    return audited("density", value, ALUMINIUM, bound, of=row, mass=inertial.mass, more=more)


def _totals(printed: Published, p: Alpha5Parameters) -> list[AuditRow]:
    masses = [row.mass for row in printed.table_2.rows]
    volumes = [row.volume for row in printed.table_3.rows]

    def wet_weight(x: FloatArray) -> float:
        return float((x[:5].sum() - SEA_WATER * x[5:].sum()) * GRAVITY)

    volume, rounding = figure(np.sum, volumes)
    weight, bound = figure(wet_weight, [*masses, *volumes])
    boxes = sum(float(np.prod(np.diff(link.bounds))) for link in p.links)
    return [
        audited("total.volume", volume, boxes, rounding),
        audited("total.wet_weight", weight, bound=bound),
    ]
