"""The settings of MoveIt and of controllers, against the description they belong to.

Names of parameters were read in the sources of moveit2, moveit_resources and
ros2_controllers, and are written down here a second time. MoveIt is not run.
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
#: Parameters of a solver: MoveIt's three, and those of the KDL plugin.
KINEMATICS = {
    "kinematics_solver",
    "kinematics_solver_search_resolution",
    "kinematics_solver_timeout",
    "max_solver_iterations",
    "epsilon",
    "orientation_vs_position",
    "position_only_ik",
}
LIMITS = {
    "has_velocity_limits",
    "max_velocity",
    "has_acceleration_limits",
    "max_acceleration",
}
JTC_COMMANDS = {"position", "velocity", "acceleration", "effort"}
JTC_STATES = {"position", "velocity", "acceleration"}


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


def test_the_solver_ignores_orientation_and_every_name_exists():
    content = settings("kinematics")
    assert set(content) == {"arm"} <= set(groups("alpha5"))
    solver = content["arm"]
    assert set(solver) <= KINEMATICS
    assert solver["position_only_ik"] is True
    assert solver["kinematics_solver"] == "kdl_kinematics_plugin/KDLKinematicsPlugin"


def test_most_orientations_cannot_be_reached():
    """Why the solver is position-only: two of three turns of the tool are not free."""
    model = pin.buildModelFromUrdf(a5.URDF_PATH)
    data = model.createData()
    rng = np.random.default_rng(20)
    lower, upper = model.lowerPositionLimit, model.upperPositionLimit
    for q in rng.uniform(lower, upper, (50, 4)):
        frame = model.getFrameId("tcp")
        jacobian = pin.computeFrameJacobian(model, data, q, frame, pin.LOCAL)
        place, turn = jacobian[:3], jacobian[3:]
        assert np.linalg.matrix_rank(place, tol=1e-6) == 3
        # With the tool point held, one direction of joint space is left.
        _, _, rows = np.linalg.svd(place)
        assert np.linalg.matrix_rank(turn @ rows[3:].T, tol=1e-6) == 1


def test_limits_are_the_descriptions_and_the_acceleration_is_the_planners():
    robot = ET.parse(REPOSITORY / "urdf" / "alpha5_jaws.urdf").getroot()
    own = settings("joint_limits")["joint_limits"]
    assert list(own) == [joint.name for joint in a5.parameters().joints]
    planned = inspect.signature(a5.plan).parameters["acceleration"].default
    for name, limits in own.items():
        assert set(limits) == LIMITS
        limit = robot.find(f"joint[@name='{name}']/limit")
        assert limits["max_velocity"] == float(limit.get("velocity"))
        assert limits["max_acceleration"] == planned


def test_planners_are_named_and_chosen():
    content = settings("ompl_planning")
    assert content["planning_plugins"] == ["ompl_interface/OMPLPlanner"]
    for name, planner in content["planner_configs"].items():
        kind = planner["type"].removeprefix("geometric::")
        assert name == f"{kind}kConfigDefault"
    arm = content["arm"]
    assert arm["planner_configs"] == list(content["planner_configs"])
    assert arm["default_planner_config"] in arm["planner_configs"]


@pytest.mark.parametrize("suffix", GRIPPERS, ids=GRIPPERS.values())
def test_controllers_move_the_groups_of_the_srdf(suffix):
    own = groups(GRIPPERS[suffix])
    ours = settings(f"ros2_controllers{suffix}")
    types = ours.pop("controller_manager")["ros__parameters"]
    assert set(types) == {*ours, "joint_state_broadcaster"}
    moveit = settings(f"moveit_controllers{suffix}")["moveit_simple_controller_manager"]
    assert moveit["controller_names"] == list(ours)
    assert set(moveit) == {*ours, "controller_names"}
    for group, joints in own.items():
        name = f"{group}_controller"
        assert types[name]["type"].startswith("joint_trajectory_controller/")
        parameters = ours[name]["ros__parameters"]
        assert parameters["joints"] == moveit[name]["joints"] == joints
        assert moveit[name]["type"] == "FollowJointTrajectory"
        assert set(parameters["command_interfaces"]) <= JTC_COMMANDS
        assert set(parameters["state_interfaces"]) <= JTC_STATES
    assert set(ours) == {f"{group}_controller" for group in own}


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


def test_the_srdf_leaves_as_many_pairs_of_shapes_as_the_guide_says():
    counts = []
    for name in GRIPPERS.values():
        path = REPOSITORY / "urdf" / f"{name}.urdf"
        model = pin.buildModelFromUrdf(str(path))
        shapes = pin.buildGeomFromUrdf(model, str(path), pin.GeometryType.COLLISION)
        shapes.addAllCollisionPairs()
        counts += [len(shapes.geometryObjects), len(shapes.collisionPairs)]
        srdf = str(path.with_suffix(".srdf"))
        pin.removeCollisionPairs(model, shapes, srdf, False)
        counts.append(len(shapes.collisionPairs))
    of_locked, locked, left, of_jaws, jaws, left_with_jaws = counts
    assert of_locked == of_jaws
    said = (
        f"The {of_locked} collision shapes make {locked} pairs on different links. "
        f"{left} of them are left to check; with jaws, {left_with_jaws} of {jaws}."
    )
    guide = (REPOSITORY / "docs" / "guides" / "ros.md").read_text("utf-8")
    assert said in " ".join(guide.split())


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

    goal = yaml.safe_load((tmp_path / "goal.yaml").read_text("utf-8"))["trajectory"]
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
    between = quintic(np.minimum(motion.time, time[-1]))
    assert abs(between - motion.position).max() < 1e-4
