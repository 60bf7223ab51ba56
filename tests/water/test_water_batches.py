"""Long batches of arms in moving water, and outside forces on them."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from dynamics_cases import close, random_q, random_v

import alpha5_model as a5

CURRENT = (0.4, -0.6, 0.8)


@pytest.mark.parametrize("gripper", ["locked", "jaws"])
def test_rows_of_long_batches_are_single_calls(gripper: str) -> None:
    """Longer than the states that are computed at once."""
    wet = a5.load(gripper=gripper).with_hydrodynamics(CURRENT)
    rng = np.random.default_rng(3)
    n = 900
    q = np.array([random_q(wet, rng) for _ in range(n)])
    v = rng.normal(size=(n, wet.model.nv))
    a = rng.normal(size=(n, wet.model.nv))
    flows = rng.normal(size=(n, 3))
    tau = wet.inverse_dynamics_batch(q, v, a, water_velocity=flows)
    load = wet.base_wrench_batch(q, v, a, water_velocity=flows)
    for i in (0, 1, 383, 384, 385, 500, 767, 768, 769, 899):
        state = q[i], v[i], a[i]
        close(tau[i], wet.inverse_dynamics(*state, water_velocity=flows[i]), 1e-11)
        close(load[i], wet.base_wrench(*state, water_velocity=flows[i]).vector, 1e-11)


def test_outside_forces_add_to_the_torques() -> None:
    """They act as in still water."""
    still = a5.load()
    wet = still.with_hydrodynamics(CURRENT)
    rng = np.random.default_rng(4)
    for _ in range(3):
        q = random_q(wet, rng)
        v = random_v(wet, rng)
        a = random_v(wet, rng)
        fext = [pin.Force(rng.normal(size=6)) for _ in range(still.model.njoints)]
        change = still.inverse_dynamics(q, v, a, fext) - still.inverse_dynamics(q, v, a)
        tau = wet.inverse_dynamics(q, v, a, fext)
        close(tau - wet.inverse_dynamics(q, v, a), change, 1e-11)
        assert np.abs(change).max() > 0.01
        close(wet.forward_dynamics(q, v, tau, fext), a, 1e-9)
        close(wet.forward_dynamics(q, v, tau - change), a, 1e-9)
