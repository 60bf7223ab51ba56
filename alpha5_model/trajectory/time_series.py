"""An analysed motion as a table over time, and its file."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import PathLike
from alpha5_model._support.outputs import output_format
from alpha5_model._support.writing import atomic_write
from alpha5_model.trajectory.analysis import Analysis
from alpha5_model.trajectory.key_figures import summary
from alpha5_model.trajectory.tables import Progress

#: Of the table: CSV; JSON with the key figures on top.
FORMATS = (".csv", ".json")
#: Rows between two reports of progress.
_CHUNK = 10_000


def columns(analysis: Analysis) -> dict[str, FloatArray]:
    """Every quantity over time by column name, in SI units.

    ``time_secs``; for each joint ``axis_e_pos, axis_e_vel, axis_e_acc`` (smoothed),
    ``axis_e_torque`` and its causes, ``axis_e_effort`` and
    ``axis_e_recorded_current`` as recorded, currents, voltage,
    powers and, with limits, ``axis_e_torque_min``, ``_max``, in a current
    ``axis_e_torque_moving_water_low``, ``_high``; ``base_force_x .. base_moment_z`` on
    the mount; ``tcp_x .. tcp_z``. Columns of a motor that cannot be computed are left
    out. Directions are the model's; `read_motion` can read the file again, for an arm
    whose signs are 1.
    """
    table = {"time_secs": analysis.smooth.time}
    of_joints = _columns_of_joints(analysis)
    for k, joint in enumerate(analysis.smooth.joints):
        for ending, values in of_joints.items():
            table[f"{joint}_{ending}"] = values[:, k]
    table |= _columns_of_axes(analysis)
    return {name: values for name, values in table.items() if not _unknown(values)}


def _columns_of_joints(a: Analysis) -> dict[str, FloatArray]:
    """Every quantity of the joints by the ending of its columns, (N, n) each."""
    table = {
        "pos": a.smooth.position,
        "vel": a.smooth.velocity,
        "acc": a.smooth.acceleration,
        "torque": a.torque,
    }
    for cause, torque in a.causes().items():
        table[f"torque_{cause}"] = torque
    if a.effort is not None:
        table["effort"] = a.effort
    if a.recorded_current is not None:
        table["recorded_current"] = a.recorded_current
    if a.moving_water is not None:
        table["torque_moving_water_low"] = a.moving_water.torque[:, 0]
        table["torque_moving_water_high"] = a.moving_water.torque[:, 2]
    table |= {
        "current": a.current,
        "current_lower": a.current_lower,
        "current_upper": a.current_upper,
        "voltage": a.voltage,
        "electrical_power": a.electrical_power,
        "mechanical_power": a.mechanical_power,
    }
    if a.torque_limits is not None:
        table["torque_min"] = a.torque_limits.lower
        table["torque_max"] = a.torque_limits.upper
    return table


def _columns_of_axes(a: Analysis) -> dict[str, FloatArray]:
    """The load on the mount and the TCP, axis by axis, (N,) each."""
    force = a.base_wrench[:, :3]
    moment = a.base_wrench[:, 3:]
    table = {}
    for k, axis in enumerate("xyz"):
        table[f"base_force_{axis}"] = force[:, k]
        table[f"base_moment_{axis}"] = moment[:, k]
        table[f"tcp_{axis}"] = a.tcp[:, k]
    return table


def _unknown(values: FloatArray) -> bool:
    """Whether a column has no number at all."""
    return bool(np.isnan(values).all())


def write(analysis: Analysis, path: PathLike, progress: Progress | None = None) -> Path:
    """Write the table; the suffix decides the format.

    Args:
        analysis: What to write.
        path: Target: ``.csv`` (also ``-``, devices and pipes) or ``.json``.
        progress: Called with a stage's name and the part done, 0 to 1.

    Raises:
        UnknownNameError: Another suffix.
        OutputError: The file cannot be written.
    """
    target = Path(path)
    suffix = output_format("table format", target, FORMATS)
    table = columns(analysis)
    if suffix == ".json":
        return atomic_write(target, _json_text(analysis, table))
    return atomic_write(target, _csv_text(table, progress))


def _json_text(analysis: Analysis, table: dict[str, FloatArray]) -> str:
    """The key figures and the table as JSON."""
    record = {
        "summary": summary(analysis),
        "columns": {name: _json_column(values) for name, values in table.items()},
    }
    return json.dumps(record, allow_nan=False) + "\n"


def _json_column(values: FloatArray) -> list[float | None]:
    """A column with None for what is not finite, as JSON needs it."""
    numbers = values.astype(object)
    numbers[~np.isfinite(values)] = None
    return list(numbers)


def _csv_text(table: dict[str, FloatArray], progress: Progress | None) -> str:
    """The table as CSV; times keep all their digits."""
    rows = np.stack(list(table.values()), axis=1)
    line = ",".join(["%.16g", *["%.9g"] * (len(table) - 1)])
    lines = [",".join(table)]
    for start in range(0, len(rows), _CHUNK):
        end = start + _CHUNK
        lines += [line % tuple(row) for row in rows[start:end].tolist()]
        if progress:
            progress("write", min(end, len(rows)) / len(rows))
    return "\n".join(lines) + "\n"
