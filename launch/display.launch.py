"""Show the arm in RViz, with sliders for its joints.

ros2 launch alpha5_description display.launch.py gripper:=jaws
"""

import xml.etree.ElementTree as ET
from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.conditions import IfCondition
from launch.substitutions import (
    Command,
    FindExecutable,
    LaunchConfiguration,
    PathJoinSubstitution,
)
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

# Arguments that xacro takes under the same name: name, default, description.
XACRO_ARGUMENTS = (
    (
        "gripper",
        "locked",
        "locked (4 joints) or jaws (adds axis_a and two fingers that follow it)",
    ),
    ("prefix", "", "stands before every link and joint name"),
    ("collision", "primitives", "primitives, none, or with urdf_version capsules"),
    ("urdf_version", "1.0", "1.0, 1.1, or 1.2 with limits of acceleration and jerk"),
    ("dh_frames", "false", "adds the massless frames dh_1 to dh_5"),
    (
        "limits_file",
        "",
        "YAML of joint limits of your own, as xacro/limits_example.yaml",
    ),
    (
        "ros2_control",
        "false",
        "adds hardware interfaces and the bus address of each joint",
    ),
    (
        "ros2_control_hardware",
        "mock",
        "mock, alpha_hardware, blue_reach_5, or a YAML file of your own",
    ),
    (
        "ros2_control_parameters",
        "",
        "NAME=VALUE of the hardware, such as serial_port=/dev/ttyUSB0",
    ),
    ("ros2_control_plugin", "", "another plugin than the hardware's"),
)
FOLDER = Path(__file__).resolve().parent.parent
MESHES = "package://alpha5_description/meshes/"


def generate_launch_description() -> LaunchDescription:
    """robot_state_publisher on the expanded xacro, joint sliders, RViz."""
    share = FindPackageShare("alpha5_description")
    command = [
        FindExecutable(name="xacro"),
        " ",
        PathJoinSubstitution([share, "xacro", "alpha5.urdf.xacro"]),
        f" mesh_prefix:={MESHES}",
    ]
    for name, _, _ in XACRO_ARGUMENTS:
        command += [f" {name}:='", LaunchConfiguration(name), "'"]
    description = ParameterValue(Command(command), value_type=str)
    return LaunchDescription(
        [
            *(
                DeclareLaunchArgument(name, default_value=default, description=text)
                for name, default, text in XACRO_ARGUMENTS
            ),
            DeclareLaunchArgument(
                "gui", default_value="true", description="sliders and RViz"
            ),
            Node(
                package="robot_state_publisher",
                executable="robot_state_publisher",
                parameters=[{"robot_description": description}],
            ),
            Node(
                package="joint_state_publisher_gui",
                executable="joint_state_publisher_gui",
                parameters=[_start()],
                condition=IfCondition(LaunchConfiguration("gui")),
            ),
            Node(
                package="rviz2",
                executable="rviz2",
                arguments=["-d", PathJoinSubstitution([share, "rviz", "alpha5.rviz"])],
                condition=IfCondition(LaunchConfiguration("gui")),
            ),
        ]
    )


def _start() -> dict[tuple, float]:
    """Where the sliders start: at the SRDF's home.

    At zero the arm is beyond its limits and in collision.
    """
    srdf = ET.parse(FOLDER / "urdf" / "alpha5.srdf")
    start = {}
    for joint in srdf.findall("group_state[@name='home']/joint"):
        name = ("zeros.", LaunchConfiguration("prefix"), joint.get("name"))
        start[name] = float(joint.get("value"))
    return start
