"""Ids of findings, their explanations, and the report for CI."""

from __future__ import annotations

import dataclasses
import json
import math
import xml.etree.ElementTree as ET
from pathlib import Path

import known_mistakes
import model_defects
import model_edits as edits
import numpy as np
import pytest
from compared_models import compared, ids
from urdf_edits import OWN, mass_text, with_mass

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
    assert IDS[0] in error
    assert IDS[-1] in error
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


def test_a_report_has_the_findings_as_failures(heavy, capsys):
    suite = report(capsys, str(heavy), status=1)
    assert suite.get("failures") == "1"
    (case,) = [case for case in suite if case.find("failure") is not None]
    assert case.get("name") == "link_2 body.mass"
    failure = case.find("failure")
    assert failure.get("type") == "body.mass"
    printed = mass_text(OWN)
    assert f"0.5 kg in place of {printed} kg" in failure.get("message")
    assert f'<mass value="{printed}"/>' in failure.text
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


#: The words that all dimensions share, and what remains if no other finding explains a
#: joint, which no known model has.
WITHOUT_EXAMPLE = {"dimension", "misplaced"}


def with_few_digits(root: ET.Element) -> None:
    model_defects.put("axis_c", xyz="0.151 0 0")(root)
    model_defects.put("axis_d", xyz="0.02 0 0.046")(root)


def unsure_of_its_base(root: ET.Element) -> None:
    model_defects.turn("axis_e", 0.0, 0.0, 0.02)(root)
    origin = root.find("link[@name='link_0']/inertial/origin")
    off = np.add(model_defects.vector(origin.get("xyz")), [0.0, 0.0, 0.002])
    origin.set("xyz", model_defects.written(off))


def about_x(root: ET.Element) -> None:
    root.find("joint[@name='axis_c']/axis").set("xyz", "1 0 0")


def twisted(root: ET.Element) -> None:
    model_defects.turn("axis_d", 0.0, 0.05, 0.0)(root)
    model_defects.turn("axis_d", 0.03, 0.0, 0.0)(root)


def endless(root: ET.Element) -> None:
    joint = root.find("joint[@name='axis_b']")
    joint.remove(joint.find("limit"))
    joint.set("type", "continuous")


def without_link_0(root: ET.Element) -> None:
    model_defects.inertial("link_0", "mass", value="11.5")(root)


def without_a_base(root: ET.Element) -> None:
    model_defects.without("link_0", "inertial")(root)
    for name, new in (("base_link", "platform"), ("link_0", "turret")):
        root.find(f"link[@name='{name}']").set("name", new)
        for end in root.iter():
            if end.get("link") == name:
                end.set("link", new)
    model_defects.shift("axis_e", 0.1, 0.2, -0.1)(root)
    model_defects.turn("axis_e", 0.0, 0.0, 0.01)(root)


def with_a_mesh(root: ET.Element) -> None:
    shape = ET.SubElement(root.find("link[@name='link_2']"), "collision")
    mesh = ET.SubElement(ET.SubElement(shape, "geometry"), "mesh")
    mesh.set("filename", "lost.stl")


def in_millimetres(root: ET.Element) -> None:
    for origin in root.findall("joint/origin"):
        numbers = model_defects.vector(origin.get("xyz"))
        origin.set("xyz", model_defects.written(1e3 * numbers))


EXAMPLES = [
    *model_defects.DEFECTS.values(),
    *known_mistakes.DEFECTS,
    model_defects.turn("link_0_fixed", 0.0, 0.0, 0.3),
    with_few_digits,
    unsure_of_its_base,
    about_x,
    model_defects.shift("axis_c", 0.2, 0.1, 0.0),
    twisted,
    endless,
    without_link_0,
    without_a_base,
    with_a_mesh,
    in_millimetres,
    model_defects.put("axis_c", rpy="180 0 74.6"),
    model_defects.put("axis_c", xyz="15.07 0 0"),
    model_defects.inertial("link_3", "mass", value="0"),
    model_defects.limits("axis_e", velocity=5.0, effort=20.0),
    model_defects.inertial("link_3", "inertia", ixx="1.0", iyy="0.1", izz="0.2"),
]


@pytest.mark.slow
def test_every_finding_has_an_example():
    """Those of `lint` have theirs in test_lint, of jaws in test_compare_advice."""
    shown = set()
    for change in EXAMPLES:
        root = ET.fromstring(OWN)
        change(root)
        shown |= set(ids(compared(root, samples=3)))
    for text in ('<robot name="x"><link name="a"/></robot>', edits.with_vehicle(25, 2)):
        shown |= set(ids(compared(text, samples=3)))
    root = ET.fromstring(OWN)
    root.find("joint[@name='axis_c']").set("type", "fixed")
    shown |= set(ids(compared(root, samples=3)))
    elsewhere = ("lint", "jaws")
    asked = {key for key in finding_ids() if not key.startswith(elsewhere)}
    assert shown >= asked - WITHOUT_EXAMPLE, asked - shown
