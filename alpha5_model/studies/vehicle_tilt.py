"""What the tilt of a floating vehicle says about the arm that it carries.

A vehicle without thrust tilts until the restoring moment of the water balances the
static moment of the arm's weight less buoyancy. For small changes the tilt is the
moment over a stiffness, one for roll and one for pitch, some time later.

The arm may be turned about the vertical, or the frame of the motion capture may. Then
its moment about one axis also tilts the vehicle about the other one, which can be
mistaken for another centre of buoyancy. So this angle, ``yaw``, is an unknown, too.

Trim and ballast of the vehicle are not known: each recording is compared without its
mean. A factor that is common to all moments of the arm goes into the stiffnesses.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    FloatArray,
    float_array,
    frozen,
    instance,
    listed,
    real,
)
from alpha5_model._support.spatial import rotation_about
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.load import load
from alpha5_model.errors import InputError, ShapeError
from alpha5_model.numbers.fluids import FRESH_WATER, GRAVITY
from alpha5_model.trajectory import Motion
from alpha5_model.water.vehicle import trim_angles

#: Step of the times that are compared [s].
STEP = 0.05
#: Delays of the vehicle that are tried [s].
DELAYS = tuple(k / 20 for k in range(21))
#: Step of the angles that are tried, and that at which the search for the best ends
#: [rad].
_FIRST_YAW_STEP = np.radians(5.0)
_YAW_STEP = 1e-7
#: Passes of the fit: the yaw also turns gravity as the arm sees it.
_PASSES = 3
#: A direction has the length 1 within this.
_LENGTH = 0.01
#: Sum of squares of moments that are none but rounding [(N m)^2].
_LEAST_MOMENT = 1e-12
#: Least time of a recording that is compared [s].
_LEAST = 5.0


@dataclass(frozen=True, eq=False)
class TiltRecording:
    """A motion of the arm, and the attitude of the vehicle on the same clock.

    Attributes:
        motion: Of the joints.
        time: Of the attitude, (N,), ascending [s].
        up: The world's z axis in the vehicle's axes, (N, 3). This is the last row of
            the rotation from the vehicle to the world, so yaw does not matter.
        grid: Times to compare at, (M,) [s]; None for every 0.05 s that both cover. Give
            them if there are gaps.

    Raises:
        InputError: Times that do not ascend, directions whose length is not 1, or less
            than 5 s that both files cover; ShapeError: wrong shapes.
    """

    motion: Motion
    time: FloatArray
    up: FloatArray
    grid: FloatArray | None = None

    def __post_init__(self) -> None:
        instance("motion", self.motion, Motion)
        time = float_array("time", self.time, ())
        up = float_array("up", self.up, (3,))
        if time.ndim != 1 or up.shape != (time.size, 3):
            raise ShapeError("up", up.shape, f"({time.size}, 3), one row for each time")
        if time.size < 2 or (np.diff(time) <= 0).any():
            raise InputError("time", time.tolist()[:5], "ascending times")
        length = np.linalg.norm(up, axis=1)
        worst = int(np.abs(length - 1).argmax())
        if abs(length[worst] - 1) > _LENGTH:
            raise InputError("up", up[worst].tolist(), "directions of length 1")

        object.__setattr__(self, "time", frozen(time))
        object.__setattr__(self, "up", frozen(up / length[:, None]))
        grid = self.grid
        times = self._common() if grid is None else float_array("grid", grid, ())
        if times.ndim != 1 or times.size < 2:
            raise InputError("grid", self.grid, f"{_LEAST:g} s that both files cover")
        object.__setattr__(self, "grid", frozen(times))

    def _common(self) -> FloatArray:
        """Times that motion and attitude cover."""
        start = max(self.time[0], self.motion.time[0])
        end = min(self.time[-1], self.motion.time[-1])
        if end - start < _LEAST:
            return np.empty(0)
        return np.arange(start, end, STEP)

    @property
    def tilt(self) -> FloatArray:
        """Roll and pitch of the vehicle at `time`, (N, 2) [rad]."""
        return np.column_stack(trim_angles(self.up))


@dataclass(frozen=True, eq=False)
class TiltFit:
    """How a vehicle answers to the moment of its arm; make one with `fit_tilt`.

    Attributes:
        arm: The arm whose moment it is.
        stiffness: For roll and pitch, (2,) [N m/rad]; infinite if the tilt goes against
            the moment, as with a wrong mount.
        stiffness_error: Standard errors, by leaving out each recording in turn
            (jackknife); NaN for fewer than two recordings.
        yaw: Angle by which the arm's axes are turned about the vehicle's z, beyond the
            mount that its record has [rad].
        yaw_error: Its standard error, likewise.
        delay: Of the vehicle [s].
        average: Length of the moving average [s].
        r2: Share of the tilt's variance that is explained, roll and pitch, (2,).
        held_out_r2: The same if each recording is predicted by what was fitted to the
            others, (2,); NaN for fewer than two recordings.
    """

    arm: Arm
    stiffness: FloatArray
    stiffness_error: FloatArray
    yaw: float
    yaw_error: float
    delay: float
    average: float
    r2: FloatArray
    held_out_r2: FloatArray

    def predict(self, recording: TiltRecording) -> FloatArray:
        """Tilt at the times of the recording's grid, without its mean, (M, 2) [rad]."""
        pulled = _pulled(self.arm)
        signal = _signal(recording, pulled, self.yaw, (self.delay,), self.average)
        (moment,) = signal.moment
        return np.asarray(moment / self.stiffness)

    def score(self, recordings: Iterable[TiltRecording]) -> FloatArray:
        """Share of the variance in recordings that is explained, (2,).

        It is NaN about an axis about which the vehicle does not tilt.

        Those to which nothing was fitted say how good the model is.

        Raises:
            InputError: No recordings.
        """
        left = np.zeros(2)
        total = np.zeros(2)
        for recording in _checked(recordings):
            tilt = _recorded(recording, self.average)
            left += ((tilt - self.predict(recording)) ** 2).sum(axis=0)
            total += (tilt**2).sum(axis=0)
        return _explained_share(left, total)


