"""How often `identify` is right, and which faults of a recording it names.

    python scripts/identification/identify_trials.py coverage --noise ar --trials 200
    python scripts/identification/identify_trials.py faults --noise white --trials 12
    python scripts/identification/identify_trials.py limits --noise ar

Truths are drawn from the printed intervals, lengths included. A recording has 25 s at
20 Hz, with noise of 3 mN m. Coverage is the share of 95 % intervals that hold the
truth: of static torques in 20 poses, and of the base parameters that a recording with
another seed supports.

The limits are those of a test that knows the noise: how often it notices a fault of one
size, and how often the fault explains more than another cause, which looks alike.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from statistics import NormalDist
from typing import Any

import numpy as np

import alpha5_model as a5
from alpha5_model.codegen.regrouping import base_parameters
from alpha5_model.studies.uncertainty import printed
from alpha5_model.studies.uncertainty.arm_numbers import arm_numbers
from alpha5_model.studies.uncertainty.digit_bounds import payload
from alpha5_model.studies.uncertainty.fitting import System
from alpha5_model.studies.uncertainty.identification import possible_causes
from alpha5_model.studies.uncertainty.misfit import SIGNIFICANCE
from alpha5_model.studies.uncertainty.recorded import recording_of
from alpha5_model.studies.uncertainty.unknowns import Unknowns

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from identification.correlated import CORRELATION, correlated

u = a5.uncertainty
SAMPLES = 500
STEP = 0.05
DEVIATION = 0.003
DIGIT = 0.01
WIDE = 1.96
#: What the recording is, and the components of it.
CHANNELS = {"efforts": 4, "sensor": 6}


def states() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A motion of sines below the rated speeds: position, velocity, acceleration."""
    time = STEP * np.arange(SAMPLES)
    slow = np.array([0.45, 0.3, 0.5, 0.25])
    fast = np.array([0.95, 1.3, 0.7, 1.1])
    first = np.outer(time, slow)
    second = np.outer(time, fast) + 1.0
    middle = a5.named_pose("reach") + np.array([0.0, 0.5, -0.6, 0.0])
    q = middle + 0.4 * np.sin(first) + 0.2 * np.sin(second)
    v = 0.4 * slow * np.cos(first) + 0.2 * fast * np.cos(second)
    a = -0.4 * slow**2 * np.sin(first) - 0.2 * fast**2 * np.sin(second)
    return q, v, a


STATES = states()
MOTION = a5.trajectory.motion(STEP * np.arange(SAMPLES), STATES[0])


def noise(kind: str, seed: int, channels: int) -> np.ndarray:
    """Noise of a recording, (N, channels)."""
    rng = np.random.default_rng(seed)
    driving = rng.normal(scale=DEVIATION, size=(SAMPLES, channels))
    return correlated(driving) if kind == "ar" else driving


def recorded(exact: np.ndarray, kind: str, seed: int) -> np.ndarray:
    """What is recorded of exact values."""
    noisy = exact + noise(kind, seed, exact.shape[1])
    if kind == "quantised":
        noisy = np.round(noisy / DIGIT) * DIGIT
    return np.asarray(noisy)


def fit(values: np.ndarray) -> Any:
    """The identification of a recording of efforts or loads."""
    if values.shape[1] == CHANNELS["efforts"]:
        motion = replace(MOTION, effort=values)
        return u.identify(motion, method="interpolate")
    return u.identify(MOTION, wrench=values, method="interpolate")


def exact_values(arm: Any, what: str) -> np.ndarray:
    """Torques or loads of the motion."""
    if what == "efforts":
        return np.array(arm.inverse_dynamics_batch(*STATES))
    return np.array(arm.base_wrench_batch(*STATES))


def coverage(what: str, kind: str, trials: int) -> None:
    """Print the shares of intervals that hold the truth, and the false alarms."""
    truths = u.sample(trials + 1, 5)
    limits = ([0.5] * 4, [5.5, 3.0, 3.0, 5.5])
    poses = np.random.default_rng(3).uniform(*limits, size=(20, 4))
    still = np.zeros_like(poses)
    pilot = u.arm(truths.parameters(trials))
    fixed = fit(recorded(exact_values(pilot, what), kind, seed=1)).supported

    torques, parameters, alarms = [], [], 0
    for k in range(trials):
        record = truths.parameters(k)
        arm = u.arm(record)
        found = fit(recorded(exact_values(arm, what), kind, seed=100 + k))
        alarms += bool(found.problems)
        predicted = found.fitted.torque(poses, still, still)
        true = np.array(arm.inverse_dynamics_batch(poses, still, still))
        error = np.abs(predicted.torque - true)[:, 1:3]
        torques.append(error < WIDE * predicted.deviation[:, 1:3])
        base = base_parameters(record.links, parameters=record)[:38]
        off = np.abs(found.estimate - base)
        parameters.append((off < WIDE * np.sqrt(np.diag(found.covariance)))[fixed])
    print(
        f"{what}, {kind}, {trials} trials: torques {np.mean(torques):.1%}, "
        f"{fixed.sum()} fixed parameters {np.mean(parameters):.1%}, "
        f"false alarms {alarms}"
    )


