"""Frames on the joint axes of any serial arm, by the Denavit-Hartenberg rule.

``x_j`` lies on the common normal of ``z_{j-1}`` and ``z_j`` and points from the first
to the second; the origin of {j} is where it meets ``z_j``. If the rule leaves a choice:

- intersecting axes: ``x_j`` along ``z_{j-1} x z_j``, so alpha_j lies in (0, pi);
- parallel axes: the normal through the origin of {j-1}, so d_j is zero;
- one and the same axis: ``x_j = x_{j-1}``, same origin, so theta_j, d_j, a_j are zero;
- {0}: the world frame if its z is the first joint's axis, else the frame on that axis
  that makes theta_1 and d_1 zero;
- {N}: ``z_N`` is the z axis of the end effector, whose pose in {N} is the chain's tool.
  If that axis is parallel to the last joint's, {N} has the end effector's origin. If it
  is the same axis, {N} also has its x, and the tool is the identity.

References:
    [Lecture7.1] Describing Robot Arms, "Frame assignment".
    [Siciliano2009] Siciliano et al.: Robotics, section 2.8.2 (where it is not unique).
    [Corke2011] Corke: Robotics, Vision and Control, section 7.2.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray, instance
from alpha5_model._support.spatial import transform
from alpha5_model.errors import InputError, UnknownNameError

if TYPE_CHECKING:
    import pinocchio as pin

#: Axes within this angle [rad] count as parallel, within this distance [m] as
#: intersecting. This moves the axes of an arm of 1 m by errors of the same size. Axes
#: with a larger tilt have a common normal up to 1 m / tilt away, where rounding errors
#: are 2e-16 m / tilt. The value balances both errors.
_TOLERANCE = 1.5e-8
#: A pitch above this makes a joint helical [m].
_HELICAL = 1e-12


class _Normal(NamedTuple):
    """The common normal of the axes of {j-1} and {j}.

    Attributes:
        x: Its direction, which is that of x_j, (3,).
        foot_before: Its foot on z_{j-1}, (3,) [m].
        foot: Its foot on z_j, which is the origin of {j}, (3,) [m].
    """

    x: FloatArray
    foot_before: FloatArray
    foot: FloatArray


def frames_on_axes(
    p: FloatArray, z: FloatArray, end: FloatArray | None
) -> list[FloatArray]:
    """Frames {0} ... {N} of a serial arm at one configuration, (4, 4) each.

    Args:
        p: A point on each joint axis, (N, 3) [m].
        z: Unit direction of each axis, (N, 3).
        end: transform_end_effector_to_world, (4, 4); without one {N} is {N-1}.
    """
    if end is not None:
        p = np.vstack([p, end[:3, 3]])
        z = np.vstack([z, end[:3, 2]])
    frames = [_first_frame(p, z)]
    for point, direction in zip(p[1:], z[1:], strict=True):
        normal = _normal(frames[-1], point, direction)
        frames.append(_frame(normal.foot, normal.x, direction))
    if end is None:
        frames.append(frames[-1])
    elif np.linalg.norm(np.cross(z[-2], z[-1])) <= _TOLERANCE:
        frames[-1] = _frame_of_end(end, p[-2], frames[-1])
    return frames


def _first_frame(p: FloatArray, z: FloatArray) -> FloatArray:
    """Frame {0}: the world frame, or a frame on the first axis."""
    off_axis = max(math.hypot(*z[0, :2]), math.hypot(*p[0, :2]))
    if off_axis <= _TOLERANCE and z[0, 2] > 0:
        return np.eye(4)
    far_from_z = np.eye(3)[np.abs(z[0]).argmin()]
    first = _frame(p[0], far_from_z, z[0])
    if len(p) == 1:
        return first
    # {0} is {1} seen from the first axis: theta_1 = d_1 = 0.
    normal = _normal(first, p[1], z[1])
    return _frame(normal.foot_before, normal.x, z[0])


def _frame_of_end(end: FloatArray, point: FloatArray, last: FloatArray) -> FloatArray:
    """Frame {N} if the end effector's z axis is parallel to the last joint's.

    Args:
        end: transform_end_effector_to_world, (4, 4).
        point: A point on the last joint's axis, (3,) [m].
        last: The frame by the common rule, (4, 4).
    """
    z = end[:3, 2]
    away = np.cross(np.cross(z, end[:3, 3] - point), z)
    same_axis = np.linalg.norm(away) <= _TOLERANCE
    x = end[:3, 0] if same_axis else last[:3, 0]
    return _frame(end[:3, 3], x, z)


def table_row(step: FloatArray) -> tuple[float, float, float, float]:
    """theta, d, a, alpha of a relative pose that has the form of A_j."""
    theta = math.atan2(step[1, 0], step[0, 0])
    alpha = math.atan2(step[2, 1], step[2, 2])
    a = step[0, 3] * step[0, 0] + step[1, 3] * step[1, 0]
    return theta, float(step[2, 3]), float(a), alpha


def _normal(previous: FloatArray, point: FloatArray, z: FloatArray) -> _Normal:
    """The common normal of the z axis of {j-1} and the axis of {j}."""
    origin = previous[:3, 3]
    z_before = previous[:3, 2]
    between = point - origin
    cross = np.cross(z_before, z)
    square = cross @ cross
    sine = math.sqrt(square)
    if sine > _TOLERANCE:
        foot_before = origin + np.cross(between, z) @ cross / square * z_before
        foot = point + np.cross(between, z_before) @ cross / square * z
        x = cross / sine
        if (foot - foot_before) @ cross / sine < -_TOLERANCE:
            x = -x
        return _Normal(x=x, foot_before=foot_before, foot=foot)

    # One of the normals of parallel axes: the one at the origin of {j-1}. If that is so
    # far from the point that the small tilt between the axes would move the foot by
    # more than the tolerance, it is the one at the point.
    along = between @ z_before
    across = between - along * z_before
    distance = math.sqrt(across @ across)
    x = across / distance if distance > _TOLERANCE else previous[:3, 0]
    if sine * abs(along) > _TOLERANCE:
        return _Normal(x=x, foot_before=point - across, foot=point)
    return _Normal(x=x, foot_before=origin, foot=origin + across)


def _frame(origin: FloatArray, x: FloatArray, z: FloatArray) -> FloatArray:
    """A frame with this origin and z, and with x in the plane of x and z, (4, 4)."""
    x = x - (x @ z) * z
    x = x / math.sqrt(x @ x)
    return transform(np.column_stack([x, np.cross(z, x), z]), origin)


def axes_of_model(model: pin.Model, frame: str | None) -> dict[str, Any]:
    """The arguments of `DHChain.from_axes` for a pin.Model; see
    `DHChain.from_pinocchio`.
    """
    import pinocchio as pin

    instance("model", model, pin.Model)
    if frame is None:
        last = [f for f in model.frames if f.parentJoint == model.njoints - 1]
        frame = last[-1].name
    names = [f.name for f in model.frames]
    if not isinstance(frame, str) or frame not in names:
        raise UnknownNameError("frame", frame, names)
    tip = model.getFrameId(frame)
    path = [j for j in model.supports[model.frames[tip].parentJoint] if j != 0]
    if not path:
        raise InputError("frame", frame, "a frame that a joint moves")

    data = model.createData()
    # The linear part is the velocity of the body's point at the world's origin.
    jacobians = pin.computeJointJacobians(model, data, pin.neutral(model))
    jacobians = jacobians.reshape(6, -1)
    pin.updateFramePlacements(model, data)
    directions = []
    limits = []
    for j in path:
        joint = model.joints[j]
        linear, angular = jacobians[:, joint.idx_v].reshape(2, 3)
        helical = angular.any() and abs(linear @ angular) > _HELICAL
        if joint.nv != 1 or helical:
            expected = "a revolute or prismatic joint"
            raise InputError(model.names[j], joint.shortname(), expected)
        directions.append(angular if angular.any() else linear)

        lower = float(model.lowerPositionLimit[joint.idx_q])
        upper = float(model.upperPositionLimit[joint.idx_q])
        # A continuous joint has a cosine and a sine.
        limited = joint.nq == 1 and lower < upper
        limits.append((lower, upper) if limited else (-math.inf, math.inf))

    return {
        "points": [data.oMi[j].translation for j in path],
        "directions": directions,
        "sigma": [int(not jacobians[3:, model.joints[j].idx_v].any()) for j in path],
        "limits": limits,
        "end_effector": data.oMf[tip].homogeneous,
        "q": np.zeros(len(path)),
        "name": model.name,
        "joint_names": tuple(model.names[j] for j in path),
    }
