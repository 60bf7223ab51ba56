"""Trials of calibrations on simulated arms: coverage, false alarms, named faults.

    python scripts/identification/calibration_trials.py coverage   # 200 trials of each
    python scripts/identification/calibration_trials.py coverage scales --noise ar
    python scripts/identification/calibration_trials.py coverage sensor --moving
    python scripts/identification/calibration_trials.py faults --trials 40

Each trial draws an arm from the prior, weighs it by Pinocchio on a tilted mount with a
sensor of wrong gains and offsets, and fits. Coverage is the share of 95 % intervals
that hold the truth: of static torques of axis_d and axis_c, in poses that were not
weighed, and of three numbers chosen beforehand.

Noise is white by default. Quantised, the sensor rounds to 3.5 times its deviation,
which rounding alone would give. With ar, a reading shares 0.95 of its error with the
one before. Scales always show whole grams. An arm that moves is read at 20 Hz for 25 s,
and its noise counts as correlated.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from statistics import NormalDist
from typing import Any

import numpy as np
import pinocchio as pin

import alpha5_model as a5
from alpha5_model.numbers.covariance import WIDTH
from alpha5_model.studies.arm_numbers import arm_numbers, load_slopes
from alpha5_model.studies.calibration.equations import TILT, ZEROS, prior_numbers

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from identification.correlated import correlated

c = a5.calibrate
#: Half width of a 95 % interval in standard deviations.
WIDE = NormalDist().inv_cdf(0.975)
#: Poses whose torques are predicted.
POSES = 20
#: Numbers whose intervals are counted.
FIXED = ("zeros.axis_d", "zeros.axis_c", "links.link_2.mass")
#: Whole grams.
GRAM = 1e-3
#: Width of a step over the standard deviation of rounding to it.
STEP = 12**0.5
CASES: dict[str, tuple[Any, float]] = {
    "scales": (c.scales(), a5.AIR),
    "sensor": (c.force_torque(), a5.SEA_WATER),
    "efforts": (c.efforts(), a5.SEA_WATER),
}


def motion() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A motion of sines below the rated speeds: position, velocity, acceleration."""
    time_ = 0.05 * np.arange(500)
    slow = np.array([0.45, 0.3, 0.5, 0.25])
    fast = np.array([0.95, 1.3, 0.7, 1.1])
    first = np.outer(time_, slow)
    second = np.outer(time_, fast) + 1.0
    middle = a5.named_pose("reach") + np.array([0.0, 0.5, -0.6, 0.0])
    q = middle + 0.4 * np.sin(first) + 0.2 * np.sin(second)
    v = 0.4 * slow * np.cos(first) + 0.2 * fast * np.cos(second)
    a = -0.4 * slow**2 * np.sin(first) - 0.2 * fast**2 * np.sin(second)
    return q, v, a


def drawn_arm(numbers: Any, prior: str, rng: np.random.Generator) -> Any:
    """An arm as the prior allows, with its centres of mass inside: values, record."""
    deviation = numbers.half_width
    while True:
        change = rng.normal(size=len(deviation))
        if prior == "digits":
            # Digits are uniform; the zeros are not.
            uniform = rng.uniform(-WIDTH, WIDTH, len(deviation))
            zeros = np.array([name.startswith("zeros") for name in numbers.names])
            change = np.where(zeros, change, uniform)
        values = numbers.middle + change * deviation
        try:
            return values, numbers.record(values)
        except a5.Alpha5Error:
            continue  # a centre of mass outside of its body


