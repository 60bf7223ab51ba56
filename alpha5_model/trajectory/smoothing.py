"""Positions, velocities and accelerations of a motion from noisy samples, with a stated bandwidth.

Differentiating twice multiplies noise by the square of its frequency, so that a recording says
nothing about acceleration until a bandwidth is chosen. Each method states the one it has: the
frequency at which the amplitude of a sine is down to 1/sqrt(2) (-3 dB). None shifts the phase.

``"spline"`` (default)
    Cubic smoothing spline, the minimum of ``integral (y - f)^2 dt + lam * integral f''^2 dt``, with
    the first integral by the trapezoidal rule, so that samples need not be uniform. Its response to
    a sine of angular frequency w is ``1 / (1 + lam w^4)`` [Silverman1984], hence
    ``lam = (sqrt(2) - 1) / w_c^4``. Accelerations are zero at both ends (natural spline).
``"savgol"``
    Savitzky-Golay filter of third degree on a uniform grid of the median sample time, the window
    chosen for the bandwidth by its frequency response; linear interpolation to the grid and back.
``"interpolate"``
    Cubic spline through every sample (not-a-knot): for planned motions; no bandwidth.

References:
    [Reinsch1967] Smoothing by spline functions, Numerische Mathematik 10.
    [Silverman1984] Spline smoothing: the equivalent variable kernel method, Annals of Statistics
        12(3).
    [Schafer2011] What is a Savitzky-Golay filter?, IEEE Signal Processing Magazine 28(4).
"""

from __future__ import annotations

import math
from bisect import bisect_left
from dataclasses import dataclass

import numpy as np

from alpha5_model._support.checks import FloatArray, choice, frozen, real
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import parameters
from alpha5_model.trajectory.motions import Motion

METHODS = ("spline", "savgol", "interpolate")
#: The arm's joints move at 30 deg/s at most; recordings hold values for about 0.1 s.
DEFAULT_BANDWIDTH = 2.0
#: Slower than this share of its rated speed a joint counts as at rest: friction holds the load.
REST_SHARE = 0.002
#: Noise in velocities hides the direction of slow motion; displacement over this time shows it [s].
DIRECTION_WINDOW = 0.5
#: Samples at even times, beyond 100 for each one recorded, that the Savitzky-Golay filter takes.
_MOST_EVEN = 1_000_000
#: Least bandwidth as a share of the sample rate: the condition of the spline's equations grows with
#: its inverse to the fourth power; below this a sine's amplitude is off by more than 0.1 %.
LEAST_BANDWIDTH = 1e-4
_DEGREE = 3
#: Values, first and second derivatives of signals, (N, k) each.
_Fit = tuple[FloatArray, FloatArray, FloatArray]


