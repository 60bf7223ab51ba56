"""Arm files written: the catalogue's with every key, and any record."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, TypeAlias

import numpy as np

from alpha5_model._support.checks import instance
from alpha5_model._support.spatial import rpy_from_rotation
from alpha5_model.numbers import arm_schema as schema
from alpha5_model.numbers.arm_checks import LENGTHS
from alpha5_model.numbers.arm_schema import Key
from alpha5_model.numbers.corrections import CORRECTIONS, DEFAULT_CORRECTIONS
from alpha5_model.numbers.covariance_table import covariance_lines
from alpha5_model.numbers.parameters import (
    Alpha5Parameters,
    JointParameters,
    Measurement,
    parameters,
)
from alpha5_model.numbers.pose import printed_tool
from alpha5_model.numbers.printed import published
from alpha5_model.numbers.quantity import Quantity
from alpha5_model.numbers.tables import JOINT_NAMES, BodyBounds, Published

#: What TOML takes for the printed units whose spelling differs.
_UNITS = {
    "V/rad/s": "V s/rad",
    "Nm/A": "N m/A",
    "kg.mm^2": "kg mm^2",
    "Nm": "N m",
    "Nmm": "N mm",
}
_HEAD = """\
# An arm of your own: the catalogue's arm, with every key. Change what you have measured, and delete the rest:
# what is left out is as printed. A number without a unit is in SI units (m, rad, kg, m^3, kg m^2, N m, rad/s).
# A value may have a source and a half width in its own unit:
#     mass = {value = 341, unit = "g", source = "weighed on 3 May", half_width = 1}
# `alpha5 arm check FILE` says what a file changes. `alpha5 calibrate` makes a file of measurements; it adds a table
# [covariance]: how well the numbers are known together.
format = 1
"""  # noqa: E501 (lines of a file)
_MOUNT = """
# Where base_link is fixed. Without this table nothing is said of it.
# [mount]
# parent = "base"                              # frame of the vehicle
# xyz = {value = [210, 0, -85], unit = "mm"}   # origin of base_link in it
# rpy = {value = [180, 0, 0], unit = "deg"}    # roll, pitch, yaw
"""
_ATTACHED = """
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
# cob = [0, 0, 0]                              # without it, at the com
"""
_TOOL = """
# The tcp in link_4, whose jaws are along -z. A spacer moves it: then leave xyz out.
[tool]
xyz = {value = [0, 0, %s], unit = "mm"}  # tool point in link_4
rpy = {value = [90, 90, 0], unit = "deg"}  # roll, pitch, yaw of the tcp in link_4
"""
_MOTORS = """
[motors]
# Not printed; without them nothing is said of them. One value for all joints, or one for each.
# supply_voltage = 24.0                        # (V)
# current_limit = 1.0                          # of the driver (A)
# rotor_inertia = {axis_e = 5e-7}              # at the motor shaft (kg m^2)
# friction_backward = {axis_e = 0.004}         # at the motor shaft; else friction holds both ways (N m)
# viscous_friction = {axis_e = 1e-6}           # at the motor shaft, per motor speed (N m s/rad)
constants = "printed"  # or "torque" (K_t for both) or "voltage" (K_v), which contradict each other
"""  # noqa: E501 (lines of a file)


def new_arm_file() -> str:
    """The text of a file that describes the catalogue's arm.

    `alpha5_model.arm_file` reads the catalogue's record from it, exactly: numbers stand
    in it with the digits and units of the document.
    """
    printed = published()
    wrist = printed.table_1.rows[3].d.text
    return "".join(
        [
            _HEAD,
            _names(),
            _MOUNT,
            _lengths(printed),
            _zeros(),
            _limits(printed),
            _links(printed),
            _ATTACHED,
            _TOOL % wrist,
            _MOTORS,
            _actuators(printed),
        ]
    )


def _names() -> str:
    """Name and corrections."""
    known = ", ".join(CORRECTIONS)
    chosen = ", ".join(f'"{name}"' for name in DEFAULT_CORRECTIONS)
    return (
        'name = "alpha5"\n'
        f"corrections = [{chosen}]  # departures from the document: {known}\n"
    )


def _lengths(printed: Published) -> str:
    """The lengths of Table 1; a_1 is computed there."""
    lines = ["", "# Lengths of Table 1; a_1 = hypot(40 mm, 145.3 mm)", "[lengths]"]
    for name, (i, field) in LENGTHS.items():
        number = getattr(printed.table_1.rows[i], field)
        if isinstance(number, str):
            # The repr of a double reads back as the same double.
            lines.append(f'{name} = {{value = {_elbow(printed)!r}, unit = "m"}}')
        else:
            lines.append(f"{name} = {_value(number)}")
    return _joined(lines)


def _elbow(printed: Published) -> float:
    """Length a_1 [m]."""
    return math.hypot(printed.elbow.opposite.si, printed.elbow.adjacent.si)


def _zeros() -> str:
    lines = [
        "",
        "# Added to the angle that a joint reports (its angle in this model)",
        "[zeros]",
        *(f'{name} = {{value = 0, unit = "deg"}}' for name in schema.ZEROS),
    ]
    return _joined(lines)


def _limits(printed: Published) -> str:
    """Limits by MoveIt's keys."""
    lines: list[str] = []
    for row in printed.supplementary.joints:
        keys = schema.JOINT_LIMITS[row.name]
        quantities = {
            "min_position": row.lower,
            "max_position": row.upper,
            "max_velocity": row.velocity,
            "max_effort": row.effort,
        }
        lines += ["", f"[joint_limits.{row.name}]"]
        for name, sourced in quantities.items():
            note = " (a placeholder)" if sourced.status == "placeholder" else ""
            about = f"{keys[name].about}{note}"
            lines.append(f"{name} = {_value(sourced.quantity)}  # {about}")
    return _joined(lines)


