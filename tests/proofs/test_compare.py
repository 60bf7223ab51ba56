"""`alpha5 compare` finds each known defect of public models in a copy of our URDF."""

from __future__ import annotations

import json
import math
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import reference
from compared_models import compared
from hypothesis import given, settings
from hypothesis import strategies as st
from known_mistakes import (
    DEFECTS,
    Defect,
    too_much_water,
    wrong_side,
)
from urdf_edits import OWN, with_mass

import alpha5_model as a5
from alpha5_model._support.paths import JAWS_URDF_PATH
from alpha5_model.cli import main
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.errors import (
    Alpha5Error,
    FileFormatError,
    InputError,
    UnknownNameError,
)


def inject(*defects: Defect):
    root = ET.fromstring(OWN)
    for defect in defects:
        defect(root)
    return compared(root)


def found(comparison, defect: Defect) -> bool:
    where, words = DEFECTS[defect]
    return any(f.where == where and words in f.text for f in comparison.findings)


@pytest.mark.parametrize("defect", DEFECTS, ids=lambda d: d.__name__)
def test_each_defect_is_found_and_named(defect):
    comparison = inject(defect)
    assert found(comparison, defect), comparison.findings
    assert comparison.agrees == (
        defect is too_much_water
    )  # the URDF itself still computes right


@pytest.mark.parametrize("path", [a5.URDF_PATH, JAWS_URDF_PATH])
def test_our_own_files_have_no_findings(path):
    comparison = a5.compare(path, samples=50)
    assert comparison.findings == ()
    assert comparison.agrees
    assert comparison.tip_error < 1e-12
    assert comparison.gravity_error.max() < 1e-12


@pytest.mark.parametrize(
    "variant",
    [
        Variant(
            prefix="left_", parent="vehicle", xyz=(0.3, -0.1, 0.2), rpy=(0.1, -0.4, 2.0)
        ),
        Variant(parent="vehicle", rpy=(math.pi, 0.0, 0.0), dh_frames=True),
    ],
)
def test_a_mounted_arm_differs_by_its_mount_only(variant):
    comparison = compared(urdf(variant), samples=20)
    assert [finding.where for finding in comparison.findings] == ["base"]
    assert comparison.agrees
    assert comparison.tip_error < 1e-12
    assert comparison.gravity_error.max() < 1e-12
    assert comparison.mass_matrix_error < 1e-12


def test_the_base_after_the_rotation_pi_is_recognised():
    comparison = compared(urdf(Variant(corrections=())))
    assert {finding.where for finding in comparison.findings} == {"link_0"}
    assert (
        sum("turned by pi about z" in finding.text for finding in comparison.findings)
        == 2
    )


def test_shifted_zeros_and_signs_are_measured():
    root = ET.fromstring(OWN)
    root.find("joint[@name='axis_d']/origin").set("rpy", "1.5707963267948966 1.5 0.0")
    root.find("joint[@name='axis_c']/axis").set("xyz", "0 0 -1")
    alignment = compared(root, samples=5).alignment
    np.testing.assert_array_equal(alignment.sign, [1, 1, -1, 1])
    np.testing.assert_allclose(
        alignment.zero, [0, 1.5 - 1.3021582029078473, 0, 0], atol=1e-12
    )


@pytest.mark.parametrize("side", [1, -1])
def test_a_mimic_beyond_a_limit_of_zero_is_measured(side):
    """At its lower limit the rod takes the finger to 51 * 0.0013 - 0.1 rad, or back.

    With another mass and another place the finger is not ours.
    """
    text = with_mass(Path(JAWS_URDF_PATH).read_text(), "0.05", "finger_1")
    if side > 0:
        text = text.replace('offset="-0.0663"', 'offset="-0.1"', 1)
    else:
        text = text.replace('"51.0" offset="-0.0663"', '"-51.0" offset="0.1"', 1)
        text = text.replace(
            'lower="0.0" upper="0.612"', 'lower="-0.612" upper="0.0"', 1
        )
    findings = compared(text, samples=5).findings
    (found,) = (f for f in findings if "mimics" in f.text)
    assert (found.where, found.text) == (
        "finger_1_joint",
        "mimics axis_a 0.0337 beyond its own limit",
    )


