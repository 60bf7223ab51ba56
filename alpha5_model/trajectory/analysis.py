"""Torques by cause, motor currents, power, mount load and TCP path of a motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, choice, frozen, real
from alpha5_model._support.renaming import renamed
from alpha5_model._support.text import short_repr
from alpha5_model.dynamics.actuators import Actuator, Interval, actuator
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.trajectory import smoothing
from alpha5_model.trajectory.checks import HOLD, SUPPLY
from alpha5_model.trajectory.motions import Motion, MotionWarning
from alpha5_model.trajectory.motors import Drive, drive_limits, motor_columns
from alpha5_model.trajectory.smoothing import SmoothMotion, smooth_for
from alpha5_model.trajectory.tables import Progress

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm
    from alpha5_model.water.terms import WaterTerms

#: Causes that take torque in the motor: they are in the current, not in the torque.
AT_MOTORS = ("rotor", "friction")
#: Velocities and positions are compared as means over this time [s], and over so many
#: samples at least: noise and held values do not count.
_SLOW = 2.0
_SLOW_SAMPLES = 10.0
#: A joint whose speed is below this share of its rated speed is too slow to judge.
_JUDGED_SHARE = 0.02
#: The same for a joint all of whose velocities are zero.
_ZERO_SHARE = 0.002
#: Velocities outside these multiples of the slope of positions are implausible.
_LEAST_GAIN = 0.8
_MOST_GAIN = 1.25
#: A fault of a moment, such as a spike, shows in means over this time [s], and over so
#: many samples at least, by this share of the rated speed. Longer steps are gaps.
_MOMENT = 0.5
_MOMENT_SAMPLES = 10.0
_MOMENT_SHARE = 0.3
_GAP_SAMPLES = 3.0
#: Lags to each side at which velocities and positions are compared.
_LAGS = 5
#: A payload may double the torque of the model and its friction. In milliamperes an
#: effort is some 50 times that in N m: Table 4's motors give 1 N m with 43 to 108 mA.
_MOST_OF_TORQUE = 2.0
_MILLI = 1e-3


@dataclass(frozen=True, eq=False)
class Analysis:
    """Torques, motor currents, powers and mount load of a motion.

    Rows are samples, columns joints from base to tip. Torques are those at the joint:
    N m, for the jaw rod N. ``torque`` is the sum of ``inertia``, ``coriolis``,
    ``weight``, ``buoyancy`` and, with a water current, of moving water.
    ``torque + friction``, with ``rotor`` if it is known, is what the motor gives,
    ``K_t i`` times the gear ratio. Columns of a motor that cannot be computed (jaw rod
    without screw lead) are NaN.

    Attributes:
        motion: The samples as given.
        smooth: Positions, velocities and accelerations that the rest is computed from.
        actuators: Motor of each joint.
        arm: The model.
        inertia, coriolis, weight, buoyancy: Torques by cause, (N, n).
        torque: Joint torque, (N, n).
        friction: Motor friction and gear loss at the joint, (N, n). At rest, friction
            holds the load, and the motor adds the least torque that keeps it there:
            mostly none.
        current: Motor currents, (N, n) [A].
        current_lower, current_upper: Over the printed tolerance of friction,
            (N, n) [A].
        voltage: Winding voltages, (N, n) [V]; di/dt is left out (L/R is below 0.1 ms).
        electrical_power, mechanical_power: (N, n) [W]; negative while the joint feeds
            power back.
        base_wrench: Force and moment on the mount at base_link, in its axes,
            (N, 6) [N, N m].
        tcp: TCP in base_link, (N, 3) [m].
        torque_limits: Lower and upper (N, n) limits from supply voltage and current
            limit; None without them.
        supply_voltage: Of the motors [V]; None if it is not given.
        current_limit: Of the motors' drives [A]; None if it is not given, or if the
            motors have different ones.
        warnings: Warnings about the motion, including velocities that contradict the
            positions.
        moving_water: What a water current adds, (N, 3, n) with all numbers low, nominal
            and high. ``torque``, ``base_wrench`` and all that follows from them include
            the nominal values. None if no water current was given.
        current_limits: Limit of the current of each motor, (n,) [A]; None for one that
            is not known.
        effort: Recorded joint torques, (N, n) [N m], jaw rod [N]; NaN if unknown, None
            if there are none.
        recorded_current: Recorded currents of the motors, (N, n) [A]; NaN if unknown,
            None if there are none. Efforts of the motion that are milliamperes are
            here.
        rotor: What turns the rotors, at the joint, (N, n); 0 at rest, and for a motor
            whose rotor inertia is unknown. None if it is unknown of all.
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
    current_limits: tuple[float | None, ...] = ()
    effort: FloatArray | None = None
    recorded_current: FloatArray | None = None
    rotor: FloatArray | None = None

    __repr__ = short_repr

    def causes(self) -> dict[str, FloatArray]:
        """Torques by cause, (N, n) each; those of `AT_MOTORS` are the last."""
        causes = {
            "inertia": self.inertia,
            "coriolis": self.coriolis,
            "weight": self.weight,
            "buoyancy": self.buoyancy,
        }
        if self.moving_water is not None:
            causes["moving_water"] = self.moving_water.torque[:, 1]
        if self.rotor is not None:
            causes["rotor"] = self.rotor
        causes["friction"] = self.friction
        return causes


