"""Tolerances of the inverse kinematics for rounding errors."""

from __future__ import annotations

from typing import NamedTuple

#: A joint angle this far beyond its limit [rad] is on it, and is returned as the limit
#: itself.
LIMIT_TOLERANCE = 1e-12
#: A joint position that a user gives, this far beyond a limit [rad or m], is on it: it
#: may have been printed with six digits. The page has the same in ``kinematics.js``.
ON_LIMIT = 1e-6
#: A target this close to the yaw axis [m] is on it, everywhere in this package: theta_0
#: is free and the tcp is put on the axis itself.
AXIS_TOLERANCE = 1e-9


class Tolerances(NamedTuple):
    """The tolerances of one scalar type.

    Attributes:
        edge: A target this far beyond the edge of reach is on it [m]: rounding must
            not lose a solution.
        limit: An angle this far beyond a joint limit is that limit [rad].
        singular: A target this close to the edge of reach is ``singular`` [m].
        axis: A target this close to the yaw axis is on it [m].
        azimuth: Error of the azimuth at 1 m from the yaw axis [rad].
        elbow: Error of the two angles of a nearly stretched arm [rad], times the sine
            of the elbow's angle.
        least_sine: The sine is taken as at least this.
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
