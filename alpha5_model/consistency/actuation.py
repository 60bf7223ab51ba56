"""Table 4 against the laws of the DC motor and against the arm's own weight.

References:
    [ReachAlpha] Manufacturer's document, Section 2.2.1, Table 4.
    [Siciliano2009] Siciliano, Sciavicco, Villani, Oriolo: Robotics, section 5.2.1: in SI units a
        motor's torque constant equals its voltage constant, by conservation of energy.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.consistency.row import AuditRow, audited, figure
from alpha5_model.fluids import AIR, FRESH_WATER
from alpha5_model.parameters import Alpha5Parameters
from alpha5_model.published.quantity import Quantity
from alpha5_model.published.tables import ActuatorRow, Published


def audit(printed: Published, p: Alpha5Parameters) -> list[AuditRow]:
    """The rows of Table 4."""
    rows = printed.table_4.rows
    peaks = peak_hydrostatic_torque(p, AIR), peak_hydrostatic_torque(p, FRESH_WATER)
    # Actuator 4 drives the jaw rod; without the screw's lead it has no torque to compare.
    turning = list(zip(rows[:4], p.joints, strict=False))
    supply = _least_supply(printed)
    origin = printed.table_4.origins["friction"]
    return [
        _turning(printed),
        *(_motor_constants(row) for row in rows),
        *(_friction(row, joint.name, peaks, origin) for row, joint in turning),
        *(_stall(row, joint.name, joint.effort, supply) for row, joint in turning),
    ]


def peak_hydrostatic_torque(p: Alpha5Parameters, fluid_density: float) -> float:
    """Largest torque [N m] of weight and buoyancy about axis_d, the shoulder, within limits.

    The torque is ``A cos(theta_1) + B sin(theta_1)``; the range of theta_1 spans more than half a
    turn, so ``sqrt(A^2 + B^2)`` is reached, and only theta_2 and theta_3 are searched.
    """
    from alpha5_model.dynamics import arm_of  # late: Pinocchio

    grid = np.meshgrid(*(np.linspace(j.lower, j.upper, 121) for j in p.joints[2:4]), indexing="ij")
    q = np.zeros((2, grid[0].size, 4))
    q[..., 2], q[..., 3] = grid[0].ravel(), grid[1].ravel()
    q[1, :, 1] = np.pi / 2
    still, arm = np.zeros(4), arm_of(p, fluid_density)
    one, other = (arm.inverse_dynamics_batch(rows, still, still)[:, 1] for rows in q)
    return float(np.hypot(one, other).max())


def _turning(printed: Published) -> AuditRow:
    turns = [row.theta.startswith("theta_") for row in printed.table_1.rows]
    return audited("actuators.turning", sum(turns[:4]) - sum(turns[4:]), 4)


def _motor_constants(row: ActuatorRow) -> AuditRow:
    k_t, k_v = row.torque_constant, row.voltage_constant
    value, bound = figure(lambda x: x[0] / x[1], [k_t, k_v])
    effect, more = None, ""
    if row.actuator != "4":
        effect = abs(k_t.si - k_v.si) * row.gear_ratio.si * row.efficiency.si
        more = "; the effect is the joint torque per ampere that the two disagree about"
    return audited("motor_constants", value, 1.0, bound, of=row, effect=effect, more=more)


def _friction(row: ActuatorRow, joint: str, peaks: tuple[float, float], origin: str) -> AuditRow:
    value, rounding = figure(lambda x: x[0] * x[1], [row.friction, row.gear_ratio])
    air, fresh = peaks
    # The printed tolerance is the document's own, and wider than its rounding.
    bound = value * row.friction_tolerance.si + rounding
    words: dict[str, Any] = {"air": f"{air:.2f}", "fresh": f"{fresh:.2f}", "origin": origin}
    words["joint"] = joint
    return audited("friction", value, air, bound, of=row, effect=max(value - air, 0.0), **words)


def _least_supply(printed: Published) -> list[Quantity]:
    """K_v, Gr and rated speed of the joint whose rated speed needs the highest voltage, K_v Gr w.

    Neither a supply nor a current limit is printed; a supply below this would not reach that speed.
    """
    rows = zip(printed.table_4.rows[:4], printed.supplementary.joints, strict=False)
    inputs = [[row.voltage_constant, row.gear_ratio, j.velocity.quantity] for row, j in rows]
    return max(inputs, key=lambda needed: math.prod(q.si for q in needed))


def _stall(row: ActuatorRow, joint: str, effort: float, supply: list[Quantity]) -> AuditRow:
    def torque(x: FloatArray) -> float:
        k_t, resistance, ratio, efficiency, *voltage = x
        return float(k_t / resistance * ratio * efficiency * np.prod(voltage))

    inputs = [row.torque_constant, row.resistance, row.gear_ratio, row.efficiency, *supply]
    value, bound = figure(torque, inputs)
    volts, effect = f"{math.prod(q.si for q in supply):.1f}", max(value - effort, 0.0)
    words: dict[str, Any] = {"joint": joint, "volts": volts}
    return audited("stall_torque", value, effort, bound, of=row, effect=effect, **words)