@renamed("current", "water_velocity")
def analyse(
    motion: Motion,
    arm: Alpha5Parameters | Arm | None = None,
    *,
    method: str = "spline",
    bandwidth: float = smoothing.DEFAULT_BANDWIDTH,
    use_velocity: bool | None = None,
    constants: str | None = None,
    actuators: Mapping[str, Actuator] | None = None,
    supply_voltage: float | None = None,
    current_limit: float | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    water_velocity: ArrayLike | None = None,
    efficiency: str = "gearbox",
) -> Analysis:
    """Torques, currents, powers, mount load and TCP path of a motion.

    Args:
        motion: From `read_motion` or `motion`.
        arm: The model; its joints decide whether the jaw rod is used. A record, or
            None for the catalogue's, is loaded in sea water, with jaws if the motion
            has ``axis_a``. The arm of a record of your own has the motors, supply
            voltage and current limits of that record.
        method, bandwidth, use_velocity: See `alpha5_model.trajectory.smoothing.smooth`.
        constants: Which of the contradicting motor constants to use
            (`alpha5_model.dynamics.actuators`); None for those of the arm's record,
            ``"printed"`` for the catalogue's.
        actuators: Motors by joint name, in place of the arm's own, for example with a
            rotor inertia.
        supply_voltage: Of the motors [V]; with ``current_limit`` it adds the
            speed-torque limits. Not published; None for the arm's record.
        current_limit: Electric current limit of the motors' drives [A]; not published,
            None for those of the arm's record.
        threads: Of Pinocchio; None for all that this process may use.
        progress: Called with a stage's name and the part done, 0 to 1.
        water_velocity: Velocity of the water in base_link, (3,) [m/s]. It adds drag and
            added mass, which are estimated, not published. None for still water, with
            buoyancy only.
        efficiency: Whose efficiency Table 4's eta_max is
            (`alpha5_model.dynamics.actuators`).

    Raises:
        InputError: No `Arm`, an arm with other joints than the motion, or one limit
            without the other.
        UnknownNameError: No such method, constants, efficiency or joint.
    """
    # Pinocchio, which reading and smoothing do not need, takes long to import.
    from alpha5_model.dynamics.batch import frame_positions
    from alpha5_model.dynamics.load import loaded
    from alpha5_model.dynamics.torque_causes import torque_terms
    from alpha5_model.water.terms import water_terms

    gripper = "jaws" if JOINT_NAMES[4] in motion.joints else "locked"
    arm = loaded(arm, gripper=gripper)
    motion = _motion_for_arm(motion, arm)
    drive = _drive(arm.parameters, motion.joints, supply_voltage, current_limit)
    motors = {
        joint: actuator(joint, constants, efficiency=efficiency, arm=arm.parameters)
        for joint in motion.joints
    }
    for joint, own in (actuators or {}).items():
        motors[choice("joint", joint, motion.joints)] = own

    doubts = _velocity_warnings(motion, arm.parameters, used=use_velocity is True)
    if doubts and use_velocity is None:
        use_velocity = False
    smooth = smooth_for(arm.parameters, motion, method, bandwidth, use_velocity)
    state = smooth.position, smooth.velocity, smooth.acceleration

    terms = torque_terms(arm, *state, threads)
    torque = terms.inertia + terms.coriolis + terms.weight + terms.buoyancy
    base_wrench = arm.base_wrench_batch(*state, threads)
    moving_water: WaterTerms | None = None
    if water_velocity is not None:
        moving_water = water_terms(arm, *state, water_velocity)
        nominal = 1
        torque = torque + moving_water.torque[:, nominal]
        base_wrench = base_wrench + moving_water.wrench[:, nominal]
    if progress:
        progress("compute", 1.0)

    of_motors = tuple(motors.values())
    by_motor = motor_columns(of_motors, smooth, torque)
    has_rotor = any(motor.rotor_inertia is not None for motor in of_motors)
    effort, recorded_current, of_unit = _recorded(motion, torque, of_motors)

    return Analysis(
        motion=motion,
        smooth=smooth,
        actuators=of_motors,
        arm=arm,
        inertia=frozen(terms.inertia),
        coriolis=frozen(terms.coriolis),
        weight=frozen(terms.weight),
        buoyancy=frozen(terms.buoyancy),
        torque=frozen(torque),
        friction=frozen(by_motor["friction"]),
        current=frozen(by_motor["current"]),
        current_lower=frozen(by_motor["current_lower"]),
        current_upper=frozen(by_motor["current_upper"]),
        voltage=frozen(by_motor["voltage"]),
        electrical_power=frozen(by_motor["electrical_power"]),
        mechanical_power=frozen(torque * smooth.velocity),
        base_wrench=frozen(base_wrench),
        tcp=frozen(frame_positions(arm, smooth.position)),
        torque_limits=drive_limits(of_motors, smooth, torque, drive),
        supply_voltage=None if drive is None else drive.supply_voltage,
        current_limit=None if drive is None else _shared(drive.current_limits),
        warnings=(*motion.warnings, *doubts, *of_unit),
        moving_water=moving_water,
        current_limits=() if drive is None else drive.current_limits,
        effort=effort,
        recorded_current=recorded_current,
        rotor=frozen(by_motor["rotor"]) if has_rotor else None,
    )


