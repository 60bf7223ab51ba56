"""``alpha5 compare``: another URDF of this arm against the tables."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from typer import Argument, Option, echo, style

from alpha5_model._support.checks import choice
from alpha5_model._support.outputs import check_outputs
from alpha5_model._support.text import table
from alpha5_model._support.writing import atomic_write
from alpha5_model.cli import options, printing, values
from alpha5_model.cli.units import GRAM, MILLIMETRE
from alpha5_model.cli.words import WORDS
from alpha5_model.errors import InputError, OutputError
from alpha5_model.proofs.comparison import compare_robots
from alpha5_model.proofs.comparison.model import read_model
from alpha5_model.proofs.comparison.result import Comparison, explanation
from alpha5_model.viewer.comparison_plot import plot_comparison
from alpha5_model.viewer.figures import FORMATS

if TYPE_CHECKING:
    from alpha5_model.proofs.comparison.as_arm import ArmOfModel

#: Forms of the answer; the first one is for people.
_FORMS = ("text", "json", "junit")

#: The help of an option.
_SAMPLES = "Random joint positions at which both models are compared."
_Other = Annotated[
    Path | None, Argument(help="A URDF or xacro file of the Reach Alpha 5.")
]


def compare(
    other: _Other = None,
    joints: Annotated[
        str, Option("--map", help="Joints: axis_e=NAME,axis_d=NAME and so on.")
    ] = "",
    base: Annotated[
        str | None, Option(help="First link of an arm on a vehicle.")
    ] = None,
    xacro: Annotated[bool, Option("--xacro", help="Run the xacro file.")] = False,
    package: Annotated[
        list[str] | None, Option(help="With --xacro: NAME=FOLDER.")
    ] = None,
    arg: Annotated[list[str] | None, Option(help="With --xacro: NAME:=VALUE.")] = None,
    samples: Annotated[int, Option(help=_SAMPLES, min=1, max=100_000)] = 500,
    arm_file: options.Arm = None,
    write_arm: Annotated[
        Path | None, Option(help="Write the model as an arm file, .toml.")
    ] = None,
    form: Annotated[
        str, Option("--format", help="text, json, or junit (a report for CI).")
    ] = "text",
    as_json: options.Json = False,
    plot: options.Plot = None,
    explain: Annotated[
        str | None, Option(help="Say what a finding means, by its id.")
    ] = None,
) -> int:
    """Compare another URDF of this arm with the printed tables, or with your own arm.

    A URDF is only read. A xacro file is a program: --xacro runs it, with your
    rights, so use it only on files that you trust. --write-arm writes the model
    as an arm file, and lists what such a file cannot say. Findings end with their
    id in round brackets; --explain ID says what it means.

    Exit status: 0 joints and bodies agree, 1 something differs or it is another
    arm, 2 it cannot be read. A tool frame at another point of the gripper is no
    difference; the verdict says how far it is off.

    Example: alpha5 compare other.urdf --map axis_e=joint1,axis_d=joint2,axis_c=joint3,axis_b=joint4
    """  # noqa: E501 (a line of the help)
    if explain is not None:
        printing.say(explanation(explain))
        return 0
    if other is None:
        raise InputError("OTHER", None, "a URDF or xacro file, or --explain ID")
    _check_form(form, as_json)
    outputs = {"write-arm": (write_arm, (".toml",)), "plot": (plot, FORMATS)}
    check_outputs([other], **outputs)
    if write_arm is not None and write_arm.exists():
        raise OutputError(write_arm, "it exists; name another file")
    names = values.pairs("map", joints.split(","), "=")
    packages = values.pairs("package", package or [], "=")
    arguments = values.pairs("arg", arg or [], ":=")
    own = values.arm_record(arm_file)
    with printing.spinner("comparing"):
        # Read once: a xacro file is a program.
        model = read_model(other, packages, arguments, xacro)
        comparison = compare_robots(model, names, samples, other.parent, base, arm=own)
        described = None
        if write_arm is not None:
            from alpha5_model.proofs.comparison.as_arm import arm_of_robot, arm_text

            described = arm_of_robot(model, names, base)
            atomic_write(write_arm, arm_text(described, other.name))

    # A model of another arm has no errors to draw.
    picture = plot if comparison.joints else None
    if picture is not None:
        plot_comparison(comparison, picture)
    if form == "junit":
        from alpha5_model.proofs.comparison.junit import junit_report

        echo(junit_report(comparison, other.stem), nl=False)
    else:
        written = None if described is None else write_arm
        as_record = as_json or form == "json"
        _show(as_record, comparison, described, picture, written)
    return 0 if comparison.agrees else 1


def _check_form(form: str, as_json: bool) -> None:
    """Refuse a form that is unknown, or none that --json goes with."""
    choice("format", form, _FORMS)
    if as_json and form == "junit":
        raise InputError("format", form, "json or text with --json")


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

    yield style(comparison.verdict, fg="green" if comparison.agrees else "red")
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
        side["mass_kg"] / GRAM,
        *(coordinate / MILLIMETRE for coordinate in com),
        *(moment / MILLIMETRE**2 for moment in moments),
    ]


def _cell(x: float, sign: str = "") -> str:
    if math.isnan(x):
        return "-"
    decimals = 2 if abs(x) < 1e4 else 0
    return f"{x:{sign}z.{decimals}f}"


def _largest(comparison: Comparison) -> str:
    """The largest differences, and where the tool was measured."""
    words = WORDS["compare"]
    tool = comparison.tool
    if tool is None:
        return ""
    return str(words["largest"]).format(
        frame=f"frame {tool.frame}" if tool.frame else words["no_tool"],
        base=tool.base or words["no_base"],
        tip=tool.distance.max() / MILLIMETRE,
        median=np.median(tool.distance) / MILLIMETRE,
        turned=np.degrees(tool.angle.max()),
        matched=tool.matched_distance.max() / MILLIMETRE,
        matched_turned=np.degrees(tool.matched_angle.max()),
        gravity=comparison.gravity_error.max(),
        mass_matrix=comparison.mass_matrix_error,
    )


def _findings(comparison: Comparison) -> printing.Lines:
    for found in comparison.findings:
        mark = "✗" if found.serious else "·"
        cost = f" [{found.cost:.3g} N m]" if found.cost > 0 else ""
        yield f"{mark} {found.where}: {found.text}{cost} ({found.id})"
        if found.instead:
            yield f"  write {found.instead}"
