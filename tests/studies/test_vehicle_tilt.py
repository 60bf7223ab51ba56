"""The script that fits the tilt of a floating vehicle: a known answer is found."""

from __future__ import annotations

import numpy as np
import pytest
import reference
from identification import validate_recordings as recordings
from identification import vehicle_tilt
from shared_recordings import POOL, RECORDINGS, needs_recordings

import alpha5_model as a5

STIFFNESS = np.array([6e5, 9e5])
TIME = np.arange(0.0, 16.0, 0.05)


def moment(q: np.ndarray) -> np.ndarray:
    """Of weight less buoyancy of the moving links about x and y, from the tables."""
    total = np.zeros(3)
    frames = list(reference.inertial_frames(q))
    for i in range(1, len(frames)):
        weight = np.append(np.array(reference.COM[i]) / 1e3, 1.0)
        lift = np.append(np.array(reference.COB[i]) / 1e3, 1.0)
        lever = reference.MASS[i] * (frames[i] @ weight)[:3]
        lever = lever - reference.VOLUME[i] * (frames[i] @ lift)[:3]
        total += np.cross(lever, [0.0, 0.0, -recordings.GRAVITY])
    return total[:2]


def recording(yaw: float) -> recordings.Recording:
    """A vehicle that hardly tilts, so that gravity is the same; 0.3 s late."""
    q = a5.named_pose("home") + 0.6 * np.sin(np.outer(TIME, [0.5, 0.61, 0.7, 0.83]))
    turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    late = np.maximum(np.arange(TIME.size) - 6, 0)
    tilt = np.array([moment(one) for one in q])[late] @ turn.T / STIFFNESS
    return recordings.Recording(
        name="stiff",
        motion=a5.trajectory.motion(TIME, q),
        time=TIME,
        tilt=tilt,
        gravity=np.tile([0.0, 0.0, -recordings.GRAVITY], (TIME.size, 1)),
        grid=np.arange(2.0, 14.0, 0.05),
    )


@pytest.mark.slow
@pytest.mark.parametrize("yaw", [-3.0, 0.2])
def test_a_stiff_vehicle_is_fitted_exactly(yaw: float) -> None:
    found = vehicle_tilt.fit([recording(yaw)])
    assert found.yaw == pytest.approx(yaw, abs=1e-5)
    assert found.stiffness == pytest.approx(STIFFNESS, rel=1e-4)
    assert recordings.LAGS[found.lag] == pytest.approx(0.3)
    assert vehicle_tilt.score(found, [recording(yaw)]).min() > 1 - 1e-6


@pytest.mark.slow
@needs_recordings
def test_recordings_that_nothing_was_fitted_to_are_predicted() -> None:
    four, _, _ = recordings.read(RECORDINGS)
    others, _, _ = recordings.read(POOL)
    found = vehicle_tilt.fit(four)
    assert np.degrees(found.yaw) == pytest.approx(7.1, abs=1.5)
    assert found.stiffness == pytest.approx([4.2, 4.2], abs=0.2)
    assert vehicle_tilt.score(found, others).min() > 0.97
