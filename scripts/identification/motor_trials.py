"""How well `a5.calibrate.motors` finds motors, from simulated currents.

    python scripts/identification/motor_trials.py --trials 40 --seconds 240

The torques are Pinocchio's; the currents are made here, by motors with more friction
at low speed (Stribeck), a ripple over the joint's angle, friction and a zero that
drift, and noise of 5 mA. The sway has 20 Hz and stays below the rated speeds.
"""

from __future__ import annotations

import argparse
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

import alpha5_model as a5
from alpha5_model.errors import InputError

#: Static currents of axis_e, axis_d, axis_c and axis_b [A]: Table 4's, a driver's.
TABLE_4 = np.array([0.28, 0.28, 0.28, 0.017])
DRIVER = np.array([0.043, 0.043, 0.043, 0.017])
#: Backward friction over forward; torque per ampere [N m/A].
BACKWARD = 0.92
PER_AMPERE = np.array([24.3, 24.3, 24.3, 7.1])
#: Current per speed [A s/rad] and per acceleration [A s^2/rad].
VISCOUS = 0.02
ARMATURE = 0.003
NOISE = 0.005
MASS = 0.3


class Sway(NamedTuple):
    """Times and exact states of a motion, and its torques by Pinocchio, (N, 4)."""

    time: np.ndarray
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    torque: np.ndarray


def sway(payload: float = 0.0, seconds: float = 60.0) -> Sway:
    """All joints sway for some seconds; the tool point may carry a mass [kg]."""
    time = np.arange(0.0, seconds, 0.05)
    rate = 2 * np.pi * np.array([0.11, 0.07, 0.13, 0.17])
    size = np.minimum([0.6, 0.9, 0.55, 0.6], 0.45 / rate)
    slow = np.outer(time, rate)
    fast = 2.37 * slow
    q = np.array([3.0, 1.7, 1.7, 3.0]) + size * (
        0.75 * np.sin(slow) + 0.25 / 2.37 * np.sin(fast)
    )
    v = size * rate * (0.75 * np.cos(slow) + 0.25 * np.cos(fast))
    a = -size * rate**2 * (0.75 * np.sin(slow) + 0.25 * 2.37 * np.sin(fast))

    arm = a5.load().with_payload(mass=payload) if payload else a5.load()
    data = arm.model.createData()
    water = arm.fluid_model.createData()
    torque = [
        pin.rnea(arm.model, data, *state)
        - pin.computeGeneralizedGravity(arm.fluid_model, water, state[0])
        for state in zip(q, v, a, strict=True)
    ]
    return Sway(time=time, q=q, v=v, a=a, torque=np.array(torque))


def currents(motion: Sway, static: np.ndarray, seed: int) -> np.ndarray:
    """Recorded currents of axis_e to axis_b, (N, 4) [A].

    Args:
        motion: Of the arm.
        static: Current of the friction forward, (4,) [A].
        seed: Of the noise.
    """
    rng = np.random.default_rng(seed)
    columns = []
    for k in range(4):
        v = motion.v[:, k]
        drift = 0.04 * np.sin(2 * np.pi * motion.time / 90 + k)
        ripple = 0.05 * np.sin(40 * motion.q[:, k])
        stribeck = 0.2 * np.exp(-((v / 0.03) ** 2))
        way = np.tanh(v / 0.002)
        friction = static[k] * np.where(way > 0, 1.0, BACKWARD)
        friction = friction * (1 + drift - drift.mean()) * (1 + ripple) * (1 + stribeck)
        zero = 0.003 * np.sin(2 * np.pi * motion.time / 70)
        of_motor = VISCOUS * v + ARMATURE * motion.a[:, k]
        load = motion.torque[:, k] / PER_AMPERE[k]
        noise = rng.normal(scale=NOISE, size=len(v))
        columns.append(load + friction * way + of_motor + zero - zero.mean() + noise)
    return np.column_stack(columns)


def found(motion: Sway, current: np.ndarray, arm: Any = None, **options: Any) -> Any:
    """The calibration of simulated currents."""
    recorded = a5.trajectory.motion(motion.time, motion.q, current=current)
    return a5.calibrate.motors(recorded, arm, method="interpolate", **options)


def errors(calibration: Any, static: np.ndarray) -> np.ndarray:
    """Errors of forward and backward friction and torque per ampere, (4, 3)."""
    rows = []
    for joint, friction, per_ampere in zip(
        calibration.joints, static, PER_AMPERE, strict=True
    ):
        rows.append(
            [
                joint.friction_forward / friction - 1,
                joint.friction_backward / (BACKWARD * friction) - 1,
                joint.torque_per_ampere / per_ampere - 1,
            ]
        )
    return np.array(rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, default=40)
    parser.add_argument("--seconds", type=float, default=60.0)
    given = parser.parse_args()
    trials = given.trials
    bare = sway(seconds=given.seconds)
    heavy = sway(MASS, given.seconds)
    for name, static in (("Table 4, 280 mA", TABLE_4), ("driver, 43 mA", DRIVER)):
        fits = [found(bare, currents(bare, static, k)) for k in range(trials)]
        squares = np.square([errors(one, static) for one in fits])
        spread = 100 * np.sqrt(squares.mean(axis=0))
        print(f"{name}: rms error of friction, backward friction, K_t gear (%)")
        for joint, row in zip(fits[0].joints, spread, strict=True):
            print(f"  {joint.name} {row[0]:5.1f} {row[1]:5.1f} {row[2]:5.1f}")

        off, refused = [], 0
        arm = a5.load(arm=fits[0].parameters)
        for k in range(trials):
            current = currents(heavy, static, 1000 + k)
            try:
                weighed = found(heavy, current, arm, payload=True).payload
            except InputError as error:
                refused += 1
                print(f"  refused: {error}") if refused == 1 else None
            else:
                off.append(weighed.mass - MASS)
        if off:
            root = 1e3 * np.sqrt(np.mean(np.square(off)))
            print(f"  payload of {1e3 * MASS:.0f} g: rms error {root:.0f} g")
        print(f"  payload refused in {refused} of {trials}")


if __name__ == "__main__":
    main()
