"""An arm's joint positions, by name, in numbers or in time, and the poses of its links there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray, choice, float_array
from alpha5_model.description.srdf import NAMED_POSES
from alpha5_model.description.urdf_reading import UrdfJoint, parse_urdf
from alpha5_model.errors import InputError
from alpha5_model.parameters import parameters
from alpha5_model.trajectory.analysis import analyse
from alpha5_model.trajectory.motion import Motion, motion
from alpha5_model.trajectory.smoothing import DEFAULT_BANDWIDTH
from alpha5_model.view.scene import WORLD, MotionTrack, Scene

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm

#: Samples per second of a tour, and its rest at each pose [s].
_RATE, _PAUSE = 25.0, 0.6


def named_poses(arm: Arm) -> dict[str, FloatArray]:
    """Named poses as joint positions (n,) of the arm, its jaws closed."""
    closed = [joint.lower for joint in parameters().joints[4 : len(arm.joint_names)]]
    return {name: np.array([*pose, *closed]) for name, pose in NAMED_POSES.items()}


def pose_of(arm: Arm, text: str) -> FloatArray:
    """Joint positions (nq,) from the name of a pose or from numbers with commas or spaces."""
    named, n = named_poses(arm), len(arm.joint_names)
    try:
        values = [float(part) for part in text.replace(",", " ").split()]
    except ValueError:
        return with_base(arm, named[choice("pose", text.strip(), tuple(named))])
    if len(values) == 4:
        values += named["home"][4:].tolist()
    if len(values) != n:
        names = ", ".join(arm.joint_names)
        raise InputError("pose", text, f"{n} numbers ({names}), or the name of a pose")
    return with_base(arm, float_array("pose", values, (n,)))


def with_base(arm: Arm, joints: FloatArray) -> FloatArray:
    """Joint positions (n,) as the arm's q (nq,): a floating base stands at the world's origin."""
    return np.concatenate([[0, 0, 0, 0, 0, 0, 1.0], joints]) if arm.floating_base else joints


def link_poses(arm: Arm, tree: Sequence[UrdfJoint], q: FloatArray) -> dict[str, FloatArray]:
    """Pose of every link in the world by Pinocchio, (4, 4), and of the world itself."""
    links = [tree[0].parent, *(joint.child for joint in tree)]
    poses = {link: np.array(arm.forward_kinematics(q, frame=link).homogeneous) for link in links}
    return {WORLD: np.eye(4), **poses}


def posed(scene: Scene, arm: Arm, q: FloatArray) -> Scene:
    """A scene with its arm at joint positions q (nq,)."""
    joints = q[len(q) - len(scene.sliders) :]
    return replace(scene, q=joints, poses=link_poses(arm, scene.tree, q))


def resampled(arm: Arm, time: FloatArray, q: FloatArray, rate: float) -> Iterator[FloatArray]:
    """Joint positions (nq,) at a steady rate [1/s] along a motion, time (N,) and q (N, nq)."""
    at = time[0] + np.arange(0.0, time[-1] - time[0] + 0.999 / rate, 1.0 / rate)
    first = np.searchsorted(time, at, side="right") - 1
    after = np.minimum(first + 1, len(time) - 1)
    share = np.minimum((at - time[first]) / np.maximum(time[after] - time[first], 1e-12), 1.0)
    for i, k, part in zip(first, after, share, strict=True):
        yield pin.interpolate(arm.model, q[i], q[k], float(part))


def tree_of(arm: Arm, urdf: str) -> tuple[UrdfJoint, ...]:
    """The joint tree of a URDF, placed as in the arm's model: its corrections may differ."""
    tree = tuple(parse_urdf(urdf).joints.values())
    poses = link_poses(arm, tree, with_base(arm, np.zeros(len(arm.joint_names))))
    placed = []
    for joint in tree:
        child_in_parent = np.linalg.inv(poses[joint.parent]) @ poses[joint.child]
        still = np.linalg.inv(joint.motion(joint.offset))
        placed.append(replace(joint, transform=child_in_parent @ still))
    return tuple(placed)


def motion_track(
    moved: Motion, arm: Arm, q: FloatArray, current: ArrayLike | None = None
) -> MotionTrack:
    """A motion of the arm's joints, base to tip, with its torques and its load on the mount.

    Joints that it lacks stay where they are. An arm on a vehicle has no mount.
    """
    time, n = moved.time - moved.time[0], len(arm.joint_names)
    track, both = np.tile(q[len(q) - n :], (len(time), 1)), min(n, len(moved.joints))
    track[:, :both] = moved.position[:, :both]
    loads: dict[str, FloatArray] = {}
    if not arm.floating_base:
        known, rest = moved.velocity, ((0, 0), (0, n - both))
        velocity = None if known is None else np.pad(known[:, :both], rest)
        # Too few samples a second for a bandwidth.
        method = "spline" if np.median(np.diff(time)) < 0.5 / DEFAULT_BANDWIDTH else "interpolate"
        analysis = analyse(motion(time, track, velocity), arm, method=method, current=current)
        loads = {**analysis.causes(), "mount": analysis.base_wrench}
        del loads["friction"]  # at the motor
    return MotionTrack(Path(moved.source).name, time, track, loads)


def tour(waypoints: ArrayLike) -> Motion:
    """Move from pose to pose, resting at each.

    Each leg follows ``s = (1 - cos(pi t / T)) / 2`` and takes the time at which the fastest joint
    just reaches its speed.

    Args:
        waypoints: (N, n), at least two, joints base to tip [rad; jaw rod m].

    Returns:
        The motion, sampled at 25 Hz.

    Raises:
        InputError: Fewer than two poses, or not of four or five joints.
    """
    joints = parameters().joints[: np.shape(waypoints)[-1]]
    poses = float_array("waypoints", waypoints, (len(joints),))
    if poses.ndim != 2 or len(poses) < 2:
        raise InputError("waypoints", poses.shape, "at least two poses in rows")
    speed, rest = np.array([joint.velocity for joint in joints]), round(_PAUSE * _RATE)
    pieces: list[FloatArray] = [np.repeat(poses[:1], rest, axis=0)]
    for start, end in pairwise(poses):
        duration = float(np.max(np.pi / 2 * np.abs(end - start) / speed))
        phase = np.linspace(0.0, np.pi, max(2, round(duration * _RATE) + 2))[1:]
        leg = start + (end - start) * ((1.0 - np.cos(phase)) / 2)[:, None]
        pieces += [leg, np.repeat(end[None], rest, axis=0)]
    q = np.concatenate(pieces)
    return replace(motion(np.arange(len(q)) / _RATE, q), source="a short motion")