@dataclass(frozen=True, eq=False)
class SmoothMotion:
    """A motion with its derivatives; rows are samples, columns joints from base to tip.

    Attributes:
        time: (N,) [s].
        joints: Names of the n joints.
        position: (N, n) [rad], jaw rod [m].
        velocity: (N, n) [rad/s].
        acceleration: (N, n) [rad/s^2].
        direction: Direction of motion, (N, n): -1, 0 (at rest) or 1, the sign of the mean velocity
            over `DIRECTION_WINDOW` if there is smoothing, so that noise does not reverse friction.
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
        """Velocities as friction sees them, (N, n): signed by `direction`, zero at rest."""
        return np.asarray(self.direction * np.abs(self.velocity))


def smooth(
    motion: Motion,
    method: str = "spline",
    bandwidth: float = DEFAULT_BANDWIDTH,
    use_velocity: bool | None = None,
) -> SmoothMotion:
    """Smooth positions and their derivatives at the motion's own sample times.

    Args:
        motion: Samples.
        method: One of `METHODS`; see the docstring of this module.
        bandwidth: -3 dB frequency [Hz]; no effect on ``"interpolate"``.
        use_velocity: Take velocities, and accelerations as their derivative, from the velocities of
            the motion in place of its positions; None does so if there are any. Real recordings
            hold each position for about 0.1 s, and the second derivative of that is useless.

    Raises:
        UnknownNameError: No such method.
        InputError: A bandwidth that the samples cannot carry, or no velocities to use.
    """
    choice("smoothing method", method, METHODS)
    signals = motion.position
    if use_velocity is None:
        use_velocity = motion.velocity is not None
    if use_velocity and motion.velocity is not None:
        signals = np.hstack([signals, motion.velocity])
    elif use_velocity:
        raise InputError("use_velocity", True, "False: the motion has no velocities")
    t, joints = motion.time, motion.joints
    if method != "interpolate":
        bandwidth = real("bandwidth", bandwidth, minimum=0.0, strict=True)
        rate = 1 / float(np.median(np.diff(t)))
        if bandwidth >= rate / 2:
            most = f"less than half the sample rate, {rate / 2:.4g} Hz (or method interpolate)"
            hint = ": is the time in seconds?" if rate < 1 else ""
            raise InputError("bandwidth", bandwidth, most + hint)
        if bandwidth < (low := LEAST_BANDWIDTH * rate):
            least = f"at least {LEAST_BANDWIDTH:g} of the sample rate, {low:.4g} Hz"
            raise InputError("bandwidth", bandwidth, least)
    reached: float | None = bandwidth
    if method == "spline":
        value, slope, bend = smoothing_spline(t, signals, bandwidth)
    elif method == "savgol":
        value, slope, bend, reached = savitzky_golay(t, signals, bandwidth)
    else:
        from scipy.interpolate import CubicSpline

        spline, reached = CubicSpline(t, signals), None
        value, slope, bend = signals, spline(t, 1), spline(t, 2)
    n = len(joints)
    velocity, acceleration = (
        (value[:, n:], slope[:, n:]) if use_velocity else (slope, bend)
    )
    mean = slope[:, :n]
    if (
        method != "interpolate"
    ):  # over a window: its sign changes only where the motion reverses
        ends = t - DIRECTION_WINDOW / 2, t + DIRECTION_WINDOW / 2
        early, late = (end.clip(t[0], t[-1]) for end in ends)
        mean = _columns(late, t, motion.position) - _columns(early, t, motion.position)
        mean /= (late - early)[:, None]
    rated = np.array([joint.velocity for joint in parameters().joints[:n]])
    direction = np.where(np.abs(mean) < REST_SHARE * rated, 0.0, np.sign(mean))
    deviation = np.abs(value[:, :n] - motion.position).max(axis=0)
    moving = value[:, :n], velocity, acceleration, direction, deviation
    q, v, a, direction, deviation = map(frozen, moving)
    return SmoothMotion(
        t, joints, q, v, a, direction, method, reached, use_velocity, deviation
    )


def smoothing_spline(time: FloatArray, signals: FloatArray, bandwidth: float) -> _Fit:
    """Cubic smoothing spline of all columns at once, by Reinsch's banded equations.

    The same spline as SciPy's ``make_smoothing_spline`` with the trapezoidal weights, found for the
    second derivatives at the samples instead of for B-spline coefficients: one banded solution
    gives value, slope and second derivative, in a tenth of the time.

    Args:
        time: (N,) [s], increasing.
        signals: (N, k).
        bandwidth: -3 dB frequency [Hz].

    Returns:
        Values, first and second derivatives at the samples, each (N, k).
    """
    from scipy.linalg import solveh_banded

    lam = (math.sqrt(2) - 1) / (2 * math.pi * bandwidth) ** 4
    h = np.diff(time)
    weight = (np.append(h, 0.0) + np.append(0.0, h)) / 2
    # Q^T takes second differences: row j has (below, middle, above) at samples j, j+1, j+2.
    below, above = 1 / h[:-1], 1 / h[1:]
    middle = -below - above
    inverse = lam / weight
    bands = np.zeros((3, h.size - 1))  # upper form of R + lam Q^T W^-1 Q
    bands[2] = (h[:-1] + h[1:]) / 3
    bands[2] += (
        inverse[:-2] * below**2 + inverse[1:-1] * middle**2 + inverse[2:] * above**2
    )
    bands[1, 1:] = inverse[1:-2] * middle[:-1] * below[1:]
    bands[1, 1:] += inverse[2:-1] * above[:-1] * middle[1:]
    bands[1, 1:] += h[1:-1] / 6
    bands[0, 2:] = inverse[2:-2] * above[:-2] * below[2:]
    right = np.diff(np.diff(signals, axis=0) / h[:, None], axis=0)
    bend = np.zeros_like(signals)
    bend[1:-1] = solveh_banded(bands, right, check_finite=False)
    # f = y - lam W^-1 Q f'': the residual is the second difference of the second derivative.
    residual = np.zeros_like(signals)
    residual[:-2] += below[:, None] * bend[1:-1]
    residual[1:-1] += middle[:, None] * bend[1:-1]
    residual[2:] += above[:, None] * bend[1:-1]
    value = signals - inverse[:, None] * residual
    step, rise = h[:, None], np.diff(value, axis=0) / h[:, None]
    slope = np.empty_like(signals)
    slope[:-1] = rise - step / 6 * (2 * bend[:-1] + bend[1:])
    slope[-1] = rise[-1] + step[-1] / 6 * (bend[-2] + 2 * bend[-1])
    return value, slope, bend


def savitzky_golay(
    time: FloatArray, signals: FloatArray, bandwidth: float
) -> tuple[*_Fit, float]:
    """Savitzky-Golay filter of third degree, its window chosen for the bandwidth.

    Returns:
        Values, first and second derivatives at the samples, each (N, k), and the bandwidth that the
        whole number of samples in the window gives [Hz].

    Raises:
        InputError: The bandwidth asks for a window longer than the motion, or below 5 samples; or
            gaps so long that even times in between were too many.
    """
    from scipy.signal import savgol_filter

    dt = float(np.median(np.diff(time)))
    frequency = bandwidth * dt  # in cycles per sample
    # [Schafer2011, eq. 12] is the first guess; the response itself decides, and falls with length.
    guess = ((_DEGREE + 1) / (2 * frequency) + 4.6) / 3.2
    count = float(np.ceil((time[-1] - time[0]) / dt)) + 1
    if count > _MOST_EVEN + 100 * time.size:
        most = f"spline: a gap of the motion takes {count:.3g} samples for even times"
        raise InputError("smoothing", "savgol", most)
    windows = range(2 * max(2, int(0.8 * guess) - 1) + 1, 2 * int(1.2 * guess) + 7, 2)
    at = bisect_left(windows, -frequency, 1, key=lambda window: -_cutoff(window))
    near = {_cutoff(window): window for window in windows[at - 1 : at + 1]}
    reached = min(near, key=lambda cutoff: abs(cutoff - frequency))
    window = near[reached]
    grid = np.arange(time[0], time[-1] + dt, dt)
    if window > grid.size:
        most = (
            f"a window of at most the motion's {grid.size} samples (it takes {window})"
        )
        raise InputError("bandwidth", bandwidth, most)
    even = _columns(grid, time, signals)
    by_order = (
        savgol_filter(even, window, _DEGREE, deriv=k, delta=dt, axis=0)
        for k in range(3)
    )
    value, slope, bend = (_columns(time, grid, even) for even in by_order)
    return value, slope, bend, reached / dt


def _cutoff(window: int) -> float:
    """-3 dB frequency of the Savitzky-Golay filter, cycles per sample."""
    from scipy.optimize import brentq
    from scipy.signal import savgol_coeffs

    half = window // 2
    kernel = savgol_coeffs(window, _DEGREE)[half:]
    k = np.arange(1, half + 1)

    def response(f: float) -> float:
        amplitude = kernel[0] + 2 * np.cos(2 * math.pi * f * k) @ kernel[1:]
        return float(amplitude - math.sqrt(0.5))

    return float(brentq(response, 0.0, 2.0 / window, xtol=1e-15))


def _columns(new: FloatArray, old: FloatArray, signals: FloatArray) -> FloatArray:
    return np.stack([np.interp(new, old, column) for column in signals.T], axis=1)
