"""``alpha5 workspace``: what the arm reaches."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import Any

from alpha5_model import workspace as space
from alpha5_model._support.outputs import check_outputs
from alpha5_model._support.text import table
from alpha5_model.cli import options as common
from alpha5_model.cli import printing
from alpha5_model.cli.parsing import Parser
from alpha5_model.collision.self_collision import without_self_collision
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.studies.uncertainty.effects import reach, sensitivity
from alpha5_model.viewer import figures
from alpha5_model.viewer.self_collision_plot import self_collision_figure
from alpha5_model.viewer.workspace_plot import own_workspace_figure, workspace_figure

#: Units in which areas, volumes and lengths are printed, in SI units.
_SQUARE_CENTIMETRE = 1e-4
_LITRE = 1e-3
_MILLIMETRE = 1e-3
#: Points that --self-collision tries if nothing is said.
_SAMPLES = 20_000
#: Region of `PublishedErrors` -> what it is.
_REGIONS = {
    "reachable": "reachable within the joint limits",
    "published": "published (Section 1.2)",
    "unreachable": "published, not reachable",
    "missed": "reachable, not published",
}


HELP = """
With --arm only the exact workspace is printed, because nothing is published
about your own arm.

Example: alpha5 workspace --self-collision --plot collision.pdf
"""


def options(parser: Parser) -> None:
    common.plot(parser)
    parser.add_argument(
        "--self-collision",
        action="store_true",
        help="also compute the share that is reached only in self-collision; --plot "
        "draws it, but not with --arm",
    )
    parser.add_argument(
        "--samples",
        type=int,
        help=f"how many points --self-collision tries. Default: {_SAMPLES}",
    )
    common.arm_file(parser)
    common.as_json(parser)


def run(given: Namespace) -> None:
    check_outputs([given.arm], plot=(given.plot, figures.FORMATS))
    if given.samples is not None and not given.self_collision:
        raise InputError("samples", given.samples, "--self-collision with it")
    samples = _SAMPLES if given.samples is None else given.samples
    own = common.record_of(given)
    plot = given.plot
    if own is not None:
        _of_own_arm(own, plot, samples if given.self_collision else 0, given.json)
        return

    share = None
    if given.self_collision:
        with printing.spinner("trying points for self-collision"):
            share = space.sampled_share(without_self_collision, samples)

    if plot is not None:
        with printing.spinner("drawing"):
            page = (
                self_collision_figure(samples=samples) if share else workspace_figure()
            )
            figures.write_figure(page, plot)

    record = _record()
    if share is not None:
        record = {"without_self_collision": share} | record
    printing.show(given.json, record, _text(record), plot)


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
    area = record["cross_section_area"]["both"] / _SQUARE_CENTIMETRE
    volume = record["volume"] / _LITRE
    yield f"The arm reaches {area:.2f} cm² of a half-plane, in all {volume:.3f} L."
    yield from _boundary(record["boundary"]["both"])
    if "without_self_collision" in record:
        yield _collision(record["without_self_collision"])


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
    errors = record["errors_of_the_published_region"]
    yield from _regions(errors)
    area = errors.unreachable_area / errors.published_area
    volume = errors.unreachable_volume / errors.published_volume
    yield (
        f"{area:.1%} of the published area and {volume:.1%} of its volume cannot be "
        "reached."
    )

    value = record["reach"]["value"] / _MILLIMETRE
    digits = record["reach"]["digits"] / _MILLIMETRE
    yield (
        f"The tcp reaches {value:.1f} mm ±{digits:.1f} from the shoulder, "
        "by the digits of Table 1."
    )
    yield from _boundary(record["boundary"]["both"])
    if "without_self_collision" in record:
        yield _collision(record["without_self_collision"])


def _regions(errors: space.PublishedErrors) -> list[str]:
    """Area and volume of the reachable, the published and the differing regions."""
    sizes = vars(errors)
    rows = [["region", "half-plane", "volume"], ["", "cm²", "L"]]
    for region, name in _REGIONS.items():
        area = sizes[f"{region}_area"] / _SQUARE_CENTIMETRE
        volume = sizes[f"{region}_volume"] / _LITRE
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
                f"{arc.radius / _MILLIMETRE:.1f}",
                _millimetres(start),
                _millimetres(end),
            ]
        )
    yield from table(rows, "<<>")


def _millimetres(point: Any) -> str:
    r, z = point
    return f"{r / _MILLIMETRE:z.1f}, {z / _MILLIMETRE:z.1f}"


def _collision(free: Any) -> str:
    """What is reached only in self-collision, from a sampled share of the volume."""
    litres = free.total / _LITRE
    touching = 1 - free.share
    return (
        f"Without self-collision {free.share * litres:.2f} L are reached; "
        f"{touching:.1%} of the volume, {touching * litres:.2f} L, in self-collision "
        f"only (standard error {free.standard_error:.2%}, "
        f"{free.standard_error * litres:.3f} L, from {free.samples} points; any wrist "
        "angle counts)."
    )
