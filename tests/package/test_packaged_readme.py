"""The text that a package index shows leads nowhere that an index does not have."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BUILD = runpy.run_path(str(ROOT / "hatch_readme.py"))
packaged_readme = BUILD["packaged_readme"]

#: What stands in the brackets of a link or a picture, by a scan apart from the hook's.
ADDRESSES = re.compile(r"\]\(([^)]*)\)|src=\"([^\"]*)\"")


def relative(text: str) -> list[str]:
    """Addresses of a page that lead to files beside it."""
    prose = re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE)
    found = ["".join(groups) for groups in ADDRESSES.findall(prose)]
    return [each for each in found if not each.startswith(("https://", "#"))]


def test_the_packaged_readme_names_no_file() -> None:
    text = (ROOT / "README.md").read_text("utf-8")
    assert "scripts/figures/page.png" in relative(text), "README has pictures"
    assert "docs/start.md" in relative(text), "and links"
    packaged = packaged_readme(text)
    assert relative(packaged) == []
    assert "![" not in packaged


def test_all_else_stays() -> None:
    text = (ROOT / "README.md").read_text("utf-8")
    packaged = packaged_readme(text)
    blocks = re.findall(r"^```.*?^```", text, flags=re.DOTALL | re.MULTILINE)
    assert all(block in packaged for block in blocks)
    headings = re.findall(r"^#+ .*$", text, flags=re.MULTILINE)
    assert re.findall(r"^#+ .*$", packaged, flags=re.MULTILINE) == headings
    words = [line for line in text.splitlines() if "](" not in line]
    assert [line for line in words if line not in packaged] == []


@pytest.mark.parametrize(
    ("text", "packaged"),
    [
        ("a\n\n![b](c.png)\n\nd\n", "a\n\nd\n"),
        ("![b](https://c.org/d.png)\n", "![b](https://c.org/d.png)\n"),
        ("[`a/b`](a/b), [c](#c)\n", "`a/b`, [c](#c)\n"),
        ("[a](https://b.org)\n", "[a](https://b.org)\n"),
        ("```sh\nx [a](b)\n```\n[a](b)\n", "```sh\nx [a](b)\n```\na\n"),
    ],
)
def test_one_picture_or_link(text: str, packaged: str) -> None:
    assert packaged_readme(text) == packaged
