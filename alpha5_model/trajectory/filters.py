"""Filters of noisy samples that also give derivatives.

`alpha5_model.trajectory.smoothing` describes the methods and names the references.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.errors import InputError

#: Degree of the polynomials of the Savitzky-Golay filter.
_DEGREE = 3
#: Its shortest window, in samples.
_SHORTEST = 5
#: Most samples on the uniform grid of the Savitzky-Golay filter, besides 100 for each
#: recorded sample.
_MOST_EVEN = 1_000_000


class Fit(NamedTuple):
    """Smooth signals and their derivatives at the samples, one signal a column.

    Attributes:
        value: (N, k).
        slope: First derivatives, (N, k).
        curvature: Second derivatives, (N, k).
    """

    value: FloatArray
    slope: FloatArray
    curvature: FloatArray


class _SecondDifferences(NamedTuple):
    """The matrix Q^T of [Reinsch1967]: row j takes samples j, j + 1 and j + 2.

    Attributes:
        below, middle, above: (N - 2,) The factors of the three samples.
    """

    below: FloatArray
    middle: FloatArray
    above: FloatArray


def interpolating_spline(time: FloatArray, signals: FloatArray) -> Fit:
    """Cubic spline through every sample (not-a-knot).

    Args:
        time: (N,) [s], increasing.
        signals: (N, k).
    """
    from scipy.interpolate import CubicSpline

    spline = CubicSpline(time, signals)
    return Fit(value=signals, slope=spline(time, 1), curvature=spline(time, 2))


def smoothing_spline(time: FloatArray, signals: FloatArray, bandwidth: float) -> Fit:
    """Cubic smoothing spline of all columns at once, by Reinsch's banded equations.

    It is the spline of SciPy's ``make_smoothing_spline`` with the trapezoidal weights.
    The unknowns are the second derivatives at the samples instead of B-spline
    coefficients: one banded solution gives value, slope and second derivative, in a
    tenth of the time.

    Args:
        time: (N,) [s], increasing.
        signals: (N, k).
        bandwidth: -3 dB frequency [Hz].
    """
    from scipy.linalg import solveh_banded

    lam = (math.sqrt(2) - 1) / (2 * math.pi * bandwidth) ** 4
    h = np.diff(time)
    weight = (np.append(h, 0.0) + np.append(0.0, h)) / 2
    lam_over_weight = lam / weight
    differences = _second_differences(h)

    bands = _reinsch_bands(h, differences, lam_over_weight)
    right = np.diff(np.diff(signals, axis=0) / h[:, None], axis=0)
    curvature = np.zeros_like(signals)
    curvature[1:-1] = solveh_banded(bands, right, check_finite=False)

    # f = y - lam W^-1 Q f''
    residual = _transposed_product(differences, curvature)
    value = signals - lam_over_weight[:, None] * residual
    return Fit(
        value=value,
        slope=_spline_slope(h, value, curvature),
        curvature=curvature,
    )


def _second_differences(h: FloatArray) -> _SecondDifferences:
    """Q^T for the steps of time h, (N - 1,)."""
    below = 1 / h[:-1]
    above = 1 / h[1:]
    return _SecondDifferences(below=below, middle=-below - above, above=above)


def _reinsch_bands(
    h: FloatArray, differences: _SecondDifferences, lam_over_weight: FloatArray
) -> FloatArray:
    """R + lam Q^T W^-1 Q, (3, N - 2), in the upper form of ``solveh_banded``.

    Args:
        h: (N - 1,) Steps of time.
        differences: Q^T.
        lam_over_weight: (N,) The diagonal of lam W^-1.
    """
    below, middle, above = differences
    s = lam_over_weight

    diagonal = (h[:-1] + h[1:]) / 3
    diagonal += s[:-2] * below**2 + s[1:-1] * middle**2 + s[2:] * above**2

    first_above = s[1:-2] * middle[:-1] * below[1:]
    first_above += s[2:-1] * above[:-1] * middle[1:]
    first_above += h[1:-1] / 6

    second_above = s[2:-2] * above[:-2] * below[2:]

    bands = np.zeros((3, h.size - 1))
    bands[2] = diagonal
    bands[1, 1:] = first_above
    bands[0, 2:] = second_above
    return bands


def _transposed_product(
    differences: _SecondDifferences, curvature: FloatArray
) -> FloatArray:
    """Q f'': second differences of the second derivatives, (N, k)."""
    inner = curvature[1:-1]
    product = np.zeros_like(curvature)
    product[:-2] += differences.below[:, None] * inner
    product[1:-1] += differences.middle[:, None] * inner
    product[2:] += differences.above[:, None] * inner
    return product


def _spline_slope(
    h: FloatArray, value: FloatArray, curvature: FloatArray
) -> FloatArray:
    """First derivatives at the samples of a cubic spline, (N, k)."""
    step = h[:, None]
    rise = np.diff(value, axis=0) / step
    slope = np.empty_like(value)
    slope[:-1] = rise - step / 6 * (2 * curvature[:-1] + curvature[1:])
    slope[-1] = rise[-1] + step[-1] / 6 * (curvature[-2] + 2 * curvature[-1])
    return slope


def savitzky_golay(
    time: FloatArray, signals: FloatArray, bandwidth: float
) -> tuple[FloatArray, FloatArray, FloatArray, float]:
    """Savitzky-Golay filter of third degree, its window chosen for the bandwidth.

    Args:
        time: (N,) [s], increasing.
        signals: (N, k).
        bandwidth: -3 dB frequency [Hz].

    Returns:
        Values, first and second derivatives at the samples, each (N, k), and the
        bandwidth that the whole number of samples in the window gives [Hz].

    Raises:
        InputError: The bandwidth needs a window longer than the motion, or shorter than
            5 samples; or the gaps would take too many samples on a uniform grid.
    """
    from scipy.signal import savgol_filter

    dt = float(np.median(np.diff(time)))
    _check_even_samples(time, dt)
    window, reached = _window(bandwidth * dt)
    grid = np.arange(time[0], time[-1] + dt, dt)
    if window > grid.size:
        most = f"at most the motion's {grid.size} samples (it takes {window})"
        raise InputError("bandwidth", bandwidth, f"a window of {most}")

    even = resampled(grid, time, signals)
    derivatives = []
    for order in range(3):
        at_even_times = savgol_filter(
            even, window, _DEGREE, deriv=order, delta=dt, axis=0
        )
        derivatives.append(resampled(time, grid, at_even_times))
    value, slope, curvature = derivatives
    return value, slope, curvature, reached / dt


def _check_even_samples(time: FloatArray, dt: float) -> None:
    """Refuse gaps that would take too many samples on the uniform grid."""
    count = float(np.ceil((time[-1] - time[0]) / dt)) + 1
    if count > _MOST_EVEN + 100 * time.size:
        most = f"spline: a gap of the motion takes {count:.3g} samples for even times"
        raise InputError("smoothing", "savgol", most)


def _window(frequency: float) -> tuple[int, float]:
    """The window of the Savitzky-Golay filter in samples, and its -3 dB frequency.

    It is the window whose -3 dB frequency is nearest to the one that is asked for.

    Args:
        frequency: -3 dB frequency [cycles per sample].
    """
    # The frequency falls with the length of the window.
    longest = _SHORTEST
    while _cutoff(longest) > frequency:
        longest = 2 * longest + 1
    windows = range(_SHORTEST, longest + 1, 2)
    at = bisect_left(windows, -frequency, 1, key=lambda window: -_cutoff(window))
    near = {window: _cutoff(window) for window in windows[at - 1 : at + 1]}
    best = min(near, key=lambda window: abs(near[window] - frequency))
    return best, near[best]


def _cutoff(window: int) -> float:
    """-3 dB frequency of the Savitzky-Golay filter [cycles per sample]."""
    from scipy.optimize import brentq
    from scipy.signal import savgol_coeffs

    half = window // 2
    kernel = savgol_coeffs(window, _DEGREE)[half:]
    k = np.arange(1, half + 1)

    def above_cutoff(frequency: float) -> float:
        cosines = np.cos(2 * math.pi * frequency * k)
        amplitude = kernel[0] + 2 * cosines @ kernel[1:]
        return float(amplitude - math.sqrt(0.5))

    return float(brentq(above_cutoff, 0.0, 0.5, xtol=1e-15))


def resampled(new: FloatArray, old: FloatArray, signals: FloatArray) -> FloatArray:
    """Signals at new times, interpolated linearly, one signal a column."""
    columns = [np.interp(new, old, column) for column in signals.T]
    return np.stack(columns, axis=1)
