"""Readings as a function of all unknowns: the arm's, and those of each session.

The unknowns of a session are the tilt of its mount, the sensor's gains and offsets, the
places of its scales or the yaw of an arm on a vehicle, and, for efforts of joints that
move, friction.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.studies.calibration.floating import (
    Placement,
    tilt_angles,
    tilt_slopes,
)
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
#: A joint that is slower rests: what is left is rounding, whose sign says nothing
#: [rad/s].
_AT_REST = 1e-12


class OfSession(NamedTuple):
    """The unknowns of one session, all 0 if nothing is wrong.

    Attributes:
        tilt: Turn of gravity about two axes across it, (2,) [rad].
        gain: Of each channel, less 1, (k,).
        offset: Of each channel, (k,).
        placement: Of the scales along two axes, (6,) [m]; the yaw of an arm on a
            vehicle that tilts, (1,) [rad]; of other sensors, (0,).
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
        clean = _clean(session, own, arm, session.density)
        read = (1.0 + own.gain) * clean + own.offset
        if own.friction.size:
            read = read + _friction_columns(session.motion) @ own.friction
        return np.asarray(read)

    def slopes(self, values: FloatArray, number: int) -> FloatArray:
        """Derivative of `predicted` by the unknowns, (N, k, K)."""
        session = self.sessions[number]
        own = self._own(values, number)
        of_arm = values[: len(NAMES)]
        by = _clean_slopes(session, own, self.unknowns, of_arm)

        count, size = by.clean.shape
        out = np.zeros((count, size, len(self.names)))
        gains = (1.0 + own.gain)[:, None]
        out[..., : len(NAMES)] = gains * by.arm
        ones = np.broadcast_to(np.eye(size), (count, size, size))
        parts = [gains * by.tilt, by.clean[..., None] * ones, ones]
        if own.placement.size:
            parts.append(gains * by.placement)
        if own.friction.size:
            parts.append(_friction_columns(session.motion))
        out[..., self._places[number]] = np.concatenate(parts, axis=-1)
        return out

    def by_density(self, values: FloatArray, number: int) -> FloatArray:
        """Change of `predicted` with the fluid's density, (N, k) for each kg/m^3."""
        session = self.sessions[number]
        own = self._own(values, number)
        arm = self.unknowns.record(values[: len(NAMES)])
        denser = _clean(session, own, arm, session.density + 1.0)
        return np.asarray(
            (1.0 + own.gain) * (denser - _clean(session, own, arm, session.density))
        )

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


class _CleanSlopes(NamedTuple):
    """Readings without gain and offset, and their derivatives.

    Attributes:
        clean: (N, k).
        arm: By the arm's numbers, (N, k, 78).
        tilt: By the mount's tilt, (N, k, 2).
        placement: By `OfSession.placement`, (N, k, ...).
    """

    clean: FloatArray
    arm: FloatArray
    tilt: FloatArray
    placement: FloatArray


def _clean(
    session: Session, own: OfSession, arm: Alpha5Parameters, density: float
) -> FloatArray:
    """What a sensor without gain and offset reads, (N, k)."""
    carrier = session.sensor.carrier
    if carrier is not None:
        return tilt_angles(arm, density, session.motion.q, carrier, _on_vehicle(own))
    load = loads(arm, density, _tilted(session, own.tilt))
    return np.asarray(load @ _placed_matrix(session, own).T)


def _clean_slopes(
    session: Session, own: OfSession, unknowns: ArmUnknowns, of_arm: FloatArray
) -> _CleanSlopes:
    """The same with its derivatives."""
    carrier = session.sensor.carrier
    density = session.density
    if carrier is not None:
        by = tilt_slopes(
            unknowns, of_arm, density, session.motion.q, carrier, _on_vehicle(own)
        )
        return _CleanSlopes(
            clean=by.angles, arm=by.by_arm, tilt=by.by_tilt, placement=by.by_yaw
        )
    matrix = _placed_matrix(session, own)
    arm = unknowns.record(of_arm)
    motion = _tilted(session, own.tilt)
    load = loads(arm, density, motion)
    turns = _tilt_slopes(session, own.tilt)
    by_tilt = gravity_slopes(arm, density, motion.q, turns)
    by_place = np.zeros((*load.shape[:1], session.sensor.size, 0))
    if own.placement.size:
        moved = load @ placement_matrices(session.sensor).swapaxes(1, 2)
        by_place = np.moveaxis(moved, 0, -1)
    return _CleanSlopes(
        clean=load @ matrix.T,
        arm=matrix @ load_slopes(unknowns, of_arm, density, motion),
        tilt=matrix @ by_tilt,
        placement=by_place,
    )


def _on_vehicle(own: OfSession) -> Placement:
    """How the arm stands on the vehicle that tilts."""
    return Placement(tilt=own.tilt, yaw=own.placement.item())


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
    if sensor.carrier is not None:
        placed = 1
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
    if session.sensor.carrier is not None:
        names.append("yaw")
    elif prior.placement.size:
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
    moving = np.abs(motion.v) > _AT_REST
    coulomb = np.where(moving, np.sign(motion.v), 0.0)[..., None] * unit
    viscous = motion.v[..., None] * unit
    return np.concatenate([coulomb, viscous], axis=-1)
