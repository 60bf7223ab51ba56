"""How well `a5.calibrate.motors` finds motors, from simulated currents.

    python scripts/identification/motor_trials.py noise --trials 100
    python scripts/identification/motor_trials.py rough --trials 40 --seconds 240
    python scripts/identification/motor_trials.py faults --trials 20

The torques are Pinocchio's; the currents are made here. `noise`: motors as in the
model, with noise that is correlated. `rough`: motors with more friction at low speed
(Stribeck), a ripple over the joint's angle, friction and a zero that drift, and white
noise of 5 mA; a payload is weighed, too. `faults`: recordings in another fluid, with
swapped columns, or upside down. The sway has 20 Hz and stays below the rated speeds.
Plain least squares has the same columns, without drift, prior and correlation.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from scipy.signal import lfilter

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
#: White noise of rough motors [A]; correlation and size of that of smooth ones.
NOISE = 0.005
CORRELATED = (
    (0.0, 0.005),
    (0.9, 0.001),
    (0.9, 0.005),
    (0.95, 0.001),
    (0.95, 0.005),
    (0.99, 0.001),
    (0.99, 0.005),
)
#: Speeds below these are left out [rad/s], as in the package.
SLOW = 0.15 * np.array([joint.velocity for joint in a5.parameters().joints[:4]])
MASS = 0.3
WIDE = 1.96
NAMES = ("axis_e", "axis_d", "axis_c", "axis_b")
#: Order of the quantities in all tables, and their units.
QUANTITIES = ("friction", "backward", "viscous", "K_t gear")
UNITS = ("mA", "mA", "mA s/rad", "%")


class Sway(NamedTuple):
    """Times and exact states of a motion, and its torques by Pinocchio, (N, 4)."""

    time: np.ndarray
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    torque: np.ndarray


def sway(
    payload: float = 0.0,
    seconds: float = 60.0,
    density: float = a5.SEA_WATER,
    gravity: float = -9.81,
) -> Sway:
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

    arm = a5.load(density, gravity=np.array([0.0, 0.0, gravity]))
    arm = arm.with_payload(mass=payload) if payload else arm
    data = arm.model.createData()
    water = arm.fluid_model.createData()
    torque = [
        pin.rnea(arm.model, data, *state)
        - pin.computeGeneralizedGravity(arm.fluid_model, water, state[0])
        for state in zip(q, v, a, strict=True)
    ]
    return Sway(time=time, q=q, v=v, a=a, torque=np.array(torque))


def smooth_currents(
    motion: Sway, static: np.ndarray, seed: int, rho: float, size: float
) -> np.ndarray:
    """Currents of motors as in the model, (N, 4) [A].

    Args:
        motion: Of the arm.
        static: Current of the friction forward, (4,) [A].
        seed: Of the noise.
        rho: Correlation of the noise of neighbours.
        size: Its standard deviation [A].
    """
    chance = np.random.default_rng(seed).normal(size=(len(motion.time) + 2000, 4))
    noise = lfilter([1.0], [1.0, -rho], chance, axis=0)[2000:] * np.sqrt(1 - rho**2)
    friction = np.where(motion.v > 0, static, -BACKWARD * static)
    of_motor = VISCOUS * motion.v + ARMATURE * motion.a
    return np.asarray(motion.torque / PER_AMPERE + friction + of_motor + size * noise)


def currents(motion: Sway, static: np.ndarray, seed: int) -> np.ndarray:
    """Currents of rough motors, (N, 4) [A]; see `smooth_currents`."""
    rng = np.random.default_rng(seed)
    columns = []
    for k in range(4):
        v = motion.v[:, k]
        phase = rng.uniform(0.0, 2 * np.pi, 3)
        drift = 0.04 * np.sin(2 * np.pi * motion.time / 90 + phase[0])
        ripple = 0.05 * np.sin(40 * motion.q[:, k] + phase[1])
        stribeck = 0.2 * np.exp(-((v / 0.03) ** 2))
        way = np.tanh(v / 0.002)
        friction = static[k] * np.where(way > 0, 1.0, BACKWARD)
        friction = friction * (1 + drift - drift.mean()) * (1 + ripple) * (1 + stribeck)
        zero = 0.003 * np.sin(2 * np.pi * motion.time / 70 + phase[2])
        of_motor = VISCOUS * v + ARMATURE * motion.a[:, k]
        load = motion.torque[:, k] / PER_AMPERE[k]
        noise = rng.normal(scale=NOISE, size=len(v))
        columns.append(load + friction * way + of_motor + zero - zero.mean() + noise)
    return np.column_stack(columns)


def found(motion: Sway, current: np.ndarray, arm: Any = None, **options: Any) -> Any:
    """The calibration of simulated currents; the arm is in sea water if not given."""
    recorded = a5.trajectory.motion(motion.time, motion.q, current=current)
    arm = a5.load() if arm is None else arm
    return a5.calibrate.motors(recorded, arm, method="interpolate", **options)


def truth(static: np.ndarray) -> np.ndarray:
    """Friction, backward, viscous, torque per ampere of each joint, (4, 4)."""
    viscous = np.full(4, VISCOUS)
    return np.column_stack([static, BACKWARD * static, viscous, PER_AMPERE])


def estimates(calibration: Any) -> tuple[np.ndarray, np.ndarray]:
    """Of the same, and their standard deviations, (4, 4) each."""
    values = []
    deviations = []
    for joint in calibration.joints:
        both = [joint.friction_forward, joint.friction_backward]
        per_ampere = joint.torque_per_ampere if joint.known else np.nan
        values.append([*both, joint.viscous, per_ampere])
        of_friction = [joint.friction_deviation] * 2
        of_scale = joint.relative_deviation * joint.torque_per_ampere
        deviations.append([*of_friction, joint.viscous_deviation, of_scale])
    return np.array(values), np.array(deviations)


def plain(motion: Sway, current: np.ndarray) -> np.ndarray:
    """The same values by plain least squares, (4, 4)."""
    values = []
    for k in range(4):
        v = motion.v[:, k]
        way = [np.where(v > 0, 1.0, 0.0), np.where(v < 0, -1.0, 0.0)]
        columns = np.column_stack([motion.torque[:, k], *way, v, motion.a[:, k]])
        used = np.abs(v) > SLOW[k]
        fitted = np.linalg.lstsq(columns[used], current[used, k])[0]
        values.append([*fitted[1:4], 1 / fitted[0]])
    return np.array(values)


def compare(
    name: str,
    motion: Sway,
    static: np.ndarray,
    make: Callable[[int], np.ndarray],
    trials: int,
) -> None:
    """Print errors and coverage, with those of plain least squares beside."""
    scale = np.array([1e3, 1e3, 1e3, 100.0])
    scale = np.stack([scale * [1, 1, 1, 1 / one] for one in PER_AMPERE])
    errors, others, inside = [], [], []
    for seed in range(trials):
        current = make(seed)
        values, deviations = estimates(found(motion, current))
        errors.append(scale * (values - truth(static)))
        others.append(scale * (plain(motion, current) - truth(static)))
        held = np.abs(values - truth(static)) < WIDE * deviations
        inside.append(np.where(np.isnan(values), np.nan, held))
    print(f"{name}: rms error (plain least squares; truth inside ±)")
    for k, joint in enumerate(NAMES):
        cells = []
        for one in range(4):
            error = np.array(errors)[:, k, one]
            if np.isnan(error).mean() > 0.5:
                continue
            size = np.sqrt(np.nanmean(error**2))
            other = np.sqrt(np.mean(np.array(others)[:, k, one] ** 2))
            share = np.nanmean(np.array(inside)[:, k, one])
            words = f"{size:.2f} ({other:.2f}; {share:.0%}) {UNITS[one]}"
            cells.append(f"{QUANTITIES[one]} {words}")
        print(f"  {joint}: {', '.join(cells)}")
    pooled = np.nanmean(np.array(inside), axis=(0, 1))
    print(
        "  all joints:",
        *(
            f"{name} {share:.0%}"
            for name, share in zip(QUANTITIES, pooled, strict=True)
        ),
    )


def noise(trials: int, seconds: float) -> None:
    """Print how correlated noise changes the estimates."""
    motion = sway(seconds=seconds)
    for rho, size in CORRELATED:

        def make(seed: int, rho: float = rho, size: float = size) -> np.ndarray:
            return smooth_currents(motion, DRIVER, seed, rho, size)

        compare(f"AR {rho}, {1e3 * size:g} mA", motion, DRIVER, make, trials)


def rough(trials: int, seconds: float) -> None:
    """Print how well rough motors and a payload are found."""
    bare = sway(seconds=seconds)
    heavy = sway(MASS, seconds)
    for name, static in (("Table 4, 280 mA", TABLE_4), ("driver, 43 mA", DRIVER)):

        def make(seed: int, static: np.ndarray = static) -> np.ndarray:
            return currents(bare, static, seed)

        compare(name, bare, static, make, trials)
        off, refused = [], 0
        arm = a5.load(arm=found(bare, make(0)).parameters)
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


def named(motion: Sway, current: np.ndarray, arm: Any) -> str:
    """What the calibration says of a recording."""
    try:
        problems = found(motion, current, arm).problems
    except InputError as error:
        return (
            "columns" if "order of their joints" in str(error) else f"refused: {error}"
        )
    names = [one.name for one in problems if one.name != "uncertain"]
    return names[0] if names else "nothing"


def faults(trials: int, seconds: float) -> None:
    """Print what is named if something is wrong, and if nothing is."""
    sea, air = a5.load(), a5.load(a5.AIR)
    by_fluid = {
        a5.SEA_WATER: sway(seconds=seconds),
        a5.FRESH_WATER: sway(seconds=seconds, density=a5.FRESH_WATER),
        a5.AIR: sway(seconds=seconds, density=a5.AIR),
    }
    hanging = sway(seconds=seconds, gravity=9.81)
    own_order = [0, 1, 2, 3]
    cases: dict[str, tuple[Sway, Any, list[int]]] = {
        "nothing wrong, sea": (by_fluid[a5.SEA_WATER], sea, own_order),
        "nothing wrong, air": (by_fluid[a5.AIR], air, own_order),
        "air read as sea": (by_fluid[a5.AIR], sea, own_order),
        "sea read as air": (by_fluid[a5.SEA_WATER], air, own_order),
        "fresh read as sea": (by_fluid[a5.FRESH_WATER], sea, own_order),
        "hanging read as standing": (hanging, sea, own_order),
        "axis_d and axis_c swapped": (by_fluid[a5.SEA_WATER], sea, [0, 2, 1, 3]),
        "axis_e and axis_b swapped": (by_fluid[a5.SEA_WATER], sea, [3, 1, 2, 0]),
        "all shifted": (by_fluid[a5.SEA_WATER], sea, [1, 2, 3, 0]),
    }
    kinds: dict[str, Callable[[Sway, int], np.ndarray]] = {
        "5 mA, AR 0.95": lambda s, k: smooth_currents(s, DRIVER, k, 0.95, 0.005),
        "5 mA, AR 0.99": lambda s, k: smooth_currents(s, DRIVER, k, 0.99, 0.005),
        "rough, 43 mA": lambda s, k: currents(s, DRIVER, k),
        "rough, 280 mA": lambda s, k: currents(s, TABLE_4, k),
    }
    for kind, make in kinds.items():
        for case, (motion, arm, order) in cases.items():
            said = [
                named(motion, make(motion, k)[:, order], arm) for k in range(trials)
            ]
            counts = {word: said.count(word) for word in sorted(set(said))}
            print(f"{kind}, {case}: {counts}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("task", choices=("noise", "rough", "faults"))
    parser.add_argument("--trials", type=int, default=40)
    parser.add_argument("--seconds", type=float, default=60.0)
    given = parser.parse_args()
    {"noise": noise, "rough": rough, "faults": faults}[given.task](
        given.trials, given.seconds
    )


if __name__ == "__main__":
    main()
