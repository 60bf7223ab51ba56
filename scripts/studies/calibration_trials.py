"""Trials of calibrations on simulated arms: coverage, false alarms, possible bodies.

    python scripts/studies/calibration_trials.py                  # 200 trials of each
    python scripts/studies/calibration_trials.py scales --trials 20
    python scripts/studies/calibration_trials.py --noise ar

Each trial draws an arm from the prior, weighs it by Pinocchio on a tilted mount with a
sensor of wrong gains and offsets, and fits. Counted are the static torques, in poses
that were not weighed, and three numbers chosen beforehand that lie within their 95 %
intervals.

Noise is white by default. Quantised, the sensor rounds to 3.5 times its deviation,
which rounding alone would give. With ar, a reading shares 0.95 of its error with the
pose before. Scales always show whole grams.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from statistics import NormalDist
from typing import Any, NamedTuple

import numpy as np

import alpha5_model as a5
from alpha5_model.studies.calibration.loads import Motion, load_slopes
from alpha5_model.studies.calibration.poses import TILT
from alpha5_model.studies.calibration.unknowns import (
    NAMES,
    ArmUnknowns,
    arm_unknowns,
)
from alpha5_model.studies.uncertainty.linear_maps import possible

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from identification.correlated import correlated

#: Half width of a 95 % interval in standard deviations.
WIDE = NormalDist().inv_cdf(0.975)
#: Poses whose torques are predicted.
POSES = 20
#: Numbers whose intervals are counted.
FIXED = ("zeros.axis_d", "zeros.axis_c", "links.link_2.mass")
#: Whole grams.
GRAM = 1e-3
NOISE = ("white", "ar", "quantised")
#: Width of a step over the standard deviation of rounding to it.
STEP = 12**0.5
CASES = {
    "scales": (a5.calibrate.scales(), a5.AIR),
    "sensor": (a5.calibrate.force_torque(), a5.SEA_WATER),
    "efforts": (a5.calibrate.efforts(), a5.SEA_WATER),
}


class Trial(NamedTuple):
    """What one trial gave.

    Attributes:
        torques: Error over standard deviation of predicted torques, (POSES, 2).
        numbers: The same of `FIXED`, (3,).
        remaining: Standard deviation of axis_d's and axis_c's torque, (2,) [N m].
        problems: Names of the problems.
        impossible: Whether a body of the result is impossible.
        seconds: Of the fit.
    """

    torques: np.ndarray
    numbers: np.ndarray
    remaining: np.ndarray
    problems: tuple[str, ...]
    impossible: bool
    seconds: float


def drawn_arm(unknowns: ArmUnknowns, rng: np.random.Generator) -> Any:
    """Values of an arm as the prior allows, with its centres of mass inside."""
    while True:
        change = rng.normal(size=len(NAMES)) * unknowns.deviation
        if unknowns.prior == "digits":
            # Digits are uniform; the zeros are not.
            uniform = rng.uniform(-(3**0.5), 3**0.5, len(NAMES)) * unknowns.deviation
            printed = np.array([not name.startswith("zeros") for name in NAMES])
            change[printed] = uniform[printed]
        values = unknowns.middle + change
        try:
            return values, unknowns.record(values)
        except a5.Alpha5Error:
            continue  # a centre of mass outside of its body


def noisy(
    clean: np.ndarray, deviation: Any, kind: str, rng: np.random.Generator
) -> np.ndarray:
    """Readings of a sensor, one row for each pose, with its noise of a kind."""
    if kind == "quantised":
        step = STEP * np.asarray(deviation)
        return np.asarray(step * np.round(clean / step))
    error = rng.normal(size=clean.shape)
    if kind == "ar":
        error = correlated(error)
    return np.asarray(clean + deviation * error)


def readings(
    planned: Any, arm: Any, rng: np.random.Generator, kind: str = "white"
) -> np.ndarray:
    """What the sensor shows of an arm."""
    sensor = planned.sensor
    tilt = np.append(rng.normal(size=2) * TILT, 0.0)
    gravity = planned.motion.gravity + np.cross(tilt, planned.motion.gravity)
    gravity *= 9.81 / np.linalg.norm(gravity)
    body = a5.uncertainty.arm(arm, planned.density, gravity)
    still = np.zeros(4)
    loads = []
    for q in planned.motion.q:
        wrench = body.base_wrench(q, still, still).vector
        loads.append([*body.hydrostatic_torque(q), *wrench])
    gain = 1.0 + rng.normal(size=sensor.size) * sensor.gain
    offset = rng.normal(size=sensor.size) * np.minimum(sensor.offset, 0.5)
    clean = gain * (np.array(loads) @ sensor.matrix.T) + offset
    if sensor.kind == "scales":
        shown = noisy(clean, sensor.noise, kind, rng) if kind == "ar" else clean
        return np.asarray(GRAM * np.round(shown / GRAM))
    return noisy(clean, sensor.noise, kind, rng)


def trial(
    planned: Any, prior: str, rng: np.random.Generator, kind: str = "white"
) -> Trial:
    """One arm, weighed and fitted."""
    unknowns = arm_unknowns(a5.parameters(), prior)
    truth, arm = drawn_arm(unknowns, rng)
    weighed = a5.calibrate.with_readings(planned, readings(planned, arm, rng, kind))
    start = time.process_time()
    found = a5.calibrate.fit(weighed, prior=prior)
    seconds = time.process_time() - start

    joints = a5.parameters().joints[:4]
    lower = [joint.lower for joint in joints]
    upper = [joint.upper for joint in joints]
    q = rng.uniform(lower, upper, (POSES, 4))
    motion = Motion(q=q, v=0 * q, a=0 * q, gravity=planned.motion.gravity)
    values = unknowns.middle.copy()
    values[[NAMES.index(name) for name in found.names]] = found.estimate
    deviation = predicted_deviation(unknowns, values, found, planned.density, motion)
    error = [
        body.inverse_dynamics_batch(q, 0 * q, 0 * q)[:, 1:3]
        for body in (
            a5.uncertainty.arm(found.arm, planned.density),
            a5.uncertainty.arm(arm, planned.density),
        )
    ]
    place = [NAMES.index(name) for name in FIXED]
    ours = [found.names.index(name) for name in FIXED]
    bodies = np.array([[_numbers(link) for link in found.arm.links]])
    return Trial(
        torques=(error[0] - error[1]) / deviation,
        numbers=(values - truth)[place] / found.deviation[ours],
        remaining=np.sqrt((deviation**2).mean(axis=0)),
        problems=tuple(one.name for one in found.problems),
        impossible=not bool(possible(bodies).all()),
        seconds=seconds,
    )


def predicted_deviation(
    unknowns: ArmUnknowns, values: Any, found: Any, density: float, motion: Motion
) -> np.ndarray:
    """Standard deviation of static torques after the fit, (POSES, 2)."""
    slopes = load_slopes(unknowns, values, density, motion)[:, 1:3]
    covariance = np.diag(unknowns.deviation**2)
    known = found.arm.covariance
    place = [NAMES.index(name) for name in known.names]
    covariance[np.ix_(place, place)] = known.matrix
    variance = np.einsum("njk,kl,njl->nj", slopes, covariance, slopes)
    return np.sqrt(variance)


def _numbers(link: Any) -> list[float]:
    """The 14 numbers of a link."""
    second = np.trace(link.inertia) / 2 * np.eye(3) - link.inertia
    upper = second[np.triu_indices(3)]
    return [link.mass, *link.com, *upper, link.volume, *link.cob]


def report(name: str, prior: str, count: int, seed: int, kind: str = "white") -> None:
    """Run the trials of one sensor and print a line."""
    sensor, density = CASES[name]
    start = time.process_time()
    planned = a5.calibrate.plan_poses(sensor, fluid_density=density, prior=prior)
    planning = time.process_time() - start
    rng = np.random.default_rng(seed)
    found = [trial(planned, prior, rng, kind) for _ in range(count)]
    torques = np.abs([one.torques for one in found]) < WIDE
    numbers = np.abs([one.numbers for one in found]) < WIDE
    alarms = [one for one in found if one.problems]
    remaining = 1e3 * np.sqrt(np.mean([one.remaining**2 for one in found], axis=0))
    print(
        f"{name}, {prior}, {kind}: {count} trials; "
        f"coverage of torques {torques.mean():.1%}, of numbers {numbers.mean():.1%}; "
        f"remaining torque {remaining[0]:.2f} / "
        f"{remaining[1]:.2f} mN m; false alarms {len(alarms)} "
        f"{sorted({one.problems[0] for one in alarms})}; impossible bodies "
        f"{sum(one.impossible for one in found)}; fit "
        f"{np.mean([one.seconds for one in found]):.2f} s, plan {planning:.3f} s",
        flush=True,
    )


def main(words: list[str] | None = None) -> None:
    """Run the trials of some sensors, or of all."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("names", nargs="*", default=[*CASES])
    parser.add_argument("--trials", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--prior", choices=("digits", "loose"), action="append")
    parser.add_argument("--noise", choices=NOISE, default="white")
    given = parser.parse_args(words)
    for name in given.names:
        for prior in given.prior or ("digits", "loose"):
            report(name, prior, given.trials, given.seed, given.noise)


if __name__ == "__main__":
    main()
