"""`alpha5 compare`: the tool is where Pinocchio says, and the advice mends the file.

The tests take every defect alone, and a sample of pairs.
``python tests/proofs/test_compare_tool.py`` runs every pair.
"""

from __future__ import annotations

import itertools
import math
import re
import sys
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterable

import numpy as np
import pinocchio as pin
import pytest
import reference
import shared_recordings as recordings
from urdf_edits import OWN

from alpha5_model.description.reading import parse_urdf
from alpha5_model.proofs.comparison.measure import compare_robots
from alpha5_model.proofs.comparison.records import Comparison, Finding
from alpha5_model.proofs.comparison.tool_findings import _axes_are_a_choice

AXES = ("axis_e", "axis_d", "axis_c", "axis_b")
MODELS = recordings.RECORDINGS / "models"
SAMPLES = 40
Defect = Callable[[ET.Element], None]


# --- the defects


def rotation(rpy: Iterable[float]) -> np.ndarray:
    return pin.rpy.rpyToMatrix(*(float(x) for x in rpy))


def vector(text: str) -> np.ndarray:
    return np.array(text.split(), float)


def written(values: Iterable[float]) -> str:
    return " ".join(repr(float(x)) for x in values)


def origin_of(root: ET.Element, joint: str) -> ET.Element:
    return root.find(f"joint[@name='{joint}']/origin")


def put(joint: str, xyz: str = "", rpy: str = "") -> Defect:
    """Another origin."""

    def change(root: ET.Element) -> None:
        element = origin_of(root, joint)
        element.attrib.update({k: v for k, v in (("xyz", xyz), ("rpy", rpy)) if v})

    return change


def shift(joint: str, *by: float) -> Defect:
    """The origin moved in the parent's axes [m]."""

    def change(root: ET.Element) -> None:
        element = origin_of(root, joint)
        element.set("xyz", written(vector(element.get("xyz")) + by))

    return change


def turn(joint: str, *rpy: float) -> Defect:
    """The child turned in its own axes [rad]."""

    def change(root: ET.Element) -> None:
        element = origin_of(root, joint)
        whole = rotation(vector(element.get("rpy"))) @ rotation(rpy)
        element.set("rpy", written(pin.rpy.matrixToRpy(whole)))

    return change


def reverse(joint: str) -> Defect:
    def change(root: ET.Element) -> None:
        element = root.find(f"joint[@name='{joint}']/axis")
        element.set("xyz", written(-vector(element.get("xyz"))))

    return change


def limits(joint: str, **values: float) -> Defect:
    def change(root: ET.Element) -> None:
        element = root.find(f"joint[@name='{joint}']/limit")
        element.attrib.update({name: repr(value) for name, value in values.items()})

    return change


def in_degrees(joint: str) -> Defect:
    def change(root: ET.Element) -> None:
        element = root.find(f"joint[@name='{joint}']/limit")
        for name in ("lower", "upper", "velocity"):
            element.set(name, f"{math.degrees(float(element.get(name))):.2f}")

    return change


def inertial(link: str, tag: str, **values: str) -> Defect:
    def change(root: ET.Element) -> None:
        root.find(f"link[@name='{link}']/inertial/{tag}").attrib.update(values)

    return change


def without(link: str, tag: str) -> Defect:
    def change(root: ET.Element) -> None:
        element = root.find(f"link[@name='{link}']")
        for child in element.findall(tag):
            element.remove(child)

    return change


def no_inertials(root: ET.Element) -> None:
    for link in root.iter("link"):
        for child in link.findall("inertial"):
            link.remove(child)


def renamed_tool(root: ET.Element) -> None:
    """No frame that anybody would take for the tool's."""
    root.find("link[@name='tcp']").set("name", "lamp")
    root.find("joint[@name='tcp_fixed']/child").set("link", "lamp")


def mounted(root: ET.Element) -> None:
    ET.SubElement(root, "link", name="vehicle")
    joint = ET.SubElement(root, "joint", name="mount", type="fixed")
    ET.SubElement(joint, "parent", link="vehicle")
    ET.SubElement(joint, "child", link="base_link")
    ET.SubElement(joint, "origin", xyz="0.3 -0.2 0.5", rpy="0.3 -1.1 2.0")


