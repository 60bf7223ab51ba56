"""What the printed digits leave open in torques and loads, and what recordings tell of them."""

from __future__ import annotations

from collections.abc import Callable
from statistics import NormalDist
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    FloatArray,
    count,
    float_array,
    instance,
    shaped,
)
from alpha5_model.codegen.base_parameters import base_parameters
from alpha5_model.dynamics.actuators import Interval
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.dimensions import check_dimensions
from alpha5_model.dynamics.kernel_numbers import arm_parameters
from alpha5_model.dynamics.load import arm_of as arm
from alpha5_model.dynamics.load import load
from alpha5_model.dynamics.regression import NAMES, regressor_rows
from alpha5_model.dynamics.states import is_one_state, rows
from alpha5_model.errors import InputError
from alpha5_model.numbers.fluids import SEA_WATER
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters
from alpha5_model.studies.uncertainty import printed
from alpha5_model.studies.uncertainty.printed import (
    ALTERNATIVES,
    Names,
    PrintedNumber,
    Sample,
    sample,
)
from alpha5_model.trajectory import Motion, smooth

__all__ = [
    "ALTERNATIVES",
    "Bounds",
    "Identification",
    "PrintedNumber",
    "Sample",
    "Sensitivity",
]
__all__ += ["Spread", "arm", "bounds", "identify", "printed_numbers", "reach", "sample"]
__all__ += ["sensitivity", "spread", "torque_bounds"]

#: A result of a parameter set: a number or an array.
Result = Callable[[Alpha5Parameters], ArrayLike]
#: Half of a 95 % interval in standard deviations.
_WIDE = NormalDist().inv_cdf(0.975)
#: Noise [N m, N] below which a recording is a computation, and gains that are rounding.
_LEAST, _RANK = 1e-12, 1e-12
#: Standard deviation of a number that is uniform in -1 to 1.
_DEVIATION = 3**-0.5


def printed_numbers(alternatives: Names = ()) -> dict[str, PrintedNumber]:
    """Every number of Tables 1 to 4 by its name, with the interval that its digits allow.

    Args:
        alternatives: Names of `ALTERNATIVES` to believe.

    Raises:
        UnknownNameError: An alternative that is not recorded.
    """
    return dict(printed.numbers(printed.believed(alternatives)))


class Bounds(NamedTuple):
    """Lower and upper ends; without N for one state.

    Attributes:
        torque: Of the joints, (N, 4) [N m].
        base_wrench: Force and moment on the mount in base_link, (N, 6) [N, N m].
        kinetic_energy: (N,) [J].
        potential_energy: Of weight and buoyancy, (N,) [J].
    """

    torque: Interval
    base_wrench: Interval
    kinetic_energy: Interval
    potential_energy: Interval


def bounds(
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    arm: Arm | None = None,
    alternatives: Names = (),
) -> Bounds:
    """What no numbers that round to the printed ones can pass, for a motion of the arm on a fixed base.

    Args:
        q, v, a: (4,) each, or (N, 4), where one row is used for all states.
        arm: Fluid, gravity and payload, which is taken as known; None for the bare arm in sea water.
        alternatives: Names of `ALTERNATIVES` to believe.

    Raises:
        InputError: As of `Arm.inverse_dynamics_batch`, or an arm on a floating base or with jaws that move.
        UnknownNameError: An alternative that is not recorded.
    """
    arm = load() if arm is None else instance("arm", arm, Arm)
    one = is_one_state(q, v, a)
    gravity = arm_parameters(arm)[-3:]
    q, v, a = rows(arm._model, q=q, v=v, a=a)
    still = np.zeros_like(v)
    linear = regressor_rows(q, v, a, gravity)
    # The kinetic energy is half of what v takes as an acceleration from rest.
    torque = regressor_rows(q, still, v, np.zeros(3))[:, :4]
    kinetic = (v[:, :, None] * torque).sum(axis=1) / 2
    # Moments of weights, sums of r x n g, for two directions of g have all of the sum of n r.
    x, y = (regressor_rows(q, still, still, g)[:, 7:] for g in np.eye(3)[:2])
    potential = -np.tensordot(gravity, [y[:, 2], -x[:, 2], x[:, 1]], 1)
    every = linear[:, :4], linear[:, 4:], kinetic, potential
    return Bounds(
        *(extremes(part, one, arm, printed.believed(alternatives)) for part in every)
    )


def torque_bounds(
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    fluid_density: float = SEA_WATER,
    **options: Any,
) -> Interval:
    """The torques of `bounds`, ``(lower, upper)``, (4,) each or (N, 4) [N m]; its options, and a fluid [kg/m^3]."""
    return bounds(q, v, a, **{"arm": load(fluid_density), **options}).torque


