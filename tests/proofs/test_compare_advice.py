"""The advice of a finding mends the file: one fault each, and none of another link."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from compared_models import advised, compared, described, ids
from urdf_edits import OWN

from alpha5_model._support.paths import JAWS_URDF_PATH
from alpha5_model.proofs.comparison.result import finding_ids


def inertial(root: ET.Element, link: str, tag: str) -> ET.Element:
    return root.find(f"link[@name='{link}']/inertial/{tag}")


# --- bodies that move and have no mass or inertia


@pytest.mark.parametrize("mass", ["-0.3", "0"])
def test_a_mass_that_no_body_has_is_said_once_and_mended(mass: str) -> None:
    root = ET.fromstring(OWN)
    inertial(root, "link_2", "mass").set("value", mass)
    comparison = compared(root)
    (serious,) = [one for one in comparison.findings if one.serious]
    assert serious.where == "link_2"
    again = compared(advised(root, comparison))
    assert again.agrees, again.findings
    assert again.gravity_error.max() < 1e-9


def test_a_moment_of_zero_is_said_without_a_second_reason() -> None:
    root = ET.fromstring(OWN)
    inertial(root, "link_3", "inertia").set("izz", "0")
    comparison = compared(root)
    assert not {"lint.no_inertia", "lint.zero_moment"} & set(ids(comparison))
    assert compared(advised(root, comparison)).agrees


def test_many_links_without_a_body_are_one_finding() -> None:
    root = ET.fromstring(OWN)
    parent = "base_link"
    for k in range(60):
        ET.SubElement(root, "link", name=f"x{k}")
        joint = ET.SubElement(root, "joint", name=f"turn{k}", type="continuous")
        ET.SubElement(joint, "parent", link=parent)
        ET.SubElement(joint, "child", link=f"x{k}")
        parent = f"x{k}"
    comparison = compared(root)
    (bare,) = [one for one in comparison.findings if one.id == "lint.no_inertia"]
    assert "59 other" in bare.text
    assert len(bare.corrections) == 60
    assert len(bare.instead) < 400
    assert all("x9" not in one.text for one in comparison.findings)
    assert "lint.no_inertia" not in ids(compared(advised(root, comparison)))


# --- joints of the jaws


JAWS = Path(JAWS_URDF_PATH).read_text("utf-8")
Edit = Callable[[ET.Element], None]


def attribute(name: str, tag: str, **values: str) -> Edit:
    def edit(root: ET.Element) -> None:
        element = root.find(f"joint[@name='{name}']")
        (element if tag == "joint" else element.find(tag)).attrib.update(values)

    return edit


def free_fingers(root: ET.Element) -> None:
    for joint in root.findall("joint"):
        for mimic in joint.findall("mimic"):
            joint.remove(mimic)


def hands(text: str) -> np.ndarray:
    """Poses of rod and fingers in link_4 over the rod's travel, by Pinocchio."""
    model = pin.buildModelFromXML(text, mimic=True)
    data = model.createData()
    assert model.nq == 5
    poses = []
    for travel in np.linspace(0.0013, 0.0133, 4):
        q = pin.neutral(model)
        q[model.joints[model.getJointId("axis_a")].idx_q] = travel
        pin.framesForwardKinematics(model, data, q)
        wrist, *parts = (
            data.oMf[model.getFrameId(name, pin.FrameType.BODY)]
            for name in ("link_4", "jaw_rod", "finger_1", "finger_2")
        )
        poses += [(wrist.inverse() * part).homogeneous for part in parts]
    return np.array(poses)


def following_rod(root: ET.Element) -> None:
    rod = root.find("joint[@name='axis_a']")
    ET.SubElement(rod, "mimic", joint="axis_b", multiplier="0.001", offset="0.004")


FAULTS = (
    (free_fingers, "jaws.free"),
    (following_rod, "jaws.follows"),
    (attribute("finger_1_joint", "mimic", multiplier="-3"), "jaws.mimic"),
    (attribute("finger_2_joint", "mimic", offset="0"), "jaws.mimic"),
    (attribute("axis_a", "origin", xyz="0 0 -0.14275"), "jaws.origin"),
    (attribute("finger_1_joint", "origin", rpy="0 0 0"), "jaws.origin"),
    (attribute("axis_a", "joint", type="revolute"), "jaws.type"),
    (attribute("axis_a", "axis", xyz="0 0 -1"), "jaws.axis"),
    (attribute("axis_a", "limit", upper="1"), "jaws.limits"),
    (attribute("axis_a", "limit", velocity="0"), "lint.velocity_zero"),
    (attribute("axis_a", "limit", velocity="0.1"), "jaws.velocity"),
    (attribute("axis_a", "limit", effort="99"), "jaws.effort"),
    (attribute("finger_1_joint", "mimic", joint="nope"), "lint.mimic"),
)


def limits_of(text: str) -> dict[str, list[float]]:
    names = ("lower", "upper", "velocity", "effort")
    return {
        joint.get("name"): [float(joint.find("limit").get(name)) for name in names]
        for joint in ET.fromstring(text).findall("joint")
        if joint.find("limit") is not None
    }


def test_every_finding_of_the_jaws_has_a_fault() -> None:
    of_jaws = {one for one in finding_ids() if one.startswith("jaws.")}
    assert of_jaws <= {expected for _, expected in FAULTS}


