"""What the best motion could tell: a bound for `a5.calibrate.plan_excitation`.

    python scripts/studies/excitation_bound.py

Readings may be taken in any states, without a way between them. The weights of 1500
random states are those that leave the least variance of the torques at rest (A-optimal,
by the multiplicative algorithm). The gap is how much the best weights of these states
could still gain, by convexity.

References:
    [Silvey1978] Silvey, Titterington, Torsney: An algorithm for optimal designs on a
        design space, Communications in Statistics A 7(14).
"""

from __future__ import annotations

from typing import Any

import numpy as np

import alpha5_model as a5
from alpha5_model.studies.calibration.equations import Equations
from alpha5_model.studies.calibration.loads import load_slopes
from alpha5_model.studies.calibration.poses import TILT
from alpha5_model.studies.calibration.unknowns import NAMES, arm_unknowns

READINGS = 400
STATES = 1500
STEPS = 60
#: Frequency of a joint that turns at its rated speed, at most [Hz].
FASTEST = 0.5
UNKNOWNS = arm_unknowns(a5.parameters(), "digits", moving=True)
JOINTS = a5.parameters().joints[:4]
LOWER = np.array([joint.lower for joint in JOINTS])
UPPER = np.array([joint.upper for joint in JOINTS])
SPEED = np.array([joint.velocity for joint in JOINTS])


def wanted() -> np.ndarray:
    """Torques at rest of axis_d and axis_c by the arm's numbers, (100, 2, 78)."""
    q = np.random.default_rng(0).uniform(LOWER, UPPER, (100, 4))
    still = a5.calibrate.session(a5.calibrate.efforts(), q, fluid_density=a5.SEA_WATER)
    slopes = load_slopes(UNKNOWNS, UNKNOWNS.middle, still.density, still.motion)
    return np.asarray(slopes[:, 1:3] * UNKNOWNS.deviation)


def slopes_of(sensor: Any, q: Any, v: Any, a: Any) -> np.ndarray:
    """Readings by all unknowns, in standard deviations of both, (N, k, K)."""
    read = a5.calibrate.session(sensor, q, v=v, a=a, fluid_density=a5.SEA_WATER)
    equations = Equations(UNKNOWNS, [read], TILT)
    slopes = equations.slopes(equations.middle, 0) / sensor.noise[:, None]
    return np.asarray(slopes * equations.deviation)


def covariance(slopes: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Of the unknowns, in standard deviations of the prior, (K, K)."""
    information = np.einsum("n,njk,njl->kl", weights, slopes, slopes)
    return np.asarray(np.linalg.inv(np.eye(slopes.shape[-1]) + information))


def remaining(slopes: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Standard deviation of the torques at rest, (2,) [mN m]."""
    torque = wanted()
    known = covariance(slopes, weights)[: len(NAMES), : len(NAMES)]
    variance = np.einsum("njk,kl,njl->nj", torque, known, torque)
    return 1e3 * np.sqrt(variance.mean(axis=0))


def best_weights(slopes: np.ndarray) -> tuple[np.ndarray, float]:
    """Weights of states with the least variance, and the gap as a share of it."""
    torque = wanted()
    squares = np.zeros(2 * slopes.shape[-1:])
    of_arm = slice(0, len(NAMES))
    squares[of_arm, of_arm] = np.einsum("njk,njl->kl", torque, torque)
    weights = np.full(len(slopes), READINGS / len(slopes))
    for _ in range(STEPS):
        known = covariance(slopes, weights)
        gains = np.einsum("njk,kl,njl->n", slopes, known @ squares @ known, slopes)
        weights = weights * np.sqrt(gains)
        weights *= READINGS / weights.sum()
    known = covariance(slopes, weights)
    gains = np.einsum("njk,kl,njl->n", slopes, known @ squares @ known, slopes)
    gap = READINGS * gains.max() - weights @ gains
    return weights, float(gap / np.trace(squares @ known))


def sway() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The sway of the documentation, which keeps to the rated speeds."""
    rates = np.array([1.25, 1.0, 1.3, 1.1])
    phase = np.outer(np.arange(READINGS) / 20.0, rates)
    middle = a5.named_pose("reach") + np.array([0.0, 0.5, -0.6, 0.0])
    q = middle + 0.4 * np.sin(phase)
    return q, 0.4 * rates * np.cos(phase), -0.4 * rates**2 * np.sin(phase)


def main() -> None:
    """Print the sway, the planned motion and the bound for both sensors."""
    rng = np.random.default_rng(1)
    q = rng.uniform(LOWER, UPPER, (STATES, 4))
    v = rng.uniform(-SPEED, SPEED, (STATES, 4))
    a = rng.uniform(-1.0, 1.0, (STATES, 4)) * 2 * np.pi * FASTEST * SPEED
    for sensor in (a5.calibrate.efforts(), a5.calibrate.force_torque()):
        planned = a5.calibrate.plan_excitation(sensor)
        motion = (planned.position, planned.velocity, planned.acceleration)
        for name, states in (("sway", sway()), ("planned", motion)):
            slopes = slopes_of(sensor, *states)
            left = remaining(slopes, np.ones(len(slopes)))
            print(f"{sensor.kind}, {name}: {left[0]:.2f} / {left[1]:.2f} mN m")
        slopes = slopes_of(sensor, q, v, a)
        weights, gap = best_weights(slopes)
        left = remaining(slopes, weights)
        print(
            f"{sensor.kind}, any states: {left[0]:.2f} / {left[1]:.2f} mN m, "
            f"gap {gap:.1%}"
        )


if __name__ == "__main__":
    main()
