"""The settings of MoveIt 2 and of ros2_control's controllers, with their SRDF."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from alpha5_model._support.checks import plain_name
from alpha5_model.description.srdf import srdf
from alpha5_model.numbers.jaws import Gripper
from alpha5_model.numbers.parameters import (
    DEFAULT_ACCELERATION,
    Alpha5Parameters,
    JointParameters,
    chosen_arm,
)

#: First line of a file.
_COMMENTS = {
    "joint_limits.yaml": "Speeds, accelerations and jerks are the arm's. No "
    f"acceleration is published: {DEFAULT_ACCELERATION} is a choice.",
    "kinematics.yaml": "Four joints cannot reach most orientations: the solver must "
    "leave orientation alone (moveit#3695).",
}


def moveit_files(
    gripper: Gripper = "locked", prefix: str = "", arm: Alpha5Parameters | None = None
) -> dict[str, bytes]:
    """The files that MoveIt's setup assistant would write, name -> content.

    Args:
        gripper: ``locked`` or ``jaws``, whose rod is a group with a controller.
        prefix: Prefix of every link, joint, group and controller, as in the URDF.
        arm: Record of an arm of your own, whose limits they have; None for the
            catalogue's.

    Raises:
        InputError: A prefix with which no ROS node can be named: controllers are nodes.
        Alpha5Error: See `alpha5_model.description.srdf.srdf`.
    """
    import yaml

    if prefix:
        plain_name("prefix", prefix)
    text = srdf(gripper, arm, prefix)
    *turning, rod = chosen_arm(arm).joints
    groups = {f"{prefix}arm": turning}
    if gripper == "jaws":
        groups[f"{prefix}gripper"] = [rod]
    names = {
        f"{group}_controller": [prefix + joint.name for joint in joints]
        for group, joints in groups.items()
    }
    contents = {
        "joint_limits.yaml": _joint_limits(groups, prefix),
        "kinematics.yaml": {f"{prefix}arm": _SOLVER},
        "ompl_planning.yaml": {**_PLANNING, f"{prefix}arm": _PLANNERS},
        "moveit_controllers.yaml": _moveit_controllers(names),
        "ros2_controllers.yaml": _ros2_controllers(names),
    }
    files = {"alpha5.srdf": text.encode()}
    for name, content in contents.items():
        comment = f"# {_COMMENTS[name]}\n" if name in _COMMENTS else ""
        written = yaml.safe_dump(content, sort_keys=False)
        files[name] = (comment + written).encode()
    return files


def _joint_limits(
    groups: Mapping[str, list[JointParameters]], prefix: str
) -> dict[str, Any]:
    limits = {}
    for joints in groups.values():
        for joint in joints:
            limit = {
                "has_velocity_limits": True,
                "max_velocity": float(joint.velocity),
                "has_acceleration_limits": True,
                "max_acceleration": float(joint.acceleration or DEFAULT_ACCELERATION),
            }
            if joint.jerk is not None:
                limit |= {"has_jerk_limits": True, "max_jerk": float(joint.jerk)}
            limits[prefix + joint.name] = limit
    return {"joint_limits": limits}


_SOLVER = {
    "kinematics_solver": "kdl_kinematics_plugin/KDLKinematicsPlugin",
    "kinematics_solver_search_resolution": 0.005,
    "kinematics_solver_timeout": 0.05,
    "position_only_ik": True,
}

_PLANNING = {
    "planning_plugins": ["ompl_interface/OMPLPlanner"],
    "request_adapters": [
        "default_planning_request_adapters/ResolveConstraintFrames",
        "default_planning_request_adapters/ValidateWorkspaceBounds",
        "default_planning_request_adapters/CheckStartStateBounds",
        "default_planning_request_adapters/CheckStartStateCollision",
    ],
    "response_adapters": [
        "default_planning_response_adapters/AddTimeOptimalParameterization",
        "default_planning_response_adapters/ValidateSolution",
    ],
    "planner_configs": {
        "RRTConnectkConfigDefault": {"type": "geometric::RRTConnect", "range": 0.0},
        "RRTstarkConfigDefault": {"type": "geometric::RRTstar", "range": 0.0},
    },
}

_PLANNERS = {
    "default_planner_config": "RRTConnectkConfigDefault",
    "planner_configs": ["RRTConnectkConfigDefault", "RRTstarkConfigDefault"],
}


def _moveit_controllers(names: Mapping[str, list[str]]) -> dict[str, Any]:
    """What MoveIt sends motions to: joints by the name of their controller."""
    manager = "moveit_simple_controller_manager"
    controllers = {
        name: {
            "action_ns": "follow_joint_trajectory",
            "type": "FollowJointTrajectory",
            "default": True,
            "joints": joints,
        }
        for name, joints in names.items()
    }
    return {
        "moveit_controller_manager": f"{manager}/MoveItSimpleControllerManager",
        manager: {"controller_names": list(names), **controllers},
    }


def _ros2_controllers(names: Mapping[str, list[str]]) -> dict[str, Any]:
    """What ``ros2_control_node`` is given: joints by the name of their controller."""
    kinds = {"joint_state_broadcaster": "joint_state_broadcaster/JointStateBroadcaster"}
    for name in names:
        kinds[name] = "joint_trajectory_controller/JointTrajectoryController"
    manager = {name: {"type": kind} for name, kind in kinds.items()}
    controllers = {
        name: {
            "ros__parameters": {
                "joints": joints,
                "command_interfaces": ["position"],
                "state_interfaces": ["position", "velocity"],
            }
        }
        for name, joints in names.items()
    }
    return {"controller_manager": {"ros__parameters": manager}, **controllers}
