"""`alpha5 compare`: the tool is where Pinocchio says, and the advice mends the file.

The tests take every defect alone, and a sample of pairs.
"""

from __future__ import annotations

import itertools
import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterable

import numpy as np
import pinocchio as pin
import pytest
import reference
import shared_recordings as recordings
from compared_models import AXES, advised, compared, text_of, tools
from model_defects import (
    DEFECTS,
    damaged,
    limits,
    put,
    shift,
    turn,
    vector,
    written,
)
from urdf_edits import OWN

from alpha5_model.cli import main

MODELS = recordings.RECORDINGS / "models"
SAMPLES = 40


def truth(text: str, count: int, frame: str, base: str, joints: Iterable[str] = AXES):
    """Distances [m] and angles [rad] of the tool from ours at the same positions."""
    q = np.random.default_rng(0).uniform(reference.LOWER, reference.UPPER, (count, 4))
    pairs = zip(
        tools(OWN, q, "tcp", "base_link", AXES),
        tools(text, q, frame, base, joints),
        strict=True,
    )
    apart = [ours.inverse() * theirs for ours, theirs in pairs]
    distances = [float(np.linalg.norm(one.translation)) for one in apart]
    return np.array(distances), np.array(
        [float(np.linalg.norm(pin.log3(one.rotation))) for one in apart]
    )


def check(*names: str) -> None:
    """The tool is where Pinocchio says, and with all advice where ours is."""
    root = damaged(*names)
    comparison = compared(root, samples=SAMPLES)
    frame = "lamp" if "no tool" in names else "tcp"
    if frame == "tcp":
        distances, angles = truth(text_of(root), SAMPLES, frame, "base_link")
        assert comparison.tool.frame == frame
        assert comparison.tool.base == "base_link"
        np.testing.assert_allclose(comparison.tool.distance, distances, atol=1e-6)
        np.testing.assert_allclose(
            np.sin(comparison.tool.angle / 2), np.sin(angles / 2), atol=1e-6
        )

    mended = advised(root, comparison)
    after = compared(mended, joints=comparison.joints, samples=SAMPLES)
    assert after.agrees, [f.text for f in after.findings]
    assert after.tip_error < 1e-5
    if frame == "tcp":
        distances, angles = truth(mended, SAMPLES, frame, "base_link")
        assert distances.max() < 1e-5
        assert angles.max() < 1e-4


def failures(cases: Iterable[tuple[str, ...]]) -> list[str]:
    """The cases that fail, with the first words of why."""
    failed = []
    for names in cases:
        try:
            check(*names)
        except AssertionError as error:
            failed.append(f"{names}: {str(error)[:200]}")
    return failed


@pytest.mark.parametrize("name", ["tool beside", "elbow tilted"])
def test_a_defect_is_measured_and_the_advice_mends_it(name):
    check(name)


@pytest.mark.slow
def test_each_defect_is_measured_and_the_advice_mends_it():
    assert failures((name,) for name in DEFECTS) == []


@pytest.mark.slow
@pytest.mark.parametrize("part", range(4))
def test_pairs_of_defects(part):
    pairs = list(itertools.combinations(DEFECTS, 2))
    chosen = np.random.default_rng(23).choice(len(pairs), 60, replace=False)
    # Nothing but its name and place shows the base.
    tilted = "axis_e turned about x"
    sample = [(tilted, "link_0 elsewhere"), (tilted, "no inertials")]
    sample += [pairs[k] for k in chosen]
    assert failures(sample[part::4]) == []


def test_a_short_pi_says_how_far_it_moves_the_tip():
    root = damaged("short pi")
    comparison = compared(root, samples=SAMPLES)
    distances, _ = truth(text_of(root), SAMPLES, "tcp", "base_link")
    (found,) = [f for f in comparison.findings if "pi are cut short" in f.text]
    assert f"the tip is up to {1e3 * distances.max():.2f} mm off" in found.text


