"""An analysed motion as a table: CSV, or JSON with the summary on top. Files are written whole or not."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.files import atomic_write, output_format
from alpha5_model.trajectory.analysis import BY_MOTOR, Analysis
from alpha5_model.trajectory.reading import Progress
from alpha5_model.trajectory.summary import CAUSES, summary

FORMATS = (".csv", ".json")
_CHUNK = 10_000

#: Suffix of a joint's column -> attribute of the analysis that holds it.
_JOINT_COLUMNS = {
    "torque": "torque",
    **{f"torque_{cause}": cause for cause in CAUSES},
    **{name: name for name in (*BY_MOTOR[1:], "mechanical_power")},
}


def columns(analysis: Analysis) -> dict[str, FloatArray]:
    """Every quantity over time by column name, SI units; motors that cannot be computed are left out.

    ``time_secs``; for each joint ``axis_e_pos, axis_e_vel, axis_e_acc`` (smoothed), ``axis_e_torque``
    and its causes, currents, voltage, powers and, with limits, ``axis_e_torque_min``, ``_max``;
    ``base_force_x .. base_moment_z`` on the mount; ``tcp_x .. tcp_z``. The file can be read again by
    `read_motion`.
    """
    a, s = analysis, analysis.smooth
    out = {"time_secs": s.time}
    for k, name in enumerate(s.joints):
        out[f"{name}_pos"] = s.position[:, k]
        out[f"{name}_vel"] = s.velocity[:, k]
        out[f"{name}_acc"] = s.acceleration[:, k]
        for suffix, attribute in _JOINT_COLUMNS.items():
            out[f"{name}_{suffix}"] = getattr(a, attribute)[:, k]
        if a.torque_limits is not None:
            out[f"{name}_torque_min"] = a.torque_limits.lower[:, k]
            out[f"{name}_torque_max"] = a.torque_limits.upper[:, k]
    for k, name in enumerate("xyz"):
        out[f"base_force_{name}"] = a.base_wrench[:, k]
        out[f"base_moment_{name}"] = a.base_wrench[:, 3 + k]
        out[f"tcp_{name}"] = a.tcp[:, k]
    return {name: column for name, column in out.items() if not np.isnan(column).all()}


def write(
    analysis: Analysis, path: str | os.PathLike[str], progress: Progress | None = None
) -> Path:
    """Write the table; the suffix says how, ``.csv`` (also ``-``, devices and pipes) or ``.json``.

    Args:
        analysis: What to write.
        path: Target.
        progress: Called with a stage's name and the part done, 0 to 1.

    Raises:
        UnknownNameError: Another suffix.
        OutputError: The file cannot be written.
    """
    target = Path(path)
    kind = output_format("table format", target, FORMATS)
    table = columns(analysis)
    if kind == ".json":
        record = {"summary": summary(analysis), "columns": {k: _json(v) for k, v in table.items()}}
        return atomic_write(target, json.dumps(record, allow_nan=False) + "\n")
    rows = np.stack(list(table.values()), axis=1)
    line = ",".join(["%.16g", *["%.9g"] * (len(table) - 1)])
    parts = [",".join(table)]
    for start in range(0, len(rows), _CHUNK):
        parts += [line % tuple(row) for row in rows[start : start + _CHUNK].tolist()]
        if progress:
            progress("write", min(start + _CHUNK, len(rows)) / len(rows))
    return atomic_write(target, "\n".join(parts) + "\n")


def _json(column: FloatArray) -> list[float | None]:
    numbers = column.astype(object)
    numbers[~np.isfinite(column)] = None
    return list(numbers)
