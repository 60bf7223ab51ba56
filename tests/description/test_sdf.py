"""The Gazebo model: Table 3 by Gazebo's rule, Tables 1 and 2 by hand, libsdformat."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from reference import COM, INERTIA, LOWER, MASS, UPPER, dh_frames, inertial_frames
from sdf_reading import (
    gazebo_buoyancy,
    libsdformat,
    link_poses,
    needs_libsdformat,
    numbers,
    pose,
)
from water_reference import COB, VOLUME

import alpha5_model as a5
from alpha5_model._support.paths import REPOSITORY_PATH, URDF_PATH
from alpha5_model.cli import main
from alpha5_model.description.sdf import SdfOptions, sdf, sdf_files, sdf_world
from alpha5_model.description.srdf import NAMED_POSES
from alpha5_model.errors import InputError, UnknownNameError
from alpha5_model.numbers.jaws import split_link_4
from alpha5_model.numbers.parameters import parameters


def test_gazebos_rule_gives_table_3():
    found = gazebo_buoyancy(sdf())
    assert set(found) == set(VOLUME)
    for name, litres in VOLUME.items():
        volume, centre = found[name]
        assert volume * 1000 == pytest.approx(litres, rel=1e-12)
        np.testing.assert_allclose(centre * 1000, COB[name], atol=1e-12)


def test_boxes_have_the_bodies_proportions():
    """Gazebo's graded density slices the box, so the shape of the box counts."""
    root = ET.fromstring(sdf())
    for link in parameters().links:
        (box,) = root.findall(f".//link[@name='{link.name}']/collision")
        np.testing.assert_array_equal(pose(box)[:3, :3], np.eye(3))
        size = numbers(box.find("geometry/box/size"))
        extent = np.diff(link.bounds, axis=1)[:, 0]
        np.testing.assert_allclose(size / size[0], extent / extent[0], rtol=1e-11)
        assert (
            size[0] < extent[0]
        )  # the printed volume is less than that of the bounding box


def test_gazebos_rule_sees_a_wrong_volume_and_com_for_cob():
    text = sdf()
    root = ET.fromstring(text)
    link = root.find(".//link[@name='link_2']")
    link.find("collision/pose").text = link.find("inertial/pose").text
    _, centre = gazebo_buoyancy(ET.tostring(root, encoding="unicode"))["link_2"]
    assert np.abs(centre * 1000 - COB["link_2"]).max() > 2
    # the collision bodies of the URDF, several to a link, displace another volume
    size = link.find("collision/geometry/box/size")
    size.text = " ".join(str(1.01 * x) for x in numbers(size))
    volume, _ = gazebo_buoyancy(ET.tostring(root, encoding="unicode"))["link_2"]
    assert volume * 1000 > 1.02 * VOLUME["link_2"]


def test_jaws_displace_the_same_water_together():
    found = gazebo_buoyancy(sdf(SdfOptions(gripper="jaws")))
    bodies = {body.name: body for body in split_link_4(parameters()).bodies}
    moment, volume = np.zeros(3), 0.0
    for name in ("link_4", "finger_1", "finger_2"):
        v, centre = found[name]
        c, s = math.cos(bodies[name].roll), math.sin(bodies[name].roll)
        turn = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
        volume += v
        moment += v * (bodies[name].origin + turn @ centre)
    assert "jaw_rod" not in found
    assert volume * 1000 == pytest.approx(VOLUME["link_4"], rel=1e-12)
    np.testing.assert_allclose(moment / volume * 1000, COB["link_4"], atol=1e-11)


def test_frames_are_those_of_table_1():
    root = ET.fromstring(sdf())
    tip = next(f for f in root.iter("frame") if f.get("name") == "tcp")
    rng = np.random.default_rng(3)
    for q in rng.uniform(LOWER, UPPER, (200, 4)):
        found = link_poses(root, q)
        for i, expected in enumerate(inertial_frames(q)):
            np.testing.assert_allclose(found[f"link_{i}"], expected, atol=1e-12)
        np.testing.assert_allclose(
            found["link_4"] @ pose(tip), dh_frames(q)[5], atol=1e-12
        )


