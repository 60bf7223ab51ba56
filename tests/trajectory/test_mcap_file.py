"""A motion as MCAP, written by rosbags and read by MCAP's own library."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.trajectory.analysis import Analysis
from alpha5_model.trajectory.mcap_file import mcap

START = 1.7e9
TIME = START + np.arange(0.0, 6.0, 0.1)


def analysed(gripper: str = "locked", start: float = START) -> Analysis:
    """A short sway with recorded efforts."""
    n = 5 if gripper == "jaws" else 4
    home = np.array([*a5.named_pose("home"), 0.007])[:n]
    seconds = TIME - START
    sway = np.array([0.3, 0.2, -0.4, 0.5, 0.002])[:n]
    q = home + np.sin(seconds)[:, None] * sway
    effort = np.cos(seconds)[:, None] * np.arange(1.0, n + 1)
    motion = a5.trajectory.motion(seconds + start, q, effort=effort)
    arm = a5.load(gripper=gripper)
    return a5.trajectory.analyse(motion, arm, method="interpolate")


def messages(data: bytes) -> dict[str, list[Any]]:
    """Messages by topic, in their order; each with `log_time` [ns] and `content`."""
    reader = make_reader(io.BytesIO(data), decoder_factories=[DecoderFactory()])
    found: dict[str, list[Any]] = {}
    for _, channel, message, content in reader.iter_decoded_messages():
        found.setdefault(channel.topic, []).append((message.log_time, content))
    return found


def rotated(quaternion: Any) -> np.ndarray:
    """Rotation matrix of a ROS quaternion, by the textbook's formula."""
    w = quaternion.w
    u = np.array([quaternion.x, quaternion.y, quaternion.z])
    cross = np.array([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])
    return (w**2 - u @ u) * np.eye(3) + 2 * np.outer(u, u) + 2 * w * cross


def chained(transforms: list[Any]) -> dict[str, np.ndarray]:
    """Pose (4, 4) of each frame in base_link."""
    poses = {"base_link": np.eye(4)}
    for each in transforms:
        shift = each.transform.translation
        step = np.eye(4)
        step[:3, :3] = rotated(each.transform.rotation)
        step[:3, 3] = [shift.x, shift.y, shift.z]
        poses[each.child_frame_id] = poses[each.header.frame_id] @ step
    return poses


def test_joint_states_torques_and_mount_load_are_those_of_the_analysis() -> None:
    analysis = analysed()
    found = messages(mcap(analysis))
    assert set(found) == {"/joint_states", "/torques", "/mount_load", "/tcp", "/tf"}
    assert {len(stream) for stream in found.values()} == {TIME.size}

    table = a5.trajectory.columns(analysis)
    for k in range(TIME.size):
        log_time, state = found["/joint_states"][k]
        assert log_time == state.header.stamp.sec * 10**9 + state.header.stamp.nanosec
        assert abs(log_time / 1e9 - TIME[k]) < 1e-6
        assert state.name == list(analysis.smooth.joints)
        np.testing.assert_array_equal(state.position, analysis.smooth.position[k])
        np.testing.assert_array_equal(state.velocity, analysis.smooth.velocity[k])
        np.testing.assert_array_equal(state.effort, analysis.torque[k])

        torques = found["/torques"][k][1]
        expected = [table[name][k] for name in torques.name]
        np.testing.assert_array_equal(torques.effort, expected)
        assert len(torques.position) == len(torques.velocity) == 0

        wrench = found["/mount_load"][k][1].wrench
        load = [wrench.force.x, wrench.force.y, wrench.force.z]
        load += [wrench.torque.x, wrench.torque.y, wrench.torque.z]
        np.testing.assert_array_equal(load, analysis.base_wrench[k])
    assert {"axis_d_torque_weight", "axis_b_effort"} <= set(torques.name)


@pytest.mark.slow
@pytest.mark.parametrize("gripper", ["locked", "jaws"])
def test_the_frames_are_where_the_arm_has_them(gripper: str) -> None:
    """Chained up from base_link, fingers included."""
    analysis = analysed(gripper)
    found = messages(mcap(analysis))
    for k in (0, 7, TIME.size - 1):
        poses = chained(found["/tf"][k][1].transforms)
        for frame, pose in poses.items():
            placement = analysis.arm.forward_kinematics(
                analysis.smooth.position[k], frame=frame
            )
            np.testing.assert_allclose(pose, placement.homogeneous, atol=1e-12)
        point = found["/tcp"][k][1].point
        np.testing.assert_allclose(
            [point.x, point.y, point.z], poses["tcp"][:3, 3], atol=1e-12
        )
    fingers = {name for name in poses if "finger" in name}
    assert fingers == ({"finger_1", "finger_2"} if gripper == "jaws" else set())


def test_pinocchio_computes_the_written_efforts_from_the_written_motion() -> None:
    """Inverse dynamics of the printed arm, at positions and speeds from the file."""
    analysis = analysed()
    _, state = messages(mcap(analysis))["/joint_states"][6]
    arm = a5.load()
    q = np.array(state.position)
    in_air = pin.rnea(
        arm.model,
        arm.model.createData(),
        q,
        np.array(state.velocity),
        analysis.smooth.acceleration[6],
    )
    torque = in_air - arm.buoyancy_torque(q)
    np.testing.assert_allclose(state.effort, torque, atol=1e-9)


def test_the_command_writes_what_it_can_read(tmp_path: Path) -> None:
    analysis = analysed()
    table = a5.trajectory.write(analysis, tmp_path / "motion.csv")
    target = tmp_path / "motion.mcap"
    arguments = ["--smoothing", "interpolate", "--output", str(target)]
    assert main(["trajectory", str(table), *arguments]) == 0

    again = a5.trajectory.read_motion(target)
    assert again.joints == analysis.smooth.joints
    assert again.warnings == ()
    np.testing.assert_allclose(again.position, analysis.smooth.position, atol=1e-8)
    np.testing.assert_allclose(again.effort, analysis.torque, atol=1e-4)
