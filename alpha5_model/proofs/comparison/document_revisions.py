"""Tables 2 and 3 of two revisions of the document, in SI units.

Version 7, and the earlier revision whose numbers public models carry
(``numbers/earlier_revision.toml``; supplementary, we have not seen its document). The
model itself uses version 7 only.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers.inertia import flip_products
from alpha5_model.numbers.parameters import in_si
from alpha5_model.numbers.printed import earlier_revision, published
from alpha5_model.numbers.tables import BuoyancyRow, EarlierRow, InertialRow


@dataclass(frozen=True, eq=False)
class Revision:
    """Tables 2 and 3 of one revision in SI units, base to tip.

    Attributes:
        numbers: What its numbers are called, such as "Table 2's numbers".
        mass: (5,) [kg].
        com: Centres of mass, (5, 3) [m].
        inertia: At the COM, URDF sign, (5, 3, 3) [kg m^2].
        inertia_link: At the origin of the link frame, URDF sign, (5, 3, 3) [kg m^2].
        volume: (5,) [m^3].
        cob: Centres of buoyancy, (5, 3) [m].
    """

    numbers: str
    mass: FloatArray
    com: FloatArray
    inertia: FloatArray
    inertia_link: FloatArray
    volume: FloatArray
    cob: FloatArray


@cache
def revisions() -> tuple[Revision, Revision]:
    """Version 7, then the earlier revision."""
    document = published()
    earlier = earlier_revision()
    return (
        _revision(
            numbers="Table 2's numbers",
            inertial=document.table_2.rows,
            buoyancy=document.table_3.rows,
        ),
        _revision(
            numbers="an earlier revision's numbers",
            inertial=earlier,
            buoyancy=earlier,
        ),
    )


def _revision(
    *,
    numbers: str,
    inertial: Sequence[InertialRow],
    buoyancy: Sequence[BuoyancyRow | EarlierRow],
) -> Revision:
    """The revision of the printed rows of its two tables."""
    at_com = _column(inertial, "inertia_com")
    at_link = _column(inertial, "inertia_link")
    return Revision(
        numbers=numbers,
        mass=_column(inertial, "mass"),
        com=_column(inertial, "com"),
        inertia=flip_products(at_com),
        inertia_link=flip_products(at_link),
        volume=_column(buoyancy, "volume"),
        cob=_column(buoyancy, "cob"),
    )


def _column(rows: Sequence[Any], name: str) -> FloatArray:
    """A column of printed rows in SI units, (5, ...)."""
    return np.array([in_si(getattr(row, name)) for row in rows])
