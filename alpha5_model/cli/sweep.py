"""``alpha5 sweep``: what a study's many states, cases or recordings ask of the arm."""

from __future__ import annotations

import math
import os
import sys
from argparse import Namespace
from pathlib import Path
from typing import Any

from alpha5_model._support.text import table
from alpha5_model.cli import options as common
from alpha5_model.cli import printing
from alpha5_model.cli.parsing import Parser

#: How many values of an output of a study are printed; its file has all of them.
_PRINTED = 5
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
        "--restart",
        action="store_true",
        help="compute all of it, whatever the folder has",
    )
    common.arm_file(parser)
    common.as_json(parser)


def run(given: Namespace) -> int:
    from alpha5_model.studies.sweep.run import sweep as run_study

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
                restart=given.restart,
                progress=progress,
                arm=own,
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
    }
    if found.study.arm is not None:
        record["arm"] = found.study.arm.name
    printing.show(given.json, record, _text(record), given.output)
    return 1 if found.failures else 0


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


def _cell(x: Any) -> str:
    if isinstance(x, float):
        return f"{x:.4g}" if math.isfinite(x) else "-"
    return str(x)
