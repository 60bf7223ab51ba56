"""``alpha5 compare``: how far another model of this arm is off, and why."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from alpha5_model.cli.options import spinner, words_beside

if TYPE_CHECKING:
    from alpha5_model.comparison.records import Comparison


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("compare")(compare)


def compare(
    other: Annotated[Path, typer.Argument(help="A URDF of the Reach Alpha 5.")],
    joints: Annotated[
        str, typer.Option("--map", help="Our joints and theirs: axis_e=joint1,axis_d=joint2,...")
    ] = "",
    samples: Annotated[int, typer.Option(help="Random configurations.", min=1, max=100_000)] = 500,
    as_json: Annotated[bool, typer.Option("--json", help="Everything as JSON.")] = False,
    plot: Annotated[
        Path | None, typer.Option(help="Picture of the errors: .png, .pdf or .svg.")
    ] = None,
) -> int:
    """Hold another URDF of this arm against the tables.

    Exit status: 0 the model agrees, 1 it differs, 2 it cannot be read.

    Example: alpha5 compare other.urdf --map axis_e=joint1,axis_d=joint2,axis_c=joint3,axis_b=joint4
    """
    from alpha5_model.comparison.report import compare as run
    from alpha5_model.files import check_outputs
    from alpha5_model.view.figures import FORMATS

    check_outputs([other], plot=(plot, FORMATS))
    if plot is not None:
        from alpha5_model.view.comparison_plot import plot_comparison
    with spinner("comparing"):
        comparison = run(other, _pairs(joints), samples)
    if plot is not None:
        plot_comparison(comparison, plot)
    with words_beside(plot):
        if as_json:
            typer.echo(json.dumps(comparison.as_dict(), indent=2))
        else:
            _print(comparison)
            if plot is not None:
                typer.echo(f"wrote {plot}")
    return 0 if comparison.agrees else 1


def _pairs(text: str) -> dict[str, str]:
    from alpha5_model.errors import InputError

    pairs: dict[str, str] = {}
    for part in filter(None, (p.strip() for p in text.split(","))):
        ours, equals, theirs = part.partition("=")
        if not equals or not theirs or ours in pairs:
            raise InputError("map", text, "axis_e=NAME,axis_d=NAME,... with each axis once")
        pairs[ours.strip()] = theirs.strip()
    return pairs


def _print(comparison: Comparison) -> None:
    from rich import box
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    console = Console()
    joints = ", ".join(f"{ours} = {theirs}" for ours, theirs in comparison.joints.items())
    console.print(f"[bold]{escape(comparison.name)}[/bold]  {escape(joints)}", highlight=False)
    table = Table(box=box.SIMPLE_HEAD)
    for name in ("body", "mass [kg]", "difference [g]", "COM [mm]", "inertia [kg mm²]"):
        table.add_column(name, justify="left" if name == "body" else "right")
    for body in comparison.bodies:
        table.add_row(
            body.name,
            f"{body.mass:.4f}",
            f"{body.mass_error * 1e3:+.2f}",
            f"{body.com_error * 1e3:.3f}",
            f"{body.inertia_error * 1e6:.3f}",
        )
    console.print(table)
    worst = comparison.gravity_error.max()
    console.print(
        f"Largest differences: tip {comparison.tip_error * 1e3:.3f} mm, gravity torque "
        f"{worst:.4g} N m, mass matrix {comparison.mass_matrix_error:.3g} kg m².",
        highlight=False,
    )
    for finding in comparison.findings:
        mark = "[red]✗[/red]" if finding.serious else "[yellow]·[/yellow]"
        console.print(f" {mark} [bold]{escape(finding.where)}[/bold]: {escape(finding.text)}")
    if comparison.agrees:
        console.print("[green]The model agrees with the tables.[/green]")
    else:
        serious = sum(finding.serious for finding in comparison.findings)
        plural = "" if serious == 1 else "s"
        console.print(f"[red]The model differs: {serious} finding{plural}.[/red]")
