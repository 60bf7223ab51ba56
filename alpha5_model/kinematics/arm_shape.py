"""Lengths, zeros and limits of any arm, and any tool point: what its kinematics need.

Joint 3 turns the tool point about the wrist axis. With psi = theta_3 + wrist_offset,
a tool point (x, y, z) in link_4 is

    c = a_2 + x cos(psi) - y sin(psi)      along x_2 from the elbow,
    z                                      along the wrist axis,
    w = -(x sin(psi) + y cos(psi))         beside the plane of the arm.

So at a given theta_3 the arm is a plane with two links
(`alpha5_model.kinematics.plane`) that passes the yaw axis at the distance w. Its second
link has the length ``hypot(c, z)``. For a tool on the wrist axis w is 0 and c is a_2,
whatever theta_3.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.errors import PublishedDataError
from alpha5_model.kinematics.tolerances import AXIS_TOLERANCE
from alpha5_model.numbers.parameters import Alpha5Parameters

_TWISTS = [math.pi / 2, math.pi, -math.pi / 2]


class ArmShape(NamedTuple):
    """Lengths, zeros and limits of an arm.

    Attributes:
        a_0, d_0: Shoulder in the plane of the arm [m].
        a_1: The first link [m].
        a_2: From the elbow axis to the wrist axis [m].
        x, y, z: Tool point in link_4, whose z axis is the wrist axis [m].
        azimuth_offset: Azimuth of the plane's r axis minus theta_0 [rad].
        phi_offset: Direction of the first link minus theta_1 [rad].
        elbow_offset, wrist_offset: Constant parts of DH angles 2 and 3 [rad].
        lower, upper: Limits of theta_0 ... theta_3, (4,) [rad].
    """

    a_0: float
    d_0: float
    a_1: float
    a_2: float
    x: float
    y: float
    z: float
    azimuth_offset: float
    phi_offset: float
    elbow_offset: float
    wrist_offset: float
    lower: tuple[float, ...]
    upper: tuple[float, ...]

    @classmethod
    def from_parameters(cls, parameters: Alpha5Parameters) -> ArmShape:
        """The shape of the arm that a record describes.

        Raises:
            PublishedDataError: Table 1 is not of the shape that the closed form solves.
        """
        row_0, row_1, row_2, row_3, row_4 = parameters.dh
        twists = [row_0.alpha, row_1.alpha, row_2.alpha]
        must_be_zero = [row_1.d, row_2.d, row_3.a, row_4.d, row_4.a]
        tool = parameters.tool
        if twists != _TWISTS or any(must_be_zero):
            raise PublishedDataError(
                "Table 1", "not a vertical plane with two links in it"
            )

        x, y, z = (0.0, 0.0, row_3.d) if tool is None else tool.position.tolist()
        joints = parameters.joints[:4]
        return cls(
            a_0=row_0.a,
            d_0=row_0.d,
            a_1=row_1.a,
            a_2=row_2.a,
            x=x,
            y=y,
            z=z,
            azimuth_offset=row_0.theta_offset,
            phi_offset=row_1.theta_offset,
            elbow_offset=row_2.theta_offset,
            wrist_offset=row_3.theta_offset,
            lower=tuple(joint.lower for joint in joints),
            upper=tuple(joint.upper for joint in joints),
        )

    @classmethod
    def from_numbers(cls, numbers: Any) -> ArmShape:
        """The shape of its `numbers`, or of symbols in their place."""
        scalars = list(numbers[:-8])
        lower = tuple(numbers[-8:-4])
        upper = tuple(numbers[-4:])
        fields = (*scalars, lower, upper)
        return cls(**dict(zip(cls._fields, fields, strict=True)))

    @property
    def numbers(self) -> FloatArray:
        """All of them in the order of the fields, (19,)."""
        return np.array([*self[:-2], *self.lower, *self.upper])

    @property
    def middle(self) -> tuple[float, ...]:
        """Middle of each range, (4,) [rad]."""
        return tuple((a + b) / 2 for a, b in zip(self.lower, self.upper, strict=True))

    @property
    def has_tool_on_axis(self) -> bool:
        """Whether the tool point is on the wrist axis, but not on the elbow's."""
        length = math.hypot(self.a_2, self.z)
        return self.x == 0.0 and self.y == 0.0 and length > AXIS_TOLERANCE

    def tool_in_forearm(self, theta_3: FloatArray) -> tuple[FloatArray, FloatArray]:
        """c and w [m], see the module's text, at wrist angles (...) [rad]."""
        psi = theta_3 + self.wrist_offset
        c = self.a_2 + self.x * np.cos(psi) - self.y * np.sin(psi)
        w = -(self.x * np.sin(psi) + self.y * np.cos(psi))
        return c, w

    def gamma_offset(self, c: float) -> float:
        """gamma minus theta_2 for one c [rad].

        The forearm goes c along x_2 and the tool point's -z across it, so that the
        second link is turned from x_2.
        """
        return self.elbow_offset + math.pi - math.atan2(-self.z, c)


#: How many numbers describe a shape.
SHAPE_NUMBERS = len(ArmShape._fields) - 2 + 8