def loads(arm: Any, q: Any, v: Any, a: Any) -> np.ndarray:
    """Joint torques and load on the mount by Pinocchio's recursion, (N, 10)."""
    gravity = arm.model.gravity.linear
    found = np.zeros((len(q), 10))
    # Displaced water weighs against the bodies, and is not accelerated.
    parts = ((1.0, arm.model, v, a), (-1.0, arm.fluid_model, 0 * v, 0 * a))
    for sign, model, rates, accelerations in parts:
        data = model.createData()
        base = model.inertias[0]
        of_base = np.append(gravity, np.cross(base.lever, gravity)) * base.mass
        for row, state in enumerate(zip(q, rates, accelerations, strict=True)):
            found[row, :4] += sign * pin.rnea(model, data, *state)
            pin.forwardKinematics(model, data, state[0])
            held = data.oMi[1].act(data.f[1]).vector
            found[row, 4:] += sign * (of_base - held)
    return found


def noisy(
    clean: np.ndarray, deviation: Any, kind: str, rng: np.random.Generator
) -> np.ndarray:
    """Readings of a sensor, one row for each state, with its noise of a kind."""
    if kind == "quantised":
        step = STEP * np.asarray(deviation)
        return np.asarray(step * np.round(clean / step))
    error = rng.normal(size=clean.shape)
    if kind == "ar":
        error = correlated(error)
    return np.asarray(clean + deviation * error)


#: Three scales: the shares of a force are barycentric coordinates in their triangle.
CORNERS = np.array([(0.18, 0.0), (-0.09, 0.156), (-0.09, -0.156)])
HEIGHT = -0.03


def shown(sensor: Any, load: np.ndarray, v: np.ndarray) -> np.ndarray:
    """What a perfect sensor shows of loads (N, 10), by statics."""
    if sensor.kind == "force-torque":
        return load[:, 4:]
    if sensor.kind == "efforts":
        return load[:, :4] + 0.05 * np.sign(v) + 0.02 * v
    return on_scales(load)


def on_scales(load: np.ndarray, corners: Any = CORNERS) -> np.ndarray:
    """Masses on three scales at corners (3, 2), of loads (N, 10), (N, 3)."""
    force, moment = load[:, 4:7], load[:, 7:]
    down = -force[:, 2]
    # The moment about the point (x, y) on the table has no part along x and y.
    x = (moment[:, 1] - HEIGHT * force[:, 0]) / down
    y = (-moment[:, 0] - HEIGHT * force[:, 1]) / down
    sides = np.vstack([np.transpose(corners), np.ones(3)])
    shares = np.linalg.solve(sides, np.array([x, y, np.ones_like(x)]))
    return np.asarray(down[:, None] / 9.81 * shares.T)


def readings(
    session: Any, arm: Any, rng: np.random.Generator, kind: str = "white"
) -> np.ndarray:
    """What the sensor shows of an arm."""
    sensor = session.sensor
    tilt = np.append(rng.normal(size=2) * TILT, 0.0)
    gravity = session.gravity + np.cross(tilt, session.gravity)
    gravity *= 9.81 / np.linalg.norm(gravity)
    body = a5.uncertainty.arm(arm, session.density, gravity)
    clean = shown(sensor, loads(body, session.q, session.v, session.a), session.v)
    gain = 1.0 + rng.normal(size=sensor.size) * sensor.gain
    offset = rng.normal(size=sensor.size) * 0.5
    clean = gain * clean + (0.0 if sensor.kind == "efforts" else offset)
    if sensor.kind != "scales":
        return noisy(clean, sensor.deviation, kind, rng)
    given = noisy(clean, sensor.deviation, kind, rng) if kind == "ar" else clean
    return np.asarray(GRAM * np.round(given / GRAM))


def torque_deviation(found: Any, density: float, q: np.ndarray) -> np.ndarray:
    """Standard deviation of static torques after the fit, (POSES, 2)."""
    record = found.arm
    numbers = arm_numbers(record)
    known = {*record.covariance.names}
    others = np.array([name not in known for name in numbers.names])
    # Numbers that the readings do not tell have the prior that they had.
    before = dict(zip(found.names, WIDTH * found.prior, strict=True))
    alone = np.array([before.get(name, 0.0) for name in numbers.names]) * others
    gravity = np.array([0.0, 0.0, -9.81])
    wide = replace(numbers, half_width=np.where(others, alone, numbers.half_width))
    slopes = load_slopes(wide, density, gravity, q, 0 * q, 0 * q)[:, 1:3]
    together = np.linalg.norm(slopes @ numbers.root, axis=-1)
    return np.hypot(together, np.linalg.norm(slopes * alone, axis=-1)) / WIDTH


