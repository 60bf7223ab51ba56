"""Table 3 against the bodies and against Table 2: centres, densities, totals.

References:
    [ReachAlpha] Manufacturer's document, Section 2.2, Table 3.
    [Aluminium] Density of aluminium, 2.70 kg/L: any handbook.
"""

from __future__ import annotations

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.consistency.row import AuditRow, judged, rounding_bound
from alpha5_model.consistency.units import GRAVITY, LITRE, MM, excess_of_box
from alpha5_model.fluids import SEA_WATER
from alpha5_model.parameters import Alpha5Parameters, LinkParameters, convert
from alpha5_model.published.tables import BuoyancyRow, InertialRow, Published

ALUMINIUM = 2.70  # kg/L


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

    cob = np.array([c.si for c in row.cob])
    measured, bound = excess(cob), float(rounding_bound(excess, row.cob))
    moved = float(np.linalg.norm(corrected.cob - cob))
    weight = SEA_WATER * row.volume.si * GRAVITY
    finding = "distance of the COB from the body's outer bounds, 0 inside"
    if moved:
        x, y, z = corrected.cob / MM
        finding += (
            f"; read in link 1's frame, which holds the same kind of part, and carried to link 3's it "
            f"is ({x:.1f}, {y:.1f}, {z:.1f}) mm, "
            f"{'inside' if excess(corrected.cob) == 0 else 'outside'}; the effect is the buoyancy "
            "at the distance between the two"
        )
    return judged(
        f"cob_inside.link_{row.link}",
        f"Section 2.2, Table 3, link {row.link}",
        f"COB ({', '.join(c.text for c in row.cob)}) mm",
        measured / MM,
        "<=",
        0.0,
        bound / MM,
        "mm",
        finding,
        law=True,
        effect=moved * weight if moved else None,
        effect_unit="N m" if moved else "",
    )


def _density(inertial: InertialRow, row: BuoyancyRow) -> AuditRow:
    inputs = [inertial.mass, row.volume]

    def density(x: FloatArray) -> float:
        return float(x[0] / x[1])

    value = density(np.array([q.si for q in inputs]))
    bound = float(rounding_bound(density, inputs))
    heavy = (value - bound) * LITRE > ALUMINIUM
    return judged(
        f"density.link_{row.link}",
        f"Tables 2 and 3, link {row.link}",
        f"{inertial.mass} in {row.volume}",
        value * LITRE,
        "<=",
        ALUMINIUM,
        bound * LITRE,
        "kg/L",
        "mean density against solid aluminium's"
        + ("; some of the mass sits in volume that the table counts elsewhere" if heavy else ""),
        kind="observation",
    )


def _volume_fits(printed: Published, p: Alpha5Parameters) -> AuditRow:
    volumes = [row.volume for row in printed.table_3.rows]
    boxes = sum(float(np.prod(np.diff(link.bounds))) for link in p.links)
    return judged(
        "total.volume",
        "Section 2.2, Table 3, volume",
        "the volumes are those of the five bodies",
        sum(v.si for v in volumes) / LITRE,
        "<=",
        boxes / LITRE,
        float(rounding_bound(lambda x: float(x.sum()), volumes)) / LITRE,
        "L",
        "sum of the volumes against that of the bodies' bounding boxes",
        law=True,
    )


def _sinks(printed: Published) -> AuditRow:
    masses = [row.mass for row in printed.table_2.rows]
    volumes = [row.volume for row in printed.table_3.rows]

    def wet(x: FloatArray) -> float:
        return float((x[:5].sum() - SEA_WATER * x[5:].sum()) * GRAVITY)

    inputs = [*masses, *volumes]
    return judged(
        "total.wet_weight",
        "Tables 2 and 3",
        "the arm is heavier than the sea water it displaces",
        wet(np.array([q.si for q in inputs])),
        ">=",
        0.0,
        float(rounding_bound(wet, inputs)),
        "N",
        "weight less buoyancy of all five links in sea water",
        kind="observation",
    )
