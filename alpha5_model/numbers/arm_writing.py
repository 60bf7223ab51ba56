"""A record as an arm file: what differs from the catalogue's arm, or every key."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any, TypeAlias

import numpy as np

from alpha5_model._support.checks import FloatArray, flag, instance
from alpha5_model.numbers import arm_schema as schema
from alpha5_model.numbers.arm_checks import LENGTHS
from alpha5_model.numbers.arm_schema import Key
from alpha5_model.numbers.corrections import CORRECTIONS, DEFAULT_CORRECTIONS
from alpha5_model.numbers.covariance import Covariance
from alpha5_model.numbers.parameters import (
    Alpha5Parameters,
    JointParameters,
    Measurement,
    parameters,
)
from alpha5_model.numbers.pose import Pose, has_own_tool_point, printed_tool, tool_of
from alpha5_model.numbers.rigid_body import AttachedBody
from alpha5_model.numbers.tables import JOINT_NAMES

#: Key -> value, of one table of a file.
_Table: TypeAlias = Mapping[str, Any]
_NOTHING: _Table = MappingProxyType({})
#: Angles that are smaller are zeros [rad].
_ROUNDING = 1e-15
_HEAD = """\
# An arm of your own: the catalogue's arm, with every key. Change what you have measured, and delete the rest:
# what is left out is as printed. A number is in SI units, or a table with its own unit; it may have a source and
# a half width in this unit:
#     mass = {value = 341, unit = "g", source = "weighed on 3 May", half_width = 1}
# `alpha5 arm check FILE` says what a file changes. `alpha5 calibrate` makes a file of measurements; it adds a table
# [covariance]: how well the numbers are known together."""  # noqa: E501 (lines of a file)
#: Comments at tables of a file with every key, and what the catalogue's arm has not.
_COMMENTS = {
    "mount": """
# Where base_link is fixed. Without this table nothing is known of it.
# [mount]
# parent = "base"                              # frame of the vehicle
# xyz = {value = [210, 0, -85], unit = "mm"}   # origin of base_link in it
# rpy = {value = [180, 0, 0], unit = "deg"}    # roll, pitch, yaw""",
    "lengths": """
# Lengths of Table 1; a_1 = hypot(40 mm, 145.3 mm)""",
    "signs": """
# -1 if your driver counts in the other direction than this model, whose limits, zeros
# and joint positions keep their signs.""",
    "joint_limits.axis_e": """
# Efforts are placeholders: no rating is published. No acceleration or jerk is, either:
# max_acceleration = 0.5                       # rad/s^2, of axis_a m/s^2
# max_jerk = 5.0                               # rad/s^3, of axis_a m/s^3""",
    "links.link_0": """
# Tables 2 and 3, each link in its own frame. Products of inertia have the signs of
# URDF; the document prints the opposite ones.""",
    "attached": """
# Bodies that are fixed to a link: one such table for each.
# [[attached]]
# name = "force_sensor"
# link = "link_4"                              # link_0 to link_4
# at = {value = [0, 0, -75], unit = "mm"}      # origin of its frame in the link
# rpy = {value = [0, 0, 0], unit = "deg"}      # roll, pitch, yaw in the link
# spacer = {value = 22, unit = "mm"}           # on link_4: moves jaws and tool along -z
# mass = {value = 120, unit = "g"}
# com = [0, 0, 0]                              # in its own frame, as inertia and cob
# inertia = [[0, 0, 0], [0, 0, 0], [0, 0, 0]]  # without it, a point
# volume = {value = 0.045, unit = "L"}
# cob = [0, 0, 0]                              # without it, at the com""",
    "tool": """
# A spacer moves Table 1's tool point: then leave xyz out.""",
    "motors": """
# constants: "printed", "torque" (K_t for both) or "voltage" (K_v), which contradict
# each other. The rest is not printed; give one value for all joints, or one for each.
# supply_voltage = 24.0                        # V
# current_limit = 1.0                          # of the driver (A)
# rotor_inertia = {axis_e = 5e-7}              # at the motor shaft (kg m^2)
# friction_backward = {axis_e = 0.004}         # else friction holds both ways (N m)
# viscous_friction = {axis_e = 1e-6}           # per motor speed (N m s/rad)""",
}