def start_of(name: str, prior: str, moving: bool) -> Any:
    """The states that are read."""
    sensor, density = CASES[name]
    if not moving:
        return c.plan_poses(sensor, fluid_density=density, prior=prior)
    q, v, a = motion()
    return c.session(sensor, q, v=v, a=a, fluid_density=density)


def coverage(
    name: str, prior: str, count: int, seed: int, kind: str, moving: bool
) -> None:
    """Run the trials of one sensor and print a line."""
    session = start_of(name, prior, moving)
    numbers = prior_numbers(a5.parameters(), prior, ZEROS, moving)
    rng = np.random.default_rng(seed)
    torques, fixed, remaining, alarms, seconds = [], [], [], [], []
    for _ in range(count):
        truth, arm = drawn_arm(numbers, prior, rng)
        read = c.with_readings(session, readings(session, arm, rng, kind))
        start = time.process_time()
        found = c.fit(read, prior=prior, correlated=moving)
        seconds.append(time.process_time() - start)
        alarms += [found.problems[0].name] if found.problems else []

        joints = a5.parameters().joints[:4]
        limits = [one.lower for one in joints], [one.upper for one in joints]
        q = rng.uniform(*limits, (POSES, 4))
        deviation = torque_deviation(found, session.density, q)
        ours, true = (
            loads(a5.uncertainty.arm(one, session.density), q, 0 * q, 0 * q)[:, 1:3]
            for one in (found.arm, arm)
        )
        torques.append(np.abs(ours - true) < WIDE * deviation)
        remaining.append((deviation**2).mean(axis=0))
        for one in FIXED:
            k = found.names.index(one)
            off = found.estimate[k] - truth[numbers.names.index(one)]
            fixed.append(abs(off) < WIDE * found.deviation[k])
    left = 1e3 * np.sqrt(np.mean(remaining, axis=0))
    print(
        f"{name}{', moving' if moving else ''}, {prior}, {kind}: {count} trials; "
        f"coverage of torques {np.mean(torques):.1%}, of numbers {np.mean(fixed):.1%}; "
        f"remaining torque {left[0]:.2f} / {left[1]:.2f} mN m; "
        f"false alarms {len(alarms)} {sorted({*alarms})}; "
        f"fit {np.mean(seconds):.2f} s",
        flush=True,
    )


def heavier(arm: Any, link: int, factor: float) -> Any:
    """The arm with another mass of a link."""
    links = list(arm.links)
    links[link] = replace(links[link], mass=factor * links[link].mass)
    return replace(arm, links=tuple(links))


def turned(arm: Any, joint: int, angle: float) -> Any:
    """The arm with another zero of a joint."""
    rows = list(arm.dh)
    offset = rows[joint].theta_offset + angle
    rows[joint] = replace(rows[joint], theta_offset=offset)
    return replace(arm, dh=tuple(rows))


