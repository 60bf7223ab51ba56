"""A motion as a file: a table, a JointTrajectory, or commands of the arm's bus."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import PathLike
from alpha5_model._support.outputs import output_format
from alpha5_model._support.writing import atomic_write

#: Of a motion: a table, or a ``trajectory_msgs/JointTrajectory``.
FORMATS = (".csv", ".json", ".yaml")
#: Of commands of the bus.
BUS_FORMATS = (".csv",)
_NANOSECONDS = 10**9


def write_motion_table(
    path: PathLike,
    joints: Sequence[str],
    time: FloatArray,
    position: FloatArray,
    velocity: FloatArray,
    acceleration: FloatArray,
) -> Path:
    """Write time, positions, velocities and accelerations.

    The table, which `alpha5_model.trajectory.read_motion` reads, has the columns
    ``time_secs`` and, for each joint, ``axis_e_pos``, ``axis_e_vel`` and
    ``axis_e_acc``.

    Args:
        path: ``.csv``, ``-``, a device or a pipe; ``.json`` or ``.yaml`` for a
            ``trajectory_msgs/JointTrajectory``.
        joints: Names of the joints, (n,).
        time: (N,) [s].
        position, velocity, acceleration: (N, n).

    Raises:
        UnknownNameError: Another suffix.
        OutputError: The file cannot be written.
    """
    suffix = output_format("motion format", path, FORMATS)
    if suffix != ".csv":
        message = _joint_trajectory(joints, time, position, velocity, acceleration)
        return atomic_write(path, _text(message, suffix))

    columns = {"time_secs": time}
    for k, joint in enumerate(joints):
        columns[f"{joint}_pos"] = position[:, k]
        columns[f"{joint}_vel"] = velocity[:, k]
        columns[f"{joint}_acc"] = acceleration[:, k]
    return _write_columns(path, columns)


def write_bus_commands(
    path: PathLike, time: FloatArray, devices: Mapping[int, FloatArray]
) -> Path:
    """Write what the devices on the arm's bus are told: ``device_5 [rad]`` and so on.

    Args:
        path: ``.csv``, ``-``, a device or a pipe.
        time: (N,) [s].
        devices: Device -> its positions, (N,) [rad].

    Raises:
        UnknownNameError: Another suffix.
        OutputError: The file cannot be written.
    """
    output_format("format of bus commands", path, BUS_FORMATS)
    columns = {"time_secs": time}
    for device, positions in devices.items():
        columns[f"device_{device} [rad]"] = positions
    return _write_columns(path, columns)


def _write_columns(path: PathLike, columns: Mapping[str, FloatArray]) -> Path:
    # All digits: a replay of the file is that of the motion.
    rows = np.stack([*columns.values()], axis=1).tolist()
    lines = [",".join(map(repr, row)) for row in rows]
    return atomic_write(path, "\n".join([",".join(columns), *lines]) + "\n")


def _joint_trajectory(
    joints: Sequence[str],
    time: FloatArray,
    position: FloatArray,
    velocity: FloatArray,
    acceleration: FloatArray,
) -> dict[str, Any]:
    """The message; a controller starts it when it comes, since its stamp is zero."""
    points = []
    for k, nanoseconds in enumerate(np.rint(time * _NANOSECONDS).astype(int).tolist()):
        sec, nanosec = divmod(nanoseconds, _NANOSECONDS)
        point = {
            "positions": position[k].tolist(),
            "velocities": velocity[k].tolist(),
            "accelerations": acceleration[k].tolist(),
            "effort": [],
            "time_from_start": {"sec": sec, "nanosec": nanosec},
        }
        points.append(point)
    return {
        "header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""},
        "joint_names": list(joints),
        "points": points,
    }


def _text(message: dict[str, Any], suffix: str) -> str:
    if suffix == ".json":
        return json.dumps(message) + "\n"
    import yaml

    # libyaml's is ten times as fast; wheels of PyYAML have it.
    dumper = getattr(yaml, "CSafeDumper", yaml.SafeDumper)
    # In braces, it may stand inside the text of a goal.
    return str(yaml.dump(message, Dumper=dumper, default_flow_style=True))
