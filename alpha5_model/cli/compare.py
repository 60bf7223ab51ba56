"""``alpha5 compare``: how far another model of this arm is off, and why."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any

from rich import box
from rich.table import Column, Table
from rich.text import Text
from typer import Argument, Option

from alpha5_model.cli.options import Lines, show, spinner
from alpha5_model.comparison import compare as run
from alpha5_model.comparison.records import Comparison
from alpha5_model.errors import InputError
from alpha5_model.files import check_outputs
from alpha5_model.view.figures import FORMATS, plot_comparison


def compare(
    other: Annotated[Path, Argument(help="A URDF or xacro file of the Reach Alpha 5.")],
    joints: Annotated[
        str, Option("--map", help="Our joints and theirs: axis_e=joint1,axis_d=joint2,...")
    ] = "",
    base: Annotated[
        str | None, Option(help="First link of the arm, if a vehicle carries it.")
    ] = None,
    package: Annotated[
        list[str] | None, Option(help="Folder of a package of a xacro file: NAME=FOLDER.")
    ] = None,
    arg: Annotated[list[str] | None, Option(help="Argument of a xacro file: NAME:=VALUE.")] = None,
    samples: Annotated[int, Option(help="Random configurations.", min=1, max=100_000)] = 500,
    as_json: Annotated[bool, Option("--json", help="Everything as JSON.")] = False,
    plot: Annotated[Path | None, Option(help="Picture of the errors: .png, .pdf or .svg.")] = None,
) -> int:
    """Compare another URDF of this arm with the tables.

    Exit status: 0 the model agrees, 1 it differs or is another arm, 2 it cannot be read.

    Example: alpha5 compare other.urdf --map axis_e=joint1,axis_d=joint2,axis_c=joint3,axis_b=joint4
    """
    check_outputs([other], plot=(plot, FORMATS))
    with spinner("comparing"):
        comparison = run(
            other,
            _pairs("map", joints.split(","), "="),
            samples,
            base,
            _pairs("package", package or [], "="),
            _pairs("arg", arg or [], ":="),
        )
    if not comparison.joints:
        plot = None  # another arm has no errors to draw
    if plot is not None:
        plot_comparison(comparison, plot)
    show(as_json, comparison.as_dict(), _text(comparison), plot)
    return 0 if comparison.agrees else 1


def _pairs(option: str, parts: list[str], sign: str) -> dict[str, str]:
    pairs: dict[str, str] = {}
    for part in filter(None, (p.strip() for p in parts)):
        name, equals, value = part.partition(sign)
        if not name or not equals or (not value and option != "arg") or name.strip() in pairs:
            expected = "axis_e=NAME,axis_d=NAME,..." if option == "map" else f"NAME{sign}VALUE"
            raise InputError(option, ",".join(parts), f"{expected} with each name once")
        pairs[name.strip()] = value.strip()
    return pairs


def _text(comparison: Comparison) -> Lines:
    joints = ", ".join(f"{ours} = {theirs}" for ours, theirs in comparison.joints.items())
    yield Text(f"{comparison.name}: {joints or comparison.verdict}")
    if not joints:
        return
    # Text, not markup: rich would take the units' brackets for a style.
    heads = ["mass\n[g]", *(f"COM {axis}\n[mm]" for axis in "xyz")]
    heads += (f"moment {n}\n[kg mm²]" for n in "123")
    figures = (Column(Text(head), justify="right", no_wrap=True) for head in heads)
    names = (Column(name, no_wrap=True) for name in ("body", ""))
    table = Table(*names, *figures, box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False)
    for body in comparison.bodies:
        both = body.as_dict()
        theirs, ours = _row(both), _row(both["ours"])
        table.add_row(body.name, "theirs", *map(_cell, theirs))
        table.add_row("", "ours", *map(_cell, ours))
        table.add_row("", "diff", *(_cell(a - b, "+") for a, b in zip(theirs, ours, strict=True)))
        table.add_section()
    yield table
    yield Text(
        f"Largest differences: tip {comparison.tip_error * 1e3:.3f} mm, gravity torque in air "
        f"{comparison.gravity_error.max():.4g} N m, mass matrix {comparison.mass_matrix_error:.3g} "
        "kg m²."
    )
    listed = Table.grid(padding=(0, 1))
    for finding in comparison.findings:
        mark = Text("✗", "red") if finding.serious else Text("·", "yellow")
        costs = f" [{finding.cost:.3g} N m]" if finding.cost > 0 else ""
        listed.add_row(mark, Text.assemble((finding.where, "bold"), f": {finding.text}{costs}"))
        if finding.instead:
            listed.add_row("", Text(f"write {finding.instead}", "dim"))
    yield listed
    yield Text(comparison.verdict, "green" if comparison.agrees else "red")


def _row(side: dict[str, Any]) -> list[float]:
    """Mass [g], COM [mm] and principal moments [kg mm^2] of one side."""
    com = side["com_m"] or [math.nan] * 3
    moments = side["principal_moments_kgm2"]
    return [side["mass_kg"] * 1e3, *(x * 1e3 for x in com), *(x * 1e6 for x in moments)]


def _cell(x: float, sign: str = "") -> str:
    if math.isnan(x):
        return "-"
    digits = 2 if abs(x) < 1e4 else 0
    return f"{round(x, digits) + 0.0:{sign}.{digits}f}"  # adding zero turns -0.0 into 0.0