def other_frames(root: ET.Element) -> None:
    """Move and turn the frame of link_3 about its joint axis; all else stays."""
    frame = pin.SE3(rotation((0, 0, 0.8)), np.array([0, 0, 0.011]))

    def moved(element: ET.Element, before: pin.SE3, after: pin.SE3) -> None:
        at = pin.SE3(
            rotation(vector(element.get("rpy", "0 0 0"))), vector(element.get("xyz"))
        )
        at = before * at * after
        element.set("xyz", written(at.translation))
        element.set("rpy", written(pin.rpy.matrixToRpy(at.rotation)))

    none = pin.SE3.Identity()
    moved(origin_of(root, "axis_c"), none, frame)
    moved(origin_of(root, "axis_b"), frame.inverse(), none)
    link = root.find("link[@name='link_3']")
    for tag in ("inertial", "visual", "collision"):
        for element in link.findall(f"{tag}/origin"):
            moved(element, frame.inverse(), none)


def cut_digits_of_pi(root: ET.Element) -> None:
    """Write pi and pi/2 with two decimals in every origin."""
    for origin in root.iter("origin"):
        rpy = origin.get("rpy")
        rpy = rpy.replace("3.141592653589793", "3.14")
        origin.set("rpy", rpy.replace("1.5707963267948966", "1.57"))


def all_limits_in_degrees(root: ET.Element) -> None:
    for axis in AXES:
        in_degrees(axis)(root)


DEFECTS: dict[str, Defect] = {
    "tool on the other side": put("tcp_fixed", xyz="0 0 0.18"),
    "tool too far": put("tcp_fixed", xyz="0 0 -0.25"),
    "tool beside": shift("tcp_fixed", 0.03, 0.01, 0),
    "tool at the finger tips": put("tcp_fixed", xyz="0 0 -0.22275"),
    "tool turned": turn("tcp_fixed", 0.3, -0.2, 0.1),
    "tool with other axes": put("tcp_fixed", rpy="0 0 0"),
    "no tool": renamed_tool,
    "axis_e turned about z": turn("axis_e", 0, 0, math.pi),
    "axis_d turned about z": turn("axis_d", 0, 0, math.pi),
    "axis_c turned about z": turn("axis_c", 0, 0, math.pi),
    "axis_c turned about x": turn("axis_c", math.pi, 0, 0),
    "axis_c turned about y": turn("axis_c", 0, math.pi, 0),
    "axis_d turned about x": turn("axis_d", math.pi, 0, 0),
    "axis_b turned about x": turn("axis_b", math.pi, 0, 0),
    "axis_b turned about y": turn("axis_b", 0, math.pi, 0),
    "axis_e turned about x": turn("axis_e", math.pi, 0, 0),
    "zero of axis_e": turn("axis_e", 0, 0, 0.7),
    "zero of axis_d": turn("axis_d", 0, 0, -0.4),
    "zero of axis_c": turn("axis_c", 0, 0, 1.9),
    "zero of axis_b": turn("axis_b", 0, 0, 0.5),
    "axis_e reversed": reverse("axis_e"),
    "axis_d reversed": reverse("axis_d"),
    "axis_c reversed": reverse("axis_c"),
    "axis_b reversed": reverse("axis_b"),
    "shoulder aside": shift("axis_d", 0.004, 0, 0),
    "shoulder on the other side": shift("axis_d", -0.04, 0, 0),
    "shoulder high": shift("axis_d", 0, 0, 0.012),
    "shoulder skew": shift("axis_d", 0, 0.006, 0),
    "base high": shift("axis_e", 0, 0, 0.0008),
    "base aside": shift("axis_e", 0.01, -0.02, 0.015),
    "base tilted": turn("axis_e", 0.05, -0.08, 0),
    "link_0 elsewhere": shift("link_0_fixed", 0.02, 0, 0.01),
    "elbow too far": shift("axis_c", 0.01, 0, 0),
    "elbow off the plane": shift("axis_c", 0, 0, 0.007),
    "elbow tilted": turn("axis_c", 0.02, 0.03, 0),
    "wrist too far": shift("axis_b", 0.003, 0, 0),
    "wrist on the other side": shift("axis_b", -0.04, 0, 0),
    "wrist along": shift("axis_b", 0, -0.01, 0),
    "wrist tilted": turn("axis_b", 0.02, 0, 0),
    "short pi": cut_digits_of_pi,
    "limits": limits("axis_d", lower=0.0, upper=3.8),
    "limits in degrees": in_degrees("axis_e"),
    "limits of all in degrees": all_limits_in_degrees,
    "mass": inertial("link_2", "mass", value="0.5"),
    "COM on the other side": inertial(
        "link_4", "origin", xyz="-3e-05 -0.001482 0.100881"
    ),
    "tensor": inertial("link_3", "inertia", ixy="-2.1363e-05"),
    "turned tensor": inertial("link_2", "origin", rpy="0.4 0.2 -0.6"),
    "link without inertial": without("link_1", "inertial"),
    "no inertials": no_inertials,
    "mounted": mounted,
    "other frames": other_frames,
}


