"""The page on speed: one figure and one table of the benchmark's ratios."""

from __future__ import annotations

import os
import platform
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date
from importlib.metadata import version
from pathlib import Path
from typing import Any

from benchmarks.timing import Row, duration
from conformance.conformance import insert

import alpha5_model as a5
from alpha5_model.viewer.figures import Color, new_figure, style, write_figure

MARKS = ("<!-- speed: begin -->", "<!-- speed: end -->")
FIGURE = Path(__file__).resolve().parents[1] / "figures" / "speed.png"
#: How the names of candidates begin that are this package itself.
OWN = ("alpha5", "NumPy alone")
#: Pixels per inch.
DPI = 110


@dataclass(frozen=True)
class Comparison:
    """A peer beside this package's own time for the same work.

    Attributes:
        work: What is computed.
        seconds: This package's time per unit [s].
        peer: Who else computes it.
        ratio: The peer's time as a multiple of this package's.
        success: Share of the inputs that the peer solved; None if nothing can fail.
    """

    work: str
    seconds: float
    peer: str
    ratio: float
    success: float | None


def comparisons(rows: Sequence[Row]) -> list[Comparison]:
    """Each row beside the first one of its work."""
    own: dict[str, Row] = {}
    found = []
    for row in rows:
        first = own.setdefault(row.work, row)
        if row is not first:
            found.append(
                Comparison(
                    work=row.work,
                    seconds=first.seconds,
                    peer=row.candidate,
                    ratio=row.seconds / first.seconds,
                    success=row.success,
                )
            )
    return found


def write_page(page: Path, rows: Sequence[Row]) -> None:
    """Put the table between the markers of a page, and draw the figure beside it."""
    found = comparisons(rows)
    write_figure(figure(found), FIGURE, DPI)
    insert(page, f"\n{machine()}\n\n{table(found)}\n", MARKS)


def machine() -> str:
    """Where and when the ratios were measured, in a sentence or two."""
    packages = ", ".join(f"{name} {version(name)}" for name in ("pin", "numpy"))
    return (
        f"Measured on {date.today().isoformat()} with {os.cpu_count()} cores of "
        f"{processor()}, {packages}, Python {platform.python_version()}. The kernels "
        f"were {a5.backend()}."
    )


def processor() -> str:
    """The processor's name as Linux gives it, else its kind."""
    information = Path("/proc/cpuinfo")
    if information.is_file():
        for line in information.read_text("utf-8").splitlines():
            name, _, value = line.partition(":")
            if name.strip() == "model name":
                return value.strip()
    return platform.machine()


def table(found: Sequence[Comparison]) -> str:
    """The comparisons as Markdown."""
    lines = [
        "| work | here, per unit | compared with | its time over ours | solved |",
        "|---|---|---|---|---|",
    ]
    for one in found:
        solved = "" if one.success is None else f"{one.success:.0%}"
        cells = (
            one.work,
            duration(one.seconds),
            one.peer,
            f"{one.ratio:.3g}",
            solved,
        )
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


@style()
def figure(found: Sequence[Comparison]) -> Any:
    """Bars of the ratios on a logarithmic axis, the peers of this package only."""
    shown = [one for one in found if not one.peer.startswith(OWN)]
    drawing = new_figure(9.0, 0.8 + 0.28 * len(shown))
    axes = drawing.add_subplot()
    labels = [f"{one.work}: {one.peer}" for one in shown]
    colors = [Color.BLUE if one.ratio >= 1.0 else Color.ORANGE for one in shown]
    axes.barh(labels, [one.ratio for one in shown], color=colors)
    axes.set_xscale("log")
    axes.axvline(1.0, color=Color.BLACK, linewidth=1.0)
    axes.invert_yaxis()
    axes.set_xlabel("time of the other, in times of this package (logarithmic)")
    for place, one in enumerate(shown):
        axes.annotate(f" {one.ratio:.3g}", (one.ratio, place), va="center")
    axes.margins(x=0.12)
    return drawing
