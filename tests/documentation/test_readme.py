"""Tables of README and documentation are tables, and the errata are the audit's.

A blank line or a missing cell turns the rest of a table into plain text.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from pages import PAGES, REPOSITORY, generated_text
from PIL import Image

import alpha5_model as a5

DELIMITER = re.compile(r"\|(\s*:?-{3,}:?\s*\|)+")


def faults(text: str) -> list[str]:
    """Rows that no Markdown reader shows as part of a table (GitHub's 4.10)."""
    text = re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE)
    wrong = []
    for block in re.findall(r"(?:^\|.*\n)+", text, re.MULTILINE):
        rows = block.splitlines()
        widths = [len(re.findall(r"(?<!\\)\|", row)) for row in rows]
        if len(rows) < 3 or not DELIMITER.fullmatch(rows[1].strip()):
            wrong.append(f"no head above {rows[0][:40]!r}")
        wrong += [
            row[:40] for row, n in zip(rows, widths, strict=True) if n != widths[0]
        ]
    return wrong


@pytest.mark.slow
def test_every_row_stands_in_a_table() -> None:
    texts = {
        page.name: generated_text.written(page.read_text("utf-8")) for page in PAGES
    }
    assert sum(text.count("\n|") for text in texts.values()) > 60
    assert {name: faults(text) for name, text in texts.items() if faults(text)} == {}


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("| a | b |\n|---|---|\n| 1 | 2 |\n\n| 3 | 4 |\n", "no head"),
        ("| a | b |\n|---|---|\n| 1 | 2 | 3 |\n", "| 1 | 2 | 3 |"),
        ("| a | b |\n| 1 | 2 |\n| 3 | 4 |\n", "no head"),
    ],
)
def test_a_broken_table_is_seen(text: str, fault: str) -> None:
    assert fault in faults(text)[0]


def broken(page: Path, text: str) -> list[str]:
    """Links of a page to files that are not there."""
    links = re.findall(
        r"\]\(([^)\s]+)\)", re.sub(r"^```.*?^```", "", text, flags=re.S | re.M)
    )
    files = [link.partition("#")[0] for link in links if ":" not in link]
    return [name for name in files if name and not (page.parent / name).exists()]


def test_every_link_leads_to_a_file() -> None:
    assert {page.name: broken(page, page.read_text("utf-8")) for page in PAGES} == {
        page.name: [] for page in PAGES
    }
    assert broken(PAGES[0], "[a](README.md#x) [b](docs/none.md)") == ["docs/none.md"]


# --- the errata are the audit's -------------------------------------------------------


#: Heading of the audit's rows -> the table of the page that holds them.
TABLES = {
    "error": "errors",
    "reading": "readings",
    "transcription": "transcription",
    "observation": "observations",
    "outside": "outside",
}
#: The tables of the errata that the page shows first.
FIRST = ("motors", "base_frame", "link3_cob", "tori", "two_poses")


def errata(name: str) -> list[tuple[str, str]]:
    """(text, name of claim) of each row in a generated text of the page."""
    tables = re.findall(r"(?:^\|.*\n)+", generated_text.TEXTS[name](), re.MULTILINE)
    heads = [text.partition("\n")[0] for text in tables]
    return [
        (text, claim)
        for text, head in zip(tables, heads, strict=True)
        for claim in claims(head)
    ]


def claims(names: str) -> list[str]:
    """Claims of a cell: the first one whole, the others by what follows the topic."""
    first, *others = re.findall(r"`(.+?)`", names)
    return [first, *(f"{first.partition('.')[0]}.{name}" for name in others)]


def says(text: str, value: float) -> bool:
    """Whether one of the numbers in a text is this one, to the digits that it has."""
    for number in re.findall(r"[-−]?\d+(?:\.\d+)?", text):
        digits = len(number.partition(".")[2])
        if (
            abs(abs(float(number.replace("−", "-"))) - abs(value))
            <= 0.5 * 10**-digits * 1.0001
        ):
            return True
    return False


@pytest.mark.parametrize("name", [*TABLES.values(), *FIRST])
def test_the_errata_are_what_the_audit_measures(name: str) -> None:
    rows = {row.claim: row for row in a5.audit() if row.verdict != "agrees"}
    found = errata(name)
    assert found
    for text, claim in found:
        row = rows[claim]  # it differs no more if it is not here
        figures = [row.measured, row.standard_error]
        figures.append(row.bound if row.bound > 1e-6 else 0.0)
        for figure in figures:
            assert not figure or says(text, figure), (row.claim, figure)
        effect = row.effect or 0.0
        in_micro = 1e6 * effect if "µN·m" in text else effect
        assert not effect or says(text, in_micro), (row.claim, effect)


