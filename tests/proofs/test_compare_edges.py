"""`compare` at the edges: what differs by just the tolerance is no finding.

The evidence is made up, so that a difference is exactly the tolerance or a hair more.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
import test_compare_tool
from urdf_edits import OWN

import alpha5_model as a5
from alpha5_model.description.reading import parse_urdf
from alpha5_model.description.urdf_robot import UrdfJoint
from alpha5_model.proofs.comparison import axis_findings, base_findings, limit_findings
from alpha5_model.proofs.comparison.alignment import (
    ANGLE_TOLERANCE,
    LENGTH_TOLERANCE,
    SAME_ZERO,
    Alignment,
    Tolerance,
    allowed,
)
from alpha5_model.proofs.comparison.body_findings import (
    COM_TOLERANCE,
    INERTIA_TOLERANCE,
    MASS_TOLERANCE,
    BodyCase,
    _dummies,
    _rounded,
    findings_of_body,
)
from alpha5_model.proofs.comparison.body_replacement import Replacement
from alpha5_model.proofs.comparison.chains import find_chains
from alpha5_model.proofs.comparison.correction import (
    LEVER,
    LIMIT_TOLERANCE,
    JointCorrection,
    pose_distance,
    seems_in_degrees,
)
from alpha5_model.proofs.comparison.hypotheses import hypotheses_of
from alpha5_model.proofs.comparison.inertials import Inertial
from alpha5_model.proofs.comparison.measure import compare_robots
from alpha5_model.proofs.comparison.own_arm import own_arm_of
from alpha5_model.proofs.comparison.printed_digits import Rounding
from alpha5_model.proofs.comparison.records import BodyDifference, Comparison, Finding
from alpha5_model.proofs.comparison.reduction import reduce_robot
from alpha5_model.proofs.comparison.tool_findings import JAWS_FROM, _on_gripper

RECORD = a5.parameters()
ROBOT = parse_urdf(OWN)
#: A hair more.
MORE = 1.0 + 1e-9


def made_up(**parts: Any) -> Any:
    return SimpleNamespace(**parts)


def ids(found: Any) -> list[str]:
    return [one.id for one in found]


# --- axes


@pytest.mark.parametrize("tolerance", [Tolerance(1e-3, 0.1), Tolerance(0.1, 1e-3)])
def test_a_dimension_off_by_its_tolerance_is_none(
    tolerance: Tolerance, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first four dimensions are lengths, the others angles."""
    monkeypatch.setattr(
        axis_findings, "_dimension", lambda evidence, index, change: index
    )
    just = np.repeat([tolerance.length, tolerance.angle], 4)
    for factor, found in ((1.0, []), (MORE, [*range(8)]), (-MORE, [*range(8)])):
        alignment = Alignment(dimensions=factor * just)
        evidence = made_up(alignment=alignment, tolerance=tolerance)
        assert list(axis_findings._dimensions(evidence)) == found


def test_a_zero_off_by_its_tolerance_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(axis_findings, "_shifted", lambda evidence, joint: joint)
    tolerance = Tolerance(length=1.0, angle=0.01)
    for factor, found in ((1.0, []), (MORE, [0, 1, 2, 3]), (-MORE, [0, 1, 2, 3])):
        alignment = Alignment(zero=np.full(4, factor * tolerance.angle))
        evidence = made_up(alignment=alignment, tolerance=tolerance)
        assert list(axis_findings._zeros(evidence)) == found


@pytest.mark.parametrize(
    ("zero", "words"),
    [
        (ANGLE_TOLERANCE, ""),
        (
            -ANGLE_TOLERANCE * MORE,
            ", zero of axis_d -0.01 deg, zero of axis_c 0.57 deg",
        ),
        (0.01, ", zero of axis_d 0.57 deg, zero of axis_c 0.57 deg"),
        (0.01 * MORE, ""),
    ],
)
def test_zeros_that_the_digits_explain_are_said(zero: float, words: str) -> None:
    """Those of axis_d and axis_c, which are fitted; the other two are not."""
    other = zero if not words else 0.01
    alignment = Alignment(zero=np.array([0.005, zero, other, 0.005]))
    evidence = made_up(alignment=alignment, tolerance=Tolerance(1.0, 0.01))
    assert axis_findings._small_zeros(evidence) == words


