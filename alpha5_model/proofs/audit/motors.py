"""Table 4: the motors, against the laws of the DC motor and the arm's own weight.

References:
    [ReachAlpha] Manufacturer's document, Section 2.2.1, Table 4.
    [Siciliano2009] Siciliano, Sciavicco, Villani, Oriolo: Robotics, section 5.2.1: in
        SI units a motor's torque constant equals its voltage constant, by conservation
        of energy.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers.fluids import AIR, FRESH_WATER
from alpha5_model.numbers.parameters import Alpha5Parameters, JointParameters
from alpha5_model.numbers.quantity import Quantity
from alpha5_model.numbers.tables import ActuatorRow, Published
from alpha5_model.proofs.audit.rounding import Figure, figure, si
from alpha5_model.proofs.audit.row import AuditRow, audited

#: Positions of each joint at which the torque of weight and buoyancy is computed.
_GRID = 121


def audit(printed: Published, parameters: Alpha5Parameters) -> list[AuditRow]:
    """The rows of Table 4."""
    rows = printed.table_4.rows
    # Actuator 4 drives the jaw rod; without the screw's lead it has no torque to
    # compare.
    turning = list(zip(rows[:4], parameters.joints[:4], strict=True))
    supply = _least_supply(printed)
    holding = _Holding(
        air=peak_hydrostatic_torque(parameters, AIR),
        fresh=peak_hydrostatic_torque(parameters, FRESH_WATER),
        origin=printed.table_4.origins["friction"],
    )
    return [
        _turning_joints(printed),
        *(_motor_constants(row) for row in rows),
        *(_friction(row, joint, holding) for row, joint in turning),
        *(_efficiency(row, joint, rows[3], supply) for row, joint in turning[:3]),
        *(_stall(row, joint, supply) for row, joint in turning),
    ]


def _least_supply(printed: Published) -> list[Quantity]:
    """The factors of the lowest voltage at which all joints reach their speeds.

    Neither a supply nor a current limit is printed. The voltage is K_v Gr w of the
    joint whose rated speed w needs the highest one.
    """
    joints = printed.supplementary.joints
    voltages = [
        [row.voltage_constant, row.gear_ratio, joint.velocity.quantity]
        for row, joint in zip(printed.table_4.rows[:4], joints, strict=False)
    ]
    return max(voltages, key=lambda factors: float(np.prod(si(factors))))


def _turning_joints(printed: Published) -> AuditRow:
    """Whether the first four rows of Table 1 turn, and no other."""
    turns = [row.theta.startswith("theta_") for row in printed.table_1.rows]
    excess = sum(turns[:4]) - sum(turns[4:])
    return audited("actuators.turning", measured=excess, expected=4)


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


def _motor_constants(row: ActuatorRow) -> AuditRow:
    """K_t over K_v, which are equal in SI units."""
    k_t = row.torque_constant
    k_v = row.voltage_constant
    ratio = figure(lambda x: x[0] / x[1], [k_t, k_v])
    effect = None
    if row.actuator != "4":  # it drives the jaws, by a screw of unpublished lead
        effect = abs(k_t.si - k_v.si) * row.gear_ratio.si * row.efficiency.si
    return audited(
        "motor_constants",
        measured=ratio.value,
        bound=ratio.bound,
        expected=1.0,
        of=row,
        effect=effect,
    )


class _Holding(NamedTuple):
    """Torques that hold the arm still, and the source of the friction.

    Attributes:
        air, fresh: Largest torque of weight and buoyancy in air and in fresh water [N
            m].
        origin: Where the document says how the friction was measured.
    """

    air: float
    fresh: float
    origin: str


def _friction(row: ActuatorRow, joint: JointParameters, holding: _Holding) -> AuditRow:
    """Friction at the joint, against the torque that holds the arm still."""
    friction = figure(np.prod, [row.friction, row.gear_ratio])
    # The printed tolerance is the document's own, and wider than its rounding.
    tolerance = friction.value * row.friction_tolerance.si
    return audited(
        "friction",
        measured=friction.value,
        bound=tolerance + friction.bound,
        expected=holding.air,
        of=row,
        effect=max(friction.value - holding.air, 0.0),
        joint=joint.name,
        origin=holding.origin,
        air=holding.air,
        fresh=holding.fresh,
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

    expected = figure(
        for_own_ratio, [other.efficiency, other.gear_ratio, row.gear_ratio]
    )
    with_loss = _stall_torque(row, supply).value
    return audited(
        "efficiency",
        measured=row.efficiency.si,
        bound=expected.bound + row.efficiency.rounding,
        expected=expected.value,
        of=row,
        effect=with_loss / row.efficiency.si - with_loss,
        joint=joint.name,
        other=other,
    )


def _stall_torque(row: ActuatorRow, supply: list[Quantity]) -> Figure:
    """Stall torque of a joint at full voltage [N m], and its rounding."""
    factors = [row.torque_constant, row.gear_ratio, row.efficiency, *supply]
    return figure(lambda x: np.prod(x[:-1]) / x[-1], [*factors, row.resistance])


def _stall(
    row: ActuatorRow, joint: JointParameters, supply: list[Quantity]
) -> AuditRow:
    """The torque at full voltage, against the largest torque of the joint."""
    stall = _stall_torque(row, supply)
    return audited(
        "stall_torque",
        measured=stall.value,
        bound=stall.bound,
        expected=joint.effort,
        of=row,
        effect=max(stall.value - joint.effort, 0.0),
        joint=joint.name,
        volts=np.prod(si(supply)),
        without=stall.value / row.efficiency.si,
    )
