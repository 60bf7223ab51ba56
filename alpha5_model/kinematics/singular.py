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
from alpha5_model.kinematics.arm_shape import ArmShape
from alpha5_model.kinematics.hand import Hand
from alpha5_model.kinematics.plane import ArmPlane


class Singularities(NamedTuple):
    """Distance of joint positions from the singular sets.

    Attributes:
        stretched: theta_2 minus the angle of the stretched arm, wrapped to [-pi, pi),
            (...) [rad].
        folded: theta_2 minus the angle of the folded arm, wrapped to [-pi, pi),
            (...) [rad].
        yaw_axis: Distance of the tcp from the yaw axis in the plane of the arm,
            (...) [m]; positive in front of it. For a tool beside the wrist axis, 0 is
            the cylinder on which underarm and overarm coincide.
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


class _InPlane(NamedTuple):
    """Joint positions in the plane of the arm, (...) each.

    Attributes:
        gamma: Angle between the links [rad].
        r: The tcp's distance from the yaw axis, positive in front of it [m].
        l_2: Length of the second link [m].
    """

    gamma: FloatArray
    r: FloatArray
    l_2: FloatArray | float


def singularities(shape: ArmShape, q: ArrayLike) -> Singularities:
    """How far joint positions (..., 4) are from the three singular sets."""
    at = _in_plane(shape, float_array("q", q, (4,)))
    return Singularities(
        stretched=wrap(at.gamma - math.pi), folded=wrap(at.gamma), yaw_axis=at.r
    )


def singular_elbow_angles(plane: ArmPlane) -> dict[str, float]:
    """theta_2 of the stretched and of the folded arm [rad]."""
    return {
        "stretched": math.pi - plane.gamma_offset,
        "folded": -plane.gamma_offset,
    }


def manipulability(hand: Hand, q: ArrayLike) -> FloatArray:
    """Yoshikawa's measure of the tcp's linear motion at joint positions (..., 4)."""
    shape = hand.shape
    position = float_array("q", q, (4,))
    if shape.has_tool_on_axis:
        at = _in_plane(shape, position)
        return np.asarray(np.abs(at.r * np.sin(at.gamma)) * (shape.a_1 * at.l_2))

    # theta_3 moves the tcp, too: there is no closed form.
    jacobian = hand.chain.jacobian(position)[..., :3, :]
    square = np.linalg.det(jacobian @ np.swapaxes(jacobian, -1, -2))
    return np.asarray(np.sqrt(np.maximum(square, 0.0)))


def _in_plane(shape: ArmShape, q: FloatArray) -> _InPlane:
    """Joint positions (..., 4) in the plane of the arm at their theta_3."""
    l_2: FloatArray | float
    gamma_offset: FloatArray | float
    if shape.has_tool_on_axis:
        l_2 = math.hypot(shape.a_2, shape.z)
        gamma_offset = shape.gamma_offset(shape.a_2)
    else:
        c, _ = shape.tool_in_forearm(q[..., 3])
        l_2 = np.hypot(c, shape.z)
        gamma_offset = shape.elbow_offset + math.pi - np.arctan2(-shape.z, c)

    phi = q[..., 1] + shape.phi_offset
    gamma = q[..., 2] + gamma_offset
    forearm = phi + math.pi - gamma
    return _InPlane(
        gamma=gamma,
        r=shape.a_0 + shape.a_1 * np.cos(phi) + l_2 * np.cos(forearm),
        l_2=l_2,
    )
