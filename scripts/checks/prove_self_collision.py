"""Prove again what is committed about self-collision of the catalogue's arm.

    python scripts/checks/prove_self_collision.py [--update]

Makes anew which collision shapes can ever touch, and the tables of joint positions in
which the arm certainly is, or is not, in self-collision. Compares both with the files
in ``alpha5_model/collision/``; exit status 1 if they differ. ``--update`` writes the
files. It takes a minute, and needs the compiled kernels.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

import numpy as np

import alpha5_model.collision
from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model._support.writing import atomic_write_all
from alpha5_model.collision.bodies import (
    CollisionBodies,
    collision_bodies,
    joint_ranges,
)
from alpha5_model.collision.cells import certified_cells
from alpha5_model.collision.cells_file import NAME as CELLS_NAME
from alpha5_model.collision.cells_file import cells_text
from alpha5_model.collision.compiled import CompiledScene
from alpha5_model.collision.touching_pairs import TOUCHING_PAIRS_PATH
from alpha5_model.collision.touching_proof import touching_text
from alpha5_model.numbers.jaws import GRIPPERS
from alpha5_model.numbers.parameters import parameters

CELLS_PATH = Path(alpha5_model.collision.__file__).with_name(CELLS_NAME)


def _cells_text() -> str:
    """The text of the tables."""
    arm = parameters()
    bodies = collision_bodies(arm)
    tables = certified_cells(bodies, *joint_ranges(arm), _touches)
    return cells_text(bodies, tables)


def _touches(bodies: CollisionBodies, angles: FloatArray, margin: float) -> BoolArray:
    """The exact test."""
    rows = np.ascontiguousarray(angles)
    return CompiledScene(bodies).touches(rows, margin, asked=None)


def _without_angles(text: str) -> str:
    """The pairs only: where they touch may depend on the last bit of a distance."""
    return re.sub(r"(\[\d+, \d+), .*\]", r"\1]", text)


def main(arguments: list[str]) -> int:
    """Prove, then compare or write."""
    if arguments not in ([], ["--update"]):
        print(__doc__)
        return 2
    fresh = {
        TOUCHING_PAIRS_PATH: touching_text(parameters(), GRIPPERS),
        CELLS_PATH: _cells_text(),
    }
    if arguments:
        atomic_write_all({path: text.encode() for path, text in fresh.items()})
        return 0

    agree = True
    for path, text in fresh.items():
        committed = path.read_text("utf-8")
        agrees = _without_angles(text) == _without_angles(committed)
        verdict = "is as proven" if agrees else "is stale: run it with --update"
        print(f"{path.name} {verdict}")
        agree = agree and agrees
    return 0 if agree else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