def fit_tilt(
    recordings: Iterable[TiltRecording],
    arm: Arm | None = None,
    average: float = 1.5,
    delays: ArrayLike = DELAYS,
) -> TiltFit:
    """Stiffnesses, yaw and delay of a vehicle, by least squares over all recordings.

    Args:
        recordings: Of one vehicle.
        arm: On a fixed base; its fluid counts, and the mount of its record says how
            base_link stands on the vehicle. None for the bare arm in fresh water, its
            axes parallel to the vehicle's.
        average: Length of the moving average of both signals [s].
        delays: Delays that are tried [s].

    Raises:
        InputError: No recordings, an arm that never moves, or an arm on a floating
            base.
    """
    chosen = load(FRESH_WATER) if arm is None else instance("arm", arm, Arm)
    if chosen.floating_base:
        raise InputError("arm", "a floating base", "an arm on a fixed base")
    length = real("average", average, STEP)
    tried = np.atleast_1d(float_array("delays", delays, ()))
    pulled = _pulled(chosen)
    given = _checked(recordings)
    yaw = 0.0
    for _ in range(_PASSES):
        signals = [_signal(one, pulled, yaw, tried.tolist(), length) for one in given]
        sums = [_sums(signal) for signal in signals]
        best = _best(sums)
        if not np.isfinite(best.compliance).all():
            raise InputError("recordings", f"{len(given)} of an arm at rest", "motions")
        yaw += best.yaw

    of_others = [_best(sums[:k] + sums[k + 1 :]) for k in range(len(sums))]
    return TiltFit(
        arm=chosen,
        stiffness=_stiffness(best),
        stiffness_error=_jackknife([_stiffness(other) for other in of_others]),
        yaw=yaw,
        yaw_error=_jackknife([np.array([other.yaw]) for other in of_others]).item(),
        delay=float(tried[best.delay]),
        average=length,
        r2=_explained(signals, [best] * len(signals)),
        held_out_r2=_explained(signals, of_others),
    )


def averaged(
    at: FloatArray, time: FloatArray, values: FloatArray, length: float
) -> FloatArray:
    """Moving average of values, (M, K); between two times it counts the mean of both.

    Before the first value and after the last one they stay as they are. A sum that ends
    there would be taken for a tilt if the mean is not 0.

    Args:
        at: Middles of the averages, (M,).
        time: Of the values, (N,).
        values: (N, K).
        length: Of the average.
    """
    beyond = length + np.ptp(np.concatenate([at, time]))
    time = np.concatenate([[time[0] - beyond], time, [time[-1] + beyond]])
    values = np.vstack([values[:1], values, values[-1:]])
    areas = (values[1:] + values[:-1]) / 2 * np.diff(time)[:, None]
    integral = np.vstack([np.zeros(values.shape[1]), np.cumsum(areas, axis=0)])
    low = interpolated(at - length / 2, time, integral)
    high = interpolated(at + length / 2, time, integral)
    return (high - low) / length