def test_inertials_are_those_of_table_2():
    root = ET.fromstring(sdf())
    for i, (mass, com, printed) in enumerate(zip(MASS, COM, INERTIA, strict=True)):
        inertial = root.find(f".//link[@name='link_{i}']/inertial")
        xx, yy, zz, xy, xz, yz = (x * 1e-6 for x in printed)
        expected = {"ixx": xx, "iyy": yy, "izz": zz, "ixy": -xy, "ixz": -xz, "iyz": -yz}
        assert float(inertial.find("mass").text) == mass
        np.testing.assert_allclose(
            numbers(inertial.find("pose")), [*np.divide(com, 1e3), 0, 0, 0]
        )
        for name, value in expected.items():
            assert float(inertial.find(f"inertia/{name}").text) == pytest.approx(
                value, rel=1e-14
            )


def test_world_holds_the_arm_in_the_fluid_asked_for():
    root = ET.fromstring(sdf_world(SdfOptions(fluid_density=1000.0)))
    assert root.get("version") == "1.9"
    plugin = root.find(".//plugin[@name='gz::sim::systems::Buoyancy']")
    assert plugin.get("filename") == "gz-sim-buoyancy-system"
    assert float(plugin.find("uniform_fluid_density").text) == 1000.0
    assert root.find("world/gravity").text == "0 0 -9.81"
    mount = root.find(".//joint[@name='mount']")
    assert mount.find("parent").text == "world"
    assert mount.find("child").text == "alpha5::base_link"
    arm = root.find(".//model[@name='alpha5']")
    assert (
        ET.tostring(arm).split()
        == ET.tostring(ET.fromstring(sdf()).find("model")).split()
    )


def test_every_mesh_is_beside_the_model():
    files = sdf_files(SdfOptions(gripper="jaws"))
    for name in ("model.sdf", "world.sdf"):
        uris = {uri.text for uri in ET.fromstring(files[name]).iter("uri")}
        assert len(uris) == 7
        assert uris <= set(files)
    libraries = {
        line.split()[1]
        for name, data in files.items()
        if name.endswith(".obj")
        for line in data.decode().splitlines()
        if line.startswith("mtllib")
    }
    assert {f"meshes/{library}" for library in libraries} <= set(files)


def test_the_closed_fingers_are_shown_where_the_urdf_shows_them():
    """The URDF's visuals are written by the xacro, these by the package."""
    root = ET.fromstring(sdf_files()["model.sdf"])
    shown = {visual.get("name"): pose(visual) for visual in root.iter("visual")}
    urdf = ET.parse(URDF_PATH).getroot()
    for visual in urdf.findall("link[@name='link_4']/visual"):
        origin = visual.find("origin")
        element = ET.fromstring(
            f"<v><pose>{origin.get('xyz')} {origin.get('rpy')}</pose></v>"
        )
        name = Path(visual.find("geometry/mesh").get("filename")).stem
        np.testing.assert_allclose(shown.pop(name), pose(element), atol=1e-12)
        colour = visual.find("material/color").get("rgba")
        for light in ("ambient", "diffuse"):
            assert (
                root.findtext(f".//visual[@name='{name}']/material/{light}") == colour
            )
    assert set(shown) == {f"link_{i}" for i in range(4)}


@needs_libsdformat
@pytest.mark.parametrize("gripper", ["locked", "jaws"])
def test_libsdformat_accepts_model_and_world(tmp_path, gripper):
    arguments = ["sdf", "--gripper", gripper, "--output", str(tmp_path)]
    assert main(["generate", *arguments]) == 0
    for name in ("model.sdf", "world.sdf"):
        done = libsdformat(tmp_path / name)
        assert "Valid." in done.stdout + done.stderr
        assert "Error" not in done.stdout
    broken = tmp_path / "broken.sdf"
    broken.write_text(
        sdf().replace("<parent>link_2</parent>", "<parent>link_9</parent>"),
        encoding="utf-8",
    )
    assert "Valid." not in (done := libsdformat(broken)).stdout + done.stderr


