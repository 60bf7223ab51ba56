"""`compare` on whole files: the cost of a wrong body, the advice, and both sides."""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
import reference
from urdf_edits import OWN

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.description.reading import parse_urdf
from alpha5_model.numbers.parameters import parameters
from alpha5_model.proofs.comparison.axis_findings import _misplaced
from alpha5_model.proofs.comparison.body_findings import BodyCase, findings_of_body
from alpha5_model.proofs.comparison.body_replacement import Replacement
from alpha5_model.proofs.comparison.correction import JointCorrection
from alpha5_model.proofs.comparison.hypotheses import hypotheses_of
from alpha5_model.proofs.comparison.measure import compare_robots
from alpha5_model.proofs.comparison.own_arm import own_arm_of
from alpha5_model.proofs.comparison.records import Finding

MASS_2 = a5.parameters().links[2].mass

SAMPLES = 40


def inertial(root: ET.Element, link: str) -> ET.Element:
    return root.find(f"link[@name='{link}']/inertial")


def edited(
    *edits: tuple[str, str, dict[str, str]], root: ET.Element | None = None
) -> ET.Element:
    """Our URDF with attributes of inertials set.

    Each edit is a link, one of "mass", "origin" and "inertia", and its attributes.
    """
    root = ET.fromstring(OWN) if root is None else root
    for link, tag, attributes in edits:
        inertial(root, link).find(tag).attrib.update(attributes)
    return root


def compared(root: ET.Element, samples: int = SAMPLES):
    return compare_robots(parse_urdf(ET.tostring(root)), samples=samples)


def found(comparison, link: str, words: str):
    """The one finding of a body that has these words."""
    (one,) = [f for f in comparison.findings if f.where == link and words in f.text]
    return one


HEAVY = ("link_2", "mass", {"value": "0.5"})
ASIDE = ("link_3", "origin", {"xyz": "0.011188 -0.046 0.000148"})
OTHER_SIDE = ("link_4", "origin", {"xyz": "-3e-05 -0.001482 0.100881"})
ROUND = ("link_4", "inertia", {"ixx": "0.0013", "iyy": "0.0013", "izz": "0.00036"})


def gravity_difference(root: ET.Element) -> float:
    """Second route: Pinocchio parses both files.

    The seeded positions are drawn again.
    """
    texts = (OWN, ET.tostring(root, encoding="unicode"))
    models = [pin.buildModelFromXML(text) for text in texts]
    q = np.random.default_rng(0).uniform(reference.LOWER, reference.UPPER, (SAMPLES, 4))
    torques = [
        [pin.computeGeneralizedGravity(model, model.createData(), row) for row in q]
        for model in models
    ]
    return float(np.abs(np.subtract(*torques)).max())


@pytest.mark.parametrize(
    ("edit", "words"),
    [(HEAVY, "mass"), (ASIDE, "COM"), (OTHER_SIDE, "COM")],
    ids=str,
)
def test_a_finding_costs_what_it_alone_changes_in_the_torque(edit, words):
    alone = gravity_difference(edited(edit))
    assert alone > 0.01
    for edits in ([edit], [HEAVY, ASIDE, OTHER_SIDE, ROUND]):
        cost = found(compared(edited(*edits)), edit[0], words + " ").cost
        assert cost == pytest.approx(alone, rel=1e-9)


def test_a_wrong_mass_and_com_of_one_body_cost_each_their_own():
    mass, com = ("link_3", "mass", {"value": "0.3"}), ASIDE
    both = compared(edited(mass, com))
    for edit, words in ((mass, "mass "), (com, "COM ")):
        expected = gravity_difference(edited(edit))
        assert found(both, "link_3", words).cost == pytest.approx(expected, rel=1e-9)


def test_what_no_joint_carries_costs_nothing():
    base = compared(edited(("link_0", "mass", {"value": "0.9"})))
    assert found(base, "link_0", "mass").cost == 0.0
    assert found(compared(edited(ROUND)), "link_4", "inertia").cost == 0.0


