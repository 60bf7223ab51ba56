"""What counts as at an edge of the inverse kinematics: on the yaw axis, stretched, at a limit."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from alpha5_model.checks import BoolArray, FloatArray

#: A joint angle this far beyond its limit [rad] is on it, and is returned as the limit itself.
LIMIT_TOLERANCE = 1e-12
#: A target this close to the yaw axis [m] is on it, everywhere in this package: theta_0 is free
#: and the tcp is put on the axis itself.
AXIS_TOLERANCE = 1e-9

#: Closer than this to the yaw axis [m], to the edge of reach [m^2, in rho^2] or to a joint limit
#: [rad], rounding matters and `alpha5_model.kinematics.ik.one.solve_one` takes over from the
#: kernel. Farther away, rounding moves an angle by less than NEAR_LIMIT.
NEAR_AXIS = 1e-8
NEAR_EDGE = 2e-9
NEAR_LIMIT = 1e-6


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


def on_axis(position: FloatArray) -> BoolArray:
    """Targets on the yaw axis, where theta_0 is free, (...)."""
    x, y = position[..., 0], position[..., 1]
    with np.errstate(over="ignore"):
        return np.asarray(np.sqrt(x * x + y * y) <= AXIS_TOLERANCE)  # as `solve_one` has it
