"""``alpha5 check``: the document against itself, and the generated files against the document."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict
from itertools import takewhile
from pathlib import Path
from typing import Annotated, Any, TypeVar

from rich.padding import Padding
from rich.rule import Rule
from rich.table import Column, Table
from rich.text import Text
from typer import Option

from alpha5_model.cli.options import Lines, correction_names, show, spinner
from alpha5_model.consistency import audit
from alpha5_model.consistency.row import AuditRow
from alpha5_model.description.verification import FileCheck, verify_generated, verify_urdf
from alpha5_model.errors import InputError

RowT = TypeVar("RowT")

_COLOUR = {"agrees": "green", "differs": "yellow", "impossible": "red"}
_COLOUR |= {"passed": "green", "failed": "bold red", "not run": "yellow"}
_RELATION = {"=": "", "<=": "at most ", ">=": "at least "}
_TITLES = {
    "claim": "The documents against themselves",
    "observation": "Observed in their numbers, not claimed by them",
}


def check(
    urdf: Annotated[
        Path | None, Option(help="Check this file and nothing else.", metavar="FILE")
    ] = None,
    corrections: Annotated[
        str | None,
        Option(help="With --urdf: corrections it was made with, with commas; '' for none."),
    ] = None,
    every: Annotated[bool, Option("--all", help="Show every row that agrees, too.")] = False,
    as_json: Annotated[bool, Option("--json", help="Print JSON for scripts.")] = False,
) -> int:
    """Check the manufacturer's document against itself and the generated files against it.

    Where the document differs from itself that is a finding: the exit status is 1 only if a
    generated file (or the one given) fails.

    Example: alpha5 check --urdf my_arm.urdf
    """
    if urdf is None and corrections is not None:
        raise InputError("corrections", corrections, "a file to check, --urdf FILE")
    document: Sequence[AuditRow] = ()
    with spinner("checking"):
        if urdf is None:
            document, files = audit(), verify_generated()
        else:
            files = verify_urdf(urdf, correction_names(corrections))
    failed = any(row.verdict == "failed" for row in files)
    claims, checks = ([asdict(row) for row in rows] for rows in (document, files))
    record = {"document": claims, "files": checks, "passed": not failed}
    show(as_json, record, _text(document, files, every))
    return 1 if failed else 0


def _text(document: Sequence[AuditRow], files: Sequence[FileCheck], every: bool) -> Lines:
    for kind, rows in _grouped(document, lambda row: row.kind):
        yield from _document(_TITLES[kind], rows, every)
    yield Rule("[bold]The files against the documents", align="left", style="dim")
    for file, of_file in _grouped(files, lambda row: row.file):
        yield Text(f"\n{file}", "bold")
        table = Table.grid(*(Column(width=width) for width in (9, 17, 7, None)), padding=(0, 2))
        for row in of_file:
            deviation = "" if row.measured is None else f"{row.measured:.1e}"
            table.add_row(_coloured(row.verdict), row.check, deviation, Text(row.finding))
        yield Padding(table, (0, 0, 0, 2))
    yield ""
    yield Text(_summary(document, files))


def _document(title: str, rows: Sequence[AuditRow], every: bool) -> Lines:
    yield Rule(f"[bold]{title}", align="left", style="dim")
    yield _grid([("verdict", "of", "measured", "must be", "effect")], style="dim")
    for topic, of_topic in _grouped(rows, lambda row: row.topic):
        # the common beginning of the places, comma by comma
        parts = zip(*(row.place.split(", ") for row in of_topic), strict=False)
        place = ", ".join(part[0] for part in takewhile(lambda part: len({*part}) == 1, parts))
        yield Text.assemble("\n", (topic.replace("_", " "), "bold"), "  ", (place, "dim"))
        hidden = [row for row in of_topic if row.verdict == "agrees" and not every]
        shown = [row for row in of_topic if row not in hidden]
        lines = [
            (_coloured(verdict), _subjects(same), *figures)
            for (verdict, *figures), same in _grouped(shown, _figures)
        ]
        if lines:
            yield _grid(lines)
        if hidden:
            yield Text.assemble("  ", _coloured("agrees"), "     ", _subjects(hidden))
        for finding, same in _grouped(shown, lambda row: row.finding):
            subject = f"{_subjects(same)}: " if len(shown) > len(same) else ""
            subject += "" if place else f"{same[0].place}: "
            says = "; ".join(dict.fromkeys(row.says for row in same))
            note = Text.assemble((subject, "dim"), (says, "italic"), (f" - {finding}.", "dim"))
            yield Padding(note, (0, 0, 0, 4))
    yield ""


def _grid(lines: Sequence[Sequence[str | Text]], style: str = "") -> Padding:
    """Lines of verdict, subject, measured, must be, effect in columns that fit 80 characters."""
    columns = [Column(width=width) for width in (10, 17, 14, 22, 11)]
    columns[2].justify = columns[4].justify = "right"
    table = Table.grid(*columns, padding=(0, 1))
    for line in lines:
        table.add_row(*line, style=style)
    return Padding(table, (0, 0, 0, 2))


def _figures(row: AuditRow) -> tuple[str, str, str, str]:
    """Verdict, measured, must be, effect as text: rows that read the same share a line."""
    effect = "" if not row.effect else f"{row.effect:.3g} {row.effect_unit}"
    error = f" ± {row.standard_error:.2g}" if row.standard_error else ""
    measured = f"{row.measured:.4g}{error} {row.unit}".rstrip()
    bound = f" ± {row.bound:.2g}" if row.bound else ""
    must_be = f"{_RELATION[row.relation]}{row.expected:.4g}{bound}"
    return row.verdict, measured, must_be, effect


def _subjects(rows: Sequence[AuditRow]) -> str:
    """``link 0, 1, 4`` for claims that end in link_0, link_1 and link_4."""
    words = [row.claim.partition(".")[2].replace("_", " ") for row in rows]
    stems = {word.rpartition(" ")[0] for word in words}
    if len(words) > 1 and len(stems) == 1 and words[0][-1].isdigit():
        return f"{stems.pop()} {', '.join(word.rpartition(' ')[2] for word in words)}"
    return ", ".join(words)


def _grouped(rows: Iterable[RowT], key: Callable[[RowT], Any]) -> Iterable[tuple[Any, list[RowT]]]:
    groups: dict[Any, list[RowT]] = {}
    for row in rows:
        groups.setdefault(key(row), []).append(row)
    return groups.items()


def _coloured(verdict: str) -> Text:
    return Text.assemble((verdict, _COLOUR[verdict]))


def _summary(document: Sequence[AuditRow], files: Sequence[FileCheck]) -> str:
    parts = []
    for kind, name in (("claim", "documents"), ("observation", "observations")):
        if counts := Counter(str(row.verdict) for row in document if row.kind == kind):
            words = (word for word in ("agrees", "differs", "impossible") if counts[word])
            found = (f"{counts[word]} {word.removesuffix('s')}" for word in words)
            parts.append(f"{name} {', '.join(found)}")
    verdicts = Counter({"passed": 0, "failed": 0})
    verdicts.update(row.verdict for row in files)
    parts.append("files " + ", ".join(f"{count} {word}" for word, count in verdicts.items()))
    return "; ".join(parts).capitalize()
