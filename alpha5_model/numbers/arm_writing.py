"""The catalogue's arm as a commented arm file, every key shown."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from alpha5_model.numbers import arm_schema as schema
from alpha5_model.numbers.arm_checks import LENGTHS
from alpha5_model.numbers.arm_schema import Key
from alpha5_model.numbers.corrections import CORRECTIONS, DEFAULT_CORRECTIONS
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
