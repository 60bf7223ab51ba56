"""Tables 2 and 3: tensors, equations, masses, centres, sizes and densities against each other.

References:
    [ReachAlpha] Manufacturer's document, Section 2.1, Table 2, equations (1) and (2), and Section
        2.2, Table 3.
    [Wensing2018], [Bhatia2000] See `alpha5_model.numbers.inertia`.
    [Aluminium] Density of aluminium, 2.70 kg/L: any handbook.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from decimal import Decimal
from functools import partial
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import cross_matrix, excess_of_box, rotation_about
from alpha5_model.numbers import inertia
from alpha5_model.numbers.fluids import GRAVITY, SEA_WATER
from alpha5_model.numbers.parameters import (
    Alpha5Parameters,
    LinkParameters,
    link_numbers,
)
from alpha5_model.numbers.tables import BuoyancyRow, InertialRow, Published, Triple
from alpha5_model.proofs.audit.row import ARITHMETIC, AuditRow, audited, figure, si

ALUMINIUM = 2700.0  # kg/m^3
G = -GRAVITY[2]  # m/s^2
#: Of mass [kg], P = COM (3,) [m], I_COM and I_Link (3, 3) [kg m^2] in URDF sign.
Formula = Callable[[float, FloatArray, FloatArray, FloatArray], Any]


def _less(term: Callable[[float, FloatArray], FloatArray]) -> Formula:
    """I_Link less I_COM and a term of mass and P."""
    return lambda m, p, com, link: link - com - term(m, p)


#: Claim about a row of Table 2 -> the tensor that vanishes if it is true.
RESIDUALS: dict[str, Formula] = {
    "parallel_axis": lambda m, p, com, link: link - inertia.tensor_at_origin(m, p, com),
    # The control: with the products read in URDF sign, the same must be out of bounds.
    "product_sign": lambda m, p, com, link: (
        inertia.flip_products(link)
        - inertia.tensor_at_origin(m, p, inertia.flip_products(com))
    ),
    "equation_1.printed": _less(
        lambda m, p: m * ((p @ p) * np.eye(3) - (p @ p).T * np.eye(3))
    ),
    "equation_1.corrected": _less(
        lambda m, p: m * ((p @ p) * np.eye(3) - np.outer(p, p))
    ),
    "equation_2.printed": _less(lambda m, p: m * cross_matrix(p) @ cross_matrix(p)),
    "equation_2.corrected": _less(lambda m, p: -m * cross_matrix(p) @ cross_matrix(p)),
    # {A} at the link frame, {B} at the COM
    "equation_1.any_frame": lambda m, p, com, link: (
        inertia.tensor_at_origin(m, p, link) - com
    ),
}
EQUATIONS = [claim for claim in RESIDUALS if claim.startswith("equation")]
#: Claim about a row of Table 2 -> the tensor about the COM that is that of a body.
TENSORS: dict[str, Formula] = {
    "possible_com": lambda m, p, com, link: com,
    "possible_link": lambda m, p, com, link: inertia.tensor_at_com(m, p, link),
}


def audit(printed: Published, p: Alpha5Parameters) -> list[AuditRow]:
    """The rows of Tables 2 and 3."""
    rows, waters = printed.table_2.rows, printed.table_3.rows
    fastest = max(joint.velocity for joint in p.joints[:4])
    boxes = [link.bounds for link in p.links]
    return [
        *(
            audited("parallel_axis", of=row, **_worst("parallel_axis", row))
            for row in rows
        ),
        *(_product_sign(row, fastest) for row in rows),
        # on the link with the longest lever
        *(
            audited(claim, link=rows[4].link, **_worst(claim, rows[4]))
            for claim in EQUATIONS
        ),
        *_rotation(p),
        *_masses(rows),
        *_missing_decimals(rows),
        *(_possible(claim, row) for row in rows for claim in TENSORS),
        *(_inside("com_inside", r, r.com, b) for r, b in zip(rows, boxes, strict=True)),
        *map(_mass_spread, rows, boxes),
        *_jaw_plane(printed),
        *map(_cob_inside, waters, p.links, link_numbers(printed, ("link3_cob",))),
        *map(_density, rows, waters),
        *_totals(printed, boxes),
    ]


def _of(row: InertialRow, formula: Formula) -> tuple[Any, Any]:
    """A formula by the numbers of a row of Table 2, and what the rounding of its digits allows."""
    tensors, upper = (row.inertia_com, row.inertia_link), np.triu_indices(3)

    def value(x: FloatArray) -> Any:
        read = np.zeros((2, 3, 3))
        read[:, *upper] = read[:, *upper[::-1]] = x[4:].reshape(2, 6)
        return formula(float(x[0]), x[1:4], *inertia.flip_products(read))

    entries = [t[i][j] for t in tensors for i, j in zip(*upper, strict=True)]
    return figure(value, [row.mass, *row.com, *entries])


def _worst(claim: str, row: InertialRow) -> dict[str, Any]:
    """The largest entry of the tensor, among those beyond their bound if there are any.

    Returns:
        For `audited`: its size, what rounding allows, its name, and how many of six are beyond.
    """
    value, bound = _of(row, RESIDUALS[claim])
    size = np.abs(value)
    beyond = size > bound
    i, j = divmod(
        int(np.argmax(np.where(beyond, size, 0.0) if beyond.any() else size)), 3
    )
    words = {"entry": "xyz"[i] + "xyz"[j], "beyond": beyond[np.triu_indices(3)].sum()}
    return {"measured": size[i, j], "bound": bound[i, j], **words}


def _product_sign(row: InertialRow, fastest: float) -> AuditRow:
    (_, xy, xz), (_, _, yz), _ = row.inertia_com
    effect = 2 * np.abs(si([xy, xz, yz])).max() * fastest**2
    worst = _worst("product_sign", row)
    return audited(
        "product_sign", worst["measured"], 0.0, worst["bound"], of=row, effect=effect
    )


def _rotation(p: Alpha5Parameters) -> list[AuditRow]:
    """I_COM of links 1 to 4 carried from inertial frame {i} into the axes of DH frame {i}.

    Moments and products about the axes of {i} do not depend on the frame in which they are
    computed.
    """
    tensors = np.array([link.inertia for link in p.links[1:]])
    # Turns frame {i} into DH frame {i}; its transpose maps coordinates from {i} to DH {i}.
    turn = rotation_about((1, 0, 0), [row.alpha for row in p.dh[:4]])
    back = np.swapaxes(turn, 1, 2)
    found = []
    for name, one, other in (
        ("rotation", turn, back),
        ("rotation_of_coordinates", back, turn),
    ):
        miss = np.abs(turn @ (one @ tensors @ other) @ back - tensors).max()
        found.append(audited(f"equation_1.{name}", miss, ARITHMETIC, link="1 to 4"))
    return found


def _mass(_: float, com: FloatArray, at_com: FloatArray, at_link: FloatArray) -> float:
    """The m that minimizes |I_Link - I_COM - m (P.P E - P P^T)|."""
    term = inertia.point_mass_tensor(1.0, com)
    return float(np.sum(term * (at_link - at_com)) / np.sum(term * term))


def implied_mass(row: InertialRow) -> tuple[float, float]:
    """The mass [kg] that best carries I_COM to I_Link, and how far digits may move it."""
    return _of(row, _mass)


def _masses(rows: tuple[InertialRow, ...]) -> list[AuditRow]:
    found, total = [], sum((row.mass.value for row in rows), start=Decimal(0))
    for row in rows:
        implied = implied_mass(row)[0]
        excess, bound = _of(row, lambda m, *numbers: _mass(m, *numbers) - m)
        effect = abs(excess) * G * float(np.linalg.norm(si(row.com)))
        found.append(
            audited("implied_mass", implied, bound, row.mass.si, of=row, effect=effect)
        )
    implied, bound = (
        sum(getattr(row, key) for row in found) for key in ("measured", "bound")
    )
    return [*found, audited("total.mass", implied, bound, float(total), total=total)]


def _missing_decimals(rows: tuple[InertialRow, ...]) -> list[AuditRow]:
    """Masses with fewer decimals than those of the other links."""
    decimals = [len(row.mass.text.partition(".")[2]) for row in rows]
    usual = max(decimals)

    found = []
    for row, own in zip(rows, decimals, strict=True):
        if own == usual:
            continue
        finer = replace(row.mass, text=f"{row.mass.value:.{usual}f}")
        implied, rounding = implied_mass(row)
        lever = float(np.linalg.norm(si(row.com)))
        words: dict[str, Any] = {
            "usual": usual,
            "finer": finer,
            "implied": implied,
            "rounding": rounding,
            "effect": (row.mass.rounding - finer.rounding) * G * lever,
        }
        found.append(audited("printed_digits", own, expected=usual, of=row, **words))
    return found


def _possible(claim: str, row: InertialRow) -> AuditRow:
    def smallest(*numbers: Any) -> Any:
        return inertia.principal_moments(
            inertia.second_moments(TENSORS[claim](*numbers))
        )[0]

    return audited(claim, *_of(row, smallest), of=row)


def _mass_spread(row: InertialRow, bounds: FloatArray) -> AuditRow:
    """Along each axis the standard deviation of the mass is at most sqrt((max-c)(c-min))."""

    def spread(
        mass: float, com: FloatArray, at_com: FloatArray, _: FloatArray
    ) -> FloatArray:
        """Along each axis [m], 0 where the tensor is impossible; and how much that is too much."""
        size = np.sqrt(np.maximum(np.diag(inertia.second_moments(at_com)) / mass, 0.0))
        room = np.maximum([com - bounds[:, 0], bounds[:, 1] - com], 0.0)
        return np.array([size, size - np.sqrt(room.prod(axis=0))])

    (size, excess), (_, bound) = _of(row, spread)
    k = int(np.argmax(excess - bound))
    words: dict[str, Any] = {"axis": "xyz"[k], "more": excess[k] > bound[k]}
    return audited(
        "mass_spread", size[k], bound[k], size[k] - excess[k], of=row, **words
    )


def _jaw_plane(printed: Published) -> list[AuditRow]:
    """The plane through the wrist axis that holds the closed fingers, and how much they weigh."""
    jaws = printed.supplementary.jaws
    names = ("pivot_offset", "finger_density", "finger_volume", "second_finger_volume")
    finger, sdk = [jaws[name].quantity for name in names], jaws["sdk_plane"].quantity
    (xx, xy, _), (_, yy, _), _ = printed.table_2.rows[4].inertia_com
    # Of the greatest spread of mass, from x of {4}; products in the document's sign.
    angle, rounding = figure(
        lambda x: np.arctan2(2 * x[2], x[1] - x[0]) / 2, [xx, yy, xy]
    )
    spread, digits = figure(lambda x: x[1] - x[0], [xx, yy])
    # I_yy - I_xx of two points of the fingers' masses at the pivots
    expected, bound = figure(lambda x: x[0] ** 2 * x[1] * (x[2] + x[3]), finger)
    offset, density, *volumes = si(finger)
    words: dict[str, Any] = {
        "offset": finger[0],
        "implied": 1e3 * spread / (2 * offset**2),
    }
    words["first"], words["second"] = (1e3 * volume * density for volume in volumes)
    direction = audited("jaw_plane.direction", angle, rounding + sdk.rounding, sdk.si)
    return [
        direction,
        audited("jaw_plane.spread", spread, bound + digits, expected, **words),
    ]


def _inside(
    claim: str, row: Any, point: Triple, bounds: FloatArray, **words: Any
) -> AuditRow:
    """How far a row's point is from the body's bounds."""
    outside = figure(partial(excess_of_box, bounds=bounds), point)
    return audited(claim, *outside, of=row, **words)


def _cob_inside(
    row: BuoyancyRow, link: LinkParameters, corrected: dict[str, Any]
) -> AuditRow:
    words: dict[str, Any] = {}
    cob = corrected["cob"]
    if moved := float(np.linalg.norm(cob - si(row.cob))):
        words["side"] = "outside" if excess_of_box(cob, link.bounds) else "inside"
        words["effect"] = moved * SEA_WATER * row.volume.si * G
        words["there"] = 1e3 * cob
    return _inside("cob_inside", row, row.cob, link.bounds, more=moved > 0, **words)


def _density(inertial: InertialRow, row: BuoyancyRow) -> AuditRow:
    value, bound = figure(lambda x: x[0] / x[1], [inertial.mass, row.volume])
    words: dict[str, Any] = {"mass": inertial.mass, "more": value - bound > ALUMINIUM}
    return audited("density", value, bound, ALUMINIUM, of=row, **words)


def _totals(printed: Published, boxes: list[FloatArray]) -> list[AuditRow]:
    masses = [row.mass for row in printed.table_2.rows]
    volumes = [row.volume for row in printed.table_3.rows]
    weight = figure(
        lambda x: (x[:5].sum() - SEA_WATER * x[5:].sum()) * G, [*masses, *volumes]
    )
    whole = sum(float(np.prod(np.diff(bounds))) for bounds in boxes)
    volume = audited("total.volume", *figure(np.sum, volumes), whole)
    return [volume, audited("total.wet_weight", *weight)]
