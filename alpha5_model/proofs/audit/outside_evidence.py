"""Table 4 against public drivers of real arms: evidence from outside the documents.

A driver's numbers come without a report of their measurement. So a difference is not
counted as an error of the document, and the model takes none of them.

References:
    [ReachAlpha] Manufacturer's document, Section 2.2.1, Table 4.
"""

from __future__ import annotations

from alpha5_model.numbers.tables import (
    ActuatorRow,
    Driver,
    DriverCurrents,
    Published,
)
from alpha5_model.proofs.audit.rounding import Figure, figure
from alpha5_model.proofs.audit.row import AuditRow, audited

#: Name of a driver -> what the rows call it.
_DRIVERS = {
    "uvms_simulator": "edxmorgan's driver of 2026",
    "reach_alpha_sim": "RKinDLab's driver of 2024",
}


def audit(printed: Published) -> list[AuditRow]:
    """The rows of outside evidence."""
    drivers = printed.supplementary.drivers
    newer = drivers["uvms_simulator"]
    older = drivers["reach_alpha_sim"]
    turning = printed.table_4.rows[:4]
    return [
        *(
            _static_current(row, newer, currents)
            for row, currents in zip(turning, newer.joints, strict=True)
        ),
        *(
            _current_cap(row, older, currents)
            for row, currents in zip(turning, older.joints, strict=True)
        ),
    ]


def _friction_current(row: ActuatorRow) -> Figure:
    """Current that overcomes the printed friction [A], with the printed tolerance."""
    current = figure(lambda x: x[0] / x[1], [row.friction, row.torque_constant])
    # The printed tolerance is the document's own, and wider than its rounding.
    tolerance = current.value * row.friction_tolerance.si
    return Figure(value=current.value, bound=tolerance + current.bound)


def _static_current(
    row: ActuatorRow, driver: Driver, currents: DriverCurrents
) -> AuditRow:
    """The friction's current, against the nearest of the driver's static currents.

    Between the currents of the two directions both agree.
    """
    printed = _friction_current(row)
    ends = sorted([currents.forward.si, currents.backward.si])
    nearest = min(max(printed.value, ends[0]), ends[1])
    torque_per_current = row.torque_constant.si * row.gear_ratio.si
    disagreed = abs(printed.value - nearest) * torque_per_current
    return audited(
        "static_current",
        measured=printed.value,
        bound=printed.bound,
        expected=nearest,
        of=row,
        effect=disagreed,
        more=nearest != printed.value,
        joint=currents.name,
        driver=_DRIVERS[driver.name],
        source=driver.source,
        forward=1e3 * currents.forward.si,
        backward=1e3 * currents.backward.si,
        theirs=nearest * torque_per_current,
        ours=printed.value * torque_per_current,
    )


def _current_cap(
    row: ActuatorRow, driver: Driver, currents: DriverCurrents
) -> AuditRow:
    """The friction's current, against the largest current that a driver commands."""
    printed = _friction_current(row)
    lacking = max(printed.value - currents.cap.si, 0.0)
    return audited(
        "current_cap",
        measured=printed.value,
        bound=printed.bound,
        expected=currents.cap.si,
        of=row,
        effect=lacking * row.torque_constant.si * row.gear_ratio.si,
        more=lacking > printed.bound,
        joint=currents.name,
        driver=_DRIVERS[driver.name],
        source=driver.source,
    )
