"""Motions to play: a recording with its torques, a tour, positions at a steady rate."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, float_array, shaped
from alpha5_model.dynamics.arm import Arm
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.trajectory import Analysis, Motion, analyse, motion
from alpha5_model.trajectory.analysis import AT_MOTORS
from alpha5_model.trajectory.smoothing import DEFAULT_BANDWIDTH
from alpha5_model.viewer.scene import Compared, MotionTrack

#: Samples of a tour per second.
_RATE = 25.0
#: Rest of a tour at each pose [s].
_PAUSE = 0.6


def motion_track(
    played: Motion,
    arm: Arm,
    q: FloatArray,
    water_velocity: ArrayLike | None = None,
    curves: Mapping[str, ArrayLike] | None = None,
) -> MotionTrack:
    """A motion of the arm's joints, with its torques and its load on the mount.

    Recorded positions, efforts and currents stand beside the computed ones.

    Args:
        played: The motion. Joints that the arm lacks are left out.
        arm: The arm. On a vehicle it has no mount, and the track has no loads.
        q: Where joints stay that the motion lacks, (nq,).
        water_velocity: In base_link, (3,) [m/s]; no moving water if None.
        curves: Name -> signals of the user, with one number for each sample, (N,).
    """
    signals = _signals(curves or {}, len(played.time))
    time = played.time - played.time[0]
    n = len(arm.joint_names)
    common = min(n, len(played.joints))
    positions = np.tile(q[len(q) - n :], (len(time), 1))
    positions[:, :common] = played.position[:, :common]

    track = MotionTrack(
        name=Path(played.source).name,
        time=time,
        q=positions,
        loads={},
        signals=signals,
    )
    if arm.floating_base:
        return track

    def widened(rows: FloatArray | None, missing: float) -> FloatArray | None:
        """Columns for all joints of the arm."""
        if rows is None:
            return None
        beyond = ((0, 0), (0, n - common))
        return np.pad(rows[:, :common], beyond, constant_values=missing)

    # It has been checked: what is checked again might lose samples.
    moved = replace(
        played,
        joints=tuple(arm.joint_names),
        position=positions,
        velocity=widened(played.velocity, 0.0),
        effort=widened(played.effort, np.nan),
        current=widened(played.current, np.nan),
    )
    analysis = _analysis(arm, moved, water_velocity)
    return replace(track, loads=_loads(analysis), compared=_compared(analysis))


def _signals(curves: Mapping[str, ArrayLike], samples: int) -> dict[str, FloatArray]:
    """The user's curves, by name.

    Raises:
        InputError: A name that is none, or numbers that do not fit (`ShapeError`,
            `NonFiniteError`).
    """
    signals = {}
    for name, values in curves.items():
        fits = isinstance(name, str) and 0 < len(name) <= 40 and name.isprintable()
        if not fits:
            raise InputError("curves", name, "names of 1 to 40 printable characters")
        signals[name] = shaped(f"curves[{name!r}]", values, (samples,))
    return signals


def _analysis(arm: Arm, moved: Motion, water_velocity: ArrayLike | None) -> Analysis:
    # A smoothing bandwidth needs more than two samples for each of its periods.
    step = np.median(np.diff(moved.time))
    method = "spline" if step < 0.5 / DEFAULT_BANDWIDTH else "interpolate"
    return analyse(moved, arm, method=method, water_velocity=water_velocity)


def _loads(analysis: Analysis) -> dict[str, FloatArray]:
    """Torque by cause at the joints, and as ``mount`` the load on the mount."""
    causes = analysis.causes()
    at_joints = {name: causes[name] for name in causes if name not in AT_MOTORS}
    return {**at_joints, "mount": analysis.base_wrench}


def _compared(analysis: Analysis) -> dict[str, Compared]:
    """What was recorded, by quantity."""
    position = Compared(
        recorded=analysis.motion.position, computed=analysis.smooth.position
    )
    compared = {"position": position}
    if analysis.effort is not None:
        compared["effort"] = Compared(
            recorded=analysis.effort, computed=analysis.torque
        )
    if analysis.recorded_current is not None:
        compared["current"] = Compared(
            recorded=analysis.recorded_current, computed=analysis.current
        )
    return compared


def tour(waypoints: ArrayLike, parameters: Alpha5Parameters) -> Motion:
    """Move from pose to pose, resting at each.

    Each leg follows ``s = (1 - cos(pi t / T)) / 2`` and takes the time at which the
    fastest joint just reaches its speed.

    Args:
        waypoints: (N, n), at least two, joints base to tip [rad; jaw rod m].
        parameters: The arm, for the speeds of its joints.

    Returns:
        The motion, sampled at 25 Hz.

    Raises:
        InputError: Fewer than two poses, or not of four or five joints.
    """
    joints = parameters.joints[: np.shape(waypoints)[-1]]
    poses = float_array("waypoints", waypoints, (len(joints),))
    if poses.ndim != 2 or len(poses) < 2:
        raise InputError("waypoints", poses.shape, "at least two poses in rows")
    speeds = np.array([joint.velocity for joint in joints])
    resting = round(_PAUSE * _RATE)

    pieces = [_rest(poses[0], resting)]
    for start, end in pairwise(poses):
        pieces += [_leg(start, end, speeds), _rest(end, resting)]
    q = np.concatenate(pieces)
    time = np.arange(len(q)) / _RATE
    return replace(motion(time, q), source="a short motion")


def _rest(pose: FloatArray, samples: int) -> FloatArray:
    """Samples of a pose (n,), in rows."""
    return np.repeat(pose[None], samples, axis=0)


def _leg(start: FloatArray, end: FloatArray, speeds: FloatArray) -> FloatArray:
    """Samples after the first of a smooth move from start (n,) to end (n,), in rows."""
    duration = float(np.max(np.pi / 2 * np.abs(end - start) / speeds))
    samples = round(duration * _RATE) + 2
    phase = np.linspace(0.0, np.pi, samples)[1:]
    done = (1.0 - np.cos(phase)) / 2
    return np.asarray(start + (end - start) * done[:, None])


def resampled(
    arm: Arm, time: FloatArray, q: FloatArray, rate: float
) -> Iterator[FloatArray]:
    """Joint positions (nq,) at a rate [1/s] along a motion, time (N,) and q (N, nq)."""
    duration = time[-1] - time[0]
    ticks = time[0] + np.arange(0.0, duration + 0.999 / rate, 1.0 / rate)
    # Place 2.3 is three tenths of the way from sample 2 to sample 3.
    for place in np.interp(ticks, time, np.arange(float(len(time)))):
        i = min(int(place), len(time) - 2)
        yield pin.interpolate(arm.model, q[i], q[i + 1], place - i)
