"""Bounds of arms with jaws, and of lengths, against samples."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import alpha5_model as a5
from alpha5_model.dynamics.load import arm_of

u = a5.uncertainty
RNG = np.random.default_rng(3)
Q = RNG.uniform([0.1, 0.1, 0.1, 0.1], [6.0, 3.3, 3.3, 6.0], (12, 4))
V = RNG.uniform(-0.5, 0.5, (12, 4))
A = RNG.uniform(-1, 1, (12, 4))


def with_rod(rows: np.ndarray, value: float) -> np.ndarray:
    """Rows of the four joints and the jaw rod."""
    return np.column_stack([rows, np.full(len(rows), value)])


def test_bounds_with_jaws_are_those_without_moved_by_the_jaws() -> None:
    """The interval has the same width; its middle is what the arm itself gives."""
    jaws = a5.load(gripper="jaws", gravity=(1.0, -2.0, -9.0))
    jaws = jaws.with_payload(0.2, (0.0, 0.01, 0.02))
    locked = a5.load(gravity=(1.0, -2.0, -9.0))
    states = [with_rod(Q, 0.005), with_rod(V, 0.01), with_rod(A, 0.02)]
    found = u.bounds(*states, arm=jaws)
    narrow = u.bounds(Q, V, A, arm=locked)
    ours = jaws.inverse_dynamics_batch(*states)
    plain = locked.inverse_dynamics_batch(Q, V, A)
    for side in (0, 1):
        margin = narrow.torque[side] - plain
        assert found.torque[side][:, :4] == pytest.approx(ours[:, :4] + margin)
        assert found.torque[side][:, 4] == pytest.approx(ours[:, 4])
    one = u.bounds(*(rows[0] for rows in states), arm=jaws)
    for alone, of_all in zip(one, found, strict=True):
        assert alone.lower == pytest.approx(of_all.lower[0])
        assert alone.upper == pytest.approx(of_all.upper[0])

    load = jaws.base_wrench(*(rows[0] for rows in states)).vector
    assert (one.base_wrench.lower < load).all()
    assert (load < one.base_wrench.upper).all()
    energy = jaws.kinetic_energy(states[0][0], states[1][0])
    assert one.kinetic_energy.lower < energy < one.kinetic_energy.upper
    potential = jaws.potential_energy(states[0][0])
    assert one.potential_energy.lower < potential < one.potential_energy.upper


def test_a_floating_base_is_refused() -> None:
    free = a5.load(floating_base=True)
    q = pin.neutral(free.model)
    with pytest.raises(a5.errors.InputError, match="fixed base"):
        u.bounds(q, np.zeros(10), np.zeros(10), arm=free)


@pytest.mark.parametrize("lengths", [False, True])
def test_no_sample_with_the_same_choice_exceeds_the_bounds(lengths: bool) -> None:
    """With lengths it is first order: 0.1 % of the width is left for the second."""
    lower, upper = u.bounds(Q, V, A, lengths=lengths).torque
    slack = 1e-3 * (upper - lower) if lengths else 0.0
    drawn = u.sample(20, 7, lengths=lengths)
    printed = a5.parameters().dh
    for k in range(20):
        record = drawn.parameters(k)
        same = all(
            (one.a, one.d) == (other.a, other.d)
            for one, other in zip(record.dh, printed, strict=True)
        )
        assert same != lengths
        tau = arm_of(record).inverse_dynamics_batch(Q, V, A)
        assert (lower - slack <= tau).all()
        assert (tau <= upper + slack).all()


@pytest.mark.slow
def test_lengths_widen_the_bounds_by_their_sensitivity() -> None:
    """`sensitivity` moves each length to both ends of its interval, by another way."""
    q, rest = a5.named_pose("reach"), np.zeros(4)
    narrow = u.bounds(q, rest, rest).torque
    wide = u.bounds(q, rest, rest, lengths=True).torque
    effects = u.sensitivity(lambda p: u.arm(p).hydrostatic_torque(q))
    of_lengths = [
        effect
        for name, effect in zip(effects.names, effects.effects, strict=True)
        if name.startswith("elbow.") or name.endswith((".a", ".d"))
    ]
    added = np.sum(np.abs(of_lengths), axis=0)
    assert wide.upper - narrow.upper == pytest.approx(added, rel=1e-3, abs=1e-12)
    assert narrow.lower - wide.lower == pytest.approx(added, rel=1e-3, abs=1e-12)
    assert added[1] > 1e-4
