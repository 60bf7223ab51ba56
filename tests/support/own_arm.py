"""Arms with lengths, zeros, limits and tools of their own, and where their tips are.

The forward kinematics are the rows of Table 1, multiplied out.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np

import alpha5_model as a5
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.pose import Pose

TWISTS = (math.pi / 2, math.pi, -math.pi / 2, 0.0)
#: Jaws along -z, the x axis of the tool forward: Table 1's axes of {5} in link_4.
TOOL_AXES = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]])


def with_tool(
    x: float, y: float, z: float, record: Alpha5Parameters | None = None
) -> Alpha5Parameters:
    """A record whose tool point is at (x, y, z) in link_4 [m]."""
    tool = Pose(position=np.array([x, y, z]), rotation=TOOL_AXES)
    return dataclasses.replace(record or a5.parameters(), tool=tool)


def random_arm(rng: np.random.Generator, off_axis: bool) -> Alpha5Parameters:
    """An arm with random lengths, zeros, limits and tool."""
    published = a5.parameters()
    lengths = {
        0: {"a": rng.uniform(0.03, 0.08), "d": rng.uniform(0.005, 0.05)},
        1: {"a": rng.uniform(0.1, 0.25)},
        2: {"a": rng.uniform(0.005, 0.05)},
        3: {},
    }
    rows = [
        dataclasses.replace(
            published.dh[i],
            theta_offset=published.dh[i].theta_offset + rng.uniform(-0.2, 0.2),
            **changes,
        )
        for i, changes in lengths.items()
    ]
    joints = [
        dataclasses.replace(
            joint,
            lower=joint.lower + rng.uniform(0.0, 0.5),
            upper=joint.upper - rng.uniform(0.0, 0.5),
        )
        for joint in published.joints[:4]
    ]
    record = dataclasses.replace(
        published,
        dh=(*rows, published.dh[4]),
        joints=(*joints, published.joints[4]),
    )
    x, y = rng.uniform(-0.06, 0.06, 2) if off_axis else (0.0, 0.0)
    return with_tool(x, y, -rng.uniform(0.15, 0.3), record)


def limits(record: Alpha5Parameters) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper limits of theta_0 ... theta_3, (4,) each."""
    joints = record.joints[:4]
    lower = np.array([joint.lower for joint in joints])
    upper = np.array([joint.upper for joint in joints])
    return lower, upper


def within(record: Alpha5Parameters, count: int, seed: int) -> np.ndarray:
    """Random configurations within the limits, (count, 4)."""
    return np.random.default_rng(seed).uniform(*limits(record), (count, 4))


def link_4(record: Alpha5Parameters, q: np.ndarray) -> np.ndarray:
    """Pose of link_4 in base_link, (..., 4, 4)."""
    out = np.broadcast_to(np.eye(4), (*q.shape[:-1], 4, 4))
    for j, (row, twist) in enumerate(zip(record.dh, TWISTS, strict=False)):
        theta = q[..., j] + row.theta_offset
        a, d = (row.a, row.d) if j < 3 else (0.0, 0.0)
        c, s = np.cos(theta), np.sin(theta)
        ca, sa = round(math.cos(twist)), round(math.sin(twist))
        step = np.zeros((*q.shape[:-1], 4, 4))
        step[..., 0, 0], step[..., 0, 1], step[..., 0, 2] = c, -s * ca, s * sa
        step[..., 1, 0], step[..., 1, 1], step[..., 1, 2] = s, c * ca, -c * sa
        step[..., 2, 1], step[..., 2, 2] = sa, ca
        step[..., 0, 3], step[..., 1, 3], step[..., 2, 3] = a * c, a * s, d
        step[..., 3, 3] = 1.0
        out = out @ step
    return np.asarray(out)


def poses(record: Alpha5Parameters, q: np.ndarray) -> np.ndarray:
    """transform_tcp_to_base, (..., 4, 4)."""
    tool = np.eye(4)
    assert record.tool is not None
    tool[:3, :3] = record.tool.rotation
    tool[:3, 3] = record.tool.position
    return np.asarray(link_4(record, q) @ tool)


def tips(record: Alpha5Parameters, q: np.ndarray) -> np.ndarray:
    """tcp positions, (..., 3)."""
    tool = record.tool
    point = np.array([0.0, 0.0, record.dh[3].d]) if tool is None else tool.position
    at = link_4(record, q)
    return np.asarray(at[..., :3, :3] @ point + at[..., :3, 3])


def turned_apart(q: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Largest joint difference up to full turns, (...) [rad]."""
    off = (q - other + math.pi) % math.tau - math.pi
    return np.asarray(np.abs(off).max(axis=-1))


def mount_pose(record: Alpha5Parameters) -> np.ndarray:
    """Pose of base_link in what carries it, (4, 4)."""
    pose = np.eye(4)
    if record.mount is not None:
        pose[:3, :3] = record.mount.rotation
        pose[:3, 3] = record.mount.position
    return pose
