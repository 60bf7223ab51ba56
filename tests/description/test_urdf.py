"""The committed URDF against the document, typed again in `reference`."""

from __future__ import annotations

import dataclasses
import math
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import reference
import yaml
from lazily import Lazy

import alpha5_model as a5
from alpha5_model._support.paths import JAWS_URDF_PATH, XACRO_PATH
from alpha5_model.cli import main
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.errors import InputError, UnknownNameError
from alpha5_model.geometry.collision_shapes import collision_capsules
from alpha5_model.numbers.parameters import parameters

mujoco = Lazy("mujoco")
yourdfpy = Lazy("yourdfpy")
FRAMES = [f"link_{i}" for i in range(5)]


def pinocchio_error(text: str, count: int = 3000) -> float:
    """Largest difference of any frame's pose from the document's, m and rad."""
    model = pin.buildModelFromXML(text)
    data = model.createData()
    ids = [model.getFrameId(name) for name in [*FRAMES, "tcp"]]
    worst = 0.0
    for q in reference.configurations(count, seed=1):
        pin.framesForwardKinematics(model, data, q)
        expected = [*reference.inertial_frames(q), reference.dh_frames(q)[5]]
        for frame, pose in zip(ids, expected, strict=True):
            worst = max(worst, np.abs(data.oMf[frame].homogeneous - pose).max())
    return worst


@pytest.fixture(scope="module")
def text() -> str:
    return Path(a5.URDF_PATH).read_text(encoding="utf-8")


def test_forward_kinematics_of_every_frame_equals_the_dh_product(text):
    assert pinocchio_error(text) < 1e-12


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (
            'xyz="0.02 0.0 0.0462"',
            'xyz="0.02 0.0 0.047"',
        ),  # the SDK's shoulder, 0.8 mm higher
        (
            'rpy="0.0 0.0 3.141592653589793"',
            'rpy="0.0 0.0 3.1416"',
        ),  # five printed digits
        ('xyz="0.0 0.0 -0.18"', 'xyz="0.0 0.0 0.18"'),
    ],
)
def test_a_wrong_placement_is_found(text, old, new):
    assert old in text
    assert pinocchio_error(text.replace(old, new), count=50) > 1e-6


def test_every_dh_frame_is_where_the_document_puts_it():
    model = pin.buildModelFromXML(urdf(Variant(dh_frames=True)))
    data = model.createData()
    for q in reference.configurations(200, seed=2):
        pin.framesForwardKinematics(model, data, q)
        for i, pose in enumerate(reference.dh_frames(q)[1:], start=1):
            frame = data.oMf[model.getFrameId(f"dh_{i}")].homogeneous
            np.testing.assert_allclose(frame, pose, atol=1e-12)


def test_inertias_equal_table_2_to_the_last_bit(text):
    # The decimal point is shifted in the printed text, and float() reads the nearest
    # double: no product of floats on this route.
    def shifted(number: float, places: int) -> float:
        return float(f"{number:.3f}e-{places}")

    for i in range(5):
        inertial = ET.fromstring(text).find(f"link[@name='link_{i}']/inertial")
        assert float(inertial.find("mass").get("value")) == reference.MASS[i]
        com = [float(x) for x in inertial.find("origin").get("xyz").split()]
        assert com == [shifted(x, 3) for x in reference.COM[i]]
        assert [float(x) for x in inertial.find("origin").get("rpy").split()] == [
            0,
            0,
            0,
        ]
        xx, yy, zz, xy, xz, yz = (shifted(x, 6) for x in reference.INERTIA[i])
        expected = {"ixx": xx, "iyy": yy, "izz": zz, "ixy": -xy, "ixz": -xz, "iyz": -yz}
        assert {
            k: float(v) for k, v in inertial.find("inertia").attrib.items()
        } == expected


