"""The arm as its inverse kinematics sees it: a vertical plane that turns, and two links in it.

Joint 0 turns the plane about the base's z axis. In the plane, with r outwards and z up, the shoulder is
at ``(a_0, d_0)``, and

    tcp = shoulder + l_1 e(phi) + l_2 e(phi + pi - gamma),     e(x) = (cos x, sin x)

where ``l_1 = a_1`` and ``l_2 = sqrt(a_2^2 + d_3^2)`` are the sides l_1 and l_2 of the document's
triangle (Section 1.3), phi is the direction of the first link and gamma the angle of the triangle at
the elbow. Both are a joint angle plus a constant: ``phi = theta_1 + phi_offset``,
``gamma = theta_2 + gamma_offset``. Joint 3 turns the tcp about an axis through it and moves no point.
"""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

from alpha5_model.errors import PublishedDataError
from alpha5_model.parameters import parameters


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
        longest, shortest: Distance from shoulder to tcp of the stretched and of the folded arm [m]; the
            folded one is beyond the limits of theta_2.
        squares: Of the two [m^2].
        k: ``(l_2 - l_1) / (l_2 + l_1)``, of the law of tangents.
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
    k: float

    @property
    def phi_range(self) -> tuple[float, float]:
        """Directions of the first link within the limits of theta_1 [rad]."""
        return self.lower[1] + self.phi_offset, self.upper[1] + self.phi_offset

    @property
    def gamma_range(self) -> tuple[float, float]:
        """Angles at the elbow within the limits of theta_2 [rad]."""
        return self.lower[2] + self.gamma_offset, self.upper[2] + self.gamma_offset


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
        k=(l_2 - l_1) / longest,
    )
