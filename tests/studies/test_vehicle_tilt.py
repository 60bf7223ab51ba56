"""The tilt of a vehicle: known stiffness, yaw and delay are found again."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import reference
from shared_recordings import RECORDINGS, needs_recordings, pool_recordings
from shared_recordings import tilt_recordings as of_folder

import alpha5_model as a5
from alpha5_model._support.spatial import rotation_from_rpy
from alpha5_model.numbers.pose import Pose

STIFFNESS = np.array([6.0, 9.0])
DELAY = 0.3
YAW = 0.2
STEP = 0.02


def net_moment(q: np.ndarray, gravity: np.ndarray) -> np.ndarray:
    """Moment of weight less buoyancy about base_link, from the tables, (3,)."""
    total = np.zeros(3)
    for i, frame in enumerate(reference.inertial_frames(q)):
        weight = np.append(np.array(reference.COM[i]) / 1e3, 1.0)
        lift = np.append(np.array(reference.COB[i]) / 1e3, 1.0)
        lever = reference.MASS[i] * (frame @ weight)[:3]
        lever = lever - reference.VOLUME[i] * (frame @ lift)[:3]
        total += np.cross(lever, gravity)
    return total


def recording(
    seed: int, turn: np.ndarray, noise: float = 0.0, late: float = DELAY
) -> a5.TiltRecording:
    """A vehicle that answers late; the arm's axes are turned by a rotation on it."""
    rng = np.random.default_rng(seed)
    time = np.arange(0, 24, STEP)
    rates = rng.uniform(0.3, 0.6, 4)
    middle = rng.uniform([1.0, 0.9, 0.9, 0.0], [5.0, 2.0, 2.0, 1.0])
    q = middle + 0.6 * np.sin(np.outer(time, rates) + rng.uniform(0, 6, 4))
    trim = rng.uniform(-0.03, 0.03, 2)
    tilt = np.zeros((time.size, 2))
    steps = round(late / STEP)
    for k in range(time.size):
        before = max(k - steps, 0)
        gravity = -9.81 * vertical(tilt[before])
        moment = turn @ net_moment(q[before], turn.T @ gravity)
        tilt[k] = moment[:2] / STIFFNESS + trim
    up = np.array([vertical(angles) for angles in tilt])
    up += rng.normal(0, noise, up.shape)
    up /= np.linalg.norm(up, axis=1)[:, None]
    grid = np.arange(3, 21, 0.05)
    return a5.TiltRecording(a5.trajectory.motion(time, q), time, up, grid)


def vertical(tilt: np.ndarray) -> np.ndarray:
    """The world's z in a vehicle with roll and pitch."""
    return rotation_from_rpy([tilt[0], tilt[1], 0.0])[2]


@pytest.fixture(scope="module")
def turned() -> list[a5.TiltRecording]:
    turn = rotation_from_rpy([0.0, 0.0, YAW])
    return [recording(seed, turn, noise=1e-3) for seed in range(4)]


def test_stiffness_yaw_and_delay_are_found(turned: list[a5.TiltRecording]) -> None:
    found = a5.fit_tilt(turned)
    assert found.stiffness == pytest.approx(STIFFNESS, rel=5e-3)
    assert found.yaw == pytest.approx(YAW, abs=2e-3)
    assert found.delay == pytest.approx(DELAY)
    assert found.r2.min() > 0.999
    assert found.held_out_r2.min() > 0.999
    assert 0 < found.yaw_error < 3e-3
    assert (found.stiffness_error < 0.1).all()
    fresh = [recording(17, rotation_from_rpy([0.0, 0.0, YAW]))]
    assert found.score(fresh).min() > 0.999


@pytest.mark.slow
def test_the_mount_of_the_record_counts(turned: list[a5.TiltRecording]) -> None:
    """Upside down and turned; nothing is left for the yaw."""
    mount = Pose(
        parent="vehicle",
        position=np.zeros(3),
        rotation=rotation_from_rpy([np.pi, 0.1, YAW]),
    )
    record = replace(a5.parameters(), mount=mount)
    arm = a5.load(a5.FRESH_WATER, arm=record)
    found = a5.fit_tilt([recording(k, mount.rotation) for k in range(2)], arm)
    assert found.yaw == pytest.approx(0.0, abs=2e-3)
    assert found.stiffness == pytest.approx(STIFFNESS, rel=5e-3)
    wrong = a5.fit_tilt([recording(k, mount.rotation) for k in range(2)])
    assert wrong.r2.min() < 0.2
    assert np.isinf(wrong.stiffness.max())


