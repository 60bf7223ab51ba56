"""Tables 2 and 3: tensors, masses, centres, sizes and densities against each other.

References:
    [ReachAlpha] Manufacturer's document, Section 2.1, Table 2, equations (1) and (2),
        and Section 2.2, Table 3.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import excess_of_box
from alpha5_model.numbers import inertia
from alpha5_model.numbers.fluids import SEA_WATER
from alpha5_model.numbers.parameters import (
    Alpha5Parameters,
    LinkParameters,
    link_numbers,
)
from alpha5_model.numbers.tables import BuoyancyRow, InertialRow, Published
from alpha5_model.proofs.audit import masses, tensors
from alpha5_model.proofs.audit.masses import G
from alpha5_model.proofs.audit.rounding import figure, si
from alpha5_model.proofs.audit.row import AuditRow, audited
from alpha5_model.proofs.audit.tensors import Body


def audit(printed: Published, parameters: Alpha5Parameters) -> list[AuditRow]:
    """The rows of Tables 2 and 3."""
    rows = printed.table_2.rows
    waters = printed.table_3.rows
    boxes = [link.bounds for link in parameters.links]
    fastest = max(joint.velocity for joint in parameters.joints[:4])
    # The link with the longest lever shows most of equations (1) and (2).
    longest = rows[4]
    return [
        *(tensors.parallel_axis(row, fastest) for row in rows),
        *(tensors.product_sign(row, fastest) for row in rows),
        *(tensors.equation(claim, longest) for claim in tensors.EQUATIONS),
        *tensors.rotation(parameters),
        *masses.implied_masses(rows),
        *masses.missing_decimals(rows),
        *(tensors.possible(claim, row) for row in rows for claim in tensors.TENSORS),
        *map(_com_inside, rows, boxes),
        *map(_mass_spread, rows, boxes),
        *_jaw_plane(printed),
        *_cobs_inside(printed, parameters),
        *map(masses.density, rows, waters),
        *masses.totals(printed, boxes),
    ]


def _com_inside(row: InertialRow, bounds: FloatArray) -> AuditRow:
    """How far the COM is from the body's bounds."""
    outside = figure(partial(excess_of_box, bounds=bounds), row.com)
    return audited("com_inside", measured=outside.value, bound=outside.bound, of=row)


def _cobs_inside(printed: Published, parameters: Alpha5Parameters) -> list[AuditRow]:
    rows = printed.table_3.rows
    corrected = link_numbers(printed, ("link3_cob",))
    cobs = [numbers["cob"] for numbers in corrected]
    return list(map(_cob_inside, rows, parameters.links, cobs))


def _cob_inside(
    row: BuoyancyRow, link: LinkParameters, corrected: FloatArray
) -> AuditRow:
    """How far the centre of buoyancy is from the body's bounds.

    Args:
        corrected: The centre after the correction `link3_cob`, which moves that of
            link 3 only, (3,) [m].
    """
    outside = figure(partial(excess_of_box, bounds=link.bounds), row.cob)
    moved = float(np.linalg.norm(corrected - si(row.cob)))
    words: dict[str, Any] = {}
    if moved:
        words = {
            "side": "outside" if excess_of_box(corrected, link.bounds) else "inside",
            "effect": moved * SEA_WATER * row.volume.si * G,
            "there": 1e3 * corrected,
        }
    return audited(
        "cob_inside",
        measured=outside.value,
        bound=outside.bound,
        of=row,
        more=moved > 0,
        **words,
    )


def _mass_spread(row: InertialRow, bounds: FloatArray) -> AuditRow:
    """Whether the mass is spread no farther than the body's bounds allow.

    Along each axis its standard deviation is at most sqrt((max - c) (c - min)).
    """

    def spread(body: Body) -> FloatArray:
        """Standard deviation along each axis and its excess, (2, 3) [m].

        The deviation is 0 if the tensor is impossible.
        """
        moments = np.diag(inertia.second_moments(body.at_com))
        deviation = np.sqrt(np.maximum(moments / body.mass, 0.0))
        below = body.com - bounds[:, 0]
        above = bounds[:, 1] - body.com
        room = np.maximum([below, above], 0.0)
        return np.array([deviation, deviation - np.sqrt(room.prod(axis=0))])

    found = tensors.of_row(row, spread)
    deviation, excess = found.value
    _, bound = found.bound
    worst = int(np.argmax(excess - bound))
    return audited(
        "mass_spread",
        measured=deviation[worst],
        bound=bound[worst],
        expected=deviation[worst] - excess[worst],
        of=row,
        more=excess[worst] > bound[worst],
        axis="xyz"[worst],
    )


def _jaw_plane(printed: Published) -> list[AuditRow]:
    """Plane and mass of the closed fingers, from the tensor about the wrist axis."""
    jaws = printed.supplementary.jaws
    names = ("pivot_offset", "finger_density", "finger_volume", "second_finger_volume")
    fingers = [jaws[name].quantity for name in names]
    (xx, xy, _), (_, yy, _), _ = printed.table_2.rows[4].inertia_com

    # The direction of the greatest spread of mass, from x of {4}. The products of
    # inertia have the document's sign.
    direction = figure(lambda x: np.arctan2(2 * x[2], x[1] - x[0]) / 2, [xx, yy, xy])
    printed_plane = jaws["sdk_plane"].quantity
    direction_row = audited(
        "jaw_plane.direction",
        measured=direction.value,
        bound=direction.bound + printed_plane.rounding,
        expected=printed_plane.si,
        apart=np.degrees(printed_plane.si - direction.value),
    )

    spread = figure(lambda x: x[1] - x[0], [xx, yy])
    # I_yy - I_xx of two point masses at the pivots, with the masses of the fingers.
    points = figure(lambda x: x[0] ** 2 * x[1] * (x[2] + x[3]), fingers)
    offset, density, first_volume, second_volume = si(fingers)
    spread_row = audited(
        "jaw_plane.spread",
        measured=spread.value,
        bound=points.bound + spread.bound,
        expected=points.value,
        offset=fingers[0],
        implied=1e3 * spread.value / (2 * offset**2),
        first=1e3 * first_volume * density,
        second=1e3 * second_volume * density,
    )
    return [direction_row, spread_row]
