"""Table 4: the motors, against physics, the arm's own weight, and two public drivers.

A driver's numbers come without a report of their measurement. So a difference from them
is not counted as an error of the document, and the model takes none of them.

References:
    [ReachAlpha] Manufacturer's document, Section 2.2.1, Table 4.
    [Siciliano2009] Siciliano, Sciavicco, Villani, Oriolo: Robotics, section 5.2.1: in
        SI units a motor's torque constant equals its voltage constant, by conservation
        of energy.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers.fluids import AIR, FRESH_WATER
from alpha5_model.numbers.parameters import Alpha5Parameters, JointParameters
from alpha5_model.numbers.quantity import Quantity
from alpha5_model.numbers.tables import ActuatorRow, Driver, DriverCurrents, Published
from alpha5_model.proofs.audit.row import AuditRow, Figure, figure, judged, si

#: Positions of each joint at which the torque of weight and buoyancy is computed.
_GRID = 121


def rows(printed: Published, parameters: Alpha5Parameters) -> list[AuditRow]:
    """The rows of Table 4."""
    table = printed.table_4
    # Actuator 4 drives the jaw rod; without the screw's lead it has no torque to
    # compare.
    turning = list(zip(table.rows[:4], parameters.joints[:4], strict=True))
    supply = _least_supply(printed)
    in_air = peak_hydrostatic_torque(parameters, AIR)
    in_water = peak_hydrostatic_torque(parameters, FRESH_WATER)
    friction_at = f"at the motor, {table.origins['friction']}"
    return [
        _turning_joints(printed),
        *map(_motor_constants, table.rows),
        *(
            _friction(row, joint, in_air, in_water, friction_at)
            for row, joint in turning
        ),
        *(_efficiency(row, joint, table.rows[3], supply) for row, joint in turning[:3]),
        *(_stall(row, joint, supply) for row, joint in turning),
        *_drivers(table.rows[:4], printed.supplementary.drivers),
    ]


def _place(row: ActuatorRow, joint: str) -> str:
    return f"Section 2.2.1, Table 4, actuator {row.actuator}, {joint}"


def _turning_joints(printed: Published) -> AuditRow:
    """Whether the first four rows of Table 1 turn, and no other."""
    turns = [row.theta.startswith("theta_") for row in printed.table_1.rows]
    return judged(
        "actuators.turning",
        Figure(sum(turns[:4]) - sum(turns[4:])),
        expected=4,
        place="Section 2.2.1, note",
        says="actuators 0-3 turn the frames, actuator 4 slides",
        measures="rows 0 to 3 of Table 1 that turn, minus 1 if row 4 does",
    )


def _motor_constants(row: ActuatorRow) -> AuditRow:
    """K_t over K_v, which are equal in SI units."""
    k_t = row.torque_constant
    k_v = row.voltage_constant
    effect = None
    if row.actuator != "4":  # the lead of the jaws' screw is not published
        effect = abs(k_t.si - k_v.si) * row.gear_ratio.si * row.efficiency.si
    return judged(
        f"motor_constants.actuator_{row.actuator}",
        figure(lambda x: x[0] / x[1], [k_t, k_v]),
        expected=1.0,
        place=f"Section 2.2.1, Table 4, actuator {row.actuator}",
        says=f"K_t {k_t}, K_v {k_v}",
        measures="K_t / K_v in SI units, which is 1 if both refer to the same winding",
        finding="Both may be right if one is per phase and the other line to line, "
        "which Table 4 does not say.",
        used="K_t for torque and K_v for voltage; constants= chooses one for both",
        effect=effect,
        effect_unit="N m/A",
        cost="difference in joint torque per ampere between the two",
        category="reading",
    )


def _friction(
    row: ActuatorRow,
    joint: JointParameters,
    in_air: float,
    in_water: float,
    measured: str,
) -> AuditRow:
    """Friction at the joint, against the torque that holds the arm still.

    Args:
        in_air, in_water: Largest torque of weight and buoyancy in air and in fresh
            water [N m].
        measured: Where the document says how the friction was measured.
    """
    friction = figure(np.prod, [row.friction, row.gear_ratio])
    # The printed tolerance is the document's own, and wider than its rounding.
    tolerance = friction.value * row.friction_tolerance.si
    return judged(
        f"friction.actuator_{row.actuator}",
        Figure(friction.value, friction.bound + tolerance),
        expected=in_air,
        relation="<=",
        unit="N m",
        kind="observation",
        place=_place(row, joint.name),
        says=f"F {row.friction} +-{row.friction_tolerance} {measured}",
        measures="F Gr, the friction at the joint, compared with the largest torque of "
        "the arm's weight about axis_d",
        finding=f"The weight's torque is at most {in_air:.2f} N m in air and "
        f"{in_water:.2f} N m in fresh water.",
        used="the printed friction with its tolerance",
        effect=friction.value - in_air,
        cost="friction beyond the largest torque of the arm's weight",
    )


def peak_hydrostatic_torque(
    parameters: Alpha5Parameters, fluid_density: float
) -> float:
    """Largest torque [N m] of weight and buoyancy about the shoulder, axis_d.

    The torque is ``A cos(theta_1) + B sin(theta_1)``. The range of theta_1 spans more
    than half a turn, so ``sqrt(A^2 + B^2)`` is reached, and only theta_2 and theta_3
    are searched.
    """
    # Imported late: it loads Pinocchio.
    from alpha5_model.dynamics.load import arm_of

    arm = arm_of(parameters, fluid_density)
    ranges = [
        np.linspace(joint.lower, joint.upper, _GRID) for joint in parameters.joints[2:4]
    ]
    theta_2, theta_3 = np.meshgrid(*ranges, indexing="ij")
    q = np.zeros((theta_2.size, 4))
    q[:, 2] = theta_2.ravel()
    q[:, 3] = theta_3.ravel()
    still = np.zeros(4)

    cosine_part = arm.inverse_dynamics_batch(q, still, still)[:, 1]
    q[:, 1] = np.pi / 2
    sine_part = arm.inverse_dynamics_batch(q, still, still)[:, 1]
    return float(np.hypot(cosine_part, sine_part).max())


def _least_supply(printed: Published) -> list[Quantity]:
    """The factors of the lowest voltage at which all joints reach their speeds.

    Neither a supply nor a current limit is printed. The voltage is K_v Gr w of the
    joint whose rated speed w needs the highest one.
    """
    joints = printed.supplementary.joints
    voltages = [
        [row.voltage_constant, row.gear_ratio, joint.velocity.quantity]
        for row, joint in zip(printed.table_4.rows[:4], joints[:4], strict=True)
    ]
    return max(voltages, key=lambda factors: float(np.prod(si(factors))))


def _stall_torque(row: ActuatorRow, supply: list[Quantity]) -> Figure:
    """Stall torque of a joint at full voltage [N m], and its rounding."""
    factors = [row.torque_constant, row.gear_ratio, row.efficiency, *supply]
    return figure(lambda x: np.prod(x[:-1]) / x[-1], [*factors, row.resistance])


def _stall(
    row: ActuatorRow, joint: JointParameters, supply: list[Quantity]
) -> AuditRow:
    """The torque at full voltage, against the largest torque of the joint."""
    stall = _stall_torque(row, supply)
    return judged(
        f"stall_torque.actuator_{row.actuator}",
        stall,
        expected=joint.effort,
        relation="<=",
        unit="N m",
        kind="observation",
        place=_place(row, joint.name),
        says="no current limit is printed",
        measures=f"stall torque K_t U / R Gr eta at {np.prod(si(supply)):.1f} V, "
        "compared with the effort in most public URDFs",
        finding="A lower voltage would not give every joint its rated speed. So there "
        "must be a current limit, which you have to give. Without eta, if it is the "
        f"motor's, the torque is {stall.value / row.efficiency.si:.1f} N m.",
        used="the effort of these URDFs, marked as a placeholder",
        effect=stall.value - joint.effort,
        cost="torque beyond that effort",
    )


def _efficiency(
    row: ActuatorRow,
    joint: JointParameters,
    other: ActuatorRow,
    supply: list[Quantity],
) -> AuditRow:
    """Whether eta_max can be a gearbox's, by an actuator with another gear ratio.

    A gearbox of n equal stages has the ratio ``r^n`` and the efficiency ``e^n``, so the
    logarithms of the two are proportional.
    """

    def for_own_ratio(x: FloatArray) -> float:
        efficiency, ratio, own_ratio = x
        return float(efficiency ** (np.log(own_ratio) / np.log(ratio)))

    numbers = [other.efficiency, other.gear_ratio, row.gear_ratio]
    expected = figure(for_own_ratio, numbers)
    with_loss = _stall_torque(row, supply).value
    return judged(
        f"efficiency.actuator_{row.actuator}",
        Figure(row.efficiency.si, expected.bound + row.efficiency.rounding),
        expected=expected.value,
        relation="<=",
        unit="%",
        kind="observation",
        place=_place(row, joint.name),
        says=f"eta_max {row.efficiency} at {row.gear_ratio}:1, from motor/gearbox data "
        "sheets",
        measures=f"eta_max, compared with actuator 3's {other.efficiency} at "
        f"{other.gear_ratio}:1, with the same loss in every stage",
        finding="This is too high for a gearbox. It is more likely the motor's.",
        used="eta_max as the gearbox's; a5.actuators.actuator can take "
        "it as the motor's",
        effect=with_loss / row.efficiency.si - with_loss,
        cost="stall torque gained, if nothing is lost in the gearbox",
    )


# --- what public drivers of real arms say ---------------------------------------------


def _drivers(
    turning: Sequence[ActuatorRow], drivers: dict[str, Driver]
) -> list[AuditRow]:
    newer = drivers["uvms_simulator"]
    older = drivers["reach_alpha_sim"]
    return [
        *(
            _static_current(row, currents, newer.source)
            for row, currents in zip(turning, newer.joints, strict=True)
        ),
        *(
            _current_cap(row, currents, older.source)
            for row, currents in zip(turning, older.joints, strict=True)
        ),
    ]


def _static_current(row: ActuatorRow, driver: DriverCurrents, source: str) -> AuditRow:
    """The friction's current, against the nearest of the driver's static currents.

    Between the currents of the two directions both agree.
    """
    needed = _friction_current(row)
    lower, upper = sorted([driver.forward.si, driver.backward.si])
    nearest = min(max(needed.value, lower), upper)
    torque_per_ampere = row.torque_constant.si * row.gear_ratio.si
    return judged(
        f"static_current.actuator_{row.actuator}",
        needed,
        expected=nearest,
        unit="mA",
        kind="outside",
        place=_place(row, driver.name),
        says=_friction_says(row),
        measures="F / K_t, the current that overcomes friction, compared with the "
        "static current in edxmorgan's driver of 2026",
        finding=f"The driver has {1e3 * driver.forward.si:.0f} mA forward and "
        f"{1e3 * driver.backward.si:.0f} mA backward. At the joint that is a friction "
        f"of {nearest * torque_per_ampere:.2f} N m, where F Gr is "
        f"{needed.value * torque_per_ampere:.2f} N m. Source: {source}.",
        used=_UNTIL_MEASURED,
        effect=abs(needed.value - nearest) * torque_per_ampere,
        cost="difference in friction at the joint",
    )


def _current_cap(row: ActuatorRow, driver: DriverCurrents, source: str) -> AuditRow:
    """The friction's current, against the largest current that a driver commands."""
    needed = _friction_current(row)
    lacking = needed.value - driver.cap.si
    return judged(
        f"current_cap.actuator_{row.actuator}",
        needed,
        expected=driver.cap.si,
        relation="<=",
        unit="mA",
        kind="outside",
        place=_place(row, driver.name),
        says=_friction_says(row),
        measures="F / K_t, the current that overcomes friction, compared with the "
        "largest current that RKinDLab's driver of 2024 commands",
        finding="With Table 4's friction, this joint of that arm would never move. "
        f"Source: {source}.",
        used=_UNTIL_MEASURED,
        effect=lacking * row.torque_constant.si * row.gear_ratio.si,
        cost="friction at the joint that the largest current does not overcome",
    )


_UNTIL_MEASURED = (
    "Table 4's friction until you measure yours; alpha5 calibrate motors starts from a "
    "wide prior"
)


def _friction_says(row: ActuatorRow) -> str:
    return f"F {row.friction} +-{row.friction_tolerance}, K_t {row.torque_constant}"


def _friction_current(row: ActuatorRow) -> Figure:
    """Current that overcomes the printed friction [A], with the printed tolerance."""
    current = figure(lambda x: x[0] / x[1], [row.friction, row.torque_constant])
    tolerance = current.value * row.friction_tolerance.si
    return Figure(current.value, current.bound + tolerance)
