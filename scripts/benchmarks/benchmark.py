"""Speed against the peers that are installed, as ratios measured in one run.

    python scripts/benchmarks/benchmark.py                    # every subject
    python scripts/benchmarks/benchmark.py kinematics
    python scripts/benchmarks/benchmark.py --page docs/speed.md

Install the peers with ``pip install alpha5-model[bench]``; one that is missing is left
out of the table.
"""

from __future__ import annotations

import argparse
import sys
from importlib import import_module
from pathlib import Path

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from benchmarks.speed_page import comparisons, table, write_page

#: Modules of ``scripts/benchmarks`` with ``rows() -> list[Row]``.
SUBJECTS = ("dynamics", "kinematics", "collision", "planning", "recordings")


def main() -> None:
    """Measure the chosen subjects and print them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "subjects", nargs="*", metavar="subject", help=f"of {', '.join(SUBJECTS)}"
    )
    parser.add_argument(
        "--page", type=Path, help="also write table and figure into this page"
    )
    options = parser.parse_args()
    if unknown := {*options.subjects} - {*SUBJECTS}:
        parser.error(f"unknown {min(unknown)!r}; choose from {', '.join(SUBJECTS)}")
    rows = []
    for subject in options.subjects or SUBJECTS:
        rows += import_module(f"benchmarks.{subject}").rows()
    print(table(comparisons(rows)))
    if options.page:
        write_page(options.page, rows)


if __name__ == "__main__":
    main()