@pytest.mark.parametrize(("edit", "expected"), FAULTS)
def test_a_wrong_joint_of_the_jaws_is_named_and_mended(
    edit: Edit, expected: str
) -> None:
    root = ET.fromstring(JAWS)
    edit(root)
    comparison = compared(root)
    assert set(ids(comparison)) == {expected}
    mended = advised(root, comparison)
    again = compared(mended)
    assert again.findings == ()
    assert again.gravity_error.max() < 1e-6
    np.testing.assert_allclose(hands(mended), hands(JAWS), atol=1e-6)
    limits, ours = (limits_of(text) for text in (mended, JAWS))
    for name, written in limits.items():
        assert written == pytest.approx(ours[name], rel=1e-4)


def test_jaws_with_another_zero_and_sense_are_ours_if_they_move_alike() -> None:
    root = ET.fromstring(JAWS)
    attribute("axis_a", "axis", xyz="0 0 -1")(root)
    attribute("axis_a", "origin", xyz="0 0 -0.13405")(root)
    attribute("axis_a", "limit", lower="-0.012", upper="0")(root)
    for finger in ("finger_1_joint", "finger_2_joint"):
        attribute(finger, "mimic", multiplier="-51", offset="0")(root)
    comparison = compared(root)
    assert comparison.findings == ()
    attribute("finger_1_joint", "mimic", multiplier="51")(root)
    comparison = compared(root)
    assert ids(comparison) == ["jaws.mimic"]
    assert compared(advised(root, comparison)).findings == ()


# --- links that are none of the arm's


def with_camera(text: str, link: str, mass: float) -> ET.Element:
    """The arm with a small ball on one of its links."""
    root = ET.fromstring(text)
    camera = ET.SubElement(root, "link", name="camera")
    body = ET.SubElement(camera, "inertial")
    ET.SubElement(body, "mass", value=repr(mass))
    moment = repr(1e-4 * mass)
    diagonal = dict.fromkeys(("ixx", "iyy", "izz"), moment)
    ET.SubElement(body, "inertia", diagonal | dict.fromkeys(("ixy", "ixz", "iyz"), "0"))
    joint = ET.SubElement(root, "joint", name="to_camera", type="fixed")
    ET.SubElement(joint, "origin", xyz="0.05 0 0.02", rpy="0 0 0")
    ET.SubElement(joint, "parent", link=link)
    ET.SubElement(joint, "child", link="camera")
    return root


@pytest.mark.parametrize("mass", [1e-4, 0.01, 0.05, 0.2, 1.0])
@pytest.mark.parametrize(
    ("text", "link"), [(OWN, "link_2"), (JAWS, "link_2"), (JAWS, "link_4")]
)
def test_a_camera_is_named_and_not_the_link_that_carries_it(
    text: str, link: str, mass: float
) -> None:
    root = with_camera(text, link, mass)
    comparison = compared(root)
    serious = [one for one in comparison.findings if one.serious]
    assert [one.where for one in serious] == [link]
    (correction,) = serious[0].corrections
    assert (correction.name, correction.elements) == ("camera", {"inertial": None})
    again = compared(advised(root, comparison))
    assert again.agrees
    assert again.gravity_error.max() < 1e-6


# --- texts


def test_numbers_that_differ_are_printed_so() -> None:
    root = ET.fromstring(OWN)
    tensor = inertial(root, "link_2", "inertia")
    moment = float(tensor.get("iyy"))
    tensor.set("iyy", repr(moment + 6e-9))
    (found,) = [one for one in compared(root).findings if one.serious]
    theirs, ours = re.search("is (.*) in place of (.*) kg", found.text).groups()
    assert float(theirs) - float(ours) == pytest.approx(6e-9, rel=0.2)


def test_reversed_limits_are_said_in_the_arm_file() -> None:
    root = ET.fromstring(OWN)
    limit = root.find("joint[@name='axis_d']/limit")
    lower, upper = limit.get("lower"), limit.get("upper")
    limit.attrib.update(lower=upper, upper=lower)
    arm = described(root)
    assert arm.record.joints[1].lower == pytest.approx(float(lower))
    (warning,) = [text for text in arm.left_out if text.startswith("warning:")]
    assert "axis_d" in warning
    assert not [text for text in described(OWN).left_out if "warning" in text]


# --- base


@pytest.mark.parametrize("text", [OWN, JAWS])
@pytest.mark.parametrize("yaw", [0.02, -0.3, 1.2, 3.14159265])
def test_a_turned_joint_of_link_0_is_named_and_turned_back(
    text: str, yaw: float
) -> None:
    root = ET.fromstring(text)
    attribute("link_0_fixed", "origin", rpy=f"0 0 {yaw}")(root)
    comparison = compared(root)
    assert ids(comparison) == ["joint.turned_base"]
    assert comparison.findings[0].where == "link_0_fixed"
    assert not comparison.agrees
    mended = advised(root, comparison)
    assert compared(mended).findings == ()
    origin = ET.fromstring(mended).find("joint[@name='link_0_fixed']/origin")
    np.testing.assert_allclose(np.fromstring(origin.get("rpy"), sep=" "), 0, atol=1e-6)


def test_a_shifted_zero_of_axis_e_turns_no_base() -> None:
    root = ET.fromstring(OWN)
    attribute("axis_e", "origin", rpy="0 0 2.9")(root)
    found = ids(compared(root))
    assert "zero" in found
    assert "joint.turned_base" not in found


def test_a_rounded_origin_of_the_rod_changes_no_rule_of_the_fingers() -> None:
    root = ET.fromstring(JAWS)
    attribute("axis_a", "origin", xyz="0 0 -0.1328")(root)
    found = ids(compared(root))
    assert not [one for one in found if one.startswith("jaws")]
