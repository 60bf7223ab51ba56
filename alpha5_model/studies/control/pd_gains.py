"""Gains of independent PD controllers, one for each joint, for a wanted bandwidth.

The controller of joint k is

    tau_k = K_k (q_goal - q)_k + D_k (v_goal - v)_k + tau_hold(q)_k + F_k sign(v_goal)_k

with tau_hold, the torque that holds weight and buoyancy, and F_k, the measured Coulomb
friction. The gains are ``K = w^2 I`` and ``D = 2 w I - B`` with the bandwidth w, the
joint's viscous friction B, and I, the largest inertia that the joint turns in any pose
and with any payload, that of the rotor, n^2 J, included. There the joint is critically
damped. Alone in any other, it is overdamped, because it turns less.

All K and D are multiples of the same matrix diag(I). So at each pose the four coupled
loops fall apart into four single ones, whose inertias are those of the gains divided by
the eigenvalues r of ``M(q)^-1 diag(I)``. Rotors behind large gears bring r close to 1.
Where r is above 1, the slowest pole is between w and w / 2, so that the loop settles to
2 % within ``2 ln(50) / w``. Where joints turn together, r is below 1, down to 0.5
without rotors. There the loop is underdamped and may need up to ``8.5 / w``.

What limits w is the delay. The phase margin, ``atan(2 x) - x w T`` at the crossover x
w, is concave in x, which grows with r. So it is the least at an end of the range of r.
Most often that is the largest: a joint that turns little inertia answers fast, perhaps
faster than the delay permits.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    FloatArray,
    array,
    bounded,
    float_array,
    frozen,
    instance,
    real,
)
from alpha5_model.dynamics.actuators import actuator
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.linear_model import motor_terms
from alpha5_model.dynamics.load import load
from alpha5_model.errors import InputError, MissingParameterError, ShapeError
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.motors import joint_losses
from alpha5_model.studies.control.loop import (
    LEAST_PHASE,
    Margins,
    fastest_bandwidth,
    margins,
)
from alpha5_model.studies.uncertainty.digit_bounds import bounds, torque_margin
from alpha5_model.water.arm import HydrodynamicArm

_JOINTS = 4
#: How many positions of axis_d, axis_c and axis_b stand for all.
_POSITIONS = (25, 25, 9)
#: And of axis_e, which changes torques only if the mount is tilted.
_POSITIONS_ON_TILTED_MOUNT = 9
#: Least bandwidth [rad/s]: a joint that takes months for a step.
_SLOWEST = 1e-6
#: Logarithm of the 50 that is left of a step when it has settled to 2 %.
_SETTLED = math.log(50.0)


@dataclass(frozen=True, eq=False)
class Gains:
    """Gains of an arm's joints, ``axis_e`` to ``axis_b``, and what they leave.

    Arrays are (4,). Torques are those at the joints.

    Attributes:
        arm: The arm, without payload, that the controller compensates.
        bandwidth: w [rad/s].
        rate: Samples per second.
        delay: From measuring a position to the change of the torque [s].
        quantisation: Of the measured positions [rad].
        payload: Up to which the gains are made [kg].
        stiffness: K [N m/rad].
        damping: D [N m s/rad].
        friction: Coulomb friction that is compensated while the goal moves, 0 unless it
            was measured [N m].
        inertia: The largest that each joint turns, n^2 J included [kg m^2].
        armature: The rotors' share n^2 J of it [kg m^2].
        torque_per_ampere: Joint torque of the motor current, K_t n eta [N m/A].
        ratio: The largest eigenvalue r: how much smaller the least inertia is.
        ratio_of_digits: How far the uncertain numbers of the arm move it.
        least_ratio: The smallest r, those numbers included; it is below 1 where joints
            turn together.
        margins: The least of the loops of all poses and payloads, those numbers
            included; the crossover is the fastest.
        fastest: The largest bandwidth that keeps a phase margin of 45 deg [rad/s].
        dead_band: Error at which the friction of the arm's record can hold a joint, F n
            / K [rad].
        sag: Error that the heaviest payload and the uncertain numbers cause together,
            if no friction holds the joint [rad].
        ripple: Change of the motor current by one count of the position [A].
    """

    arm: Arm
    bandwidth: float
    rate: float
    delay: float
    quantisation: float
    payload: float
    stiffness: FloatArray
    damping: FloatArray
    friction: FloatArray
    inertia: FloatArray
    armature: FloatArray
    torque_per_ampere: FloatArray
    ratio: float
    ratio_of_digits: float
    least_ratio: float
    margins: Margins
    fastest: float
    dead_band: FloatArray
    sag: FloatArray
    ripple: FloatArray

    @property
    def settling_time(self) -> float:
        """In which each loop falls to 2 % at every pose, without delay and limits [s].

        It is ``2 ln(50) / w``, and longer if ``least_ratio`` is below 0.55.
        """
        return _settling(self.least_ratio) / self.bandwidth

    def torque(
        self, q: ArrayLike, v: ArrayLike, goal: ArrayLike, v_goal: ArrayLike = 0.0
    ) -> FloatArray:
        """The controller: joint torque for a measured state, (4,) [N m].

        Args:
            q, v: Measured position and velocity, (4,).
            goal: Position, (4,) [rad].
            v_goal: Velocity of the goal, (4,) or one number [rad/s].

        Raises:
            InputError: Other shapes, or no finite numbers.
        """
        position, velocity = array("q", q, _JOINTS), array("v", v, _JOINTS)
        error = array("goal", goal, _JOINTS) - position
        rate = per_joint("v_goal", v_goal)
        return np.asarray(
            self.stiffness * error
            + self.damping * (rate - velocity)
            + self.arm.hydrostatic_torque(position)
            + self.friction * np.sign(rate)
        )


def gains(
    bandwidth: float | None = None,
    *,
    settling_time: float | None = None,
    rate: float,
    delay: float,
    quantisation: float = 0.0,
    payload: float = 0.0,
    rotor_inertias: ArrayLike | None = None,
    q: ArrayLike | None = None,
    arm: Arm | None = None,
) -> Gains:
    """PD gains for a bandwidth or a settling time.

    Args:
        bandwidth: w, the natural frequency of a joint with its largest inertia [rad/s].
        settling_time: Instead of it: ``settling_time`` of the result [s].
        rate: Samples per second of the controller [Hz].
        delay: From measuring a position to the change of the torque, the sampling
            itself left out [s].
        quantisation: Step of the measured positions [rad].
        payload: Heaviest point mass at the tcp [kg]; the lightest is none.
        rotor_inertias: Rotor and first gear stage at the motor shafts, (4,) or one for
            all [kg m^2]; None for those of the arm's record. Not published. 0 is a
            joint without gear and motor, as many simulations have it.
        q: Poses that the gains are for, (N, 4); None for all within the limits.
        arm: On a fixed base with locked jaws; None for the catalogue's in sea water. It
            may be in moving water, whose added mass counts.

    Raises:
        MissingParameterError: No rotor inertia.
        InputError: Also another arm, or a bandwidth that the delay does not permit; the
            message has the largest possible one.

    Warns:
        ImplausibleWarning: A time in ms, or a rotor inertia in another unit.
    """
    arm = load() if arm is None else four_joints(arm)
    asked, wanted = _asked(bandwidth, settling_time)
    rate = real("rate", rate)
    if not 1.0 <= rate <= 1e5:
        raise InputError("rate", rate, "1 to 100000 samples per second")
    delay = _within("delay", delay, 1.0, "s")
    quantisation = _within("quantisation", quantisation, 0.1, "rad")
    heaviest = real("payload", payload, minimum=0.0)
    loaded = arm.with_payload(heaviest) if heaviest else arm
    poses = _poses(arm) if q is None else np.atleast_2d(float_array("q", q, (_JOINTS,)))
    if poses.ndim != 2 or not len(poses):
        raise ShapeError("q", poses.shape, "at least one pose, (N, 4)")
    check_limits("q", poses, arm)

    motors = [actuator(name, arm=arm.parameters) for name in arm.joint_names]
    gears = np.array([motor.ratio for motor in motors])
    armature = gears**2 * _rotor_inertias(rotor_inertias, motors)
    per_ampere = (
        np.array([m.torque_constant * m.gear_efficiency for m in motors]) * gears
    )

    arms = [arm, loaded] if heaviest else [arm]
    matrices = np.concatenate([_mass_matrices(a, poses) for a in arms])
    matrices += np.diag(armature)
    inertia = np.diagonal(matrices, axis1=1, axis2=2).max(axis=0)
    ratio, of_digits, least = _ratios(arm, poses, matrices, inertia)

    total_delay = delay + 1 / rate
    ends = np.array([least, ratio + of_digits])
    fastest = min(fastest_bandwidth(r, total_delay) for r in ends.tolist())
    w = wanted if asked == "bandwidth" else _settling(least) / wanted
    if w > fastest:
        _refuse(asked, wanted, fastest, total_delay, ends)
    both = margins(w**2, 2 * w, 1 / ends, total_delay)

    stiffness = w**2 * inertia
    full_damping = 2 * w * inertia
    _, viscous = motor_terms(arm)
    damping = np.maximum(full_damping - viscous, 0.0)
    losses = joint_losses(arm.parameters)
    friction = [losses[n].friction if n in losses else 0.0 for n in arm.joint_names]
    in_record = np.array([motor.joint_friction for motor in motors])
    return Gains(
        arm=arm,
        bandwidth=w,
        rate=rate,
        delay=delay,
        quantisation=quantisation,
        payload=heaviest,
        stiffness=frozen(stiffness),
        damping=frozen(damping),
        friction=frozen(friction),
        inertia=frozen(inertia),
        armature=frozen(armature),
        torque_per_ampere=frozen(per_ampere),
        ratio=ratio,
        ratio_of_digits=of_digits,
        least_ratio=least,
        margins=Margins(
            crossover=both.crossover.max(),
            phase=both.phase.min(),
            delay=both.delay.min(),
            gain=both.gain.min(),
        ),
        fastest=fastest,
        dead_band=frozen(in_record / stiffness),
        sag=frozen(_wrong_hold(arm, loaded, poses) / stiffness),
        ripple=frozen(quantisation * (stiffness + damping * rate) / per_ampere),
    )


def four_joints(arm: Any) -> Arm:
    """An arm with the four joints that the gains are for.

    Raises:
        InputError: It is none.
    """
    checked = instance("arm", arm, Arm)
    if checked.floating_base or len(checked.joint_names) != _JOINTS:
        raise InputError("arm", arm, "an arm on a fixed base with locked jaws")
    return checked


def check_limits(name: str, q: FloatArray, arm: Arm) -> None:
    """Refuse positions (..., 4) of which one is beyond the limits of an arm.

    Raises:
        InputError: Such a position.
    """
    limits = arm.limits
    if limits.beyond(q).any():
        ends = ", ".join(
            f"{low:.4g} to {high:.4g}"
            for low, high in zip(limits.lower, limits.upper, strict=True)
        )
        raise InputError(name, q.tolist(), f"positions within {ends} rad")


def per_joint(name: str, given: ArrayLike, least: float = -math.inf) -> FloatArray:
    """Four numbers, or one for all; (4,).

    Raises:
        InputError: Another shape, or a number below the least.
    """
    values = float_array(name, given, ())
    if values.shape not in ((), (_JOINTS,)) or (values < least).any():
        bound = f" of at least {least:g}" if math.isfinite(least) else ""
        raise InputError(name, given, f"one or 4 numbers{bound}")
    return np.broadcast_to(bounded(name, values), _JOINTS).copy()


def _asked(bandwidth: Any, settling_time: Any) -> tuple[str, float]:
    """The name of what was asked for, and its value."""
    if (bandwidth is None) == (settling_time is None):
        given = "both" if bandwidth is not None else None
        raise InputError("bandwidth", given, "a bandwidth or a settling_time")
    if settling_time is None:
        return "bandwidth", real("bandwidth", bandwidth, _SLOWEST)
    longest = 2 * _SETTLED / _SLOWEST
    _within("settling_time", settling_time, longest, "s")
    time = real("settling_time", settling_time, 0.0, strict=True)
    plausibility.check("settling_time", time, plausibility.SETTLING_TIME)
    return "settling_time", time


def _settling(least_ratio: float) -> float:
    """Settling time to 2 %, times the bandwidth, of all r from the smallest up.

    A loop with r below 1 rings within ``exp(-r w t) / sqrt(1 - r)``. With r above 0.9
    this bound is useless, and the time is below that of a pole at w / 2.
    """
    r = min(least_ratio, 0.9)
    return max(2 * _SETTLED, (_SETTLED - math.log(1 - r) / 2) / r)


def _refuse(
    asked: str, wanted: float, fastest: float, delay: float, ratios: FloatArray
) -> None:
    """Say what the delay permits."""
    least, most = 1 / ratios.max(), 1 / ratios.min()
    reason = (
        f"delay and one sample are {1e3 * delay:.3g} ms; by pose, payload and digits "
        f"the inertia is {least:.3g} to {most:.3g} times that of the gains; "
        f"{math.degrees(LEAST_PHASE):g} deg of phase are left"
    )
    if asked == "bandwidth":
        possible = f"at most {three_digits(fastest)} rad/s"
    else:
        shortest = three_digits(_settling(ratios.min()) / fastest, up=True)
        possible = f"at least {shortest} s"
    raise InputError(asked, wanted, f"{possible} ({reason})")


def three_digits(number: float, up: bool = False) -> str:
    """A positive number, rounded down or up, so that a bound stays possible."""
    unit = 10.0 ** (math.floor(math.log10(number)) - 2)
    whole = math.ceil(number / unit) if up else math.floor(number / unit)
    return f"{whole * unit:.3g}"


def _within(name: str, value: float, largest: float, unit: str) -> float:
    number = real(name, value, minimum=0.0)
    if number > largest:
        raise InputError(name, value, f"at most {largest:g} {unit}")
    return number


def _rotor_inertias(given: ArrayLike | None, motors: list[Any]) -> FloatArray:
    """Of the motors, (4,) [kg m^2]: those given, or those of the record."""
    if given is not None:
        values = per_joint("rotor_inertias", given, least=0.0)
        plausibility.check("rotor_inertias", values.max(), plausibility.ROTOR_INERTIA)
        return values
    unknown = [motor.joint for motor in motors if motor.rotor_inertia is None]
    if unknown:
        raise MissingParameterError("rotor_inertias", f"the gain of {unknown[0]}")
    return np.array([motor.rotor_inertia for motor in motors])


def _poses(arm: Arm) -> FloatArray:
    """A grid over the limits, (N, 4)."""
    limits = arm.limits
    x, y, _ = arm._model.gravity.linear
    counts = (_POSITIONS_ON_TILTED_MOUNT if x or y else 1, *_POSITIONS)
    ends = zip(limits.lower, limits.upper, counts, strict=True)
    return np.array(list(product(*(np.linspace(*end) for end in ends))))


def _mass_matrices(arm: Arm, poses: FloatArray) -> FloatArray:
    """M(q) of each row, (N, 4, 4), by inverse dynamics of unit accelerations."""
    still = np.zeros((1, _JOINTS))
    at_rest = arm.inverse_dynamics_batch(poses, still, still)
    columns = [
        arm.inverse_dynamics_batch(poses, still, unit[None]) - at_rest
        for unit in np.eye(_JOINTS)
    ]
    matrices = np.stack(columns, axis=-1)
    return np.asarray((matrices + matrices.transpose(0, 2, 1)) / 2)


def _ratios(
    arm: Arm, poses: FloatArray, matrices: FloatArray, inertia: FloatArray
) -> tuple[float, float, float]:
    """The largest eigenvalue r of ``M^-1 diag(I)``, what the digits add, the smallest.

    What the digits take from the smallest is already subtracted.
    """
    root = np.sqrt(inertia)
    values, vectors = np.linalg.eigh(matrices / np.outer(root, root))

    def ratio(k: int, column: int) -> tuple[float, float]:
        """One eigenvalue r, and how far the digits move it.

        With the eigenvector x it is ``x' diag(I) x / x' M x``. To first order the
        digits change the last factor alone, twice the kinetic energy at the velocity x.
        """
        x = vectors[k, :, column] / root
        x /= np.linalg.norm(x)
        # Added mass is not one of the digits.
        still = arm.still if isinstance(arm, HydrodynamicArm) else arm
        pose = poses[k % len(poses)]
        energy = bounds(pose, x, np.zeros(_JOINTS), still).kinetic_energy
        r = 1 / float(values[k, column])
        return r, float(r * (energy.upper - energy.lower) / (x @ matrices[k] @ x))

    largest, more = ratio(int(values[:, 0].argmin()), 0)
    smallest, less = ratio(int(values[:, -1].argmax()), -1)
    return largest, more, smallest - less


def _wrong_hold(arm: Arm, loaded: Arm, poses: FloatArray) -> FloatArray:
    """Largest torque at rest that the compensation does not know, (4,) [N m]."""
    still = np.zeros((1, _JOINTS))
    of_payload = loaded.inverse_dynamics_batch(poses, still, still)
    of_payload -= arm.inverse_dynamics_batch(poses, still, still)
    # The digits' share changes slowly with the pose, and costs more time.
    some = poses[:: max(1, len(poses) // 200)]
    _, of_digits = torque_margin(arm, some, still, still)
    return np.asarray(np.abs(of_payload).max(axis=0) + of_digits.max(axis=0))
