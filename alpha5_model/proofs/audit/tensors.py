"""The tensors of Table 2 against each other, and against equations (1) and (2).

References:
    [ReachAlpha] Manufacturer's document, Section 2.1, Table 2, equations (1) and (2).
    [Wensing2018], [Bhatia2000] See `alpha5_model.numbers.inertia`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import cross_matrix, rotation_about
from alpha5_model.numbers import inertia
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.tables import InertialRow
from alpha5_model.proofs.audit.rounding import Figure, figure, si
from alpha5_model.proofs.audit.row import PER_SI, AuditRow, audited


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


Formula = Callable[[Body], Any]


def of_row(row: InertialRow, formula: Formula) -> Figure:
    """A formula of the numbers in a row of Table 2, and what rounding allows."""
    upper = np.triu_indices(3)
    entries = [
        tensor[i][j]
        for tensor in (row.inertia_com, row.inertia_link)
        for i, j in zip(*upper, strict=True)
    ]

    def value(numbers: FloatArray) -> Any:
        rows, columns = upper
        printed = np.zeros((2, 3, 3))
        printed[:, rows, columns] = numbers[4:].reshape(2, 6)
        printed[:, columns, rows] = numbers[4:].reshape(2, 6)
        at_com, at_link = inertia.flip_products(printed)
        body = Body(
            mass=float(numbers[0]), com=numbers[1:4], at_com=at_com, at_link=at_link
        )
        return formula(body)

    return figure(value, [row.mass, *row.com, *entries])


# --- what vanishes if a claim is true
# ------------------------------------------------------


def _parallel_axis(body: Body) -> FloatArray:
    moved = inertia.tensor_at_origin(body.mass, body.com, body.at_com)
    return body.at_link - moved


def _product_sign_read(body: Body) -> FloatArray:
    """The control: with products of inertia in URDF's sign it does not vanish."""
    at_com = inertia.flip_products(body.at_com)
    moved = inertia.tensor_at_origin(body.mass, body.com, at_com)
    return inertia.flip_products(body.at_link) - moved


def _equation_1_printed(body: Body) -> FloatArray:
    p = body.com
    term = body.mass * ((p @ p) * np.eye(3) - (p @ p).T * np.eye(3))
    return body.at_link - body.at_com - term


def _equation_1_corrected(body: Body) -> FloatArray:
    p = body.com
    term = body.mass * ((p @ p) * np.eye(3) - np.outer(p, p))
    return body.at_link - body.at_com - term


def _equation_2_printed(body: Body) -> FloatArray:
    term = body.mass * cross_matrix(body.com) @ cross_matrix(body.com)
    return body.at_link - body.at_com - term


def _equation_2_corrected(body: Body) -> FloatArray:
    term = -body.mass * cross_matrix(body.com) @ cross_matrix(body.com)
    return body.at_link - body.at_com - term


def _equation_1_any_frame(body: Body) -> FloatArray:
    """With {A} at the link frame and {B} at the COM."""
    return inertia.tensor_at_origin(body.mass, body.com, body.at_link) - body.at_com


#: Claim about a row of Table 2 -> the tensor that vanishes if it is true.
RESIDUALS: dict[str, Formula] = {
    "parallel_axis": _parallel_axis,
    "product_sign": _product_sign_read,
    "equation_1.printed": _equation_1_printed,
    "equation_1.corrected": _equation_1_corrected,
    "equation_2.printed": _equation_2_printed,
    "equation_2.corrected": _equation_2_corrected,
    "equation_1.any_frame": _equation_1_any_frame,
}
EQUATIONS = [claim for claim in RESIDUALS if claim.startswith("equation")]


class _Entry(NamedTuple):
    """An entry of a tensor that should vanish.

    Attributes:
        size: Its magnitude.
        bound: What rounding allows.
        name: ``xx`` to ``zz``.
        beyond: How many of the tensor's six entries are beyond their bounds.
    """

    size: float
    bound: float
    name: str
    beyond: int


