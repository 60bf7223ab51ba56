"""Moving water around an arm of one's own: bodies in the link frames of its record."""

from __future__ import annotations

import numpy as np
import own_arm_dynamics as own
import pytest
from loops import each

import alpha5_model as a5
from alpha5_model.numbers.hydrodynamics import DragStrip, hydrodynamics
from alpha5_model.numbers.parameters import Alpha5Parameters

DENSITY = 1025.0
CURRENT = np.array([0.4, -0.3, 0.2])
every_record = each("record", [own.RECORDS[k] for k in (1, 2, 8, 9)])


def points(
    record: Alpha5Parameters, strip: DragStrip, link: int, q: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Axis of a strip, and its points for a midpoint rule, in base_link, (K, 3)."""
    rotations, origins = own.link_frames(record, q[None])
    rotation, origin = rotations[link][0], origins[link][0]
    shares = (np.arange(400) + 0.5) / 400
    line = strip.start + np.outer(shares, strip.end - strip.start)
    axis = (strip.end - strip.start) / np.linalg.norm(strip.end - strip.start)
    return rotation @ axis, origin + line @ rotation.T


def virtual_power(
    record: Alpha5Parameters, strip: DragStrip, link: int, q: np.ndarray
) -> np.ndarray:
    """Torque of the drag on a resting strip in `CURRENT`, by small motions, (4,)."""
    axis, _ = points(record, strip, link, q)
    length = np.linalg.norm(strip.end - strip.start)
    along = (CURRENT @ axis) * axis
    across = CURRENT - along
    pressure = DENSITY / 2 * strip.diameter * length / 400
    force = pressure * (
        strip.across * np.linalg.norm(across) * across
        + strip.along * np.linalg.norm(along) * along
    )
    h = 1e-6
    torque = []
    for step in h * np.eye(4):
        _, ahead = points(record, strip, link, q + step)
        _, behind = points(record, strip, link, q - step)
        torque.append(((ahead - behind) / (2 * h) @ force).sum())
    return np.array(torque)


def munk_torque(record: Alpha5Parameters, q: np.ndarray) -> np.ndarray:
    """Torque that holds the resting arm against its added mass in `CURRENT`, (4,).

    With the kinetic energy T of the water around the resting bodies, Lagrange's
    equations leave ``-dT/dq``.
    """

    def energy(at: np.ndarray) -> float:
        rotations, _ = own.link_frames(record, at[None])
        total = 0.0
        for name, body in hydrodynamics().items():
            slip = rotations[int(name[-1])][0].T @ -CURRENT
            added = body.added_mass[:3, :3] * DENSITY / 1000.0
            total += slip @ added @ slip / 2
        return total

    h = 1e-6
    steps = h * np.eye(4)
    return np.array([-(energy(q + s) - energy(q - s)) / (2 * h) for s in steps])


@pytest.mark.slow
@every_record
def test_a_resting_arm_is_loaded_by_drag_at_its_own_places(
    record: Alpha5Parameters,
) -> None:
    still = a5.load(DENSITY, arm=record)
    wet = still.with_hydrodynamics(CURRENT)
    q = own.states(record, 3)[0]
    rest = np.zeros(4)
    for row in q:
        expected = still.inverse_dynamics(row, rest, rest) + munk_torque(record, row)
        for name, body in hydrodynamics().items():
            for strip in body.strips:
                expected -= virtual_power(record, strip, int(name[-1]), row)
        found = wet.inverse_dynamics(row, rest, rest)
        assert found == pytest.approx(expected, abs=1e-6)
        assert np.abs(found - still.inverse_dynamics(row, rest, rest)).max() > 1e-3


@pytest.mark.slow
@every_record
def test_batches_are_single_calls_and_jaws_follow_the_spacer(
    record: Alpha5Parameters,
) -> None:
    wet = a5.load(DENSITY, arm=record).with_hydrodynamics(CURRENT)
    q, v, a = own.states(record, 20)
    torque = wet.inverse_dynamics_batch(q, v, a)
    single = [wet.inverse_dynamics(*state) for state in zip(q, v, a, strict=True)]
    assert np.array(single) == pytest.approx(torque, abs=1e-12)
    assert wet.forward_dynamics_batch(q, v, torque) == pytest.approx(a, abs=1e-9)
    assert wet.mass_matrix(q[0]) == pytest.approx(wet.mass_matrix(q[0]).T)

    # A finger's frame is lower by the spacer.
    jaws = a5.load(DENSITY, gripper="jaws", arm=record)
    closed = np.append(q[0], record.joints[4].lower)
    level = a5.load(DENSITY, gripper="jaws")
    ours = jaws.forward_kinematics(closed, "finger_1")
    wrist = jaws.forward_kinematics(closed, "link_4")
    printed = level.forward_kinematics(closed, "link_4").actInv(
        level.forward_kinematics(closed, "finger_1")
    )
    moved = wrist.actInv(ours).translation - printed.translation
    assert moved == pytest.approx([0.0, 0.0, -record.spacer], abs=1e-12)
    jaws.with_hydrodynamics(CURRENT).inverse_dynamics(closed, *np.zeros((2, 5)))
