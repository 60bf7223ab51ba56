"""``alpha5 workspace``: what the arm reaches."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import Annotated, Any

from typer import Option

from alpha5_model import workspace as space
from alpha5_model._support.outputs import check_outputs
from alpha5_model._support.text import table
from alpha5_model.cli import options, printing, values
from alpha5_model.cli.units import LITRE, MILLIMETRE, SQUARE_CENTIMETRE
from alpha5_model.cli.words import WORDS
from alpha5_model.collision.self_collision import without_self_collision
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.studies.uncertainty.effects import reach, sensitivity
from alpha5_model.viewer import figures
from alpha5_model.viewer.self_collision_plot import self_collision_figure
from alpha5_model.viewer.workspace_plot import own_workspace_figure, workspace_figure


def workspace(
    plot: options.Plot = None,
    self_collision: Annotated[
        bool, Option("--self-collision", help=options.HELP["touching"])
    ] = False,
    samples: Annotated[
        int, Option(help="How many points --self-collision tries.")
    ] = 20_000,
    arm_file: options.Arm = None,
    as_json: options.Json = False,
) -> None:
    """The exact workspace, and how much of the published one is wrong.

    With --arm only the exact workspace is printed, because nothing is published
    about your own arm.

    Example: alpha5 workspace --self-collision --plot collision.pdf
    """
    check_outputs([arm_file], plot=(plot, figures.FORMATS))
    own = values.arm_record(arm_file)
    if own is not None:
        _of_own_arm(own, plot, samples if self_collision else 0, as_json)
        return

    share = None
    if self_collision:
        with printing.spinner("trying points for self-collision"):
            share = space.sampled_share(without_self_collision, samples)

    if plot is not None:
        with printing.spinner("drawing"):
            if share:
                page = self_collision_figure(samples=samples)
            else:
                page = workspace_figure()
            figures.write_figure(page, plot)

    record = _record()
    if share is not None:
        record = {"without_self_collision": share} | record
    printing.show(as_json, record, _text(record), plot)


def _of_own_arm(
    own: Alpha5Parameters, plot: Path | None, samples: int, as_json: bool
) -> None:
    """The exact workspace of an arm of one's own.

    Args:
        samples: Points that are tried for self-collision; 0 for none.
    """
    if plot is not None and samples:
        expected = "no --plot beside --self-collision and --arm"
        raise InputError("--plot", str(plot), expected)

    record: dict[str, Any] = {
        "cross_section_area": {
            side: space.cross_section_area(side, arm=own) for side in space.SIDES
        },
        "volume": space.volume(arm=own),
        "volume_without_limits": space.volume(limits=False, arm=own),
        "boundary": {side: space.boundary(side, arm=own) for side in space.SIDES},
        "singular_theta_2": space.singular_elbow_angles(arm=own),
    }
    if samples:
        free = partial(without_self_collision, arm=own)
        with printing.spinner("trying points for self-collision"):
            share = space.sampled_share(free, samples, arm=own)
        record = {"without_self_collision": share} | record
    if plot is not None:
        with printing.spinner("drawing"):
            page = own_workspace_figure(own)
            figures.write_figure(page, plot)
    printing.show(as_json, record, _own_text(record), plot)


def _own_text(record: dict[str, Any]) -> printing.Lines:
    area = record["cross_section_area"]["both"] / SQUARE_CENTIMETRE
    volume = record["volume"] / LITRE
    yield f"The arm reaches {area:.2f} cm² of a half-plane, in all {volume:.3f} L."
    yield from _boundary(record["boundary"]["both"])
    if "without_self_collision" in record:
        words = WORDS["workspace"]["collision"]
        yield _collision(record["without_self_collision"], words)


def _record() -> dict[str, Any]:
    farthest = sensitivity(reach)
    return {
        "errors_of_the_published_region": space.published_errors(),
        "cross_section_area": {
            side: space.cross_section_area(side) for side in space.SIDES
        },
        "reach": {"value": farthest.nominal, "digits": farthest.half_width},
        "volume": space.volume(),
        "volume_without_limits": space.volume(limits=False),
        "boundary": {side: space.boundary(side) for side in space.SIDES},
        "published_tori": space.published_tori(),
        "singular_theta_2": space.singular_elbow_angles(),
    }


def _text(record: dict[str, Any]) -> printing.Lines:
    words = WORDS["workspace"]
    errors = record["errors_of_the_published_region"]
    yield from _regions(errors, words["regions"])
    yield words["outside"].format(
        area=errors.unreachable_area / errors.published_area,
        volume=errors.unreachable_volume / errors.published_volume,
    )

    value = record["reach"]["value"] / MILLIMETRE
    digits = record["reach"]["digits"] / MILLIMETRE
    yield (
        f"The tcp reaches {value:.1f} mm ±{digits:.1f} from the shoulder, "
        "by the digits of Table 1."
    )
    yield from _boundary(record["boundary"]["both"])
    if "without_self_collision" in record:
        yield _collision(record["without_self_collision"], words["collision"])


def _regions(errors: space.PublishedErrors, names: dict[str, str]) -> list[str]:
    """Area and volume of the reachable, the published and the differing regions."""
    sizes = vars(errors)
    rows = [["region", "half-plane", "volume"], ["", "cm²", "L"]]
    for region, name in names.items():
        area = sizes[f"{region}_area"] / SQUARE_CENTIMETRE
        volume = sizes[f"{region}_volume"] / LITRE
        rows.append([name, f"{area:.2f}", f"{volume:.3f}"])
    return table(rows)


def _boundary(arcs: Iterable[space.Arc]) -> printing.Lines:
    yield (
        "\nboundary in a half-plane that both poses can face;\n"
        "R from the axis of axis_e, z above base_link"
    )
    rows = [
        ["pose", "bounded by", "centre R, z", "radius", "from R, z", "to R, z"],
        ["", "", "mm", "mm", "mm", "mm"],
    ]
    for arc in arcs:
        start, end = arc.points([arc.start, arc.end])
        rows.append(
            [
                arc.side,
                arc.cause.replace("at its ", "").replace(" limit", ""),
                _millimetres(arc.center),
                f"{arc.radius / MILLIMETRE:.1f}",
                _millimetres(start),
                _millimetres(end),
            ]
        )
    yield from table(rows, "<<>")


def _millimetres(point: Any) -> str:
    r, z = point
    return f"{r / MILLIMETRE:z.1f}, {z / MILLIMETRE:z.1f}"


def _collision(free: Any, words: str) -> str:
    """What is reached only in self-collision, from a sampled share of the volume."""
    touching = 1 - free.share
    litres = free.total / LITRE
    return words.format(
        share=touching,
        error=free.standard_error,
        samples=free.samples,
        free=free.share * litres,
        litres=touching * litres,
        error_litres=free.standard_error * litres,
    )
