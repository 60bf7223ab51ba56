"""Readings as a function of all unknowns: the arm's, and those of each session.

The unknowns of a session are the tilt of its mount, the sensor's gains and offsets, the
places of its scales and, for efforts of joints that move, friction.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.studies.calibration.loads import (
    Motion,
    gravity_slopes,
    load_slopes,
    loads,
)
from alpha5_model.studies.calibration.sensors import placement_matrices
from alpha5_model.studies.calibration.sessions import Session
from alpha5_model.studies.calibration.unknowns import NAMES, ArmUnknowns

#: Prior of friction that is not known at all [N m, N m s/rad].
_ANY_FRICTION = 10.0


class OfSession(NamedTuple):
    """The unknowns of one session, all 0 if nothing is wrong.

    Attributes:
        tilt: Turn of gravity about two axes across it, (2,) [rad].
        gain: Of each channel, less 1, (k,).
        offset: Of each channel, (k,).
        placement: Of the scales along two axes, (6,) [m]; of other sensors, (0,).
        friction: Coulomb, then viscous, of joints that move, (8,); otherwise (0,).
    """

    tilt: FloatArray
    gain: FloatArray
    offset: FloatArray
    placement: FloatArray
    friction: FloatArray


class Equations:
    """Readings of sessions, divided by their noise, in terms of all unknowns.

    Unknowns are the arm's `NAMES`, then those of each session.

    Attributes:
        sessions: What was measured.
        names: Of all unknowns, (K,).
        middle: Their values beforehand, (K,).
        deviation: Their standard deviations beforehand, (K,).
    """

    def __init__(
        self, unknowns: ArmUnknowns, sessions: Sequence[Session], tilt: float
    ) -> None:
        self.unknowns = unknowns
        self.sessions = tuple(sessions)
        own = [_prior(session, tilt) for session in sessions]
        self._places = _places([sum(map(len, part)) for part in own])
        own_names = []
        for number, session in enumerate(self.sessions):
            own_names += [f"{number}.{name}" for name in _names(session)]
        self.names = (*NAMES, *own_names)
        parts = [part for prior in own for part in prior]
        self.deviation = np.concatenate([unknowns.deviation, *parts])
        self.middle = np.zeros(len(self.names))
        self.middle[: len(NAMES)] = unknowns.middle

    def predicted(self, values: FloatArray, number: int) -> FloatArray:
        """Readings of a session by unknowns (K,), (N, k), in the sensor's units."""
        session = self.sessions[number]
        own = self._own(values, number)
        arm = self.unknowns.record(values[: len(NAMES)])
        load = loads(arm, session.density, _tilted(session, own.tilt))
        clean = load @ _placed_matrix(session, own).T
        read = (1.0 + own.gain) * clean + own.offset
        if own.friction.size:
            read = read + _friction_columns(session.motion) @ own.friction
        return np.asarray(read)

    def slopes(self, values: FloatArray, number: int) -> FloatArray:
        """Derivative of `predicted` by the unknowns, (N, k, K)."""
        session = self.sessions[number]
        own = self._own(values, number)
        matrix = _placed_matrix(session, own)
        of_arm = values[: len(NAMES)]
        arm = self.unknowns.record(of_arm)
        motion = _tilted(session, own.tilt)
        load = loads(arm, session.density, motion)
        clean = load @ matrix.T

        count, size = clean.shape
        out = np.zeros((count, size, len(self.names)))
        by_arm = load_slopes(self.unknowns, of_arm, session.density, motion)
        gains = (1.0 + own.gain)[:, None]
        out[..., : len(NAMES)] = gains * (matrix @ by_arm)

        turns = _tilt_slopes(session, own.tilt)
        by_tilt = gravity_slopes(arm, session.density, motion.q, turns)
        ones = np.broadcast_to(np.eye(size), (count, size, size))
        parts = [gains * (matrix @ by_tilt), clean[..., None] * ones, ones]
        if own.placement.size:
            by_place = load @ placement_matrices(session.sensor).swapaxes(1, 2)
            parts.append(gains * np.moveaxis(by_place, 0, -1))
        if own.friction.size:
            parts.append(_friction_columns(session.motion))
        out[..., self._places[number]] = np.concatenate(parts, axis=-1)
        return out

    def residuals(self, values: FloatArray) -> FloatArray:
        """Read minus predicted, in standard deviations of the noise, (m,)."""
        rows = []
        for number, session in enumerate(self.sessions):
            left = session.readings - self.predicted(values, number)
            rows.append((left / session.sensor.noise)[np.isfinite(session.readings)])
        return np.concatenate(rows)

    def matrix(self, values: FloatArray) -> FloatArray:
        """Derivative of what is predicted, in standard deviations, (m, K)."""
        rows = []
        for number, session in enumerate(self.sessions):
            slopes = self.slopes(values, number) / session.sensor.noise[:, None]
            rows.append(slopes[np.isfinite(session.readings)])
        return np.concatenate(rows)

    def _own(self, values: FloatArray, number: int) -> OfSession:
        """The unknowns of a session."""
        prior = _prior(self.sessions[number], 0.0)
        ends = np.cumsum([len(part) for part in prior])[:-1]
        parts = np.split(values[self._places[number]], ends)
        return OfSession(
            tilt=parts[0],
            gain=parts[1],
            offset=parts[2],
            placement=parts[3],
            friction=parts[4],
        )


