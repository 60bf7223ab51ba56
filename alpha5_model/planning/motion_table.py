"""The table of a motion as CSV, which `alpha5_model.trajectory.read_motion` reads."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import PathLike
from alpha5_model._support.outputs import output_format
from alpha5_model._support.writing import atomic_write

#: Of the table of a motion.
FORMATS = (".csv",)


def write_motion_table(
    path: PathLike,
    joints: Sequence[str],
    time: FloatArray,
    position: FloatArray,
    velocity: FloatArray,
    acceleration: FloatArray,
) -> Path:
    """Write time, positions, velocities and accelerations.

    Columns are ``time_secs`` and, for each joint, ``axis_e_pos``, ``axis_e_vel`` and
    ``axis_e_acc``.

    Args:
        path: ``.csv``, ``-``, a device or a pipe.
        joints: Names of the joints, (n,).
        time: (N,) [s].
        position, velocity, acceleration: (N, n).

    Raises:
        UnknownNameError: Another suffix.
        OutputError: The file cannot be written.
    """
    output_format("motion format", path, FORMATS)
    names = ["time_secs"]
    columns = [time]
    for k, joint in enumerate(joints):
        names += [f"{joint}_pos", f"{joint}_vel", f"{joint}_acc"]
        columns += [position[:, k], velocity[:, k], acceleration[:, k]]
    # All digits: a replay of the file is that of the motion.
    rows = np.stack(columns, axis=1).tolist()
    lines = [",".join(map(repr, row)) for row in rows]
    return atomic_write(Path(path), "\n".join([",".join(names), *lines]) + "\n")
