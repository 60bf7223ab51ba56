"""Parts of a comparison: frozen joints, ranked chains, packages, guesses and bounds."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import test_compare_tool
from urdf_edits import OWN

import alpha5_model as a5
from alpha5_model.description.reading import parse_urdf
from alpha5_model.errors import InputError
from alpha5_model.numbers.rigid_body import RigidBody
from alpha5_model.proofs.comparison.chains import find_chains
from alpha5_model.proofs.comparison.frozen_joints import rest_position
from alpha5_model.proofs.comparison.guesses import explain_guess, solid_of_size
from alpha5_model.proofs.comparison.inertials import Inertial
from alpha5_model.proofs.comparison.model_file import package_above
from alpha5_model.proofs.comparison.own_arm import _widened

RECORD = a5.parameters()
ROBOT = parse_urdf(OWN)
LINK_2 = RECORD.links[2]


# --- frozen joints


@pytest.mark.parametrize(
    ("lower", "upper", "rest"),
    [
        (None, None, 0.0),
        (0.0, 1.0, 0.0),
        (0.0, 0.0, 0.0),
        (0.2, 1.0, 0.2),
        (-1.0, -0.3, -0.3),
        (-1.0, 0.0, 0.0),
        (-1.0, 1.0, 0.0),
        (None, 1.0, 0.0),
        (-1.0, None, 0.0),
    ],
)
def test_a_joint_is_frozen_nearest_to_zero(
    lower: float | None, upper: float | None, rest: float
) -> None:
    joint = replace(ROBOT.joints["axis_e"], lower=lower, upper=upper)
    assert rest_position(ROBOT, joint) == rest


def test_a_joint_that_mimics_another_is_frozen_where_that_one_drives_it() -> None:
    leader = replace(ROBOT.joints["axis_e"], name="rod", lower=0.2, upper=1.0)
    follower = replace(leader, name="jaw", mimic="rod", multiplier=3.0, offset=0.05)
    second = replace(follower, name="tip", mimic="jaw")
    robot = replace(ROBOT, joints={"rod": leader, "jaw": follower, "tip": second})
    assert rest_position(robot, follower) == pytest.approx(0.65)
    # What mimics a follower, or nothing that is there, has its own range only.
    assert rest_position(robot, second) == 0.2
    assert rest_position(robot, replace(second, mimic="nothing")) == 0.2


# --- ranked chains


@pytest.mark.parametrize(
    ("off", "first"), [(0.0, "axis_e"), (0.00004, "axis_e"), (0.0004, "e")]
)
def test_names_decide_between_arms_of_the_same_shape(off: float, first: str) -> None:
    """The shapes are the same to a tenth of a millimetre."""
    arm = re.search("<link.*</joint>", OWN, re.DOTALL)
    assert arm
    root = ET.fromstring(OWN)
    test_compare_tool.shift("axis_b", off, 0.0, 0.0)(root)
    second = re.sub('(name|link)="(axis_)?', r'\1="', arm[0])
    second = re.sub('(name|link)="((?![edcb]").*?)"', r'\1="x_\2"', second)
    for element in ET.fromstring(f"<arm>{second}</arm>"):
        root.insert(0, element)
    ET.SubElement(root, "link", name="hull")
    for base in ("base_link", "x_base_link"):
        joint = ET.SubElement(root, "joint", name=f"to_{base}", type="fixed")
        ET.SubElement(joint, "parent", link="hull")
        ET.SubElement(joint, "child", link=base)
    chains = find_chains(parse_urdf(ET.tostring(root)), RECORD)
    assert len(chains) == 2
    assert chains[0].names[0] == first
    assert {chains[0].named_as_ours, chains[1].named_as_ours} == {0, 4}


def test_a_wrong_mapping_names_the_joints_that_turn() -> None:
    expected = "follow each other, out of: axis_e, axis_d, axis_c, axis_b"
    with pytest.raises(InputError, match=f"{expected}, got"):
        find_chains(ROBOT, RECORD, {"axis_e": "axis_d"})
    locked = {
        name: replace(joint, lower=0.0, upper=0.0)
        for name, joint in ROBOT.joints.items()
    }
    with pytest.raises(InputError, match="out of: none, got"):
        find_chains(replace(ROBOT, joints=locked), RECORD, {"axis_e": "axis_e"})


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


# --- guesses


def box(*sides: float) -> np.ndarray:
    squares = np.square(sides)
    return 0.4 / 12 * np.diag(squares.sum() - squares)


def cylinder(radius: float, length: float) -> np.ndarray:
    across = 0.4 * (3 * radius**2 + length**2) / 12
    return np.diag([0.2 * radius**2, across, across])


@pytest.mark.parametrize(
    ("tensor", "words"),
    [
        # Sides of whole millimetres, to 0.05 mm, and none of a millimetre or less.
        (box(0.03, 0.04004, 0.15), "a solid box of 30 x 40 x 150 mm"),
        (box(0.03, 0.04006, 0.15), None),
        (box(0.03, 0.03994, 0.15), None),
        (box(0.002, 0.04, 0.15), "a solid box of 2 x 40 x 150 mm"),
        (box(0.00099, 0.04, 0.15), None),
        # Both moments across a cylinder are the same to a thousandth of the largest.
        (cylinder(0.018, 0.151) * (1 + np.diag([0, 0, 9e-4])), "a solid cylinder of"),
        (cylinder(0.018, 0.151) * (1 + np.diag([0, 0, 12e-4])), None),
    ],
)
def test_solids_at_the_edge_of_a_guess(tensor: np.ndarray, words: str | None) -> None:
    found = solid_of_size(LINK_2, 0.4, tensor)
    assert (found or "").startswith(words or "a") == (words is not None)


@pytest.mark.parametrize(("off", "dummy"), [(0.9e-4, True), (1.1e-4, False)])
def test_a_dummy_has_one_moment_to_a_ten_thousandth(off: float, dummy: bool) -> None:
    inertia = 0.02 * np.diag([1.0, 1.0 - off, 1.0])
    link = Inertial("a", 0.4, np.zeros(3), inertia, np.eye(4))
    words = explain_guess(LINK_2, [link])
    assert words is not None
    assert ("a dummy, 0.02 kg m^2 about every axis" in words) == dummy


# --- bounds


def test_a_loaded_link_has_the_bounds_of_a_box_of_its_tensor() -> None:
    """A box of this mass and tensor, or the printed bounds where those are wider."""
    middle = LINK_2.com + np.array([0.5, 0.0, 0.0])
    sides = np.array([0.2, 0.3, 0.01])
    squares = np.square(sides)
    loaded = RigidBody(
        name="link_2",
        mass=0.6,
        com=middle,
        inertia=0.6 / 12 * np.diag(squares.sum() - squares),
        volume=LINK_2.volume,
        cob=LINK_2.cob,
    )
    wide = _widened(LINK_2, loaded)
    box_ends = np.column_stack([middle - sides / 2, middle + sides / 2])
    low = np.minimum(LINK_2.bounds[:, 0], box_ends[:, 0])
    high = np.maximum(LINK_2.bounds[:, 1], box_ends[:, 1])
    assert wide.bounds == pytest.approx(np.column_stack([low, high]))
    assert (wide.mass, wide.name) == (0.6, "link_2")
