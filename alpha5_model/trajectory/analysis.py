"""What a joint motion takes: torques by cause, motors, power, load on the mount, TCP path."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, choice, frozen, real
from alpha5_model.dynamics.actuators import Actuator, Interval, actuator
from alpha5_model.errors import InputError, MissingParameterError
from alpha5_model.numbers.parameters import parameters
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.trajectory import file_table, smoothing
from alpha5_model.trajectory.motions import Motion
from alpha5_model.trajectory.smoothing import SmoothMotion, smooth
from alpha5_model.trajectory.warning import MotionWarning

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm
    from alpha5_model.dynamics.batch import WaterTerms

#: Attributes of an analysis that need a motor's constants: NaN without.
BY_MOTOR = (
    "friction",
    "current",
    "current_lower",
    "current_upper",
    "voltage",
    "electrical_power",
)
#: Rows computed between two reports of progress.
_CHUNK = 25_000


@dataclass(frozen=True, eq=False)
class Analysis:
    """A motion's forces, currents and powers; rows are samples, columns joints base to tip.

    Torques are those at the joint: N m, for the jaw rod N. The sum of ``inertia``, ``coriolis``,
    ``weight``, ``buoyancy`` and, if asked for, what moving water adds is ``torque``; ``torque +
    friction`` is what the motor gives, ``K_t i`` times the gear ratio. Columns of a motor that
    cannot be computed (jaw rod without screw lead) are NaN.

    Attributes:
        motion: The samples as given.
        smooth: Positions, velocities and accelerations that the rest is computed from.
        actuators: Motor of each joint.
        arm: The model.
        inertia, coriolis, weight, buoyancy: Torques by cause, (N, n).
        torque: Joint torque, (N, n).
        friction: Motor friction and gear loss at the joint, (N, n). At rest friction holds the load
            and the motor gives the least torque that keeps it there, in most cases none.
        current: Motor currents, (N, n) [A].
        current_lower, current_upper: Over the printed tolerance of friction, (N, n) [A].
        voltage: Winding voltages, (N, n) [V]; di/dt is left out (L/R is below 0.1 ms).
        electrical_power, mechanical_power: (N, n) [W]; negative where the joint feeds back.
        base_wrench: Force and moment on the mount at base_link, in its axes, (N, 6) [N, N m].
        tcp: TCP in base_link, (N, 3) [m].
        torque_limits: Lower and upper (N, n) limits from supply voltage and current limit; None
            without them.
        supply_voltage, current_limit: As given [V], [A]; None if not.
        warnings: What was found odd in the motion, velocities that contradict positions included.
        moving_water: What a current adds, (N, 3, n) with all numbers low, nominal and high; the
            nominal ones are in ``torque``, ``base_wrench`` and all that follows from them. None if
            no current was given.
    """

    motion: Motion
    smooth: SmoothMotion
    actuators: tuple[Actuator, ...]
    arm: Arm
    inertia: FloatArray
    coriolis: FloatArray
    weight: FloatArray
    buoyancy: FloatArray
    torque: FloatArray
    friction: FloatArray
    current: FloatArray
    current_lower: FloatArray
    current_upper: FloatArray
    voltage: FloatArray
    electrical_power: FloatArray
    mechanical_power: FloatArray
    base_wrench: FloatArray
    tcp: FloatArray
    torque_limits: Interval | None
    supply_voltage: float | None
    current_limit: float | None
    warnings: tuple[MotionWarning, ...]
    moving_water: WaterTerms | None = None

    def causes(self) -> dict[str, FloatArray]:
        """Torques by cause, (N, n) each: those of the joint, then ``friction`` at the motor."""
        out = {
            name: getattr(self, name)
            for name in ("inertia", "coriolis", "weight", "buoyancy")
        }
        if self.moving_water is not None:
            out["moving_water"] = self.moving_water.torque[:, 1]
        return {**out, "friction": self.friction}


def analyse(
    motion: Motion,
    arm: Arm | None = None,
    *,
    method: str = "spline",
    bandwidth: float = smoothing.DEFAULT_BANDWIDTH,
    use_velocity: bool | None = None,
    constants: str = "printed",
    actuators: Mapping[str, Actuator] | None = None,
    supply_voltage: float | None = None,
    current_limit: float | None = None,
    threads: int | None = None,
    progress: file_table.Progress | None = None,
    current: ArrayLike | None = None,
    efficiency: str = "gearbox",
) -> Analysis:
    """Torques, currents, powers, mount load and TCP path of a motion.

    Args:
        motion: From `read_motion` or `motion`.
        arm: The model; its joints decide whether the jaw rod is used. None loads the jaws variant
            in sea water if the motion has ``axis_a``, and the one with locked jaws otherwise.
        method, bandwidth, use_velocity: See `alpha5_model.trajectory.smoothing.smooth`.
        constants: Which of the contradicting motor constants to believe (`alpha5_model.dynamics.actuators`).
        actuators: Motors by joint name, in place of those of Table 4: say, with a rotor inertia.
        supply_voltage: [V], with ``current_limit`` [A]: adds the speed-torque limits; not
            published.
        threads: Of Pinocchio; None for all that this process may use.
        progress: Called with a stage's name and the part done, 0 to 1.
        current: Velocity of the water in base_link, (3,) [m/s]: adds drag and added mass, which are
            estimated, not published. None for water that only bears.
        efficiency: Whose efficiency Table 4's eta_max is (`alpha5_model.dynamics.actuators`).

    Raises:
        InputError: An arm with other joints than the motion, or one limit without the other.
        UnknownNameError: No such method, constants, efficiency or joint.
    """
    from alpha5_model.dynamics.batch import (
        WaterTerms,
        frame_positions,
        torque_terms,
        water_terms,
    )

    if arm is None:
        from alpha5_model.dynamics.load import load

        arm = load(gripper="jaws" if "axis_a" in motion.joints else "locked")
    motion = _for_arm(motion, arm)
    if supply_voltage is not None:
        supply_voltage = real("supply_voltage", supply_voltage)
    if current_limit is not None:
        current_limit = real("current_limit", current_limit)
    given: Any = supply_voltage, current_limit
    if (supply_voltage is None) != (current_limit is None):
        raise InputError("supply_voltage and current_limit", given, "both or neither")
    by_joint = {
        name: actuator(name, constants, efficiency=efficiency) for name in motion.joints
    }
    own = (actuators or {}).items()
    by_joint |= {choice("joint", name, motion.joints): motor for name, motor in own}
    motors = tuple(by_joint.values())
    s = smooth(motion, method, bandwidth, use_velocity)
    parts: list[dict[str, FloatArray]] = []
    for start in range(0, s.time.size, _CHUNK):
        q, v, a = (
            x[start : start + _CHUNK] for x in (s.position, s.velocity, s.acceleration)
        )
        parts.append({**vars(torque_terms(arm, q, v, a, threads))})
        parts[-1]["base_wrench"] = arm.base_wrench_batch(q, v, a, threads)
        parts[-1]["tcp"] = frame_positions(arm, q)
        if current is not None:
            water = water_terms(arm, q, v, a, current)
            parts[-1] |= {"water_torque": water.torque, "water_wrench": water.wrench}
        if progress:
            progress("compute", min(start + _CHUNK, s.time.size) / s.time.size)
    out = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    out["torque"] = out["inertia"] + out["coriolis"] + out["weight"] + out["buoyancy"]
    moving = None
    if current is not None:
        added = (frozen(out.pop(f"water_{name}")) for name in ("torque", "wrench"))
        moving = WaterTerms(water.current, *added)
        out["torque"] += moving.torque[:, 1]
        out["base_wrench"] += moving.wrench[:, 1]
    out["mechanical_power"] = out["torque"] * s.velocity
    drive = None if current_limit is None else given
    by_motor, limits = motor_side(motors, s, out["torque"], drive)
    columns: dict[str, Any] = {name: frozen(x) for name, x in (out | by_motor).items()}
    columns |= {"supply_voltage": supply_voltage, "current_limit": current_limit}
    columns["warnings"] = motion.warnings + _velocity_warnings(motion)
    return Analysis(
        motion, s, motors, arm, **columns, torque_limits=limits, moving_water=moving
    )


def _for_arm(motion: Motion, arm: Arm) -> Motion:
    """The motion of the joints that the arm has; a locked gripper leaves the jaw rod out."""
    if arm.floating_base or arm.model.nv not in (4, 5):
        raise InputError(
            "arm", f"a model with nv = {arm.model.nv}", "an arm on a fixed base"
        )
    wanted = JOINT_NAMES[: arm.model.nv]
    if len(wanted) > len(motion.joints):
        expected = "a motion of axis_a too, since the arm's gripper has jaws"
        raise InputError("motion", motion.joints, expected)
    if len(wanted) == len(motion.joints):
        return motion
    arrays = {
        name: getattr(motion, name) for name in ("position", "velocity", "effort")
    }
    fewer: dict[str, Any] = {k: x[:, :4] for k, x in arrays.items() if x is not None}
    warnings = tuple(w for w in motion.warnings if "axis_a" not in w.text)
    ignored = (*motion.ignored, "axis_a")
    return replace(motion, joints=wanted, warnings=warnings, ignored=ignored, **fewer)


def motor_side(
    motors: Sequence[Actuator],
    s: SmoothMotion,
    torque: FloatArray,
    drive: Sequence[float] | None,
) -> tuple[dict[str, FloatArray], Interval | None]:
    """`BY_MOTOR`, and what the drive can give while the joint moves and hold where it rests."""
    out = np.full((len(BY_MOTOR), *torque.shape), np.nan)
    lower, upper = np.full((2, *torque.shape), np.nan)
    velocity = s.signed_velocity
    for k, motor in enumerate(motors):
        v, tau, rest = velocity[:, k], torque[:, k], s.direction[:, k] == 0
        state = tau, v, None if motor.rotor_inertia is None else s.acceleration[:, k]
        with suppress(MissingParameterError):
            every = motor, *motor.extremes()
            held = [np.clip(0.0, *m.holding_current(tau)) for m in every]
            current, *ends = np.where(rest, held, [m.current(*state) for m in every])
            friction = motor.torque_constant * motor.ratio * current - tau
            voltage = motor.voltage(current, v)
            interval = np.minimum(*ends), np.maximum(*ends)
            out[..., k] = friction, current, *interval, voltage, voltage * current
            if drive is not None:
                supply, limit = drive
                moving = motor.torque_limits(v, supply, limit)  # checks both
                most = min(limit, supply / motor.parameters.resistance)
                lower[:, k] = np.where(
                    rest, motor.holding_torque(-most).lower, moving.lower
                )
                upper[:, k] = np.where(
                    rest, motor.holding_torque(most).upper, moving.upper
                )
    limits = None if drive is None else Interval(frozen(lower), frozen(upper))
    return dict(zip(BY_MOTOR, out, strict=True)), limits


def _velocity_warnings(motion: Motion) -> tuple[MotionWarning, ...]:
    """Joints whose velocities are not the slope of their positions, by slow parts of both."""
    if motion.velocity is None:
        return ()
    rate = 1 / float(np.median(np.diff(motion.time)))
    bandwidth = max(min(0.5, 0.1 * rate), smoothing.LEAST_BANDWIDTH * rate)
    slope, given = (
        smooth(motion, "spline", bandwidth, use).velocity for use in (False, True)
    )
    found = []
    for k, joint in enumerate(parameters().joints[: len(motion.joints)]):
        power = float(np.mean(slope[:, k] ** 2))
        if power < (0.02 * joint.velocity) ** 2:  # too slow to judge its velocities
            continue
        gain = float(np.mean(slope[:, k] * given[:, k])) / power
        if not 0.8 < gain < 1.25:
            text = f"{joint.name}'s velocities are {gain:.3g} times the slope of its positions"
            found.append(MotionWarning("velocity", 1, "all samples", text))
    return tuple(found)