def test_findings_come_in_the_order_of_their_cost():
    comparison = compared(
        edited(HEAVY, ASIDE, OTHER_SIDE, ROUND, ("link_0", "mass", {"value": "0.9"}))
    )
    costs = [f.cost for f in comparison.findings]
    assert costs == sorted(costs, reverse=True)
    assert [f.where for f in comparison.findings[:3]] == ["link_4", "link_2", "link_3"]
    free = [f for f in comparison.findings if f.cost == 0]
    assert [f.serious for f in free] == sorted((f.serious for f in free), reverse=True)
    wheres = [f.where for f in free if f.serious]
    assert wheres == sorted(wheres)
    assert {"link_0", "link_3", "link_4"} == set(wheres)


# --------------------------------------------------------------- what to write instead


def write_instead(root: ET.Element, finding) -> None:
    """Follow a finding: write one element of one link, and empty the links it names."""
    pattern = r"(\S+): ((?:<[^>]+/> ?)+)(?:\(nothing in (.+)\))?"
    link, elements, empty = re.fullmatch(pattern, finding.instead).groups()
    node = root.find(f"link[@name='{link}']")
    body = node.find("inertial")
    body = ET.SubElement(node, "inertial") if body is None else body
    for element in ET.fromstring(f"<x>{elements}</x>"):
        for old in body.findall(element.tag):
            body.remove(old)
        body.append(element)
    for name in (empty or "").split(", ") if empty else ():
        other = root.find(f"link[@name='{name}']")
        for old in other.findall("inertial"):
            other.remove(old)


def test_what_to_write_instead_mends_the_file():
    root = edited(HEAVY, ASIDE, OTHER_SIDE, ROUND)
    comparison = compared(root)
    for finding in comparison.findings:
        if finding.instead:
            write_instead(root, finding)
    assert compared(root).findings == ()


def test_what_to_write_instead_is_in_the_frame_of_the_other_models_link():
    root = edited()
    node = root.find("link[@name='link_3']")
    node.remove(node.find("inertial"))
    for name, mass in (("shell", "0.2"), ("motor", "0.1")):
        part = ET.SubElement(root, "link", name=name)
        body = ET.SubElement(part, "inertial")
        ET.SubElement(body, "origin", xyz="0.01 0.02 0.03", rpy="0.3 0.2 0.1")
        ET.SubElement(body, "mass", value=mass)
        ET.SubElement(
            body,
            "inertia",
            ixx="1e-4",
            iyy="2e-4",
            izz="2e-4",
            ixy="0",
            ixz="0",
            iyz="0",
        )
        joint = ET.SubElement(root, "joint", name=f"{name}_fixed", type="fixed")
        ET.SubElement(joint, "origin", xyz="0.02 -0.01 0.005", rpy="0.7 -0.4 1.9")
        ET.SubElement(joint, "parent", link="link_3")
        ET.SubElement(joint, "child", link=name)
    wrong = [f for f in compared(root).findings if f.instead]
    assert len(wrong) == 3
    for finding in wrong:
        assert finding.instead.startswith("shell: <")
        assert finding.instead.endswith("/> (nothing in motor)")
        for element in re.findall("<[^>]+>", finding.instead):
            step = (
                1e-6 if element.startswith("<origin") else 1e-9
            )  # the digits of Table 2
            for quoted in re.findall('"([^"]+)"', element):
                steps = np.array(quoted.split(), float) / step
                np.testing.assert_allclose(steps, np.round(steps), atol=1e-4)
        write_instead(root, finding)
    after = compared(root)
    assert [f.text for f in after.findings if f.serious] == []
    np.testing.assert_allclose(
        after.bodies[3].com, np.array(reference.COM[3]) / 1e3, atol=1e-6
    )


def test_a_part_without_an_inertial_is_named_whatever_its_name():
    for name in ("a_shell", "z_shell"):
        root = edited()
        ET.SubElement(root, "link", name=name)
        joint = ET.SubElement(root, "joint", name=f"{name}_fixed", type="fixed")
        ET.SubElement(joint, "parent", link="link_3")
        ET.SubElement(joint, "child", link=name)
        assert f"no <inertial> in {name}" in " ".join(
            f.text for f in compared(root).findings
        )


