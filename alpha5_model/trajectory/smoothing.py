"""Positions, velocities and accelerations from noisy samples, with a stated bandwidth.

Differentiating twice multiplies noise by the square of its frequency, so that a
recording says nothing about acceleration until a bandwidth is chosen: the frequency at
which the amplitude of a sine is down to 1/sqrt(2) (-3 dB). Nothing shifts the phase.

``"spline"`` (default)
    Cubic smoothing spline, the minimum of
    ``integral (y - f)^2 dt + lam * integral f''^2 dt``, with the first integral by the
    trapezoidal rule, so that samples need not be uniform. Its response to a sine of
    angular frequency w is ``1 / (1 + lam w^4)`` [Silverman1984], hence
    ``lam = (sqrt(2) - 1) / w_c^4``. The second derivative of the fitted signal is zero
    at both ends (natural spline): the acceleration if positions are fitted, the jerk if
    velocities are.
``"interpolate"``
    Cubic spline through every sample (not-a-knot): for planned motions; no bandwidth.

References:
    [Silverman1984] Spline smoothing: the equivalent variable kernel method, Annals of
        Statistics 12(3).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray, choice, frozen, real
from alpha5_model._support.text import short_repr
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm
from alpha5_model.trajectory.checks import MINIMUM_SAMPLES, jumps
from alpha5_model.trajectory.motions import Motion

METHODS = ("spline", "interpolate")
#: The arm's joints move at 30 deg/s at most; recordings hold values for about 0.1 s.
DEFAULT_BANDWIDTH = 2.0
#: A joint that is slower than this share of its rated speed counts as at rest: friction
#: holds the load.
REST_SHARE = 0.002
#: Noise in velocities hides the direction of slow motion; displacement over this time
#: shows it [s].
DIRECTION_WINDOW = 0.5
#: Least bandwidth as a share of the sample rate: the condition of the spline's
#: equations grows with its inverse to the fourth power; below this a sine's amplitude
#: is off by more than 0.1 %.
LEAST_BANDWIDTH = 1e-4


@dataclass(frozen=True, eq=False)
class SmoothMotion:
    """A motion with its derivatives; rows are samples, columns joints from base to tip.

    Attributes:
        time: (N,) [s].
        joints: Names of the n joints.
        position: (N, n) [rad], jaw rod [m].
        velocity: (N, n) [rad/s].
        acceleration: (N, n) [rad/s^2].
        direction: Direction of motion, (N, n): -1, 0 (at rest) or 1. With smoothing it
            is the sign of the mean velocity over `DIRECTION_WINDOW`, so that noise does
            not reverse friction.
        method: One of `METHODS`.
        bandwidth: -3 dB frequency [Hz]; None for ``"interpolate"``.
        from_velocity: Velocities and accelerations come from the motion's velocities.
        deviation: Largest distance of the samples from the smooth position, (n,) [rad].
    """

    time: FloatArray
    joints: tuple[str, ...]
    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    direction: FloatArray
    method: str
    bandwidth: float | None
    from_velocity: bool
    deviation: FloatArray

    __repr__ = short_repr

    @property
    def signed_velocity(self) -> FloatArray:
        """Velocities as friction sees them, (N, n): signed by `direction`."""
        return np.asarray(self.direction * np.abs(self.velocity))


def smooth(
    motion: Motion,
    method: str = "spline",
    bandwidth: float = DEFAULT_BANDWIDTH,
    use_velocity: bool | None = None,
    arm: Alpha5Parameters | None = None,
) -> SmoothMotion:
    """Smooth positions and their derivatives at the motion's own sample times.

    Args:
        motion: Samples.
        method: ``spline``, or ``interpolate`` for motions without noise.
        bandwidth: -3 dB frequency [Hz]; no effect on ``"interpolate"``.
        use_velocity: Compute velocities and accelerations from the velocities of the
            motion instead of its positions; None does so if there are any (`analyse`:
            if they agree with the positions). Recordings hold each position for about
            0.1 s, which makes its second derivative useless.
        arm: Record of an arm of your own, for its rated speeds, below which a joint is
            at rest; None for the catalogue's.

    Raises:
        UnknownNameError: No such method.
        InputError: A bandwidth that the samples cannot carry, or no velocities to use.
    """
    return smooth_for(chosen_arm(arm), motion, method, bandwidth, use_velocity)


def smooth_for(
    parameters: Alpha5Parameters,
    motion: Motion,
    method: str = "spline",
    bandwidth: float = DEFAULT_BANDWIDTH,
    use_velocity: bool | None = None,
) -> SmoothMotion:
    """`smooth` for the rated speeds of any arm, below which a joint is at rest."""
    choice("smoothing method", method, METHODS)
    if use_velocity is None:
        use_velocity = motion.velocity is not None
    signals = motion.position
    if use_velocity:
        if motion.velocity is None:
            expected = "False: the motion has no velocities"
            raise InputError("use_velocity", True, expected)
        signals = np.hstack([motion.position, motion.velocity])
    width: float | None = None
    if method == "spline":
        width = _checked_bandwidth(bandwidth, motion.time)
    pieces = pieces_of(parameters, motion)
    fits = [_fitted(motion.time[x], signals[x], width) for x in pieces]
    value, slope, curvature = (np.concatenate(x) for x in zip(*fits, strict=True))

    n = len(motion.joints)
    position = value[:, :n]
    velocity = value[:, n:] if use_velocity else slope
    acceleration = slope[:, n:] if use_velocity else curvature
    if method == "interpolate":
        mean_velocity = slope[:, :n]
    else:
        mean_velocity = np.concatenate(
            [
                mean_slope(motion.time[x], motion.position[x], DIRECTION_WINDOW)
                for x in pieces
            ]
        )
    rated = np.array([joint.velocity for joint in parameters.joints[:n]])
    at_rest = np.abs(mean_velocity) < REST_SHARE * rated
    return SmoothMotion(
        time=motion.time,
        joints=motion.joints,
        position=frozen(position),
        velocity=frozen(velocity),
        acceleration=frozen(acceleration),
        direction=frozen(np.where(at_rest, 0.0, np.sign(mean_velocity))),
        method=method,
        bandwidth=width,
        from_velocity=use_velocity,
        deviation=frozen(np.abs(position - motion.position).max(axis=0)),
    )


def _fitted(
    time: FloatArray, signals: FloatArray, bandwidth: float | None
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Signals and their first two derivatives, (N, k) each.

    Args:
        time: (N,) [s].
        signals: (N, k).
        bandwidth: -3 dB frequency of a smoothing spline [Hz]; None for a spline
            through every sample.
    """
    from scipy.interpolate import CubicSpline, make_smoothing_spline

    t = time - time[0]  # times since 1970 would cost digits
    if bandwidth is None:
        spline: Any = CubicSpline(t, signals)
        return signals, spline(t, 1), spline(t, 2)
    steps = np.diff(t)
    weights = (np.append(steps, 0.0) + np.append(0.0, steps)) / 2
    lam = (math.sqrt(2) - 1) / (2 * math.pi * bandwidth) ** 4
    spline = make_smoothing_spline(t, signals, w=weights, lam=lam)
    return spline(t), spline(t, 1), spline(t, 2)


