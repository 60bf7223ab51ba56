"""``alpha5 sweep``: what a study's many states, cases or recordings ask of the arm."""

from __future__ import annotations

import math
import os
import sys
from argparse import Namespace
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from alpha5_model._support.text import table
from alpha5_model.cli import options as common
from alpha5_model.cli import printing
from alpha5_model.cli.parsing import Parser
from alpha5_model.errors import InputError
from alpha5_model.studies.sweep.extent import Extent
from alpha5_model.studies.sweep.run import sweep as run_study

#: How many values of an output of a study are printed; its file has all of them.
_PRINTED = 5
#: Work that takes longer is announced [s].
_LONG = 2.0
#: Log levels of Dask: an error on a cluster is one line of ours. The last of them
#: reports callbacks that come after an interruption.
_QUIET = str(
    {
        "distributed": "critical",
        "distributed.client": "critical",
        "tornado.application": "critical",
    }
)


HELP = """
Exit status: 1 if a recording could not be used.

Example: alpha5 sweep study.toml --output results
"""


def options(parser: Parser) -> None:
    parser.add_argument(
        "study",
        type=Path,
        metavar="STUDY",
        help="TOML file: axes and outputs; see the guide on studies",
    )
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        required=True,
        metavar="FOLDER",
        help="folder of results; a study there is continued",
    )
    parser.add_argument(
        "--workers",
        type=int,
        default=0,
        help="processes on this machine; 0 uses this process alone. "
        "Default: %(default)s",
    )
    parser.add_argument(
        "--scheduler", help="scheduler of a Dask cluster: tcp://host:8786"
    )
    parser.add_argument(
        "--yes",
        action="store_true",
        help="start even more than a billion rows or 10 GB",
    )
    common.arm_file(parser)
    common.as_json(parser)


def run(given: Namespace) -> int:
    own = common.record_of(given)
    # Dask reads this when it is imported, by the workers, too.
    os.environ.setdefault("DASK_LOGGING", _QUIET)
    try:
        with printing.progress_bars() as progress:
            found = run_study(
                given.study,
                given.output,
                workers=given.workers,
                scheduler=given.scheduler,
                progress=progress,
                arm=own,
                announce=partial(_announce, given.yes),
            )
    except KeyboardInterrupt:
        goes_on = "interrupted; the same command goes on with what is left"
        print(f"alpha5: {goes_on}", file=sys.stderr)
        raise

    record: dict[str, Any] = {
        "rows": found.rows,
        "failures": found.failures,
        "units": {name: found.study.outputs[name].unit for name in found.outputs},
        "outputs": found.outputs,
        "repaired": found.repaired,
        "foreign": found.foreign,
    }
    if found.study.arm is not None:
        record["arm"] = found.study.arm.name
    printing.show(given.json, record, _text(record), given.output)
    return 1 if found.failures else 0


def _announce(yes: bool, extent: Extent) -> None:
    """Print what a long study will take.

    Raises:
        InputError: It is large, and ``--yes`` is not given.
    """
    words = _extent_text(extent)
    if extent.is_large and not yes:
        expected = f"a smaller one, or --yes: {words}"
        raise InputError("study", f"{extent.rows:,} rows", expected)
    if (extent.seconds or 0.0) > _LONG:
        print(words, file=sys.stderr)


def _extent_text(extent: Extent) -> str:
    """The size of a study and its approximate time, in words."""
    parts = "one part" if extent.parts == 1 else f"{extent.parts:,} parts"
    rows = parts if extent.rows is None else f"{extent.rows:,} rows in {parts}"
    words = [rows]
    if extent.table_bytes:
        words.append(f"about {extent.table_bytes * 1e-9:.2g} GB of tables")
    if extent.seconds:
        words.append(f"about {_duration(extent.seconds)}")
    return ", ".join(words)


def _duration(seconds: float) -> str:
    """A duration in the unit that suits it."""
    for unit, size in (("days", 86400), ("h", 3600), ("min", 60)):
        if seconds >= 2 * size:
            return f"{seconds / size:,.0f} {unit}"
    return f"{seconds:.0f} s"


def _text(record: dict[str, Any]) -> printing.Lines:
    whose = f" of {record['arm']}" if "arm" in record else ""
    yield f"{record['rows']} rows{whose}"
    for name, columns in record["outputs"].items():
        count = max(len(column) for column in columns.values())
        more = f": the first {_PRINTED} of {count}" if count > _PRINTED else ""
        yield f"\n{name} [{record['units'][name]}]{more}"

        rows = [
            [key, *(_cell(x) for x in column[:_PRINTED].tolist())]
            for key, column in columns.items()
            if not key.endswith("_row")
        ]
        yield from table(rows, "<>", 2)
    for recording, problem in record["failures"].items():
        yield f"\nnot used: {recording}: {problem}"
    for problem in record["repaired"]:
        yield f"\nmade again: {problem}"
    yield from _foreign(record["foreign"])


def _foreign(names: Sequence[str]) -> printing.Lines:
    """A line about files in the folder that are none of the study's."""
    if names:
        more = f" and {len(names) - _PRINTED} more" if len(names) > _PRINTED else ""
        yield f"\nnot of this study: {', '.join(names[:_PRINTED])}{more}"


def _cell(x: Any) -> str:
    if isinstance(x, float):
        return f"{x:.4g}" if math.isfinite(x) else "-"
    return str(x)
