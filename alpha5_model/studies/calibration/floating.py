"""Roll and pitch of a floating vehicle, which tilts by the arm that it carries.

At rest, weight and buoyancy of vehicle and arm have no moment about the vehicle's
origin. With the lever ``S = sum (m c - rho V b)`` of all bodies in the vehicle's axes,
the moment is ``S x g``. So -S points up. For small changes the tilt is the arm's moment
over a stiffness, as in `alpha5_model.fit_tilt`.

If weight and buoyancy of the whole differ, a thrust holds the depth. It is taken to act
at the vehicle's origin.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import cross_matrix, rotation_about
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.studies.calibration.loads import Motion, load_slopes, loads
from alpha5_model.studies.calibration.unknowns import ArmUnknowns
from alpha5_model.water.carrier import Carrier
from alpha5_model.water.vehicle import trim_angles

#: The axes of base_link along which gravity pulls with 1 m/s^2.
_ALONG_X, _, _ALONG_Z = np.eye(3)
#: Where the force along x and the moments about x and y stand in `loads`.
_FORCE_X = 4
_MOMENT_X = 7
_MOMENT_Y = 8


class Placement(NamedTuple):
    """How the arm stands on its vehicle, beyond the mount that is given.

    Attributes:
        tilt: Turns about x and y of base_link, (2,) [rad].
        yaw: Turn about the vehicle's z [rad].
    """

    tilt: FloatArray
    yaw: float


class TiltSlopes(NamedTuple):
    """Roll and pitch, and their derivatives.

    Attributes:
        angles: (N, 2) [rad].
        by_arm: By the numbers of the arm, (N, 2, 78).
        by_tilt: By `Placement.tilt`, (N, 2, 2).
        by_yaw: By `Placement.yaw`, (N, 2, 1).
    """

    angles: FloatArray
    by_arm: FloatArray
    by_tilt: FloatArray
    by_yaw: FloatArray


def tilt_angles(
    arm: Alpha5Parameters,
    density: float,
    q: FloatArray,
    carrier: Carrier,
    placement: Placement,
) -> FloatArray:
    """Roll and pitch of the vehicle, (N, 2) [rad].

    Args:
        arm: The record, with its attached bodies.
        density: Of the fluid [kg/m^3].
        q: Of an arm at rest, (N, 4).
        carrier: The vehicle.
        placement: Of the arm.
    """
    moments = _static_moments(arm, density, q)
    upward = _upward(moments, density, carrier, placement)
    return np.column_stack(trim_angles(upward))


def tilt_slopes(
    unknowns: ArmUnknowns,
    values: FloatArray,
    density: float,
    q: FloatArray,
    carrier: Carrier,
    placement: Placement,
) -> TiltSlopes:
    """`tilt_angles` and their derivatives, for the numbers (78,) of an arm."""
    moments = _static_moments(unknowns.record(values), density, q)
    upward = _upward(moments, density, carrier, placement)
    by_upward = _angle_slopes(upward)
    to_vehicle = _to_vehicle(carrier, placement)

    along_x = load_slopes(unknowns, values, density, _at_rest(q, _ALONG_X))
    along_z = load_slopes(unknowns, values, density, _at_rest(q, _ALONG_Z))
    by_numbers = _moments(along_x.swapaxes(1, 2), along_z.swapaxes(1, 2))
    by_arm = to_vehicle @ by_numbers.swapaxes(1, 2)
    by_tilt = [moments @ turned.T for turned in _tilt_slopes(carrier, placement)]
    by_yaw = moments @ _yaw_slope(carrier, placement).T
    return TiltSlopes(
        angles=np.column_stack(trim_angles(upward)),
        by_arm=by_upward @ -by_arm,
        by_tilt=by_upward @ -np.stack(by_tilt, axis=-1),
        by_yaw=by_upward @ -by_yaw[..., None],
    )


def _static_moments(arm: Alpha5Parameters, density: float, q: FloatArray) -> FloatArray:
    """Lever of the arm in base_link, and its mass less displaced mass, (N, 4)."""
    along_x = loads(arm, density, _at_rest(q, _ALONG_X))
    along_z = loads(arm, density, _at_rest(q, _ALONG_Z))
    return _moments(along_x, along_z)


def _at_rest(q: FloatArray, gravity: FloatArray) -> Motion:
    still = np.zeros_like(q)
    return Motion(q=q, v=still, a=still, gravity=gravity)


def _moments(along_x: FloatArray, along_z: FloatArray) -> FloatArray:
    """Lever and net mass of loads (..., 10) under both gravities, (..., 4).

    A lever S gives the moments ``S x e_x = (0, S_z, -S_y)`` and
    ``S x e_z = (S_y, -S_x, 0)``.
    """
    lever_x = -along_z[..., _MOMENT_Y]
    lever_y = along_z[..., _MOMENT_X]
    lever_z = along_x[..., _MOMENT_Y]
    net_mass = along_x[..., _FORCE_X]
    return np.stack([lever_x, lever_y, lever_z, net_mass], axis=-1)


def _upward(
    moments: FloatArray, density: float, carrier: Carrier, placement: Placement
) -> FloatArray:
    """What points up, in the vehicle's axes, (N, 3)."""
    of_arm = moments @ _to_vehicle(carrier, placement).T
    return -(of_arm + carrier.lever(density))