def _checked_bandwidth(bandwidth: float, time: FloatArray) -> float:
    """A bandwidth that the samples can carry [Hz].

    Raises:
        InputError: It is not positive, or too high or too low for the sample rate.
    """
    wanted = real("bandwidth", bandwidth, minimum=0.0, strict=True)
    rate = 1 / float(np.median(np.diff(time)))
    if wanted >= rate / 2:
        most = f"less than half the sample rate, {rate / 2:.4g} Hz"
        hint = ": is the time in seconds?" if rate < 1 else ""
        expected = f"{most} (or method interpolate){hint}"
        raise InputError("bandwidth", wanted, expected)

    lowest = LEAST_BANDWIDTH * rate
    if wanted < lowest:
        least = f"at least {LEAST_BANDWIDTH:g} of the sample rate, {lowest:.4g} Hz"
        doubt = f" ({rate:.4g} samples/s: is the unit of the time right?)"
        expected = least + (doubt if rate > 1e4 else "")
        raise InputError("bandwidth", wanted, expected)
    return wanted


def pieces_of(parameters: Alpha5Parameters, motion: Motion) -> list[slice]:
    """The motion between jumps: no joint moves so, and no torque makes it.

    Jumps that leave fewer samples than a piece needs do not count.
    """
    jump = np.zeros(motion.time.size - 1, dtype=bool)
    for k, limits in enumerate(parameters.joints[: len(motion.joints)]):
        jump |= jumps(motion.time, motion.position[:, k], limits)
    pieces = []
    start = 0
    for end in (np.flatnonzero(jump) + 1).tolist():
        enough = min(end - start, motion.time.size - end) >= MINIMUM_SAMPLES
        if enough:
            pieces.append(slice(start, end))
            start = end
    return [*pieces, slice(start, motion.time.size)]


def mean_slope(time: FloatArray, signals: FloatArray, window: float) -> FloatArray:
    """Mean slopes over a window around each sample, (N, k).

    Unlike noisy velocities, they change sign only if the motion reverses.

    Args:
        time: (N,) [s].
        signals: (N, k).
        window: Its length [s]; it is shorter at both ends of the motion.
    """
    early = np.maximum(time - window / 2, time[0])
    late = np.minimum(time + window / 2, time[-1])
    rise = [np.interp(late, time, x) - np.interp(early, time, x) for x in signals.T]
    return np.asarray(np.stack(rise, axis=1) / (late - early)[:, None])
