"""The settings of MoveIt and of controllers have the arm's joints and limits.

MoveIt is not run, and its parser of SRDF, srdfdom, is neither on PyPI nor in Debian.
Pinocchio reads the SRDF in its place, and so does `faults`, by the rules of srdfdom:
https://github.com/moveit/srdfdom/blob/ros2/src/model.cpp.
"""

from __future__ import annotations

import inspect
import re
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import yaml
from scipy.interpolate import BPoly

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.description.moveit import moveit_files
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.errors import InputError

REPOSITORY = Path(__file__).resolve().parents[2]
CONFIG = REPOSITORY / "config"
GRIPPERS = {"": "alpha5", "_jaws": "alpha5_jaws"}


def settings(name: str) -> dict:
    return yaml.safe_load((CONFIG / f"{name}.yaml").read_text("utf-8"))


def groups(name: str) -> dict[str, list[str]]:
    """Group of an SRDF -> its joints; a chain has those that Pinocchio finds."""
    folder = REPOSITORY / "urdf"
    model = pin.buildModelFromUrdf(str(folder / f"{name}.urdf"))
    found = {}
    for group in ET.parse(folder / f"{name}.srdf").getroot().findall("group"):
        chain = group.find("chain")
        joints = [joint.get("name") for joint in group.findall("joint")]
        if chain is not None:
            tip = model.frames[model.getFrameId(chain.get("tip_link"))].parentJoint
            joints = [model.names[j] for j in model.supports[tip] if j > 0]
        found[group.get("name")] = joints
    return found


def test_limits_are_the_arms_and_the_acceleration_is_the_planners():
    joints = a5.parameters().joints
    limits = settings("joint_limits")["joint_limits"]
    speeds = {name: limit["max_velocity"] for name, limit in limits.items()}
    assert speeds == {joint.name: joint.velocity for joint in joints}
    planned = inspect.signature(a5.plan).parameters["acceleration"].default
    assert {limit["max_acceleration"] for limit in limits.values()} == {planned}
    assert not any("jerk" in key for limit in limits.values() for key in limit)


def test_limits_of_an_arm_file(tmp_path):
    """In SI, by hand; ROS takes a number without a point for no double."""
    arm = tmp_path / "lab.toml"
    arm.write_text(
        """
        format = 1
        [joint_limits.axis_e]
        max_acceleration = {value = 90, unit = "deg/s^2"}
        max_jerk = 5
        [joint_limits.axis_a]
        max_velocity = {value = 2, unit = "mm/s"}
        max_acceleration = {value = 20, unit = "mm/s^2"}
        max_jerk = 0.2
        """
    )
    main(
        ["generate", "moveit", "--gripper=jaws", f"--arm={arm}", f"--output={tmp_path}"]
    )
    text = (tmp_path / "joint_limits.yaml").read_text("utf-8")
    limits = yaml.safe_load(text)["joint_limits"]
    assert limits["axis_e"]["max_acceleration"] == pytest.approx(np.pi / 2)
    assert limits["axis_e"]["max_jerk"] == 5.0
    assert limits["axis_a"] == {
        "has_velocity_limits": True,
        "max_velocity": pytest.approx(0.002),
        "has_acceleration_limits": True,
        "max_acceleration": pytest.approx(0.02),
        "has_jerk_limits": True,
        "max_jerk": pytest.approx(0.2),
    }
    assert limits["axis_d"] == settings("joint_limits")["joint_limits"]["axis_d"]
    numbers = re.findall(r"max_\w+: (\S+)", text)
    assert len(numbers) == 5 + 5 + 2
    assert all("." in number for number in numbers)


# --- the SRDF -------------------------------------------------------------------------