def damaged(*names: str) -> ET.Element:
    root = ET.fromstring(OWN)
    for name in names:
        DEFECTS[name](root)
    return root


# --- the truth, by Pinocchio


def tools(
    text: str, q: np.ndarray, frame: str, base: str, joints: Iterable[str]
) -> list[pin.SE3]:
    model = pin.buildModelFromXML(text)
    data = model.createData()
    columns = [model.joints[model.getJointId(name)].idx_q for name in joints]
    out = []
    for row in q:
        position = pin.neutral(model)
        position[columns] = row
        pin.framesForwardKinematics(model, data, position)
        at, tool = (
            data.oMf[model.getFrameId(name, pin.FrameType.BODY)]
            for name in (base, frame)
        )
        out.append(at.inverse() * tool)
    return out


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


# --- what is advised


def remove_inertials(root: ET.Element, names: str) -> None:
    """Remove the inertials of the links whose names are listed."""
    for name in names.split(", "):
        link = root.find(f"link[@name='{name}']")
        for inertial_element in link.findall("inertial"):
            link.remove(inertial_element)


def element_to_correct(root: ET.Element, name: str) -> ET.Element:
    """The joint of this name, or else the inertial of the link."""
    joint = root.find(f"joint[@name='{name}']")
    if joint is not None:
        return joint
    link = root.find(f"link[@name='{name}']")
    body = link.find("inertial")
    return ET.SubElement(link, "inertial") if body is None else body


def write_elements(node: ET.Element, elements: str) -> None:
    for element in ET.fromstring(f"<x>{elements}</x>"):
        old = node.find(element.tag)
        old = ET.SubElement(node, element.tag) if old is None else old
        old.attrib.update(element.attrib)


def follow(root: ET.Element, findings: Iterable[Finding]) -> None:
    """Write what every finding says."""
    lines = [line for finding in findings for line in finding.instead.split("; ")]
    for line in filter(None, lines):
        if line.startswith("no <inertial> in "):
            remove_inertials(root, line.removeprefix("no <inertial> in "))
            continue
        pattern = r"(\S+): ((?:<[^>]+/> ?)+)(?:\(nothing in (.+)\))?"
        name, elements, empty = re.fullmatch(pattern, line).groups()
        write_elements(element_to_correct(root, name), elements)
        if empty:
            remove_inertials(root, empty)


def text_of(root: ET.Element) -> str:
    return ET.tostring(root, encoding="unicode")


def mend(root: ET.Element, comparison: Comparison) -> Comparison:
    follow(root, comparison.findings)
    return compare_robots(parse_urdf(text_of(root)), comparison.joints, samples=SAMPLES)


def check(*names: str) -> None:
    """The tool is where Pinocchio says, and with all advice where ours is."""
    root = damaged(*names)
    comparison = compare_robots(parse_urdf(text_of(root)), samples=SAMPLES)
    frame = "lamp" if "no tool" in names else "tcp"
    if frame == "tcp":
        distances, angles = truth(text_of(root), SAMPLES, frame, "base_link")
        assert comparison.tool.frame == frame
        assert comparison.tool.base == "base_link"
        np.testing.assert_allclose(comparison.tool.distance, distances, atol=1e-6)
        np.testing.assert_allclose(
            np.sin(comparison.tool.angle / 2), np.sin(angles / 2), atol=1e-6
        )

    after = mend(root, comparison)
    assert after.agrees, [f.text for f in after.findings]
    assert after.tip_error < 1e-5
    if frame == "tcp":
        distances, angles = truth(text_of(root), SAMPLES, frame, "base_link")
        assert distances.max() < 1e-5
        assert angles.max() < 1e-4


