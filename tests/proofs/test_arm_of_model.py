"""The record of an arm from another model: axes, zeros, base, limits and notes."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET

import model_defects
import model_edits as edits
import numpy as np
import pinocchio as pin
import pytest
from compared_models import AXES, described
from own_arm import mount_pose
from urdf_edits import OWN

import alpha5_model as a5
from alpha5_model.proofs.comparison.as_arm import ArmOfModel

pytestmark = pytest.mark.filterwarnings(
    "ignore::alpha5_model.errors.ImplausibleWarning"
)
RECORD = a5.parameters()
VOLUMES = "volumes and centres of buoyancy, which no URDF has: Table 3's are kept"
SHAPES = "shapes and meshes"


def signs_of(arm: ArmOfModel) -> np.ndarray:
    """-1 for each joint that the notes say turns the other way."""
    notes = [
        f"{axis} turns the other way: its position is minus the model's"
        for axis in AXES
    ]
    return np.array([-1.0 if note in arm.left_out else 1.0 for note in notes])


def assert_same_tcp(root: ET.Element, arm: ArmOfModel) -> None:
    """Second route: Pinocchio's tcp of the file, at positions with their signs."""
    model = pin.buildModelFromXML(ET.tostring(root, encoding="unicode"))
    data = model.createData()
    frame = model.getFrameId("tcp", pin.FrameType.BODY)
    ours = a5.load(0.0, arm=arm.record)
    sign = signs_of(arm)
    for q in np.random.default_rng(4).uniform(-2.0, 2.0, (5, 4)):
        pin.framesForwardKinematics(model, data, sign * q)
        expected = data.oMf[frame].homogeneous
        found = mount_pose(arm.record) @ ours.forward_kinematics(q).homogeneous
        assert found == pytest.approx(expected, abs=1e-9)


# --- signs and zeros


@pytest.mark.parametrize("seed", range(3))
def test_reversed_axes_and_shifted_zeros_change_nothing_else(seed: int) -> None:
    rng = np.random.default_rng(seed)
    flipped = rng.random(4) < 0.5
    zeros = rng.choice([0.0, 0.3, -0.7, 1.1], 4)
    root = ET.fromstring(OWN)
    for axis, flip, zero in zip(AXES, flipped, zeros, strict=True):
        joint = root.find(f"joint[@name='{axis}']")
        if flip:
            edits.reverse(joint)
        edits.shift_zero(joint, zero)
    arm = described(root)

    sign = np.where(flipped, -1.0, 1.0)
    assert signs_of(arm).tolist() == sign.tolist()
    assert arm.left_out[flipped.sum() :] == (VOLUMES, SHAPES)
    assert arm.record.mount is None
    assert arm.record.tool is None or zeros[3] != 0
    for k, (own, printed) in enumerate(zip(arm.record.dh, RECORD.dh, strict=True)):
        assert [own.a, own.d] == pytest.approx([printed.a, printed.d], abs=1e-9)
        # A position of the record is the model's times its sign.
        shift = sign[k] * zeros[k] if k < 4 else 0.0
        turn = own.theta_offset - (printed.theta_offset - shift)
        assert math.remainder(turn, math.tau) == pytest.approx(0.0, abs=1e-9)
    for k, joint in enumerate(arm.record.joints[:4]):
        printed_ends = np.array([RECORD.joints[k].lower, RECORD.joints[k].upper])
        expected = printed_ends + sign[k] * zeros[k]
        assert [joint.lower, joint.upper] == pytest.approx(expected, abs=1e-9)
    for own_link, link in zip(arm.record.links, RECORD.links, strict=True):
        assert own_link.com == pytest.approx(link.com, abs=1e-9)
        assert own_link.inertia == pytest.approx(link.inertia, abs=1e-12)
    assert_same_tcp(root, arm)