def faults(srdf: str, urdf: str) -> list[str]:
    """What srdfdom would leave out of an SRDF with a line in its log."""
    robot = ET.fromstring(urdf)
    links = {link.get("name") for link in robot.findall("link")}
    joints = {joint.get("name") for joint in robot.findall("joint")}
    parents = {
        joint.find("child").get("link"): joint.find("parent").get("link")
        for joint in robot.findall("joint")
    }
    root = ET.fromstring(srdf)
    groups = {group.get("name") for group in root.findall("group")}
    known = {
        "group/chain": {"base_link": links, "tip_link": links},
        "group/joint": {"name": joints},
        "group_state": {"group": groups},
        "group_state/joint": {"name": joints},
        "end_effector": {
            "group": groups,
            "parent_group": groups,
            "parent_link": links,
        },
        "passive_joint": {"name": joints},
        "disable_collisions": {"link1": links, "link2": links},
    }
    assert {child.tag for child in root} <= {path.partition("/")[0] for path in known}
    found = [] if root.get("name") == robot.get("name") else ["name"]
    for path, attributes in known.items():
        for element in root.findall(path):
            for name, allowed in attributes.items():
                if element.get(name) not in allowed:
                    found.append(f"{path} {name}={element.get(name)}")
    for chain in root.findall("group/chain"):
        link = chain.get("tip_link")
        while link is not None and link != chain.get("base_link"):
            link = parents.get(link)
        if link is None:
            found.append(f"no chain to {chain.get('tip_link')}")
    return found


def loaded(srdf: str, urdf: str) -> tuple[pin.Model, pin.GeometryModel]:
    """As Pinocchio reads both: named poses in the model, pairs in the geometry."""
    model = pin.buildModelFromXML(urdf)
    geometry = pin.buildGeomFromUrdfString(model, urdf, pin.GeometryType.COLLISION)
    geometry.addAllCollisionPairs()
    pin.loadReferenceConfigurationsFromXML(model, srdf)
    pin.removeCollisionPairsFromXML(model, geometry, srdf)
    return model, geometry


@pytest.mark.parametrize("gripper", ["locked", "jaws"])
def test_an_srdf_with_a_prefix_belongs_to_the_urdf_with_it(gripper, capsys):
    texts = {}
    for prefix in ("", "left_"):
        for kind in ("urdf", "srdf"):
            main(["generate", kind, f"--gripper={gripper}", f"--prefix={prefix}"])
            texts[prefix, kind] = capsys.readouterr().out
        assert faults(texts[prefix, "srdf"], texts[prefix, "urdf"]) == []
    assert len(faults(texts["", "srdf"], texts["left_", "urdf"])) > 10

    plain, prefixed = (
        loaded(texts[prefix, "srdf"], texts[prefix, "urdf"]) for prefix in ("", "left_")
    )
    assert named(prefixed[0]) == named(plain[0])
    assert set(named(plain[0])) >= {"stow", "home", "reach"}
    assert compared(prefixed[1], "left_") == compared(plain[1], "")
    assert 0 < len(plain[1].collisionPairs) < len(every_pair(plain[1]))


def named(model: pin.Model) -> dict[str, list[float]]:
    """Named pose -> joint positions."""
    return {
        entry.key(): entry.data().tolist() for entry in model.referenceConfigurations
    }


def compared(geometry: pin.GeometryModel, prefix: str) -> set[frozenset[str]]:
    """Names of the bodies of the pairs that are left, without the prefix."""
    names = [body.name.removeprefix(prefix) for body in geometry.geometryObjects]
    return {
        frozenset((names[pair.first], names[pair.second]))
        for pair in geometry.collisionPairs
    }


def every_pair(geometry: pin.GeometryModel) -> list[pin.CollisionPair]:
    whole = geometry.copy()
    whole.addAllCollisionPairs()
    return list(whole.collisionPairs)


@pytest.mark.parametrize("prefix", ["a b", "<", "\n", "1left_", "left/", "left-"])
def test_a_prefix_that_no_controller_can_have_is_refused(prefix):
    """Controllers are ROS nodes: letters, digits and underscores, no digit first."""
    with pytest.raises(InputError, match="prefix"):
        moveit_files(prefix=prefix)