def _motion_for_arm(motion: Motion, arm: Arm) -> Motion:
    """The motion without the jaw rod, if the arm's gripper is locked.

    Raises:
        InputError: No `Arm` on a fixed base, or a motion without one of its joints.
    """
    from alpha5_model.dynamics.arm import Arm

    if not isinstance(arm, Arm) or arm.has_hydrodynamics:
        expected = "an Arm in still water (moving water: the argument water_velocity)"
        raise InputError("arm", type(arm).__name__, expected)
    if arm.floating_base or arm.model.nv not in (4, 5):
        found = f"a model with nv = {arm.model.nv}"
        raise InputError("arm", found, "an arm on a fixed base")

    wanted = JOINT_NAMES[: arm.model.nv]
    if len(wanted) > len(motion.joints):
        expected = "a motion of axis_a too, since the arm's gripper has jaws"
        raise InputError("motion", motion.joints, expected)
    if len(wanted) == len(motion.joints):
        return motion

    def of_arm(values: FloatArray | None) -> FloatArray | None:
        return None if values is None else values[:, :4]

    rod = JOINT_NAMES[4]
    return replace(
        motion,
        joints=wanted,
        position=motion.position[:, :4],
        velocity=of_arm(motion.velocity),
        warnings=tuple(w for w in motion.warnings if w.joint != rod),
        ignored=(*motion.ignored, rod),
        effort=of_arm(motion.effort),
        current=of_arm(motion.current),
    )


def _drive(
    parameters: Alpha5Parameters,
    joints: Sequence[str],
    supply_voltage: float | None,
    current_limit: float | None,
) -> Drive | None:
    """The limits of the motors' drives; None if none are known.

    Raises:
        InputError: One limit without the other, or a limit that is no number.
    """
    if supply_voltage is not None:
        supply_voltage = real("supply_voltage", supply_voltage)
    if current_limit is not None:
        current_limit = real("current_limit", current_limit)

    known = parameters.motors
    limits = known.current_limits[: len(joints)]
    if current_limit is not None:
        limits = (current_limit,) * len(joints)
    supply = known.supply_voltage if supply_voltage is None else supply_voltage

    limited = any(limit is not None for limit in limits)
    if supply is not None and limited:
        return Drive(supply_voltage=supply, current_limits=limits)
    if supply_voltage is None and current_limit is None:
        return None
    given = (supply_voltage, current_limit)
    name = "supply_voltage and current_limit"
    raise InputError(name, given, "both or neither")


def _shared(limits: Sequence[float | None]) -> float | None:
    """The current limit of all motors; None if they differ."""
    first, *others = {*limits}
    return None if others else first


