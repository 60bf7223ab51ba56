"""How much rounding the inverse kinematics forgives."""

from __future__ import annotations

from typing import NamedTuple

#: A joint angle this far beyond its limit [rad] is on it, and is returned as the limit
#: itself.
LIMIT_TOLERANCE = 1e-12
#: A target this close to the yaw axis [m] is on it, everywhere in this package: theta_0
#: is free and the tcp is put on the axis itself.
AXIS_TOLERANCE = 1e-9


class Tolerances(NamedTuple):
    """What rounding is forgiven, for one scalar type.

    Attributes:
        edge: Beyond the edge of reach [m]: rounding must not lose a solution.
        limit: Beyond a joint limit, which is then returned itself [rad].
        singular: ``singular`` within this distance of the edge of reach [m].
        axis: On the yaw axis within this distance of it [m].
        azimuth: Of the azimuth at 1 m from the yaw axis [rad].
        elbow: Of the two angles of a nearly stretched arm [rad], over the sine of the
            elbow's angle.
        least_sine: Of that angle.
    """

    edge: float
    limit: float
    singular: float
    axis: float
    azimuth: float
    elbow: float
    least_sine: float


DOUBLE = Tolerances(
    edge=1e-10,
    limit=LIMIT_TOLERANCE,
    singular=1e-9,
    axis=AXIS_TOLERANCE,
    azimuth=1e-15,
    elbow=1e-14,
    least_sine=1e-7,
)
#: Joint angles of up to 6.2 rad are known to 5e-7 in single precision.
SINGLE = Tolerances(
    edge=2e-6,
    limit=2e-6,
    singular=1e-5,
    axis=1e-6,
    azimuth=5e-7,
    elbow=5e-6,
    least_sine=2e-3,
)