def test_dynamic_errors_equal_pinocchio_on_the_files():
    """Second route: Pinocchio parses both files; the seeded samples are drawn again."""
    root = ET.fromstring(OWN)
    wrong_side(root)
    text = ET.tostring(root, encoding="unicode")
    models = [pin.buildModelFromXML(source) for source in (OWN, text)]
    data = [model.createData() for model in models]
    gravity, matrix = np.zeros(4), 0.0
    for q in np.random.default_rng(0).uniform(
        reference.LOWER, reference.UPPER, (40, 4)
    ):
        g = [
            pin.computeGeneralizedGravity(m, d, q)
            for m, d in zip(models, data, strict=True)
        ]
        M = [pin.crba(m, d, q) for m, d in zip(models, data, strict=True)]
        gravity = np.maximum(gravity, np.abs(g[0] - g[1]))
        matrix = max(matrix, np.abs(M[0] - M[1]).max())
    comparison = compared(text, samples=40)
    np.testing.assert_allclose(comparison.gravity_error, gravity, atol=1e-12)
    assert comparison.mass_matrix_error == pytest.approx(matrix, abs=1e-12)


def test_joints_are_mapped_by_name_prefix_order_or_hand():
    renamed = OWN
    for i, axis in enumerate(("axis_e", "axis_d", "axis_c", "axis_b")):
        renamed = renamed.replace(f'"{axis}"', f'"joint{i}"')
    found = compared(renamed).joints
    assert [*found.values()] == ["joint0", "joint1", "joint2", "joint3"]
    jaws = Path(JAWS_URDF_PATH).read_text().replace('"axis_d"', '"shoulder"')
    for names in (None, {"axis_d": "shoulder"}):
        assert compared(jaws, joints=names).joints["axis_d"] == "shoulder"
    with pytest.raises(UnknownNameError, match="choose from link_0_fixed"):
        compared(renamed, joints={"axis_e": "waist"})
    with pytest.raises(InputError, match="map"):
        compared(OWN, joints={"axis_e": "axis_d"})
    with pytest.raises(InputError, match="map"):
        compared(OWN, joints={"axis_e": "axis_d", "axis_d": "axis_e"})


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "not XML"),
        ("not xml", "line 1: not XML"),
        ("<robot>\n<link name='a'>\n</robot>", "line 3: not XML: mismatched tag"),
        ("<sdf/>", "expected <robot>, got <sdf>"),
        ("<robot/>", "there is no <link>"),
        ("<robot><link/></robot>", "<link> has no attribute 'name'"),
        (
            "<robot><link name='a'/>\n<link name='a'/></robot>",
            "line 2: link 'a' is there twice",
        ),
        ("<robot><link name='a'/><link name='b'/></robot>", "2 root links: a, b"),
        (
            with_mass(OWN, "heavy"),
            "expected a finite number, got 'heavy'",
        ),
        (
            with_mass(OWN, "nan"),
            "expected a finite number, got 'nan'",
        ),
        (
            OWN.replace('ixx="8.2697e-05"', 'ixx="abc"'),
            "<inertia ixx>: expected a finite number",
        ),
        (
            OWN.replace('<child link="link_2"/>', '<child link="limb"/>'),
            "no link 'limb'",
        ),
        (
            OWN.replace('<child link="link_2"/>', '<child link="link_1"/>'),
            "has two parents",
        ),
        (
            OWN.replace('<parent link="link_0"/>', '<parent link="tcp"/>'),
            "2 root links|a loop",
        ),
        (
            OWN.replace('axis xyz="0 0 1"', 'axis xyz="0 0 0"'),
            "the axis has no direction",
        ),
        (OWN.replace('type="revolute"', 'type="hinge"'), "unknown type 'hinge'"),
    ],
)
def test_broken_files_say_where(text, words, tmp_path, capsys):
    path = tmp_path / "other.urdf"
    path.write_text(text)
    with pytest.raises(FileFormatError, match=words):
        a5.compare(path)
    assert main(["compare", str(path)]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


def test_command_line(tmp_path, capsys):
    assert main(["compare", a5.URDF_PATH, "--samples", "5"]) == 0
    assert "agrees" in capsys.readouterr().out
    path, picture = tmp_path / "other.urdf", tmp_path / "errors.png"
    path.write_text(with_mass(OWN, "0.5"))
    assert main(["compare", str(path), "--json", "--plot", str(picture)]) == 1
    content = json.loads(capsys.readouterr().out)
    assert content["agrees"] is False
    assert content["bodies"][2]["mass_error_kg"] == pytest.approx(
        0.5 - a5.parameters().links[2].mass
    )
    (remark,) = [f for f in content["findings"] if f["id"] == "file"]
    assert "../meshes/link_0.obj" in remark["text"]
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nowhere.urdf"], "no such file"),
        ([a5.URDF_PATH, "--map", "axis_e"], "axis_e=NAME"),
        ([a5.URDF_PATH, "--map", "axis_q=axis_e"], "choose from axis_e, axis_d"),
        ([a5.URDF_PATH, "--map", "axis_e=knee"], "unknown joint of the other model"),
        ([a5.URDF_PATH, "--map", "axis_e=axis_b"], "four different joints"),
        ([a5.URDF_PATH, "--map", "axis_e=tcp_fixed"], "a revolute joint"),
        ([a5.URDF_PATH, "--samples", "99999999999"], "--samples"),
        ([a5.URDF_PATH, "--plot", "errors.txt"], "choose from .png, .pdf, .svg"),
    ],
)
def test_wrong_input_is_one_line_and_status_2(arguments, words, capsys):
    assert main(["compare", *arguments]) == 2
    err = capsys.readouterr().err
    assert words in err
    assert len(err.splitlines()) == 1


