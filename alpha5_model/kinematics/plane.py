"""The arm as a vertical plane that turns, with two links in it, and its kernel for many targets.

Joint 0 turns the plane about the base's z axis. In the plane, with r outwards and z up, the
shoulder is at ``(a_0, d_0)``, and

    tcp = shoulder + l_1 e(phi) + l_2 e(phi + pi - gamma),     e(x) = (cos x, sin x)

where ``l_1 = a_1`` and ``l_2 = sqrt(a_2^2 + d_3^2)`` are the sides l_1 and l_2 of the document's
triangle (Section 1.3), phi is the direction of the first link and gamma the angle of the triangle
at the elbow. Both are a joint angle plus a constant: ``phi = theta_1 + phi_offset``, ``gamma =
theta_2 + gamma_offset``. Joint 3 turns about an axis through the tcp and does not move it.

The inverse kinematics of it are a kernel, which `solve_batch` runs for many targets.

References:
    [Siciliano2009] Siciliano, Sciavicco, Villani, Oriolo: Robotics, section 2.12.2.
"""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import LARGEST, BoolArray, FloatArray
from alpha5_model.codegen.kernels.choice import compute
from alpha5_model.errors import KernelError, PublishedDataError
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters

#: A joint angle this far beyond its limit [rad] is on it, and is returned as the limit itself.
LIMIT_TOLERANCE = 1e-12
#: A target this close to the yaw axis [m] is on it, everywhere in this package: theta_0 is free
#: and the tcp is put on the axis itself.
AXIS_TOLERANCE = 1e-9
#: Targets in a block: what the kernel writes of them stays in the cache.
BLOCK = 8192


class Tolerances(NamedTuple):
    """What rounding is forgiven, for one scalar type.

    Attributes:
        edge: Beyond the edge of reach [m]: rounding must not lose a solution.
        limit: Beyond a joint limit, which is then returned itself [rad].
        singular: ``singular`` within this distance of the edge of reach [m].
        axis: On the yaw axis within this distance of it [m].
        azimuth: Of the azimuth at 1 m from the yaw axis [rad].
        elbow: Of the two angles of a nearly stretched arm [rad], over the sine of the elbow's angle.
        least_sine: Of that angle.
    """

    edge: float
    limit: float
    singular: float
    axis: float
    azimuth: float
    elbow: float
    least_sine: float


DOUBLE = Tolerances(1e-10, LIMIT_TOLERANCE, 1e-9, AXIS_TOLERANCE, 1e-15, 1e-14, 1e-7)
#: Joint angles of up to 6.2 rad are known to 5e-7 in single precision.
SINGLE = Tolerances(2e-6, 2e-6, 1e-5, 1e-6, 5e-7, 5e-6, 2e-3)


class ArmPlane(NamedTuple):
    """Lengths, offsets and ranges, from Table 1 and the joint limits.

    Attributes:
        a_0, d_0: Shoulder in the plane [m].
        l_1, l_2: The two links [m].
        azimuth_offset: Azimuth of the plane's r axis less theta_0 [rad].
        phi_offset, gamma_offset: phi less theta_1, gamma less theta_2 [rad].
        lower, upper: Limits of theta_0 ... theta_3, (4,) [rad].
        middle: Middle of each range, (4,) [rad].
        longest, shortest: Distance from shoulder to tcp of the stretched and of the folded arm [m];
            the folded one is beyond the limits of theta_2.
    """

    a_0: float
    d_0: float
    l_1: float
    l_2: float
    azimuth_offset: float
    phi_offset: float
    gamma_offset: float
    lower: tuple[float, ...]
    upper: tuple[float, ...]
    middle: tuple[float, ...]
    longest: float
    shortest: float

    @classmethod
    def from_parameters(cls, parameters: Alpha5Parameters) -> ArmPlane:
        """The plane of the arm that a record describes.

        Raises:
            PublishedDataError: Table 1 is not of the shape that this closed form solves.
        """
        base, upper, fore, wrist, tip = parameters.dh[:5]
        alphas = [base.alpha, upper.alpha, fore.alpha]
        zeros = [upper.d, fore.d, wrist.a, tip.d, tip.a]
        upright = alphas == [math.pi / 2, math.pi, -math.pi / 2]
        if not upright or any(zeros) or wrist.d >= 0.0:
            raise PublishedDataError(
                "Table 1", "not a vertical plane with two links in it"
            )

        l_1 = upper.a
        l_2 = math.hypot(fore.a, wrist.d)
        wrist_angle = math.atan2(-wrist.d, fore.a)

        joints = parameters.joints[:4]
        return cls(
            a_0=base.a,
            d_0=base.d,
            l_1=l_1,
            l_2=l_2,
            azimuth_offset=base.theta_offset,
            phi_offset=upper.theta_offset,
            gamma_offset=fore.theta_offset + math.pi - wrist_angle,
            lower=tuple(joint.lower for joint in joints),
            upper=tuple(joint.upper for joint in joints),
            middle=tuple((joint.lower + joint.upper) / 2 for joint in joints),
            longest=l_1 + l_2,
            shortest=abs(l_1 - l_2),
        )


@cache
def arm_plane() -> ArmPlane:
    """The plane of the Reach Alpha 5."""
    return ArmPlane.from_parameters(parameters())


def on_axis(position: FloatArray) -> BoolArray:
    """Targets on the yaw axis, where theta_0 is free, (...)."""
    x, y = position[..., 0], position[..., 1]
    with np.errstate(over="ignore"):
        return np.asarray(
            np.sqrt(x * x + y * y) <= AXIS_TOLERANCE
        )  # as the formula has it


def solve_batch(
    position: FloatArray, wrist: FloatArray, angles: bool = True
) -> tuple[FloatArray, BoolArray, BoolArray, BoolArray]:
    """Solve finite targets of any shape.

    Args:
        position: (..., 3) [m].
        wrist: Broadcasts to (...) [rad].
        angles: False leaves q to scratch, not to be relied on.

    Returns:
        q (..., 4, 4), exists (..., 4), within limits (..., 4) and singular (...), as in
        `alpha5_model.kinematics.ik.Solutions`.
    """
    lead, none = position.shape[:-1], np.empty(0)
    target = np.ascontiguousarray(position.reshape(-1, 3))
    theta_3 = np.broadcast_to(wrist, lead if wrist.ndim else len(target))
    if wrist.ndim:
        theta_3 = np.ascontiguousarray(theta_3).reshape(-1)
    n, block = len(target), min(len(target), BLOCK) or 1
    q = np.empty((n if angles else block, 4, 4))
    flags = [np.empty((n, size), np.bool_) for size in (4, 4, 1)]
    for start in range(0, n, block):
        rows = target[start : start + block]
        given = rows, np.ascontiguousarray(theta_3[start : start + block])
        numbers = [np.empty((len(rows), flag.shape[1])) for flag in flags]
        out = q[start : start + block] if angles else q[: len(rows)], *numbers
        try:
            compute("inverse_kinematics", none, *given, *out)
        except KernelError:  # too large: what is clipped is as far out of reach
            near = (x.clip(-LARGEST, LARGEST) for x in given)
            compute("inverse_kinematics", none, *near, *out)
        for flag, number in zip(flags, numbers, strict=True):
            np.not_equal(number, 0.0, out=flag[start : start + block])
    exists, within, singular = flags
    q = q.reshape(*lead, 4, 4) if angles else q
    return q, exists.reshape(*lead, 4), within.reshape(*lead, 4), singular.reshape(lead)
