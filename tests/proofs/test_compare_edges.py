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
from alpha5_model.proofs.comparison import axis_findings, base_findings
from alpha5_model.proofs.comparison.alignment import (
    ANGLE_TOLERANCE,
    LENGTH_TOLERANCE,
    SAME_ZERO,
    Alignment,
    Tolerance,
    allowed,
)
from alpha5_model.proofs.comparison.correction import (
    LEVER,
)
from alpha5_model.proofs.comparison.measure import compare_robots
from alpha5_model.proofs.comparison.printed_digits import Rounding
from alpha5_model.proofs.comparison.records import Comparison, Finding

RECORD = a5.parameters()
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
