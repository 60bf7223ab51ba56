"""Every key of an arm file, changed alone: a walk over the schema."""

from __future__ import annotations

from collections.abc import Iterator

import alpha5_model as a5
from alpha5_model.numbers import arm_schema

_NUMBERS = {
    "length": 0.11,
    "mount length": 0.11,
    "jaw length": 0.0101,
    "angle": 0.101,
    "speed": 0.12,
    "rod speed": 0.001,
    "torque": 1.5,
    "force": 7.0,
    "mass": 0.33,
    "volume": 7e-5,
    "current": 1.2,
    "voltage": 23.0,
    "share": 0.71,
}
#: Keys whose number must be near another one.
_SPECIAL = {
    "a_0": 0.021,
    "d_0": 0.047,
    "a_1": 0.152,
    "a_2": 0.021,
    "d_3": -0.179,
    "max_position": 3.0,
}
#: An attached body with no more than it needs, and one with every key.
SENSOR = '[[attached]]\nname = "s"\nlink = "link_4"\nat = [0, 0, 0]\nmass = 0.5\n'
WHOLE = (
    SENSOR
    + """rpy = [0.1, 0.2, 0.3]
com = [0.002, 0.001, 0.003]
inertia = [[2e-4, 0, 0], [0, 2.5e-4, 0], [0, 0, 3e-4]]
volume = 1e-4
cob = [0.003, 0.002, 0.001]
"""
)


def other(name: str, key: arm_schema.Key) -> str:
    """Another value for a key, in SI units."""
    if key.dimension_name == "jaw length" and name == "min_position":
        return "0.0012"
    if key.dimension_name == "jaw length" and name == "max_position":
        return "0.0132"
    number = _SPECIAL.get(name, _NUMBERS.get(key.dimension_name, 1.1e-3))
    if name == "com":
        return "[0.001, 0.002, -0.04]"
    if key.shape == (3,):
        return f"[{number / 10}, 0.003, {-number}]"
    if key.shape == (3, 3):
        return "[[3e-4, 1e-6, 0], [1e-6, 3e-4, 0], [0, 0, 2e-4]]"
    return str(number)


def _near(table: str, name: str) -> str:
    """Another COM or inertia of a link; a body takes none that is far off."""
    link = a5.parameters().links[int(table[-1])]
    if name == "com":
        return str((link.com + 1e-3).tolist())
    if name == "inertia":
        return str((link.inertia * 1.1).tolist())
    return ""


def changes(sensor: str) -> Iterator[tuple[str, str]]:
    """Dotted key -> a file in which it alone has another value.

    Args:
        sensor: The attached body of which one key is changed, `SENSOR` or `WHOLE`.
    """
    yield "name", 'name = "other"'
    yield "corrections", "corrections = []"
    yield "mount.parent", '[mount]\nparent = "rov"'
    yield "motors.constants", '[motors]\nconstants = "torque"'
    yield "motors.supply_voltage", "[motors]\nsupply_voltage = 23"
    flat_tables = {
        "mount": arm_schema.MOUNT,
        "lengths": arm_schema.LENGTHS,
        "zeros": arm_schema.ZEROS,
        "tool": arm_schema.TOOL,
        **{f"joint_limits.{n}": k for n, k in arm_schema.JOINT_LIMITS.items()},
        **{f"links.{n}": k for n, k in arm_schema.LINKS.items()},
    }
    for table, keys in flat_tables.items():
        for name, key in keys.items():
            number = other(name, key)
            if table.startswith("links."):
                number = _near(table, name) or number
            text = f"[{table}]\n{name} = {number}"
            yield f"{table}.{name}", text
    for name, key in {**arm_schema.DRIVES, **arm_schema.ACTUATORS}.items():
        for joint in arm_schema.JOINT_LIMITS:
            text = f"[motors]\n{name} = {{{joint} = {other(name, key)}}}"
            yield f"motors.{name}.{joint}", text
    for name, key in arm_schema.ATTACHED.items():
        lines = sensor.splitlines()
        kept = [line for line in lines if not line.startswith(f"{name} =")]
        kept.append(f"{name} = {other(name, key)}")
        yield f"attached.{name}", "\n".join(kept)
    yield "attached.name", sensor.replace('"s"', '"t"')
    yield "attached.link", sensor.replace("link_4", "link_2")
