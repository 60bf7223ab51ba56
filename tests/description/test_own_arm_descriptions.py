"""Every description of an arm of your own is that arm."""

from __future__ import annotations

import dataclasses
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import newton_euler as ne
import numpy as np
import own_arm_dynamics as own
import pinocchio as pin
import pytest
import sdf_reading
from own_arm import mount_pose

import alpha5_model as a5
from alpha5_model._support.paths import XACRO_PATH
from alpha5_model.cli import main
from alpha5_model.collision.link_pairs import NEVER_PAIRS
from alpha5_model.description.mjcf import MjcfOptions, mjcf, mjcf_files
from alpha5_model.description.sdf import SdfOptions, sdf, sdf_files, sdf_world
from alpha5_model.description.srdf import NAMED_POSES, named_pose, srdf
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.description.xacro_parameters import parameter_yaml
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters
from alpha5_model.numbers.pose import Pose

DENSITY = 1025.0
GRAVITY = np.array([0.0, 0.0, -9.81])
RECORDS = own.RECORDS
#: With a spacer; with a tool beside the wrist axis; on a mount. All have other lengths,
#: limits and bodies, some of them attached.
every_record = pytest.mark.parametrize("record", [RECORDS[k] for k in (1, 2, 9)])


def plain_xacro(folder: Path, record: Alpha5Parameters, *arguments: str) -> str:
    """What the program ``xacro`` makes of a record's YAML, without this package."""
    file = folder / "my_arm.yaml"
    file.write_text(parameter_yaml(record), encoding="utf-8")
    program = [sys.executable, "-c", "import xacro; xacro.main()"]
    done = subprocess.run(
        [*program, XACRO_PATH, f"parameters:={file}", *arguments],
        capture_output=True,
        text=True,
        cwd=folder,
        check=True,
    )
    return done.stdout


def same_elements(one: str, other: str) -> bool:
    return ET.canonicalize(one, strip_text=True) == ET.canonicalize(
        other, strip_text=True
    )


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 9])
def test_plain_xacro_makes_the_urdf_of_the_record(seed: int, tmp_path: Path) -> None:
    record = RECORDS[seed]
    locked = plain_xacro(tmp_path, record, "dh_frames:=true")
    assert same_elements(locked, urdf(Variant(arm=record, dh_frames=True)))
    jaws = plain_xacro(tmp_path, record, "gripper:=jaws", "ros2_control:=true")
    ours = urdf(Variant(arm=record, gripper="jaws", ros2_control=True))
    assert same_elements(jaws, ours)


def test_plain_xacro_mounts_on_another_parent_where_it_is_given(tmp_path: Path) -> None:
    record = RECORDS[9]
    place = ("parent:=table", "xyz:=0.1 0.0 0.0", "rpy:=0.0 0.0 0.0")
    text = plain_xacro(tmp_path, record, *place)
    variant = Variant(arm=record, parent="table", xyz=(0.1, 0.0, 0.0))
    assert same_elements(text, urdf(variant))
    assert "bluerov" not in text
    assert 'xyz="0.1 0.0 0.0"' in text


def test_ros2_control_has_the_limits_of_the_record() -> None:
    record = RECORDS[1]
    variant = Variant(arm=record, gripper="jaws", ros2_control=True)
    root = ET.fromstring(urdf(variant)).find("ros2_control")
    assert root is not None
    for joint in record.joints:
        element = root.find(f"joint[@name='{joint.name}']")
        assert element is not None

        def number(path: str, inside: ET.Element = element) -> float:
            return float(inside.findtext(path, "nan"))

        position = "command_interface[@name='position']/param"
        velocity = "command_interface[@name='velocity']/param"
        assert number(f"{position}[@name='min']") == joint.lower
        assert number(f"{position}[@name='max']") == joint.upper
        assert number(f"{velocity}[@name='min']") == -joint.velocity
        assert number(f"{velocity}[@name='max']") == joint.velocity
        start = number("state_interface[@name='position']/param")
        assert joint.lower <= start <= joint.upper


