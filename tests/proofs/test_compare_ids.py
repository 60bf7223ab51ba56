"""Ids of findings, their explanations, and the report for CI."""

from __future__ import annotations

import dataclasses
import json
import math
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from urdf_edits import OWN, with_mass

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.errors import UnknownNameError
from alpha5_model.proofs.comparison.junit import junit_report
from alpha5_model.proofs.comparison.result import (
    Correction,
    Finding,
    explanation,
    finding_ids,
)

COMPARISON = Path(a5.__file__).parent / "proofs" / "comparison"
#: In the order of the file. Scripts of other people have these: add, rename none.
IDS = Path(__file__).with_name("finding_ids.txt").read_text("utf-8").split()


@pytest.fixture
def heavy(tmp_path: Path) -> Path:
    """A model whose link 2 is too heavy."""
    file = tmp_path / "lab.urdf"
    file.write_text(with_mass(OWN, "0.5"), encoding="utf-8")
    return file


def test_ids_are_those_that_people_use():
    assert list(finding_ids()) == IDS


def test_each_finding_is_explained(capsys):
    assert all(explanation(key) for key in IDS)
    assert main(["compare", "--explain", "body.mass"]) == 0
    assert capsys.readouterr().out.split() == explanation("body.mass").split()


def test_an_unknown_id_names_those_that_there_are(capsys):
    assert main(["compare", "--explain", "body.colour"]) == 2
    error = capsys.readouterr().err
    assert "body.mass" in error
    assert error.count("\n") == 1
    with pytest.raises(UnknownNameError):
        explanation("body")


def test_findings_have_their_id_in_text_and_json(heavy, capsys):
    assert main(["compare", str(heavy)]) == 1
    assert "(body.mass)" in capsys.readouterr().out
    for form in (["--json"], ["--format", "json"]):
        assert main(["compare", str(heavy), *form]) == 1
        found = json.loads(capsys.readouterr().out)["findings"]
        serious = [row["id"] for row in found if row["serious"]]
        assert serious == ["body.mass"]
    assert main(["compare", str(heavy), "--format", "yaml"]) == 2


def report(capsys, *arguments: str, status: int) -> ET.Element:
    assert main(["compare", *arguments, "--format", "junit"]) == status
    (suite,) = ET.fromstring(capsys.readouterr().out.encode())
    cases = suite.findall("testcase")
    assert int(suite.get("tests")) == len(cases)
    assert int(suite.get("failures")) == len(suite.findall("testcase/failure"))
    assert len({case.get("name") for case in cases}) == len(cases)
    return suite


def test_a_report_of_a_model_that_agrees_passes(capsys):
    suite = report(capsys, a5.URDF_PATH, status=0)
    names = [case.get("name") for case in suite]
    assert suite.get("failures") == "0"
    assert {"link_0", "link_4", "axis_e", "axis_b", "tool"} <= set(names)


def test_a_report_is_not_json_as_well(capsys):
    assert main(["compare", str(a5.URDF_PATH), "--format", "junit", "--json"]) == 2
    assert "format: expected json or text with --json" in capsys.readouterr().err


def test_a_report_has_the_findings_as_failures(heavy, capsys):
    suite = report(capsys, str(heavy), status=1)
    assert suite.get("failures") == "1"
    (case,) = [case for case in suite if case.find("failure") is not None]
    assert case.get("name") == "link_2 body.mass"
    failure = case.find("failure")
    assert failure.get("type") == "body.mass"
    assert "0.5 kg in place of 0.38 kg" in failure.get("message")
    assert '<mass value="0.38"/>' in failure.text
    assert "--explain body.mass" in failure.text
    passed = {case.get("name") for case in suite if case is not failure}
    assert "link_1" in passed
    assert "link_2" not in passed
    # Its meshes are not beside the copy: remarks, which fail nothing.
    said = [
        case.findtext("system-out")
        for case in suite
        if case.find("system-out") is not None
    ]
    assert said
    assert all("(file)" in text for text in said)


def test_a_report_of_another_arm_has_one_failure(tmp_path, capsys):
    text = '<robot name="other"><link name="a"/></robot>'
    file = tmp_path / "other.urdf"
    file.write_text(text, encoding="utf-8")
    suite = report(capsys, str(file), status=1)
    (case,) = suite
    assert case.find("failure").get("type") == "another_arm.without_joints"


def test_no_name_breaks_the_report():
    comparison = a5.compare(a5.URDF_PATH)
    hostile = Finding(
        where='link <"&\x00\ud800',
        text="]]> \x1b[31m \ufffe <x>",
        corrections=(Correction("link", "\x0b &amp;", {}),),
        cost=math.inf,
        id="body.mass",
    )
    odd = dataclasses.replace(comparison, findings=(hostile,))
    (suite,) = ET.fromstring(junit_report(odd, "\x07<file>").encode("utf-8"))
    assert suite.get("failures") == "1"
    assert suite.find("testcase/failure").get("message") == "]]> ?[31m ? <x>"
