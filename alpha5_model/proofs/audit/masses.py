"""Masses, densities and totals of Tables 2 and 3.

References:
    [ReachAlpha] Manufacturer's document, Section 2.1, Table 2, and Section 2.2, Table
        3.
    [Aluminium] Density of aluminium, 2.70 kg/L: any handbook.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from decimal import Decimal

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers import inertia
from alpha5_model.numbers.fluids import GRAVITY, SEA_WATER
from alpha5_model.numbers.tables import BuoyancyRow, InertialRow, Published
from alpha5_model.proofs.audit.rounding import Figure, figure, si
from alpha5_model.proofs.audit.row import AuditRow, audited
from alpha5_model.proofs.audit.tensors import Body, of_row

ALUMINIUM = 2700.0  # kg/m^3
G = -GRAVITY[2]  # m/s^2


def _mass(body: Body) -> float:
    """The mass m that minimizes |I_Link - I_COM - m (P.P E - P P^T)| [kg]."""
    per_mass = inertia.point_mass_tensor(1.0, body.com)
    difference = body.at_link - body.at_com
    return float(np.sum(per_mass * difference) / np.sum(per_mass * per_mass))


def implied_mass(row: InertialRow) -> Figure:
    """The mass [kg] that fits I_COM and I_Link best, and what rounding allows."""
    return of_row(row, _mass)


def implied_masses(rows: Sequence[InertialRow]) -> list[AuditRow]:
    """The printed masses against those that the tensors imply, and their sums."""
    found = [_implied_mass_row(row) for row in rows]
    total = sum((row.mass.value for row in rows), start=Decimal(0))
    total_row = audited(
        "total.mass",
        measured=sum(row.measured for row in found),
        bound=sum(row.bound for row in found),
        expected=float(total),
        total=total,
    )
    return [*found, total_row]


def _implied_mass_row(row: InertialRow) -> AuditRow:
    excess = of_row(row, lambda body: _mass(body) - body.mass)
    lever = float(np.linalg.norm(si(row.com)))
    return audited(
        "implied_mass",
        measured=implied_mass(row).value,
        bound=excess.bound,
        expected=row.mass.si,
        of=row,
        effect=abs(excess.value) * G * lever,
        more=abs(excess.value) > excess.bound,
    )


def missing_decimals(rows: Sequence[InertialRow]) -> list[AuditRow]:
    """Masses with fewer decimals than those of the other links."""
    decimals = [len(row.mass.text.partition(".")[2]) for row in rows]
    usual = max(decimals)
    return [
        _missing_decimals_row(row, own, usual)
        for row, own in zip(rows, decimals, strict=True)
        if own != usual
    ]


def _missing_decimals_row(row: InertialRow, own: int, usual: int) -> AuditRow:
    finer = replace(row.mass, text=f"{row.mass.value:.{usual}f}")
    implied = implied_mass(row)
    lever = float(np.linalg.norm(si(row.com)))
    return audited(
        "printed_digits",
        measured=own,
        expected=usual,
        of=row,
        effect=(row.mass.rounding - finer.rounding) * G * lever,
        usual=usual,
        finer=finer,
        implied=implied.value,
        rounding=implied.bound,
    )


def density(inertial: InertialRow, row: BuoyancyRow) -> AuditRow:
    """A link's density, with a remark if it exceeds that of aluminium."""
    found = figure(lambda x: x[0] / x[1], [inertial.mass, row.volume])
    return audited(
        "density",
        measured=found.value,
        bound=found.bound,
        expected=ALUMINIUM,
        of=row,
        more=found.value - found.bound > ALUMINIUM,
        mass=inertial.mass,
    )


def totals(printed: Published, boxes: Sequence[FloatArray]) -> list[AuditRow]:
    """Volume of all links against that of their bounds, and their weight in water."""
    masses = [row.mass for row in printed.table_2.rows]
    volumes = [row.volume for row in printed.table_3.rows]

    def wet_weight(x: FloatArray) -> float:
        mass = x[:5].sum()
        displaced = SEA_WATER * x[5:].sum()
        return float((mass - displaced) * G)

    volume = figure(np.sum, volumes)
    whole = sum(float(np.prod(np.diff(box))) for box in boxes)
    weight = figure(wet_weight, [*masses, *volumes])
    return [
        audited(
            "total.volume", measured=volume.value, bound=volume.bound, expected=whole
        ),
        audited("total.wet_weight", measured=weight.value, bound=weight.bound),
    ]