def test_yourdfpy_agrees(text, tmp_path):
    robot = yourdfpy.URDF.load(a5.URDF_PATH, load_meshes=False, build_scene_graph=True)
    worst = 0.0
    for q in reference.configurations(300, seed=3):
        robot.update_cfg(q)
        pose = robot.get_transform("tcp", "base_link")
        worst = max(worst, np.abs(pose - reference.dh_frames(q)[5]).max())
    assert worst < 1e-9


def test_massless_frames_say_so(text):
    root = ET.fromstring(text)
    inertial = root.find("link[@name='tcp']/inertial")
    assert float(inertial.find("mass").get("value")) == 0
    assert {float(v) for v in inertial.find("inertia").attrib.values()} == {0.0}


def test_the_root_has_no_inertial_whatever_it_is(text):
    """KDL warns about one, even of zeros; on any other link PyBullet wants it."""
    mounted = urdf(Variant(parent="vehicle"))
    for root_name, document in (("base_link", text), ("vehicle", mounted)):
        root = ET.fromstring(document)
        bare = [
            link.get("name")
            for link in root.iter("link")
            if link.find("inertial") is None
        ]
        assert bare == [root_name]


def test_closed_jaws_are_link_4_of_table_2():
    model = pin.buildModelFromUrdf(JAWS_URDF_PATH)
    joints = {
        name: model.joints[model.getJointId(name)].idx_q for name in model.names[1:]
    }
    q = np.zeros(model.nq)
    q[joints["axis_a"]] = 0.0013  # closed: the rod's lower limit, fingers at zero
    data = model.createData()
    pin.forwardKinematics(model, data, q)
    wrist = data.oMi[model.getJointId("axis_b")]
    total = pin.Inertia.Zero()
    for name in ("axis_b", "axis_a", "finger_1_joint", "finger_2_joint"):
        joint = model.getJointId(name)
        total += wrist.actInv(data.oMi[joint]).act(model.inertias[joint])
    assert total.mass == pytest.approx(reference.MASS[4], abs=1e-12)
    np.testing.assert_allclose(
        total.lever, np.array(reference.COM[4]) / 1e3, atol=1e-12
    )
    xx, yy, zz, xy, xz, yz = np.array(reference.INERTIA[4]) / 1e6
    expected = [[xx, -xy, -xz], [-xy, yy, -yz], [-xz, -yz, zz]]
    np.testing.assert_allclose(total.inertia, expected, atol=1e-12)


def test_rod_and_finger_limits_agree():
    root = ET.parse(JAWS_URDF_PATH).getroot()
    rod = root.find("joint[@name='axis_a']/limit")
    for i in (1, 2):
        joint = root.find(f"joint[@name='finger_{i}_joint']")
        mimic, limit = joint.find("mimic"), joint.find("limit")
        assert mimic.get("joint") == "axis_a"
        for end in ("lower", "upper"):
            angle = float(mimic.get("multiplier")) * float(rod.get(end)) + float(
                mimic.get("offset")
            )
            assert angle == pytest.approx(float(limit.get(end)), abs=1e-12)
        turn = float(mimic.get("multiplier")) * float(rod.get("velocity"))
        assert turn == pytest.approx(float(limit.get("velocity")))


def test_open_fingers_move_apart():
    model = pin.buildModelFromUrdf(JAWS_URDF_PATH, mimic=True)
    data = model.createData()
    gaps = []
    for rod in (0.0013, 0.0133):
        pin.framesForwardKinematics(model, data, np.array([1.0, 1.0, 1.0, 1.0, rod]))
        tips = [
            data.oMf[model.getFrameId(f"finger_{i}")].act(
                np.array([0, sign * 0.085, 0])
            )
            for i, sign in ((1, 1), (2, -1))
        ]
        gaps.append(np.linalg.norm(tips[0] - tips[1]))
    assert gaps[0] == pytest.approx(0.031, abs=1e-12)  # pivots 15.5 mm to either side
    assert gaps[1] == pytest.approx(0.031 + 2 * 0.085 * math.sin(51 * 0.012), abs=1e-12)


