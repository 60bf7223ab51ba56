"""The errata: a table for each row of the audit that differs.

Rows with the same words and figures stand in one table. Each table says what is
printed, what follows from it, what this package uses, and what it costs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby

from markdown_tables import plain, table

import alpha5_model as a5
from alpha5_model.cli.audit_text import heading
from alpha5_model.numbers.corrections import CORRECTIONS
from alpha5_model.proofs.audit.row import AuditRow

#: Rows that say the same.
Group = Sequence[AuditRow]

#: The errata that matter most: name of the generated text -> rows of the audit.
FIRST = {
    "motors": ("friction.actuator_0", "motor_constants.actuator_3"),
    "base_frame": ("base_frame.link_0",),
    "link3_cob": ("cob_inside.link_3",),
    "tori": ("workspace.downward_centre", "workspace.self_collision"),
    "two_poses": ("inverse_kinematics.branches", "inverse_kinematics.wrapping"),
}
#: Where the page shows them.
FIRST_PLACE = "#the-five-that-matter"
#: Units of what a difference costs, the first first.
COSTS = ("N m", "mm", "N m/A", "")
#: Torques below this are shown in µN·m [N m].
SMALL_TORQUE = 1e-3
RELATION = {"=": "", "<=": "at most ", ">=": "at least "}


def first_errata(name: str) -> str:
    """The tables of an entry of `FIRST`."""
    return "\n".join(map(erratum, first_groups(name)))


def other_errata(of: str) -> str:
    """The tables under a heading of `heading`, by their cost, without the first ones.

    A line at the end names the rows that are shown first.
    """
    shown = [group for name in FIRST for group in first_groups(name)]
    under = [group for group in groups() if heading(group[0]) == of]
    others = sorted((group for group in under if group not in shown), key=by_cost)
    text = "\n".join(map(erratum, others))
    names = ", ".join(names_of(group) for group in shown if group in under)
    if names:
        text += f"\n[Shown above]({FIRST_PLACE}): {names}.\n"
    return text


def first_groups(name: str) -> list[Group]:
    """The groups of an entry of `FIRST`, in its order."""
    by_claim = {row.claim: group for group in groups() for row in group}
    return [by_claim[claim] for claim in FIRST[name]]


def groups() -> list[Group]:
    """The rows that differ; neighbours with the same words and figures in one group."""
    rows = [row for row in a5.audit() if row.verdict != "agrees"]
    return [
        list(same)
        for _, same in groupby(rows, lambda r: (r.topic, r.says, r.measured, r.effect))
    ]


def by_cost(group: Group) -> tuple[int, float]:
    """Torques first, then lengths; the largest first."""
    row = group[0]
    return COSTS.index(row.effect_unit), -(row.effect or 0.0)


def erratum(group: Group) -> str:
    """The table of a group: its names, its place, and what it says."""
    lines = [("where", place_of(group)), *lines_of(group[0])]
    return table(["row", names_of(group)], lines)


def names_of(group: Group) -> str:
    """The claims of a group: the first one whole, the others by their subjects."""
    subjects = [row.claim.partition(".")[2] for row in group[1:]]
    return ", ".join(f"`{name}`" for name in (group[0].claim, *subjects))


def place_of(group: Group) -> str:
    """Where the claims of a group are printed."""
    first, *others = dict.fromkeys(row.place for row in group)
    return first + "".join(f"; {shorter(first, other)}" for other in others)


def lines_of(row: AuditRow) -> Iterator[tuple[str, str]]:
    """What a row says, with what it is."""
    yield "printed", plain(row.says)
    yield "we measure", plain(units(row.measures))
    yield "result", f"{figure(row.measured)} {units(row.unit)}".strip()
    yield "expected", expected(row)
    if row.bound:
        yield "tolerance", f"± {figure(row.bound, 2)} {units(row.unit)}".strip()
    if row.finding:
        yield "what follows", plain(units(row.finding))
    yield "we use", plain(row.used)
    if row.effect is not None:
        yield "it costs", cost(row.effect, row)


def expected(row: AuditRow) -> str:
    """The expected figure with its relation and unit."""
    return f"{RELATION[row.relation]}{figure(row.expected)} {units(row.unit)}".strip()


def cost(effect: float, row: AuditRow) -> str:
    """What a difference costs."""
    words = plain(units(row.cost))
    if row.effect_unit == "N m" and effect < SMALL_TORQUE:
        return f"{figure(1e6 * effect)} µN·m: {words}"
    return f"{figure(effect)} {units(row.effect_unit)}: {words}"


def shorter(first: str, place: str) -> str:
    """What a place says beyond the parts that it shares with the first one."""
    parts, ours = place.split(", "), first.split(", ")
    while len(parts) > 1 and ours and parts[0] == ours[0]:
        parts, ours = parts[1:], ours[1:]
    return ", ".join(parts)


def figure(value: float, digits: int = 4) -> str:
    """A number to so many significant digits, without an exponent."""
    text = f"{value:.{digits}g}"
    return f"{value:.0f}" if "e" in text else text


def units(text: str) -> str:
    """A text with its units as a reader writes them."""
    return text.replace("kg mm^2", "kg·mm²").replace("N m", "N·m")


def corrections() -> str:
    """A table for each recorded correction: what it does, why, and its effect."""
    tables = (
        table(
            ["name", f"`{correction.name}`"],
            [
                ("what it does", plain(correction.statement)),
                ("evidence", plain(correction.evidence)),
                ("effect", plain(correction.effect)),
            ],
        )
        for correction in CORRECTIONS.values()
    )
    return "\n".join(tables)
