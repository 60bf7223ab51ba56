"""``alpha5 check``: the documents and the generated files against the documents."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

from typer import Option

from alpha5_model._support.text import table
from alpha5_model.cli import audit_text, options, printing, values
from alpha5_model.cli.words import WORDS
from alpha5_model.description.verification import (
    FileCheck,
    verify_generated,
    verify_urdf,
)
from alpha5_model.errors import InputError
from alpha5_model.proofs.audit import audit
from alpha5_model.proofs.audit.row import AuditRow

#: The last lines of a short report.
_MORE = "\n--verbose also shows what holds, what is printed, and what we use instead"


def check(
    urdf: Annotated[
        Path | None, Option(help="Check only this file.", metavar="FILE")
    ] = None,
    arm_file: options.Arm = None,
    corrections: Annotated[str | None, Option(help=options.HELP["corrections"])] = None,
    verbose: Annotated[
        bool, Option("--verbose", "-v", "--all", help=options.HELP["all"])
    ] = False,
    as_json: options.Json = False,
) -> int:
    """Check the documents against their own numbers, and the generated files against both.

    A document that contradicts itself is a finding, not a failure. It is an
    error, a matter of reading, or a matter of transcription. The exit status is
    1 only if a file fails. --verbose also shows what holds, what is printed, and
    what we use instead. With --arm, the file of --urdf is compared with your
    own arm.

    Example: alpha5 check --urdf my_arm.urdf
    """  # noqa: E501 (a line of the help)
    if urdf is None and corrections is not None:
        raise InputError("corrections", corrections, "a file to check, --urdf FILE")
    if urdf is None and arm_file is not None:
        raise InputError("arm", str(arm_file), "a file to check, --urdf FILE")

    names = values.correction_names(corrections)
    with printing.spinner("checking"):
        claims = audit() if urdf is None else ()
        own = values.arm_record(arm_file)
        if urdf is None:
            files = verify_generated()
        else:
            files = verify_urdf(urdf, names, arm=own)
    failed = any(row.verdict == "failed" for row in files)

    record = {"document": claims, "files": files, "passed": not failed}
    printing.show(as_json, record, _report(claims, files, verbose))
    return 1 if failed else 0


def _report(
    claims: Sequence[AuditRow], files: Sequence[FileCheck], verbose: bool
) -> printing.Lines:
    yield _summary(claims, files)
    yield from _claims(claims, verbose)
    yield from _file_checks(files, verbose)
    if not verbose:
        yield _MORE


def _summary(claims: Sequence[AuditRow], files: Sequence[FileCheck]) -> str:
    verdicts = Counter({"passed": 0, "failed": 0})
    verdicts.update(row.verdict for row in files)
    counts = f"files: {_counts(verdicts)}"
    if claims:
        counts = f"{audit_text.counts(claims)}; {counts}"
    return counts.capitalize()


def _counts(verdicts: Counter[Any]) -> str:
    return ", ".join(f"{count} {verdict}" for verdict, count in verdicts.items())


def _claims(claims: Sequence[AuditRow], verbose: bool) -> printing.Lines:
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


def _file_checks(files: Sequence[FileCheck], verbose: bool) -> printing.Lines:
    yield "\nThe files against the documents"
    for file, checks in audit_text.grouped(files, lambda row: row.file).items():
        verdicts = Counter(row.verdict for row in checks)
        yield f"  {file}: {_counts(verdicts)}"

        shown = [row for row in checks if verbose or row.verdict != "passed"]
        cells = [[row.verdict, row.check, _off(row), row.finding] for row in shown]
        if cells:
            yield from table(cells, "<", 4, printing.width())


def _off(row: FileCheck) -> str:
    return f"{row.measured:.1e}" if row.measured else ""