def test_the_fingers_follow_the_rod_in_sdf_1_11():
    texts = {
        version: sdf(SdfOptions("jaws", sdf_version=version))
        for version in ("1.9", "1.11")
    }
    assert "<mimic" not in texts["1.9"]
    root = ET.fromstring(texts["1.11"])
    assert root.get("version") == "1.11"
    lower = parameters().joints[4].lower
    followers = {e.get("name"): e.find("axis/mimic") for e in root.iter("joint")}
    followed = {name: mimic for name, mimic in followers.items() if mimic is not None}
    assert set(followed) == {"finger_1_joint", "finger_2_joint"}
    for mimic in followed.values():
        assert mimic.get("joint") == "axis_a"
        numbers = {child.tag: float(child.text) for child in mimic}
        assert numbers == pytest.approx(
            {"multiplier": 51, "offset": -51 * lower, "reference": 0}
        )
    assert "mimic" not in sdf(SdfOptions(sdf_version="1.11"))  # no fingers


def test_command_line_refuses_what_the_format_does_not_have(tmp_path, capsys):
    folder = str(tmp_path / "out")
    for arguments, option in (
        (["sdf", "--prefix", "l_"], "--prefix"),
        (["mjcf", "--prefix", "l_"], "--prefix"),
        (["sdf", "--buoyancy", "none"], "--buoyancy"),
        (["mjcf", "--sdf-version", "1.11"], "--sdf-version"),
        (["sdf", "--sdf-version", "1.10"], "SDF version"),
        (["mjcf", "--ros2-control"], "--ros2-control"),
        (["urdf", "--fluid", "fresh"], "--fluid"),
        (["fbx"], "fbx"),
        (["sdf", "--fluid", "mercury"], "fluid"),
        (["sdf", "--fluid", "-5"], "fluid"),
    ):
        assert main(["generate", *arguments, "--output", folder]) == 2
        error = capsys.readouterr().err
        assert error.count("\n") == 1
        assert option in error
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("wrong", "error"),
    [
        ({"gripper": "none"}, UnknownNameError),
        ({"fluid_density": -1.0}, InputError),
        ({"corrections": ("no_such",)}, UnknownNameError),
        ({"sdf_version": 1.11}, UnknownNameError),
    ],
)
def test_bad_options_are_refused(wrong, error):
    with pytest.raises(error):
        SdfOptions(**wrong)


@pytest.mark.parametrize("parent", ["rov", "world"])
def test_options_mount_the_arm(parent):
    """By the parent's frame, which places the model, or by the model's pose."""
    xyz_rpy = np.array([0.2, 0.1, -0.3, 3.0, 0.4, -0.2])
    options = SdfOptions(parent=parent, xyz=xyz_rpy[:3], rpy=xyz_rpy[3:])
    model = ET.fromstring(sdf(options)).find("model")
    element = ET.fromstring(f"<v><pose>{' '.join(map(str, xyz_rpy))}</pose></v>")
    mounted = pose(element)
    if parent == "world":
        np.testing.assert_allclose(pose(model), mounted, atol=1e-12)
    else:
        assert model.get("placement_frame") == parent
        frame = model.find(f"frame[@name='{parent}']")
        assert frame.get("attached_to") == "base_link"
        np.testing.assert_allclose(pose(frame) @ mounted, np.eye(4), atol=1e-11)
    for wrong in ({"xyz": (0.0, 0.0, 1.0)}, {"rpy": (1.0, 0.0, 0.0)}):
        with pytest.raises(InputError):
            SdfOptions(**wrong)