@pytest.mark.parametrize(
    ("off", "found", "rounded"),
    [
        (LENGTH_TOLERANCE, [], ""),
        (LENGTH_TOLERANCE * MORE, [], "text; text"),
        (3 * (0.001 + LEVER * 0.01), [], "text; text"),
        (3 * (0.001 + LEVER * 0.01) * MORE, ["misplaced"] * 2, ""),
    ],
)
def test_a_joint_is_misplaced_beyond_three_times_the_tolerance(
    off: float, found: list[str], rounded: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(axis_findings, "_digits", lambda evidence, line: [line])
    evidence = made_up(tolerance=Tolerance(length=0.001, angle=0.01))
    correction: Any = made_up(off=off, text="text", ours=None)
    *misplaced, line = axis_findings.findings_of_rest(evidence, [correction] * 2)
    assert ids(misplaced) == found
    assert line == rounded


@pytest.mark.parametrize("line", ["", "axis_e: <origin/>"])
@pytest.mark.parametrize("zeros", ["", ", zero of axis_d 0.02 deg"])
@pytest.mark.parametrize("residual", [LENGTH_TOLERANCE, LENGTH_TOLERANCE * MORE])
@pytest.mark.parametrize("tip", [LENGTH_TOLERANCE, LENGTH_TOLERANCE * MORE])
def test_digits_are_named_if_they_are_seen(
    tip: float, residual: float, zeros: str, line: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What pi explains is written there, and not once more for the other digits."""
    monkeypatch.setattr(axis_findings, "_small_zeros", lambda evidence: zeros)
    monkeypatch.setattr(axis_findings, "_tips", lambda evidence, arm, q: arm)
    evidence = made_up(
        alignment=Alignment(residual=(residual, 0.5)),
        tolerance=Tolerance(length=0.002, angle=0.01),
        theirs=np.array([[0.0, 0.0, 0.0], [tip, 0.0, 0.0]]),
        written=np.zeros((2, 3)),
        q=np.zeros((2, 4)),
    )
    found = list(axis_findings._digits(evidence, line))

    pi_is_seen = tip > LENGTH_TOLERANCE
    others_are_seen = residual > LENGTH_TOLERANCE or zeros or (line and not pi_is_seen)
    expected = ["digits.of_pi"] * pi_is_seen + ["digits"] * bool(others_are_seen)
    assert ids(found) == expected
    assert [one.instead for one in found if one.instead] == [line] * bool(
        line and found
    )
    if pi_is_seen:
        assert "up to 0.01 mm off" in found[0].text
    if others_are_seen:
        words = f"2 mm and 0.57 deg: residual 0.01 mm, 28.6479 deg rms{zeros}"
        assert found[-1].text.endswith(words)


def test_a_zero_of_a_quarter_degree_is_ours() -> None:
    assert Alignment(zero=np.full(4, -SAME_ZERO)).oddities == 0
    assert Alignment(zero=np.full(4, -SAME_ZERO * MORE)).oddities == 4


def test_an_alignment_of_nothing() -> None:
    """That of another arm: nothing is known of it, and JSON has whole matrices."""
    said = Finding(where="arm", text="odd")
    nothing = Comparison(name="other", findings=(said,))
    assert nothing.alignment.base.tolist() == np.eye(4).tolist()
    assert nothing.alignment.stands.tolist() == np.eye(4).tolist()
    assert nothing.alignment.sign.tolist() == [1, 1, 1, 1]
    assert nothing.alignment.zero.tolist() == [0, 0, 0, 0]
    assert not nothing.alignment.same_base
    assert nothing.gravity_error.shape == (4,)
    assert nothing.as_dict()["gravity_error_Nm"] == [None] * 4
    assert (said.serious, said.cost) == (True, 0.0)


def test_what_the_printed_digits_allow() -> None:
    """A rounded length turns the axes by its share of the upper arm."""
    upper_arm = math.hypot(0.04, 0.1453)
    digits = Rounding(length=0.003, angle=0.02, pi=0.01)
    theirs: Any = made_up(digits=digits)
    turn = 0.003 / upper_arm
    assert allowed(RECORD, theirs) == pytest.approx((0.003, math.hypot(0.02, turn)))
    with_pi = allowed(RECORD, theirs, short_pi=True)
    turned = math.sqrt(0.02**2 + turn**2 + 0.02**2)
    assert with_pi == pytest.approx((upper_arm * 0.02, turned))
    exact: Any = made_up(digits=Rounding(0.0, 0.0, 0.0))
    assert allowed(RECORD, exact, short_pi=True) == (1e-5, 1e-4)


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
    test_compare_tool.turn("axis_e", 0.0, 0.0, zero)(root)
    com = np.add(RECORD.links[0].com, [0.0, 0.0, off])
    xyz = test_compare_tool.written(com)
    test_compare_tool.inertial("link_0", "origin", xyz=xyz)(root)
    found = compare_robots(parse_urdf(ET.tostring(root)), samples=5).findings
    (shifted,) = [one for one in found if one.id.startswith("zero")]
    assert (shifted.id == "zero") == sure
    radius = math.hypot(*RECORD.links[0].com[:2])
    turned = math.hypot(2 * radius * math.sin(zero / 2), off)
    assert sure == (off < 0.001 or turned > 3 * off)


def test_without_a_mass_of_link_0_nothing_tells_them_apart() -> None:
    root = ET.fromstring(OWN)
    test_compare_tool.turn("axis_e", 0.0, 0.0, 0.7)(root)
    test_compare_tool.inertial("link_0", "mass", value="0")(root)
    found = compare_robots(parse_urdf(ET.tostring(root)), samples=5).findings
    assert "zero.or_base" in ids(found)


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
    test_compare_tool.turn("axis_b", 0.0, 0.0, roll)(root)
    izz = link.inertia[2, 2] + error / ratio
    test_compare_tool.inertial("link_4", "inertia", izz=repr(float(izz)))(root)
    alignment = compare_robots(parse_urdf(ET.tostring(root)), samples=5).alignment
    assert alignment.zero[3] == pytest.approx(-roll if shifted else 0.0, abs=1e-9)


# --- the base


@pytest.mark.parametrize(
    ("shift", "tilt", "found"),
    [
        ((0.002, 0.0, 0.0), 0.0, []),
        ((0.0, -0.002 * MORE, 0.0), 0.0, ["beside"]),
        ((0.0, 0.0, 0.002), 0.0, []),
        ((0.0, 0.0, 0.002 * MORE), 0.0, ["height"]),
        ((0.0, 0.0, -0.002 * MORE), 0.0, ["height"]),
        ((0.0, 0.0, 0.05), 0.0099, ["height"]),
        ((0.0, 0.0, 0.0), 0.0101, ["beside"]),
    ],
)
def test_a_shoulder_off_by_its_tolerance_is_none(
    shift: tuple[float, float, float], tilt: float, found: list[str]
) -> None:
    stands = np.eye(4)
    stands[:3, 3] = shift
    stands[1:3, 1:3] = [
        [math.cos(tilt), -math.sin(tilt)],
        [math.sin(tilt), math.cos(tilt)],
    ]
    evidence = made_up(
        alignment=Alignment(stands=stands, same_base=True, base_link="foot"),
        tolerance=Tolerance(length=0.002, angle=0.01),
        joint_replacements=["one", "", "three", ""],
        parameters=RECORD,
    )
    said = list(base_findings.findings_of_shoulder(evidence))
    assert ids(said) == found
    assert [one.instead for one in said] == ["one"] * len(found)
    if found == ["height"]:
        way = "lower" if shift[2] < 0 else "higher"
        height = 46.2 - 1e3 * shift[2]
        off = abs(1e3 * shift[2])
        assert said[0].text.startswith(f"lies {height:.2f} mm above foot, but d_0 is")
        assert f"the base is {off:.2f} mm {way}, and" in said[0].text
    evidence.alignment = replace(evidence.alignment, same_base=False)
    assert list(base_findings.findings_of_shoulder(evidence)) == []


@pytest.mark.parametrize("same_base", [False, True])
@pytest.mark.parametrize(
    ("shift", "turn", "found"),
    [
        (LENGTH_TOLERANCE, 0.0, False),
        (LENGTH_TOLERANCE * MORE, 0.0, True),
        (0.0, 0.9 * ANGLE_TOLERANCE, False),
        (0.0, 1.1 * ANGLE_TOLERANCE, True),
        (0.0, 3.0, True),
    ],
)
def test_a_root_off_by_the_tolerance_is_no_mount(
    shift: float, turn: float, found: bool, same_base: bool
) -> None:
    base = np.eye(4)
    base[:2, :2] = [[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]]
    base[2, 3] = -shift
    elsewhere = np.eye(4)
    elsewhere[0, 3] = 0.4
    evidence = made_up(
        alignment=Alignment(base=base, base_link="foot", same_base=same_base),
        theirs=made_up(link_poses={"foot": elsewhere}),
        other=made_up(root="world"),
    )
    said = list(base_findings._mount(evidence))
    name = "mount" if same_base else "mount.or_zero"
    assert ids(said) == [name] * found
    if found:
        assert f"turned by {math.degrees(turn):.2f} deg" in said[0].text
    # A base_link at the root is no mount, however the axes lie.
    evidence.theirs.link_poses["foot"] = np.eye(4)
    assert ids(base_findings._mount(evidence)) == [name] * (found and not same_base)


@pytest.mark.parametrize("count", [0, 1, 3, 4, 5])
def test_three_of_the_carried_links_are_named(count: int) -> None:
    masses = {f"l{k}": float(k) for k in range(1, count + 1)}
    links = {name: made_up(mass=mass) for name, mass in masses.items()}
    evidence = made_up(
        theirs=made_up(foreign_links=(*masses, "light"), mass=[0.2, 9.0, 9.0]),
        other=made_up(links=links | {"light": made_up(mass=None)}),
        parameters=RECORD,
    )
    said = list(base_findings._carried(evidence))
    assert len(said) == bool(count)
    if count:
        heaviest = [f"l{k} ({k} kg)" for k in range(count, 0, -1)][:3]
        names = ", ".join(heaviest)
        if count > 3:
            total = count * (count + 1) / 2
            names += f" and {count - 3} more, {total:g} kg in all"
        assert f"left out of link_0: {names}; with it" in said[0].text
        excess = sum(masses.values()) + 0.2 - RECORD.links[0].mass
        assert f"would be {excess:.1f} kg too heavy" in said[0].text


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


# --- bodies


def case(body: int = 2, **changes: Any) -> BodyCase:
    """A body of ours with other numbers, written by one link in our frame."""
    ours = RECORD.links[body]
    difference = BodyDifference(
        name=ours.name,
        links=("limb",),
        mass=ours.mass,
        com=ours.com,
        inertia=ours.inertia,
        ours=ours,
    )
    difference = replace(difference, **changes)
    written = Inertial(
        link="limb",
        mass=difference.mass,
        com=difference.com,
        inertia=difference.inertia,
        pose=np.eye(4),
    )
    return BodyCase(
        body=difference,
        known=hypotheses_of(own_arm_of(RECORD), body),
        written=[written],
        bare=[],
        instead=Replacement(),
        cost=lambda body, mass, moment: 0.0,
    )


@pytest.mark.parametrize("body", range(5))
@pytest.mark.parametrize(("factor", "wrong"), [(0.999, False), (1.001, True)])
def test_a_body_off_by_its_tolerances_is_right(
    factor: float, wrong: bool, body: int
) -> None:
    ours = RECORD.links[body]
    kind = "body.inertia_of_wrist" if body == 4 else "body.inertia"

    def ids_of(**changes: Any) -> list[str]:
        found = ids(findings_of_body(case(body, **changes)))
        return [one for one in found if one != "body.impossible"]

    heavier = ours.mass * (1 - factor * MASS_TOLERANCE)
    assert ids_of(mass=heavier) == ["body.mass"] * wrong
    moved = np.add(ours.com, [0.0, factor * COM_TOLERANCE, 0.0])
    assert ids_of(com=moved) == ["body.com"] * wrong
    slack = 0.003
    moved = np.add(ours.com, [0.0, factor * (COM_TOLERANCE + slack), 0.0])
    assert ids_of(com=moved, slack=slack) == ["body.com"] * wrong
    other = ours.inertia.copy()
    other[2, 2] += factor * INERTIA_TOLERANCE * np.abs(ours.inertia).max()
    assert ids_of(inertia=other) == [kind] * wrong


def test_a_com_at_the_joint_is_not_on_its_wrong_side() -> None:
    for z, kind in ((0.0, "body.com"), (1e-6, "body.com_beyond")):
        com = np.array([0.0, 0.0, z])
        assert kind in ids(findings_of_body(case(4, com=com)))
        assert "body.com" in ids(findings_of_body(case(3, com=com)))


@pytest.mark.parametrize(
    ("mass", "factor", "found"),
    [
        (1e-3, MORE, ["dummy"]),
        (1e-3, 1 / MORE, []),
        (1e-3 * MORE, MORE, ["dummy.heavy"]),
        (0.0, MORE, []),
    ],
)
def test_a_link_with_a_radius_of_gyration_beyond_the_arm_is_a_dummy(
    mass: float, factor: float, found: list[str]
) -> None:
    """The arm is 0.6 m long, stretched out."""
    inertia = max(mass, 1e-3) * 0.36 * factor * np.eye(3)
    link = Inertial("tool", mass, np.zeros(3), inertia, np.eye(4))
    said = list(_dummies("link_4", [link]))
    assert ids(said) == found
    if said:
        assert "tool has" in said[0].text
        assert "a radius of gyration of 0.60 m" in said[0].text


def test_dummies_of_other_masses_or_inertias_are_named_apart() -> None:
    numbers = ((1e-4, 1e-4), (1e-4, 2e-4), (2e-4, 2e-4), (1e-4, 1e-4))
    links = [
        Inertial(f"l{k}", mass, np.zeros(3), inertia * np.eye(3), np.eye(4))
        for k, (mass, inertia) in enumerate(numbers)
    ]
    said = [one.text.split(" kg ")[0] for one in _dummies("link_4", links)]
    assert said == [
        "dummy links l0, l3 have 0.1 g and 0.0001",
        "dummy link l1 has 0.1 g and 0.0002",
        "dummy link l2 has 0.2 g and 0.0002",
    ]


def test_a_com_that_the_mended_joints_move_by_its_tolerance() -> None:
    ours = RECORD.links[2].com
    for factor, found in ((0.999, []), (1.001, ["digits.of_body"])):
        com = np.add(ours, [0.0, 0.0, factor * COM_TOLERANCE])
        said = list(_rounded(case(2), com))
        assert ids(said) == found
        assert all("COM 0.10 mm off" in one.text for one in said)
        assert list(_rounded(case(2, mass=0.0), com)) == []


# --- the tool


@pytest.mark.parametrize(
    ("point", "on"),
    [
        ((0.0, 0.0, -JAWS_FROM), True),
        ((0.0, 0.0, -JAWS_FROM + 1e-9), False),
        ((0.0, 0.0, RECORD.links[4].bounds[2, 0]), True),
        ((0.0, 0.0, RECORD.links[4].bounds[2, 0] - 1e-9), False),
        ((0.0018, 0.0024, -0.18), True),
        ((0.0018, 0.0025, -0.18), False),
        ((-0.0031, 0.0, -0.18), False),
    ],
)
def test_a_tool_is_on_the_gripper_between_its_collar_and_the_finger_tips(
    point: tuple[float, float, float], on: bool
) -> None:
    """It may be 2 mm beside the axis, and 1 mm more by its digits."""
    evidence: Any = made_up(parameters=RECORD, tolerance=Tolerance(0.00101, 0.01))
    assert _on_gripper(evidence, np.array(point)) == on


def test_the_tolerance_of_our_own_arm_is_that_of_nothing_printed() -> None:
    chain = find_chains(ROBOT, RECORD)[0]
    arm = reduce_robot(ROBOT, chain.joints, RECORD)
    # The URDF is written to the last digit of a double.
    assert allowed(RECORD, arm, short_pi=True) == (LENGTH_TOLERANCE, ANGLE_TOLERANCE)
