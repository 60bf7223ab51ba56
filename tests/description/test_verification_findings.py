"""What the verification says of small edits of our own files, word by word."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
import reference
from own_arm_dynamics import RECORDS
from test_verification import JAWS, LOCKED

from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.description.verification import FileCheck, verify_urdf
from alpha5_model.numbers.parameters import Alpha5Parameters

LINK_2 = "link[@name='link_2']/inertial"
ROD = "joint[@name='axis_a']"
FINGER = "joint[@name='finger_1_joint']"


def edited(text: str, path: str, **attributes: str | None) -> str:
    """The text with other attributes of an element; None takes one away."""
    root = ET.fromstring(text)
    element = root.find(path)
    assert element is not None, path
    for name, value in attributes.items():
        element.attrib.pop(name, None)
        if value is not None:
            element.set(name, value)
    return ET.tostring(root, encoding="unicode")


def without(text: str, parent: str, child: str) -> str:
    """The text without a child of an element."""
    root = ET.fromstring(text)
    around = root.find(parent)
    assert around is not None
    inner = around.find(child)
    assert inner is not None
    around.remove(inner)
    return ET.tostring(root, encoding="unicode")


def row(
    check: str,
    text: str,
    folder: Path,
    samples: int = 5,
    arm: Alpha5Parameters | None = None,
) -> FileCheck:
    """One row of the verification of a text."""
    file = folder / "arm.urdf"
    file.write_text(text, "utf-8")
    rows = verify_urdf(file, samples=samples, arm=arm)
    (found,) = (row for row in rows if row.check == check)
    return found


def test_a_com_is_told_in_millimetres(tmp_path: Path) -> None:
    x, y, z = (c * 1e-3 for c in reference.COM[2])
    moved = f"{x + 0.003!r} {y + 0.004!r} {z!r}"
    found = row("inertias", edited(LOCKED, f"{LINK_2}/origin", xyz=moved), tmp_path)
    assert found.finding.endswith(" m, 5 mm from Table 2's")


def test_a_tensor_is_told_in_square_millimetres_without_a_wrong_name(
    tmp_path: Path,
) -> None:
    xx, _, _, xy, _, _ = (c * 1e-6 for c in reference.INERTIA[2])
    tensor = f"{LINK_2}/inertia"
    larger = edited(LOCKED, tensor, ixx=repr(xx + 2e-6))
    found = row("inertias", larger, tmp_path)
    assert found.finding == "link_2: inertia is 2 kg mm^2 from Table 2's I_COM"
    # Without products it is no mistake that has a name.
    bare = edited(LOCKED, tensor, ixy="0", ixz="0", iyz="0")
    found = row("inertias", bare, tmp_path)
    expected = f"{abs(xy) * 1e6:.3g} kg mm^2 from Table 2's I_COM"
    assert found.finding == f"link_2: inertia is {expected}"


@pytest.mark.parametrize("turn", ["50", "-52"])
def test_a_finger_that_turns_otherwise_is_told(turn: str, tmp_path: Path) -> None:
    text = edited(JAWS, f"{FINGER}/mimic", multiplier=turn)
    found = row("jaw limits", text, tmp_path)
    words = f"finger_1_joint: {turn} rad/m, expected 51 rad/m; "
    assert found.finding.startswith(words)
    assert (found.verdict, found.finding.count("; ")) == ("failed", 2)


@pytest.mark.parametrize("limit", ["lower", "upper", "velocity"])
def test_each_limit_of_rod_and_fingers_is_needed(limit: str, tmp_path: Path) -> None:
    bare = edited(JAWS, f"{ROD}/limit", **{limit: None})
    assert row("jaw limits", bare, tmp_path).finding == "axis_a: no limits"
    bare = edited(JAWS, f"{FINGER}/limit", **{limit: None})
    words = f"finger_1_joint: {limit} None, the rod makes it "
    assert row("jaw limits", bare, tmp_path).finding.startswith(words)


def test_a_finger_that_closes_the_other_way_has_its_ends_in_order(
    tmp_path: Path,
) -> None:
    """Its range is then below zero."""
    text = edited(JAWS, f"{FINGER}/mimic", multiplier="-51", offset="0.0663")
    found = row("jaw limits", text, tmp_path)
    limits = [part.split()[1:3] for part in found.finding.split("; ")]
    assert limits == [["lower", "0.0,"], ["upper", "0.612,"]]
    assert "the rod makes it -0.612; " in found.finding


@pytest.mark.parametrize("link", ["link_4", "jaw_rod", "finger_2"])
def test_all_parts_of_the_jaws_need_a_mass(link: str, tmp_path: Path) -> None:
    text = without(JAWS, f"link[@name='{link}']", "inertial")
    found = row("closed jaws", text, tmp_path)
    assert found.finding.startswith("wrist, rod and fingers are not all there")


@pytest.mark.parametrize(("mass", "ixx"), [("1e-9", "0"), ("0", "1e-9")])
def test_mass_or_inertia_alone_is_stray(mass: str, ixx: str, tmp_path: Path) -> None:
    inertial = "link[@name='tcp']/inertial"
    text = edited(LOCKED, f"{inertial}/mass", value=mass)
    text = edited(text, f"{inertial}/inertia", ixx=ixx)
    found = row("stray masses", text, tmp_path)
    assert found.finding == f"tcp: mass {float(mass):g} kg where there is no body"


@pytest.mark.parametrize(("samples", "few"), [(50, 66), (283, 150), (284, 100)])
def test_yourdfpy_is_asked_about_few_positions(
    samples: int, few: int, tmp_path: Path
) -> None:
    """With the 16 corners of the limits: all of up to 199, then about a hundred."""
    pytest.importorskip("yourdfpy")
    asked = row("frames, yourdfpy", LOCKED, tmp_path, samples)
    assert f" frames at {few} joint positions" in asked.finding
    asked = row("frames, Pinocchio", LOCKED, tmp_path, samples)
    assert f" frames at {samples + 16} joint positions" in asked.finding


def test_a_mount_that_turns_is_found(tmp_path: Path) -> None:
    record = RECORDS[9]
    text = urdf(Variant(arm=record))
    assert row("mount", text, tmp_path, arm=record).verdict == "passed"
    assert record.mount is not None
    loose = edited(text, "joint[@name='mount']", type="floating")
    found = row("mount", loose, tmp_path, arm=record)
    parent = record.mount.parent
    expected = f"base_link on {parent}, floating, expected {parent}, fixed"
    assert found.finding == expected


def test_a_vehicle_may_have_a_base_link_of_its_own(tmp_path: Path) -> None:
    """Its name is no prefix of the arm's names."""
    text = urdf(Variant(parent="rov_base_link"))
    for check in ("names", "joints", "inertias", "frames, Pinocchio"):
        assert row(check, text, tmp_path).verdict == "passed"