@pytest.mark.parametrize("reversed_too", [False, True])
@pytest.mark.parametrize(("zero", "sure"), [(0.7, True), (0.02, False)])
def test_a_small_zero_of_axis_e_may_be_the_base(zero, sure, reversed_too):
    """A COM of link_0 that is 2 mm off tells a large turn of it, and no small one."""
    root = damaged(*["axis_e reversed"][: int(reversed_too)])
    turn("axis_e", 0, 0, zero)(root)
    com = root.find("link[@name='link_0']/inertial/origin")
    moved_com = vector(com.get("xyz")) + np.array([0.0, 0.0, 0.002])
    com.set("xyz", written(moved_com))
    comparison = compared(root, samples=SAMPLES)
    (found,) = [f for f in comparison.findings if "zero is shifted" in f.text]
    assert ("or else the base" not in found.text) == sure


def test_a_tool_elsewhere_in_the_gripper_is_in_the_verdict(tmp_path, capsys) -> None:
    """30 mm stood in a remark, below a verdict that said nothing of them."""
    root = ET.fromstring(OWN)
    put("tcp_fixed", xyz="0 0 -0.15")(root)
    comparison = compared(root)
    assert comparison.agrees
    assert comparison.tool.offset == pytest.approx(0.03)
    assert comparison.verdict.endswith("but its tcp is 30 mm from ours.")
    path = tmp_path / "other.urdf"
    path.write_text(text_of(root))
    assert main(["compare", str(path), "--samples", "5"]) == 0
    assert "30 mm from ours" in capsys.readouterr().out
    assert compared(advised(root, comparison)).findings == ()


@pytest.mark.parametrize(
    ("rpy", "askew"),
    [((0.0, 0.0, 0.5), False), ((0.3, 0.0, 0.0), True), ((0.0, 0.2, 0.0), True)],
)
def test_a_tool_askew_differs(rpy: tuple[float, float, float], askew: bool) -> None:
    root = ET.fromstring(OWN)
    put("tcp_fixed", rpy=written(rpy))(root)
    comparison = compared(root)
    assert comparison.agrees != askew
    assert [f.id for f in comparison.findings] == ["tool" if askew else "tool.choice"]


@pytest.mark.parametrize("degrees", [5, 100, 170])
def test_a_tilted_base_says_by_how_much(degrees):
    root = ET.fromstring(OWN)
    turn("axis_e", math.radians(degrees), 0, 0)(root)
    comparison = compared(root, samples=SAMPLES)
    (found,) = [f for f in comparison.findings if "tilted by" in f.text]
    assert f"tilted by {degrees:.3f} deg" in found.text


def test_rounding_of_the_base_is_no_mount():
    text = OWN.replace("base_link", "platform")
    root = ET.fromstring(text)
    turn("link_0_fixed", 0, 0, 1e-9)(root)
    shift("link_0_fixed", 1e-9, 0, 0)(root)
    comparison = compared(root, samples=SAMPLES)
    assert [f for f in comparison.findings if f.where == "base"] == []


# --- public models

#: File -> joints, the frame of its tool, base; the tool frame's distance from Table 1's
#: {5} [mm].
PUBLIC = {
    "evan_palmer_alpha": (AXES, "standard_jaws_tool", "base_link", 7.25),
    "diff_uvms": ([f"alpha_{axis}" for axis in AXES], "", "base_link", None),
    "hkolano_blue_rov": (
        [f"r5m_joint{k}" for k in (5, 4, 3, 2)],
        "",
        "r5m_base_link",
        None,
    ),
}
NO_MODELS = pytest.mark.skipif(
    not MODELS.is_dir(), reason="no public models beside the checkout"
)


@NO_MODELS
@pytest.mark.parametrize("name", PUBLIC)
def test_the_tool_of_public_models(name):
    joints, frame, base, away = PUBLIC[name]
    text = (MODELS / f"{name}.urdf").read_text()
    mapped = dict(zip(AXES, joints, strict=True))
    comparison = compared(text, joints=mapped, samples=SAMPLES)
    tool = comparison.tool
    assert tool.frame == frame
    if frame:
        distances, _ = truth(text, SAMPLES, frame, base, joints)
        np.testing.assert_allclose(tool.distance, distances, atol=1e-6)
        (said,) = [f for f in comparison.findings if f.where == "tool"]
        assert not said.serious
        assert f"{away:.2f} mm from Table 1's frame {{5}}" in said.text

    mended_text = advised(text, comparison)
    after = compared(mended_text, joints=mapped, samples=SAMPLES)
    assert after.agrees, [f.text for f in after.findings]
    assert after.tip_error < 1e-4
    if frame:
        distances, angles = truth(mended_text, SAMPLES, frame, base, joints)
        assert distances.max() < 1e-4
        assert angles.max() < 1e-3