# --- the same arm in each: poses, masses, torques -------------------------------------


def expected_torque(
    record: Alpha5Parameters, states: tuple[np.ndarray, ...], density: float
) -> np.ndarray:
    gravity = mount_pose(record)[:3, :3].T @ GRAVITY
    q, v, a = states
    return own.inverse_dynamics(record, q, v, a, density, gravity)[0]


@every_record
def test_the_urdf_is_the_record_on_its_mount(record: Alpha5Parameters) -> None:
    model = pin.buildModelFromXML(urdf(Variant(arm=record)))
    data = model.createData()
    q, v, a = own.states(record, 8)
    torque = expected_torque(record, (q, v, a), 0.0)
    for k in range(8):
        assert pin.rnea(model, data, q[k], v[k], a[k]) == pytest.approx(
            torque[k], abs=1e-11
        )
        pin.crba(model, data, q[k])
        masses = np.triu(data.M) + np.triu(data.M, 1).T
        assert masses == pytest.approx(own.mass_matrix(record, q[k]), abs=1e-11)
        pin.framesForwardKinematics(model, data, q[k])
        tip = data.oMf[model.getFrameId("tcp")].homogeneous
        expected = mount_pose(record) @ own.tcp(record, q[k])
        assert tip == pytest.approx(expected, abs=1e-11)
    lower, upper = model.lowerPositionLimit, model.upperPositionLimit
    for i, joint in enumerate(record.joints[:4]):
        assert (lower[i], upper[i]) == (joint.lower, joint.upper)
        assert model.velocityLimit[i] == joint.velocity
        assert model.effortLimit[i] == joint.effort


def free_mujoco(text: str) -> tuple[Any, Any]:
    """A model in which nothing but inertia, weight and water acts."""
    mujoco = pytest.importorskip("mujoco", minversion="3.5")
    model = mujoco.MjModel.from_xml_string(text)
    for name in ("LIMIT", "CONTACT", "EQUALITY", "ACTUATION"):
        model.opt.disableflags |= getattr(mujoco.mjtDisableBit, f"mjDSBL_{name}")
    return model, mujoco.MjData(model)


@every_record
def test_the_mujoco_model_is_the_record_in_water(record: Alpha5Parameters) -> None:
    mujoco = pytest.importorskip("mujoco", minversion="3.5")
    model, data = free_mujoco(mjcf(MjcfOptions(arm=record, fluid_density=DENSITY)))
    q, v, a = own.states(record, 8)
    torque = expected_torque(record, (q, v, a), DENSITY)
    for k in range(8):
        data.qpos, data.qvel, data.qacc = q[k], v[k], a[k]
        mujoco.mj_inverse(model, data)
        assert data.qfrc_inverse == pytest.approx(torque[k], abs=1e-11)
        masses = np.zeros((4, 4))
        for row, unit in zip(masses, np.eye(4), strict=True):
            mujoco.mj_mulM(model, data, row, unit)
        assert masses == pytest.approx(own.mass_matrix(record, q[k]), abs=1e-11)
        tip = np.eye(4)
        tip[:3, :3] = data.site("tcp").xmat.reshape(3, 3)
        tip[:3, 3] = data.site("tcp").xpos
        expected = mount_pose(record) @ own.tcp(record, q[k])
        assert tip == pytest.approx(expected, abs=1e-11)
    for joint in record.joints[:4]:
        assert model.joint(joint.name).range.tolist() == [joint.lower, joint.upper]
        force = model.actuator(joint.name).forcerange.tolist()
        assert force == [-joint.effort, joint.effort]