def test_a_missing_inertial_is_given_whole():
    root = edited()
    node = root.find("link[@name='link_2']")
    node.remove(node.find("inertial"))
    comparison = compared(root)
    finding = found(comparison, "link_2", "no <inertial> in link_2")
    assert finding.serious
    light = gravity_difference(edited(("link_2", "mass", {"value": "1e-9"})))
    assert finding.cost == pytest.approx(light, rel=1e-6)
    write_instead(root, finding)
    assert compared(root).findings == ()


# ------------------------------------------------------------------------ single texts


def test_a_body_without_mass_has_no_com_and_no_tensor_to_judge():
    comparison = compared(edited(("link_3", "mass", {"value": "0"})))
    texts = [f.text for f in comparison.findings if f.where == "link_3"]
    assert texts == ["no mass in place of 0.142 kg"]
    body = comparison.as_dict()["bodies"][3]
    assert body["com_m"] is None
    assert body["com_error_m"] is None
    assert body["ours"]["com_m"] is not None
    assert json.loads(json.dumps(comparison.as_dict(), allow_nan=False))


@pytest.mark.parametrize(
    ("z", "wrong"), [("-0.09", False), ("0.001", True), ("0.1", True)]
)
def test_the_wrists_com_on_the_wrong_side_is_said_in_these_words(z, wrong):
    comparison = compared(edited(("link_4", "origin", {"xyz": f"0.001 0.002 {z}"})))
    text = found(comparison, "link_4", "COM ").text
    assert ("the wrist's COM is on the wrong side" in text) == wrong
    assert (f"(z = {float(z) * 1e3:+.1f} mm)" in text) == wrong


def add_link(
    root: ET.Element, name: str, mass: str, inertia: str, parent: str = "link_4"
):
    part = ET.SubElement(root, "link", name=name)
    body = ET.SubElement(part, "inertial")
    ET.SubElement(body, "mass", value=mass)
    ET.SubElement(
        body,
        "inertia",
        ixx=inertia,
        iyy=inertia,
        izz=inertia,
        ixy="0",
        ixz="0",
        iyz="0",
    )
    joint = ET.SubElement(root, "joint", name=f"{name}_fixed", type="fixed")
    ET.SubElement(joint, "parent", link=parent)
    ET.SubElement(joint, "child", link=name)


def test_dummies_are_named_together():
    root = edited()
    for name in ("tool", "rod"):
        add_link(root, name, "0.0001", "0.0001")
    add_link(root, "camera", "0.1", "0.05")
    comparison = compared(root)
    two = found(comparison, "link_4", "dummy link")
    assert two.text == (
        "dummy links tool, rod have 0.1 g and 0.0001 kg m^2: "
        "a radius of gyration of 1.00 m, more than the whole arm"
    )
    assert two.instead == "no <inertial> in tool, rod"
    one = found(comparison, "link_4", "camera has 100 g and 0.05 kg m^2")
    assert "a radius of gyration of 0.71 m" in one.text
    assert "dummy" not in one.text
    assert one.instead == ""  # it has a mass, so it needs an inertia
    # 0.6 m is the arm's reach: 0.36 m^2
    for inertia, named in (("3.5e-5", False), ("3.7e-5", True)):
        root = edited()
        add_link(root, "tool", "0.0001", inertia)
        assert (
            any("dummy link tool" in f.text for f in compared(root).findings) == named
        )


def test_jaws_beside_a_whole_wrist_are_counted_twice():
    root = edited()
    for name in ("left_jaw", "right_jaw"):
        add_link(root, name, "0.05", "1e-5")
    text = found(compared(root), "link_4", "mass ").text
    assert text == (
        "mass 0.455 kg in place of 0.355 kg: link_4 has the mass of Table 2; "
        "beside it left_jaw, right_jaw with 100 g: the jaws are counted twice"
    )
    root = edited()
    add_link(root, "motor", "0.05048", "1e-5", parent="link_3")
    text = found(compared(root), "link_3", "mass ").text
    assert text.endswith("link_3 has the mass of Table 2; beside it motor with 50 g")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("edit", "words", "just", "over"),
    [
        (
            "mass",
            "mass ",
            {"value": str(MASS_2 * 1.00097)},
            {"value": str(MASS_2 * 1.00103)},
        ),
        (
            "origin",
            "COM ",
            {"xyz": "0.073653 -9e-05 -0.000734"},
            {"xyz": "0.073673 -9e-05 -0.000734"},
        ),
        ("inertia", "inertia ", {"izz": "0.00087265"}, {"izz": "0.00087295"}),
    ],
)
def test_what_agrees_and_what_differs(edit, words, just, over):
    """Bounds: 1/1000 of the mass, 0.1 mm, 0.5 % of the largest moment of inertia."""
    for attributes, wrong in ((just, False), (over, True)):
        comparison = compared(edited(("link_2", edit, attributes)), 5)
        assert [words in f.text for f in comparison.findings] == [True] * wrong


