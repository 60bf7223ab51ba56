"""An arm's record as the text of an arm file: what differs from the catalogue's arm."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any, TypeAlias

import numpy as np

from alpha5_model._support.checks import instance
from alpha5_model._support.spatial import rpy_from_rotation
from alpha5_model.numbers import arm_schema as schema
from alpha5_model.numbers.arm_checks import LENGTHS
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS
from alpha5_model.numbers.covariance_table import covariance_lines
from alpha5_model.numbers.measurement import Measurement
from alpha5_model.numbers.parameters import (
    Alpha5Parameters,
    JointParameters,
    parameters,
)
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.numbers.tool import printed_tool

#: Key -> value, of one table of a file.
_Table: TypeAlias = Mapping[str, Any]
#: Nothing of it is printed.
_NOTHING: _Table = MappingProxyType({})


def arm_file_text(arm: Alpha5Parameters, notes: Iterable[str] = ()) -> str:
    """The text of a file that describes an arm.

    `alpha5_model.arm_file` reads the record from it: lengths, limits, bodies and tool
    positions to the bit, zeros and rotations to their rounding, a covariance to 13
    digits. Jaws and the bounds of links, which no arm file has, are the catalogue's.

    Args:
        arm: The record.
        notes: Lines of comments at the head; characters that would end a line, or
            that no comment may hold, are escaped.
    """
    record = instance("arm", arm, Alpha5Parameters)
    writer = _Writer(record)
    lines = [
        *(_comment(note) for note in notes),
        "# Numbers are in SI units; what is left out is as printed.",
        f"format = {schema.FORMAT}",
        f"name = {_text(record.name)}",
    ]
    if record.corrections != DEFAULT_CORRECTIONS:
        lines.append(f"corrections = {_text(record.corrections)}")
    lines += [
        *writer.mount(),
        *writer.lengths(),
        *writer.zeros(),
        *writer.limits(),
        *writer.links(),
        *writer.attached(),
        *writer.tool(),
        *writer.motors(),
        *covariance_lines(record.covariance),
    ]
    return "\n".join(lines) + "\n"


def _comment(note: str) -> str:
    """A comment of one line, whatever the note holds: names from other files."""
    characters = [
        character if character.isprintable() else _escaped(character)
        for character in note
    ]
    return f"# {''.join(characters)}"


def _escaped(character: str) -> str:
    return character.encode("unicode_escape").decode()


class _Writer:
    """Writes the tables of a record: what differs from the catalogue, or was measured.

    Attributes:
        arm: The record.
        base: The catalogue's, with the same corrections.
        measured: Key -> measurement.
    """

    def __init__(self, arm: Alpha5Parameters) -> None:
        self.arm = arm
        self.base = parameters(arm.corrections)
        self.measured = {each.key: each for each in arm.measurements}

    def mount(self) -> list[str]:
        """Where base_link is fixed."""
        mount = self.arm.mount
        if mount is None:
            return []
        table = {
            "parent": mount.parent,
            "xyz": mount.position,
            "rpy": rpy_from_rotation(mount.rotation),
        }
        return self._table("mount", table)

    def lengths(self) -> list[str]:
        """Of Table 1."""
        own = {name: _length(self.arm, name) for name in LENGTHS}
        printed = {name: _length(self.base, name) for name in LENGTHS}
        return self._table("lengths", own, printed)

    def zeros(self) -> list[str]:
        """What is added to the angles of Table 1."""
        rows = zip(schema.ZEROS, self.arm.dh, self.base.dh, strict=False)
        zeros = {
            name: own.theta_offset - printed.theta_offset for name, own, printed in rows
        }
        return self._table("zeros", zeros, dict.fromkeys(zeros, 0.0))

    def limits(self) -> list[str]:
        """Of the joints, by MoveIt's keys."""
        lines = []
        for own, printed in zip(self.arm.joints, self.base.joints, strict=True):
            name = f"joint_limits.{own.name}"
            lines += self._table(name, _limits(own), _limits(printed))
        return lines

    def links(self) -> list[str]:
        """Masses and volumes."""
        lines = []
        for own, printed in zip(self.arm.links, self.base.links, strict=True):
            keys = schema.LINKS[own.name]
            name = f"links.{own.name}"
            lines += self._table(name, _fields(own, keys), _fields(printed, keys))
        return lines

    def attached(self) -> list[str]:
        """Bodies that are fixed to links."""
        lines = []
        for body in self.arm.attached:
            table: dict[str, Any] = {
                "name": body.name,
                "link": body.link,
                "at": body.position,
                "rpy": rpy_from_rotation(body.rotation),
                **_fields(body, ("mass", "com", "inertia", "volume", "cob")),
            }
            if body.spacer:
                table["spacer"] = body.spacer
            lines += ["", "[[attached]]", *self._values(f"attached.{body.name}", table)]
        return lines

    def tool(self) -> list[str]:
        """The tool, unless it is Table 1's, or where a spacer moves it."""
        printed = printed_tool(self.arm.dh[3], self.arm.dh[4])
        tool = self.arm.tool or printed
        own: dict[str, Any] = {}
        if not self.arm.spacer:
            own["xyz"] = tool.position
        if not np.array_equal(tool.rotation, printed.rotation):
            own["rpy"] = rpy_from_rotation(tool.rotation)
        return self._table("tool", own, {"xyz": printed.position})

    def motors(self) -> list[str]:
        """Supply, drivers, and what differs from Table 4, joint by joint."""
        motors = self.arm.motors
        top: dict[str, Any] = {"constants": motors.constants}
        if motors.supply_voltage is not None:
            top["supply_voltage"] = motors.supply_voltage

        tables: dict[str, tuple[_Table, _Table]] = {}
        for key, field in schema.DRIVE_FIELDS.items():
            values = zip(JOINT_NAMES, getattr(motors, field), strict=True)
            known = {joint: value for joint, value in values if value is not None}
            tables[key] = (known, {})
        for key in schema.ACTUATORS:
            tables[key] = (_column(self.arm, key), _column(self.base, key))
        for key in tables:
            if f"motors.{key}" in self.measured:
                top[key] = tables[key][0][JOINT_NAMES[0]]  # one value for all joints

        lines = self._table("motors", top, {"constants": self.base.motors.constants})
        for key, (own, printed) in tables.items():
            if key not in top:
                lines += self._table(f"motors.{key}", own, printed)
        return lines

    def _table(self, name: str, own: _Table, printed: _Table = _NOTHING) -> list[str]:
        """A table of what differs from the printed values, or was measured."""
        shown = {}
        for key, value in own.items():
            is_new = key not in printed or not np.array_equal(value, printed[key])
            if is_new or f"{name}.{key}" in self.measured:
                shown[key] = value
        return ["", f"[{name}]", *self._values(name, shown)] if shown else []

    def _values(self, name: str, table: _Table) -> list[str]:
        """The lines of keys, each with source and half width if they are known."""
        lines = []
        for key, value in table.items():
            text = _text(value)
            measured = self.measured.get(f"{name}.{key}")
            if measured is not None:
                text = _with_source(text, measured)
            lines.append(f"{key} = {text}")
        return lines