def arm_file_text(
    arm: Alpha5Parameters, notes: Iterable[str] = (), *, every_key: bool = False
) -> str:
    """The text of a file that describes an arm.

    `alpha5_model.arm_file` reads the record from it: lengths, limits, bodies and tool
    positions to the bit, zeros and rotations to their rounding, a covariance to 13
    digits. Jaws and the bounds of links, which no arm file has, are the catalogue's.

    Args:
        arm: The record.
        notes: Lines of comments at the head; characters that would end a line, or
            that no comment may hold, are escaped.
        every_key: Whether keys whose values are as printed stand in it, too, each with
            a comment.
    """
    record = instance("arm", arm, Alpha5Parameters)
    writer = _Writer(record, flag("every_key", every_key))
    return "\n".join([*map(_comment, notes), *writer.lines()]) + "\n"


class _Writer:
    """Writes the tables of a record.

    Attributes:
        arm: The record.
        base: The catalogue's, with the same corrections.
        every_key: Whether to write what is as printed.
        measured: Key -> measurement.
    """

    def __init__(self, arm: Alpha5Parameters, every_key: bool) -> None:
        self.arm = arm
        self.base = parameters(arm.corrections)
        self.every_key = every_key
        self.measured = {each.key: each for each in arm.measurements}

    def lines(self) -> list[str]:
        """The lines of the file."""
        short = "# Numbers are in SI units; what is left out is as printed."
        return [
            _HEAD if self.every_key else short,
            f"format = {schema.FORMAT}",
            f"name = {_text(self.arm.name)}",
            *self._corrections(),
            *self._mount(),
            *self._lengths(),
            *self._zeros(),
            *self._signs(),
            *self._limits(),
            *self._links(),
            *self._attached(),
            *self._tool(),
            *self._motors(),
            *_covariance(self.arm.covariance),
        ]

    def _corrections(self) -> list[str]:
        line = f"corrections = {_text(self.arm.corrections)}"
        if self.every_key:
            return [f"{line}  # departures from the document: {', '.join(CORRECTIONS)}"]
        return [] if self.arm.corrections == DEFAULT_CORRECTIONS else [line]

    def _mount(self) -> list[str]:
        mount = self.arm.mount
        if mount is None:
            return self._remark("mount")
        own = {"parent": mount.parent, "xyz": mount.position, "rpy": _rpy(mount)}
        return self._table("mount", own, keys=schema.MOUNT)

    def _lengths(self) -> list[str]:
        own = {name: getattr(self.arm.dh[i], of) for name, (i, of) in LENGTHS.items()}
        printed = {
            name: getattr(self.base.dh[i], of) for name, (i, of) in LENGTHS.items()
        }
        return self._table("lengths", own, printed, schema.LENGTHS)

    def _zeros(self) -> list[str]:
        """What is added to the angles of Table 1."""
        rows = zip(schema.ZEROS, self.arm.dh, self.base.dh, strict=False)
        zeros = {
            name: own.theta_offset - printed.theta_offset for name, own, printed in rows
        }
        return self._table("zeros", zeros, dict.fromkeys(zeros, 0.0), schema.ZEROS)

    def _signs(self) -> list[str]:
        signs = {joint.name: joint.sign for joint in self.arm.joints}
        return self._table("signs", signs, dict.fromkeys(signs, 1))

    def _limits(self) -> list[str]:
        """Of the joints, by MoveIt's keys."""
        lines = []
        for own, printed in zip(self.arm.joints, self.base.joints, strict=True):
            name = f"joint_limits.{own.name}"
            keys = schema.JOINT_LIMITS[own.name]
            lines += self._table(name, _limits(own), _limits(printed), keys)
        return lines

    def _links(self) -> list[str]:
        """Masses and volumes."""
        lines = []
        for own, printed in zip(self.arm.links, self.base.links, strict=True):
            keys = schema.LINKS[own.name]
            name = f"links.{own.name}"
            lines += self._table(name, _fields(own, keys), _fields(printed, keys), keys)
        return lines

    def _attached(self) -> list[str]:
        """Bodies that are fixed to links."""
        if not self.arm.attached:
            return self._remark("attached")
        lines = []
        for body in self.arm.attached:
            key = f"attached.{body.name}"
            lines += ["", "[[attached]]", *self._values(key, _attached(body))]
        return lines

    def _tool(self) -> list[str]:
        """The tool, unless it is Table 1's, or where a spacer moves it."""
        printed = printed_tool(self.arm.dh[3], self.arm.dh[4])
        tool = tool_of(self.arm)
        own: dict[str, Any] = {}
        if not self.arm.spacer or has_own_tool_point(self.arm):
            own["xyz"] = tool.position
        if self.every_key or not np.array_equal(tool.rotation, printed.rotation):
            own["rpy"] = _rpy(tool)
        return self._table("tool", own, {"xyz": printed.position}, schema.TOOL)

    def _motors(self) -> list[str]:
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

        lines = self._table("motors", top, {"constants": self.base.motors.constants})
        keys = {**schema.DRIVES, **schema.ACTUATORS}
        for key, (own, printed) in tables.items():
            of_joints = dict.fromkeys(own, keys[key])
            lines += self._table(f"motors.{key}", own, printed, of_joints)
        return lines

    def _table(
        self,
        name: str,
        own: _Table,
        printed: _Table = _NOTHING,
        keys: Mapping[str, Key] = MappingProxyType({}),
    ) -> list[str]:
        """A table of what differs from the printed values, or was measured.

        Args:
            name: Of the table.
            own: The values of the arm.
            printed: Those of the catalogue.
            keys: For the comments in a file with every key.
        """
        shown = {}
        for key, value in own.items():
            is_new = key not in printed or not np.array_equal(value, printed[key])
            if is_new or self.every_key or f"{name}.{key}" in self.measured:
                shown[key] = value
        if not shown:
            return []
        lines = self._values(name, shown)
        if not self.every_key:
            return ["", f"[{name}]", *lines]
        for i, key in enumerate(shown):
            if key in keys:
                unit = f" ({keys[key].unit})".removesuffix(" (1)")
                lines[i] += f"  # {keys[key].about}{unit}"
        return [*(self._remark(name) or [""]), f"[{name}]", *lines]

    def _remark(self, name: str) -> list[str]:
        """The comment at a table, in a file with every key."""
        return [_COMMENTS[name]] if self.every_key and name in _COMMENTS else []

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