#: Fault of the readings of scales -> what is named, and what it makes of them.
FAULTS: dict[str, tuple[str, Callable[[np.ndarray], np.ndarray]]] = {
    "grams for kilograms": ("unit", lambda y: 1000.0 * y),
    "ounces for grams": ("unit", lambda y: 1e-3 * np.round(1e3 * y / 28.35, 1)),
    "pounds for kilograms": ("unit", lambda y: np.round(y / 0.4536, 2)),
    "all 3 % too large": ("scale", lambda y: 1.03 * y),
    "scale_2 3 % too large": ("scale", lambda y: y * [1.0, 1.03, 1.0]),
    "one reading 5 g off": ("reading", lambda y: y + 0.005 * (spot(y, 3, 1))),
    "one reading 100 g off": ("reading", lambda y: y + 0.1 * (spot(y, 8, 2))),
    "tare of scale_3 from 7": ("tare", lambda y: y + tared(y, 6, 2)),
    "tare of scale_1 from 4": ("tare", lambda y: y + tared(y, 3, 0)),
    "scale_2 20 g more from 10": ("tare", lambda y: y - 0.02 * np.sign(tared(y, 9, 1))),
    "scales 1 and 2 swapped": ("channels", lambda y: y[:, [1, 0, 2]]),
    "scales in a circle": ("channels", lambda y: y[:, [1, 2, 0]]),
}
#: Fault of the arm -> what is named, and the arm.
ARM_FAULTS: dict[str, tuple[str, Callable[[Any], Any]]] = {
    "link 2 + 20 %": ("mass of link_2", lambda arm: heavier(arm, 2, 1.2)),
    "link 3 + 20 %": ("mass of link_3", lambda arm: heavier(arm, 3, 1.2)),
    "zero of axis_d 8 deg": ("zero", lambda arm: turned(arm, 1, np.radians(8.0))),
    "zero of axis_c -10 deg": ("zero", lambda arm: turned(arm, 2, np.radians(-10.0))),
}


def spot(y: np.ndarray, pose: int, channel: int) -> np.ndarray:
    """1 for one reading."""
    found = np.zeros_like(y)
    found[pose, channel] = 1.0
    return found


def tared(y: np.ndarray, pose: int, channel: int) -> np.ndarray:
    """What a scale shows less that is zeroed before a pose, at the pose before it."""
    found = np.zeros_like(y)
    found[pose:, channel] = -y[pose - 1, channel]
    return found


def faults(count: int, seed: int) -> None:
    """Print how often each fault of scales is noticed, and how often it is first."""
    session = start_of("scales", "digits", moving=False)
    numbers = prior_numbers(a5.parameters(), "digits", ZEROS, moves=False)
    for fault in (*FAULTS, "wrong pose", "water for air", "fresh for sea", *ARM_FAULTS):
        rng = np.random.default_rng(seed)
        names = []
        said = session
        for _ in range(count):
            _, arm = drawn_arm(numbers, "digits", rng)
            true = session
            if fault in ARM_FAULTS:
                name, change = ARM_FAULTS[fault]
                arm = change(arm)
            elif fault == "wrong pose":
                name = "pose"
                q = session.q.copy()
                q[4, 1] += np.radians(10.0)
                true = replace(session, q=q)
            elif fault == "water for air":
                name, true = "fluid", replace(session, density=a5.FRESH_WATER)
            elif fault == "fresh for sea":
                name, true = "fluid", replace(session, density=a5.FRESH_WATER)
                said = replace(session, density=a5.SEA_WATER)
            y = readings(true, arm, rng)
            if fault in FAULTS:
                name, of_readings = FAULTS[fault]
                y = of_readings(y)
            found = c.fit(c.with_readings(said, y))
            names.append(found.problems[0].name if found.problems else "")
        others = sorted({*names} - {name, ""})
        print(
            f"{fault}: caught {sum(map(bool, names))}, "
            f"named {names.count(name)} of {count} {others or ''}",
            flush=True,
        )


def main(words: list[str] | None = None) -> None:
    """Run the trials of some sensors, or of all."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("task", choices=("coverage", "faults"))
    parser.add_argument("names", nargs="*", default=[*CASES])
    parser.add_argument("--trials", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--prior", choices=("digits", "loose"), default="digits")
    parser.add_argument(
        "--noise", choices=("white", "ar", "quantised"), default="white"
    )
    parser.add_argument("--moving", action="store_true")
    given = parser.parse_args(words)
    if given.task == "faults":
        faults(given.trials, given.seed)
        return
    for name in given.names:
        coverage(name, given.prior, given.trials, given.seed, given.noise, given.moving)


if __name__ == "__main__":
    main()