def interpolated(at: FloatArray, time: FloatArray, values: FloatArray) -> FloatArray:
    """Values (N, K) at other times, on straight lines, (M, K)."""
    return np.stack([np.interp(at, time, column) for column in values.T], axis=1)


class _Signal(NamedTuple):
    """The averaged signals of a recording, without their means.

    Attributes:
        moment: About the vehicle's x and y, at each delay, (D, M, 2) [N m].
        tilt: (M, 2) [rad].
    """

    moment: FloatArray
    tilt: FloatArray


class _Sums(NamedTuple):
    """Products of the signals of a recording, summed over its samples.

    Attributes:
        moments: Of the moments, (D, 2, 2).
        both: Of the tilts (rows) and the moments, (D, 2, 2).
    """

    moments: FloatArray
    both: FloatArray


class _Answer(NamedTuple):
    """What fits best.

    Attributes:
        delay: Index.
        yaw: [rad].
        compliance: (2,) [rad/(N m)].
    """

    delay: int
    yaw: float
    compliance: FloatArray


def _checked(recordings: Iterable[TiltRecording]) -> list[TiltRecording]:
    """The recordings; at least one."""
    found = listed("recordings", recordings, "TiltRecordings")
    if not found:
        raise InputError("recordings", found, "at least one TiltRecording")
    return [instance("recordings", one, TiltRecording) for one in found]


def _pulled(arm: Arm) -> list[Arm]:
    """The arm with gravity of 1 m/s^2 along each axis of base_link."""
    pulled = []
    for axis in np.eye(3):
        model = arm.model.copy()
        model.gravity.linear = axis
        pulled.append(
            Arm(model, arm.displacements, arm.fluid_density, parameters=arm.parameters)
        )
    return pulled


def _signal(
    recording: TiltRecording,
    pulled: Sequence[Arm],
    yaw: float,
    delays: Sequence[float],
    average: float,
) -> _Signal:
    """The moment of the arm at each delay, and the tilt."""
    moment = static_moment(recording, pulled, yaw)
    time = recording.motion.time
    grid = np.asarray(recording.grid)
    delayed = [averaged(grid - delay, time, moment, average) for delay in delays]
    found = np.stack(delayed)
    return _Signal(
        moment=found - found.mean(axis=1, keepdims=True),
        tilt=_recorded(recording, average),
    )


def _recorded(recording: TiltRecording, average: float) -> FloatArray:
    """The averaged tilt without its mean, (M, 2)."""
    grid = np.asarray(recording.grid)
    tilt = averaged(grid, recording.time, recording.tilt, average)
    return np.asarray(tilt - tilt.mean(axis=0))


def static_moment(
    recording: TiltRecording, pulled: Sequence[Arm], yaw: float
) -> FloatArray:
    """Moment of weight less buoyancy about the vehicle's x and y axes, (N, 2) [N m].

    It acts at base_link, at the times of the recording's motion. It is linear in
    gravity, which has the direction that the tilted vehicle sees.

    Args:
        recording: With the attitude of the vehicle.
        pulled: The arm, with gravity of 1 m/s^2 along x, y and z of base_link.
        yaw: Of the arm about the vehicle's z, beyond its mount [rad].
    """
    motion = recording.motion
    mount = pulled[0].parameters.mount
    to_vehicle = rotation_about((0.0, 0.0, 1.0), yaw)
    if mount is not None:
        to_vehicle = to_vehicle @ mount.rotation
    up = interpolated(motion.time, recording.time, recording.up)
    gravity = -np.linalg.norm(GRAVITY) * up @ to_vehicle
    q = motion.position[:, :4]
    rest = np.zeros((1, 4))
    moment = np.zeros((len(q), 3))
    for arm, pull in zip(pulled, gravity.T, strict=True):
        moment += pull[:, None] * arm.base_wrench_batch(q, rest, rest)[:, 3:]
    return np.asarray((moment @ to_vehicle.T)[:, :2])


def _sums(signal: _Signal) -> _Sums:
    """The sums that a fit needs."""
    moments = signal.moment
    return _Sums(
        moments=np.einsum("dmi,dmj->dij", moments, moments),
        both=np.einsum("mi,dmj->dij", signal.tilt, moments),
    )


