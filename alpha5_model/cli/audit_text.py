"""The rows of the audit as sentences and as counts."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Sequence
from itertools import takewhile
from typing import TypeVar

from alpha5_model.proofs.audit.row import AuditRow

Row = TypeVar("Row")
Key = TypeVar("Key", bound=Hashable)

#: Heading -> what the summary calls the claims under it.
_CLAIMS = {
    "agrees": "claims agree",
    "error": "errors",
    "reading": "readings",
    "transcription": "matters of transcription",
}
#: Kind of the other rows -> what the summary calls them.
_OTHERS = {"observation": "observations", "outside": "outside evidence"}
_RELATION = {"=": "", "<=": "at most ", ">=": "at least "}


def heading(row: AuditRow) -> str:
    """The heading under which a row is shown, a key of the command's words."""
    if row.kind != "claim":
        return row.kind
    return row.category or "agrees"


def counts(rows: Sequence[AuditRow]) -> str:
    """How many rows of each kind agree, and how the others differ."""
    claims = Counter(heading(row) for row in rows if row.kind == "claim")
    found = [f"{claims[key]} {words}" for key, words in _CLAIMS.items()]
    parts = [f"documents: {', '.join(found)}"]
    for kind, words in _OTHERS.items():
        agreeing = [row.verdict == "agrees" for row in rows if row.kind == kind]
        differing = len(agreeing) - sum(agreeing)
        parts.append(f"{words}: {sum(agreeing)} agree, {differing} differ")
    return "; ".join(parts)


def grouped(rows: Iterable[Row], key: Callable[[Row], Key]) -> dict[Key, list[Row]]:
    """Rows by a key, in the order of the first row of each."""
    groups: dict[Key, list[Row]] = {}
    for row in rows:
        groups.setdefault(key(row), []).append(row)
    return groups


def alike(rows: Iterable[AuditRow]) -> list[list[AuditRow]]:
    """Groups of rows with the same text."""
    groups = grouped(
        rows, lambda row: (row.topic, row.verdict, _figures(row), row.measures)
    )
    return list(groups.values())


def sentence(rows: Sequence[AuditRow], verbose: bool = False) -> str:
    """What was measured and where, for rows with the same text.

    Args:
        verbose: Also what the documents claim there, and why it differs.
    """
    row = rows[0]
    place = _common_place(rows)
    if len(rows) > 1:
        place += f", {_subjects(rows)}"
    if not verbose:
        return f"{place}: {row.measures}: {_figures(row)}"

    claims = "; ".join(dict.fromkeys(row.says for row in rows))
    words = [f'{place}, "{claims}": {row.measures}: {_figures(row)}.']
    words += dict.fromkeys(row.finding for row in rows if row.finding)
    if row.used:
        words.append(f"We use {row.used}.")
    if row.effect is not None:
        words.append(f"It costs {row.effect:.3g} {row.effect_unit}: {row.cost}.")
    return " ".join(words)


def _common_place(rows: Sequence[AuditRow]) -> str:
    """The common beginning of the places, comma by comma."""
    places = [row.place.split(", ") for row in rows]
    levels = zip(*places, strict=False)
    common = takewhile(lambda parts: len(set(parts)) == 1, levels)
    return ", ".join(part for part, *_ in common)


def _figures(row: AuditRow) -> str:
    """What was measured and what is expected, as numbers with their unit."""
    measured = f"{row.measured:.4g} {row.unit}".rstrip()
    bound = f" ± {row.bound:.2g}" if row.bound else ""
    expected = f"{row.expected:.4g}{bound} {row.unit}".rstrip()
    return f"{measured}, expected {_RELATION[row.relation]}{expected}"


def _subjects(rows: Sequence[AuditRow]) -> str:
    """``link 0, 1, 4`` for claims that end in link_0, link_1 and link_4."""
    words = [row.claim.partition(".")[2].replace("_", " ") for row in rows]
    parts = [word.rpartition(" ") for word in words]
    stems = {stem for stem, _, _ in parts}
    numbers = [number for _, _, number in parts]
    if len(stems) == 1 and "".join(numbers).isdigit():
        return f"{stems.pop()} {', '.join(numbers)}"
    return ", ".join(words)
