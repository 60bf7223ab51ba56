"""Frames that other tools compute, against the product of Table 1's rows."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from itertools import product

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import transform
from alpha5_model.description.pinocchio_model import urdf_model
from alpha5_model.description.verification.subject import FileCheck, Subject
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.theory.dh.link import dh_transform

#: Largest error of a frame, in metres and in radians; the project's promise for other
#: tools is 1e-9.
FRAME_BOUND = 1e-12
YOURDFPY_BOUND = 1e-9

# yourdfpy logs problems of a file; the row reports them instead.
logging.getLogger("yourdfpy").addHandler(logging.NullHandler())

#: A function of a file, the names of F frames without prefix, base_link first, and
#: joint positions (N, 4). It yields the frames' poses in base_link, N times (F, 4, 4).
Tool = Callable[[Subject, list[str], FloatArray], Iterator[list[FloatArray]]]


def check_frames(
    tool: str, text: Subject, q: FloatArray, compute: Tool, bound: float
) -> FileCheck:
    """Compare every frame as another tool computes it with `dh_product`."""
    check = f"frames, {tool}"
    expected = dh_product(text.expected, q)
    wanted = _wanted_frames(text, expected)
    absent = [name for name in wanted if text.prefix + name not in text.links]
    if absent:
        return text.row(check, "failed", f"no link {', '.join(absent)} to compute")

    try:
        # The file may hold infinite numbers, which the comparison reveals.
        with np.errstate(all="ignore"):
            given = np.array(list(compute(text, wanted, q)))
    except ImportError:
        return text.row(check, "not run", f"{tool} is not installed")
    except Exception as error:
        # Other tools raise anything for a file that they cannot load.
        problem = " ".join(str(error).split())
        return text.row(check, "failed", f"{tool}: {problem[:200]}")

    errors = []
    for k, name in enumerate(wanted):
        errors.append(frame_error(given[:, k], expected[name]))
    worst = int(np.argmax(errors))
    count = f"{len(wanted)} frames at {len(q)} joint positions"
    claim = "against Table 1's DH product [m, rad]"
    return text.row(
        check,
        verdict="passed" if errors[worst] <= bound else "failed",
        finding=f"{count} {claim}; largest at {wanted[worst]}",
        measured=float(np.max(errors)),
        bound=bound,
        unit="m, rad",
    )


def _wanted_frames(text: Subject, expected: dict[str, FloatArray]) -> list[str]:
    """Frames to compare: the arm's, and the DH frames that the file has."""
    wanted = []
    for name in expected:
        optional = name.startswith("dh_")
        if not optional or text.prefix + name in text.links:
            wanted.append(name)
    return wanted


def configurations(p: Alpha5Parameters, count: int) -> FloatArray:
    """Every corner of the limits, and seeded random positions within them, (N, 4)."""
    joints = p.joints[:4]
    lower = np.array([joint.lower for joint in joints])
    upper = np.array([joint.upper for joint in joints])
    corners = list(product(*zip(lower, upper, strict=True)))
    inside = np.random.default_rng(5).uniform(lower, upper, (count, 4))
    return np.vstack([corners, inside])


def dh_product(p: Alpha5Parameters, q: FloatArray) -> dict[str, FloatArray]:
    """Poses in base_link of all frames, from Table 1 and Section 2, as products of A_j.

    Args:
        p: Table 1 in SI units, or the record of an arm of your own.
        q: (N, 4) [rad].

    Returns:
        ``base_link``, ``link_0`` to ``link_4``, ``dh_1`` to ``dh_5`` and ``tcp`` -> (N,
        4, 4).
    """
    pose = np.broadcast_to(np.eye(4), (len(q), 4, 4))
    frames = {
        "base_link": pose,
        "link_0": pose @ dh_transform(p.base_yaw, 0, 0, 0),
    }
    for i, row in enumerate(p.dh):
        angle = row.theta_offset + (q[:, i] if row.variable else 0.0)
        if row.variable:
            # Section 2: the link's frame is after the rotation, before the rest of the
            # row.
            frames[f"link_{i + 1}"] = pose @ dh_transform(angle, 0, 0, 0)
        pose = pose @ dh_transform(angle, row.d, row.a, row.alpha)
        frames[f"dh_{i + 1}"] = pose
    frames["tcp"] = pose
    if p.tool is not None:
        tool = transform(p.tool.rotation, p.tool.position)
        frames["tcp"] = frames["link_4"] @ tool
    return frames


def frame_error(given: FloatArray, expected: FloatArray) -> float:
    """Larger of the errors in position [m] and orientation [rad], over all samples."""
    shift = np.linalg.norm(given[:, :3, 3] - expected[:, :3, 3], axis=1)
    relative = np.swapaxes(expected[:, :3, :3], -1, -2) @ given[:, :3, :3]
    # |R - R^T| / sqrt(8) is sin(angle): exact for small angles, where acos of the trace
    # is blind.
    skew = relative - np.swapaxes(relative, -1, -2)
    sine = np.linalg.norm(skew, axis=(-2, -1)) / np.sqrt(8)
    cosine = (np.trace(relative, axis1=-2, axis2=-1) - 1) / 2
    angle = np.arctan2(sine, cosine)
    return float(max(shift.max(), angle.max()))


def pinocchio_frames(
    text: Subject, links: list[str], q: FloatArray
) -> Iterator[list[FloatArray]]:
    """Poses of the links by Pinocchio; see `Tool`."""
    import pinocchio as pin

    model = urdf_model(text.path)
    data = model.createData()
    absent = []
    for name in JOINT_NAMES[:4]:
        if not model.existJointName(text.prefix + name):
            absent.append(name)
    if absent:
        raise ValueError(f"no movable joint {', '.join(absent)}")

    joints = [model.getJointId(text.prefix + name) for name in JOINT_NAMES[:4]]
    columns = [model.joints[joint].idx_q for joint in joints]
    frames = [model.getFrameId(text.prefix + n, pin.FrameType.BODY) for n in links]
    position = pin.neutral(model)
    for row in q:
        position[columns] = row
        pin.framesForwardKinematics(model, data, position)
        home = data.oMf[frames[0]].inverse()
        yield [(home * data.oMf[frame]).homogeneous for frame in frames]


def yourdfpy_frames(
    text: Subject, links: list[str], q: FloatArray
) -> Iterator[list[FloatArray]]:
    """Poses of the links by yourdfpy; see `Tool`."""
    import yourdfpy

    robot = yourdfpy.URDF.load(
        str(text.path), load_meshes=False, build_scene_graph=True
    )
    joints = [text.prefix + name for name in JOINT_NAMES[:4]]
    frames = [text.prefix + name for name in links]
    for row in q:
        robot.update_cfg(dict(zip(joints, row, strict=True)))
        yield [robot.get_transform(frame, frames[0]) for frame in frames]
