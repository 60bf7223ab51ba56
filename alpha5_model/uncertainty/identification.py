"""What a recording says about the printed numbers: bounded least squares inside their intervals.

Unknown are the printed numbers z, scaled so that their intervals are -1 to 1; torques and loads are linear in the
base parameters, and these nearly so in z (products of mass and COM): a few steps of Gauss and Newton. No z leaves
its interval, where every body is possible, so the result is physically consistent by construction. What the
intervals say counts as one more measurement, of the variance 1/3 that a uniform z has; it settles what the data do
not. Noise is taken as white; its size is that of what is left over.

References:
    [Stark1995] Stark, Parker: Bounded-variable least-squares, Computational Statistics 10 (`lsq_linear`).
"""

from __future__ import annotations

from statistics import NormalDist
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray, instance, shaped
from alpha5_model.dynamics import load
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.batch import arm_parameters
from alpha5_model.dynamics.regressor import NAMES, regressor_rows
from alpha5_model.errors import InputError
from alpha5_model.parameters import Alpha5Parameters
from alpha5_model.trajectory import Motion, smooth
from alpha5_model.uncertainty import printed
from alpha5_model.uncertainty.effects import extremes, payload
from alpha5_model.uncertainty.printed import Names

#: Half of a 95 % interval in standard deviations.
_WIDE = NormalDist().inv_cdf(0.975)
_STEPS = 4
#: Noise [N m, N] below which a recording is a computation, and gains that are rounding.
_LEAST, _RANK = 1e-12, 1e-12
#: Standard deviation of a number that is uniform in -1 to 1.
_DEVIATION = 3**-0.5


class Identification(NamedTuple):
    """Base parameters from data; see `alpha5_model.base_parameters` for names and units.

    Attributes:
        names: Of the base parameters, (38,).
        estimate: (38,).
        lower, upper: 95 % intervals, (38,) each, cut to what the printed digits allow.
        covariance: (38, 38).
        supported: Which ones the data know at least twice as well as the printed digits do, (38,) bool; of the
            others they tell little or nothing.
        gains: Of each independent combination of printed numbers, best first: standard deviation by the digits
            over that by the data, (r,); below 1 the digits say more. The first over the last is the condition
            of the data.
        combinations: What one standard deviation by the digits of each is in base parameters, (r, 38).
        noise: Standard deviation of what is left over, for each torque or part of the load [N m, N].
        parameters: The estimate as a parameter set, whose bodies are all possible.
    """

    names: tuple[str, ...]
    estimate: FloatArray
    lower: FloatArray
    upper: FloatArray
    covariance: FloatArray
    supported: Any
    gains: FloatArray
    combinations: FloatArray
    noise: FloatArray
    parameters: Alpha5Parameters


def identify(
    motion: Motion,
    arm: Arm | None = None,
    *,
    wrench: ArrayLike | None = None,
    alternatives: Names = (),
    **smoothing: Any,
) -> Identification:
    """Base parameters that a motion with its efforts, or with the load on the mount, supports.

    Args:
        motion: From `alpha5_model.trajectory`; the jaw rod is left out.
        arm: Fluid, gravity and payload, which is taken as known; None for the bare arm in sea water.
        wrench: Force and moment on the mount in base_link, (N, 6) [N, N m], NaN where there is none. None for
            the motion's efforts.
        alternatives: Names of `alpha5_model.uncertainty.ALTERNATIVES` to believe.
        smoothing: As of `alpha5_model.trajectory.smooth`.

    Raises:
        InputError: A motion without efforts, no wrench either, or arrays that do not fit; an arm on a floating
            base or with jaws that move.
    """
    from scipy.optimize import lsq_linear

    chosen = printed.believed(alternatives)
    arm = load() if arm is None else instance("arm", arm, Arm)
    own, density = arm_parameters(arm), arm.fluid_density
    s = smooth(instance("motion", motion, Motion), **smoothing)
    q, v, a = (np.array(x[:, :4]) for x in (s.position, s.velocity, s.acceleration))
    linear = regressor_rows(q, v, a, own[-3:])
    if wrench is not None:
        linear, y = linear[:, 4:], shaped("wrench", wrench, (len(q), 6))
    elif motion.effort is not None:
        linear, y = linear[:, :4], motion.effort[:, :4]
    else:
        raise InputError("motion", motion.source, "one with recorded efforts, or a wrench")
    known, held = np.isfinite(y), payload(arm)
    middle, half = printed.ends(chosen)
    scaled = np.diag(half)[half * np.abs(printed.link_map(chosen)).any(axis=(1, 2)) > 0]
    free, z, noise = len(scaled), np.zeros(len(scaled)), np.ones(y.shape[1])

    def base(z: FloatArray) -> FloatArray:
        return printed.groups(middle + z @ scaled, chosen, density)

    slope = (base(np.eye(free)) - base(-np.eye(free))) / 2
    for _ in range(_STEPS):
        table = np.concatenate([linear, y[..., None]], axis=-1) / noise[:, None]
        triangle = np.asarray(np.linalg.qr(table[known], mode="r"))
        data = triangle[:, :-1] @ slope.T
        target = triangle[:, -1] - triangle[:, :-1] @ (base(z) + held - z @ slope)
        table = np.vstack([data, np.eye(free) / _DEVIATION])
        target = np.append(target, np.zeros(free))
        z = lsq_linear(table, target, bounds=(-1.0, 1.0), method="bvls").x
        noise = np.sqrt(np.nanmean((y - linear @ (base(z) + held)) ** 2, axis=0)) + _LEAST
    covariance = slope.T @ np.linalg.inv(table.T @ table) @ slope
    _, gains, ways = np.linalg.svd(data * _DEVIATION, full_matrices=False)
    told = gains > gains[0] * _RANK
    wide, found = _WIDE * np.sqrt(np.diag(covariance)), base(z)
    supported = 2 * wide < _WIDE * _DEVIATION * np.linalg.norm(slope, axis=0)
    ends = extremes(np.eye(len(NAMES))[None], True, load(density), chosen)
    lower, upper = np.clip([found - wide, found + wide], *ends)
    values = dict(zip(printed.numbers(chosen), middle + z @ scaled, strict=True))
    best, combinations = printed.parameter_set(values, chosen), _DEVIATION * ways[told] @ slope
    figures = found, lower, upper, covariance, supported, gains[told], combinations, noise
    return Identification(NAMES, *figures, best)
