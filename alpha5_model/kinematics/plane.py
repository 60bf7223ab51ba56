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
from alpha5_model.errors import InputError
from alpha5_model.kinematics.arm_shape import ArmShape
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
            folded arm [m]; the folded one is beyond the published limits of theta_2.
        shape: What they were computed from.
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
    shape: ArmShape

    @classmethod
    def from_parameters(cls, parameters: Alpha5Parameters) -> ArmPlane:
        """The plane of the arm that a record describes.

        Raises:
            PublishedDataError: Table 1 is not of the shape that this closed form
                solves.
            InputError: A tool that is not on the wrist axis.
        """
        return cls.from_shape(ArmShape.from_parameters(parameters), "the plane")

    @classmethod
    def from_shape(cls, shape: ArmShape, needed_for: str) -> ArmPlane:
        """The plane of an arm.

        Args:
            shape: Lengths, zeros and limits.
            needed_for: What needs it, for the message.

        Raises:
            InputError: A tool that is not on the wrist axis.
        """
        check_tool_on_axis(shape, needed_for)
        l_1 = shape.a_1
        l_2 = math.hypot(shape.a_2, shape.z)
        return cls(
            a_0=shape.a_0,
            d_0=shape.d_0,
            l_1=l_1,
            l_2=l_2,
            azimuth_offset=shape.azimuth_offset,
            phi_offset=shape.phi_offset,
            gamma_offset=shape.gamma_offset(shape.a_2),
            lower=shape.lower,
            upper=shape.upper,
            middle=shape.middle,
            longest=l_1 + l_2,
            shortest=abs(l_1 - l_2),
            shape=shape,
        )


def check_tool_on_axis(shape: ArmShape, needed_for: str) -> None:
    """Check that the tool point of an arm is on the wrist axis.

    Raises:
        InputError: It is not.
    """
    if not shape.has_tool_on_axis:
        tool = f"x = {shape.x:g}, y = {shape.y:g}, z = {shape.z:g} m in link_4"
        expected = f"a tool point on the wrist axis, x = y = 0, for {needed_for}"
        raise InputError("tool", tool, expected)


def on_axis(position: FloatArray) -> BoolArray:
    """Which targets (..., 3) lie on the yaw axis, where theta_0 is free, (...)."""
    x = position[..., 0]
    y = position[..., 1]
    with np.errstate(over="ignore"):
        radius = np.sqrt(x * x + y * y)  # in the words of the generated formula
        return np.asarray(radius <= AXIS_TOLERANCE)