@pytest.mark.parametrize("flipped", [(False, False), (True, False)])
@pytest.mark.parametrize("defect", ["shoulder", "wrist"])
def test_lengths_are_positive_on_either_side(
    defect: str, flipped: tuple[bool, bool]
) -> None:
    """An axis on the other side is reversed instead, with all that follow it."""
    root = ET.fromstring(OWN)
    model_defects.DEFECTS[f"{defect} on the other side"](root)
    # Near the wrist, so that it is near Table 1's tool on either side.
    model_defects.put("tcp_fixed", xyz="0.01 0 -0.05")(root)
    for axis, flip in zip(("axis_d", "axis_b"), flipped, strict=True):
        if flip:
            edits.reverse(root.find(f"joint[@name='{axis}']"))
    arm = described(root)
    for own, printed in zip(arm.record.dh, RECORD.dh, strict=True):
        assert [own.a, own.d] == pytest.approx([printed.a, printed.d], abs=1e-9)
    assert (signs_of(arm) < 0).any() or any(flipped)
    assert_same_tcp(root, arm)


def test_a_length_of_nothing_is_left_out() -> None:
    root = ET.fromstring(OWN)
    model_defects.put("axis_d", xyz="0 0 0.0462")(root)
    arm = described(root)
    (said,) = [text for text in arm.left_out if text.startswith("a_0 is ")]
    assert said.endswith(" m, which has not the sign of Table 1")
    assert arm.record.dh[0].a == RECORD.dh[0].a


@pytest.mark.parametrize(
    ("axis", "rpy", "degrees"),
    [
        ("axis_d", (0.0, 0.02, 0.0), 0.02),
        ("axis_c", (0.0, 0.03, 0.0), 0.03),
        ("axis_b", (0.05, 0.0, 0.0), 0.05),
    ],
)
def test_a_twisted_axis_is_said_with_its_angle(
    axis: str, rpy: tuple[float, float, float], degrees: float
) -> None:
    root = ET.fromstring(OWN)
    origin = model_defects.origin_of(root, axis)
    printed = model_defects.rotation(model_defects.vector(origin.get("rpy")))
    z = printed[:, 2]
    # A turn about a line across both axes.
    across = np.cross(z, [0, 0, 1]) if axis != "axis_c" else printed[:, 0]
    turned = pin.exp3(across / np.linalg.norm(across) * degrees) @ printed
    origin.set("rpy", model_defects.written(pin.rpy.matrixToRpy(turned)))
    said = f"{math.degrees(degrees):.3g} deg against the axis before it"
    assert described(root).left_out[0] == f"{axis} is twisted by {said}", rpy


# --- the base


@pytest.mark.slow
@pytest.mark.parametrize(
    ("higher", "kept"),
    [(0.09, True), (-0.2, False)],
)
def test_a_base_link_far_below_the_shoulder_is_another_frame(
    higher: float, kept: bool
) -> None:
    """It is known by the COM of link_0. d_0 may differ by 100 mm, and is positive."""
    root = ET.fromstring(OWN)
    model_defects.shift("axis_e", 0.0, 0.0, higher)(root)
    arm = described(root)
    printed = RECORD.dh[0].d
    expected = printed + higher if kept else printed
    assert arm.record.dh[0].d == pytest.approx(expected, abs=1e-9)
    moved = "its root is named base_link: the mount's is base_link_of_model"
    assert (moved in arm.left_out) == (not kept)
    if kept:
        assert arm.record.mount is None
    else:
        assert arm.record.mount is not None
        assert arm.record.mount.parent == "base_link_of_model"
        assert arm.record.mount.position == pytest.approx([0, 0, higher], abs=1e-9)
    assert_same_tcp(root, arm)


@pytest.mark.parametrize("tilt", [(0.3, 0.2), (0.0, math.pi / 2), (1.0, -0.4)])
def test_a_tilted_base_link_gives_the_record_its_x_axis(
    tilt: tuple[float, float],
) -> None:
    """x of base_link is theirs, seen along axis_e; if it lies along axis_e, y is."""
    root = ET.fromstring(OWN)
    model_defects.turn("axis_e", *tilt, 0.0)(root)
    arm = described(root)
    assert arm.record.mount is not None
    x, _, z = arm.record.mount.rotation.T
    expected = np.array([1.0, 0.0, 0.0]) - z[0] * z
    if np.linalg.norm(expected) < 0.5:
        expected = np.cross([0.0, 1.0, 0.0], z)
    assert x == pytest.approx(expected / np.linalg.norm(expected), abs=1e-9)
    assert_same_tcp(root, arm)