def torque_margin(arm: Arm, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> FloatArray:
    """How far the digits move the torques of any arm on a fixed base, lowest and highest, (2, nv) or (2, N, nv).

    Payload, moving water and the jaws, which are taken out of link 4, are as known.

    Raises:
        InputError: An arm with other dimensions than the catalogue's, whose digits they are.
    """
    check_dimensions(arm._model, "the margin of the printed digits")
    bare = load(arm.fluid_density, gravity=arm.model.gravity.linear)
    out = np.zeros((2, *np.shape(q)))
    q, v, a = (np.asarray(x)[..., :4] for x in (q, v, a))
    nominal = bare.inverse_dynamics_batch(q, v, a)
    out[..., :4] = np.array(bounds(q, v, a, bare).torque) - nominal.reshape(q.shape)
    return out


def extremes(
    linear: FloatArray, one: bool, arm: Arm, alternatives: tuple[str, ...]
) -> Interval:
    """Of quantities that are linear in the base parameters, rows (N, ..., 38): (N, ...), (...) of one state."""
    density, to_links = arm.fluid_density, printed.link_map(alternatives)
    middle, half = printed.ends(alternatives)
    link, width = (
        np.tensordot(middle, to_links, 1),
        np.tensordot(half, np.abs(to_links), 1),
    )
    w = np.tensordot(linear, printed.grouping(density), (-1, -1))  # (N, ..., 5, 14)
    # m s: of m, and s by its slope at the middle COM and what is of second degree from there on.
    com, box = link[:, 1:4], width[:, 1:4]
    curve = w[..., 4 + printed.SYMMETRIC] * (np.eye(3) + 1)
    bent = (curve * com[:, None]).sum(axis=-1)
    s = w[..., 0] + ((w[..., 1:4] + bent / 2) * com).sum(axis=-1)
    slope = np.abs(w[..., 1:4] + bent) + (np.abs(curve) * box[:, None]).sum(axis=-1) / 2
    ds = (slope * box).sum(axis=-1)
    lift = w[..., 10] + (w[..., 11:] * link[:, 11:]).sum(axis=-1)
    dlift = (np.abs(w[..., 11:]) * width[:, 11:]).sum(axis=-1)
    # Digits of the tensor, each of which is in several second moments.
    tensor = np.tensordot(w[..., 4:10], to_links[:, :, 4:10], ((-2, -1), (1, 2)))
    digits = np.tensordot(tensor, middle, 1) + np.multiply.outer(
        (-1, 1), np.abs(tensor) @ half
    )
    weight = _product(link[:, 0], width[:, 0], s, ds).sum(axis=-1)
    parts = (
        weight,
        digits,
        _product(link[:, 10], width[:, 10], lift, dlift).sum(axis=-1),
    )
    slack = 1e-14 * np.abs(parts).sum(
        axis=(0, 1)
    )  # what the rounding of doubles may hide
    if (
        slack.ndim > 1
    ):  # what is nothing for one joint is the rounding of another's torque
        slack = slack.max(axis=1, keepdims=True)
    total = np.sum(parts, axis=0) + linear @ payload(arm) + np.array([-slack, slack])
    return Interval(*(total[:, 0] if one else total))


def payload(arm: Arm) -> FloatArray:
    """What an arm's base parameters have beyond those of the bare arm, (38,)."""
    catalogue = parameters()
    bare = base_parameters(catalogue.links, arm.fluid_density, parameters=catalogue)
    return (arm_parameters(arm) - bare)[:-3]


def _product(
    x: FloatArray, dx: FloatArray, y: FloatArray, dy: FloatArray
) -> FloatArray:
    """Lowest and highest of (x +- dx) (y +- dy), (2, ...)."""
    corners = [(x + i * dx) * (y + j * dy) for i in (-1, 1) for j in (-1, 1)]
    return np.array([np.min(corners, axis=0), np.max(corners, axis=0)])


class Sensitivity(NamedTuple):
    """What each printed number does to a result, first order.

    Attributes:
        names: Of the printed numbers, (K,).
        nominal: The result at the middle of all intervals, (...).
        effects: Half of what it changes from the lower to the upper end of each interval, (K, ...).
    """

    names: tuple[str, ...]
    nominal: FloatArray
    effects: FloatArray

    @property
    def half_width(self) -> FloatArray:
        """All effects together at their worst, (...)."""
        return np.asarray(np.abs(self.effects).sum(axis=0))

    def most(self, *index: int, count: int = 5) -> tuple[tuple[str, float], ...]:
        """The numbers that matter most, with their effects on ``nominal[index]``."""
        effects = np.moveaxis(self.effects, 0, -1)[index]
        order = np.argsort(-np.abs(effects), kind="stable")[:count]
        return tuple((self.names[k], float(effects[k])) for k in order)


def sensitivity(result: Result, alternatives: Names = ()) -> Sensitivity:
    """Which printed digits a result hangs on.

    Args:
        result: From a parameter set to a number or an array, such as
            ``lambda p: arm(p).hydrostatic_torque(q)``.
        alternatives: Names of `ALTERNATIVES` to believe.

    Raises:
        InputError: A result that is not finite numbers.
    """
    chosen = printed.believed(alternatives)
    intervals = printed.numbers(chosen)
    # The printed numbers stand by themselves.
    middle = {name: x.value for name, x in intervals.items() if x.value != x.printed.si}

    def at(values: dict[str, float]) -> FloatArray:
        return float_array(
            "result", result(printed.parameter_set(middle | values, chosen)), ()
        )

    effects = [(at({k: x.upper}) - at({k: x.lower})) / 2 for k, x in intervals.items()]
    return Sensitivity(tuple(intervals), at({}), np.array(effects))


class Spread(NamedTuple):
    """Mean and standard deviation of a sampled result, (...) each, and the standard error of the mean."""

    mean: FloatArray
    standard_deviation: FloatArray
    standard_error: FloatArray


def spread(result: Result, n: int = 1000, seed: int = 0, **options: Any) -> Spread:
    """What `sample` (n, seed, options) leaves of a result as `sensitivity` takes it."""
    if count("n", n) < 2:
        raise InputError("n", n, "at least 2 sets")
    drawn = sample(n, seed, **options)
    found = np.array(
        [float_array("result", result(drawn.parameters(k)), ()) for k in range(n)]
    )
    deviation = found.std(axis=0, ddof=1)
    return Spread(found.mean(axis=0), deviation, deviation / np.sqrt(n))


class Identification(NamedTuple):
    """Base parameters from data; see `alpha5_model.codegen.base_parameters` for names and units.

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

    Unknown are the printed numbers, scaled so that their intervals are -1 to 1; torques and loads are linear in
    the base parameters, and these nearly so in the numbers: a few steps of Gauss and Newton. No number leaves its
    interval, where every body is possible, so the result is physically consistent by construction. What the
    intervals say counts as one more measurement, of the variance 1/3 of a uniform number; it settles what the
    data do not. Noise is taken as white; its size is that of what is left over.

    Args:
        motion: From `alpha5_model.trajectory`; the jaw rod is left out.
        arm: Fluid, gravity and payload, which is taken as known; None for the bare arm in sea water.
        wrench: Force and moment on the mount in base_link, (N, 6) [N, N m]; None for the motion's efforts.
        alternatives: Names of `ALTERNATIVES` to believe.
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
        raise InputError(
            "motion", motion.source, "one with recorded efforts, or a wrench"
        )
    known, held = np.isfinite(y), payload(arm)
    middle, half = printed.ends(chosen)
    scaled = np.diag(half)[half * np.abs(printed.link_map(chosen)).any(axis=(1, 2)) > 0]
    free, z, noise = len(scaled), np.zeros(len(scaled)), np.ones(y.shape[1])

    def base(z: FloatArray) -> FloatArray:
        return printed.groups(middle + z @ scaled, chosen, density)

    slope = (base(np.eye(free)) - base(-np.eye(free))) / 2
    for _ in range(4):
        table = np.concatenate([linear, y[..., None]], axis=-1) / noise[:, None]
        triangle = np.asarray(np.linalg.qr(table[known], mode="r"))
        data = triangle[:, :-1] @ slope.T
        target = triangle[:, -1] - triangle[:, :-1] @ (base(z) + held - z @ slope)
        table = np.vstack([data, np.eye(free) / _DEVIATION])
        target = np.append(target, np.zeros(free))
        z = lsq_linear(table, target, bounds=(-1.0, 1.0), method="bvls").x
        noise = (
            np.sqrt(np.nanmean((y - linear @ (base(z) + held)) ** 2, axis=0)) + _LEAST
        )
    covariance = slope.T @ np.linalg.inv(table.T @ table) @ slope
    _, gains, ways = np.linalg.svd(data * _DEVIATION, full_matrices=False)
    told = gains > gains[0] * _RANK
    wide, found = _WIDE * np.sqrt(np.diag(covariance)), base(z)
    supported = 2 * wide < _WIDE * _DEVIATION * np.linalg.norm(slope, axis=0)
    ends = extremes(np.eye(len(NAMES))[None], True, load(density), chosen)
    lower, upper = np.clip([found - wide, found + wide], *ends)
    values = dict(zip(printed.numbers(chosen), middle + z @ scaled, strict=True))
    best, combinations = (
        printed.parameter_set(values, chosen),
        _DEVIATION * ways[told] @ slope,
    )
    figures = (
        found,
        lower,
        upper,
        covariance,
        supported,
        gains[told],
        combinations,
        noise,
    )
    return Identification(NAMES, *figures, best)


def reach(parameters: Alpha5Parameters) -> float:
    """Farthest that the tcp gets from the shoulder without limits, ``a_1 + hypot(a_2, d_3)`` [m]."""
    dh = parameters.dh
    return dh[1].a + float(np.hypot(dh[2].a, dh[3].d))
