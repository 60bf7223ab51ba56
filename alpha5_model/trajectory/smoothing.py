"""Positions, velocities and accelerations from noisy samples, with a stated bandwidth.

Differentiating twice multiplies noise by the square of its frequency, so that a
recording says nothing about acceleration until a bandwidth is chosen. Each method
states its bandwidth: the frequency at which the amplitude of a sine is down to
1/sqrt(2) (-3 dB). No method shifts the phase. `alpha5_model.trajectory.filters` has the
filters.

``"spline"`` (default)
    Cubic smoothing spline, the minimum of
    ``integral (y - f)^2 dt + lam * integral f''^2 dt``, with the first integral by the
    trapezoidal rule, so that samples need not be uniform. Its response to a sine of
    angular frequency w is ``1 / (1 + lam w^4)`` [Silverman1984], hence
    ``lam = (sqrt(2) - 1) / w_c^4``. The second derivative of the fitted signal is zero
    at both ends (natural spline): the acceleration if positions are fitted, the jerk if
    velocities are.
``"savgol"``
    Savitzky-Golay filter of third degree on a uniform grid of the median sample time,
    the window chosen for the bandwidth by its frequency response [Schafer2011]; linear
    interpolation to the grid and back.
``"interpolate"``
    Cubic spline through every sample (not-a-knot): for planned motions; no bandwidth.

References:
    [Reinsch1967] Smoothing by spline functions, Numerische Mathematik 10.
    [Silverman1984] Spline smoothing: the equivalent variable kernel method, Annals of
        Statistics 12(3).
    [Schafer2011] What is a Savitzky-Golay filter?, IEEE Signal Processing Magazine
        28(4).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from alpha5_model._support.checks import FloatArray, choice, frozen, real
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm
from alpha5_model.trajectory.checks import MINIMUM_SAMPLES, jumps
from alpha5_model.trajectory.filters import (
    Fit,
    interpolating_spline,
    resampled,
    savitzky_golay,
    smoothing_spline,
)
from alpha5_model.trajectory.motions import Motion

METHODS = ("spline", "savgol", "interpolate")
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
        method: ``spline``, ``savgol`` (Savitzky-Golay), or ``interpolate`` for motions
            without noise.
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
    pieces = _pieces(parameters, motion)
    fits = [
        _fitted(motion.time[piece], signals[piece], method, bandwidth)
        for piece in pieces
    ]
    reached = fits[0][1]
    value = np.concatenate([fit.value for fit, _ in fits])
    slope = np.concatenate([fit.slope for fit, _ in fits])
    curvature = np.concatenate([fit.curvature for fit, _ in fits])

    n = len(motion.joints)
    position = value[:, :n]
    velocity = value[:, n:] if use_velocity else slope
    acceleration = slope[:, n:] if use_velocity else curvature
    if method == "interpolate":
        mean_velocity = slope[:, :n]
    else:
        mean_velocity = np.concatenate(
            [_mean_velocity(motion.time[x], motion.position[x]) for x in pieces]
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
        bandwidth=reached,
        from_velocity=use_velocity,
        deviation=frozen(np.abs(position - motion.position).max(axis=0)),
    )


def _fitted(
    time: FloatArray, signals: FloatArray, method: str, bandwidth: float
) -> tuple[Fit, float | None]:
    """The signals as a method smooths them, and the bandwidth that it reaches [Hz]."""
    if method == "interpolate":
        return interpolating_spline(time, signals), None

    wanted = _checked_bandwidth(bandwidth, time)
    if method == "spline":
        return smoothing_spline(time, signals, wanted), wanted

    value, slope, curvature, reached = savitzky_golay(time, signals, wanted)
    return Fit(value=value, slope=slope, curvature=curvature), reached


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
        raise InputError("bandwidth", wanted, least)
    return wanted


def _pieces(parameters: Alpha5Parameters, motion: Motion) -> list[slice]:
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


def _mean_velocity(time: FloatArray, position: FloatArray) -> FloatArray:
    """Mean velocities over `DIRECTION_WINDOW` around each sample, (N, n).

    Unlike the noisy velocity, they change sign only if the motion reverses.
    """
    half = DIRECTION_WINDOW / 2
    early = np.maximum(time - half, time[0])
    late = np.minimum(time + half, time[-1])
    displacement = resampled(late, time, position)
    displacement -= resampled(early, time, position)
    return np.asarray(displacement / (late - early)[:, None])