def test_two_arms_of_one_robot_share_no_group_and_no_controller():
    names = []
    for prefix in ("left_", "right_"):
        files = moveit_files("jaws", prefix)
        for name in ("ros2_controllers", "moveit_controllers"):
            content = yaml.safe_load(files[f"{name}.yaml"])
            manager = content.get("moveit_simple_controller_manager", content)
            names += [key for key in manager if key.startswith(("left_", "right_"))]
        limits = yaml.safe_load(files["joint_limits.yaml"])["joint_limits"]
        assert all(joint.startswith(prefix) for joint in limits)
        for name in ("kinematics", "ompl_planning"):
            assert f"{prefix}arm" in yaml.safe_load(files[f"{name}.yaml"])
    assert sorted(names) == sorted(
        2
        * [
            f"{prefix}{group}_controller"
            for prefix in ("left_", "right_")
            for group in ("arm", "gripper")
        ]
    )


# --- the controllers ------------------------------------------------------------------


@pytest.mark.parametrize("suffix", GRIPPERS, ids=GRIPPERS.values())
def test_controllers_move_the_groups_of_the_srdf(suffix):
    own = {
        f"{name}_controller": joints
        for name, joints in groups(GRIPPERS[suffix]).items()
    }
    ours = settings(f"ros2_controllers{suffix}")
    del ours["controller_manager"]
    moveit = settings(f"moveit_controllers{suffix}")["moveit_simple_controller_manager"]
    assert moveit.pop("controller_names") == list(ours)
    assert {
        name: controller["ros__parameters"]["joints"]
        for name, controller in ours.items()
    } == own
    assert {name: controller["joints"] for name, controller in moveit.items()} == own


@pytest.mark.parametrize("hardware", ["mock", "alpha_hardware", "blue_reach_5"])
def test_every_hardware_has_the_interfaces_of_the_controllers(hardware):
    variant = Variant(
        gripper="jaws",
        collision="none",
        ros2_control=True,
        ros2_control_hardware=hardware,
    )
    joints = ET.fromstring(urdf(variant)).findall("ros2_control/joint")
    controllers = settings("ros2_controllers_jaws")
    del controllers["controller_manager"]
    claimed = []
    for controller in controllers.values():
        parameters = controller["ros__parameters"]
        claimed += parameters["joints"]
        for kind in ("command", "state"):
            for joint in joints:
                offered = [e.get("name") for e in joint.findall(f"{kind}_interface")]
                assert set(parameters[f"{kind}_interfaces"]) <= set(offered)
    # alpha_hardware changes the mode of all joints at once, or of none.
    assert sorted(claimed) == sorted(joint.get("name") for joint in joints)


def test_the_guides_goal_is_a_motion_that_the_controller_takes(tmp_path, monkeypatch):
    """Its joints, times, rest at the end, and what lies between the points.

    joint_trajectory_controller interpolates by quintic polynomials, and refuses a last
    velocity that is not 0.
    """
    monkeypatch.chdir(tmp_path)
    guide = (REPOSITORY / "docs" / "guides" / "ros.md").read_text("utf-8")
    fenced = re.findall(r"^```+\{?[\w-]*\}?[^\n]*\n(.*?)^```+$", guide, re.M | re.S)
    (block,) = (text for text in fenced if "a5.plan(" in text)
    names = {}
    exec(block, names)
    motion = names["motion"]

    written = (tmp_path / "motion.yaml").read_text("utf-8")
    # As the shell puts it into the action's goal.
    goal = yaml.safe_load(f"{{trajectory: {written}}}")["trajectory"]
    controllers = yaml.safe_load((CONFIG / "ros2_controllers.yaml").read_text("utf-8"))
    joints = controllers["arm_controller"]["ros__parameters"]["joints"]
    assert goal["joint_names"] == joints
    stamps = [point["time_from_start"] for point in goal["points"]]
    time = np.array([stamp["sec"] + 1e-9 * stamp["nanosec"] for stamp in stamps])
    assert (np.diff(time) > 0).all()
    assert goal["points"][-1]["velocities"] == [0.0] * 4

    columns = ("positions", "velocities", "accelerations")
    derivatives = [[point[name] for name in columns] for point in goal["points"]]
    quintic = BPoly.from_derivatives(time, np.array(derivatives, float))
    # The same motion at more places, and in a time that is not a multiple of 0.1 s.
    fine = a5.plan(motion.way[0], motion.way[-1])
    between = quintic(fine.time * (time[-1] / fine.duration))
    assert abs(between - fine.position).max() < 1e-4