def test_closed_jaws_in_mujoco_are_the_record() -> None:
    record = RECORDS[1]
    mujoco = pytest.importorskip("mujoco", minversion="3.5")
    options = MjcfOptions(arm=record, gripper="jaws", fluid_density=DENSITY)
    model, data = free_mujoco(mjcf(options))
    q, v, a = own.states(record, 4)
    torque = expected_torque(record, (q, v, a), DENSITY)
    rest = np.zeros(3)
    for k in range(4):
        # The rod is at its lower limit, and the fingers at zero.
        data.qpos = [*q[k], record.joints[4].lower, 0.0, 0.0]
        data.qvel, data.qacc = np.r_[v[k], rest], np.r_[a[k], rest]
        mujoco.mj_inverse(model, data)
        assert data.qfrc_inverse[:4] == pytest.approx(torque[k], abs=1e-11)


def sdf_bodies(text: str) -> list[list[ne.Body]]:
    """The bodies of the links, with Gazebo's volumes and centres of buoyancy."""
    root = ET.fromstring(text)
    floating = sdf_reading.gazebo_buoyancy(text)
    bodies = []
    for i in range(5):
        link = root.find(f".//link[@name='link_{i}']")
        assert link is not None
        numbers = {
            moment.tag: float(moment.text or "nan")
            for moment in link.iterfind("inertial/inertia/*")
        }
        tensor = np.array(
            [
                [numbers["ixx"], numbers["ixy"], numbers["ixz"]],
                [numbers["ixy"], numbers["iyy"], numbers["iyz"]],
                [numbers["ixz"], numbers["iyz"], numbers["izz"]],
            ]
        )
        place = sdf_reading.numbers(link.find("inertial/pose"))
        assert not place[3:].any()
        volume, cob = floating[f"link_{i}"]
        mass = float(link.findtext("inertial/mass", "nan"))
        bodies.append([ne.Body(mass, place[:3], tensor, volume, cob)])
    return bodies


def placed_by(root: ET.Element) -> np.ndarray:
    """Pose of base_link in the frame by which the model is placed, times its pose."""
    model = root.find("model")
    assert model is not None
    pose = sdf_reading.pose(model)
    name = model.get("placement_frame")
    if name == "base_link":
        return pose
    frame = model.find(f"frame[@name='{name}']")
    assert frame is not None
    assert frame.get("attached_to") == "base_link"
    return np.asarray(pose @ np.linalg.inv(sdf_reading.pose(frame)))


