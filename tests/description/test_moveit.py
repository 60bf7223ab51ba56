"""The settings of MoveIt and of controllers have the arm's joints and speeds.

MoveIt is not run.
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
from alpha5_model.description.urdf import Variant, urdf

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
