"""``alpha5 arm``: a file that describes your own arm."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model._support.files import STDOUT
from alpha5_model._support.text import table
from alpha5_model._support.writing import atomic_write
from alpha5_model.cli import options as common
from alpha5_model.cli import printing
from alpha5_model.cli.parsing import Parser
from alpha5_model.errors import OutputError
from alpha5_model.numbers.arm_checks import LENGTHS
from alpha5_model.numbers.arm_file import arm_file
from alpha5_model.numbers.arm_writing import arm_file_text
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters
from alpha5_model.numbers.pose import tool_of
from alpha5_model.numbers.tables import JOINT_NAMES

#: The file that ``new`` writes if none is named.
_NEW = Path("my_arm.toml")
#: Sizes of the units in which lengths and volumes are printed, in SI units.
_MILLIMETRE = 1e-3
_LITRE = 1e-3

HELP = """
check gives the cost of each change alone: the largest change of the torque
that holds a joint in sea water, and the largest distance that the tcp moves,
within the file's limits.

Example: alpha5 arm new my_arm.toml
Example: alpha5 arm check my_arm.toml
"""


def options(parser: Parser) -> None:
    parser.add_commands(
        {
            "new": ("write the catalogue's arm with every key and comments", _of_new),
            "check": ("say what a file changes against the catalogue", _of_file),
            "show": ("print the arm of a file", _of_file),
        },
    )


def _of_new(parser: Parser) -> None:
    parser.add_argument(
        "file",
        nargs="?",
        type=Path,
        default=_NEW,
        metavar="FILE",
        help="the file to write, - for standard output. Default: %(default)s",
    )
    common.as_json(parser, "print the path of the file as JSON")


def _of_file(parser: Parser) -> None:
    parser.add_argument("file", type=Path, metavar="FILE", help="the arm file")
    common.as_json(parser)


def run(given: Namespace) -> None:
    if given.command == "new":
        _new(given.file, given.json)
        return
    own = arm_file(given.file)
    if given.command == "show":
        printing.show(given.json, own, _arm_text(own))
        return

    # Pinocchio is loaded here only.
    from alpha5_model.dynamics.arm_changes import arm_changes

    with printing.spinner("searching"):
        changes = arm_changes(own, parameters())
    record = {"name": own.name, "changes": changes}
    printing.show(given.json, record, _changes_text(own, changes))


def _new(path: Path, as_json: bool) -> None:
    """Write a file with every key."""
    if str(path) != STDOUT and path.exists():
        raise OutputError(path, "it exists; name another file")
    atomic_write(path, arm_file_text(parameters(), every_key=True))
    printing.show(as_json, {"written": str(path)}, (), path)


# --- check ----------------------------------------------------------------------------


def _changes_text(own: Alpha5Parameters, changes: Any) -> printing.Lines:
    if not changes:
        yield f"{own.name} is the catalogue's arm"
        return
    yield f"{own.name} against the catalogue's arm; largest changes within its limits"
    rows = [["changed", "torque (N m)", "tcp (mm)"]]
    for change in changes:
        cells = [_digits(change.torque), _digits(change.tcp / _MILLIMETRE)]
        rows.append([change.key, *cells])
    yield from table(rows, "<>>")

    yield "\nfrom the catalogue's value to yours (SI units)"
    for change in changes:
        for difference in change.differences:
            before = _written(difference.printed)
            after = _written(difference.own)
            name = f"{change.key}: {difference.name.replace('_', ' ')}"
            yield f"  {name} {before} -> {after}"


def _digits(cost: float) -> str:
    """A cost with three digits, 0 for none."""
    return f"{cost:.3g}" if cost else "0"


def _written(value: Any) -> str:
    """A value of a record on one line."""
    if value is None:
        return "none"
    if isinstance(value, np.ndarray | tuple):
        return f"({', '.join(map(_written, value))})"
    # Adding zero turns a negative zero into zero.
    return f"{value + 0.0:.6g}" if isinstance(value, float) else str(value)


# --- show -----------------------------------------------------------------------------


def _arm_text(own: Alpha5Parameters) -> printing.Lines:
    corrections = ", ".join(own.corrections) or "none"
    yield f"{own.name}, corrections: {corrections}"
    yield from _frames(own)
    yield from _joints(own)
    yield from _bodies(own)
    yield from _motors(own)
    yield from _measurements(own)


def _frames(own: Alpha5Parameters) -> printing.Lines:
    """Mount, lengths, zeros and tool."""
    if own.mount is not None:
        at = _written(own.mount.position)
        yield f"mount on {own.mount.parent} at {at} m"
    rows = [
        [name, f"{getattr(own.dh[i], field) / _MILLIMETRE:.6g}"]
        for name, (i, field) in LENGTHS.items()
    ]
    yield "\nlengths (mm)"
    yield from table(rows, "<>", 2)

    tool = tool_of(own)
    spacer = f"{own.spacer / _MILLIMETRE:g} mm"
    moved = f", moved by a spacer of {spacer}" if own.spacer else ""
    yield f"tcp at {_written(tool.position)} m in link_4{moved}"


def _joints(own: Alpha5Parameters) -> printing.Lines:
    rows = [["joint", "lower", "upper", "velocity", "effort", "theta offset"]]
    for i, joint in enumerate(own.joints):
        limits = (joint.lower, joint.upper, joint.velocity, joint.effort)
        offset = f"{own.dh[i].theta_offset:.6g}" if i < 4 else ""
        rows.append([joint.name, *(f"{x:.5g}" for x in limits), offset])
    yield "\njoints (rad, rad/s, N m; axis_a m, m/s, N)"
    yield from table(rows, "<>", 2)

    if any(joint.acceleration or joint.jerk or joint.sign < 0 for joint in own.joints):
        rows = [["joint", "acceleration", "jerk", "driver's sign"]]
        for joint in own.joints:
            largest = (joint.acceleration, joint.jerk)
            cells = ["unknown" if x is None else f"{x:.5g}" for x in largest]
            rows.append([joint.name, *cells, f"{joint.sign}"])
        yield "\n(rad/s^2, rad/s^3; axis_a m/s^2, m/s^3)"
        yield from table(rows, "<>", 2)


def _bodies(own: Alpha5Parameters) -> printing.Lines:
    rows = [["body", "mass (kg)", "volume (L)", "com (mm)", "cob (mm)"]]
    for body in (*own.links, *own.attached):
        com = _written(body.com / _MILLIMETRE)
        cob = _written(body.cob / _MILLIMETRE)
        cells = [f"{body.mass:.6g}", f"{body.volume / _LITRE:.6g}", com, cob]
        rows.append([body.name, *cells])
    yield "\nbodies, each in its own frame"
    yield from table(rows, "<>><<", 2)
    for attached in own.attached:
        at = _written(attached.position)
        yield f"{attached.name} is fixed to {attached.link} at {at} m"


def _motors(own: Alpha5Parameters) -> printing.Lines:
    motors = own.motors
    rows = [["joint", "limit", "rotor", "K_t", "K_v", "ratio", "efficiency"]]
    for i, (name, actuator) in enumerate(zip(JOINT_NAMES, own.actuators, strict=True)):
        unknown = (motors.current_limits[i], motors.rotor_inertias[i])
        cells = ["unknown" if x is None else f"{x:.4g}" for x in unknown]
        cells += [
            f"{actuator.torque_constant:.4g}",
            f"{actuator.voltage_constant:.4g}",
            f"{actuator.gear_ratio:.6g}",
            f"{actuator.efficiency:.4g}",
        ]
        rows.append([name, *cells])
    supply = motors.supply_voltage
    volts = "unknown" if supply is None else f"{supply:g} V"
    yield f"\nmotors: supply {volts}, constants {motors.constants}; limit (A),"
    yield "rotor inertia (kg m^2), K_t (N m/A), K_v (V s/rad)"
    yield from table(rows, "<>", 2)


def _measurements(own: Alpha5Parameters) -> printing.Lines:
    if not own.measurements:
        return
    yield "\nmeasured (half width in SI units)"
    rows = []
    for each in own.measurements:
        width = "" if each.half_width is None else f"±{each.half_width:.3g}"
        rows.append([each.key, width, each.source])
    yield from table(rows, "<><", 2, printing.width())
