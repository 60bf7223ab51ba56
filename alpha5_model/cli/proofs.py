"""``alpha5 check`` and ``compare``: documents, files and other models held to one another."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from itertools import takewhile
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from typer import Argument, Option, style

from alpha5_model._support.files import check_outputs
from alpha5_model._support.text import table
from alpha5_model.cli import options
from alpha5_model.description.verification import (
    FileCheck,
    verify_generated,
    verify_urdf,
)
from alpha5_model.errors import InputError
from alpha5_model.proofs.audit.row import AuditRow
from alpha5_model.proofs.audit.run import audit
from alpha5_model.proofs.comparison.measure import compare as run
from alpha5_model.proofs.comparison.records import Comparison
from alpha5_model.viewer.figures import FORMATS, plot_comparison

#: Heading -> what the summary calls the claims under it.
_CLAIMS = {
    "agrees": "agree",
    "error": "errors",
    "reading": "readings",
    "transcription": "matters of transcription",
}
_RELATION = {"=": "", "<=": "at most ", ">=": "at least "}


def check(
    urdf: Annotated[
        Path | None, Option(help="Check this file alone.", metavar="FILE")
    ] = None,
    corrections: Annotated[str | None, Option(help=options.HELP["corrections"])] = None,
    verbose: Annotated[
        bool, Option("--verbose", "-v", "--all", help=options.HELP["all"])
    ] = False,
    as_json: options.Json = False,
) -> int:
    """Check the manufacturer's document against itself and the generated files against it.

    Where the document differs from itself that is a finding: an error, a matter
    of reading, or one of transcription. The exit status is 1 only if a generated
    file (or the one given) fails. --verbose also shows what agrees, and the
    claims' words.

    Example: alpha5 check --urdf my_arm.urdf
    """
    if urdf is None and corrections is not None:
        raise InputError("corrections", corrections, "a file to check, --urdf FILE")
    names = options.correction_names(corrections)
    with options.spinner("checking"):
        document = audit() if urdf is None else ()
        files = verify_generated() if urdf is None else verify_urdf(urdf, names)
    failed = any(row.verdict == "failed" for row in files)
    record = {"document": document, "files": files, "passed": not failed}
    options.show(as_json, record, _report(document, files, verbose))
    return 1 if failed else 0


def _report(
    claims: Sequence[AuditRow], files: Sequence[FileCheck], verbose: bool
) -> options.Lines:
    yield _summary(claims, files)
    by_heading = _grouped(claims, _heading)
    for heading, title in options.WORDS["check"].items():
        rows = by_heading.get(heading, [])
        shown = [row for row in rows if verbose or row.verdict != "agrees"]
        if not shown:
            continue
        yield f"\n{title}"
        lines: list[Any] = [
            (same[0].verdict, sentence(same, verbose)) for same in alike(shown)
        ]
        yield from table(lines, "<", 2, options.width())
    yield "\nThe files against the documents"
    for file, checks in _grouped(files, lambda row: row.file).items():
        count = Counter(row.verdict for row in checks)
        yield f"  {file}: {', '.join(f'{n} {verdict}' for verdict, n in count.items())}"
        found = [row for row in checks if verbose or row.verdict != "passed"]
        off = (f"{row.measured:.1e}" if row.measured else "" for row in found)
        cells = [
            [x.verdict, x.check, far, x.finding]
            for x, far in zip(found, off, strict=True)
        ]
        yield from table(cells, "<", 4, options.width()) if cells else ()
    if not verbose:
        yield "\n--verbose adds the rows in agreement, the claims' words and all reasons"


def _heading(row: AuditRow) -> str:
    """The heading under which a row is shown, a key of the command's words."""
    if row.kind == "observation":
        return "observation"
    if row.verdict == "agrees":
        return "agrees"
    return str(row.category)


def alike(rows: Iterable[AuditRow]) -> Iterable[Sequence[AuditRow]]:
    """Rows that read the same, together."""
    return _grouped(
        rows, lambda row: (row.topic, row.verdict, _figures(row), _asked(row))
    ).values()


