"""``alpha5 check``: the documents, or a file as ``alpha5 compare`` judges it."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import pytest
from urdf_edits import mass_text, with_mass

import alpha5_model as a5
from alpha5_model.cli import main

OURS = Path(a5.URDF_PATH).read_text("utf-8")
EXAMPLE = Path(__file__).parents[2] / "examples" / "my_arm.toml"


@pytest.mark.slow
def test_a_differing_document_is_not_a_failure(capsys: Any) -> None:
    assert main(["check", "--json"]) == 0
    (key, rows), *others = json.loads(capsys.readouterr().out).items()
    assert (key, others) == ("document", [])
    assert [row["claim"] for row in rows] == [row.claim for row in a5.audit()]
    for row, ours in zip(rows, a5.audit(), strict=True):
        assert row["measured"] == ours.measured
        assert row["verdict"] == ours.verdict
        assert row["category"] == ours.category


@pytest.mark.parametrize(("mass", "status"), [(mass_text(OURS), 0), ("0.5", 1)])
def test_a_file_is_compared(
    mass: str, status: int, tmp_path: Path, capsys: Any
) -> None:
    file = tmp_path / "arm.urdf"
    file.write_text(with_mass(OURS, mass), "utf-8")
    assert main(["compare", str(file)]) == status
    compared = capsys.readouterr().out
    assert main(["check", str(file)]) == status
    assert capsys.readouterr().out == compared
    assert main(["check", str(file), "--json"]) == status
    assert json.loads(capsys.readouterr().out)["agrees"] == (status == 0)


@pytest.mark.slow
def test_a_file_is_compared_with_an_arm_of_ones_own(tmp_path: Path) -> None:
    own = shutil.copy(EXAMPLE, tmp_path)
    file = str(tmp_path / "lab.urdf")
    assert main(["generate", "urdf", "--arm", own, "--output", file]) == 0
    assert main(["check", file, "--arm", own]) == 0
    assert main(["check", file]) == 1


@pytest.mark.parametrize(
    "text",
    [
        OURS[:500],
        "<sdf/>",
        with_mass(OURS, "nan"),
        OURS.replace('<child link="link_3"/>', ""),
        OURS.replace('<link name="link_4">', '<link name="elsewhere">'),
    ],
    ids=["not XML", "not a robot", "NaN", "no child", "a link that is not there"],
)
def test_what_cannot_be_read_is_one_line_and_status_2(
    text: str, tmp_path: Path, capsys: Any
) -> None:
    file = tmp_path / "arm.urdf"
    file.write_text(text, "utf-8")
    assert main(["check", str(file)]) == 2
    captured = capsys.readouterr()
    assert captured.err.count("\n") == 1
    assert captured.out == ""


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (("--arm", str(EXAMPLE)), "arm"),
        (("none.urdf",), "none.urdf"),
    ],
)
def test_wrong_words_are_one_line(
    words: tuple[str, ...], named: str, capsys: Any
) -> None:
    assert main(["check", *words]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert named in line
