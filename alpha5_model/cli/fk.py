"""``alpha5 fk``: where the frames of the arm are at a joint position."""

from __future__ import annotations

from argparse import Namespace
from typing import TYPE_CHECKING, Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import rpy_from_rotation
from alpha5_model._support.text import table
from alpha5_model.cli import options as common
from alpha5_model.cli import printing
from alpha5_model.cli.parsing import Parser

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm

HELP = "Example: alpha5 fk 180 70 100 0 deg"


def options(parser: Parser) -> None:
    parser.add_argument(
        "q",
        type=common.POSITION,
        metavar="Q",
        help=f"{common.JOINTS} (rad), or also axis_a (m); or stow, home, reach",
    )
    common.arm_file(parser)
    common.as_json(parser)


def run(given: Namespace) -> None:
    from alpha5_model.dynamics.load import load

    own = common.record_of(given)
    q = common.position_of(given.q, own)
    arm = load(gripper="locked" if len(q) == 4 else "jaws", arm=own)
    record: dict[str, Any] = {
        "q": q,
        "beyond_limits": common.beyond_limits(arm, q),
        "frames": _frames(arm, q),
    }
    printing.show(given.json, record, _text(record))


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
        position = 1e3 * pose[:3, 3]
        angles = np.degrees(rpy_from_rotation(pose[:3, :3]))
        rows.append([name, *(f"{x:z.3f}" for x in (*position, *angles))])

    yield from table(rows)
    for name in record["beyond_limits"]:
        yield f"{name} is beyond its limits"
