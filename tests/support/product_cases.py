"""Arms and states for what is generated from the symbolic equations."""

from __future__ import annotations

import numpy as np
import own_arm_dynamics as own
from dynamics_cases import PAYLOAD, TILTED
from fk import sample

import alpha5_model as a5

ARMS = {
    "sea": a5.load,
    "air, tilted": lambda: a5.load(a5.AIR, gravity=TILTED),
    "payload, tilted": lambda: a5.load(gravity=TILTED).with_payload(**PAYLOAD),
    "to the letter": lambda: a5.load(corrections=()),
    "own, beside the wrist axis": lambda: a5.load(arm=own.RECORDS[2]),
    "own, with a spacer, mounted, payload": lambda: a5.load(
        arm=own.RECORDS[9]
    ).with_payload(**PAYLOAD),
}
#: Functions of joint states, which an arm has methods for.
DYNAMICS = (
    "forward_kinematics",
    "link_poses",
    "jacobian",
    "gravity_torque",
    "buoyancy_torque",
    "hydrostatic_torque",
    "hydrostatic_torque_derivative",
    "mass_matrix",
    "coriolis_matrix",
    "nonlinear_effects",
    "inverse_dynamics",
    "inverse_dynamics_derivatives",
    "forward_dynamics",
    "forward_dynamics_derivatives",
    "base_wrench",
    "base_wrench_derivatives",
)


def states(count: int, seed: int) -> list[dict[str, np.ndarray]]:
    """q within the limits, v, a and tau of a few rad/s, rad/s^2 and N m."""
    rng = np.random.default_rng(seed)
    q = sample(count, seed)
    q[0] = 0.0
    return [
        {
            "q": row,
            **{name: rng.normal(scale=2.0, size=4) for name in ("v", "a", "tau")},
        }
        for row in q
    ]