def _links(printed: Published) -> str:
    """Tables 2 and 3, with products of inertia as in URDF."""
    rows = zip(
        printed.supplementary.bodies,
        printed.table_2.rows,
        printed.table_3.rows,
        strict=True,
    )
    lines = [
        "",
        "# Tables 2 and 3, each link in its own frame. Products of inertia have the",
        "# signs of URDF; the document prints the opposite ones.",
    ]
    for body, inertial, buoyancy in rows:
        tensor = [
            [q if i == j else _negative(q) for j, q in enumerate(row)]
            for i, row in enumerate(inertial.inertia_com)
        ]
        quantities = {
            "mass": inertial.mass,
            "com": inertial.com,
            "inertia": tensor,
            "volume": buoyancy.volume,
            "cob": buoyancy.cob,
        }
        lines += _link(body, quantities)
    return _joined(lines)


def _link(body: BodyBounds, quantities: Mapping[str, Any]) -> list[str]:
    """The lines of a link."""
    lines = ["", f"[links.{body.name}]"]
    for name, quantity in quantities.items():
        about = schema.LINKS[body.name][name].about
        lines.append(f"{name} = {_value(quantity)}  # {about}")
    return lines


def _actuators(printed: Published) -> str:
    """Table 4, one table by joint for each quantity."""
    lines: list[str] = []
    for name, key in schema.ACTUATORS.items():
        lines += ["", *_actuator(name, key, printed.table_4.rows)]
    return _joined(lines)


def _actuator(name: str, key: Key, rows: Iterable[Any]) -> list[str]:
    """One quantity of all motors."""
    lines = [f"[motors.{name}]  # {key.about}"]
    for joint, row in zip(JOINT_NAMES, rows, strict=True):
        lines.append(f"{joint} = {_value(getattr(row, name))}")
    return lines


def _value(given: Quantity | Sequence[Any]) -> str:
    """A value of a file, with the printed digits and unit."""
    unit = _unit(given)
    spelt = _UNITS.get(unit, unit)
    if not spelt:
        return _digits(given)
    return f'{{value = {_digits(given)}, unit = "{spelt}"}}'


def _digits(given: Quantity | Sequence[Any]) -> str:
    if isinstance(given, Quantity):
        return given.text.lstrip("+")
    return f"[{', '.join(map(_digits, given))}]"


def _unit(given: Quantity | Sequence[Any]) -> str:
    """The unit that all numbers share."""
    return given.unit if isinstance(given, Quantity) else _unit(given[0])


def _negative(quantity: Quantity) -> Quantity:
    """The same number with the other sign."""
    text = quantity.text
    negated = text[1:] if text.startswith("-") else f"-{text.lstrip('+')}"
    return Quantity(negated, quantity.unit)


def _joined(lines: Iterable[str]) -> str:
    return "\n".join(lines) + "\n"


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
            lines += self._table(name, _limits_of(own), _limits_of(printed))
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


def _limits_of(joint: JointParameters) -> _Table:
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
