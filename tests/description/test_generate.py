"""Generation: arguments change the output, and plain xacro agrees."""

from __future__ import annotations

import math
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
import yaml

import alpha5_model as a5
from alpha5_model._support.paths import REPOSITORY_PATH, XACRO_PATH
from alpha5_model.cli import main
from alpha5_model.description.srdf import NAMED_POSES
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.description.xacro_parameters import parameter_yaml
from alpha5_model.errors import (
    FileFormatError,
    InputError,
)
from alpha5_model.numbers.parameters import parameters


def names(text: str, tag: str) -> list[str]:
    return [
        element.get("name")
        for element in ET.fromstring(text).iter(tag)
        if element.get("name")
    ]


def xml(variant: Variant) -> ET.Element:
    return ET.fromstring(urdf(variant))


def test_prefix_stands_before_every_link_joint_and_reference():
    plain, prefixed = (
        urdf(Variant(gripper="jaws")),
        urdf(Variant(gripper="jaws", prefix="l_")),
    )
    for tag in ("link", "joint", "material"):
        assert names(prefixed, tag) == [f"l_{name}" for name in names(plain, tag)]
    root = ET.fromstring(prefixed)
    links = set(names(prefixed, "link"))
    for joint in root.findall("joint"):
        assert {
            joint.find("parent").get("link"),
            joint.find("child").get("link"),
        } <= links
    assert {m.get("joint") for m in root.iter("mimic")} == {"l_axis_a"}


def test_parent_is_made_and_mounted_on():
    root = xml(Variant(parent="vehicle", xyz=(0.1, 0.0, -0.2), rpy=(0.0, 0.5, 0.0)))
    mount = root.find("joint[@name='mount']")
    assert root.find("link[@name='vehicle']") is not None
    assert mount.find("parent").get("link") == "vehicle"
    assert mount.find("child").get("link") == "base_link"
    assert mount.find("origin").attrib == {"xyz": "0.1 0.0 -0.2", "rpy": "0.0 0.5 0.0"}
    assert xml(Variant()).find("joint[@name='mount']") is None


def test_ros2_control_gives_interfaces_and_device_ids():
    root = xml(
        Variant(gripper="jaws", ros2_control=True, ros2_control_plugin="pkg/Driver")
    )
    control = root.find("ros2_control")
    assert control.find("hardware/plugin").text == "pkg/Driver"
    ids = {
        j.get("name"): j.find("param[@name='device_id']").text
        for j in control.findall("joint")
    }
    assert ids == {
        "axis_e": "5",
        "axis_d": "4",
        "axis_c": "3",
        "axis_b": "2",
        "axis_a": "1",
    }
    for joint in control.findall("joint"):
        assert [c.get("name") for c in joint.findall("command_interface")] == [
            "position",
            "velocity",
        ]
    # mock hardware starts at home with its jaws closed: zero is out of the limits
    path = "state_interface[@name='position']/param[@name='initial_value']"
    start = [float(joint.find(path).text) for joint in control.findall("joint")]
    assert start == [*NAMED_POSES["home"], parameters().joints[4].lower]
    assert xml(Variant()).find("ros2_control") is None


def test_options_add_and_remove_what_they_name():
    plain = ET.fromstring(urdf())
    jaws = ET.fromstring(urdf(Variant(gripper="jaws", mesh_prefix="package://mine/")))
    frames = ET.fromstring(urdf(Variant(dh_frames=True)))
    bare = ET.fromstring(urdf(Variant(collision="none")))

    def named(root, tag):
        return {element.get("name") for element in root.findall(tag)}

    fingers = {"finger_1_joint", "finger_2_joint"}
    assert named(jaws, "joint") - named(plain, "joint") == {"axis_a"} | fingers
    files = [mesh.get("filename") for mesh in jaws.iter("mesh")]
    assert len(files) == 7
    assert all(file.startswith("package://mine/") for file in files)
    added = named(frames, "link") - named(plain, "link")
    assert added == {f"dh_{i}" for i in range(1, 6)}
    assert list(plain.iter("collision"))
    assert not list(bare.iter("collision"))
    angles = [
        float(angle)
        for origin in frames.iter("origin")
        for angle in origin.get("rpy", "0").split()
    ]
    assert max(map(abs, angles)) == pytest.approx(math.pi)


def test_a_mount_is_three_numbers_and_a_flag_one_truth():
    with pytest.raises(InputError, match="xyz"):
        Variant(parent="rov", xyz=np.zeros((2, 3)))
    for name in ("dh_frames", "ros2_control"):
        with pytest.raises(InputError, match=name):
            Variant(**{name: np.zeros(4)})


def test_corrections_turn_the_base_and_are_named():
    printed = urdf(Variant(corrections=()))
    assert "corrections to the document (none)" in printed
    base = ET.fromstring(printed).find("joint[@name='link_0_fixed']/origin")
    assert base.get("rpy") == "0.0 0.0 3.141592653589793"
    assert "corrections to the document (base_frame)" in urdf()


