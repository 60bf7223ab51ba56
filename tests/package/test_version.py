"""One version, the same everywhere that it is written."""

from __future__ import annotations

import re
import tomllib
from importlib import metadata
from pathlib import Path

import pytest

import alpha5_model as a5

ROOT = Path(__file__).resolve().parents[2]


def test_it_is_written_once() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    assert "version" in project["project"]["dynamic"]
    assert "version" not in project["project"]
    assert project["tool"]["hatch"]["version"]["path"] == "alpha5_model/__init__.py"
    source = (ROOT / "alpha5_model" / "__init__.py").read_text("utf-8")
    assert re.findall(r'^__version__ = "(.+)"$', source, re.M) == [a5.__version__]
    assert re.fullmatch(r"\d+\.\d+\.\d+", a5.__version__)


def test_citation_agrees() -> None:
    text = (ROOT / "CITATION.cff").read_text("utf-8")
    assert re.findall(r'^version: "?([^"\n]+)"?$', text, re.M) == [a5.__version__]


def test_changelog_agrees() -> None:
    text = (ROOT / "CHANGELOG.md").read_text("utf-8")
    releases = re.findall(r"^## \[?(\d+\.\d+\.\d+)\]?", text, re.M)
    assert releases[0] == a5.__version__


def test_generated_files_agree() -> None:
    for name in ("alpha5.urdf", "alpha5_jaws.urdf"):
        text = (ROOT / "urdf" / name).read_text("utf-8")
        assert re.findall(r"alpha5_model (\d+\.\d+\.\d+)", text) == [a5.__version__]


def test_the_installed_package_agrees() -> None:
    try:
        installed = metadata.version("alpha5-model")
    except metadata.PackageNotFoundError:
        pytest.skip("runs from a checkout that is not installed")
    assert installed == a5.__version__