TOKENS = st.sampled_from(
    [
        "0",
        "-1",
        "1e308",
        "1e-320",
        "nan",
        "inf",
        "",
        "a b",
        "link_0",
        "axis_e",
        "fixed",
        "0 0 0",
    ]
)


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_fuzzed_files_end_in_a_comparison_or_our_own_error(data):
    root = ET.fromstring(OWN)
    elements = list(root.iter())
    parents = {child: parent for parent in elements for child in parent}
    for _ in range(data.draw(st.integers(1, 4))):
        element = elements[data.draw(st.integers(0, len(elements) - 1))]
        action = data.draw(st.sampled_from(["attribute", "remove", "tag", "double"]))
        if action == "attribute" and element.attrib:
            element.set(
                data.draw(st.sampled_from(sorted(element.attrib))), data.draw(TOKENS)
            )
        elif action == "tag":
            element.tag = data.draw(
                st.sampled_from(["link", "joint", "origin", "nonsense"])
            )
        elif (
            action == "remove"
            and element in parents
            and element in list(parents[element])
        ):
            parents[element].remove(element)
        elif action == "double" and element in parents:
            parents[element].append(element)
    text = ET.tostring(root)
    cut = data.draw(st.integers(0, len(text)))
    for source in (text, text[:cut]):
        message = ""
        try:
            compared(source, samples=2)
        except Alpha5Error as error:
            message = str(error)
        assert len(message.splitlines()) <= 1


def test_a_picture_without_matplotlib_is_one_clear_line(
    monkeypatch, capsys, tmp_path
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    path = tmp_path / "errors.png"
    assert main(["compare", a5.URDF_PATH, "--plot", str(path)]) == 2
    assert "pip install 'alpha5-model[plot]'" in capsys.readouterr().err
    assert not path.exists()
