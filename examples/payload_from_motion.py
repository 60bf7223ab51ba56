"""Estimate a payload's mass from a motion, by a gradient through the dynamics in JAX.

python examples/payload_from_motion.py
"""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np

import alpha5_model as a5
from alpha5_model.jax import load

STEP = 0.002  # [s]
STEPS = 120
STEEL = 7850.0  # [kg/m^3]
COM = (0.0, 0.0, 0.03)  # in tcp [m]
START = np.array([2.0, 1.0, 2.0, 1.0])
GUESS = 0.3  # [kg]
#: The motors hold the guessed payload and swing it, (STEPS, 4) [N m].
GUESSED = a5.load().with_payload(GUESS, com=COM, volume=GUESS / STEEL)
SWING = np.outer(np.sin(np.linspace(0, 4, STEPS)), [0.5, 0.3, 0.2, 0.0])
TORQUE = GUESSED.hydrostatic_torque(START) + SWING


def recorded(mass: float) -> np.ndarray:
    """The motion by Pinocchio with noise of 1 mrad, as of encoders, (STEPS, 4)."""
    arm = a5.load().with_payload(mass, com=COM, volume=mass / STEEL)
    q = START
    v = np.zeros(4)
    motion = []
    # Ten steps for each step of the estimate.
    for tau in np.repeat(TORQUE, 10, axis=0):
        q = q + STEP / 20 * v
        v = v + STEP / 10 * arm.forward_dynamics(q, v, tau)
        q = q + STEP / 20 * v
        motion.append(q)
    noise = np.random.default_rng(1).normal(scale=1e-3, size=(STEPS, 4))
    return np.array(motion)[9::10] + noise


def motion(mass: jax.Array) -> jax.Array:
    """The motion with a payload, (STEPS, 4)."""
    arm = load().with_payload(mass, COM, volume=mass / STEEL)

    def step(state: tuple[jax.Array, jax.Array], tau: jax.Array) -> tuple:
        q, v = state
        q = q + STEP / 2 * v
        v = v + STEP * arm.forward_dynamics(q, v, tau)
        q = q + STEP / 2 * v
        return (q, v), q

    start = (jnp.asarray(START), jnp.zeros(4))
    return jax.lax.scan(step, start, jnp.asarray(TORQUE))[1]


def main() -> None:
    """Take Gauss-Newton steps from the guess."""
    seen = recorded(0.35)
    mass = jnp.float32(GUESS)
    follow = jax.jit(lambda mass: jax.jvp(motion, (mass,), (jnp.ones(()),)))
    for _ in range(4):
        found, slope = follow(mass)
        error = seen - found
        rms = np.degrees(np.sqrt(np.mean(error**2)))
        print(f"{mass:.4f} kg: off by {rms:.3f} degrees")
        mass = mass + (slope * error).sum() / (slope**2).sum()
    print(f"The payload has {mass:.3f} kg; it was made with 0.35 kg.")


if __name__ == "__main__":
    main()
