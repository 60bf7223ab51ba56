"""A motion that was planned, proved free and replayed."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import PathLike
from alpha5_model._support.text import short_repr
from alpha5_model.kinematics.bus_devices import devices_from_q
from alpha5_model.planning.motion_table import write_bus_commands, write_motion_table
from alpha5_model.planning.replay import Peak
from alpha5_model.planning.surroundings import Clearance, Surroundings
from alpha5_model.trajectory.analysis import Analysis
from alpha5_model.trajectory.motions import Motion


class Stop(NamedTuple):
    """Where a motion rests at a target, or passes it.

    Attributes:
        place: Of the target: ``through[0]``, ``target``, or a line of a file.
        time: When it comes to rest there, or is nearest to it [s].
        q: Of the arm at the target, (4,) [rad].
        away: How far the tcp, or any point of a link, is then from its place at q at
            most [m]; 0 where it rests.
        rotation_error: Angle between a pose that was asked for and the orientation that
            four joints attain at its point; 0 for other targets [rad].
    """

    place: str
    time: float
    q: FloatArray
    away: float
    rotation_error: float


@dataclass(frozen=True, eq=False)
class PlannedMotion:
    """A motion of axis_e to axis_b at equal steps of time. Arrays are read-only.

    Between two samples the arm is on the planned path as well, if position is
    interpolated from position and velocity.

    Attributes:
        time: (N,) [s].
        position: (N, 4) [rad].
        velocity: (N, 4) [rad/s].
        acceleration: (N, 4) [rad/s^2].
        way: Ends of the straight joint lines that it consists of, (K, 4) [rad]. A
            straight line of the tcp has its start and end.
        kind: ``straight``, ``another branch``, ``by retracted poses`` or
            ``tcp line``; through several targets, those of its parts.
        branch: Of the inverse kinematics that it ends in; None if joint positions were
            asked for.
        stops: Where and when it rests at each target, or passes it, the last one
            included.
        slowed: Factor by which the motors' limits made it longer; 1.0 if they did not.
        peaks: Speed, torque, current and voltage of each joint, with their limits.
        analysis: The replay: torques, currents, powers and load on the mount.
    """

    time: FloatArray
    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    way: FloatArray
    kind: str
    branch: str | None
    stops: tuple[Stop, ...]
    slowed: float
    peaks: tuple[Peak, ...]
    analysis: Analysis
    _surroundings: Surroundings

    __repr__ = short_repr

    @property
    def obstacles(self) -> tuple[str, ...]:
        """Names of the obstacles that it keeps clear of."""
        return self._surroundings.obstacles

    @cached_property
    def clearance(self) -> Clearance | None:
        """The least distance to an obstacle at the samples; None without obstacles."""
        return self._surroundings.clearance(self.position)

    @property
    def duration(self) -> float:
        """[s]."""
        return float(self.time[-1])

    @property
    def motion(self) -> Motion:
        """The same for `alpha5_model.trajectory` and `alpha5_model.view`."""
        return self.analysis.motion

    def write(self, path: PathLike) -> Path:
        """Write time, positions, velocities and accelerations.

        Columns of a table are ``time_secs`` and, for each joint, ``axis_e_pos``,
        ``axis_e_vel`` and ``axis_e_acc``. `alpha5_model.trajectory.read_motion` can
        read it. A joint whose sign in the arm file is -1 is written in the driver's
        direction.

        Args:
            path: ``.csv``, ``-``, a device or a pipe; ``.json`` or ``.yaml`` for a
                ``trajectory_msgs/JointTrajectory``.

        Raises:
            UnknownNameError: Another suffix.
            OutputError: The file cannot be written.
        """
        joints = self.motion.joints
        signs = self.analysis.arm.parameters.signs[: len(joints)]
        return write_motion_table(
            path,
            joints,
            time=self.time,
            position=signs * self.position,
            velocity=signs * self.velocity,
            acceleration=signs * self.acceleration,
        )

    def write_bus(self, path: PathLike) -> Path:
        """Write what `alpha5_model.devices_from_q` says that the devices are told.

        Columns are ``time_secs``, ``device_5 [rad]`` and so on to ``device_2 [rad]``.

        Args:
            path: ``.csv``, ``-``, a device or a pipe.

        Raises:
            UnknownNameError: Another suffix.
            OutputError: The file cannot be written.
        """
        devices = devices_from_q(self.position, self.analysis.arm.parameters)
        return write_bus_commands(path, self.time, devices)
