"""`alpha5 compare` finds what was done to a copy of our own URDF, and nothing else."""

from __future__ import annotations

import json
import math
import re
import xml.etree.ElementTree as ET
from itertools import pairwise
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import reference
import shared_recordings as recordings
from compared_models import AXES, advised, compared, wheres
from model_edits import (
    dressed,
    matrix,
    reverse,
    rpy_of,
    shift_zero,
    with_vehicle,
)
from urdf_edits import OWN, with_mass

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.errors import FileFormatError, InputError, UnknownNameError
from alpha5_model.viewer import comparison_plot
from alpha5_model.viewer.comparison_plot import plot_comparison

MODELS = recordings.RECORDINGS / "models"


def cut(text: str, digits: int) -> str:
    """Pi and its half cut, not rounded, to a number of digits."""
    for value in (math.pi, math.pi / 2):
        text = text.replace(repr(value), repr(value)[: digits + 1])
    return text


@pytest.mark.parametrize("digits", [3, 5, 6, 10, 15])
def test_pi_cut_short_changes_nothing(digits):
    text = cut(OWN, digits)
    assert (text != OWN) == (digits < 16)
    comparison = compared(text, samples=50)
    assert wheres(comparison) == []
    # The one remark is about the digits, and there only where they can be seen.
    assert {f.where for f in comparison.findings} == (
        {"digits"} if digits < 6 else set()
    )
    np.testing.assert_allclose(comparison.alignment.zero, 0, atol=1e-12)
    np.testing.assert_allclose(comparison.alignment.base, np.eye(4), atol=1e-12)


@pytest.mark.slow
def test_what_was_done_is_found_and_nothing_else():
    """Digits of pi, prefix, mount, reversed axes and shifted zeros are combined."""
    rng = np.random.default_rng(7)
    for n in range(60):
        mounted = rng.random() < 0.5
        xyz, rpy = rng.uniform(-2, 2, 3), rng.uniform(-math.pi, math.pi, 3)
        prefix = "".join(rng.choice(list("abc_"), rng.integers(0, 5)))
        text = cut(OWN, int(rng.choice([3, 4, 5, 6, 10, 17])))
        root = dressed(text, prefix, *((xyz, rpy) if mounted else ()))
        joints = [root.find(f"joint[@name='{prefix}{axis}']") for axis in AXES]
        flips = rng.random(4) < 0.3
        zeros = np.where(rng.random(4) < 0.3, rng.uniform(-math.pi, math.pi, 4), 0.0)
        for joint, flip, zero in zip(joints, flips, zeros, strict=True):
            if flip:
                reverse(joint)
            if zero:
                shift_zero(joint, zero)
        comparison = compared(root, samples=5)
        signs = np.where(flips, -1.0, 1.0)
        case = (n, prefix, flips, zeros, comparison.findings)
        done = [axis for axis, flip in zip(AXES, flips, strict=True) if flip]
        done += [axis for axis, zero in zip(AXES, zeros, strict=True) if zero]
        assert wheres(comparison) == sorted(done), case
        assert set(wheres(comparison, False)) <= {
            "digits",
            *(["base"] if mounted else []),
        }, case
        np.testing.assert_array_equal(comparison.alignment.sign, signs, str(case))
        off = comparison.alignment.zero - zeros
        # A joint with a cut pi and a shift has one number, which does not show the cut.
        np.testing.assert_allclose(
            np.angle(np.exp(1j * off)), 0, atol=2e-3, err_msg=str(case)
        )
        if mounted:
            at = np.linalg.inv(comparison.alignment.base)
            np.testing.assert_allclose(at[:3, 3], xyz, atol=1e-4)
            np.testing.assert_allclose(at[:3, :3], matrix(rpy), atol=4e-3)