def _worst(claim: str, row: InertialRow) -> _Entry:
    """The largest entry, among those beyond their bounds if there are any."""
    residual = of_row(row, RESIDUALS[claim])
    size = np.abs(residual.value)
    beyond = size > residual.bound
    candidates = np.where(beyond, size, 0.0) if beyond.any() else size
    i, j = divmod(int(np.argmax(candidates)), 3)
    return _Entry(
        size=size[i, j],
        bound=residual.bound[i, j],
        name="xyz"[i] + "xyz"[j],
        beyond=beyond[np.triu_indices(3)].sum(),
    )


def parallel_axis(row: InertialRow, fastest: float) -> AuditRow:
    """Whether I_Link is I_COM moved to the link frame.

    Args:
        fastest: The highest joint velocity [rad/s].
    """
    worst = _worst("parallel_axis", row)
    return audited(
        "parallel_axis",
        measured=worst.size,
        bound=worst.bound,
        of=row,
        effect=worst.size * fastest**2,
        entry=worst.name,
        beyond=worst.beyond,
    )


def equation(claim: str, row: InertialRow) -> AuditRow:
    """Whether a form of equation (1) or (2) carries I_COM to I_Link."""
    worst = _worst(claim, row)
    return audited(
        claim,
        measured=worst.size,
        bound=worst.bound,
        link=row.link,
        entry=worst.name,
        beyond=worst.beyond,
        size=worst.size * PER_SI["kg mm^2"],
    )


def product_sign(row: InertialRow, fastest: float) -> AuditRow:
    """The error of reading the products of inertia in URDF's sign.

    Args:
        fastest: The highest joint velocity [rad/s].
    """
    (_, xy, xz), (_, _, yz), _ = row.inertia_com
    largest = np.abs(si([xy, xz, yz])).max()
    worst = _worst("product_sign", row)
    return audited(
        "product_sign",
        measured=worst.size,
        expected=worst.bound,
        of=row,
        effect=2 * largest * fastest**2,
    )


def rotation(parameters: Alpha5Parameters) -> list[AuditRow]:
    """Rotation of I_COM of links 1 to 4 from inertial frame {i} to DH frame {i}.

    A tensor that is computed in the axes of the DH frame and carried back must be the
    printed one.
    """
    tensors = np.array([link.inertia for link in parameters.links[1:]])
    # Turns frame {i} into DH frame {i}; its transpose maps coordinates from {i} to DH
    # {i}.
    turn = rotation_about((1, 0, 0), [row.alpha for row in parameters.dh[:4]])
    back = np.swapaxes(turn, 1, 2)

    turned = turn @ (turn @ tensors @ back) @ back
    mapped = turn @ (back @ tensors @ turn) @ back
    return [
        _rotation_row("rotation", turned - tensors),
        _rotation_row("rotation_of_coordinates", mapped - tensors),
    ]


def _rotation_row(name: str, difference: FloatArray) -> AuditRow:
    largest = np.abs(difference).max()
    return audited(
        f"equation_1.{name}",
        measured=largest,
        bound=None,
        link="1 to 4",
        size=largest * PER_SI["kg mm^2"],
    )


# --- tensors that a body can have
# --------------------------------------------------------------


def _read_at_com(body: Body) -> FloatArray:
    return body.at_com


def _read_at_link(body: Body) -> FloatArray:
    return inertia.tensor_at_com(body.mass, body.com, body.at_link)


#: Claim about a row of Table 2 -> the tensor about the COM that must be that of a body.
TENSORS: dict[str, Formula] = {
    "possible_com": _read_at_com,
    "possible_link": _read_at_link,
}


def possible(claim: str, row: InertialRow) -> AuditRow:
    """The smallest principal second moment of a tensor; no body has one below 0."""

    def smallest(body: Body) -> Any:
        moments = inertia.second_moments(TENSORS[claim](body))
        return inertia.principal_moments(moments)[0]

    found = of_row(row, smallest)
    return audited(claim, measured=found.value, bound=found.bound, of=row)
