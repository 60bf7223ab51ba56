"""``alpha5 fk``: where the frames of the arm are at a joint position."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from typer import Argument

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import rpy_from_rotation
from alpha5_model._support.text import table
from alpha5_model.cli import options, printing, values
from alpha5_model.cli.limits import JOINTS, beyond_limits
from alpha5_model.cli.units import MILLIMETRE

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm

_POSITIONS = f"{JOINTS} (rad), or also axis_a (m); or stow, home, reach."


def fk(
    q: Annotated[list[str], Argument(help=_POSITIONS)],
    arm_file: options.Arm = None,
    as_json: options.Json = False,
) -> None:
    """Where the tcp and the links are at a joint position, in base_link.

    Example: alpha5 fk 180 70 100 0 deg
    """
    own = values.arm_record(arm_file)
    position = values.joint_positions("q", " ".join(q), (4, 5), own)
    gripper = "locked" if len(position) == 4 else "jaws"
    arm = values.arm_in("sea", options.DOWN, gripper, None, None, own)

    record: dict[str, Any] = {
        "q": position,
        "beyond_limits": beyond_limits(arm, position),
        "frames": _frames(arm, position),
    }
    printing.show(as_json, record, _text(record))


def _frames(arm: Arm, q: list[float]) -> dict[str, FloatArray]:
    """Pose of the tcp and of each link in base_link, (4, 4) each."""
    names = [
        frame.name
        for frame in arm.model.frames
        if frame.name == "tcp" or frame.type.name == "BODY"
    ]
    return {name: arm.forward_kinematics(q, name).homogeneous for name in names}


def _text(record: dict[str, Any]) -> printing.Lines:
    rows = [
        ["frame", "x", "y", "z", "roll", "pitch", "yaw"],
        ["", *["mm"] * 3, *["deg"] * 3],
    ]
    for name, pose in record["frames"].items():
        position = pose[:3, 3] / MILLIMETRE
        angles = np.degrees(rpy_from_rotation(pose[:3, :3]))
        rows.append([name, *(f"{x:z.3f}" for x in (*position, *angles))])

    yield from table(rows)
    for name in record["beyond_limits"]:
        yield f"{name} is beyond its limits"