def sentence(rows: Sequence[AuditRow], verbose: bool = False) -> str:
    """What was measured and where, of rows that read the same.

    Args:
        verbose: Also what is claimed there, and why it differs.
    """
    row = rows[0]
    # the common beginning of the places, comma by comma
    parts = zip(*(r.place.split(", ") for r in rows), strict=False)
    place = ", ".join(
        part[0] for part in takewhile(lambda part: len({*part}) == 1, parts)
    )
    place += f", {_subjects(rows)}" if len(rows) > 1 else ""
    if not verbose:
        return f"{place}: {_asked(row)}: {_figures(row)}"
    claims, found = (
        dict.fromkeys(getattr(r, k) for r in rows) for k in ("says", "finding")
    )
    worth = f", worth {row.effect:.3g} {row.effect_unit}" if row.effect else ""
    return f'{place}, "{"; ".join(claims)}": {"; ".join(found)}: {_figures(row)}{worth}'


def _figures(row: AuditRow) -> str:
    error = f" ± {row.standard_error:.2g}" if row.standard_error else ""
    bound = f" ± {row.bound:.2g}" if row.bound else ""
    must_be = f"{_RELATION[row.relation]}{row.expected:.4g}{bound} {row.unit}".rstrip()
    return f"{row.measured:.4g}{error} {row.unit}".rstrip() + f", must be {must_be}"


def _asked(row: AuditRow) -> str:
    """What was measured: a finding's first words."""
    return re.split("[;:] ", row.finding)[0]


def _subjects(rows: Sequence[AuditRow]) -> str:
    """``link 0, 1, 4`` for claims that end in link_0, link_1 and link_4."""
    words = [row.claim.partition(".")[2].replace("_", " ") for row in rows]
    stems = {word.rpartition(" ")[0] for word in words}
    if len(words) > 1 and len(stems) == 1 and words[0][-1].isdigit():
        return f"{stems.pop()} {', '.join(word.rpartition(' ')[2] for word in words)}"
    return ", ".join(words)


def _grouped(rows: Iterable[Any], key: Callable[[Any], Any]) -> dict[Any, list[Any]]:
    groups: dict[Any, list[Any]] = {}
    for row in rows:
        groups.setdefault(key(row), []).append(row)
    return groups


def documents(rows: Sequence[AuditRow]) -> str:
    """How many claims agree, how many differ in which way, and the same of the observations."""
    claims = Counter(_heading(row) for row in rows if row.kind == "claim")
    found = [f"{claims[heading]} {words}" for heading, words in _CLAIMS.items()]

    observed = Counter(row.verdict for row in rows if row.kind == "observation")
    differing = observed["differs"] + observed["impossible"]
    noted = f"observations {observed['agrees']} agree, {differing} differ"
    return f"documents {', '.join(found)}; {noted}"


def _summary(document: Sequence[AuditRow], files: Sequence[FileCheck]) -> str:
    parts = [documents(document)] if document else []
    verdicts = Counter({"passed": 0, "failed": 0})
    verdicts.update(row.verdict for row in files)
    parts.append(
        "files " + ", ".join(f"{count} {word}" for word, count in verdicts.items())
    )
    return "; ".join(parts).capitalize()


def compare(
    other: Annotated[Path, Argument(help="A URDF or xacro file of the Reach Alpha 5.")],
    joints: Annotated[
        str, Option("--map", help="axis_e=NAME,axis_d=NAME and so on.")
    ] = "",
    base: Annotated[
        str | None, Option(help="First link of an arm on a vehicle.")
    ] = None,
    xacro: Annotated[bool, Option("--xacro", help="Run the xacro file.")] = False,
    package: Annotated[
        list[str] | None, Option(help="With --xacro: NAME=FOLDER.")
    ] = None,
    arg: Annotated[list[str] | None, Option(help="With --xacro: NAME:=VALUE.")] = None,
    samples: Annotated[int, Option(help="Random positions.", min=1, max=100_000)] = 500,
    as_json: options.Json = False,
    plot: options.Plot = None,
) -> int:
    """Compare another URDF of this arm with the tables.

    A URDF is only read. A xacro file is a program: --xacro runs it, with your
    rights, so use it only on files that you trust.

    Exit status: 0 the model agrees, 1 it differs or is another arm, 2 it cannot
    be read.

    Example: alpha5 compare other.urdf --map axis_e=joint1,axis_d=joint2,axis_c=joint3,axis_b=joint4
    """
    check_outputs([other], plot=(plot, FORMATS))
    with options.spinner("comparing"):
        pairs = _pairs("map", joints.split(","), "=")
        more = _pairs("package", package or [], "="), _pairs("arg", arg or [], ":=")
        comparison = run(other, pairs, samples, base, *more, xacro)
    plot = plot if comparison.joints else None  # another arm has no errors to draw
    if plot is not None:
        plot_comparison(comparison, plot)
    options.show(as_json, comparison.as_dict(), _differences(comparison), plot)
    return 0 if comparison.agrees else 1


