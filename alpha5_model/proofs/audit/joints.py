"""What acts at the joints: Table 4 against the laws of the DC motor and the arm's own weight, and water.

The strip theory that circulates for this arm in water is held against our estimate and against
strip theory itself. No document prints its numbers; they stand in
``numbers/supplementary_hydrodynamics.toml`` with their sources.

References:
    [ReachAlpha] Manufacturer's document, Section 2.2.1, Table 4.
    [Siciliano2009] Siciliano, Sciavicco, Villani, Oriolo: Robotics, section 5.2.1: in SI units a
        motor's torque constant equals its voltage constant, by conservation of energy.
    [Newman1977] Marine Hydrodynamics, section 4.13: added mass of a strip, and how it moves to
        another point.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import cross_matrix, rotation_about
from alpha5_model.numbers.fluids import AIR, FRESH_WATER
from alpha5_model.numbers.hydrodynamics import (
    BodyHydrodynamics,
    gauss_points,
    hydrodynamics,
)
from alpha5_model.numbers.parameters import Alpha5Parameters, JointParameters
from alpha5_model.numbers.quantity import Quantity
from alpha5_model.numbers.tables import ActuatorRow, Published
from alpha5_model.proofs.audit.row import AuditRow, audited, figure, si
from alpha5_model.theory.dh.chain import DHChain

#: Positions of each joint but the first, on which no added inertia depends.
_GRID = 7


def audit(printed: Published, p: Alpha5Parameters) -> list[AuditRow]:
    """The rows of Table 4, and those of the numbers that circulate for moving water."""
    rows, speeds = printed.table_4.rows, printed.supplementary.joints
    turns = [row.theta.startswith("theta_") for row in printed.table_1.rows]
    words: dict[str, Any] = {"origin": printed.table_4.origins["friction"]}
    words["air"], words["fresh"] = (
        peak_hydrostatic_torque(p, x) for x in (AIR, FRESH_WATER)
    )
    # Actuator 4 drives the jaw rod; without the screw's lead it has no torque to compare.
    turning = list(zip(rows[:4], p.joints, strict=False))
    # Neither a supply nor a current limit is printed: K_v Gr w of the joint whose rated speed needs
    # the highest voltage; a supply below this would not reach that speed.
    needed = zip(rows[:4], speeds, strict=False)
    inputs = [
        [row.voltage_constant, row.gear_ratio, j.velocity.quantity] for row, j in needed
    ]
    supply = max(inputs, key=lambda needed: np.prod(si(needed)))
    return [
        audited("actuators.turning", sum(turns[:4]) - sum(turns[4:]), expected=4),
        *map(_motor_constants, rows),
        *(_friction(row, joint=joint.name, **words) for row, joint in turning),
        *(_efficiency(row, joint, rows[3], supply) for row, joint in turning[:3]),
        *(_stall(row, joint, supply) for row, joint in turning),
        *_moving_water(p),
    ]


def peak_hydrostatic_torque(p: Alpha5Parameters, fluid_density: float) -> float:
    """Largest torque [N m] of weight and buoyancy about axis_d, the shoulder, within limits.

    The torque is ``A cos(theta_1) + B sin(theta_1)``; the range of theta_1 spans more than half a
    turn, so ``sqrt(A^2 + B^2)`` is reached, and only theta_2 and theta_3 are searched.
    """
    from alpha5_model.dynamics.load import arm_of  # late: Pinocchio

    grid = np.meshgrid(
        *(np.linspace(j.lower, j.upper, 121) for j in p.joints[2:4]), indexing="ij"
    )
    q = np.zeros((2, grid[0].size, 4))
    q[..., 2], q[..., 3] = grid[0].ravel(), grid[1].ravel()
    q[1, :, 1] = np.pi / 2
    still, arm = np.zeros(4), arm_of(p, fluid_density)
    one, other = (arm.inverse_dynamics_batch(rows, still, still)[:, 1] for rows in q)
    return float(np.hypot(one, other).max())


def _motor_constants(row: ActuatorRow) -> AuditRow:
    k_t, k_v = row.torque_constant, row.voltage_constant
    turns = row.actuator != "4"
    effect = (
        abs(k_t.si - k_v.si) * row.gear_ratio.si * row.efficiency.si if turns else None
    )
    ratio = figure(lambda x: x[0] / x[1], [k_t, k_v])
    return audited("motor_constants", *ratio, 1.0, of=row, effect=effect, more=turns)


def _friction(row: ActuatorRow, **words: Any) -> AuditRow:
    value, rounding = figure(np.prod, [row.friction, row.gear_ratio])
    # The printed tolerance is the document's own, and wider than its rounding.
    bound = value * row.friction_tolerance.si + rounding
    effect = max(value - words["air"], 0.0)
    return audited(
        "friction", value, bound, words["air"], of=row, effect=effect, **words
    )


def _efficiency(
    row: ActuatorRow, joint: JointParameters, other: ActuatorRow, supply: list[Quantity]
) -> AuditRow:
    """eta_max as a gearbox's, against that of an actuator with another gear ratio.

    A gearbox of equal stages has a ratio of ``r^n`` and an efficiency of ``e^n``, so that
    the logarithms of the two are proportional.
    """

    def carried(x: FloatArray) -> Any:
        efficiency, ratio, own_ratio = x
        return efficiency ** (np.log(own_ratio) / np.log(ratio))

    inputs = [other.efficiency, other.gear_ratio, row.gear_ratio]
    expected, bound = figure(carried, inputs)
    with_loss, _ = _stall_torque(row, supply)
    words: dict[str, Any] = {
        "joint": joint.name,
        "other": other,
        "effect": with_loss / row.efficiency.si - with_loss,
    }
    bound += row.efficiency.rounding
    return audited("efficiency", row.efficiency.si, bound, expected, of=row, **words)


def _stall_torque(row: ActuatorRow, supply: list[Quantity]) -> tuple[float, float]:
    """Torque of the joint that stands still at full voltage [N m], and its rounding."""
    inputs = [
        row.torque_constant,
        row.gear_ratio,
        row.efficiency,
        *supply,
        row.resistance,
    ]
    value, bound = figure(lambda x: np.prod(x[:-1]) / x[-1], inputs)
    return float(value), float(bound)


def _stall(
    row: ActuatorRow, joint: JointParameters, supply: list[Quantity]
) -> AuditRow:
    value, bound = _stall_torque(row, supply)
    words: dict[str, Any] = {
        "joint": joint.name,
        "volts": np.prod(si(supply)),
        "without": value / row.efficiency.si,
    }
    effect = max(value - joint.effort, 0.0)
    return audited(
        "stall_torque", value, bound, joint.effort, of=row, effect=effect, **words
    )


def _moving_water(p: Alpha5Parameters) -> list[AuditRow]:
    """Observations, no claims of a document."""
    bodies = hydrodynamics(numbers="supplementary")
    waters = (bodies, hydrodynamics(), hydrodynamics(level="high"))
    theirs, ours, most = ({k: body.added_mass for k, body in x.items()} for x in waters)
    joined = {name: _coupled(body) for name, body in bodies.items()}
    sizes = [
        added_inertia(p, matrices)[:3] for matrices in (theirs, ours, most, joined)
    ]
    rows = []
    for joint, other, size, high, strips in zip(p.joints, *sizes, strict=False):
        words: dict[str, Any] = {"joint": joint.name, "coupled": strips / size}
        claim = f"circulating_water.{joint.name}"
        rows.append(audited(claim, other / size, high / size - 1, 1.0, **words))
    (strip,) = bodies["link_2"].strips
    turning = np.array([0.0, 0.0, 1.0])
    twist = np.concatenate([-np.cross(turning, (strip.start + strip.end) / 2), turning])
    energies = [twist @ matrices["link_2"] @ twist for matrices in (theirs, joined)]
    return [
        *rows,
        audited("circulating_water.coupling", energies[0] / energies[1], 1e-3, 1.0),
    ]


def _coupled(water: BodyHydrodynamics) -> FloatArray:
    """Strip theory with the same masses along the same line, (6, 6)."""
    (strip,) = water.strips
    line, added = strip.end - strip.start, np.diag(water.added_mass)[:3]
    along = np.outer(line, line) / (line @ line)
    per_strip = added.max() * (np.eye(3) - along) + added.min() * along
    out = np.zeros((6, 6))
    for point, share in gauss_points(strip):
        velocity = np.hstack([np.eye(3), -cross_matrix(point)])
        out += share * velocity.T @ per_strip @ velocity
    return out


def added_inertia(p: Alpha5Parameters, matrices: dict[str, FloatArray]) -> FloatArray:
    """Added inertia about each joint, mean over a grid of the joints' ranges, (4,) [kg m^2].

    In water of 1000 kg/m^3.
    """
    chain = DHChain.alpha5()
    ranges = [np.linspace(joint.lower, joint.upper, _GRID) for joint in p.joints[1:4]]
    q = np.stack(np.meshgrid([0.0], *ranges, indexing="ij"), axis=-1).reshape(-1, 4)
    frames = chain.frames(q)
    points, axes = chain.joint_axes(q)
    out = np.zeros((len(q), 4))
    for i in range(1, 5):
        # Inertial frame {i} stands at DH frame {i-1}, turned by the joint about its z (Section 2).
        pose, joint = frames[:, i - 1], chain.links[i - 1]
        turn = pose[:, :3, :3] @ rotation_about((0, 0, 1), q[:, i - 1] + joint.offset)
        spin = axes[:, :i]
        speed = np.cross(spin, pose[:, None, :3, 3] - points[:, :i])
        twist = np.concatenate([speed @ turn, spin @ turn], axis=-1)
        out[:, :i] += np.einsum("nka,ab,nkb->nk", twist, matrices[f"link_{i}"], twist)
    return np.asarray(out.mean(axis=0))
