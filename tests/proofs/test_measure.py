"""Which models are of this arm, and how the findings about one are ordered."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import test_compare_tool
from urdf_edits import OWN

import alpha5_model as a5
from alpha5_model.description.reading import parse_urdf
from alpha5_model.description.urdf_robot import UrdfRobot
from alpha5_model.errors import InputError
from alpha5_model.proofs.comparison.arm_of_model import arm_of_model, arm_of_robot
from alpha5_model.proofs.comparison.chains import Chain, find_chains, our_shape
from alpha5_model.proofs.comparison.measure import (
    _another_arm,
    _by_cost,
    _is_ours,
    _second_arms,
    _worst_differences,
    arms_of_model,
    compare,
    compare_robots,
)
from alpha5_model.proofs.comparison.records import Finding

RECORD = a5.parameters()
AXES = ("axis_e", "axis_d", "axis_c", "axis_b")


def arm(*, named: bool, ours: bool) -> UrdfRobot:
    """The arm, with joints named as ours or not, with our lengths or not."""
    root = ET.fromstring(OWN)
    if not ours:
        test_compare_tool.shift("axis_c", 0.1, 0.0, 0.0)(root)
    text = ET.tostring(root, encoding="unicode")
    if not named:
        text = re.sub('joint name="axis_([edcb])"', r'joint name="\1"', text)
    return parse_urdf(text)


@pytest.mark.slow
@pytest.mark.parametrize("ours", [True, False])
@pytest.mark.parametrize("named", [True, False])
def test_an_arm_of_other_lengths_is_described_if_its_joints_are_named(
    named: bool, ours: bool
) -> None:
    robot = arm(named=named, ours=ours)
    found = arms_of_model(robot, None, None, RECORD)
    assert (found is not None) == (named or ours)
    if found is None:
        with pytest.raises(InputError, match="compare says why it is none"):
            arm_of_robot(robot)
    if not named:
        mapping = {axis: axis[-1] for axis in AXES}
        given = arms_of_model(robot, mapping, None, RECORD)
        assert given is not None
        assert [joint.name for joint in given.meant.joints] == list("edcb")
        del mapping["axis_e"]
        three = arms_of_model(robot, mapping, None, RECORD)
        assert (three is not None) == ours


@pytest.mark.slow
def test_a_file_is_read_as_it_is_at_500_positions() -> None:
    """Unless the caller asks for other positions, or for xacro."""
    comparison = compare(a5.URDF_PATH)
    assert comparison.tool is not None
    assert comparison.tool.distance.shape == (500,)
    again = compare_robots(parse_urdf(OWN)).tool
    assert again is not None
    assert again.distance.shape == (500,)
    assert arm_of_model(a5.URDF_PATH).record.links == RECORD.links


def chain(off: float, following: int = 0, index: int = 0) -> Chain:
    """A chain whose shape is off in one number."""
    differences = np.zeros(7)
    differences[index] = off
    joints = find_chains(parse_urdf(OWN), RECORD)[0].joints
    return Chain(
        joints=joints,
        shape=our_shape(RECORD) + differences,
        differences=np.abs(differences),
        following=following,
    )


@pytest.mark.parametrize(
    ("off", "following", "ours"),
    [
        (0.05, 0, True),
        (0.0501, 0, False),
        (0.05, 1, True),
        (0.0051, 2, False),
        (0.005, 2, True),
        (0.05, 3, False),
    ],
)
def test_an_arm_is_ours_within_50_mm_or_5_mm_if_it_is_longer(
    off: float, following: int, ours: bool
) -> None:
    assert _is_ours(chain(off, following)) == ours


def test_the_three_worst_differences_are_named_in_mm_and_degrees() -> None:
    off = np.array([0.0011, 0.0, 0.03, -0.02, 0.0, 0.0, 0.9])
    ours = our_shape(RECORD)
    one = replace(chain(0.0), shape=ours + off, differences=np.abs(off))
    twist = 90 + math.degrees(0.9)
    assert _worst_differences(one, ours) == [
        f"axis_b to axis_c {twist:.0f} deg (ours 90)",
        "axis_b from axis_c 50 mm (ours 20)",
        "the elbow out of the arm's plane -20 mm (ours 0)",
    ]
    small = np.array([0.0011, 0.001, 0.0, 0.0, 0.0, 0.0, 0.0])
    two = replace(one, shape=ours + small, differences=small)
    expected = ["axis_d from axis_e 21 mm (ours 20)"]
    assert _worst_differences(two, ours) == expected


def test_another_arm_has_so_many_joints_that_turn_by_themselves() -> None:
    robot = parse_urdf(OWN)
    turning = robot.joints["axis_e"]
    more = {
        "endless": replace(turning, kind="continuous"),
        "led": replace(turning, mimic="axis_e"),
        "sliding": replace(turning, kind="prismatic"),
    }
    other = replace(robot, joints=robot.joints | more)
    found = _another_arm(RECORD, other, [])
    assert "(5 turning joints in all)" in found.text
    best = chain(0.3, index=3)
    text = _another_arm(RECORD, other, [best, chain(0.0)]).text
    assert "of its 5 turning joints axis_e, axis_d, axis_c, axis_b come" in text


def test_second_arms_have_our_shape_and_no_joint_of_the_first() -> None:
    first = chain(0.0)
    names = dict(zip("ABCD", AXES, strict=True))
    joints = [
        replace(joint, name=name)
        for joint, name in zip(first.joints, names, strict=True)
    ]
    second = replace(first, joints=tuple(joints))
    other = replace(chain(0.06), joints=tuple(joints))
    touching = replace(second, joints=(*joints[:3], first.joints[3]))
    found = _second_arms([first, other, touching, second])
    assert [one.id for one in found] == ["second_arm"]
    assert "axis_e=A,axis_d=B,axis_c=C,axis_b=D" in found[0].text


def test_findings_are_ordered_by_their_cost_to_a_micronewton_metre() -> None:
    def finding(cost: float, serious: bool) -> Finding:
        return Finding(where="", text="", serious=serious, cost=cost)

    costly = finding(0.2, serious=False)
    remark = finding(0.1000002, serious=False)
    wrong = finding(0.1, serious=True)
    less = finding(0.0999980, serious=True)
    free = finding(0.0, serious=False)
    given: list[Any] = [free, remark, less, wrong, costly]
    ordered = sorted(given, key=_by_cost)
    assert ordered == [costly, wrong, remark, less, free]
