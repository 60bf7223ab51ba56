"""``alpha5 compare``: another URDF of this arm against the tables."""

from __future__ import annotations

import math
from argparse import Namespace
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from alpha5_model._support.outputs import check_outputs
from alpha5_model._support.text import table
from alpha5_model._support.writing import atomic_write
from alpha5_model.cli import options as common
from alpha5_model.cli import printing
from alpha5_model.cli.parsing import Parser
from alpha5_model.errors import InputError, OutputError
from alpha5_model.proofs.comparison import compare_robots
from alpha5_model.proofs.comparison.model import read_model
from alpha5_model.proofs.comparison.result import Comparison, explanation

if TYPE_CHECKING:
    from alpha5_model.proofs.comparison.as_arm import ArmOfModel

_MOST_SAMPLES = 100_000
#: Sizes of the units in which bodies are printed, in SI units.
_MILLIMETRE = 1e-3
_GRAM = 1e-3

HELP = """
A URDF is only read. A xacro file is a program: --xacro runs it, with your
rights, so use it only on files that you trust. --write-arm writes the model
as an arm file, and lists what such a file cannot say. Findings end with their
id in round brackets; --explain ID says what it means.

Exit status: 0 joints and bodies agree, 1 something differs or it is another
arm, 2 it cannot be read. A tool frame at another point of the gripper is no
difference; the verdict says how far it is off.

Example:
alpha5 compare other.urdf --map axis_e=j1,axis_d=j2,axis_c=j3,axis_b=j4
"""


def options(parser: Parser) -> None:
    parser.add_argument(
        "other",
        nargs="?",
        type=Path,
        metavar="FILE",
        help="a URDF or xacro file of the Reach Alpha 5",
    )
    parser.add_argument(
        "--map",
        default="",
        metavar="MAP",
        help="joints: axis_e=NAME,axis_d=NAME and so on",
    )
    parser.add_argument("--base", help="first link of an arm on a vehicle")
    parser.add_argument("--xacro", action="store_true", help="run the xacro file")
    parser.add_argument(
        "--package", action="append", help="with --xacro: NAME=FOLDER", default=[]
    )
    parser.add_argument(
        "--arg", action="append", help="with --xacro: NAME:=VALUE", default=[]
    )
    parser.add_argument(
        "--samples",
        type=int,
        default=500,
        help="random joint positions at which both models are compared, 1 to 100000. "
        "Default: %(default)s",
    )
    common.arm_file(parser)
    parser.add_argument(
        "--write-arm",
        type=Path,
        metavar="FILE",
        help="write the model as an arm file, .toml",
    )
    parser.add_argument(
        "--format",
        choices=("text", "json", "junit"),
        default="text",
        help="junit is a report for CI. Default: text",
    )
    common.as_json(parser)
    common.plot(parser)
    parser.add_argument(
        "--explain", metavar="ID", help="say what a finding means, by its id"
    )


def run(given: Namespace) -> int:
    if given.explain is not None:
        printing.say(explanation(given.explain))
        return 0
    other, write_arm = given.other, given.write_arm
    if other is None:
        raise InputError("FILE", "nothing", "a URDF or xacro file, or --explain ID")
    if given.json and given.format == "junit":
        raise InputError("--json", True, "--json or --format junit, not both")
    if not 1 <= given.samples <= _MOST_SAMPLES:
        raise InputError("--samples", given.samples, f"1 to {_MOST_SAMPLES}")
    _check_outputs(other, write_arm, given.plot)
    names = common.joint_names(given.map)
    packages = common.pairs("package", given.package, "=")
    arguments = common.pairs("arg", given.arg, ":=", may_be_empty=True)
    own = common.record_of(given)
    with printing.spinner("comparing"):
        # Read once: a xacro file is a program.
        model = read_model(other, packages, arguments, given.xacro)
        comparison = compare_robots(
            model, names, given.samples, other.parent, given.base, arm=own
        )
        described = None
        if write_arm is not None:
            from alpha5_model.proofs.comparison.as_arm import arm_of_robot, arm_text

            described = arm_of_robot(model, names, given.base)
            atomic_write(write_arm, arm_text(described, other.name))

    # A model of another arm has no errors to draw.
    picture = given.plot if comparison.joints else None
    if picture is not None:
        from alpha5_model.viewer.comparison_plot import plot_comparison

        plot_comparison(comparison, picture)
    if given.format == "junit":
        from alpha5_model.proofs.comparison.junit import junit_report

        with printing.apart_from(picture, write_arm):
            print(junit_report(comparison, other.stem), end="")
    else:
        written = None if described is None else write_arm
        as_record = given.json or given.format == "json"
        _show(as_record, comparison, described, picture, written)
    return 0 if comparison.agrees else 1


def _check_outputs(other: Path, write_arm: Path | None, plot: Path | None) -> None:
    """Refuse outputs that must not be written."""
    outputs: dict[str, tuple[Path | None, Sequence[str]]] = {
        "write-arm": (write_arm, (".toml",))
    }
    if plot is not None:
        from alpha5_model.viewer.figures import FORMATS

        outputs["plot"] = (plot, FORMATS)
    check_outputs([other], **outputs)
    if write_arm is not None and write_arm.exists():
        raise OutputError(write_arm, "it exists; name another file")