def test_every_file_that_is_named_exists():
    """In comments, too; a folder that was renamed left a wrong one."""
    text = sdf(SdfOptions(gripper="jaws", hydrodynamics=True))
    named = re.findall(r"[\w/]+\.(?:toml|json|yaml)", text)
    assert named
    assert all((Path(REPOSITORY_PATH) / name).is_file() for name in named)


# --- Controllers ----------------------------------------------------------------------

POSITION = "gz::sim::systems::JointPositionController"
STATES = "gz::sim::systems::JointStatePublisher"
#: What JointPositionController.cc of gz-sim reads, besides topics and modes.
READ = {
    "joint_name",
    "p_gain",
    "i_gain",
    "d_gain",
    "i_max",
    "i_min",
    "cmd_max",
    "cmd_min",
    "cmd_offset",
    "initial_position",
}


def controllers(gripper: str, text: str | None = None) -> dict[str, dict[str, float]]:
    """Joint -> the elements of its controller, in the order of the file."""
    options = SdfOptions(gripper=gripper, controllers=True)
    found = {}
    for plugin in ET.fromstring(text or sdf(options)).iter("plugin"):
        if plugin.get("name") == POSITION:
            assert plugin.get("filename") == "gz-sim-joint-position-controller-system"
            values = {child.tag: child.text for child in plugin}
            assert set(values) <= READ
            joint = values.pop("joint_name")
            found[joint] = {name: float(value) for name, value in values.items()}
    return found


def held(gripper: str, scale: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Error and speed after 2 s: PID of gz-math over steps of 1 ms, our dynamics.

    Args:
        gripper: ``locked`` or ``jaws``.
        scale: Of the derivative gains.
    """
    arm = a5.load(gripper=gripper)
    settings = list(controllers(gripper).values())[: arm.model.nv]
    p, d, most, target = (
        np.array([one[name] for one in settings])
        for name in ("p_gain", "d_gain", "cmd_max", "initial_position")
    )
    step = 1e-3
    q = target.copy()
    q[:4] = NAMED_POSES["reach"]
    v = np.zeros(q.size)
    before = q - target
    for _ in range(2000):
        error = q - target
        slope = (error - before) / step
        before = error
        force = np.clip(-p * error - scale * d * slope, -most, most)
        v = v + step * arm.forward_dynamics(q, v, force)
        q = q + step * v
    return q - target, v


@pytest.mark.parametrize("gripper", ["locked", "jaws"])
def test_the_gains_hold_home_in_water(gripper):
    error, speed = held(gripper)
    assert np.abs(error).max() < 0.01
    assert np.abs(speed).max() < 1e-4


def test_gains_that_are_unstable_at_a_step_of_1_ms_are_seen():
    _, speed = held("locked", scale=2.0)
    assert np.abs(speed).max() > 0.1


@pytest.mark.parametrize(("gripper", "count"), [("locked", 4), ("jaws", 5)])
def test_each_driven_joint_has_one_within_its_effort(gripper, count):
    found = controllers(gripper)
    joints = a5.parameters().joints[:count]
    assert list(found) == [joint.name for joint in joints]
    for joint in joints:
        assert found[joint.name]["cmd_max"] == joint.effort
        assert found[joint.name]["cmd_min"] == -joint.effort
        assert joint.lower <= found[joint.name]["initial_position"] <= joint.upper


def test_joint_states_are_published_and_nothing_is_there_without_the_option():
    text = sdf(SdfOptions(controllers=True))
    (states,) = (
        p for p in ET.fromstring(text).iter("plugin") if p.get("name") == STATES
    )
    assert states.get("filename") == "gz-sim-joint-state-publisher-system"
    world = sdf_world(SdfOptions(gripper="jaws", controllers=True))
    assert len(controllers("jaws", world)) == 5
    assert POSITION not in sdf()
    assert STATES not in sdf_world()
    with pytest.raises(InputError):
        SdfOptions(controllers="yes")