@pytest.mark.parametrize(
    ("joint", "xyz", "where", "words"),
    [
        (
            "axis_d",
            (0.002, 0, 0),
            "axis_d",
            "is 22.00 mm from axis_e, ours is 20.00 mm",
        ),
        ("axis_d", (-0.04, 0, 0), "axis_d", "is -20.00 mm from axis_e"),
        ("axis_d", (0, 0, 0.0008), "axis_d", "lies 47.00 mm above base_link"),
        ("axis_c", (0.01, 0, 0), "axis_c", "is 160.71 mm from axis_d"),
        ("axis_c", (0, 0, 0.003), "axis_c", "beside the plane of the arm"),
        ("axis_b", (0.00005, 0, 0), "axis_b", "is 20.05 mm from axis_c"),
    ],
)
def test_a_wrong_offset_is_measured_and_nothing_else(joint, xyz, where, words):
    root = ET.fromstring(OWN)
    origin = root.find(f"joint[@name='{joint}']/origin")
    moved = np.array([float(x) for x in origin.get("xyz").split()]) + xyz
    origin.set("xyz", " ".join(repr(float(x)) for x in moved))
    comparison = compared(root, samples=50)
    assert [f.where for f in comparison.findings] == [where], comparison.findings
    assert words in comparison.findings[0].text
    np.testing.assert_allclose(comparison.alignment.zero, 0, atol=1e-9)
    off = float(re.search(r"up to ([\d.]+) mm off", comparison.findings[0].text)[1])
    assert off == pytest.approx(comparison.tip_error * 1e3, abs=0.01)


@pytest.mark.parametrize("index", [0, 1, 2])
def test_a_twisted_axis_is_measured_and_nothing_else(index):
    """A degree of roll in the origin of the joint behind the link."""
    root = ET.fromstring(OWN)
    joint = root.find(f"joint[@name='{AXES[index + 1]}']")
    origin = joint.find("origin")
    turn = matrix((math.radians(1.0), 0, 0))
    origin.set(
        "rpy", rpy_of(turn @ matrix([float(x) for x in origin.get("rpy").split()]))
    )
    comparison = compared(root, samples=20)
    assert {f.where for f in comparison.findings} == {AXES[index + 1]}, (
        comparison.findings
    )
    change = getattr(comparison.alignment.changes, f"alpha_{index}")
    assert abs(math.degrees(change)) == pytest.approx(1.0, abs=1e-6)
    ours = (90.0, 180.0, -90.0)[index]  # Table 1
    text = comparison.findings[0].text
    assert text.startswith(f"is {ours + math.degrees(change):.2f} deg")
    assert f"ours is {ours:.2f} deg" in text


def test_digits_that_explain_a_difference_make_it_none():
    short = OWN.replace("0.1507053084665567", "0.151").replace("0.0462", "0.046")
    remarks = compared(short, samples=5).findings
    assert {(f.where, f.serious) for f in remarks} == {("digits", False)}, remarks
    found = compared(short.replace('"0.151 ', '"0.1510 '), samples=5).findings
    assert {f.where for f in found if f.serious} == {"axis_c", "axis_d"}


#: Public arms and vehicles without ours, as example-robot-data ships them.
OTHERS = (
    "ur_description/urdf/ur5_robot",
    "panda_description/urdf/panda",
    "z1_description/urdf/z1",
    "bravo7_description/urdf/bravo7_gripper",
    "so_arm_description/urdf/so100",
    "xarm_description/urdf/xarm7",
    "pr2_description/urdf/pr2",
    "iris_description/robots/iris",
    "double_pendulum_description/urdf/double_pendulum_continuous",
    "romeo_description/urdf/romeo_small",
    "kinova_description/robots/kinova",
)


