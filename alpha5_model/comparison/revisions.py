"""The two sets of tables that models of this arm are made from, as arrays.

Version 7 of the document, and the earlier revision whose numbers public models carry
(``published/earlier_revision.toml``; supplementary, no document seen). The model itself knows
version 7 only.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.inertia import flip_products
from alpha5_model.published import published
from alpha5_model.published.reading import earlier_revision
from alpha5_model.published.tables import BuoyancyRow, EarlierRow, InertialRow


@dataclass(frozen=True, eq=False)
class Revision:
    """Tables 2 and 3 of one revision in SI units, base to tip.

    Attributes:
        numbers: What its numbers are called, "Table 2's numbers".
        mass: (5,) [kg].
        com, cob: Centres of mass and of buoyancy, (5, 3) [m].
        inertia: At the COM, URDF sign, (5, 3, 3) [kg m^2].
        inertia_link: At the origin of the link frame, URDF sign, (5, 3, 3) [kg m^2].
        volume: (5,) [m^3].
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
    document, earlier = published(), earlier_revision()
    return (
        _revision("Table 2's numbers", document.table_2.rows, document.table_3.rows),
        _revision("an earlier revision's numbers", earlier, earlier),
    )


def _revision(
    numbers: str, inertial: Iterable[InertialRow], buoyancy: Iterable[BuoyancyRow | EarlierRow]
) -> Revision:
    def column(rows: Iterable[Any], name: str) -> FloatArray:
        return np.array([_si(getattr(row, name)) for row in rows])

    return Revision(
        numbers=numbers,
        mass=column(inertial, "mass"),
        com=column(inertial, "com"),
        inertia=flip_products(column(inertial, "inertia_com")),
        inertia_link=flip_products(column(inertial, "inertia_link")),
        volume=column(buoyancy, "volume"),
        cob=column(buoyancy, "cob"),
    )


def _si(value: Any) -> Any:
    return [_si(part) for part in value] if isinstance(value, tuple) else value.si
