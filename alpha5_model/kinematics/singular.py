"""Singular joint positions, and how far from them others are.

Joint 0 moves the tcp across the plane in proportion to its distance r from the yaw
axis. Joints 1 and 2 move it within the plane, in proportion to sin(gamma). The linear
Jacobian of the three has the determinant

    |det J_v| = |r| l_1 l_2 |sin gamma|                       [Siciliano2009, 3.3]

which is Yoshikawa's manipulability ``sqrt(det(J_v J_v^T))``. It vanishes if the arm is
stretched (gamma = pi) or folded (gamma = 0, beyond the limits of theta_2), or the tcp
is on the yaw axis (r = 0).

References:
    [Yoshikawa1985] Manipulability of robotic mechanisms, Int. J. Robotics Research
        4(2).
    [Siciliano2009] Siciliano, Sciavicco, Villani, Oriolo: Robotics, sections 3.3 and
        3.9.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support import checks
from alpha5_model._support.checks import BoolArray, FloatArray, float_array
from alpha5_model._support.spatial import wrap
from alpha5_model.kinematics.plane import ArmPlane


class Singularities(NamedTuple):
    """Distance of joint positions from the singular sets.

    Attributes:
        stretched: theta_2 less the angle of the stretched arm, wrapped to [-pi, pi),
            (...) [rad].
        folded: theta_2 less the angle of the folded arm, wrapped to [-pi, pi),
            (...) [rad].
        yaw_axis: Distance of the tcp from the yaw axis in the plane of the arm,
            (...) [m]; positive in front of it.
    """

    stretched: FloatArray
    folded: FloatArray
    yaw_axis: FloatArray

    def near(self, angle: float = 1e-6, distance: float = 1e-6) -> BoolArray:
        """Closer than ``angle`` [rad] or ``distance`` [m] to any of the sets, (...)."""
        angle = checks.real("angle", angle, 0.0)
        distance = checks.real("distance", distance, 0.0)
        elbow = np.minimum(np.abs(self.stretched), np.abs(self.folded))
        return np.asarray((elbow < angle) | (np.abs(self.yaw_axis) < distance))


def singularities(plane: ArmPlane, q: ArrayLike) -> Singularities:
    """How far joint positions (..., 4) are from the three singular sets."""
    gamma, r = _plane_coordinates(plane, q)
    return Singularities(
        stretched=wrap(gamma - math.pi), folded=wrap(gamma), yaw_axis=r
    )


def singular_elbow_angles(plane: ArmPlane) -> dict[str, float]:
    """theta_2 of the stretched and of the folded arm [rad]."""
    return {
        "stretched": math.pi - plane.gamma_offset,
        "folded": -plane.gamma_offset,
    }


def manipulability(plane: ArmPlane, q: ArrayLike) -> FloatArray:
    """Yoshikawa's measure of the tcp's linear motion at joint positions (..., 4)."""
    gamma, r = _plane_coordinates(plane, q)
    return np.asarray(np.abs(r * np.sin(gamma)) * (plane.l_1 * plane.l_2))


def _plane_coordinates(plane: ArmPlane, q: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """gamma [rad] and the tcp's signed distance from the yaw axis [m], (...) each."""
    position = float_array("q", q, (4,))
    phi = position[..., 1] + plane.phi_offset
    gamma = position[..., 2] + plane.gamma_offset
    forearm = phi + math.pi - gamma
    r = plane.a_0 + plane.l_1 * np.cos(phi) + plane.l_2 * np.cos(forearm)
    return gamma, r