#: Fault -> what is named, and what it makes of efforts (N, 4) and velocities.
FAULTS: dict[str, tuple[str, Callable[[Any, Any], Any]]] = {
    "effort x1000": ("scale", lambda y, v: 1e3 * y),
    "sign": ("sign", lambda y, v: -y),
    "offset 0.1": ("offset", lambda y, v: y + 0.1),
    "offset 0.01": ("offset", lambda y, v: y + 0.01),
    "Coulomb 0.05": ("Coulomb", lambda y, v: y + 0.05 * np.sign(v)),
    "Coulomb 0.005": ("Coulomb", lambda y, v: y + 0.005 * np.sign(v)),
    "viscous 0.02": ("viscous", lambda y, v: y + 0.02 * v),
    "delay 40 ms": ("delay", lambda y, v: delayed(y)),
    "scale 1.05": ("scale", lambda y, v: 1.05 * y),
}
#: Faults of the arm: what is named, density, mass of link 2 over its own.
ARM_FAULTS = {
    "air for water": ("fluid", 0.0, 1.0),
    "fresh for sea": ("fluid", 1000.0, 1.0),
    "link 2 +20 %": ("mass of link_2", 1025.0, 1.2),
    "link 2 +5 %": ("mass of link_2", 1025.0, 1.05),
}


def delayed(values: np.ndarray) -> np.ndarray:
    """The values 40 ms late."""
    time = MOTION.time
    late = [np.interp(time - 0.04, time, one) for one in values.T]
    return np.transpose(late)


def faults(kind: str, trials: int) -> None:
    """Print how often each fault is noticed, and how often it is named first."""
    truths = u.sample(trials, 5)
    for fault in (*FAULTS, *ARM_FAULTS):
        caught, named = 0, 0
        for k in range(trials):
            record = truths.parameters(k)
            density = a5.SEA_WATER
            if fault in FAULTS:
                name, change = FAULTS[fault]
            else:
                name, density, heavier = ARM_FAULTS[fault]
                links = list(record.links)
                links[2] = replace(links[2], mass=heavier * links[2].mass)
                record = replace(record, links=tuple(links))
            exact = exact_values(u.arm(record, density), "efforts")
            if fault in FAULTS:
                exact = change(exact, STATES[1])
            found = fit(recorded(exact, kind, seed=500 + k))
            caught += bool(found.problems)
            named += bool(found.problems) and found.problems[0].name == name
        print(
            f"{kind}, {fault}: caught {caught}, named {named} of {trials}", flush=True
        )


#: Faults that are near the limit: cause, what they belong to, and size.
NEAR = (
    ("fluid", "density", 25.0),
    ("mass of link_2", "link_2", 0.05),
    ("mass of link_2", "link_2", 0.2),
    ("scale", "recording", 0.05),
)


class KnownNoise(System):
    """A recording whose noise is known."""

    def columns(self, kind: str) -> dict[tuple[str, str], np.ndarray]:
        """Cause of one size -> its column that numbers within the digits leave."""
        coefficients = np.zeros((CHANNELS["efforts"], 3))
        deviation = DEVIATION
        if kind == "ar":
            coefficients[:, 0] = CORRELATION
            deviation *= np.sqrt(1 - CORRELATION**2)
        weights = self._weights(suspected=True)._replace(
            correlation=coefficients,
            deviation=np.full(len(coefficients), deviation),
        )
        equations = self._equations(self._triangle(weights), independent=1.0)
        basis, _ = np.linalg.qr(equations.restricted)
        columns = equations.of_suspects
        left = columns - basis @ (basis.T @ columns)
        ends = np.cumsum([len(cause.of) for cause in self.causes])
        return {
            (cause.name, cause.of[0]): left[:, end - 1]
            for cause, end in zip(self.causes, ends, strict=True)
            if len(cause.of) == 1
        }


def known_noise(kind: str) -> KnownNoise:
    """A recording of the printed arm's efforts."""
    arm = u.arm(a5.parameters())
    efforts = recorded(exact_values(arm, "efforts"), kind, seed=1)
    motion = replace(MOTION, effort=efforts)
    recording = recording_of(motion, arm, None, {"method": "interpolate"})
    numbers = arm_numbers(arm.parameters, printed.believed(()))
    unknowns = Unknowns(numbers, arm)
    carried = payload(arm, numbers)
    causes = possible_causes(recording, unknowns, carried, arm.fluid_density)
    return KnownNoise(recording, unknowns, carried, causes)


def limits(kind: str) -> None:
    """Print what a test could do at best that knows the noise."""
    columns = known_noise(kind).columns(kind)
    threshold = NormalDist().inv_cdf(1 - SIGNIFICANCE / 2)
    for name, of, size in NEAR:
        fault = size * columns[name, of]
        strength = float(np.linalg.norm(fault))
        noticed = NormalDist().cdf(strength - threshold)
        print(f"{kind}, {name} {size:g}: noticed at best {noticed:.0%}")
        for other, column in columns.items():
            length = float(np.linalg.norm(column))
            if other == (name, of) or not length:
                continue
            alike = abs(float(fault @ column)) / (strength * length)
            first = NormalDist().cdf(strength * np.sqrt((1 - alike) / 2))
            if first < 0.95:
                print(f"  more than {other[0]}: {first:.0%} (correlation {alike:.3f})")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("task", choices=("coverage", "faults", "limits"))
    parser.add_argument("--noise", choices=("white", "ar", "quantised"), default="ar")
    parser.add_argument("--recorded", choices=tuple(CHANNELS), default="efforts")
    parser.add_argument("--trials", type=int, default=200)
    given = parser.parse_args()
    if given.task == "coverage":
        coverage(given.recorded, given.noise, given.trials)
    elif given.task == "faults":
        faults(given.noise, given.trials)
    else:
        limits(given.noise)


if __name__ == "__main__":
    main()
