"""The loop of a PD controller that acts late on an inertia, and its margins.

Opened at the torque, the loop is ``L(s) = (K + D s) exp(-s T) / (M s^2)``. With the
damping ratio zeta and the bandwidth w, ``K = w^2 M`` and ``D = 2 zeta w M``. T is the
time from a position to the torque that answers it. A sampled controller adds a period
to its delay: half of it until the next torque, as the last one is held, and half in a
velocity that is the difference of two positions [Franklin1997].

[Franklin1997] Franklin, Powell, Workman: Digital Control of Dynamic Systems, 1997.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import LARGEST, FloatArray, bounded, together
from alpha5_model.errors import InputError
from alpha5_model.numbers import plausibility

#: Phase margin that gains keep at least [rad]: 45 deg.
LEAST_PHASE = math.pi / 4


class Margins(NamedTuple):
    """Classical margins of a loop, arrays of one shape.

    Attributes:
        crossover: Where the loop's gain is 1 [rad/s].
        phase: Phase margin [rad]; the loop is unstable below 0.
        delay: Further delay that makes it unstable [s]; negative for one that is so.
        gain: Factor of both gains that makes it unstable; infinite without delay, and
            0 for a loop that no factor makes stable.
    """

    crossover: FloatArray
    phase: FloatArray
    delay: FloatArray
    gain: FloatArray


def margins(
    stiffness: ArrayLike, damping: ArrayLike, inertia: ArrayLike, delay: ArrayLike
) -> Margins:
    """Margins of a PD loop on an inertia without friction, which only adds to them.

    Args:
        stiffness: K [N m/rad].
        damping: D [N m s/rad].
        inertia: M, with the rotor's n^2 J [kg m^2].
        delay: From a position to the torque that answers it, with one sample period for
            a sampled controller [s].

    Raises:
        InputError: A stiffness or an inertia not above 0, a damping or delay below 0,
            or a number so large or so small that results overflow.

    Warns:
        ImplausibleWarning: A delay above 10 s.
    """
    K, D, M, T = together(
        stiffness=stiffness, damping=damping, inertia=inertia, delay=delay
    )
    for name, value, strict in (
        ("stiffness", K, True),
        ("damping", D, False),
        ("inertia", M, True),
        ("delay", T, False),
    ):
        if (value < 0).any() or (strict and (value == 0).any()):
            bound = "above 0" if strict else "of at least 0"
            raise InputError(name, float(value.min()), f"numbers {bound}")
        tiny = (value > 0) & (bounded(name, value) < 1 / LARGEST)
        if tiny.any():
            expected = f"numbers of at least {1 / LARGEST:.1e}, else results overflow"
            raise InputError(name, float(value[tiny][0]), expected)

    plausibility.check("delay", T.max(initial=0.0), plausibility.LOOP_DELAY)

    # |L|^2 = 1: M^2 w^4 - D^2 w^2 - K^2 = 0
    square = (D**2 + np.sqrt(D**4 + 4 * (M * K) ** 2)) / (2 * M**2)
    crossover = np.sqrt(square)
    phase = np.arctan2(D * crossover, K) - crossover * T

    lead = D / K
    critical = _phase_crossover(lead, T)
    with np.errstate(divide="ignore", invalid="ignore"):
        at_critical = np.hypot(K, D * critical) / (M * critical**2)
        gain = np.where(np.isinf(critical), np.inf, 1 / at_critical)
    return Margins(
        crossover=crossover,
        phase=phase,
        delay=phase / crossover,
        gain=np.where(critical > 0, gain, 0.0),
    )


def _phase_crossover(lead: FloatArray, delay: FloatArray) -> FloatArray:
    """The w at which ``atan(w lead) = w delay`` [rad/s].

    It is infinite without delay, and 0 if the delay is not below the lead. Bisection:
    in between, the phase falls below -180 deg once, before w delay is 90 deg.
    """
    with np.errstate(divide="ignore"):
        upper = np.where(delay > 0, math.pi / 2 / delay, np.inf)
    finite = np.isfinite(upper) & (lead > delay)
    top = np.where(finite, upper, 0.0)
    lower = top * 1e-12
    for _ in range(100):
        middle = (lower + top) / 2
        leads = np.arctan(middle * lead) > middle * delay
        lower, top = np.where(leads, middle, lower), np.where(leads, top, middle)
    return np.where(np.isinf(upper), np.where(lead > 0, np.inf, 0.0), top * finite)


def fastest_bandwidth(ratio: float, delay: float) -> float:
    """Largest w that keeps `LEAST_PHASE` [rad/s]; infinite without delay.

    The gains ``K = w^2 I`` and ``D = 2 w I`` are those of an inertia I, and act on one
    that is ``ratio`` times smaller. The crossover is then a fixed multiple x of w.
    """
    x = math.sqrt(2 * ratio**2 + math.sqrt(4 * ratio**4 + ratio**2))
    lead = math.atan(2 * x) - LEAST_PHASE
    return lead / (x * delay) if delay else math.inf