def test_a_base_that_nothing_shows_is_put_below_the_shoulder() -> None:
    text = OWN.replace("base_link", "platform").replace("link_0", "turret")
    root = ET.fromstring(text)
    model_defects.without("turret", "inertial")(root)
    model_defects.shift("turret_fixed", 0.1, -0.3, 0.2)(root)
    arm = described(root)
    assert arm.record.dh[0].d == pytest.approx(RECORD.dh[0].d, abs=1e-12)
    assert arm.record.mount is not None
    assert arm.record.mount.parent == "platform"
    assert arm.record.mount.position == pytest.approx([0.1, -0.3, 0.2], abs=1e-9)
    assert_same_tcp(root, arm)


# --- limits


@pytest.mark.parametrize("missing", ["lower", "upper", "both"])
def test_a_joint_without_limits_has_the_printed_ones_in_its_positions(
    missing: str,
) -> None:
    root = ET.fromstring(OWN)
    joint = root.find("joint[@name='axis_b']")
    edits.shift_zero(joint, 0.4)
    for end in ("lower", "upper"):
        if missing in (end, "both"):
            del joint.find("limit").attrib[end]
    arm = described(root)
    assert "axis_b has no limits: the catalogue's are kept" in arm.left_out
    found = arm.record.joints[3]
    printed = RECORD.joints[3]
    expected = [printed.lower + 0.4, printed.upper + 0.4]
    assert [found.lower, found.upper] == pytest.approx(expected, abs=1e-9)


# --- tool, link_4 and the notes


@pytest.mark.parametrize("rpy", ["3.141592653589793 0 0", "0 0 0"])
def test_a_tool_that_is_only_turned_is_its_own(rpy: str) -> None:
    root = ET.fromstring(OWN)
    ours = model_defects.origin_of(root, "tcp_fixed").get("rpy", "")
    model_defects.put("tcp_fixed", rpy=rpy)(root)
    arm = described(root)
    same = np.allclose(
        model_defects.vector(ours), model_defects.vector(rpy), atol=1e-12
    )
    assert (arm.record.tool is None) == same
    assert_same_tcp(root, arm)


def test_everything_that_a_model_has_beside_the_arm_is_noted() -> None:
    root = ET.fromstring(edits.with_vehicle(25.0))
    joint = ET.SubElement(root, "joint", name="claw", type="prismatic")
    ET.SubElement(joint, "parent", link="arm0_link_4")
    ET.SubElement(joint, "child", link="claw")
    ET.SubElement(joint, "limit", lower="0", upper="1", effort="1", velocity="1")
    ET.SubElement(root, "link", name="claw")
    assert described(root).left_out == (
        VOLUMES,
        "links that are not the arm's: hull, t0, t1",
        "the joints free, thruster0, thruster1, claw, which are frozen with jaws shut",
        SHAPES,
    )


@pytest.mark.parametrize("root_name", ["tcp", "link_2", "world 1"])
def test_the_root_has_a_name_that_an_arm_file_takes(root_name: str) -> None:
    """Names of the arm's own frames are taken."""
    root = edits.dressed(OWN, "", (0.1, 0.2, 0.3), (0.0, 0.0, 0.5))
    for link in root.findall("link"):
        if link.get("name") == root_name:
            link.set("name", f"own_{root_name}")
    for end in root.iter():
        if end.get("link") == root_name:
            end.set("link", f"own_{root_name}")
    root.find("link[@name='vehicle']").set("name", root_name)
    root.find("joint[@name='mount']/parent").set("link", root_name)
    arm = described(root)
    parent = {"world 1": "world_1"}.get(root_name, f"{root_name}_of_model")
    assert arm.record.mount is not None
    assert arm.record.mount.parent == parent
    said = f"its root is named {root_name}: the mount's is {parent}"
    assert said in arm.left_out