@pytest.mark.parametrize("name", OTHERS)
def test_other_robots_are_not_this_arm(name, capsys):
    data = pytest.importorskip("example_robot_data")
    folder = next(
        (
            p
            for p in Path(data.__file__).parents
            if (p / "share/example-robot-data").is_dir()
        ),
        None,
    )
    path = (
        folder / "share/example-robot-data/robots" / f"{name}.urdf"
        if folder
        else Path("-")
    )
    if not path.is_file():
        pytest.skip(f"{name} is not shipped")
    comparison = a5.compare(path)
    assert comparison.verdict.startswith("This is not a Reach Alpha 5: ")
    assert not comparison.agrees
    assert len(comparison.findings) == 1
    assert main(["compare", str(path)]) == 1
    assert (
        len(capsys.readouterr().out.strip().splitlines()) <= 5
    )  # wrapped at the terminal's width
    assert main(["compare", str(path), "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["verdict"] == comparison.verdict


def six_axes(scale: float) -> str:
    """A URDF of yaw, pitch, pitch, roll, pitch and roll.

    The joints are named from the tip, as the maker of this arm names them.
    """
    axes = {
        "g": ((0, 0, 0.1), "0 0 0"),
        "f": ((0.046, 0, 0.107), "1.5708 0 0"),
        "e": ((0.29, 0, 0), "0 0 0"),
        "d": ((0.041, 0, 0), "1.5708 0 0"),
        "c": ((0, 0, 0.16), "-1.5708 0 0"),
        "b": ((0, 0, 0.1), "1.5708 0 0"),
    }
    text = "<robot name='six'><link name='base_link'/>"
    parent = "base_link"
    for axis, (offset, rpy) in axes.items():
        xyz = " ".join(str(scale * float(x)) for x in offset)
        text += (
            f"<link name='{axis}'/>"
            f"<joint name='axis_{axis}' type='revolute'>"
            f"<parent link='{parent}'/><child link='{axis}'/>"
            f"<origin xyz='{xyz}' rpy='{rpy}'/><axis xyz='0 0 1'/>"
            "<limit lower='0' upper='3' effort='9' velocity='1'/></joint>"
        )
        parent = axis
    return text + "</robot>"


@pytest.mark.parametrize("scale", [0.5, 0.75, 1.0])
def test_a_larger_arm_of_the_same_maker_is_told_apart(scale):
    comparison = compared(six_axes(scale))
    assert comparison.verdict.startswith(
        "This is not a Reach Alpha 5: of its 6 turning joints"
    )
    assert comparison.as_dict()["tip_error_m"] is None


def test_a_vehicle_is_left_out_of_link_0():
    comparison = compared(with_vehicle(25.0))
    assert comparison.agrees
    assert [f.where for f in comparison.findings] == ["base", "base"], (
        comparison.findings
    )
    assert comparison.bodies[0].mass == pytest.approx(reference.MASS[0])
    assert comparison.carried == {"world": 0.0, "hull": 25.0, "t0": 25.0, "t1": 25.0}
    assert "hull (25 kg), t0 (25 kg), t1 (25 kg);" in comparison.findings[1].text
    assert "with it link_0 would be 75.0 kg too heavy" in comparison.findings[1].text
    np.testing.assert_allclose(
        comparison.alignment.base_link_pose, np.eye(4), atol=1e-12
    )


def test_a_vehicle_that_hangs_on_the_arm_is_left_out_too():
    root = dressed(OWN, "", (0, 0, 0), (0, 0, 0))
    mount = root.find("joint[@name='mount']")
    mount.find("parent").set("link", "link_0")
    mount.find("child").set("link", "vehicle")
    body = ET.SubElement(root.find("link[@name='vehicle']"), "inertial")
    ET.SubElement(body, "mass", value="11")
    ET.SubElement(
        body, "inertia", dict.fromkeys(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), "0")
    )
    comparison = compared(root, samples=5)
    assert comparison.carried == {"vehicle": 11.0}
    assert [f.where for f in comparison.findings] == ["base"]


def test_the_arms_first_link_can_be_given():
    light = with_vehicle(0.005)  # found by its frame, no heavier than a dummy
    assert compared(light).bodies[0].mass == pytest.approx(reference.MASS[0])
    given = compared(light, base="arm0_link_0")
    assert given.carried.keys() >= {"hull", "t1", "arm0_base_link"}
    assert compared(light, base="hull").bodies[0].mass == pytest.approx(0.249)
    with pytest.raises(
        UnknownNameError, match="choose from world, hull, arm0_base_link"
    ):
        compared(light, base="t0")
    assert main(["compare", a5.URDF_PATH, "--samples", "5", "--base", "link_0"]) == 0
    assert main(["compare", a5.URDF_PATH, "--base", "tcp"]) == 2


def test_one_of_two_arms_is_compared_and_the_other_named():
    robot = with_vehicle(25.0, arms=2)
    comparison = compared(robot)
    assert comparison.agrees
    assert comparison.joints["axis_e"] == "arm0_axis_e"
    (remark,) = [f for f in comparison.findings if f.where == "arm"]
    assert "--map axis_e=arm1_axis_e,axis_d=arm1_axis_d" in remark.text
    other = compared(robot, joints={axis: f"arm1_{axis}" for axis in AXES})
    assert other.joints["axis_b"] == "arm1_axis_b"
    assert other.agrees
    assert other.bodies[0].mass == pytest.approx(reference.MASS[0])


def test_an_arm_that_turns_in_the_vehicle_itself_has_no_link_0():
    comparison = compared(with_mass(OWN, "11.5", "link_0"))
    assert comparison.carried["link_0"] == 11.5
    assert comparison.bodies[0].links == ()
    assert [f.where for f in comparison.findings if f.serious] == ["link_0"]


def test_joints_need_no_names():
    text = OWN
    for axis in AXES:
        text = text.replace(f'"{axis}"', f'"j{hash(axis) % 97}{axis[-1]}"')
    turned = ET.fromstring(text)  # a turntable below, a rotary tool behind
    for name, parent, child in (
        ("pan", "ground", "base_link"),
        ("tool", "tcp", "drill"),
    ):
        ET.SubElement(turned, "link", name="ground" if name == "pan" else "drill")
        joint = ET.SubElement(turned, "joint", name=name, type="continuous")
        ET.SubElement(joint, "parent", link=parent)
        ET.SubElement(joint, "child", link=child)
    drill = ET.SubElement(turned.find("link[@name='drill']"), "inertial")
    ET.SubElement(drill, "mass", value="1e-8")
    moments = dict.fromkeys(("ixx", "iyy", "izz"), "1e-13")
    ET.SubElement(drill, "inertia", moments, ixy="0", ixz="0", iyz="0")
    comparison = compared(turned)
    assert [name[-1] for name in comparison.joints.values()] == list("edcb")
    assert comparison.agrees


def test_xacro_is_expanded_on_request(tmp_path, capsys):
    folder = tmp_path / "arm files"
    folder.mkdir()
    body = re.sub(r"^.*?<robot[^>]*>|</robot>\s*$", "", OWN, flags=re.DOTALL)
    (folder / "arm.xacro").write_text(f"<robot>{body}</robot>")
    top = tmp_path / "top.urdf.xacro"
    top.write_text(
        "<robot name='x' xmlns:xacro='http://www.ros.org/wiki/xacro'>"
        "<xacro:arg name='kind' default='arm'/>"
        "<xacro:include filename='$(find my_arm)/$(arg kind).xacro'/></robot>"
    )
    with pytest.raises(FileFormatError, match="a xacro file is a program"):
        a5.compare(top)
    with pytest.raises(FileFormatError, match="my_arm"):
        a5.compare(top, xacro=True)
    assert a5.compare(top, packages={"my_arm": str(folder)}, xacro=True).agrees
    given = ["compare", "--xacro", str(top), "--package", f"my_arm={folder}"]
    assert main(given) == 0
    assert main([*given, "--arg", "kind:=arm"]) == 0
    assert main([*given, "--arg", "kind:=none"]) == 2
    assert main([*given, "--arg", "kind=arm"]) == 2
    capsys.readouterr()


@pytest.mark.parametrize(
    ("root", "words"), [("mujoco", "an MJCF model"), ("sdf", "an SDF model")]
)
def test_other_formats_are_refused_by_name(root, words, tmp_path):
    path = tmp_path / "other.xml"
    path.write_text(f"<?xml version='1.0'?>\n<!-- <robot/> -->\n<{root}>\n</{root}>")
    with pytest.raises(
        FileFormatError, match=f"got <{root}>: {words}; compare reads URDF and xacro"
    ):
        a5.compare(path)


@pytest.mark.parametrize("encoding", ["utf-16", "utf-8-sig", "utf-16-le", "latin-1"])
@pytest.mark.parametrize("declared", ["", "utf-8", "the right one"])
def test_files_in_other_encodings_are_read_or_refused_in_a_line(
    encoding, declared, tmp_path
):
    text = OWN.replace('<?xml version="1.0" ?>', "").replace(
        "alpha5_model", "\u00e4", 1
    )
    name = {"the right one": encoding.replace("-sig", "")}.get(declared, declared)
    head = f'<?xml version="1.0" encoding="{name}"?>' if declared else ""
    path = tmp_path / "other.urdf"
    path.write_bytes((head + text.lstrip()).encode(encoding))
    message = ""
    try:
        assert a5.compare(path, samples=5).agrees
    except FileFormatError as error:
        message = str(error)
    marked = encoding in ("utf-16", "utf-8-sig")
    assert not message or not (
        marked or (encoding, declared) == ("latin-1", "the right one")
    )
    assert len(message.splitlines()) <= 1


#: README of the folder: mass [kg], COM error [mm] and inertia error [kg mm^2] of
#: link_2 to link_4, and the largest gravity torque errors on axis_d and axis_c [N m].
TRUTH = {
    "evan_palmer_alpha": (
        ((0.429, 1.81, 131), (0.115, 8.81, 53.3), (0.3333, 19.6, 700)), (0.065, 0.038)),
    "hkolano_blue_rov": (
        ((0.630, 0.98, 4060), (0.147, 11.8, 87.8), (0.669, 12.7, 6297)), (1.06, 0.42)),
    "diff_uvms": (
        ((0.429, 116.5, 745), (0.115, 30.5, 46.9), (0.333, 165.9, 99.4)), (1.10, 0.58)),
}  # fmt: skip


@pytest.mark.parametrize("name", TRUTH)
def test_public_models_of_this_arm(name):
    path = MODELS / f"{name}.urdf"
    if not path.is_file():
        pytest.skip("the public models are not here")
    comparison = a5.compare(path)
    # The lengths of one model are rounded by up to 0.7 mm, and the README fitted axes.
    rounded = name == "hkolano_blue_rov"
    bodies, torques = TRUTH[name]
    for body, (mass, com, inertia) in zip(comparison.bodies[2:], bodies, strict=True):
        assert body.mass == pytest.approx(mass, abs=1e-9)
        off = 0.9 if rounded else 0.05
        assert body.com_error * 1e3 == pytest.approx(com, abs=off)
        assert body.inertia_error * 1e6 == pytest.approx(inertia, rel=5e-3)
    np.testing.assert_allclose(comparison.gravity_error[1:3], torques, rtol=0.03)
    np.testing.assert_array_equal(comparison.alignment.sign, 1)
    zeros = np.degrees(comparison.alignment.zero[1:3])
    np.testing.assert_allclose(
        zeros, -0.18 if rounded else 0, atol=0.06 if rounded else 0.005
    )
    shoulder = [
        f.text for f in comparison.findings if "above" in f.text and f.where == "axis_d"
    ]
    assert [("0.80 mm lower" in text) for text in shoulder] == (
        [] if rounded else [True]
    )
    assert comparison.carried.get("vehicle_frame", 0.0) == (25.14 if rounded else 0.0)
    assert comparison.bodies[0].mass == pytest.approx(
        0.53 if rounded else 0.341, abs=2e-4
    )


def test_what_to_write_instead_mends_the_axes():
    root = ET.fromstring(OWN)
    joints = {axis: root.find(f"joint[@name='{axis}']") for axis in AXES}
    for axis, angle in (
        ("axis_e", 0.4),
        ("axis_d", -1.1),
        ("axis_c", 2.0),
        ("axis_b", 0.7),
    ):
        shift_zero(joints[axis], angle)
    reverse(joints["axis_d"])
    reverse(joints["axis_b"])
    joints["axis_c"].find("limit").set("upper", "9.5")
    comparison = compared(root)
    assert len(comparison.findings) == 7
    comparison = compared(advised(root, comparison))
    assert comparison.findings == ()
    np.testing.assert_allclose(comparison.alignment.base, np.eye(4), atol=1e-6)


def gravity(text: str, q: np.ndarray) -> np.ndarray:
    model = pin.buildModelFromXML(text)
    data = model.createData()
    return np.array(
        [pin.computeGeneralizedGravity(model, data, row).copy() for row in q]
    )


def test_costs_of_axes_are_gravity_torques_by_pinocchio():
    """Second route: Pinocchio's torques of our arm at the mistaken positions."""
    root = ET.fromstring(OWN)
    joints = {axis: root.find(f"joint[@name='{axis}']") for axis in AXES}
    reverse(joints["axis_d"])
    shift_zero(joints["axis_c"], 0.5)
    origin = joints["axis_c"].find("origin")
    origin.set("xyz", "0.17 0 0")
    found = compared(root, samples=40).findings
    cost = {(f.where, f.text.split(" ")[0]): f.cost for f in found}
    q = np.random.default_rng(0).uniform(reference.LOWER, reference.UPPER, (40, 4))
    ours = gravity(OWN, q)
    longer = OWN.replace("0.1507053084665567", "0.17")
    assert longer != OWN
    expected = {
        ("axis_d", "turns"): gravity(OWN, q * [1, -1, 1, 1]),
        ("axis_c", "its"): gravity(OWN, q - [0, 0, 0.5, 0]),
        ("axis_c", "is"): gravity(longer, q),
    }
    assert cost.keys() == expected.keys()
    for key, torque in expected.items():
        assert cost[key] == pytest.approx(np.abs(torque - ours).max(), rel=1e-4), key


def test_the_picture_shows_a_length_and_all_of_its_titles(tmp_path, monkeypatch):
    """An upper arm 10 mm too long, of a robot with a long name."""
    longer = OWN.replace("0.1507053084665567", "0.1607053084665567")
    named = longer.replace('"alpha5"', f'"{"an arm with a long name " * 8}"', 1)
    assert len(named) > len(longer) + 100
    path = tmp_path / "longer.urdf"
    path.write_text(named)
    drawn = []
    monkeypatch.setattr(comparison_plot, "write_figure", lambda *a: drawn.append(a))
    plot_comparison(a5.compare(path), tmp_path / "errors.png")
    ((page, _),) = drawn
    page.canvas.draw()
    (lengths,) = [axes for axes in page.axes if axes.get_title().startswith("length")]
    names = [text.get_text() for text in lengths.get_yticklabels()]
    widths = dict(zip(names, (bar.get_width() for bar in lengths.patches), strict=True))
    assert widths == pytest.approx({"a_0": 0, "a_1": 10, "a_2": 0, "d_1": 0}, abs=1e-6)
    titles = [page._suptitle, *(axes.title for axes in page.axes)]
    boxes = [text.get_window_extent() for text in titles]
    assert min(box.x0 for box in boxes) >= 0
    assert max(box.x1 for box in boxes) <= page.bbox.width
    for one, other in pairwise(boxes[1:]):
        assert one.x1 < other.x0


def test_another_arm_has_no_picture(tmp_path, capsys):
    path, picture = tmp_path / "six.urdf", tmp_path / "errors.png"
    path.write_text(six_axes(1.0))
    assert main(["compare", str(path), "--plot", str(picture)]) == 1
    assert "is not a Reach Alpha 5" in capsys.readouterr().out
    assert not picture.exists()
    with pytest.raises(InputError, match="one of a Reach Alpha 5"):
        plot_comparison(a5.compare(path), picture)


def test_a_tool_is_fixed_to_the_wrist() -> None:
    gripper = (
        '<link name="palm"/><link name="tool"/>'
        '<joint name="p" type="fixed">'
        '<parent link="link_4"/><child link="palm"/></joint>'
        '<joint name="t" type="{kind}"><parent link="palm"/><child link="tool"/>'
        '<axis xyz="0 0 1"/>'
        '<limit lower="0" upper="1" effort="1" velocity="1"/></joint>'
    )
    without = OWN.replace("tcp", "point")
    for kind in ("fixed", "revolute", "prismatic", "floating", "continuous"):
        text = without.replace("</robot>", gripper.format(kind=kind) + "</robot>")
        expected = "tool" if kind == "fixed" else ""
        assert compared(text).tool.frame == expected