@pytest.mark.slow
@pytest.mark.parametrize("name", DEFECTS)
def test_the_tool_is_measured_and_the_advice_mends_it(name):
    check(name)


PAIRS = list(itertools.combinations(DEFECTS, 2))
SAMPLE = [
    PAIRS[k] for k in np.random.default_rng(23).choice(len(PAIRS), 60, replace=False)
]
#: Nothing but its name and place shows the base.
SAMPLE += [
    ("axis_e turned about x", other) for other in ("link_0 elsewhere", "no inertials")
]


@pytest.mark.slow
@pytest.mark.parametrize("pair", SAMPLE, ids=" and ".join)
def test_pairs_of_defects(pair):
    check(*pair)


def test_a_short_pi_says_how_far_it_moves_the_tip():
    root = damaged("short pi")
    comparison = compare_robots(parse_urdf(text_of(root)), samples=SAMPLES)
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
    comparison = compare_robots(parse_urdf(text_of(root)), samples=SAMPLES)
    (found,) = [f for f in comparison.findings if "zero is shifted" in f.text]
    assert ("or else the base" not in found.text) == sure


@pytest.mark.parametrize("roll", [-180, -30, 0, 60, 90])
@pytest.mark.parametrize("axes", itertools.permutations(range(3)))
def test_a_tool_along_the_wrist_may_have_any_axes(roll, axes):
    chosen = np.eye(4)
    chosen[:3, :3] = rotation([0, 0, math.radians(roll)]) @ np.eye(3)[:, axes]
    assert _axes_are_a_choice(chosen, 0.01)
    for rpy in ([0, 0, 0.2], [0.2, 0, 0], [0, -0.2, 0]):
        turned = chosen.copy()
        turned[:3, :3] = rotation(rpy) @ chosen[:3, :3]
        assert not _axes_are_a_choice(turned, 0.01)


@pytest.mark.parametrize("degrees", [5, 100, 170])
def test_a_tilted_base_says_by_how_much(degrees):
    root = ET.fromstring(OWN)
    turn("axis_e", math.radians(degrees), 0, 0)(root)
    comparison = compare_robots(parse_urdf(text_of(root)), samples=SAMPLES)
    (found,) = [f for f in comparison.findings if "tilted by" in f.text]
    assert f"tilted by {degrees:.3f} deg" in found.text


def test_rounding_of_the_base_is_no_mount():
    text = OWN.replace("base_link", "platform")
    root = ET.fromstring(text)
    turn("link_0_fixed", 0, 0, 1e-9)(root)
    shift("link_0_fixed", 1e-9, 0, 0)(root)
    comparison = compare_robots(parse_urdf(text_of(root)), samples=SAMPLES)
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
    comparison = compare_robots(parse_urdf(text), mapped, samples=SAMPLES)
    tool = comparison.tool
    assert tool.frame == frame
    if frame:
        distances, _ = truth(text, SAMPLES, frame, base, joints)
        np.testing.assert_allclose(tool.distance, distances, atol=1e-6)
        (said,) = [f for f in comparison.findings if f.where == "tool"]
        assert not said.serious
        assert f"{away:.2f} mm from Table 1's frame {{5}}" in said.text

    root = ET.fromstring(text)
    after = mend(root, comparison)
    assert after.agrees, [f.text for f in after.findings]
    assert after.tip_error < 1e-4
    if frame:
        distances, angles = truth(text_of(root), SAMPLES, frame, base, joints)
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
    comparison = compare_robots(parse_urdf(text), samples=2000)
    distances, _ = truth(text, 200, "alpha_tcp", "base_link", JOINTS)
    measured = compare_robots(parse_urdf(text), samples=200).tool
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
    comparison = compare_robots(parse_urdf(text_of(root)), samples=5)
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
    comparison = compare_robots(parse_urdf(text_of(root)), samples=5)
    assert not any("degrees" in f.text for f in comparison.findings)
    assert comparison.agrees


if __name__ == "__main__":
    failed = 0
    for names in PAIRS:
        try:
            check(*names)
        except Exception as error:
            failed += 1
            words = " ".join(str(error).split())[:300]
            print(f"{' and '.join(names)}: {type(error).__name__}: {words}", flush=True)
    print(f"{len(PAIRS)} pairs, {failed} failed")
    sys.exit(bool(failed))