def sdf_frames(root: ET.Element, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rotations (5, N, 3, 3) and origins (5, N, 3) of the links in base_link."""
    poses = [sdf_reading.link_poses(root, angles) for angles in q]
    names = [f"link_{i}" for i in range(5)]
    frames = np.array([[pose[name] for pose in poses] for name in names])
    return frames[..., :3, :3], frames[..., :3, 3]


@every_record
def test_the_gazebo_model_is_the_record_in_water(record: Alpha5Parameters) -> None:
    text = sdf(SdfOptions(arm=record, fluid_density=DENSITY))
    root = ET.fromstring(text)
    q, v, a = own.states(record, 8)
    gravity = placed_by(root)[:3, :3].T @ GRAVITY
    bodies = sdf_bodies(text)
    frames = sdf_frames(root, q)
    found, _ = own.of_bodies(bodies, frames, v, a, DENSITY, gravity)
    expected = expected_torque(record, (q, v, a), DENSITY)
    # Bodies with something attached are written with 12 digits.
    assert found == pytest.approx(expected, abs=1e-11)

    for k in range(8):
        same = sdf_frames(root, np.tile(q[k], (4, 1)))
        rest, units = np.zeros((4, 4)), np.eye(4)
        masses, _ = own.of_bodies(bodies, same, rest, units, 0.0, np.zeros(3))
        assert masses == pytest.approx(own.mass_matrix(record, q[k]), abs=1e-11)


@every_record
def test_the_gazebo_model_has_the_tool_and_the_limits(record: Alpha5Parameters) -> None:
    root = ET.fromstring(sdf(SdfOptions(arm=record)))
    tcp = root.find(".//frame[@name='tcp']")
    assert tcp is not None
    for q in own.states(record, 8)[0]:
        wrist = sdf_reading.link_poses(root, q)["link_4"]
        tip = placed_by(root) @ wrist @ sdf_reading.pose(tcp)
        expected = mount_pose(record) @ own.tcp(record, q)
        assert tip == pytest.approx(expected, abs=1e-11)
    for joint in record.joints[:4]:
        limit = root.find(f".//joint[@name='{joint.name}']/axis/limit")
        assert limit is not None
        assert {each.tag: float(each.text or "nan") for each in limit} == {
            "lower": joint.lower,
            "upper": joint.upper,
            "effort": joint.effort,
            "velocity": joint.velocity,
        }


def test_an_arm_on_the_world_stands_there_in_mujoco_and_gazebo() -> None:
    mount = own.random_mount(3)
    on_world = Pose(mount.position, mount.rotation, "world")
    record = dataclasses.replace(RECORDS[2], mount=on_world)
    root = ET.fromstring(mjcf(MjcfOptions(arm=record)))
    body = root.find("worldbody/body")
    assert body is not None
    assert body.get("name") == "base_link"
    assert body.get("quat") is not None
    gazebo = ET.fromstring(sdf(SdfOptions(arm=record)))
    assert placed_by(gazebo) == pytest.approx(mount_pose(record), abs=1e-11)
    assert gazebo.find(".//frame[@name='world']") is None


@sdf_reading.needs_libsdformat
@pytest.mark.tools
@pytest.mark.parametrize(
    ("parent", "gripper"), [("bluerov", "locked"), ("world", "jaws")]
)
def test_libsdformat_accepts_model_and_world(
    parent: str, gripper: str, tmp_path: Path
) -> None:
    random = own.random_mount(3)
    mount = Pose(random.position, random.rotation, parent)
    record = dataclasses.replace(RECORDS[1], mount=mount)
    for name, content in sdf_files(SdfOptions(arm=record, gripper=gripper)).items():
        file = tmp_path / name
        file.parent.mkdir(exist_ok=True)
        file.write_bytes(content)
    for name in ("model.sdf", "world.sdf"):
        done = sdf_reading.libsdformat(tmp_path / name)
        assert "Valid." in done.stdout + done.stderr
        assert "Error" not in done.stdout


@pytest.mark.parametrize("parent", ["link_2", "base_link"])
@pytest.mark.parametrize(
    "write",
    [
        lambda arm: urdf(Variant(arm=arm)),
        lambda arm: mjcf(MjcfOptions(arm=arm)),
        lambda arm: sdf(SdfOptions(arm=arm)),
    ],
)
def test_a_carrier_named_as_the_arm_is_refused(write: Any, parent: str) -> None:
    mount = own.random_mount(3)
    taken = Pose(mount.position, mount.rotation, parent)
    with pytest.raises(InputError) as caught:
        write(dataclasses.replace(RECORDS[2], mount=taken))
    assert "parent" in caught.value.name


# --- names, poses and pairs -----------------------------------------------------------


def states_of(text: str) -> dict[str, dict[str, float]]:
    return {
        str(state.get("name")): {
            str(joint.get("name")): float(joint.get("value", "nan")) for joint in state
        }
        for state in ET.fromstring(text).iter("group_state")
    }


@every_record
def test_named_poses_lie_within_the_limits(record: Alpha5Parameters) -> None:
    mujoco = pytest.importorskip("mujoco", minversion="3.5")
    lower = np.array([joint.lower for joint in record.joints[:4]])
    upper = np.array([joint.upper for joint in record.joints[:4]])
    states = states_of(srdf("jaws", record))
    model = mujoco.MjModel.from_xml_string(mjcf(MjcfOptions(arm=record)))
    for name, pose in NAMED_POSES.items():
        expected = np.clip(pose, lower, upper)
        assert list(states[name].values()) == expected.tolist()
        assert model.key(name).qpos.tolist() == expected.tolist()
        assert named_pose(name, arm=record).tolist() == expected.tolist()
    rod = record.joints[4]
    assert states["closed"] == {"axis_a": rod.lower}
    assert states["open"] == {"axis_a": rod.upper}


def test_all_descriptions_have_the_arms_name() -> None:
    record = RECORDS[1]
    assert '<robot name="lab_1">' in urdf(Variant(arm=record))
    assert '<robot name="lab_1">' in srdf(arm=record)
    assert '<mujoco model="lab_1">' in mjcf(MjcfOptions(arm=record))
    files = sdf_files(SdfOptions(arm=record))
    assert b'<model name="lab_1"' in files["model.sdf"]
    assert b"<name>lab_1</name>" in files["model.config"]
    world = ET.fromstring(sdf_world(SdfOptions(arm=record)))
    assert world.findtext(".//joint[@name='mount']/child") == "lab_1::base_link"
    folder = mjcf_files(MjcfOptions(arm=record))
    assert b'<mujoco model="lab_1 scene">' in folder["scene.xml"]
    assert b"changed for the arm lab_1" in folder["README.md"]


def never(text: str) -> set[tuple[str, str]]:
    return {
        (str(pair.get("link1")), str(pair.get("link2")))
        for pair in ET.fromstring(text).iter("disable_collisions")
        if pair.get("reason") == "Never"
    }


def excluded(text: str) -> set[tuple[str, str]]:
    return {
        (str(pair.get("body1")), str(pair.get("body2")))
        for pair in ET.fromstring(text).iter("exclude")
    }


@pytest.mark.parametrize(("change", "kept"), [(-0.039, True), (-0.041, False)])
def test_pairs_that_never_meet_are_checked_for_other_lengths(
    change: float, kept: bool
) -> None:
    arm = parameters()
    row = dataclasses.replace(arm.dh[1], a=arm.dh[1].a + change)
    record = dataclasses.replace(arm, dh=(arm.dh[0], row, *arm.dh[2:]))
    pairs = set(NEVER_PAIRS) if kept else set()
    assert never(srdf("jaws", record)) == pairs
    options = MjcfOptions(arm=record, gripper="jaws")
    assert excluded(mjcf(options)) & set(NEVER_PAIRS) == pairs


# --- the command ----------------------------------------------------------------------

EXAMPLE = Path(__file__).parents[2] / "examples" / "my_arm.toml"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["srdf", "--gripper", "jaws"], lambda arm: srdf("jaws", arm)),
        (["xacro"], parameter_yaml),
        (
            ["mjcf", "--gripper", "jaws"],
            lambda arm: mjcf_files(MjcfOptions("jaws", arm=arm))["alpha5.xml"].decode(),
        ),
        (["sdf"], lambda arm: sdf_files(SdfOptions(arm=arm))["model.sdf"].decode()),
    ],
)
def test_generate_writes_the_arm_of_a_file(
    words: list[str], expected: Any, capsys: Any
) -> None:
    assert main(["generate", words[0], "--arm", str(EXAMPLE), *words[1:]]) == 0
    assert capsys.readouterr().out == expected(a5.arm_file(EXAMPLE))


def test_generate_writes_one_file_for_xacro(tmp_path: Path, capsys: Any) -> None:
    numbers = tmp_path / "mine.yaml"
    words = ["generate", "xacro", "--output"]
    assert main([*words, str(numbers), "--arm", str(EXAMPLE)]) == 0
    assert [path.name for path in tmp_path.iterdir()] == ["mine.yaml"]
    assert numbers.read_text("utf-8") == parameter_yaml(a5.arm_file(EXAMPLE))
    for wrong in ("mine.urdf", "folder"):
        assert main([*words, str(tmp_path / wrong)]) == 2
        assert len(capsys.readouterr().err.splitlines()) <= 2


def test_the_committed_parameters_are_fresh() -> None:
    committed = Path(XACRO_PATH).with_name("parameters.yaml")
    assert committed.read_text("utf-8") == parameter_yaml(parameters())
