"""The arm as a vertical plane that turns, with two links in it.

Joint 0 turns the plane about the base's z axis. In the plane, with r outwards and z up,
the shoulder is at ``(a_0, d_0)``, and

    tcp = shoulder + l_1 e(phi) + l_2 e(phi + pi - gamma),     e(x) = (cos x, sin x)

Here ``l_1 = a_1`` and ``l_2 = sqrt(a_2^2 + d_3^2)`` are the sides l_1 and l_2 of the
document's triangle (Section 1.3), phi is the direction of the first link and gamma the
angle of the triangle at the elbow. Both are a joint angle plus a constant:
``phi = theta_1 + phi_offset``, ``gamma = theta_2 + gamma_offset``. Joint 3 turns about
an axis through the tcp and does not move it.

References:
    [Siciliano2009] Siciliano, Sciavicco, Villani, Oriolo: Robotics, section 2.12.2.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model.errors import InputError, PublishedDataError
from alpha5_model.kinematics.tolerances import AXIS_TOLERANCE
from alpha5_model.numbers.parameters import Alpha5Parameters


class ArmPlane(NamedTuple):
    """Lengths, offsets and ranges, from Table 1 and the joint limits.

    Attributes:
        a_0, d_0: Shoulder in the plane [m].
        l_1, l_2: The two links [m].
        azimuth_offset: Azimuth of the plane's r axis minus theta_0 [rad].
        phi_offset, gamma_offset: phi minus theta_1, gamma minus theta_2 [rad].
        lower, upper: Limits of theta_0 ... theta_3, (4,) [rad].
        middle: Middle of each range, (4,) [rad].
        longest, shortest: Distance from shoulder to tcp of the stretched and of the
            folded arm [m]; the folded one is beyond the limits of theta_2.
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
            PublishedDataError: Table 1 is not of the shape that this closed form
                solves.
            InputError: A tool that is not on the wrist axis.
        """
        row_0, row_1, row_2, row_3, row_4 = parameters.dh[:5]
        twists = [row_0.alpha, row_1.alpha, row_2.alpha]
        must_be_zero = [row_1.d, row_2.d, row_3.a, row_4.d, row_4.a]
        twists_fit = twists == [math.pi / 2, math.pi, -math.pi / 2]
        if not twists_fit or any(must_be_zero) or row_3.d >= 0.0:
            raise PublishedDataError(
                "Table 1", "not a vertical plane with two links in it"
            )

        along_wrist = row_3.d
        if parameters.tool is not None:
            x, y, along_wrist = parameters.tool.position.tolist()
            if x or y:
                expected = "a tool point on the wrist axis, (0, 0, z)"
                raise InputError("tool", parameters.tool.position, expected)

        # The forearm goes a_2 along x_2 and the tool point's -z across it: l_2 is
        # turned from x_2.
        l_1 = row_1.a
        l_2 = math.hypot(row_2.a, along_wrist)
        forearm_angle = math.atan2(-along_wrist, row_2.a)

        joints = parameters.joints[:4]
        return cls(
            a_0=row_0.a,
            d_0=row_0.d,
            l_1=l_1,
            l_2=l_2,
            azimuth_offset=row_0.theta_offset,
            phi_offset=row_1.theta_offset,
            gamma_offset=row_2.theta_offset + math.pi - forearm_angle,
            lower=tuple(joint.lower for joint in joints),
            upper=tuple(joint.upper for joint in joints),
            middle=tuple((joint.lower + joint.upper) / 2 for joint in joints),
            longest=l_1 + l_2,
            shortest=abs(l_1 - l_2),
        )


def on_axis(position: FloatArray) -> BoolArray:
    """Which targets (..., 3) lie on the yaw axis, where theta_0 is free, (...)."""
    x = position[..., 0]
    y = position[..., 1]
    with np.errstate(over="ignore"):
        radius = np.sqrt(x * x + y * y)  # in the words of the generated formula
        return np.asarray(radius <= AXIS_TOLERANCE)
