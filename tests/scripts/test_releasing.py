"""A release is refused until a person has done what only a person can do.

`set_version.py` and `readiness.py` work here on a copy of the files that they touch.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import xml.etree.ElementTree as ET
from datetime import date
from pathlib import Path

import pytest
import yaml
from releasing import readiness, set_version

ROOT = Path(__file__).resolve().parents[2]
RELEASE = ROOT / "scripts" / "releasing" / "release.sh"
DAY = date(2031, 4, 5)
#: A changelog with one change that is not released.
CHANGES = "# Changelog\n\n## [Unreleased]\n\n- Something.\n\n## [0.1.0] - 2026-11-21\n"


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A copy of the files, with a change that waits for its release."""
    for name in (*set_version.VERSIONS, *readiness.INSTALL_TEXTS):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    (tmp_path / "CHANGELOG.md").write_text(CHANGES)
    return tmp_path


def replace(file: Path, old: str, new: str) -> None:
    text = file.read_text("utf-8")
    assert old in text
    file.write_text(text.replace(old, new), "utf-8")


def say_how_to_install(checkout: Path) -> None:
    for name in readiness.INSTALL_TEXTS:
        text = (checkout / name).read_text("utf-8")
        text = readiness.NOT_PUBLISHED.sub("on the package index", text)
        (checkout / name).write_text(text, "utf-8")


def name_a_maintainer(checkout: Path) -> None:
    file = checkout / "package.xml"
    address = ET.parse(file).getroot().find("maintainer").get("email")
    replace(file, address, "someone@alpha5.org")


def test_a_version_is_written_everywhere(checkout: Path) -> None:
    written = set_version.set_version(checkout, "7.8.9", DAY)
    assert set(written) == {*set_version.VERSIONS, "CHANGELOG.md"}
    cited = yaml.safe_load((checkout / "CITATION.cff").read_text("utf-8"))
    assert (cited["version"], cited["date-released"]) == ("7.8.9", DAY)
    package = ET.parse(checkout / "package.xml").getroot()
    assert package.find("version").text == "7.8.9"
    names: dict[str, str] = {}
    source = (checkout / "alpha5_model/__init__.py").read_text("utf-8")
    exec(re.search(r"^__version__ = .*$", source, re.M)[0], names)
    assert names["__version__"] == "7.8.9"
    assert (checkout / "CHANGELOG.md").read_text() == CHANGES.replace(
        "- Something.", "## [7.8.9] - 2031-04-05\n\n- Something."
    )


@pytest.mark.parametrize("version", ["1.0", "v1.0.0", "1.0.0rc1", "0.1.0"])
def test_a_bad_version_changes_no_file(checkout: Path, version: str) -> None:
    before = {file: file.read_bytes() for file in checkout.rglob("*.*")}
    with pytest.raises(ValueError, match=r"expected a version|section"):
        set_version.set_version(checkout, version, DAY)
    assert {file: file.read_bytes() for file in checkout.rglob("*.*")} == before


def test_a_release_without_changes_is_refused(checkout: Path) -> None:
    set_version.set_version(checkout, "7.8.9", DAY)
    with pytest.raises(ValueError, match="nothing under"):
        set_version.set_version(checkout, "7.9.0", DAY)


def test_a_file_without_a_version_is_named(checkout: Path) -> None:
    replace(checkout / "package.xml", "<version>", "<edition>")
    with pytest.raises(ValueError, match=r"package\.xml: expected one place"):
        set_version.set_version(checkout, "7.8.9", DAY)


def test_nothing_is_left_when_a_person_has_done_it(checkout: Path) -> None:
    set_version.set_version(checkout, "7.8.9", DAY)
    say_how_to_install(checkout)
    name_a_maintainer(checkout)
    assert list(readiness.obstacles(checkout)) == []


@pytest.mark.parametrize(
    ("file", "old", "new", "said"),
    [
        ("package.xml", "alpha5.org", "alpha5.INVALID", "reaches nobody"),
        ("package.xml", "7.8.9", "7.8.8", "package.xml has 7.8.8"),
        ("CITATION.cff", "7.8.9", "7.8.8", "CITATION.cff has 7.8.8"),
        ("CITATION.cff", "2031-04-05", "2031-04-06", "2031-04-06"),
        ("CHANGELOG.md", "[Unreleased]\n", "[Unreleased]\n- One.\n", "1 changes"),
        ("README.md", "## Install", "It is on no package index yet.", "README.md"),
    ],
)
def test_each_obstacle_is_named(
    checkout: Path, file: str, old: str, new: str, said: str
) -> None:
    set_version.set_version(checkout, "7.8.9", DAY)
    say_how_to_install(checkout)
    name_a_maintainer(checkout)
    replace(checkout / file, old, new)
    (found,) = readiness.obstacles(checkout)
    assert said in found


def test_release_asks_before_it_builds() -> None:
    text = RELEASE.read_text("utf-8")
    assert text.index("readiness.py") < text.index("-m build")


def test_the_steps_name_what_is_there() -> None:
    told = subprocess.run(
        ["bash", str(RELEASE), "--steps"], check=True, capture_output=True, text=True
    ).stdout
    numbers = [int(n) for n in re.findall(r"(?m)^ *(\d+)\. ", told)]
    assert numbers == list(range(1, len(numbers) + 1))
    files = re.findall(r"[\w./]+\.(?:py|sh|yml|toml|xml|md|cff)\b", told)
    ours = set(files)
    assert {"package.xml", "scripts/releasing/set_version.py"} <= ours
    assert [name for name in ours if not (ROOT / name).exists()] == []
