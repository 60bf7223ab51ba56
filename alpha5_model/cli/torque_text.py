"""What ``alpha5 torque`` prints for people, made from its record."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from alpha5_model._support.text import table
from alpha5_model.cli import printing
from alpha5_model.cli.torque_record import TERMS, Record
from alpha5_model.numbers.hydrodynamics import LEVELS

#: Decimals of every number, and the width to which a table keeps them.
_DECIMALS = 4
_LARGEST_WITH_DECIMALS = 1e5
#: Cause of a torque -> head of its column.
_CAUSES = {
    "inertia": "inertia",
    "coriolis": "+ Coriolis",
    "weight": "+ weight",
    "buoyancy": "+ buoyancy",
    "moving_water": "+ water",
}
#: Joints that turn; the jaw rod, which slides, may follow them.
_TURNING = 4


def torque_lines(record: Record) -> printing.Lines:
    """Torques, load on the mount, currents; then warnings; then assumptions."""
    joints = record["joints"]
    yield from _torque_table(joints)
    yield ""
    yield from _mount_load(record["mount"])
    yield ""
    yield from _current_table(joints)
    if "water_current" in record:
        yield ""
        yield from _moving_water(record)
    yield ""
    yield from _warnings(record)
    yield printing.payload(record["payload_kg"])
    gravity = ", ".join(f"{round(g, 6) + 0.0:g}" for g in record["gravity"])
    density = record["fluid_density"]
    yield f"fluid {density:g} kg/m^3; gravity ({gravity}) m/s^2 in base_link"
    yield "± by all digits and half widths, worst case to first order"


def _torque_table(joints: list[Record]) -> list[str]:
    """Torque of each joint by cause, and half the width of its interval."""
    in_water = "moving_water" in joints[0]
    causes = [*TERMS, *(["moving_water"] if in_water else [])]
    head = ["", *(_CAUSES[cause] for cause in causes), "= torque", "±"]
    columns = [*causes, "torque"]
    numbers = [[*(joint[key] for key in columns), _margin(joint)] for joint in joints]
    decimals = _decimals(numbers)
    rows = [head]
    for unit, group in _by_unit(joints):
        rows.append(["", *[unit] * (len(head) - 1)])
        for k in group:
            mark = "" if joints[k]["within_limits"] else " *"
            cells = [_number(x, decimals) for x in numbers[k]]
            rows.append([joints[k]["joint"] + mark, *cells])
    return table(rows)


def _by_unit(joints: list[Record]) -> list[tuple[str, range]]:
    """Unit of a torque or force, and the numbers of its joints."""
    groups = [("N m", range(_TURNING)), ("N", range(_TURNING, len(joints)))]
    return [(unit, group) for unit, group in groups if group]


def _margin(joint: Record) -> float:
    low, high = joint["torque_range"]
    return float(high - low) / 2


def _mount_load(mount: Record) -> list[str]:
    """Force, and moment about the origin of base_link; x, y, z in base_link."""
    vectors = [mount["force"], mount["moment"]]
    decimals = _decimals(vectors)
    rows = [["load on the mount", "x", "y", "z", ""]]
    for name, vector, unit in zip(
        ("force", "moment"), vectors, ("N", "N m"), strict=True
    ):
        cells = [_number(x, decimals) for x in vector]
        rows.append([name, *cells, f"{unit} at base_link"])
    return table(rows, "<>>><")


def _current_table(joints: list[Record]) -> list[str]:
    """Current of each motor, its range, and what the range means."""
    known = [joint for joint in joints if joint["current"] is not None]
    currents = [[joint["current"], *joint["current_range"]] for joint in known]
    decimals = _decimals(currents)
    rows = [["motor current", "A", "range", ""]]
    for joint in joints:
        if joint["current"] is None:
            rows.append([joint["joint"], "-", "-", "the screw's lead is not published"])
            continue
        state = "at rest; any in the range holds it"
        if joint["velocity"]:
            state = "moving, with friction and gear loss"
        current = _number(joint["current"], decimals)
        ends = _range(joint["current_range"], decimals)
        rows.append([joint["joint"], current, ends, state])
    return table(rows, "<>><")


def _moving_water(record: Record) -> printing.Lines:
    """What moving water adds, with the interval of its estimates."""
    velocity = ", ".join(f"{x:g}" for x in record["water_current"])
    yield f"moving water, ({velocity}) m/s in base_link; estimated, not published"

    names = []
    units = []
    numbers = []
    for k, joint in enumerate(record["joints"]):
        names.append(joint["joint"])
        units.append("N m" if k < _TURNING else "N")
        numbers.append([joint["moving_water"], *joint["moving_water_range"]])
    loads = record["mount"]["moving_water"]
    for part, unit in (("force", "N"), ("moment", "N m")):
        low, nominal, high = [math.hypot(*loads[level][part]) for level in LEVELS]
        names.append(part)
        units.append(f"{unit} on the mount")
        numbers.append([nominal, low, high])

    decimals = _decimals(numbers)
    rows = [["", "nominal", "range", ""]]
    for name, (nominal, *ends), unit in zip(names, numbers, units, strict=True):
        rows.append([name, _number(nominal, decimals), _range(ends, decimals), unit])
    yield from table(rows, "<>><")


def _warnings(record: Record) -> printing.Lines:
    if not all(joint["within_limits"] for joint in record["joints"]):
        yield "* position beyond the joint's limits"
    if "self_collision" in record:
        place = record["self_collision"]
        links = " and ".join(place["links"])
        yield f"self-collision: {links} overlap by {1e3 * place['depth']:.3g} mm"


def _decimals(numbers: Sequence[Sequence[float]]) -> int | None:
    """Decimals of all numbers of a table; None for powers of ten.

    All cells of a table have the same format, because columns of numbers are
    compared by their length.
    """
    largest = max((float(np.abs(row).max()) for row in numbers if len(row)), default=0)
    return _DECIMALS if largest < _LARGEST_WITH_DECIMALS else None


def _range(ends: Sequence[float], decimals: int | None) -> str:
    return " to ".join(_number(end, decimals) for end in ends)


def _number(x: float, decimals: int | None) -> str:
    return f"{x:z.3e}" if decimals is None else f"{x:z.{decimals}f}"
