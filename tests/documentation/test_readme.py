"""Tables of README and documentation are tables, and links and paths lead to files.

A blank line or a missing cell turns the rest of a table into plain text.
"""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest
from pages import PAGES, REPOSITORY, generated_text

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


def gone(text: str) -> list[str]:
    """Files and folders that a page on the code names, and that are not there.

    Paths begin in the package or at the root; a name without a folder is beside the
    file before it.
    """
    path = r"[\w/.]+(?:\.(?:py|js|h|md|toml|txt|urdf|xacro|yaml)|/)"
    missing = []
    beside = REPOSITORY
    for name in re.findall(f"`({path})`", text):
        for folder in (REPOSITORY / "alpha5_model", REPOSITORY, beside):
            if (folder / name).exists():
                beside = (folder / name).parent
                break
        else:
            missing.append(name)
    return missing


def test_the_architecture_page_names_files_that_exist() -> None:
    page = REPOSITORY / "docs" / "architecture.md"
    assert gone(page.read_text("utf-8")) == []
    assert gone("`cli/torque.py` and `fk.py`, `no.py`, `none/`") == ["no.py", "none/"]


# --- generated tables -----------------------------------------------------------------


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


# --- how to install -------------------------------------------------------------------

PROJECT = tomllib.loads((REPOSITORY / "pyproject.toml").read_text("utf-8"))["project"]
START = (REPOSITORY / "docs" / "start.md").read_text("utf-8")


def names(requirements: list[str]) -> set[str]:
    """Names of packages, without extras and versions."""
    return {re.split(r"[\[<>=!~ ]", text)[0].lower() for text in requirements}


def test_the_steps_for_windows_install_every_requirement() -> None:
    """Pip has no Pinocchio there: it comes from conda-forge."""
    section = START.partition("## Windows")[2].partition("\n## ")[0]
    (conda,) = re.findall(r"^conda create .* (python=.*)$", section, re.MULTILINE)
    (pip,) = re.findall(
        r"^python -m pip install (?!--no-deps)(.*)$", section, re.MULTILINE
    )
    installed = names(conda.split()) | names(pip.split())
    installed = (installed - {"python", "pinocchio"}) | {"pin"}
    assert installed == names(PROJECT["dependencies"])


def test_every_extra_has_its_line() -> None:
    table = START.partition("| extra | for |")[2].partition("\n\n")[0]
    first_cells = re.sub(r"\|[^|\n]*\|$", "|", table, flags=re.MULTILINE)
    listed = set(re.findall(r"`([\w-]+)`", first_cells))
    assert listed == set(PROJECT["optional-dependencies"])
