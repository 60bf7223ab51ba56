"""A force-torque sensor under the mount, and the efforts of the joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.studies.calibration.sensor import (
    Loads,
    Own,
    Sensor,
    deviations,
    scaled,
)

#: Prior of offsets of which nothing is known: forces [N], then moments [N m].
_ANY_OFFSET = np.repeat([10.0, 1.0], 3)
#: Prior of friction of which nothing is known [N m, N m s/rad].
_ANY_FRICTION = 10.0
#: Units in files.
_FORCES = {"N, N m": 1.0}
_TORQUES = {"N m": 1.0, "mN m": 1e-3}
#: A joint that is slower rests: what is left is rounding, whose sign says nothing
#: [rad/s].
_AT_REST = 1e-12


@dataclass(frozen=True, eq=False)
class ForceTorque(Sensor):
    """A force-torque sensor; make it with `force_torque`."""

    kind = "force-torque"
    channels = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
    unit = ("N",) * 3 + ("N m",) * 3
    units = _FORCES
    guide = (
        "Mount the arm on the sensor. Write its readings in the axes and about the",
        "origin of base_link in each pose, averaged over a second or more.",
    )

    force_noise: FloatArray
    torque_noise: FloatArray

    @property
    def deviation(self) -> FloatArray:
        return np.concatenate([self.force_noise, self.torque_noise])

    def own(self, moves: bool) -> tuple[Own, ...]:
        return (
            Own("gain", self.channels, self.gain),
            Own("offset", self.channels, _ANY_OFFSET),
        )

    def read(self, loads: Loads, own: Mapping[str, FloatArray]) -> FloatArray:
        return scaled(loads.total[:, 4:], own)


@dataclass(frozen=True, eq=False)
class Efforts(Sensor):
    """The efforts of four joints; make them with `efforts`."""

    kind = "efforts"
    channels = JOINT_NAMES[:4]
    unit = ("N m",) * 4
    units = _TORQUES
    guide = (
        "Write the torques of the joints, without friction: the mean of those after",
        "coming from above and from below.",
    )
    by_joint = True

    noise: FloatArray
    offset: FloatArray

    @property
    def deviation(self) -> FloatArray:
        return self.noise

    def own(self, moves: bool) -> tuple[Own, ...]:
        own = (
            Own("gain", self.channels, self.gain),
            Own("offset", self.channels, self.offset),
        )
        if not moves:
            return own
        any_friction = np.full(4, _ANY_FRICTION)
        return (
            *own,
            Own("Coulomb", self.channels, any_friction),
            Own("viscous", self.channels, any_friction),
        )

    def read(self, loads: Loads, own: Mapping[str, FloatArray]) -> FloatArray:
        readings = scaled(loads.total[:, :4], own)
        if "Coulomb" in own:
            v = loads.velocity
            direction = np.where(np.abs(v) > _AT_REST, np.sign(v), 0.0)
            readings = readings + direction * own["Coulomb"] + v * own["viscous"]
        return readings


def force_torque(
    *,
    force_noise: ArrayLike = 0.03,
    torque_noise: ArrayLike = 0.003,
    gain: ArrayLike = 0.01,
) -> ForceTorque:
    """A force-torque sensor under the mount, with unknown offsets.

    It reads the load of the arm at the origin and in the axes of base_link [N, N m].
    Each argument is one number, or one for each channel.

    Args:
        force_noise, torque_noise: Standard deviations of a reading [N, N m].
        gain: That of the factor by which each channel is wrong.

    Raises:
        InputError: A noise not above 0, or a gain below 0.
    """
    return ForceTorque(
        gain=deviations("gain", gain, 6),
        force_noise=deviations("force_noise", force_noise, 3, above_zero=True),
        torque_noise=deviations("torque_noise", torque_noise, 3, above_zero=True),
    )


def efforts(
    *, noise: ArrayLike = 0.003, gain: ArrayLike = 0.01, offset: ArrayLike = 0.0
) -> Efforts:
    """Torques of the four joints [N m], which hold the arm without friction.

    Coulomb and viscous friction of joints that move are unknown. Each argument is one
    number, or one for each joint.

    Args:
        noise: Standard deviation of a reading [N m].
        gain: That of the factor by which each joint is wrong.
        offset: That of the offset of each joint [N m].

    Raises:
        InputError: A noise not above 0, or a gain or offset below 0.
    """
    return Efforts(
        gain=deviations("gain", gain, 4),
        noise=deviations("noise", noise, 4, above_zero=True),
        offset=deviations("offset", offset, 4),
    )
