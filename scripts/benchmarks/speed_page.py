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

from benchmarks.timing import Row
from conformance.conformance import insert

import alpha5_model as a5
from alpha5_model.viewer.figures import (
    Color,
    new_figure,
    number,
    style,
    write_figure,
)

MARKS = ("<!-- speed: begin -->", "<!-- speed: end -->")
FIGURE = Path(__file__).resolve().parents[1] / "figures" / "speed.png"
#: Bars of the figure: the work, how the name of the peer begins, and the label.
SHOWN = (
    ("IK of one position", "EAIK", "one target: EAIK"),
    ("IK of one position", "roboticstoolbox", "one target: roboticstoolbox"),
    ("IK of one position", "Pinocchio CLIK", "one target: Pinocchio, CLIK"),
    ("IK of one position", "pin-pink", "one target: pink"),
    ("IK of 100 000 positions", "EAIK", "100 000 targets: EAIK"),
    (
        "inverse_dynamics_batch, 100000 states, 1 thread",
        "Pinocchio",
        "RNEA of a batch: Pinocchio",
    ),
    (
        "forward_dynamics_batch, 100000 states, 1 thread",
        "Pinocchio",
        "ABA of a batch: Pinocchio",
    ),
    ("inverse dynamics in JAX, 100000 states, CPU", "MJX", "JAX: MJX"),
    ("inverse dynamics under water", "MuJoCo", "water, one call: MuJoCo"),
    ("inverse dynamics under water", "Pinocchio", "water by fext: Pinocchio"),
    ("inverse_dynamics", "Pinocchio", "RNEA by load(): Pinocchio"),
    ("self-collision of one position", "coal", "self-collision: coal"),
    ("import", "roboticstoolbox", "import: roboticstoolbox"),
)
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


def duration(seconds: float) -> str:
    """A time with three digits and the unit that suits it."""
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


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


def bars(found: Sequence[Comparison]) -> dict[str, float]:
    """Label and ratio of the comparisons that the figure shows."""
    shown = {}
    for work, peer, label in SHOWN:
        for one in found:
            if one.work == work and one.peer.startswith(peer):
                shown.setdefault(label, one.ratio)
    return shown


@style()
def figure(found: Sequence[Comparison]) -> Any:
    """Bars of the ratios of the main jobs, on a logarithmic axis."""
    shown = bars(found)
    drawing = new_figure(8.0, 0.9 + 0.28 * len(shown))
    axes = drawing.add_subplot()
    ratios = list(shown.values())
    colors = [Color.BLUE if ratio >= 1.0 else Color.ORANGE for ratio in ratios]
    widths = [ratio - 1.0 for ratio in ratios]
    axes.barh(list(shown), widths, left=1.0, color=colors)
    axes.set_xscale("log")
    axes.axvline(1.0, color=Color.BLACK, linewidth=1.0)
    axes.invert_yaxis()
    axes.set_xlabel("its time over ours")
    for place, ratio in enumerate(ratios):
        axes.annotate(f"  {number(ratio)}", (max(ratio, 1.0), place), va="center")
    axes.margins(x=0.15, y=0.02)
    return drawing
