"""Where the tcp loses a direction of motion: manipulability and the three singular sets.

Seen in the plane of the arm, joint 0 moves the tcp across the plane in proportion to its distance r from
the yaw axis, and joints 1 and 2 move it within the plane, in proportion to sin(gamma). The linear
Jacobian of the first three joints has the determinant

    |det J_v| = |r| l_1 l_2 |sin gamma|                       [Siciliano2009, 3.3]

which is Yoshikawa's manipulability ``sqrt(det(J_v J_v^T))``; joint 3 moves no point. It vanishes where
the arm is stretched (gamma = pi), folded (gamma = 0, beyond the limits of theta_2), or the tcp is on
the yaw axis (r = 0).

References:
    [Yoshikawa1985] Manipulability of robotic mechanisms, Int. J. Robotics Research 4(2).
    [Siciliano2009] Siciliano, Sciavicco, Villani, Oriolo: Robotics, sections 3.3 and 3.9.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import BoolArray, FloatArray, float_array, real
from alpha5_model.kinematics.plane import arm_plane
from alpha5_model.spatial import wrap


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
        return np.asarray(
            (np.abs(self.stretched) < angle)
            | (np.abs(self.folded) < angle)
            | (np.abs(self.yaw_axis) < distance)
        )


def singularities(q: ArrayLike) -> Singularities:
    """How far joint positions are from the three singular sets.

    Args:
        q: (..., 4) [rad].
    """
    _, gamma, r = _plane_coordinates(q)
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
    _, gamma, r = _plane_coordinates(q)
    return np.asarray(np.abs(r * np.sin(gamma)) * (g.l_1 * g.l_2))


def _plane_coordinates(q: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
    """phi, gamma [rad] and the tcp's signed distance from the yaw axis [m], each (...)."""
    g = arm_plane()
    position = float_array("q", q, (4,))
    phi, gamma = position[..., 1] + g.phi_offset, position[..., 2] + g.gamma_offset
    return phi, gamma, g.a_0 + g.l_1 * np.cos(phi) + g.l_2 * np.cos(phi + math.pi - gamma)
