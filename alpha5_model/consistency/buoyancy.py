"""Table 3 against the bodies and against Table 2: centres, densities, totals.

References:
    [ReachAlpha] Manufacturer's document, Section 2.2, Table 3.
    [Aluminium] Density of aluminium, 2.70 kg/L: any handbook.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.consistency.row import AuditRow, audited, figure
from alpha5_model.consistency.units import GRAVITY, MM, excess_of_box
from alpha5_model.fluids import SEA_WATER
from alpha5_model.parameters import Alpha5Parameters, LinkParameters, convert
from alpha5_model.published.tables import BuoyancyRow, InertialRow, Published

ALUMINIUM = 2700.0  # kg/m^3


def audit(printed: Published, p: Alpha5Parameters) -> list[AuditRow]:
    """The rows of Table 3."""
    corrected = convert(printed, ("link3_cob",)).links
    links = list(zip(printed.table_3.rows, p.links, corrected, strict=True))
    pairs = list(zip(printed.table_2.rows, printed.table_3.rows, strict=True))
    return [
        *(_cob_inside(row, link, other) for row, link, other in links),
        *(_density(inertial, row) for inertial, row in pairs),
        _volume_fits(printed, p),
        _sinks(printed),
    ]


def _cob_inside(row: BuoyancyRow, link: LinkParameters, corrected: LinkParameters) -> AuditRow:
    def excess(x: FloatArray) -> float:
        return excess_of_box(x, link.bounds)

    measured, bound = figure(excess, row.cob)
    moved = float(np.linalg.norm(corrected.cob - [c.si for c in row.cob]))
    more = ""
    if moved:
        x, y, z = corrected.cob / MM
        more = (
            f"; read in link 1's frame, which holds the same kind of part, and carried to link 3's it "
            f"is ({x:.1f}, {y:.1f}, {z:.1f}) mm, "
            f"{'inside' if excess(corrected.cob) == 0 else 'outside'}; the effect is the buoyancy "
            "at the distance between the two"
        )
    return audited(
        f"cob_inside.link_{row.link}",
        measured,
        bound=bound,
        effect=moved * SEA_WATER * row.volume.si * GRAVITY if moved else None,
        link=row.link,
        cob=f"({', '.join(c.text for c in row.cob)})",
        more=more,
    )


def _density(inertial: InertialRow, row: BuoyancyRow) -> AuditRow:
    value, bound = figure(lambda x: x[0] / x[1], [inertial.mass, row.volume])
    heavy = value - bound > ALUMINIUM
    more = "; some of the mass sits in volume that the table counts elsewhere" if heavy else ""
    words: dict[str, Any] = {
        "link": row.link,
        "mass": inertial.mass,
        "volume": row.volume,
        "more": more,
    }
    return audited(f"density.link_{row.link}", value, ALUMINIUM, bound, **words)


def _volume_fits(printed: Published, p: Alpha5Parameters) -> AuditRow:
    value, bound = figure(lambda x: x.sum(), [row.volume for row in printed.table_3.rows])
    boxes = sum(float(np.prod(np.diff(link.bounds))) for link in p.links)
    return audited("total.volume", value, boxes, bound)


def _sinks(printed: Published) -> AuditRow:
    masses = [row.mass for row in printed.table_2.rows]
    volumes = [row.volume for row in printed.table_3.rows]
    value, bound = figure(
        lambda x: (x[:5].sum() - SEA_WATER * x[5:].sum()) * GRAVITY, [*masses, *volumes]
    )
    return audited("total.wet_weight", value, bound=bound)