def _placed_matrix(session: Session, own: OfSession) -> FloatArray:
    """The sensor's matrix, its scales moved to their places."""
    matrix = session.sensor.matrix
    if not own.placement.size:
        return matrix
    moved = np.tensordot(own.placement, placement_matrices(session.sensor), 1)
    return np.asarray(matrix + moved)


def _prior(session: Session, tilt: float) -> OfSession:
    """Standard deviations of the unknowns of a session."""
    sensor = session.sensor
    placed = 0 if sensor.positions is None else 6
    rubs = sensor.kind == "efforts" and not session.motion.rests
    return OfSession(
        tilt=np.full(2, tilt),
        gain=sensor.gain,
        offset=sensor.offset,
        placement=np.full(placed, sensor.placement),
        friction=np.full(8 if rubs else 0, _ANY_FRICTION),
    )


def _names(session: Session) -> list[str]:
    """Names of the unknowns of a session, in order."""
    prior = _prior(session, 0.0)
    channels = session.sensor.channels
    names = ["tilt.1", "tilt.2"]
    names += [f"gain.{channel}" for channel in channels]
    names += [f"offset.{channel}" for channel in channels]
    if prior.placement.size:
        names += [f"placement.{channel}.{k}" for channel in channels for k in (1, 2)]
    if prior.friction.size:
        names += [f"Coulomb.{joint}" for joint in JOINT_NAMES[:4]]
        names += [f"viscous.{joint}" for joint in JOINT_NAMES[:4]]
    return names


def _places(sizes: Sequence[int]) -> list[slice]:
    """Where the unknowns of each session are."""
    ends = len(NAMES) + np.cumsum(sizes)
    return [
        slice(int(end) - size, int(end)) for end, size in zip(ends, sizes, strict=True)
    ]


def across(gravity: FloatArray) -> FloatArray:
    """Two unit vectors at right angles to gravity, (2, 3); zeros without gravity."""
    size = np.linalg.norm(gravity)
    if not size:
        return np.zeros((2, 3))
    helper = np.eye(3)[np.abs(gravity).argmin()]
    first = np.cross(gravity / size, helper)
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(gravity / size, first)])


def _tilted(session: Session, tilt: FloatArray) -> Motion:
    """The motion with gravity turned, its strength kept."""
    motion = session.motion
    return Motion(
        q=motion.q, v=motion.v, a=motion.a, gravity=_turned(motion.gravity, tilt)
    )


def _turned(gravity: FloatArray, tilt: FloatArray) -> FloatArray:
    turned = gravity + np.cross(tilt @ across(gravity), gravity)
    size = np.linalg.norm(turned)
    return turned * (np.linalg.norm(gravity) / size) if size else turned


def _tilt_slopes(session: Session, tilt: FloatArray) -> FloatArray:
    """Derivative of the turned gravity by the tilt, (2, 3)."""
    gravity = session.motion.gravity
    size = np.linalg.norm(gravity)
    if not size:
        return np.zeros((2, 3))
    axes = across(gravity)
    turned = gravity + np.cross(tilt @ axes, gravity)
    length = np.linalg.norm(turned)
    unit = turned / length
    change = np.cross(axes, gravity)
    return np.asarray(size / length * (change - np.outer(change @ unit, unit)))


def _friction_columns(motion: Motion) -> FloatArray:
    """Coulomb and viscous friction of size 1, (N, 4, 8)."""
    unit = np.eye(4)
    coulomb = np.sign(motion.v)[..., None] * unit
    viscous = motion.v[..., None] * unit
    return np.concatenate([coulomb, viscous], axis=-1)
