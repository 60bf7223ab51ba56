"""Speed against the peers that are installed, as ratios measured in one run.

    python scripts/benchmarks/benchmark.py                    # every section
    python scripts/benchmarks/benchmark.py kinematics --json
    python scripts/benchmarks/benchmark.py --page docs/speed.md

Install the peers with ``pip install alpha5-model[bench]``; one that is missing is left
out of the table and named below it.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import asdict
from importlib import import_module
from pathlib import Path

from rich.console import Console
from rich.table import Table

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from benchmarks.speed_page import write_page
from benchmarks.timing import Row, duration

#: Modules of ``scripts/benchmarks`` with ``rows() -> list[Row]`` and ``missing() ->
#: list[str]``.
SECTIONS = (
    "kernels",
    "kinematics",
    "own_arm",
    "self_collision",
    "planning",
    "dynamics",
    "trajectory",
    "sweeps",
)


def ratio(row: Row, rows: Sequence[Row]) -> float:
    """Time of a row as a multiple of the first row of the same work."""
    own = next(other for other in rows if other.work == row.work)
    return row.seconds / own.seconds


def show(rows: Sequence[Row], missing: Sequence[str]) -> None:
    """Print the table, the set-up of each candidate, and the peers that are not
    installed.
    """
    console = Console()
    table = Table("work", "candidate", "per unit", "ratio", "target", "success")
    work = ""
    for row in rows:
        if row.work != work and work:
            table.add_section()
        table.add_row(
            row.work if row.work != work else "",
            row.candidate,
            duration(row.seconds),
            f"{ratio(row, rows):.3g}",
            "" if row.target is None else f">= {row.target:.3g}",
            "" if row.success is None else f"{row.success:.2%}",
        )
        work = row.work
    console.print(table)
    setups = dict.fromkeys((row.candidate, row.setup) for row in rows if row.setup)
    for candidate, setup in setups:
        console.print(f"[bold]{candidate}[/bold]: {setup}")
    for peer in missing:
        console.print(f"not installed, left out: {peer}")


def main() -> None:
    """Measure the chosen sections and print them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "sections", nargs="*", metavar="section", help=f"of {', '.join(SECTIONS)}"
    )
    parser.add_argument(
        "--json", action="store_true", help="machine-readable rows on stdout"
    )
    parser.add_argument(
        "--page", type=Path, help="also write table and figure into this page"
    )
    options = parser.parse_args()
    for section in options.sections:
        if section not in SECTIONS:
            parser.error(
                f"unknown section {section!r}; choose from {', '.join(SECTIONS)}"
            )
    modules = [import_module(f"benchmarks.{s}") for s in options.sections or SECTIONS]
    rows = [row for module in modules for row in module.rows()]
    missing = list(
        dict.fromkeys(peer for module in modules for peer in module.missing())
    )
    if options.json:
        table = [{**asdict(row), "ratio": ratio(row, rows)} for row in rows]
        print(json.dumps({"rows": table, "missing": missing}, indent=2))
    else:
        show(rows, missing)
    if options.page:
        write_page(options.page, rows)


if __name__ == "__main__":
    main()