# -------------------------------------------------------------------- both sides shown


def test_json_holds_both_sides():
    body = compared(edited(HEAVY, ROUND)).as_dict()["bodies"][4]
    xx, yy, zz, xy, xz, yz = reference.INERTIA[4]
    ours = np.array([[xx, -xy, -xz], [-xy, yy, -yz], [-xz, -yz, zz]]) * 1e-6
    theirs = ours.copy()
    np.fill_diagonal(theirs, [1.3e-3, 1.3e-3, 3.6e-4])
    for side, tensor in ((body, theirs), (body["ours"], ours)):
        assert side["mass_kg"] == 0.355
        np.testing.assert_allclose(
            side["com_m"], np.array(reference.COM[4]) / 1e3, atol=1e-15
        )
        np.testing.assert_allclose(side["inertia_kgm2"], tensor, atol=1e-15)
        moments = np.linalg.eigvalsh(tensor)
        np.testing.assert_allclose(side["principal_moments_kgm2"], moments, rtol=1e-9)
    assert body["inertia_error_kgm2"] == pytest.approx(np.abs(theirs - ours).max())


def test_links_that_together_make_a_body_are_explained_together():
    root = edited(("link_4", "mass", {"value": "0.2"}))
    add_link(root, "gripper", "0.133", "1e-5")
    text = found(compared(root, 5), "link_4", "mass ").text
    assert text == "mass 0.333 kg in place of 0.355 kg: an earlier revision's mass"


def test_a_body_that_the_other_model_lacks_is_said_to_be_missing():
    ours = compared(edited(), 5).bodies[2]
    empty = replace(ours, links=(), mass=0.0)
    case = BodyCase(
        body=empty,
        known=hypotheses_of(own_arm_of(parameters()), 2),
        written=[],
        bare=[],
        instead=Replacement(),
        cost=lambda body, mass, moment: body - mass,
    )
    (finding,) = findings_of_body(case)
    assert finding == Finding(
        where="link_2",
        text="no link of the other model is this body",
        serious=True,
        cost=2.0 + MASS_2,
        instead="",
        id="body.missing",
    )


def test_a_joint_that_nothing_explains_is_off_by_millimetres():
    joint = parse_urdf(OWN).joints["axis_b"]
    origin = joint.transform.copy()
    origin[:3, 3] += [0.003, 0.0, -0.004]
    correction = JointCorrection(joint=joint, origin=origin, axis=joint.axis)
    finding = _misplaced(correction)
    assert finding.where == "tool"  # a joint that does not move
    assert finding.text.startswith("its origin is 5.00 mm from ours")


def test_the_largest_differences_are_given_in_millimetres_and_newton_metres(
    tmp_path, capsys
):
    path, root = tmp_path / "other.urdf", edited(OTHER_SIDE)
    root.find("joint[@name='axis_d']/origin").set("xyz", "0.02 0.0 0.047")
    path.write_text(ET.tostring(root, encoding="unicode"))
    assert main(["compare", str(path), "--samples", str(SAMPLES)]) == 1
    said = " ".join(capsys.readouterr().out.split())
    gravity = gravity_difference(edited(OTHER_SIDE))
    tool = (
        "Tool (frame tcp, in base_link) at the same joint positions: "
        "up to 0.800 mm (median 0.800 mm) and 0.00 deg off; "
        "with signs and zeros matched 0.800 mm"
    )
    assert tool in said
    assert f"gravity torque in air {gravity:.4g} N·m, mass matrix 0.0" in said