def _length(arm: Alpha5Parameters, name: str) -> float:
    row, field = LENGTHS[name]
    length: float = getattr(arm.dh[row], field)
    return length


def _limits(joint: JointParameters) -> _Table:
    return {key: getattr(joint, field) for key, field in schema.LIMIT_FIELDS.items()}


def _fields(record: Any, names: Iterable[str]) -> _Table:
    return {name: getattr(record, name) for name in names}


def _column(arm: Alpha5Parameters, name: str) -> _Table:
    """One quantity of Table 4, by joint."""
    rows = zip(JOINT_NAMES, arm.actuators, strict=True)
    return {joint: getattr(row, name) for joint, row in rows}


def _with_source(text: str, measured: Measurement) -> str:
    parts = [f"value = {text}"]
    if measured.source:
        parts.append(f"source = {_text(measured.source)}")
    if measured.half_width is not None:
        parts.append(f"half_width = {_text(measured.half_width)}")
    return f"{{{', '.join(parts)}}}"


def _text(value: Any) -> str:
    """A text, a number or a list as in TOML; a double reads back as the same one."""
    if isinstance(value, str):
        # TOML has the escapes of JSON, and wants one for DEL, too.
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if np.ndim(value):
        return f"[{', '.join(_text(x) for x in value)}]"
    # Adding zero turns a negative zero into zero.
    return repr(float(value) + 0.0)
