"""Sensors that weigh an arm: scales, a force-torque sensor, the joints' efforts.

Each reads linear combinations of the joint torques and of the load on the mount, times
an unknown gain, plus an unknown offset. The tilt of a vehicle is in `tilt_sensor.py`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, array, flag, frozen, real
from alpha5_model.errors import InputError
from alpha5_model.numbers.fluids import GRAVITY
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.water.carrier import Carrier

#: Joint torques and components of the load on the mount.
LOADS = 10
#: What a scale shows is a force over this [m/s^2].
STANDARD_GRAVITY = float(np.linalg.norm(GRAVITY))
#: Corners of a triangle under base_link, all 0.18 m from its middle [m].
TRIANGLE = ((0.18, 0.0, -0.03), (-0.09, 0.156, -0.03), (-0.09, -0.156, -0.03))
#: Prior of an offset that is not known at all [kg, N, N m].
ANY_MASS = 10.0
_ANY_FORCE = 10.0
_ANY_TORQUE = 1.0
#: Scales that lie nearer to a line than this carry no moment about it [m].
_FLAT = 0.02


@dataclass(frozen=True, eq=False)
class Sensor:
    """A sensor; make one with `scales`, `weight`, `force_torque`, `efforts` or
    `vehicle_tilt`.

    Attributes:
        kind: ``scales``, ``weight``, ``force-torque``, ``efforts`` or ``vehicle-tilt``.
        channels: Names of the readings, (k,).
        unit: Of the readings in the package, one for each, (k,).
        matrix: Readings by joint torques and load on the mount in base_link, (k, 10);
            zeros for a vehicle's tilt, which is not linear in them.
        noise: Standard deviation of the readings, (k,).
        gain: That of the gains about 1, (k,).
        offset: That of the offsets, (k,).
        positions: Of scales in base_link, (3, 3) [m]; None for other kinds.
        placement: Standard deviation of each of their coordinates [m], or of the arm's
            turn about the z axis of a vehicle that tilts [rad].
        carrier: The vehicle that tilts; None for other kinds.
    """

    kind: str
    channels: tuple[str, ...]
    unit: tuple[str, ...]
    matrix: FloatArray
    noise: FloatArray
    gain: FloatArray
    offset: FloatArray
    positions: FloatArray | None = None
    placement: float = 0.0
    carrier: Carrier | None = None

    @property
    def size(self) -> int:
        """Number of its readings."""
        return len(self.channels)


def scales(
    positions: ArrayLike = TRIANGLE,
    *,
    noise: float = 0.0003,
    gain: float = 0.001,
    placement: float = 0.0,
    zeroed: bool = False,
) -> Sensor:
    """Three scales under the mount plate. They read masses [kg].

    They stand on one table, and the plate rests on one point of each.

    Args:
        positions: Of these points in base_link, (3, 3) [m].
        noise: Standard deviation of a reading [kg]. That of rounding to whole grams is
            0.29 g; scales that do not repeat a reading have more.
        gain: Standard deviation of the factor by which each scale is wrong.
        placement: That of the coordinates of the points [m].
        zeroed: Whether the scales showed 0 with the bare plate, to twice the noise. If
            not, what lies on them beside the arm is unknown.

    Raises:
        InputError: Not three points of a triangle, or numbers not above 0.
    """
    points = array("positions", positions, 3, 3)
    noise = real("noise", noise, minimum=0.0, strict=True)
    offset = 2.0 * noise if flag("zeroed", zeroed) else ANY_MASS
    return Sensor(
        kind="scales",
        channels=("scale_1", "scale_2", "scale_3"),
        unit=("kg",) * 3,
        matrix=frozen(_support_matrix(points)),
        noise=_same(noise, 3),
        gain=_same(real("gain", gain, minimum=0.0), 3),
        offset=_same(offset, 3),
        positions=frozen(points),
        placement=real("placement", placement, minimum=0.0),
    )


def weight(
    gravity: ArrayLike = GRAVITY,
    *,
    noise: float = 0.0003,
    gain: float = 0.001,
    zeroed: bool = True,
) -> Sensor:
    """One scale that carries the whole arm. It reads a mass [kg].

    Args:
        gravity: In base_link, (3,) [m/s^2].
        noise, gain, zeroed: As of `scales`.

    Raises:
        InputError: No gravity, or numbers not above 0.
    """
    pull = array("gravity", gravity, 3)
    strength = np.linalg.norm(pull)
    if not strength > 0.0:
        raise InputError("gravity", pull.tolist(), "gravity that pulls somewhere")
    noise = real("noise", noise, minimum=0.0, strict=True)
    matrix = np.zeros((1, LOADS))
    matrix[0, 4:7] = pull / strength / STANDARD_GRAVITY
    return Sensor(
        kind="weight",
        channels=("scale",),
        unit=("kg",),
        matrix=frozen(matrix),
        noise=_same(noise, 1),
        gain=_same(real("gain", gain, minimum=0.0), 1),
        offset=_same(2.0 * noise if flag("zeroed", zeroed) else ANY_MASS, 1),
    )


def force_torque(
    *, force_noise: float = 0.03, torque_noise: float = 0.003, gain: float = 0.01
) -> Sensor:
    """A force-torque sensor under the mount, with unknown offsets.

    It reads the load of the arm at the origin and in the axes of base_link [N, N m].

    Args:
        force_noise, torque_noise: Standard deviations of a reading [N, N m].
        gain: That of the factor by which each channel is wrong.

    Raises:
        InputError: A noise not above 0, or a gain below 0.
    """
    force = real("force_noise", force_noise, minimum=0.0, strict=True)
    torque = real("torque_noise", torque_noise, minimum=0.0, strict=True)
    return Sensor(
        kind="force-torque",
        channels=("Fx", "Fy", "Fz", "Mx", "My", "Mz"),
        unit=("N",) * 3 + ("N m",) * 3,
        matrix=frozen(np.eye(LOADS)[4:]),
        noise=frozen(np.repeat([force, torque], 3)),
        gain=_same(real("gain", gain, minimum=0.0), 6),
        offset=frozen(np.repeat([_ANY_FORCE, _ANY_TORQUE], 3)),
    )


def efforts(*, noise: float = 0.003, gain: float = 0.01, offset: float = 0.0) -> Sensor:
    """Torques of the four joints [N m], which hold the arm without friction.

    Coulomb and viscous friction of joints that move are unknown.

    Args:
        noise: Standard deviation of a reading [N m].
        gain: That of the factor by which each joint is wrong.
        offset: That of the offset of each joint [N m].

    Raises:
        InputError: A noise not above 0, or a gain or offset below 0.
    """
    noise = real("noise", noise, minimum=0.0, strict=True)
    return Sensor(
        kind="efforts",
        channels=JOINT_NAMES[:4],
        unit=("N m",) * 4,
        matrix=frozen(np.eye(LOADS)[:4]),
        noise=_same(noise, 4),
        gain=_same(real("gain", gain, minimum=0.0), 4),
        offset=_same(real("offset", offset, minimum=0.0), 4),
    )


def placement_matrices(sensor: Sensor) -> FloatArray:
    """Derivative of the scales' `matrix` by the places of the scales, (6, 3, 10).

    A scale that is moved by dp along its plane carries its force N at another place;
    the moment dp x N is balanced by all three.

    Args:
        sensor: Scales.

    Returns:
        For each scale, along the two axes of `plane`.
    """
    assert sensor.positions is not None
    balance = _balance(sensor.positions)
    axes = plane(sensor.positions)
    slopes = []
    for scale in range(3):
        for direction in axes[:2]:
            moment = _column(direction, axes) - [1.0, 0.0, 0.0]
            by_force = -np.linalg.solve(balance, moment)
            slopes.append(np.outer(by_force, sensor.matrix[scale]))
    return np.array(slopes)


def plane(positions: FloatArray) -> FloatArray:
    """Two axes in the plane of three points and its normal, as rows, (3, 3).

    The normal points to the side of the origin, or along z if the origin is in it.
    """
    first = positions[1] - positions[0]
    normal = np.cross(first, positions[2] - positions[0])
    height = -normal @ positions[0]
    upward = height if abs(height) > 1e-12 else normal[2]
    if upward < 0:
        normal = -normal
    normal /= np.linalg.norm(normal)
    along = first / np.linalg.norm(first)
    return np.array([along, np.cross(normal, along), normal])


def _support_matrix(positions: FloatArray) -> FloatArray:
    """What three supports carry, in kg, by the load on the mount, (3, 10).

    Raises:
        InputError: Points of no triangle.
    """
    sides = positions - positions[[1, 2, 0]]
    twice_area = np.linalg.norm(np.cross(sides[0], sides[1]))
    longest = np.linalg.norm(sides, axis=1).max()
    if twice_area <= _FLAT * longest:
        expected = f"three points at least {_FLAT:g} m off one line, in m"
        raise InputError("positions", positions.tolist(), expected)

    axes = plane(positions)
    centre = positions.mean(axis=0)
    about = np.zeros((3, 6))
    about[0, :3] = -axes[2]
    for row in (0, 1):
        # e . (M - c x F), turned round, as the scales push against the load.
        about[1 + row, :3] = np.cross(axes[row], centre)
        about[1 + row, 3:] = -axes[row]
    matrix = np.zeros((3, LOADS))
    matrix[:, 4:] = np.linalg.solve(_balance(positions), about) / STANDARD_GRAVITY
    return matrix


def _balance(positions: FloatArray) -> FloatArray:
    """Normal force and moments about the centre of unit forces at points, (3, 3)."""
    axes = plane(positions)
    centre = positions.mean(axis=0)
    return np.array([_column(point - centre, axes) for point in positions]).T


def _column(lever: FloatArray, axes: FloatArray) -> FloatArray:
    """A unit force along the normal: itself, and its moments about the axes, (3,)."""
    moment = np.cross(lever, axes[2])
    return np.array([1.0, axes[0] @ moment, axes[1] @ moment])


def _same(value: float, size: int) -> Any:
    return frozen(np.full(size, float(value)))