def _best(sums: Sequence[_Sums]) -> _Answer:
    """Delay, yaw and compliances with the least squares of what is left."""
    total = _added(sums)
    if total is None:
        return _Answer(delay=0, yaw=np.nan, compliance=np.full(2, np.nan))

    yaws = np.arange(-np.pi, np.pi, _FIRST_YAW_STEP)
    gains = np.array([_gain(total.moments, total.both, yaw) for yaw in yaws])  # (Y, D)
    row, column = np.unravel_index(gains.argmax(), gains.shape)
    delay = int(column)
    moments = total.moments[delay]
    both = total.both[delay]
    yaw = _refined(moments[None], both[None], float(yaws[row]))
    return _Answer(delay=delay, yaw=yaw, compliance=_compliance(moments, both, yaw))


def _added(sums: Sequence[_Sums]) -> _Sums | None:
    """The sums over all recordings; None if no arm moved."""
    if not sums:
        return None
    moments = np.sum([one.moments for one in sums], axis=0)
    both = np.sum([one.both for one in sums], axis=0)
    if not np.einsum("dii->", moments) > _LEAST_MOMENT:
        return None
    return _Sums(moments=moments, both=both)


def _compliance(moments: FloatArray, both: FloatArray, yaw: float) -> FloatArray:
    """Tilt over moment by least squares, for roll and pitch; never negative, (2,).

    Args:
        moments, both: At one delay, (2, 2) each.
        yaw: Of the arm.
    """
    axes = _turn(yaw)
    squares = np.diag(axes @ moments @ axes.T)
    products = np.diag(both @ axes.T)
    return np.asarray(np.maximum(products, 0.0) / squares)


def _stiffness(answer: _Answer) -> FloatArray:
    """The stiffnesses of an answer, (2,)."""
    compliance = answer.compliance
    infinite = np.full(2, np.inf)
    stiffness = np.divide(1.0, compliance, out=infinite, where=compliance != 0)
    return np.asarray(stiffness)


def _gain(moments: FloatArray, both: FloatArray, yaw: float) -> FloatArray:
    """Sum of squares that a turned moment explains at each delay, (D,).

    A negative stiffness explains nothing.
    """
    axes = _turn(yaw)
    size = np.einsum("ij,djk,ik->di", axes, moments, axes)
    along = np.maximum(np.einsum("ij,dij->di", axes, both), 0.0)
    gain = np.divide(along**2, size, out=np.zeros_like(size), where=size > 0)
    return np.asarray(gain.sum(axis=1))


def _refined(moments: FloatArray, both: FloatArray, yaw: float) -> float:
    """The best yaw near one of the grid, by halving the step."""
    step = _FIRST_YAW_STEP
    while step > _YAW_STEP:
        near = [yaw - step, yaw, yaw + step]
        gains = [_gain(moments, both, one).item() for one in near]
        yaw = near[int(np.argmax(gains))]
        step /= 2
    return yaw


def _turn(yaw: float) -> FloatArray:
    """Rotation of a vector in the plane, (2, 2)."""
    cosine = np.cos(yaw)
    sine = np.sin(yaw)
    return np.array([[cosine, -sine], [sine, cosine]])


def _explained(signals: Sequence[_Signal], answers: Sequence[_Answer]) -> FloatArray:
    """Share of the variance that each recording's own answer explains, (2,)."""
    left = np.zeros(2)
    total = np.zeros(2)
    for signal, answer in zip(signals, answers, strict=True):
        turned = signal.moment[answer.delay] @ _turn(answer.yaw).T
        left += ((signal.tilt - turned * answer.compliance) ** 2).sum(axis=0)
        total += (signal.tilt**2).sum(axis=0)
    return _explained_share(left, total)


def _explained_share(left: FloatArray, total: FloatArray) -> FloatArray:
    """Share of total squares that is not left; NaN if nothing is to be explained."""
    share = np.divide(left, total, out=np.full_like(total, np.nan), where=total > 0)
    return np.asarray(1 - share)


def _jackknife(without_each: Sequence[FloatArray]) -> FloatArray:
    """Standard errors from the answers without each recording [Efron1981]_.

    .. [Efron1981] Efron, Stein: The jackknife estimate of variance, Annals of
       Statistics 9(3).
    """
    answers = np.array(without_each)
    count = len(answers)
    if not np.isfinite(answers).all():
        return np.full(answers.shape[1], np.nan)
    deviations = answers - answers.mean(axis=0)
    return np.asarray(np.sqrt((count - 1) / count * (deviations**2).sum(axis=0)))