def _pairs(option: str, parts: list[str], sign: str) -> dict[str, str]:
    pairs: dict[str, str] = {}
    for part in filter(None, (p.strip() for p in parts)):
        name, equals, value = part.partition(sign)
        if (
            not name
            or not equals
            or (not value and option != "arg")
            or name.strip() in pairs
        ):
            expected = (
                "axis_e=NAME,axis_d=NAME,..." if option == "map" else f"NAME{sign}VALUE"
            )
            raise InputError(option, ",".join(parts), f"{expected} with each name once")
        pairs[name.strip()] = value.strip()
    return pairs


def _differences(comparison: Comparison) -> options.Lines:
    joints = ", ".join(
        f"{ours} = {theirs}" for ours, theirs in comparison.joints.items()
    )
    yield f"{comparison.name}: {joints or comparison.verdict}"
    if not joints:
        return
    rows = [
        ["body", "", "mass", "COM x", "COM y", "COM z", *(f"moment {n}" for n in "123")]
    ]
    rows.append(["", "", "[g]", *["[mm]"] * 3, *["[kg mm²]"] * 3])
    for body in comparison.bodies:
        both = body.as_dict()
        theirs, ours = _row(both), _row(both["ours"])
        apart = (_cell(a - b, "+") for a, b in zip(theirs, ours, strict=True))
        rows += [
            [body.name, "theirs", *map(_cell, theirs)],
            ["", "ours", *map(_cell, ours)],
        ]
        rows.append(["", "diff", *apart])
    yield from table(rows, "<<>", 1)
    yield _largest(comparison)
    for found in comparison.findings:
        costs = f" [{found.cost:.3g} N m]" if found.cost > 0 else ""
        yield f"{'✗' if found.serious else '·'} {found.where}: {found.text}{costs}"
        if found.instead:
            yield f"  write {found.instead}"
    yield style(comparison.verdict, fg="green" if comparison.agrees else "red")


def _largest(comparison: Comparison) -> str:
    """The largest differences, and where the tool was measured."""
    words = options.WORDS["compare"]
    tool = comparison.tool
    if tool is None:
        return ""
    return str(words["largest"]).format(
        frame=f"frame {tool.frame}" if tool.frame else words["no_tool"],
        base=tool.base or words["no_base"],
        tip=tool.distance.max() * 1e3,
        median=np.median(tool.distance) * 1e3,
        turned=np.degrees(tool.angle.max()),
        matched=tool.matched_distance.max() * 1e3,
        matched_turned=np.degrees(tool.matched_angle.max()),
        gravity=comparison.gravity_error.max(),
        mass_matrix=comparison.mass_matrix_error,
    )


def _row(side: dict[str, Any]) -> list[float]:
    """Mass [g], COM [mm] and principal moments [kg mm^2] of one side."""
    com = side["com_m"] or [math.nan] * 3
    moments = side["principal_moments_kgm2"]
    return [side["mass_kg"] * 1e3, *(x * 1e3 for x in com), *(x * 1e6 for x in moments)]


def _cell(x: float, sign: str = "") -> str:
    return "-" if math.isnan(x) else f"{x:{sign}z.{2 if abs(x) < 1e4 else 0}f}"
