"""How heavy is what the gripper holds? Its mass from a motion, by a gradient through the dynamics in JAX.

python examples/payload_from_motion.py
"""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np

import alpha5_model as a5
from alpha5_model.jax import load

STEP, STEPS = 0.002, 120  # s
STEEL, COM = 7850.0, (0.0, 0.0, 0.03)  # kg/m^3, m in tcp
START = np.array([2.0, 1.0, 2.0, 1.0])
#: What the motors do: hold a payload of 0.3 kg, which is a guess, and swing it, (STEPS, 4) [N m].
GUESS = 0.3
TORQUE = (
    a5.load()
    .with_payload(GUESS, com=COM, volume=GUESS / STEEL)
    .hydrostatic_torque(START)
)
TORQUE = TORQUE + np.sin(np.linspace(0, 4, STEPS))[:, None] * np.array(
    [0.5, 0.3, 0.2, 0.0]
)


def recorded(mass: float) -> np.ndarray:
    """What encoders see, (STEPS, 4): here Pinocchio's motion of the loaded arm, and noise of a milliradian."""
    arm = a5.load().with_payload(mass, com=COM, volume=mass / STEEL)
    q, v, out = START, np.zeros(4), []
    for tau in np.repeat(TORQUE, 10, axis=0):  # finer than the estimate's steps
        q = q + STEP / 20 * v
        v = v + STEP / 10 * arm.forward_dynamics(q, v, tau)
        q = q + STEP / 20 * v
        out.append(q)
    return np.array(out)[9::10] + np.random.default_rng(1).normal(
        scale=1e-3, size=(STEPS, 4)
    )


def motion(mass: jax.Array) -> jax.Array:
    """The motion with a payload, (STEPS, 4)."""
    arm = load().with_payload(mass, COM, volume=mass / STEEL)

    def step(state: tuple[jax.Array, jax.Array], tau: jax.Array) -> tuple:
        q, v = state[0] + STEP / 2 * state[1], state[1]
        v = v + STEP * arm.forward_dynamics(q, v, tau)
        return (q + STEP / 2 * v, v), q + STEP / 2 * v

    start = jnp.asarray(START), jnp.zeros(4)
    return jax.lax.scan(step, start, jnp.asarray(TORQUE))[1]


def main() -> None:
    """Gauss-Newton steps from the guess."""
    seen, mass = recorded(0.35), jnp.float32(GUESS)
    follow = jax.jit(lambda mass: jax.jvp(motion, (mass,), (jnp.ones(()),)))
    for _ in range(4):
        found, slope = follow(mass)
        off = seen - found
        print(
            f"{mass:.4f} kg: off by {np.degrees(np.sqrt(np.mean(off**2))):.3f} degrees"
        )
        mass = mass + (slope * off).sum() / (slope**2).sum()
    print(f"The payload has {mass:.3f} kg; it was made with 0.35 kg.")


if __name__ == "__main__":
    main()
