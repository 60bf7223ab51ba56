"""`compare` on bodies: what they cost, what to write instead, and both sides shown."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET

import mujoco
import numpy as np
import pinocchio as pin
import pytest
import reference
from compared_models import advised, compared, text_of
from urdf_edits import OWN, mass_text, with_mass

import alpha5_model as a5
from alpha5_model.proofs.comparison.result import Comparison, Finding

SAMPLES = 40
HEAVY = ("link_2", "mass", {"value": "0.5"})
ASIDE = ("link_3", "origin", {"xyz": "0.011188 -0.046 0.000148"})
OTHER_SIDE = ("link_4", "origin", {"xyz": "-3e-05 -0.001482 0.100881"})
ROUND = ("link_4", "inertia", {"ixx": "0.0013", "iyy": "0.0013", "izz": "0.00036"})


def edited(*edits: tuple[str, str, dict[str, str]]) -> ET.Element:
    """Our URDF with attributes of inertials set: link, element, attributes."""
    root = ET.fromstring(OWN)
    for link, tag, attributes in edits:
        element = root.find(f"link[@name='{link}']/inertial/{tag}")
        element.attrib.update(attributes)
    return root


def found(comparison: Comparison, link: str, key: str) -> Finding:
    """The one finding of a link with this id."""
    (one,) = [f for f in comparison.findings if f.where == link and f.id == key]
    return one


def add_link(
    root: ET.Element,
    name: str,
    mass: str,
    inertia: str,
    parent: str = "link_4",
    kind: str = "fixed",
) -> None:
    part = ET.SubElement(root, "link", name=name)
    body = ET.SubElement(part, "inertial")
    ET.SubElement(body, "mass", value=mass)
    moments = dict.fromkeys(("ixx", "iyy", "izz"), inertia)
    ET.SubElement(body, "inertia", moments, ixy="0", ixz="0", iyz="0")
    joint = ET.SubElement(root, "joint", name=f"{name}_joint", type=kind)
    ET.SubElement(joint, "parent", link=parent)
    ET.SubElement(joint, "child", link=name)
    if kind != "fixed":
        ET.SubElement(joint, "limit", lower="0", upper="1", effort="1", velocity="1")


# --- costs


def gravity_difference(root: ET.Element) -> float:
    """Second route: Pinocchio parses both files, at the seeded positions."""
    models = [pin.buildModelFromXML(text) for text in (OWN, text_of(root))]
    q = np.random.default_rng(0).uniform(reference.LOWER, reference.UPPER, (SAMPLES, 4))
    torques = [
        [pin.computeGeneralizedGravity(model, model.createData(), row) for row in q]
        for model in models
    ]
    return float(np.abs(np.subtract(*torques)).max())


@pytest.mark.parametrize(
    ("edit", "key"),
    [(HEAVY, "body.mass"), (ASIDE, "body.com"), (OTHER_SIDE, "body.com")],
    ids=str,
)
def test_a_finding_costs_what_it_alone_changes_in_the_torque(edit, key: str) -> None:
    alone = gravity_difference(edited(edit))
    assert alone > 0.01
    for edits in ([edit], [HEAVY, ASIDE, OTHER_SIDE, ROUND]):
        comparison = compared(edited(*edits), samples=SAMPLES)
        cost = found(comparison, edit[0], key).cost
        assert cost == pytest.approx(alone, rel=1e-7)


def test_a_wrong_mass_and_com_of_one_body_cost_each_their_own() -> None:
    mass = ("link_3", "mass", {"value": "0.3"})
    both = compared(edited(mass, ASIDE), samples=SAMPLES)
    for edit, key in ((mass, "body.mass"), (ASIDE, "body.com")):
        expected = gravity_difference(edited(edit))
        assert found(both, "link_3", key).cost == pytest.approx(expected, rel=1e-7)


def test_findings_come_in_the_order_of_their_cost() -> None:
    heavy_base = ("link_0", "mass", {"value": "0.9"})
    comparison = compared(edited(HEAVY, ASIDE, OTHER_SIDE, ROUND, heavy_base))
    costs = [f.cost for f in comparison.findings]
    assert costs == sorted(costs, reverse=True)
    assert [f.where for f in comparison.findings[:3]] == ["link_4", "link_2", "link_3"]
    # No joint carries the base, and no torque of gravity shows a tensor.
    assert found(comparison, "link_0", "body.mass").cost == 0.0
    assert found(comparison, "link_4", "body.inertia").cost == 0.0


# --- what agrees


@pytest.mark.parametrize("product", ["ixy", "ixz", "iyz"])
@pytest.mark.parametrize("link", [f"link_{k}" for k in range(5)])
def test_every_single_sign_is_found_and_named(link: str, product: str) -> None:
    """Five of these fifteen agreed, and four were called turned by pi."""
    root = ET.fromstring(OWN)
    tensor = root.find(f"link[@name='{link}']/inertial/inertia")
    tensor.set(product, repr(-float(tensor.get(product))))
    one = found(compared(root, samples=5), link, "body.inertia")
    assert one.mistake == f"sign_{product}"


def test_a_com_that_is_off_is_no_wrong_axes() -> None:
    for k, axis in enumerate("xyz"):
        com = np.array(reference.COM[2]) / 1e3
        com[k] += 0.02
        xyz = " ".join(map(repr, com.tolist()))
        comparison = compared(edited(("link_2", "origin", {"xyz": xyz})), samples=5)
        assert found(comparison, "link_2", "body.com").mistake == "", axis


@pytest.mark.parametrize("digits", [3, 4, 6])
def test_numbers_agree_that_are_rounded_to_the_digits_of_the_file(digits: int) -> None:
    """Every number of every link, to as many significant digits."""
    root = ET.fromstring(OWN)
    for inertial in root.iter("inertial"):
        for tag in ("mass", "inertia"):
            element = inertial.find(tag)
            for name, value in element.attrib.items():
                element.set(name, f"{float(value):.{digits}g}")
    comparison = compared(root)
    assert comparison.agrees, comparison.findings
    rounded = text_of(root)
    heavier = with_mass(rounded, f"{float(mass_text(rounded)) * 1.01:.3g}")
    assert [f.id for f in compared(heavier).findings] == ["body.mass"]


# --- what to write instead


def test_what_to_write_instead_mends_the_file() -> None:
    root = edited(HEAVY, ASIDE, OTHER_SIDE, ROUND)
    assert compared(advised(root, compared(root))).findings == ()


def test_what_to_write_instead_is_in_the_frame_of_the_other_models_link() -> None:
    root = ET.fromstring(OWN)
    node = root.find("link[@name='link_3']")
    node.remove(node.find("inertial"))
    for name, mass in (("shell", "0.2"), ("motor", "0.1")):
        add_link(root, name, mass, "1e-4", parent="link_3")
        origin = {"xyz": "0.02 -0.01 0.005", "rpy": "0.7 -0.4 1.9"}
        ET.SubElement(root.find(f"joint[@name='{name}_joint']"), "origin", origin)
    after = compared(advised(root, compared(root)))
    assert [f.text for f in after.findings if f.serious] == []
    com = np.array(reference.COM[3]) / 1e3
    np.testing.assert_allclose(after.bodies[3].com, com, atol=1e-6)


@pytest.mark.parametrize("link", ["link_0", "link_2", "link_4"])
@pytest.mark.parametrize("how", ["missing", "without mass"])
def test_a_missing_inertial_is_given_whole(link: str, how: str) -> None:
    root = ET.fromstring(OWN)
    node = root.find(f"link[@name='{link}']")
    if how == "missing":
        node.remove(node.find("inertial"))
    else:
        node.find("inertial/mass").set("value", "0")
    comparison = compared(root)
    key = "body.without_inertial" if how == "missing" else "body.without_mass"
    assert found(comparison, link, key).serious
    assert compared(advised(root, comparison)).findings == ()


def test_the_advice_is_a_file_that_mujoco_loads() -> None:
    """Moving links were to be emptied, and MuJoCo refuses them without an inertia."""
    root = edited(("link_4", "mass", {"value": "0.2"}))
    for name in ("left_jaw", "right_jaw"):
        add_link(root, name, "0.2", "1e-4", kind="revolute")
    add_link(root, "rod", "0.0001", "0.0001", kind="prismatic")
    add_link(root, "tool", "0.0001", "0.0001")
    comparison = compared(root)
    assert not comparison.agrees
    mended = advised(root, comparison)
    assert compared(mended).agrees
    bodies = ET.fromstring(mended)
    for link in bodies.iter("link"):
        for tag in ("visual", "collision"):
            for element in link.findall(tag):
                link.remove(element)
    model = mujoco.MjModel.from_xml_string(text_of(bodies))
    assert model.njnt == 7


def test_a_part_without_an_inertial_is_named_whatever_its_name() -> None:
    for name in ("a_shell", "z_shell"):
        root = ET.fromstring(OWN)
        add_link(root, name, "1", "1", parent="link_3")
        link = root.find(f"link[@name='{name}']")
        link.remove(link.find("inertial"))
        (remark,) = compared(root).findings
        assert (remark.id, remark.where) == ("body.partly", "link_3")
        assert name in remark.text


# --- dummies and other parts


def test_a_body_without_mass_has_no_com_and_no_tensor_to_judge() -> None:
    comparison = compared(edited(("link_3", "mass", {"value": "0"})))
    ids = [f.id for f in comparison.findings if f.where == "link_3"]
    assert "body.without_mass" in ids
    assert not {"body.com", "body.inertia"} & set(ids)
    body = comparison.as_dict()["bodies"][3]
    assert body["com_m"] is None
    assert body["com_error_m"] is None
    assert body["ours"]["com_m"] is not None
    assert json.loads(json.dumps(comparison.as_dict(), allow_nan=False))


# --- both sides shown


def test_json_holds_both_sides() -> None:
    body = compared(edited(HEAVY, ROUND)).as_dict()["bodies"][4]
    xx, yy, zz, xy, xz, yz = reference.INERTIA[4]
    ours = np.array([[xx, -xy, -xz], [-xy, yy, -yz], [-xz, -yz, zz]]) * 1e-6
    theirs = ours.copy()
    np.fill_diagonal(theirs, [1.3e-3, 1.3e-3, 3.6e-4])
    for side, tensor in ((body, theirs), (body["ours"], ours)):
        assert side["mass_kg"] == 0.355
        com = np.array(reference.COM[4]) / 1e3
        np.testing.assert_allclose(side["com_m"], com, atol=1e-15)
        np.testing.assert_allclose(side["inertia_kgm2"], tensor, atol=1e-15)
        moments = np.linalg.eigvalsh(tensor)
        np.testing.assert_allclose(side["principal_moments_kgm2"], moments, rtol=1e-9)
    assert body["inertia_error_kgm2"] == pytest.approx(np.abs(theirs - ours).max())


def test_bodies_are_those_of_pinocchios_reduced_model() -> None:
    """Second route: `pin.buildReducedModel` of our arm with jaws, closed."""
    path = a5.URDF_PATH.replace("alpha5.urdf", "alpha5_jaws.urdf")
    full = pin.buildModelFromUrdf(path)
    rest = np.clip(pin.neutral(full), full.lowerPositionLimit, full.upperPositionLimit)
    frozen = [
        full.getJointId(n) for n in ("axis_a", "finger_1_joint", "finger_2_joint")
    ]
    model = pin.buildReducedModel(full, frozen, rest)
    for body, inertia in zip(
        a5.compare(path).bodies[1:], model.inertias[1:], strict=True
    ):
        assert body.mass == pytest.approx(inertia.mass, abs=1e-15)
        np.testing.assert_allclose(body.com, inertia.lever, atol=1e-12)
        np.testing.assert_allclose(body.inertia, inertia.inertia, atol=1e-12)


@pytest.mark.parametrize("mass", ["0.2", "5"])
def test_a_part_too_many_is_found_and_taken_out(mass: str) -> None:
    """Heavier than the whole link, it left no link that could have been wrong."""
    root = ET.fromstring(OWN)
    add_link(root, "ballast", mass, "1e-4")
    comparison = compared(root)
    serious = [f for f in comparison.findings if f.serious]
    assert {f.where for f in serious} == {"link_4"}
    assert any("ballast" in f.text for f in serious)
    assert compared(advised(root, comparison)).agrees
