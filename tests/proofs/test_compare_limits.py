"""`compare` of limits, origins and mimicking joints, at the edges of its tolerances."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from urdf_edits import OWN

import alpha5_model as a5
from alpha5_model.description.reading import parse_urdf
from alpha5_model.description.urdf_robot import UrdfJoint
from alpha5_model.proofs.comparison import limit_findings
from alpha5_model.proofs.comparison.correction import (
    LIMIT_TOLERANCE,
    JointCorrection,
    pose_distance,
    seems_in_degrees,
)
from alpha5_model.proofs.comparison.records import Finding

RECORD = a5.parameters()
ROBOT = parse_urdf(OWN)


def made_up(**parts: Any) -> Any:
    return SimpleNamespace(**parts)


def ids(found: Any) -> list[str]:
    return [one.id for one in found]


# --- limits


def correction(**limits: float | None) -> JointCorrection:
    """That of axis_e, with other limits, and an origin of ours."""
    joint = replace(ROBOT.joints["axis_e"], **limits)  # type: ignore[arg-type]
    return JointCorrection(
        joint=joint,
        origin=joint.transform,
        axis=joint.axis,
        ours=RECORD.joints[0],
    )


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("end", [0, 1])
@pytest.mark.parametrize(("factor", "found"), [(0.99, []), (1.01, ["limits"])])
def test_a_limit_may_be_a_tenth_of_a_degree_off(
    factor: float, found: list[str], end: int, sign: float
) -> None:
    """Their range is ours in their positions, also after full turns."""
    ours = RECORD.joints[0]
    ends = np.array([ours.lower, ours.upper])
    ends[end] += factor * LIMIT_TOLERANCE
    zero = 0.4 + 4 * math.pi
    lower, upper = sorted((sign * ends + zero).tolist())
    changed = correction(lower=lower, upper=upper)
    assert ids(limit_findings._range(changed, ours, sign, zero)) == found


def test_attributes_of_limits_that_are_not_ours() -> None:
    ours = RECORD.joints[0]
    assert correction().limits == ""
    assert correction(lower=None).limits == f'lower="{ours.lower:.5g}"'
    assert correction(upper=None).limits == f'upper="{ours.upper:.5g}"'
    near = LIMIT_TOLERANCE * 0.99
    assert correction(lower=ours.lower - near, upper=ours.upper + near).limits == ""
    far = correction(lower=0.0, upper=0.0, velocity=30.0)
    expected = 'lower="0.01745" upper="6.143" velocity="0.5236"'
    assert far.limits == expected
    assert far.text == f"axis_e: <limit {expected}/>"
    assert replace(far, ours=None).text == ""


@pytest.mark.parametrize("missing", ["lower", "upper"])
def test_half_a_range_is_none(missing: str) -> None:
    half = correction(**{missing: None})
    found = limit_findings._range(half, RECORD.joints[0], 1.0, 0.0)
    assert ids(found) == ["limits.none"]


@pytest.mark.parametrize(
    ("theirs", "ours", "in_degrees"),
    [
        (None, 1.0, False),
        # Read in degrees, from half of ours to one and a half.
        (math.degrees(1.51), 1.0, False),
        (math.degrees(1.5), 1.0, False),
        (math.degrees(0.5), 1.0, False),
        (math.degrees(1.49), 1.0, True),
        (math.degrees(0.51), 1.0, True),
        (math.degrees(0.49), 1.0, False),
        (math.degrees(-1.49), -1.0, True),
        (math.degrees(1.0), -1.0, False),
        # Half a turn more than three times ours might still be radians.
        (3 * 0.05 + math.pi - 0.001, 0.05, False),
        (3 * 0.05 + math.pi + 0.001, 0.05, True),
        (3 * 0.05 + math.pi, 0.05, True),
        (0.0, 0.0, False),
    ],
)
def test_what_seems_to_be_in_degrees(
    theirs: float | None, ours: float, in_degrees: bool
) -> None:
    assert seems_in_degrees(theirs, ours) == in_degrees


def test_poses_are_apart_by_their_shift_and_the_turn_at_the_arms_length() -> None:
    turned = np.eye(4)
    turned[1:3, 1:3] = [[0.0, -1.0], [1.0, 0.0]]
    turned[:3, 3] = [0.03, -0.04, 0.0]
    # The arm behind the joint is 0.4 m long.
    expected = 0.05 + 0.4 * math.pi / 2
    assert pose_distance(turned, np.eye(4)) == pytest.approx(expected)
    assert pose_distance(np.eye(4), turned) == pytest.approx(expected)


def test_an_origin_off_by_a_micrometre_is_not_written() -> None:
    for off, written in ((0.9e-6, False), (1.1e-6, True)):
        moved = ROBOT.joints["axis_b"].transform.copy()
        moved[1, 3] += off
        joint = ROBOT.joints["axis_b"]
        one = JointCorrection(joint=joint, origin=moved, axis=joint.axis)
        assert one.text.startswith("axis_b: <origin") == written
        assert one.off == pytest.approx(off, rel=1e-6)


# --- joints that mimic others


def led(name: str, leader: str | None, *ends: float | None, **more: float) -> UrdfJoint:
    joint = ROBOT.joints["axis_e"]
    return replace(joint, name=name, mimic=leader, lower=ends[0], upper=ends[1], **more)


def mimics(*joints: UrdfJoint) -> list[Finding]:
    other: Any = made_up(joints={joint.name: joint for joint in joints})
    return list(limit_findings.findings_of_mimics(other))


@pytest.mark.parametrize("multiplier", [2.0, -2.0])
@pytest.mark.parametrize(
    ("beyond", "found"), [(0.99e-4, 0), (1.01e-4, 1), (0.25, 1), (-0.25, 0)]
)
@pytest.mark.parametrize("end", [0, 1])
def test_a_mimic_beyond_either_limit(
    beyond: float, found: int, multiplier: float, end: int
) -> None:
    leader = led("rod", None, -0.1, 0.3)
    travel = sorted([multiplier * -0.1 + 0.5, multiplier * 0.3 + 0.5])
    ends = list(travel)
    ends[end] += beyond if end == 0 else -beyond
    joint = led("finger", "rod", *ends, multiplier=multiplier, offset=0.5)
    said = mimics(leader, joint)
    assert len(said) == found
    if said:
        assert said[0].text == f"mimics rod {beyond:.4g} beyond its own limit"
        low, high = travel
        advice = f'finger: <limit lower="{low:.5g}" upper="{high:.5g}"/>'
        assert said[0].instead == advice


def test_a_mimic_of_a_mimic_travels_as_advised() -> None:
    """Joints without limits are never beyond them."""
    leader = led("rod", None, 0.0, 1.0)
    second = led("finger", "rod", 0.0, 1.5, multiplier=2.0, offset=0.0)
    third = led("tip", "finger", 0.0, 1.8, multiplier=1.0, offset=0.0)
    first, last = mimics(leader, second, third)
    assert first.text == "mimics rod 0.5 beyond its own limit"
    assert last.text == "mimics finger 0.2 beyond its own limit"
    for endless in (led("rod", None, None, 1.0), led("rod", None, 0.0, None)):
        assert mimics(endless, second) == []
