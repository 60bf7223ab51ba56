"""``alpha5 check``: the documents against their own numbers, a URDF against both."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
from pathlib import Path

from alpha5_model._support.text import table
from alpha5_model.cli import audit_text, printing
from alpha5_model.cli import options as common
from alpha5_model.cli.compare import differences
from alpha5_model.cli.parsing import Parser
from alpha5_model.errors import InputError
from alpha5_model.proofs.audit import audit
from alpha5_model.proofs.audit.row import AuditRow
from alpha5_model.proofs.comparison import compare

#: Heading of `audit_text.heading` -> its title, in the order of a report.
_TITLES = {
    "error": "Errors of the documents: wrong in every reading",
    "reading": "Readings: wrong in the reading that is measured, right in another",
    "observation": "Observed in their numbers: the documents do not claim these",
    "outside": "Outside evidence: other people's numbers contradict theirs, and we do "
    "not know who is right",
    "transcription": "Transcription: signs and letters that may be right in the "
    "originals, which we do not have",
    "agrees": "Claims that hold",
}
#: The last lines of a short report.
_MORE = "\n--verbose also shows what holds, what is printed, and what we use instead"


HELP = """
A document that contradicts itself is a finding, not a failure. A finding is an
error, a matter of reading, a matter of transcription, an observation in the
numbers that the documents do not claim, or outside evidence against them.
--verbose also shows what holds, what is printed, and what we use instead.

With a file this is alpha5 compare: exit status 0 the file agrees with the
tables, or with your own arm (--arm), 1 it differs, 2 it cannot be read.

Example: alpha5 check my_arm.urdf
"""


def options(parser: Parser) -> None:
    parser.add_argument(
        "file",
        nargs="?",
        type=Path,
        metavar="FILE",
        help="a URDF of the arm, compared with the tables",
    )
    parser.add_argument(
        "-v",
        "--verbose",
        action="store_true",
        help="print all rows and reasons, without FILE",
    )
    common.arm_file(parser)
    common.as_json(parser)


def run(given: Namespace) -> int:
    if given.file is not None:
        if given.verbose:
            raise InputError("verbose", True, "no FILE with it")
        return _compare(given)
    if given.arm is not None:
        raise InputError("arm", str(given.arm), "a file to check, FILE")

    with printing.spinner("checking"):
        claims = audit()
    printing.show(given.json, {"document": claims}, _report(claims, given.verbose))
    return 0


def _compare(given: Namespace) -> int:
    own = common.record_of(given)
    with printing.spinner("comparing"):
        comparison = compare(given.file, arm=own)
    printing.show(given.json, comparison.as_dict(), differences(comparison))
    return 0 if comparison.agrees else 1


def _report(claims: Sequence[AuditRow], verbose: bool) -> printing.Lines:
    yield audit_text.counts(claims).capitalize()
    by_heading = audit_text.grouped(claims, audit_text.heading)
    for heading, title in _TITLES.items():
        rows = by_heading.get(heading, [])
        shown = [row for row in rows if verbose or row.verdict != "agrees"]
        if not shown:
            continue

        yield f"\n{title}"
        cells = [
            (same[0].verdict, audit_text.sentence(same, verbose))
            for same in audit_text.alike(shown)
        ]
        yield from table(cells, "<", 2, printing.width())
    if not verbose:
        yield _MORE