def test_any_other_answer_leaves_more(turned: list[a5.TiltRecording]) -> None:
    """By predictions of the public method, each unknown a little larger or smaller.

    The yaw also turns gravity as the arm sees it, which a pass of the fit holds fixed.
    """
    found = a5.fit_tilt(turned, delays=[DELAY])
    least = 1 - found.score(turned)
    for change in (-3e-3, 3e-3):
        stiffness = replace(found, stiffness=found.stiffness * (1 + change))
        yaw = replace(found, yaw=found.yaw + change)
        assert (1 - stiffness.score(turned) > least).all()
        assert (1 - yaw.score(turned)).sum() > least.sum()


def test_a_further_fit_hardly_changes_the_yaw(turned: list[a5.TiltRecording]) -> None:
    """The yaw turns gravity as the arm sees it; the passes of one fit settle that."""
    found = a5.fit_tilt(turned[:2], delays=[DELAY])
    rotation = rotation_from_rpy([0.0, 0.0, found.yaw])
    mount = Pose(parent="vehicle", position=np.zeros(3), rotation=rotation)
    arm = a5.load(a5.FRESH_WATER, arm=replace(a5.parameters(), mount=mount))
    again = a5.fit_tilt(turned[:2], arm, delays=[DELAY])
    assert abs(again.yaw) < 1e-4
    assert again.stiffness == pytest.approx(found.stiffness, rel=1e-4)


def test_other_tables_explain_less(turned: list[a5.TiltRecording]) -> None:
    heavier = a5.load(a5.FRESH_WATER).with_payload(0.3)
    one = a5.fit_tilt(turned[:2], heavier)
    right = a5.fit_tilt(turned[:2])
    assert one.r2.sum() < right.r2.sum() - 0.01


def test_one_recording_has_no_errors(turned: list[a5.TiltRecording]) -> None:
    found = a5.fit_tilt(turned[:1])
    assert found.stiffness == pytest.approx(STIFFNESS, rel=0.02)
    assert np.isnan([found.yaw_error, *found.stiffness_error]).all()
    assert np.isnan(found.held_out_r2).all()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"up": np.zeros((3, 3))}, "up: expected"),
        ({"up": np.full((1200, 3), 2.0)}, "directions of length 1"),
        ({"time": np.zeros(1200)}, "ascending times"),
        ({"time": np.arange(1200.0) + 50, "grid": None}, "5 s that both files cover"),
        ({"motion": None}, "a Motion"),
    ],
)
def test_a_bad_recording_is_refused(
    turned: list[a5.TiltRecording], change: dict[str, Any], said: str
) -> None:
    with pytest.raises(a5.Alpha5Error, match=said):
        replace(turned[0], **change)


def test_what_cannot_be_fitted_is_refused(turned: list[a5.TiltRecording]) -> None:
    with pytest.raises(a5.Alpha5Error, match="at least one"):
        a5.fit_tilt([])
    with pytest.raises(a5.Alpha5Error, match="TiltRecording"):
        a5.fit_tilt([3])
    with pytest.raises(a5.Alpha5Error, match="fixed base"):
        a5.fit_tilt(turned, a5.load(floating_base=True))
    one = turned[0]
    resting = a5.trajectory.motion(one.motion.time, np.ones((1200, 4)))
    level = np.tile([0.0, 0.0, 1.0], (1200, 1))
    still = replace(one, motion=resting, up=level)
    with pytest.raises(a5.Alpha5Error, match="arm at rest"):
        a5.fit_tilt([still])


@pytest.mark.slow
@needs_recordings
def test_recordings_that_nothing_was_fitted_to_are_predicted() -> None:
    """Four recordings of the campaign, then both halves of 26 others."""
    four = a5.fit_tilt(of_folder(RECORDINGS))
    halves = pool_recordings()
    one, other = (a5.fit_tilt(half) for half in halves)
    assert four.score([*halves[0], *halves[1]]).min() > 0.97
    assert one.score(halves[1]).min() > 0.94
    assert other.score(halves[0]).min() > 0.98
    for found in (four, one, other):
        assert np.degrees(found.yaw) == pytest.approx(7.1, abs=1.5)
        assert found.stiffness == pytest.approx([4.2, 4.2], abs=0.2)
