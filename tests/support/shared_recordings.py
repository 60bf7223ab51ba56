"""The folder of recordings of a real arm: beside the checkout, or ALPHA5_RECORDINGS."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

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