def _show(
    as_record: bool,
    comparison: Comparison,
    described: ArmOfModel | None,
    *written: Path | None,
) -> None:
    """Print the differences, for scripts or for people, and name the files."""
    record = comparison.as_dict()
    if described is not None:
        record["arm_file"] = {"left_out": [*described.left_out]}
    printing.show(as_record, record, _text(comparison, described), *written)


def _text(comparison: Comparison, described: ArmOfModel | None) -> printing.Lines:
    """The differences, and what the written arm file cannot say."""
    yield from differences(comparison)
    if described is not None and described.left_out:
        yield "\nnot in the arm file:"
        yield from (f"· {text}" for text in described.left_out)


def differences(comparison: Comparison) -> printing.Lines:
    """The lines of a comparison, for people."""
    joints = ", ".join(f"{own} = {name}" for own, name in comparison.joints.items())
    yield f"{comparison.name}: {joints or comparison.verdict}"
    if not joints:
        return

    colour = "green" if comparison.agrees else "red"
    yield printing.styled(comparison.verdict, colour)
    yield from _findings(comparison)
    yield _largest(comparison)
    yield from _bodies(comparison)


def _bodies(comparison: Comparison) -> printing.Lines:
    """Mass, COM and principal moments of the bodies that differ, theirs and ours."""
    rows = {body.name: _rows(body.as_dict()) for body in comparison.bodies}
    differing = {name: cells for name, cells in rows.items() if _differs(cells[2])}
    alike = [name for name in rows if name not in differing]
    if alike:
        yield f"Bodies equal to ours to 0.01 g, mm and kg mm²: {', '.join(alike)}."
    if not differing:
        return

    moments = [f"moment {number}" for number in "123"]
    head = [
        ["body", "", "mass", "COM x", "COM y", "COM z", *moments],
        ["", "", "[g]", *["[mm]"] * 3, *["[kg mm²]"] * 3],
    ]
    for name, (theirs, ours, apart) in differing.items():
        head.append([name, "theirs", *theirs])
        head.append(["", "ours", *ours])
        head.append(["", "diff", *apart])
    yield ""
    yield from table(head, "<<>", 1)


def _rows(record: dict[str, Any]) -> tuple[list[str], list[str], list[str]]:
    """The cells of a body: theirs, ours and the difference."""
    theirs = _inertia(record)
    ours = _inertia(record["ours"])
    apart = [a - b for a, b in zip(theirs, ours, strict=True)]
    return (
        [_cell(x) for x in theirs],
        [_cell(x) for x in ours],
        [_cell(x, "+") for x in apart],
    )


def _differs(apart: Sequence[str]) -> bool:
    """Whether a difference is seen in the cells, or a centre of mass is missing."""
    return any(cell == "-" or cell.strip("+-0.") for cell in apart)


def _inertia(side: dict[str, Any]) -> list[float]:
    """Mass [g], COM [mm] and principal moments [kg mm^2] of one side."""
    com = side["com_m"] or [math.nan] * 3
    moments = side["principal_moments_kgm2"]
    return [
        side["mass_kg"] / _GRAM,
        *(coordinate / _MILLIMETRE for coordinate in com),
        *(moment / _MILLIMETRE**2 for moment in moments),
    ]


def _cell(x: float, sign: str = "") -> str:
    if math.isnan(x):
        return "-"
    decimals = 2 if abs(x) < 1e4 else 0
    return f"{x:{sign}z.{decimals}f}"


def _largest(comparison: Comparison) -> str:
    """The largest differences, and where the tool was measured."""
    tool = comparison.tool
    if tool is None:
        return ""
    frame = "no frame of one: where Table 1's {5} would be"
    if tool.frame:
        frame = f"frame {tool.frame}"
    base = tool.base or "the base that the axes show"
    tip = tool.distance.max() / _MILLIMETRE
    median = np.median(tool.distance) / _MILLIMETRE
    turned = np.degrees(tool.angle.max())
    matched = tool.matched_distance.max() / _MILLIMETRE
    matched_turned = np.degrees(tool.matched_angle.max())
    gravity = comparison.gravity_error.max()
    return (
        f"\nTool ({frame}, in {base}) at the same joint positions: up to {tip:.3f} mm "
        f"(median {median:.3f} mm) and {turned:.2f} deg off; with signs and zeros "
        f"matched {matched:.3f} mm and {matched_turned:.2f} deg.\n"
        f"Largest differences: gravity torque in air {gravity:.4g} N m, mass matrix "
        f"{comparison.mass_matrix_error:.3g} kg m²."
    )


def _findings(comparison: Comparison) -> printing.Lines:
    for found in comparison.findings:
        mark = "✗" if found.serious else "·"
        cost = f" [{found.cost:.3g} N m]" if found.cost > 0 else ""
        yield f"{mark} {found.where}: {found.text}{cost} ({found.id})"
        if found.instead:
            yield f"  write {found.instead}"