def test_the_committed_files_are_fresh():
    for path, gripper in ((a5.URDF_PATH, "locked"), (JAWS_URDF_PATH, "jaws")):
        assert Path(path).read_text("utf-8") == urdf(Variant(gripper=gripper))


def test_check_urdf_accepts_every_version(tmp_path):
    program = Path(sys.executable).with_name("check_urdf")  # the pin wheel brings it
    newest = tmp_path / "newest.urdf"
    newest.write_text(urdf(fast(limits=(0.5, 4.0), collision="capsules")))
    for path in (a5.URDF_PATH, JAWS_URDF_PATH, newest):
        result = subprocess.run(
            [program, path], capture_output=True, text=True, check=False
        )
        assert "Successfully Parsed XML" in result.stdout, result.stderr
        assert "Warning" not in result.stderr


# --- what a launch file and other tools make of it


def plain_xacro(*arguments: str) -> str:
    """What the program ``xacro`` makes of the committed sources."""
    program = Path(sys.executable).with_name("xacro")
    command = [program, XACRO_PATH, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return done.stdout


def test_a_launch_file_may_read_it_as_yaml():
    """As ROS does with a parameter of which nobody said that it is a string."""
    own = dataclasses.replace(parameters(), name="mine")
    texts = [
        Path(a5.URDF_PATH).read_text("utf-8"),
        urdf(Variant(corrections=(), gripper="jaws", collision="none")),
        urdf(Variant(arm=own, collision="none", parent="rov")),
        plain_xacro("gripper:=jaws", "ros2_control:=true", "dh_frames:=true"),
    ]
    for text in texts:
        assert isinstance(yaml.safe_load(text), str)
    with pytest.raises(yaml.YAMLError):
        yaml.safe_load(texts[0].replace("Generated from", "Generated from:"))


@pytest.mark.parametrize(
    ("prefix", "expected"),
    [
        ("", "link_0.obj"),
        ("meshes", "meshes/link_0.obj"),
        ("package://mine/meshes", "package://mine/meshes/link_0.obj"),
        ("package://mine/meshes/", "package://mine/meshes/link_0.obj"),
    ],
)
def test_meshes_lie_in_the_folder_that_is_named(prefix, expected):
    text = urdf(Variant(mesh_prefix=prefix, collision="none"))
    assert f'<mesh filename="{expected}"/>' in text


def test_the_command_takes_a_uri_of_meshes(capsys):
    words = ["generate", "urdf", "--collision", "none", "--mesh-uri"]
    assert main([*words, "package://mine/meshes"]) == 0
    assert '"package://mine/meshes/link_0.obj"' in capsys.readouterr().out
    assert main([*words, "http"]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


@pytest.mark.parametrize("gripper", ["locked", "jaws"])
def test_no_link_of_the_arm_is_the_parent(gripper):
    """Each of its names is refused, and so none of them is forgotten."""
    options = {"gripper": gripper, "dh_frames": True, "prefix": "l_"}
    root = ET.fromstring(urdf(Variant(collision="none", **options)))
    for name in [link.get("name") for link in root.iter("link")]:
        with pytest.raises(InputError) as caught:
            urdf(Variant(parent=name, **options))
        assert caught.value.name == "parent"
    assert 'parent link="tcp"' in urdf(Variant(parent="tcp", **options))


# --- URDF 1.1 and 1.2


def fast(limits: tuple[float, float], **options) -> Variant:
    """The arm in URDF 1.2, with an acceleration and a jerk of axis_d."""
    acceleration, jerk = limits
    record = parameters()
    joints = list(record.joints)
    joints[1] = dataclasses.replace(joints[1], acceleration=acceleration, jerk=jerk)
    own = dataclasses.replace(record, name="fast", joints=tuple(joints))
    return Variant(**{"arm": own, "urdf_version": "1.2", **options})


def test_1_2_has_the_accelerations_of_an_arm_file():
    root = ET.fromstring(urdf(fast(limits=(0.5, 4.0), gripper="jaws")))
    assert root.get("version") == "1.2"
    limits = {j.get("name"): j.find("limit") for j in root.iter("joint")}
    assert limits["axis_d"].get("acceleration") == "0.5"
    assert limits["axis_d"].get("jerk") == "4.0"
    for name, limit in limits.items():
        if limit is not None:
            assert ("jerk" in limit.attrib) is (name == "axis_d")
    older = urdf(fast(limits=(0.5, 4.0), urdf_version="1.1"))
    assert "acceleration" not in older
    assert 'version="1.1"' in older
    assert "version=" not in urdf().split("<link")[0].split("?>")[1]


def test_the_command_writes_the_accelerations_of_a_file(tmp_path, capsys):
    arm = tmp_path / "arm.toml"
    arm.write_text("format = 1\n[joint_limits.axis_d]\nmax_acceleration = 0.5\n")
    words = ["generate", "urdf", "--arm", str(arm), "--collision", "none"]
    assert main([*words, "--urdf-version", "1.2"]) == 0
    limit = ET.fromstring(capsys.readouterr().out).find("joint[@name='axis_d']/limit")
    assert limit.get("acceleration") == "0.5"
    assert main([*words, "--urdf-version", "2.0"]) == 2


def test_plain_xacro_takes_accelerations_of_a_file_of_limits(tmp_path):
    path = tmp_path / "limits.yaml"
    path.write_text("joint_limits: {axis_c: {max_acceleration: 0.25, max_jerk: 2}}")
    text = plain_xacro(f"limits_file:={path}", "urdf_version:=1.2", "collision:=none")
    limit = ET.fromstring(text).find("joint[@name='axis_c']/limit")
    assert (limit.get("acceleration"), limit.get("jerk")) == ("0.25", "2")


@pytest.mark.skipif(
    tuple(map(int, pin.__version__.split(".")[:2])) < (4, 1),
    reason="Pinocchio reads capsules since 4.1",
)
def test_capsules_are_those_of_mjx_in_pinocchio():
    text = urdf(Variant(collision="capsules", urdf_version="1.1"))
    model = pin.buildModelFromXML(text)
    shapes = pin.GeometryModel()
    pin.buildGeomFromUrdfString(model, text, pin.GeometryType.COLLISION, shapes)
    expected = collision_capsules()
    assert shapes.ngeoms == len(expected)
    for shape in shapes.geometryObjects:
        capsule = expected[shape.name.rpartition("_")[0]]
        placed = model.frames[shape.parentFrame].placement.actInv(shape.placement)
        half = shape.geometry.halfLength
        for end, z in ((capsule.start, -half), (capsule.end, half)):
            found = placed.act(np.array([0.0, 0.0, z]))
            np.testing.assert_allclose(found, end, rtol=0, atol=1e-12)
        assert shape.geometry.radius == capsule.radius


def test_capsules_are_read_by_mujoco():
    text = urdf(Variant(collision="capsules", urdf_version="1.1"))
    root = ET.fromstring(text)
    for link in root.iter("link"):
        for visual in link.findall("visual"):
            link.remove(visual)
    there = mujoco.MjModel.from_xml_string(ET.tostring(root, encoding="unicode"))
    is_capsule = there.geom_type == int(mujoco.mjtGeom.mjGEOM_CAPSULE)
    assert is_capsule.sum() == len(collision_capsules())


def test_a_version_that_cannot_hold_it_is_refused():
    for name, options in (
        ("urdf_version", {"collision": "capsules"}),
        ("collision", {"collision": "capsules", "gripper": "jaws"}),
    ):
        with pytest.raises(InputError) as caught:
            Variant(**options)
        assert caught.value.name == name
    with pytest.raises(UnknownNameError):
        Variant(urdf_version="1.3")
    for arguments in (["collision:=capsules"], ["urdf_version:=2.0"]):
        with pytest.raises(subprocess.CalledProcessError):
            plain_xacro(*arguments)
