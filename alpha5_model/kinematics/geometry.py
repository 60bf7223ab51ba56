"""Where the joints and the tool of an arm are, and how far its joints turn.

Joint 0 turns a vertical plane about the base's z axis. In the plane, with r outwards
and z up, the shoulder is at ``(a_0, d_0)``. Joints 1 and 2 turn two links in it:

    tool point = shoulder + l_1 e(phi) + l_2 e(phi + pi - gamma),  e(x) = (cos x, sin x)

phi is the direction of the first link and gamma the angle between the links:
``phi = theta_1 + phi_offset``, ``gamma = theta_2 + gamma_offset``.

Joint 3 turns the tool point (x, y, z) of link_4 about the wrist axis. With
psi = theta_3 + wrist_offset it is, from the elbow,

    c = a_2 + x cos(psi) - y sin(psi)      along x_2,
    -z                                     across it in the plane,
    w = -(x sin(psi) + y cos(psi))         beside the plane.

So the second link is ``hypot(c, z)`` long, and the plane passes the yaw axis at the
distance w. For a tool on the wrist axis c is a_2 and w is 0, whatever theta_3.

References:
    [Siciliano2009] Siciliano, Sciavicco, Villani, Oriolo: Robotics, section 2.12.2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from alpha5_model._support.checks import BoolArray, FloatArray, frozen
from alpha5_model.errors import InputError
from alpha5_model.kinematics.tolerances import AXIS_TOLERANCE, DOUBLE, Tolerances
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.pose import tool_of

_TWISTS = [math.pi / 2, math.pi, -math.pi / 2]


@dataclass(frozen=True)
class Geometry:
    """Lengths, zeros, limits and tool of an arm.

    Attributes:
        a_0, d_0: Shoulder in the plane of the arm [m].
        a_1: The first link [m].
        a_2: From the elbow axis to the wrist axis [m].
        zeros: Constant parts of DH angles 0 to 3, (4,) [rad].
        tool: Upper three rows of the tcp's pose in link_4, (3, 4) [1 and m].
        lower, upper: Limits of theta_0 to theta_3, (4,) [rad].
    """

    a_0: float
    d_0: float
    a_1: float
    a_2: float
    zeros: tuple[float, ...]
    tool: tuple[tuple[float, ...], ...]
    lower: tuple[float, ...]
    upper: tuple[float, ...]

    @classmethod
    def of(cls, record: Alpha5Parameters) -> Geometry:
        """The geometry of the arm that a record describes, made once.

        Raises:
            InputError: Not a vertical plane with two links in it.
        """
        return _geometry(record)

    # What the plane's formulas call them.

    @cached_property
    def l_1(self) -> float:
        """The first link [m]."""
        return self.a_1

    @cached_property
    def l_2(self) -> float:
        """The second link of an arm whose tool is on the wrist axis [m]."""
        return math.hypot(self.a_2, self.z)

    @cached_property
    def longest(self) -> float:
        """From the shoulder to the tcp of the stretched arm [m]."""
        return self.l_1 + self.l_2

    @cached_property
    def shortest(self) -> float:
        """From the shoulder to the tcp of the folded arm [m]."""
        return abs(self.l_1 - self.l_2)

    @property
    def x(self) -> float:
        """Tool point in link_4, whose z axis is the wrist axis [m]."""
        return self.tool[0][3]

    @property
    def y(self) -> float:
        """Tool point in link_4 [m]."""
        return self.tool[1][3]

    @property
    def z(self) -> float:
        """Tool point in link_4 [m]."""
        return self.tool[2][3]

    @property
    def azimuth_offset(self) -> float:
        """Azimuth of the plane's r axis minus theta_0 [rad]."""
        return self.zeros[0]

    @property
    def phi_offset(self) -> float:
        """Direction of the first link minus theta_1 [rad]."""
        return self.zeros[1]

    @property
    def gamma_offset(self) -> float:
        """gamma minus theta_2 of an arm whose tool is on the wrist axis [rad]."""
        return self.gamma_offset_at(self.a_2)

    @property
    def wrist_offset(self) -> float:
        """psi minus theta_3 [rad]."""
        return self.zeros[3]

    @cached_property
    def middle(self) -> tuple[float, ...]:
        """Middle of each joint's range, (4,) [rad]."""
        return tuple((a + b) / 2 for a, b in zip(self.lower, self.upper, strict=True))

    @cached_property
    def tool_on_axis(self) -> bool:
        """Whether the tool point is on the wrist axis, but not on the elbow's."""
        return self.x == 0.0 and self.y == 0.0 and self.l_2 > AXIS_TOLERANCE

    def require_tool_on_axis(self, needed_for: str) -> None:
        """Refuse a tool beside the wrist axis.

        Args:
            needed_for: What needs the tool point on the axis, for the message.

        Raises:
            InputError: It is beside the axis.
        """
        if not self.tool_on_axis:
            tool = f"x = {self.x:g}, y = {self.y:g}, z = {self.z:g} m in link_4"
            expected = f"a tool point on the wrist axis, x = y = 0, for {needed_for}"
            raise InputError("tool", tool, expected)

    def tool_in_forearm(self, theta_3: FloatArray) -> tuple[FloatArray, FloatArray]:
        """c and w of the module's text at wrist angles (...) [rad], (...) each [m]."""
        psi = theta_3 + self.wrist_offset
        c = self.a_2 + self.x * np.cos(psi) - self.y * np.sin(psi)
        w = -(self.x * np.sin(psi) + self.y * np.cos(psi))
        return c, w

    def gamma_offset_at(self, c: float) -> float:
        """gamma minus theta_2 at a c [m] of the module's text [rad]."""
        return self.zeros[2] + math.pi - math.atan2(-self.z, c)

    # What the generated kernels receive.

    @cached_property
    def dimensions(self) -> FloatArray:
        """The dimensions of the dynamics' kernels, (24,), read-only.

        They are a_0, d_0, a_1 and a_2 [m], the cosines and then the sines of the zeros,
        and the tool row by row [1 and m].
        """
        return frozen(
            [
                *(self.a_0, self.d_0, self.a_1, self.a_2),
                *(_exact(math.cos(zero)) for zero in self.zeros),
                *(_exact(math.sin(zero)) for zero in self.zeros),
                *np.ravel(self.tool),
            ]
        )

    @cached_property
    def ik_parameters(self) -> FloatArray:
        """The parameters of the inverse kinematics' kernel, (26,), read-only."""
        return frozen(self.ik_parameters_with(DOUBLE))

    def ik_parameters_with(self, tolerances: Tolerances) -> FloatArray:
        """The parameters of the inverse kinematics with some tolerances, (26,).

        They are a_0, d_0, a_1, a_2, x, y and z [m], the zeros and limits [rad], and the
        tolerances.
        """
        lengths = (self.a_0, self.d_0, self.a_1, self.a_2, self.x, self.y, self.z)
        angles = (*self.zeros, *self.lower, *self.upper)
        return np.array([*lengths, *angles, *tolerances])


