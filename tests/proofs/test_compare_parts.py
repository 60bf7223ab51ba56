"""`compare` with models that are ambiguous: which arm, which zero, which package."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

import model_defects
import pytest
from compared_models import AXES, compared, described, ids
from urdf_edits import OWN

import alpha5_model as a5
from alpha5_model.errors import InputError

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


# --- packages


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