def test_each_erratum_stands_once_under_its_heading() -> None:
    rows = [row for row in a5.audit() if row.verdict != "agrees"]
    first = [claim for name in FIRST for _, claim in errata(name)]
    assert set(first) <= {row.claim for row in rows}
    for heading, name in TABLES.items():
        under = {r.claim for r in rows if (r.category or r.kind) == heading}
        shown = [claim for _, claim in errata(name)]
        assert sorted(shown) == sorted(under - set(first)), heading


@pytest.mark.parametrize("name", [*TABLES.values(), *FIRST])
def test_an_erratum_says_what_is_printed_measured_used_and_lost(name: str) -> None:
    for text, claim in errata(name):
        lines = [line.split(" | ") for line in text.splitlines()[2:]]
        said = {line[0].removeprefix("| "): line[1] for line in lines}
        parts = ("printed", "we measure", "result", "expected", "we use", "it costs")
        for part in parts:
            assert said[part].removesuffix(" |"), (claim, part)


def test_the_errata_are_sorted_by_their_cost() -> None:
    rows = {row.claim: row for row in a5.audit()}
    for name in TABLES.values():
        units = [rows[claim].effect_unit for _, claim in errata(name)]
        assert units == sorted(units, key=["N m", "mm", "N m/A", ""].index), name
        torques = [rows[claim].effect for _, claim in errata(name)]
        torques = torques[: units.count("N m")]
        assert torques == sorted(torques, reverse=True), name


@pytest.mark.slow
def test_a_page_that_holds_its_tables_is_up_to_date(tmp_path: Path) -> None:
    texts = {page.name: page.read_text("utf-8") for page in PAGES}
    holding = {name: text for name, text in texts.items() if "<!-- end -->" in text}
    assert set(holding) == {"errata.md", "uncertainty.md"}
    for text in holding.values():
        assert generated_text.written(text) == text, (
            "run python docs/_extensions/generated_text.py"
        )
    text = holding["errata.md"]
    copy = tmp_path / "errata.md"
    copy.write_text(text.replace("| result | 40 mm |", "| result | 41 mm |"), "utf-8")
    assert generated_text.update(copy)
    assert copy.read_text("utf-8") == text
    assert not generated_text.update(copy)


def test_a_wrong_figure_would_be_seen() -> None:
    assert says("9.7 ± 0.6 % and −1", 9.675)
    assert says("9.7 ± 0.6 % and −1", -1)
    assert not says("9.7 ± 0.6 % and −1", 9.62)


def test_the_architecture_page_names_files_that_exist() -> None:
    text = (REPOSITORY / "docs" / "architecture.md").read_text("utf-8")
    named = set(re.findall(r"`([\w./]+(?:\.\w+|/))`", text))
    places = [REPOSITORY, REPOSITORY / "alpha5_model"]
    assert len(named) > 40
    assert [
        name for name in sorted(named) if not any((p / name).exists() for p in places)
    ] == []
    assert faults(text) == []


def test_the_first_pictures_are_small_and_move() -> None:
    """The README opens with a page and a drag, which the script of figures makes."""
    text = (REPOSITORY / "README.md").read_text("utf-8")
    assert len(text.splitlines()) < 80
    pictures = re.findall(r"!\[(.+)\]\((.+)\)", text)
    names = [Path(path).name for _, path in pictures]
    assert names == ["page.png", "drag.gif"]
    assert all(len(alternative) > 40 for alternative, _ in pictures)

    script = REPOSITORY / "scripts" / "figures" / "page_figures.py"
    assert all(name in script.read_text("utf-8") for name in names)
    drag = REPOSITORY / pictures[1][1]
    assert drag.stat().st_size < 2e6
    with Image.open(drag) as film:
        frames = []
        for k in range(film.n_frames):
            film.seek(k)
            frames.append(np.asarray(film.convert("RGB")).astype(int))
    moves = np.abs(np.diff(np.array(frames), axis=0)).max(axis=3) > 60
    assert moves.mean(axis=(1, 2)).min() > 1e-3, "each frame moves the arm"