@lru_cache(maxsize=64)
def _geometry(record: Alpha5Parameters) -> Geometry:
    row_0, row_1, row_2, row_3, row_4 = record.dh
    twists = [row_0.alpha, row_1.alpha, row_2.alpha]
    must_be_zero = [row_1.d, row_2.d, row_3.a, row_4.d, row_4.a]
    if twists != _TWISTS or any(must_be_zero):
        expected = "a vertical plane with two links in it, as Table 1's"
        raise InputError("dh", record.dh, expected)

    tool = tool_of(record)
    pose = np.column_stack([tool.rotation, tool.position])
    joints = record.joints[:4]
    return Geometry(
        a_0=row_0.a,
        d_0=row_0.d,
        a_1=row_1.a,
        a_2=row_2.a,
        zeros=tuple(row.theta_offset for row in record.dh[:4]),
        tool=tuple(tuple(row) for row in pose.tolist()),
        lower=tuple(joint.lower for joint in joints),
        upper=tuple(joint.upper for joint in joints),
    )


def on_axis(position: FloatArray) -> BoolArray:
    """Which targets (..., 3) lie on the yaw axis, where theta_0 is free, (...)."""
    x = position[..., 0]
    y = position[..., 1]
    with np.errstate(over="ignore"):
        radius = np.sqrt(x * x + y * y)  # in the words of the generated formula
        return np.asarray(radius <= AXIS_TOLERANCE)


def _exact(value: float) -> float:
    """A sine or cosine, exact for multiples of pi/2."""
    nearest = float(round(value))
    return nearest if abs(value - nearest) < 1e-15 else value