def _to_vehicle(carrier: Carrier, placement: Placement) -> FloatArray:
    """Lever about the vehicle's origin by lever and net mass in base_link, (3, 4)."""
    yaw, mount, about_x, about_y = _turns(carrier, placement)
    rotation = yaw @ mount @ about_x @ about_y
    return np.column_stack([rotation, carrier.mount[:3, 3]])


def _turns(carrier: Carrier, placement: Placement) -> tuple[FloatArray, ...]:
    """Rotations from base_link to the vehicle, the last one first."""
    axis_x, axis_y, axis_z = np.eye(3)
    return (
        rotation_about(axis_z, placement.yaw),
        carrier.mount[:3, :3],
        rotation_about(axis_x, placement.tilt[0]),
        rotation_about(axis_y, placement.tilt[1]),
    )


def _tilt_slopes(carrier: Carrier, placement: Placement) -> list[FloatArray]:
    """Derivatives of `_to_vehicle` by the two tilts, (3, 4) each."""
    axis_x, axis_y, _ = np.eye(3)
    yaw, mount, about_x, about_y = _turns(carrier, placement)
    slopes = [
        yaw @ mount @ cross_matrix(axis_x) @ about_x @ about_y,
        yaw @ mount @ about_x @ cross_matrix(axis_y) @ about_y,
    ]
    return [np.column_stack([slope, np.zeros(3)]) for slope in slopes]


def _yaw_slope(carrier: Carrier, placement: Placement) -> FloatArray:
    """Derivative of `_to_vehicle` by the yaw, (3, 4)."""
    axis_z = np.eye(3)[2]
    yaw, mount, about_x, about_y = _turns(carrier, placement)
    slope = cross_matrix(axis_z) @ yaw @ mount @ about_x @ about_y
    return np.column_stack([slope, np.zeros(3)])


def _angle_slopes(upward: FloatArray) -> FloatArray:
    """Derivative of roll and pitch by what points up, (N, 2, 3)."""
    x, y, z = upward.T
    across = y**2 + z**2
    length = x**2 + across
    radius = np.sqrt(across)
    slopes = np.zeros((len(upward), 2, 3))
    slopes[:, 0, 1] = z / across
    slopes[:, 0, 2] = -y / across
    slopes[:, 1, 0] = -radius / length
    slopes[:, 1, 1] = x * y / (radius * length)
    slopes[:, 1, 2] = x * z / (radius * length)
    return slopes
