"""The size of an installation, and whether a page still says it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from checks import install_size

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def empty(tmp_path_factory) -> str:
    """The interpreter of an environment with one made-up package of 2 MB."""
    folder = tmp_path_factory.mktemp("environment")
    make = [sys.executable, "-m", "venv", "--without-pip", str(folder)]
    subprocess.run(make, check=True)
    (packages,) = folder.glob("lib/python*/site-packages")
    (packages / "sand.py").write_bytes(b"#" * 2_000_000)
    metadata = packages / "sand-1.0.dist-info" / "METADATA"
    metadata.parent.mkdir()
    metadata.write_text("Metadata-Version: 2.1\nName: sand\nVersion: 1.0\n")
    return str(folder / "bin" / "python")


def test_an_environment_is_counted_and_weighed(empty):
    packages, megabytes = install_size.measure(empty)
    assert packages == 1
    assert megabytes == pytest.approx(2.0, abs=0.01)


@pytest.mark.parametrize(
    ("text", "status"),
    [
        ("1 packages, 2 MB", 0),
        ("1 packages, 3 MB", 1),
        ("3 packages, 2 MB", 1),
        ("", 1),
    ],
)
def test_a_page_that_is_off_is_seen(empty, tmp_path, text, status, capsys):
    page = tmp_path / "page.md"
    page.write_text(text)
    assert install_size.main([empty, "--page", str(page)]) == status
    assert capsys.readouterr().out.startswith("1 packages, 2 MB\n")


def test_the_pages_agree_with_each_other():
    found = set()
    for page in ("README.md", "docs/start.md"):
        found |= set(install_size.FIGURES.findall((ROOT / page).read_text("utf-8")))
    assert len(found) == 1