def _limits(joint: JointParameters) -> dict[str, Any]:
    """The limits of a joint that are known, by MoveIt's keys."""
    limits = {key: getattr(joint, field) for key, field in schema.LIMIT_FIELDS.items()}
    return {key: value for key, value in limits.items() if value is not None}


def _attached(body: AttachedBody) -> dict[str, Any]:
    """The table of an attached body."""
    table: dict[str, Any] = {
        "name": body.name,
        "link": body.link,
        "at": body.position,
        "rpy": _rpy(body.pose),
        **_fields(body, ("mass", "com", "inertia", "volume", "cob")),
    }
    if body.spacer:
        table["spacer"] = body.spacer
    return table


def _rpy(pose: Pose) -> FloatArray:
    """Roll, pitch, yaw, without what only rounding makes of zeros."""
    return np.where(np.abs(pose.rpy) < _ROUNDING, 0.0, pose.rpy)


def _fields(record: Any, names: Iterable[str]) -> _Table:
    return {name: getattr(record, name) for name in names}


def _column(arm: Alpha5Parameters, name: str) -> _Table:
    """One quantity of Table 4, by joint."""
    rows = zip(JOINT_NAMES, arm.actuators, strict=True)
    return {joint: getattr(row, name) for joint, row in rows}


def _covariance(covariance: Covariance | None) -> list[str]:
    """The lines of ``[covariance]``; none without a covariance."""
    if covariance is None:
        return []
    lines = [
        "",
        "# Covariance D (1 - F F^T) D of these numbers, SI units: D, the deviation,",
        "# was known before the calibration; F, the factor, is what it has told.",
        "[covariance]",
        "names = [",
        *(f'  "{name}",' for name in covariance.names),
        "]",
        "deviation = [",
        *(f"  {number!r}," for number in covariance.deviation.tolist()),
        "]",
        "factor = [",
    ]
    for row in covariance.factor:
        lines.append(f"  [{', '.join(f'{x:.13g}' for x in row)}],")
    return [*lines, "]"]


def _comment(note: str) -> str:
    """A comment of one line, whatever the note holds: names from other files."""
    characters = [
        c if c.isprintable() else c.encode("unicode_escape").decode() for c in note
    ]
    return f"# {''.join(characters)}"


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
    if isinstance(value, int):
        return str(value)
    # Adding zero turns a negative zero into zero.
    return repr(float(value) + 0.0)
