"""``alpha5 compare``: how far another model of this arm is off, and why."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any

import typer
from rich import box
from rich.console import Console
from rich.table import Column, Table
from rich.text import Text

from alpha5_model.cli.options import print_json, print_written, spinner, words_beside
from alpha5_model.comparison.records import Comparison
from alpha5_model.comparison.report import compare as run
from alpha5_model.errors import InputError
from alpha5_model.files import check_outputs
from alpha5_model.view.figures import FORMATS, plot_comparison


def compare(
    other: Annotated[Path, typer.Argument(help="A URDF or xacro file of the Reach Alpha 5.")],
    joints: Annotated[
        str, typer.Option("--map", help="Our joints and theirs: axis_e=joint1,axis_d=joint2,...")
    ] = "",
    base: Annotated[
        str | None, typer.Option(help="First link of the arm, if a vehicle carries it.")
    ] = None,
    package: Annotated[
        list[str] | None, typer.Option(help="Folder of a package of a xacro file: NAME=FOLDER.")
    ] = None,
    arg: Annotated[
        list[str] | None, typer.Option(help="Argument of a xacro file: NAME:=VALUE.")
    ] = None,
    samples: Annotated[int, typer.Option(help="Random configurations.", min=1, max=100_000)] = 500,
    as_json: Annotated[bool, typer.Option("--json", help="Everything as JSON.")] = False,
    plot: Annotated[
        Path | None, typer.Option(help="Picture of the errors: .png, .pdf or .svg.")
    ] = None,
) -> int:
    """Hold another URDF of this arm against the tables.

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
    with words_beside(plot):
        if as_json:
            print_json(comparison.as_dict())
        else:
            _print(comparison)
            print_written(plot)
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


def _print(comparison: Comparison) -> None:
    console = Console(highlight=False)
    if not comparison.joints:
        console.print(Text(f"{comparison.name}: {comparison.verdict}"))
        return
    joints = ", ".join(f"{ours} = {theirs}" for ours, theirs in comparison.joints.items())
    console.print(Text(f"{comparison.name}: {joints}"))
    # Text, not markup: rich would take the units' brackets for a style.
    heads = ["mass\n[g]", *(f"COM {axis}\n[mm]" for axis in "xyz")]
    heads += (f"moment {n}\n[kg mm²]" for n in "123")
    figures = (Column(Text(head), justify="right", no_wrap=True) for head in heads)
    names = (Column(name, no_wrap=True) for name in ("body", ""))
    table = Table(*names, *figures, box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False)
    for body in comparison.bodies:
        both = body.as_dict()
        sides = [_row(both), _row(both["ours"])]
        sides.append([a - b for a, b in zip(*sides, strict=True)])
        for label, side in zip(("theirs", "ours", "diff"), sides, strict=True):
            sign = "+" if label == "diff" else ""
            cells = (
                "-" if math.isnan(x) else f"{x:{sign}.{2 if abs(x) < 1e4 else 0}f}" for x in side
            )
            table.add_row(body.name if label == "theirs" else "", label, *cells)
        table.add_section()
    console.print(table)
    console.print(
        f"Largest differences: tip {comparison.tip_error * 1e3:.3f} mm, gravity torque in air "
        f"{comparison.gravity_error.max():.4g} N m, mass matrix {comparison.mass_matrix_error:.3g} "
        "kg m²."
    )
    listed = Table.grid(padding=(0, 1))
    for finding in comparison.findings:
        mark = Text("✗", "red") if finding.serious else Text("·", "yellow")
        costs = f" [{finding.cost:.3g} N m]" if finding.cost > 0 else ""
        text = Text.assemble((finding.where, "bold"), f": {finding.text}{costs}")
        listed.add_row(mark, text)
        if finding.instead:
            listed.add_row("", Text(f"write {finding.instead}", "dim"))
    console.print(listed)
    console.print(Text(comparison.verdict, "green" if comparison.agrees else "red"))


def _row(side: dict[str, Any]) -> list[float]:
    """Mass [g], COM [mm] and principal moments [kg mm^2] of one side."""
    com = side["com_m"] or [math.nan] * 3
    moments = side["principal_moments_kgm2"]
    return [side["mass_kg"] * 1e3, *(x * 1e3 for x in com), *(x * 1e6 for x in moments)]
