"""The folder of recordings of a real arm: beside the checkout, or ALPHA5_RECORDINGS."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

import alpha5_model as a5

_BESIDE = Path(__file__).resolve().parents[3] / "shared" / "data"
RECORDINGS = Path(os.environ.get("ALPHA5_RECORDINGS", _BESIDE))
#: Recordings as they came, with gaps and jumps; and more of the same campaign.
UNTIDY = RECORDINGS / "untidy"
POOL = RECORDINGS / "pool"
JOINT_STATES = sorted(RECORDINGS.glob("*_joint_states.csv"))

needs_recordings = pytest.mark.skipif(
    not JOINT_STATES,
    reason="no recordings: the folder shared/data beside the checkout is absent",
)


def tilt_recordings(folder: Path) -> list[a5.TiltRecording]:
    """The usable recordings of a folder, by name, without what has to be left out."""
    from recordings import validate_recordings

    moving, _, _ = validate_recordings.read(folder)
    return [
        a5.TiltRecording(
            one.motion, one.time, -one.gravity / validate_recordings.GRAVITY, one.grid
        )
        for one in moving
    ]


def pool_recordings() -> tuple[list[a5.TiltRecording], list[a5.TiltRecording]]:
    """Every second recording of the pool, and the others."""
    found = tilt_recordings(POOL)
    return found[::2], found[1::2]
