"""A step of the joints under a controller with the limits of real hardware.

The arm's equation of motion, with rotor inertia, viscous and Coulomb friction, is
integrated by small steps of the semi-implicit Euler method. Between its samples the
controller sees nothing. It sees positions in whole counts, takes the velocity as the
difference of two of them, and its currents are limited and act late.

Coulomb friction is an impulse of each small step. It stops a joint if it can, and
otherwise is as large as it can be; the four are found by projected Gauss-Seidel, as in
engines of contact [Catto2005].

[Catto2005] Catto: Iterative dynamics with temporal coherence, GDC 2005.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, array, frozen, instance, real
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.linear_model import motor_terms
from alpha5_model.errors import InputError
from alpha5_model.numbers import plausibility
from alpha5_model.studies.control.pd_gains import (
    Gains,
    check_limits,
    four_joints,
    per_joint,
)

_JOINTS = 4
#: Longest step of the integrator [s].
_STEP = 1e-3
#: The joints rest in the last part of the time, in which errors are looked at.
_LAST = 0.2
#: Longest simulation [s], about a minute of computing.
_LONGEST = 60.0


@dataclass(frozen=True, eq=False)
class Step:
    """A simulated step; N samples of the controller.

    Attributes:
        time: (N,) [s].
        goal: Of the joints, which moves at most at the rated speeds, (N, 4) [rad].
        position: True ones, (N, 4) [rad].
        current: Motor currents, (N, 4) [A].
        error: Largest distance from the last goal in the last fifth of the time, (4,)
            [rad].
        tolerance: Error that is allowed [rad].
        settled: When each joint comes within this tolerance for good, (4,) [s]; NaN if
            it does not.
        overshoot: Farthest beyond the last goal, (4,) [rad].
        limited: Share of the samples with the current at its limit, (4,).
        dead_band: Error at which the true friction can hold a joint, F / K, (4,) [rad].
    """

    time: FloatArray
    goal: FloatArray
    position: FloatArray
    current: FloatArray
    error: FloatArray
    tolerance: float
    settled: FloatArray
    overshoot: FloatArray
    limited: FloatArray
    dead_band: FloatArray

    @property
    def holds(self) -> bool:
        """Whether all joints reach their goals within the tolerance, and stay."""
        return bool(np.isfinite(self.settled).all())


def step(
    found: Gains,
    start: ArrayLike,
    goal: ArrayLike,
    *,
    current_limit: ArrayLike,
    friction: ArrayLike | None = None,
    arm: Arm | None = None,
    tolerance: float = 0.05,
    duration: float | None = None,
) -> Step:
    """Simulate a step under the controller of some gains.

    Args:
        found: The gains, with their rate, delay and quantisation.
        start, goal: Positions, (4,) [rad]. The goal moves from one to the other at the
            rated speeds.
        current_limit: Of the drivers, (4,) or one for all [A].
        friction: True Coulomb friction of the joints, (4,) or one for all [N m]; None
            for that of the arm's record.
        arm: The true arm, such as one with a payload; None for the arm of the gains.
            Its motors are those of the gains.
        tolerance: Error that is allowed at the end, of each joint [rad].
        duration: [s]; None for the motion of the goal and twice the settling time.

    Raises:
        InputError: Positions beyond the limits, values that no hardware has, or a
            duration above 60 s.

    Warns:
        ImplausibleWarning: A current limit that is most likely in mA.
    """
    instance("found", found, Gains)
    plant = found.arm if arm is None else four_joints(arm)
    first, last = array("start", start, _JOINTS), array("goal", goal, _JOINTS)
    limits = found.arm.limits
    check_limits("start", first, found.arm)
    check_limits("goal", last, found.arm)
    amperes = per_joint("current_limit", current_limit, least=0.0)
    if not amperes.all():
        raise InputError("current_limit", current_limit, "currents above 0 A")
    for ampere in amperes.tolist():
        plausibility.check("current_limit", ampere, plausibility.CURRENT_LIMIT)
    largest = amperes * found.torque_per_ampere
    dry = found.dead_band * found.stiffness
    if friction is not None:
        dry = per_joint("friction", friction, least=0.0)

    tolerance = real("tolerance", tolerance, minimum=0.0, strict=True)

    moving = float((np.abs(last - first) / limits.velocity).max())
    if duration is None:
        duration = moving + 2 * found.settling_time
    seconds = real("duration", duration, minimum=0.0, strict=True)
    if seconds > _LONGEST:
        raise InputError("duration", seconds, f"at most {_LONGEST:g} s to simulate")

    period = 1 / found.rate
    n = max(2, math.ceil(seconds / period))
    time: FloatArray = np.arange(n, dtype=np.float64) * period
    velocity = np.sign(last - first) * limits.velocity
    travelling = time[:, None] * limits.velocity < np.abs(last - first)
    goals = np.where(travelling, first + time[:, None] * velocity, last)
    goal_rates = np.where(travelling, velocity, 0.0)

    q, v = first.copy(), np.zeros(_JOINTS)
    seen_before = _counted(q, found.quantisation)
    # Before the first command arrives, the drivers hold the arm.
    torque = np.clip(found.torque(q, v, q), -largest, largest)
    on_the_way: deque[tuple[float, FloatArray]] = deque()
    substeps = math.ceil(period / _STEP)
    h = period / substeps
    body = _Body(plant, found.armature, dry, h)
    positions, currents = np.empty((2, n, _JOINTS))

    for k in range(n):
        seen = _counted(q, found.quantisation)
        rate = (seen - seen_before) * found.rate
        seen_before = seen
        wanted = found.torque(seen, rate, goals[k], goal_rates[k])
        command = np.clip(wanted, -largest, largest)
        on_the_way.append((time[k] + found.delay, command))
        positions[k], currents[k] = q, command / found.torque_per_ampere
        for i in range(substeps):
            now = time[k] + (i + 0.5) * h
            while on_the_way and on_the_way[0][0] <= now:
                _, torque = on_the_way.popleft()
            v = body.next_velocity(q, v, torque)
            q = q + h * v
        if not np.abs(q).max() < 1e3:
            expected = "gains and hardware that do not throw the arm about"
            raise InputError("found", f"{seconds:g} s with these gains", expected)

    settled = np.full(_JOINTS, np.nan)
    left = np.abs(positions - last)
    end = int((1 - _LAST) * n)
    for joint in range(_JOINTS):
        outside = np.flatnonzero(left[:, joint] > tolerance)
        after = outside[-1] + 1 if outside.size else 0
        if after <= end:
            settled[joint] = time[after]
    beyond = (positions - last) * np.sign(last - first)
    at_limit = np.abs(currents) * found.torque_per_ampere >= largest * (1 - 1e-9)
    return Step(
        time=frozen(time),
        goal=frozen(goals),
        position=frozen(positions),
        current=frozen(currents),
        error=frozen(left[end:].max(axis=0)),
        tolerance=tolerance,
        settled=frozen(settled),
        overshoot=frozen(np.maximum(beyond, 0.0).max(axis=0)),
        limited=frozen(at_limit.mean(axis=0)),
        dead_band=frozen(dry / found.stiffness),
    )


class _Body:
    """The arm with its motors, whose velocity small steps change.

    Args:
        arm: Its links and water.
        armature: (4,) [kg m^2].
        friction: Coulomb friction, (4,) [N m].
        h: Time step [s].
    """

    def __init__(
        self, arm: Arm, armature: FloatArray, friction: FloatArray, h: float
    ) -> None:
        self._arm = arm
        _, damping = motor_terms(arm)
        self._motors = np.diag(armature + h * damping)
        self._damping = damping
        self._most = friction * h
        self._h = h

    def next_velocity(
        self, q: FloatArray, v: FloatArray, tau: FloatArray
    ) -> FloatArray:
        """The velocity one step later, (4,)."""
        matrix = self._arm.mass_matrix(q) + self._motors
        inverse = np.linalg.inv(matrix)
        force = tau - self._damping * v - self._arm.nonlinear_effects(q, v)
        free: FloatArray = v + self._h * inverse @ force

        # Impulses that stop the joints, as far as friction can.
        impulse = np.zeros(_JOINTS)
        for _ in range(100):
            before = impulse.copy()
            for k in range(_JOINTS):
                stop = impulse[k] + free[k] / inverse[k, k]
                stop = min(max(stop, -self._most[k]), self._most[k])
                free = free - inverse[:, k] * (stop - impulse[k])
                impulse[k] = stop
            if np.abs(impulse - before).max() <= 1e-9 * self._most.max():
                break
        return free


def _counted(q: FloatArray, count: float) -> FloatArray:
    """Positions in whole counts."""
    return np.round(q / count) * count if count else q.copy()
