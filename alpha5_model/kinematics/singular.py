"""Singular joint positions, and how far from them others are.

`alpha5_model.kinematics.workspace` has the determinant of the tcp's Jacobian, which
vanishes at them.
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
        stretched: theta_2 minus the angle of the stretched arm, wrapped to [-pi, pi),
            (...) [rad].
        folded: theta_2 minus the angle of the folded arm, wrapped to [-pi, pi),
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
