"""The arm as a vertical plane that turns, with two links in it, and where it is singular.

Joint 0 turns the plane about the base's z axis. In the plane, with r outwards and z up, the
shoulder is at ``(a_0, d_0)``, and

    tcp = shoulder + l_1 e(phi) + l_2 e(phi + pi - gamma),     e(x) = (cos x, sin x)

where ``l_1 = a_1`` and ``l_2 = sqrt(a_2^2 + d_3^2)`` are the sides l_1 and l_2 of the document's
triangle (Section 1.3), phi is the direction of the first link and gamma the angle of the triangle
at the elbow. Both are a joint angle plus a constant: ``phi = theta_1 + phi_offset``, ``gamma =
theta_2 + gamma_offset``. Joint 3 turns about an axis through the tcp and does not move it.

Joint 0 moves the tcp across the plane in proportion to its distance r from the yaw axis, joints 1
and 2 move it within the plane, in proportion to sin(gamma). The linear Jacobian of the three has
the determinant

    |det J_v| = |r| l_1 l_2 |sin gamma|                       [Siciliano2009, 3.3]

which is Yoshikawa's manipulability ``sqrt(det(J_v J_v^T))``. It vanishes where the arm is stretched
(gamma = pi), folded (gamma = 0, beyond the limits of theta_2), or the tcp is on the yaw axis
(r = 0).

References:
    [Yoshikawa1985] Manipulability of robotic mechanisms, Int. J. Robotics Research 4(2).
    [Siciliano2009] Siciliano, Sciavicco, Villani, Oriolo: Robotics, sections 3.3 and 3.9.
"""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import BoolArray, FloatArray, float_array, real
from alpha5_model.errors import PublishedDataError
from alpha5_model.parameters import parameters
from alpha5_model.spatial import wrap

#: A joint angle this far beyond its limit [rad] is on it, and is returned as the limit itself.
LIMIT_TOLERANCE = 1e-12
#: A target this close to the yaw axis [m] is on it, everywhere in this package: theta_0 is free
#: and the tcp is put on the axis itself.
AXIS_TOLERANCE = 1e-9


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
        limits: (lower, upper, middle) of each joint.
        longest, shortest: Distance from shoulder to tcp of the stretched and of the folded arm [m];
            the folded one is beyond the limits of theta_2.
        squares: Of the two [m^2].
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
    limits: tuple[tuple[float, float, float], ...]
    longest: float
    shortest: float
    squares: tuple[float, float]


@cache
def arm_plane() -> ArmPlane:
    """The Reach Alpha 5's plane.

    Raises:
        PublishedDataError: Table 1 is not of the shape that this closed form solves.
    """
    p = parameters()
    base, upper, fore, wrist = p.dh[:4]
    half_pi = math.pi / 2
    if (
        [row.alpha for row in p.dh[:3]] != [half_pi, math.pi, -half_pi]
        or any(x != 0.0 for x in (upper.d, fore.d, wrist.a, p.dh[4].d, p.dh[4].a))
        or wrist.d >= 0.0
    ):
        raise PublishedDataError("Table 1", "not a vertical plane with two links in it")
    l_1, l_2 = upper.a, math.hypot(fore.a, wrist.d)
    longest, shortest = l_1 + l_2, abs(l_1 - l_2)
    limits = tuple((j.lower, j.upper, (j.lower + j.upper) / 2) for j in p.joints[:4])
    low, high, middle = zip(*limits, strict=True)
    return ArmPlane(
        a_0=base.a,
        d_0=base.d,
        l_1=l_1,
        l_2=l_2,
        azimuth_offset=base.theta_offset,
        phi_offset=upper.theta_offset,
        gamma_offset=fore.theta_offset + math.pi - math.atan2(-wrist.d, fore.a),
        lower=low,
        upper=high,
        middle=middle,
        limits=limits,
        longest=longest,
        shortest=shortest,
        squares=(longest**2, shortest**2),
    )


class Singularities(NamedTuple):
    """Distance of joint positions from the singular sets.

    Attributes:
        stretched: theta_2 less the angle of the stretched arm, wrapped to [-pi, pi), (...) [rad].
        folded: theta_2 less the angle of the folded arm, wrapped to [-pi, pi), (...) [rad].
        yaw_axis: Distance of the tcp from the yaw axis in the plane of the arm, (...) [m]; positive
            in front of it.
    """

    stretched: FloatArray
    folded: FloatArray
    yaw_axis: FloatArray

    def near(self, angle: float = 1e-6, distance: float = 1e-6) -> BoolArray:
        """Closer than ``angle`` [rad] or ``distance`` [m] to any of the three sets, (...)."""
        angle, distance = real("angle", angle, 0.0), real("distance", distance, 0.0)
        elbow = np.minimum(np.abs(self.stretched), np.abs(self.folded))
        return np.asarray((elbow < angle) | (np.abs(self.yaw_axis) < distance))


def singularities(q: ArrayLike) -> Singularities:
    """How far joint positions are from the three singular sets.

    Args:
        q: (..., 4) [rad].
    """
    gamma, r = _plane_coordinates(q)
    return Singularities(wrap(gamma - math.pi), wrap(gamma), r)


def singular_elbow_angles() -> dict[str, float]:
    """theta_2 of the stretched and of the folded arm [rad]; the folded one is beyond its limits."""
    g = arm_plane()
    return {"stretched": math.pi - g.gamma_offset, "folded": -g.gamma_offset}


def manipulability(q: ArrayLike) -> FloatArray:
    """Yoshikawa's measure of the tcp's linear motion, ``sqrt(det(J_v J_v^T))`` [Yoshikawa1985].

    Args:
        q: (..., 4) [rad].

    Returns:
        (...) [m^3]: volume of the velocity parallelepiped for unit joint speeds.
    """
    g = arm_plane()
    gamma, r = _plane_coordinates(q)
    return np.asarray(np.abs(r * np.sin(gamma)) * (g.l_1 * g.l_2))


def _plane_coordinates(q: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """gamma [rad] and the tcp's signed distance from the yaw axis [m], each (...)."""
    g = arm_plane()
    position = float_array("q", q, (4,))
    phi, gamma = position[..., 1] + g.phi_offset, position[..., 2] + g.gamma_offset
    return gamma, g.a_0 + g.l_1 * np.cos(phi) + g.l_2 * np.cos(phi + math.pi - gamma)


def on_axis(position: FloatArray) -> BoolArray:
    """Targets on the yaw axis, where theta_0 is free, (...)."""
    x, y = position[..., 0], position[..., 1]
    with np.errstate(over="ignore"):
        return np.asarray(np.sqrt(x * x + y * y) <= AXIS_TOLERANCE)  # as the formula has it
