"""`compare` with models that are ambiguous: which arm, which zero, which package."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from pathlib import Path

import model_defects
import numpy as np
import pinocchio as pin
import pytest
from compared_models import AXES, compared, described, ids
from urdf_edits import OWN

import alpha5_model as a5
from alpha5_model.errors import InputError
from alpha5_model.proofs.comparison.model import package_above

RECORD = a5.parameters()

# --- arms


def arm(*, named: bool, ours: bool) -> str:
    """The arm, with joints named as ours or not, with our lengths or not."""
    root = ET.fromstring(OWN)
    if not ours:
        model_defects.shift("axis_c", 0.1, 0.0, 0.0)(root)
    text = ET.tostring(root, encoding="unicode")
    if not named:
        text = re.sub('joint name="axis_([edcb])"', r'joint name="\1"', text)
    return text


@pytest.mark.filterwarnings("ignore::alpha5_model.errors.ImplausibleWarning")
def test_an_arm_of_other_lengths_is_described_if_its_joints_are_named() -> None:
    for named, ours in ((True, True), (True, False), (False, True)):
        length = described(arm(named=named, ours=ours)).record.dh[1].a
        assert length > RECORD.dh[1].a + 0.02 or ours
    other = arm(named=False, ours=False)
    with pytest.raises(InputError, match="compare says why it is none"):
        described(other)
    mapping = {axis: axis[-1] for axis in AXES}
    assert described(other, joints=mapping).record.dh[1].a > RECORD.dh[1].a + 0.02


@pytest.mark.parametrize(
    ("off", "first"), [(0.0, "axis_e"), (0.00004, "axis_e"), (0.0004, "e")]
)
def test_names_decide_between_arms_of_the_same_shape(off: float, first: str) -> None:
    """The shapes are the same to a tenth of a millimetre."""
    arm = re.search("<link.*</joint>", OWN, re.DOTALL)
    assert arm
    root = ET.fromstring(OWN)
    model_defects.shift("axis_b", off, 0.0, 0.0)(root)
    second = re.sub('(name|link)="(axis_)?', r'\1="', arm[0])
    second = re.sub('(name|link)="((?![edcb]").*?)"', r'\1="x_\2"', second)
    for element in ET.fromstring(f"<arm>{second}</arm>"):
        root.insert(0, element)
    ET.SubElement(root, "link", name="hull")
    for base in ("base_link", "x_base_link"):
        joint = ET.SubElement(root, "joint", name=f"to_{base}", type="fixed")
        ET.SubElement(joint, "parent", link="hull")
        ET.SubElement(joint, "child", link=base)
    comparison = compared(root)
    assert comparison.joints["axis_e"] == first
    assert "second_arm" in ids(comparison)


def test_a_wrong_mapping_names_the_joints_that_turn() -> None:
    expected = "follow each other, out of: axis_e, axis_d, axis_c, axis_b"
    with pytest.raises(InputError, match=f"{expected}, got"):
        compared(OWN, joints={"axis_e": "axis_d"})
    locked = re.sub(r'lower="[^"]+" upper="[^"]+"', 'lower="0" upper="0"', OWN)
    with pytest.raises(InputError, match="out of: none, got"):
        compared(locked, joints={"axis_e": "axis_e"})


# --- zeros


@pytest.mark.parametrize(
    ("zero", "off", "sure"),
    [
        # 1 mm settles it; farther off, the COM must fit three times better.
        (0.02, 0.0009, True),
        (0.02, 0.0011, False),
        (0.119, 0.002, True),
        (0.095, 0.002, False),
    ],
)
def test_the_com_of_link_0_tells_a_zero_of_axis_e_from_a_turned_base(
    zero: float, off: float, sure: bool
) -> None:
    """Turned by the zero, the COM moves by its distance from the axis."""
    root = ET.fromstring(OWN)
    model_defects.turn("axis_e", 0.0, 0.0, zero)(root)
    com = np.add(RECORD.links[0].com, [0.0, 0.0, off])
    xyz = model_defects.written(com)
    model_defects.inertial("link_0", "origin", xyz=xyz)(root)
    found = compared(root, samples=5)
    (shifted,) = [one for one in found.findings if one.id.startswith("zero")]
    assert (shifted.id == "zero") == sure
    radius = math.hypot(*RECORD.links[0].com[:2])
    turned = math.hypot(2 * radius * math.sin(zero / 2), off)
    assert sure == (off < 0.001 or turned > 3 * off)


def test_without_a_mass_of_link_0_nothing_tells_them_apart() -> None:
    root = ET.fromstring(OWN)
    model_defects.turn("axis_e", 0.0, 0.0, 0.7)(root)
    model_defects.inertial("link_0", "mass", value="0")(root)
    assert "zero.or_base" in ids(compared(root, samples=5))


@pytest.mark.parametrize(("ratio", "shifted"), [(3.8, False), (4.2, True)])
@pytest.mark.parametrize("roll", [0.6, -0.9])
def test_axis_b_is_shifted_if_link_4_then_fits_four_times_better(
    roll: float, ratio: float, shifted: bool
) -> None:
    """Its error: mass times squared distance of the COM, and the tensor's largest."""
    link = RECORD.links[4]
    back = pin.exp3(np.array([0.0, 0.0, -roll]))
    square = float(np.sum((back @ link.com - link.com) ** 2))
    tensor = back @ link.inertia @ back.T - link.inertia
    error = link.mass * square + np.abs(tensor).max()
    root = ET.fromstring(OWN)
    model_defects.turn("axis_b", 0.0, 0.0, roll)(root)
    izz = link.inertia[2, 2] + error / ratio
    model_defects.inertial("link_4", "inertia", izz=repr(float(izz)))(root)
    alignment = compared(root, samples=5).alignment
    assert alignment.zero[3] == pytest.approx(-roll if shifted else 0.0, abs=1e-9)


# --- packages


def test_the_nearest_package_that_can_be_read_is_that_of_the_file(
    tmp_path: Path,
) -> None:
    file = tmp_path / "outer" / "inner" / "urdf" / "deep" / "arm.xacro"
    file.parent.mkdir(parents=True)
    assert "outer" not in package_above(file)
    outer = tmp_path / "outer"
    (outer / "package.xml").write_text("<package><name> outer </name></package>")
    assert package_above(file) == {"outer": str(outer.resolve())}
    inner = outer / "inner"
    (inner / "package.xml").write_text("<package")
    assert package_above(file) == {"outer": str(outer.resolve())}
    (inner / "package.xml").write_text("<package><name>inner</name></package>")
    assert package_above(file) == {"inner": str(inner.resolve())}
    (inner / "package.xml").write_text("<package/>")
    assert package_above(file) == {}


def test_what_is_no_mapping_of_names_is_refused() -> None:
    for name, given in (
        ("map", {"joints": 3}),
        ("map", {"joints": "x"}),
        ("map", {"joints": {"axis_e": 1}}),
        ("packages", {"packages": 3}),
        ("arguments", {"arguments": ["a"]}),
    ):
        with pytest.raises(InputError) as caught:
            a5.compare(a5.URDF_PATH, **given)  # type: ignore[arg-type]
        assert caught.value.name == name
