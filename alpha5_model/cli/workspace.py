"""``alpha5 workspace``: what the tcp can reach, and how far the document is off."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

from rich import box
from rich.table import Column, Table
from rich.text import Text
from typer import Option

from alpha5_model.cli.options import Lines, show, spinner
from alpha5_model.dynamics.collision import without_self_collision
from alpha5_model.files import check_outputs
from alpha5_model.kinematics import workspace as space
from alpha5_model.kinematics.workspace import SampledShare, sampled_share
from alpha5_model.view.figures import FORMATS, write_figure
from alpha5_model.view.workspace_plot import figure, self_collision_figure


def workspace(
    plot: Annotated[Path | None, Option(help="Write a picture: .png, .pdf or .svg.")] = None,
    self_collision: Annotated[
        bool,
        Option(
            "--self-collision", help="Also what is reached in self-collision only; --plot draws it."
        ),
    ] = False,
    samples: Annotated[int, Option(help="Points that --self-collision tries.")] = 20_000,
    as_json: Annotated[bool, Option("--json", help="Everything as JSON.")] = False,
) -> None:
    """The exact workspace, and how much of the published one is wrong.

    Example: alpha5 workspace --self-collision --plot collision.pdf
    """
    check_outputs((), plot=(plot, FORMATS))
    share = None
    if self_collision:
        with spinner("trying points for self-collision"):
            share = sampled_share(without_self_collision, samples)
    if plot is not None:
        with spinner("drawing"):
            page = self_collision_figure(samples=samples) if self_collision else figure()
            write_figure(page, plot, dpi=150)
    sampled = {} if share is None else {"without_self_collision": share._asdict()}
    record = {
        **sampled,
        "errors_of_the_published_region": asdict(space.published_errors()),
        "cross_section_area": {side: space.cross_section_area(side) for side in space.SIDES},
        "volume": space.volume(),
        "volume_without_limits": space.volume(limits=False),
        "boundary": {side: [arc._asdict() for arc in space.boundary(side)] for side in space.SIDES},
        "published_tori": [torus._asdict() for torus in space.published_tori()],
        "singular_theta_2": space.singular_elbow_angles(),
    }
    show(as_json, record, _text(share), plot)


def _text(share: SampledShare | None) -> Lines:
    e = space.published_errors()
    figures = (Column(head, justify="right") for head in ("half-plane (cm²)", "volume (L)"))
    table = Table("region", *figures, box=box.SIMPLE_HEAD)
    for name, area, volume in (
        ("reachable within the joint limits", e.reachable_area, e.reachable_volume),
        ("published (Section 1.2)", e.published_area, e.published_volume),
        ("published, not reachable", e.unreachable_area, e.unreachable_volume),
        ("reachable, not published", e.missed_area, e.missed_volume),
    ):
        table.add_row(name, f"{area * 1e4:.2f}", f"{volume * 1e3:.3f}")
    yield table
    yield Text(
        f"{e.unreachable_area / e.published_area:.1%} of the published area and "
        f"{e.unreachable_volume / e.published_volume:.1%} of its volume cannot be reached."
    )
    heads = ("pose", "bounded by", "centre", "radius", "from", "to")
    columns = (Column(head, no_wrap=True) for head in heads)
    # 80 columns hold every row.
    arcs = Table(*columns, box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False, padding=0)
    arcs.title = "boundary where both poses can turn (R, z and radius in mm)"
    arcs.title_justify = "left"
    for arc in space.boundary():
        points = [arc.center, *arc.points([arc.start, arc.end])]
        center, start, end = (f"{1e3 * r:z.1f}, {1e3 * z:z.1f}" for r, z in points)
        cause = arc.cause.replace("at its ", "")
        arcs.add_row(arc.side, cause, center, f"{arc.radius * 1e3:.1f}", start, end)
    yield arcs
    if share is not None:
        hit, error, litres = 1 - share.share, share.standard_error, 1e3 * share.total
        yield (
            f"Without self-collision {share.share * litres:.2f} L are reached; {hit:.1%} of the volume, "
            f"{hit * litres:.2f} L, in self-collision only\n(standard error {error:.2%}, "
            f"{error * litres:.3f} L, from {share.samples} points; any wrist angle counts)."
        )
