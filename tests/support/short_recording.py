"""A short recorded motion, as arrays and as a CSV file, and whether it is refused."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import Alpha5Error

JOINTS = [f"axis_{letter}" for letter in "edcb"]
TIME = np.arange(0.0, 4.0, 0.05)
#: (80, 4) [rad]
POSITION = a5.named_pose("home") + 0.3 * np.sin(TIME[:, None] / [1.0, 0.7, 0.5, 0.8])
#: Largest current of a motor that stalls: 24 V at 3.22 ohm of Table 4 [mA].
STALLED = 1e3 * 24.0 / 3.22


def motion(**more: Any) -> a5.trajectory.Motion:
    return a5.trajectory.motion(TIME, POSITION, **more)


def kinds(found: Any) -> list[str]:
    return [warning.kind for warning in found.warnings]


def csv(path: Path, columns: dict[str, Any]) -> Path:
    rows = np.column_stack([*columns.values()])
    header = ",".join(columns)
    np.savetxt(path, rows, delimiter=",", header=header, comments="", fmt="%.17g")
    return path


def positions(values: np.ndarray = POSITION) -> dict[str, np.ndarray]:
    return {f"{joint}_pos": values[:, k] for k, joint in enumerate(JOINTS)}


def refused(when: bool, words: str) -> Any:
    return pytest.raises(Alpha5Error, match=words) if when else nullcontext()