def _recorded(
    motion: Motion, torque: FloatArray, motors: Sequence[Actuator]
) -> tuple[FloatArray | None, FloatArray | None, list[MotionWarning]]:
    """Efforts and currents of a motion; efforts that are milliamperes are currents.

    They are if they are more than twice what the motion takes with friction, and
    possible as currents. The jaw rod does not count. Recorded currents come first.

    Args:
        motion: What was recorded.
        torque: At the joints, (N, n) [N m].
        motors: Of the n joints.
    """
    effort = motion.effort
    if effort is None:
        return None, motion.current, []
    turning = slice(0, 4)
    known = np.isfinite(effort[:, turning])
    recorded = np.where(known, effort[:, turning], 0.0)
    friction = np.array([motor.joint_friction for motor in motors[turning]])
    possible = np.where(known, np.abs(torque[:, turning]) + friction, 0.0)
    stalled = max(SUPPLY / motor.parameters.resistance for motor in motors)

    ratio = float(np.linalg.norm(recorded)) / max(float(np.linalg.norm(possible)), 1e-9)
    if ratio <= _MOST_OF_TORQUE or np.abs(recorded).max() * _MILLI > stalled:
        return effort, motion.current, []
    text = (
        f"efforts read in mA and compared with the currents: as N m they are "
        f"{ratio:.3g} times the torque with friction"
    )
    warning = MotionWarning(kind="effort_unit", count=1, first="all samples", text=text)
    if motion.current is not None:
        return None, motion.current, [warning]
    return None, frozen(effort * _MILLI), [warning]


def _velocity_warnings(
    motion: Motion, parameters: Alpha5Parameters, used: bool
) -> list[MotionWarning]:
    """Warnings about velocities that are not the slope of their positions.

    `used` says whether the velocities are used in spite of it.
    """
    if motion.velocity is None:
        return []
    step = float(np.median(np.diff(motion.time)))
    window = max(_SLOW, _SLOW_SAMPLES * step)
    steps = np.diff(motion.time)[:, None]
    sums = np.cumsum((motion.velocity[1:] + motion.velocity[:-1]) / 2 * steps, axis=0)
    way = np.vstack([np.zeros(len(motion.joints)), sums])
    pieces = smoothing.pieces_of(parameters, motion)
    of_positions, given = (
        np.concatenate(
            [smoothing.mean_slope(motion.time[x], signals[x], window) for x in pieces]
        )
        for signals in (motion.position, way)
    )
    beyond = np.concatenate(
        [_beyond(motion.time[x], motion.position[x], way[x], step) for x in pieces]
    )

    warnings = []
    for k, joint in enumerate(parameters.joints[: len(motion.joints)]):
        slope = of_positions[:, k]
        power = float(np.mean(slope**2))
        never_moves = not motion.velocity[:, k].any()
        least = _ZERO_SHARE if never_moves else _JUDGED_SHARE
        judged = power > (least * joint.velocity) ** 2
        gain = float(np.mean(slope * given[:, k])) / power if judged else 1.0
        is_off = beyond[:, k] > _MOMENT_SHARE * joint.velocity
        count, first = 1, "all samples"
        if not _LEAST_GAIN < gain < _MOST_GAIN:
            what = f"are {gain:.3g} times the slope of its positions"
        elif joint.name != JOINT_NAMES[4] and is_off.any():
            edges = np.flatnonzero(np.diff(is_off, prepend=False, append=False))
            count = edges.size // 2
            middle = (edges[0] + edges[1] - 1) // 2
            first = f"at {motion.time[middle]:.12g} s"
            what = "are not the slope of its positions at some times"
        else:
            continue
        if not used:
            what += ", so that no velocities are used"
        warning = MotionWarning(
            kind="velocity",
            count=count,
            first=first,
            text=f"{joint.name}'s velocities {what}",
            joint=joint.name,
        )
        warnings.append(warning)
    return warnings


def _beyond(
    time: FloatArray, position: FloatArray, way: FloatArray, step: float
) -> FloatArray:
    """How far velocities are from all slopes of positions at nearly their time, (N, n).

    Recordings hold positions, so that either may lag behind the other. Both are means
    over a moment; the time of gaps, in which nothing is known, does not count.

    Args:
        time: (N,) [s].
        position: (N, n) [rad], jaw rod [m].
        way: Integral of the velocities, (N, n).
        step: Median sample time [s].
    """
    window = max(_MOMENT, _MOMENT_SAMPLES * step)
    is_gap = np.diff(time) > max(HOLD, _GAP_SAMPLES * step)

    def slopes(signals: FloatArray) -> FloatArray:
        changes = np.where(is_gap[:, None], 0.0, np.diff(signals, axis=0))
        start = np.zeros((1, signals.shape[1]))
        sums = np.cumsum(np.vstack([start, changes]), axis=0)
        return smoothing.mean_slope(time, sums, window)

    of_positions = slopes(position)
    given = slopes(way)
    lag = max(HOLD, step)
    near = np.array(
        [
            [np.interp(time + shift, time, slope) for slope in of_positions.T]
            for shift in np.linspace(-lag, lag, 2 * _LAGS + 1)
        ]
    )
    below = near.min(axis=0).T - given
    above = given - near.max(axis=0).T
    return np.asarray(np.maximum(np.maximum(below, above), 0.0))
