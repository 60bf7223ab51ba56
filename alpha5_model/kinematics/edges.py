"""What counts as at an edge of the inverse kinematics: on the yaw axis, stretched, at a limit."""

from __future__ import annotations

import numpy as np

from alpha5_model.checks import BoolArray, FloatArray

#: A target this far beyond the edge of reach [m] is on it: rounding must not lose a solution.
EDGE_TOLERANCE = 1e-10
#: A joint angle this far beyond its limit [rad] is on it, and is returned as the limit itself.
LIMIT_TOLERANCE = 1e-12
#: ``singular`` within this distance of the stretched or the folded arm [m].
SINGULAR_TOLERANCE = 1e-9
#: A target this close to the yaw axis [m] is on it, everywhere in this package: theta_0 is free
#: and the tcp is put on the axis itself.
AXIS_TOLERANCE = 1e-9

#: Closer than this to the yaw axis [m], to the edge of reach [m^2, in rho^2] or to a joint limit
#: [rad], rounding matters and `alpha5_model.kinematics.ik.one.solve_one` takes over from the
#: kernel. Farther away, rounding moves an angle by less than NEAR_LIMIT.
NEAR_AXIS = 1e-8
NEAR_EDGE = 2e-9
NEAR_LIMIT = 1e-6


def on_axis(position: FloatArray) -> BoolArray:
    """Targets on the yaw axis, where theta_0 is free, (...)."""
    x, y = position[..., 0], position[..., 1]
    with np.errstate(over="ignore"):
        return np.asarray(np.sqrt(x * x + y * y) <= AXIS_TOLERANCE)  # as `solve_one` has it
