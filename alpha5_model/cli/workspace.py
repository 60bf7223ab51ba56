"""``alpha5 workspace``: what the tcp can reach, beside what the document says."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from alpha5_model.cli.options import words_beside


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("workspace")(workspace)


def workspace(
    plot: Annotated[Path | None, typer.Option(help="Write a picture: .png, .pdf or .svg.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Everything as JSON.")] = False,
) -> int:
    """The exact workspace, and how much of the published one is wrong.

    Example: alpha5 workspace --plot workspace.pdf
    """
    from alpha5_model.files import check_outputs
    from alpha5_model.view.figures import FORMATS

    check_outputs((), plot=(plot, FORMATS))
    if plot is not None:
        from alpha5_model.view.workspace_plot import write

        write(plot)
    with words_beside(plot):
        if as_json:
            typer.echo(json.dumps(_as_dict(), indent=2))
        else:
            _print()
            if plot is not None:
                typer.echo(f"wrote {plot}")
    return 0


def _as_dict() -> dict[str, object]:
    from alpha5_model.kinematics import workspace as space

    return {
        "errors_of_the_published_region": asdict(space.published_errors()),
        "cross_section_area": {side: space.cross_section_area(side) for side in space.SIDES},
        "volume": space.volume(),
        "volume_without_limits": space.volume(limits=False),
        "boundary": {side: [arc._asdict() for arc in space.boundary(side)] for side in space.SIDES},
        "published_tori": [torus._asdict() for torus in space.published_tori()],
        "singular_theta_2": space.singular_elbow_angles(),
    }


def _print() -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table

    from alpha5_model.kinematics import workspace as space

    e = space.published_errors()
    console = Console()
    table = Table(box=box.SIMPLE_HEAD)
    table.add_column("region")
    table.add_column("half-plane (cm²)", justify="right")
    table.add_column("volume (L)", justify="right")
    for name, area, volume in (
        ("reachable within the joint limits", e.reachable_area, e.reachable_volume),
        ("published (Section 1.2)", e.published_area, e.published_volume),
        ("published, not reachable", e.unreachable_area, e.unreachable_volume),
        ("reachable, not published", e.missed_area, e.missed_volume),
    ):
        table.add_row(name, f"{area * 1e4:.2f}", f"{volume * 1e3:.3f}")
    console.print(table)
    console.print(
        f"{e.unreachable_area / e.published_area:.1%} of the published area and "
        f"{e.unreachable_volume / e.published_volume:.1%} of its volume cannot be reached.",
        highlight=False,
    )
    arcs = Table(
        box=box.SIMPLE_HEAD,
        title="boundary where both poses can turn (R, z and radius in mm)",
        title_justify="left",
        show_edge=False,
        pad_edge=False,
        padding=0,  # 80 columns hold every row
    )
    for column in ("pose", "bounded by", "centre", "radius", "from", "to"):
        arcs.add_column(column, no_wrap=True)
    for arc in space.boundary():
        start, end = arc.points([arc.start, arc.end]) * 1e3
        arcs.add_row(
            arc.side,
            arc.cause.replace("at its ", ""),
            _point(arc.center[0] * 1e3, arc.center[1] * 1e3),
            f"{arc.radius * 1e3:.1f}",
            _point(*start),
            _point(*end),
        )
    console.print(arcs)


def _point(radius: float, z: float) -> str:
    # Adding zero turns the -0.0 of rounding into 0.0.
    return f"{round(radius, 1) + 0.0:.1f}, {round(z, 1) + 0.0:.1f}"