def test_the_file_names_document_version_and_package():
    head = urdf().split("<link", 1)[0]
    for words in (
        "Kinematic and Dynamic Properties, version 7",
        f"alpha5_model {a5.__version__}",
    ):
        assert words in head
    assert str(Path(REPOSITORY_PATH)) not in urdf()


@pytest.mark.parametrize("gripper", ["locked", "jaws"])
def test_plain_xacro_gives_the_same_elements(gripper, tmp_path):
    """The committed sources, from a shell, in another folder, without this package."""
    program = Path(sys.executable).with_name("xacro")
    result = subprocess.run(
        [program, XACRO_PATH, f"gripper:={gripper}", "prefix:=p_", "dh_frames:=true"],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        check=True,
    )
    ours = urdf(Variant(gripper=gripper, prefix="p_", dh_frames=True))
    assert ET.canonicalize(result.stdout, strip_text=True) == ET.canonicalize(
        ours, strip_text=True
    )


def test_plain_xacro_refuses_an_unknown_gripper(tmp_path):
    program = Path(sys.executable).with_name("xacro")
    result = subprocess.run(
        [program, XACRO_PATH, "gripper:=hook"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode != 0
    assert "gripper must be 'locked' or 'jaws', not 'hook'" in result.stderr


def test_yaml_numbers_read_back_exactly():
    content = yaml.safe_load(parameter_yaml(a5.parameters()))
    for link in a5.parameters().links:
        assert content["links"][link.name]["mass"] == link.mass
        assert content["links"][link.name]["com"] == list(link.com)
        assert content["links"][link.name]["inertia"]["ixy"] == link.inertia[0, 1]
    assert content["joints"]["axis_c"]["xyz"][0] == a5.parameters().dh[1].a


def test_command_line_writes_file_and_meshes(tmp_path, capsys):
    target = tmp_path / "out" / "arm.urdf"
    assert main(["generate", "urdf", "--output", str(target), "--gripper", "jaws"]) == 0
    for mesh in ET.parse(target).getroot().iter("mesh"):
        assert (target.parent / mesh.get("filename")).is_file()
    assert main(["generate", "urdf", "--mesh-uri", "package"]) == 0
    assert "package://alpha5_description/meshes/link_0.obj" in capsys.readouterr().out
    assert main(["generate", "urdf", "--mesh-uri", "file"]) == 0
    uri = next(ET.fromstring(capsys.readouterr().out).iter("mesh")).get("filename")
    assert Path(uri.removeprefix("file://")).is_file()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--gripper", "hook"], "unknown gripper 'hook'; choose from locked, jaws"),
        (["--collision", "mesh"], "choose from primitives, capsules, none"),
        (["--mesh-uri", "http"], "choose from relative, package, file"),
        (["--corrections", "sign"], "choose from base_frame, link3_cob"),
        (["--xyz", "0 0"], "three numbers"),
        (["--xyz", "0 0 nan", "--parent", "w"], "finite numbers"),
        (["--xyz", "0 0 1"], "a parent link to mount on"),
        (["--prefix", "${1/0}"], "a text without"),
        (["--prefix", "a b"], "a name without spaces"),
        (["--output", "/dev/null/arm.urdf"], "cannot write"),
        (["--output", "folder"], "give a file name"),
        (["--colour", "red"], "--colour"),
    ],
)
def test_wrong_input_is_one_line_and_status_2(arguments, words, capsys):
    assert main(["generate", "urdf", *arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert len(err.splitlines()) == 1
    assert words in err


def test_a_broken_xacro_file_is_named(tmp_path):
    from alpha5_model.description.xacro import expand_xacro

    broken = tmp_path / "broken.xacro"
    broken.write_text("<robot><oops></robot>")
    with pytest.raises(FileFormatError, match=r"broken\.xacro"):
        expand_xacro(broken)


def test_a_parent_with_the_name_of_a_link_of_the_arm_is_refused():
    with pytest.raises(InputError, match="no link of the arm has"):
        urdf(Variant(parent="base_link"))
    with pytest.raises(InputError, match="no link of the arm has"):
        urdf(Variant(parent="l_tcp", prefix="l_"))
    assert (
        names(urdf(Variant(parent="base_link", prefix="l_")), "link").count("base_link")
        == 1
    )


@pytest.mark.parametrize("uri", ["relative", "package", "file"])
def test_meshes_are_written_beside_a_file_that_names_them_there(uri, tmp_path):
    path = tmp_path / "alpha5.urdf"
    assert main(["generate", "urdf", "--mesh-uri", uri, "--output", str(path)]) == 0
    assert path.exists()
    assert (tmp_path / "meshes").exists() is (uri == "relative")
