"""What the page says of an arm that is not the catalogue's."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from alpha5_model._support.spatial import rpy_from_rotation
from alpha5_model.dynamics.arm_changes import changed_keys
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters
from alpha5_model.numbers.pose import Pose


def own_notes(record: Alpha5Parameters, floating_base: bool) -> tuple[str, ...]:
    """Lines that say what is different: parts, mount, what is not drawn.

    Args:
        record: Of an arm of one's own.
        floating_base: Whether the arm is afloat, so that its mount does not count.
    """
    changed = _grouped(changed_keys(record, parameters())) or "its name only"
    notes = [f"{record.name} differs from the catalogue's arm in {changed}."]
    if record.mount is not None and not floating_base:
        notes.append(_mount_note(record.mount))
    if record.attached:
        names = ", ".join(body.name for body in record.attached)
        notes.append(f"Attached, with its weight but not drawn: {names}.")
    if not Geometry.of(record).tool_on_axis:
        notes.append("Reach is not drawn for a tool beside the wrist axis.")
    return tuple(notes)


def _grouped(keys: Iterable[str]) -> str:
    """Keys of an arm file as text, for example ``lengths a_1, a_2; mount``."""
    tables: dict[str, list[str]] = {}
    for key in keys:
        table, _, name = key.partition(".")
        if table != "name":
            tables.setdefault(table.replace("_", " "), []).append(name)
    parts = [f"{table} {', '.join(names)}".rstrip() for table, names in tables.items()]
    return "; ".join(parts)


def _mount_note(mount: Pose) -> str:
    """Where base_link is on its carrier."""
    x, y, z = (_rounded(1e3 * part) for part in mount.position)
    turns = np.degrees(rpy_from_rotation(mount.rotation))
    roll, pitch, yaw = (_rounded(turn) for turn in turns)
    return (
        f"Mounted on {mount.parent} at ({x}, {y}, {z}) mm, turned by roll {roll}, "
        f"pitch {pitch}, yaw {yaw}\u00b0; drawn there without the yaw."
    )


def _rounded(number: float) -> str:
    """A number with one decimal, a true minus sign and no minus zero."""
    text = f"{round(number, 1) + 0.0:.1f}"
    return text.replace("-", "\u2212")