#: The axes of a public model as written; its mesh frames are the manufacturer's.
WITHOUT_TURN = """
<robot name="arm"><link name="base_link"/>
<link name="m3"/><link name="m2_1_1"/><link name="m2"/><link name="m2_1_2"/>
<link name="m1"/><link name="jaws"/><link name="alpha_tcp"/>
<joint name="mount" type="fixed"><parent link="base_link"/><child link="m3"/></joint>
<joint name="joint_1" type="revolute"><parent link="m3"/><child link="m2_1_1"/>
  <origin xyz="0 0 0.014"/><axis xyz="0 0 1"/></joint>
<joint name="joint_2" type="revolute"><parent link="m2_1_1"/><child link="m2"/>
  <origin xyz="-0.02 0 0.033"/><axis xyz="0 1 0"/></joint>
<joint name="joint_3" type="revolute"><parent link="m2"/><child link="m2_1_2"/>
  <origin xyz="-0.04 0 -0.1453" rpy="0 0 {turn}"/><axis xyz="0 1 0"/></joint>
<joint name="joint_4" type="revolute"><parent link="m2_1_2"/><child link="m1"/>
  <origin xyz="0.02 0 0.033"/><axis xyz="0 0 -1"/></joint>
<joint name="jaws_joint" type="fixed"><parent link="m1"/><child link="jaws"/>
  <origin xyz="0 0 0.09975"/></joint>
<joint name="tcp_joint" type="fixed"><parent link="jaws"/><child link="alpha_tcp"/>
  <origin xyz="0 0 0.09"/></joint>
</robot>
"""
JOINTS = [f"joint_{k}" for k in (1, 2, 3, 4)]


@pytest.mark.parametrize(("turn", "median"), [("0", 268.4), ("3.14159", 43.2)])
def test_a_public_model_that_lacks_a_turn_of_the_forearm(turn, median):
    """268.5 mm is what a Pinocchio script of somebody else measured of it."""
    limit = '"/><limit lower="0" upper="3" effort="9" velocity="1"/></joint>'
    text = WITHOUT_TURN.format(turn=turn)
    text = re.sub(r'(<axis[^>]*)"/></joint>', rf"\1{limit}", text)
    comparison = compared(text, samples=2000)
    distances, _ = truth(text, 200, "alpha_tcp", "base_link", JOINTS)
    measured = compared(text, samples=200).tool
    np.testing.assert_allclose(measured.distance, distances, atol=1e-6)
    assert np.median(comparison.tool.distance) * 1e3 == pytest.approx(median, abs=0.5)
    serious = {
        f.where for f in comparison.findings if f.serious and f.where.startswith("axis")
    }
    # Either joint_3 is turned, or its axis and the wrist are mirrored: the same arm.
    assert serious == ({"axis_c", "axis_b", "axis_d"} if turn == "0" else {"axis_d"})
    (tool,) = [f for f in comparison.findings if f.where == "tool"]
    assert not tool.serious
    assert "42.75 mm from Table 1's frame {5}" in tool.text


# --- limits in degrees


def test_limits_in_degrees_are_called_that():
    root = damaged("limits in degrees")
    comparison = compared(root, samples=5)
    said = [f for f in comparison.findings if f.where == "axis_e"]
    assert [f.serious for f in said] == [True, True]
    assert "velocity 30 is in degrees per second" in said[0].text
    assert "limits 1 to 351.97 are in degrees" in said[1].text
    for finding in said:
        line = 'axis_e: <limit lower="0.01745" upper="6.143" velocity="0.5236"/>'
        assert finding.instead == line


@pytest.mark.parametrize(
    "values", [{"upper": 6.3}, {"lower": -3.49}, {"velocity": 10.0}]
)
def test_other_limits_are_not(values):
    root = ET.fromstring(OWN)
    limits("axis_e", **values)(root)
    comparison = compared(root, samples=5)
    assert not any("degrees" in f.text for f in comparison.findings)
    assert comparison.agrees
