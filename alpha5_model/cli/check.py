"""``alpha5 check``: the documents against their own numbers, a URDF against both."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

from typer import Argument, Option

from alpha5_model._support.text import table
from alpha5_model.cli import audit_text, options, printing, values
from alpha5_model.cli.compare import differences
from alpha5_model.cli.words import WORDS
from alpha5_model.errors import InputError
from alpha5_model.proofs.audit import audit
from alpha5_model.proofs.audit.row import AuditRow
from alpha5_model.proofs.comparison import compare

#: The last lines of a short report.
_MORE = "\n--verbose also shows what holds, what is printed, and what we use instead"


def check(
    file: Annotated[
        Path | None, Argument(help="A URDF of the arm, compared with the tables.")
    ] = None,
    urdf: Annotated[
        Path | None, Option(help="The same as the argument.", metavar="FILE")
    ] = None,
    arm_file: options.Arm = None,
    verbose: Annotated[
        bool, Option("--verbose", "-v", "--all", help=options.HELP["all"])
    ] = False,
    as_json: options.Json = False,
) -> int:
    """Check the documents against their own numbers, or a URDF against the documents.

    A document that contradicts itself is a finding, not a failure. It is an
    error, a matter of reading, or a matter of transcription. --verbose also
    shows what holds, what is printed, and what we use instead.

    With a file this is alpha5 compare: exit status 0 the file agrees with the
    tables, or with your own arm (--arm), 1 it differs, 2 it cannot be read.

    Example: alpha5 check my_arm.urdf
    """
    if file is not None and urdf is not None:
        raise InputError("urdf", str(urdf), "one file to check")
    given = file or urdf
    if given is not None:
        return _compare(given, arm_file, as_json)
    if arm_file is not None:
        raise InputError("arm", str(arm_file), "a file to check, FILE")

    with printing.spinner("checking"):
        claims = audit()
    printing.show(as_json, {"document": claims}, _report(claims, verbose))
    return 0


def _compare(file: Path, arm_file: Path | None, as_json: bool) -> int:
    own = values.arm_record(arm_file)
    with printing.spinner("comparing"):
        comparison = compare(file, arm=own)
    printing.show(as_json, comparison.as_dict(), differences(comparison))
    return 0 if comparison.agrees else 1


def _report(claims: Sequence[AuditRow], verbose: bool) -> printing.Lines:
    yield audit_text.counts(claims).capitalize()
    by_heading = audit_text.grouped(claims, audit_text.heading)
    for heading, title in WORDS["check"].items():
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
