"""Bounds of torques, loads and energies that no numbers within the digits can pass.

The package's docstring says how they are found.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, instance
from alpha5_model.codegen.regrouping import base_parameters
from alpha5_model.dynamics.actuators import Interval
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.dimensions import check_dimensions
from alpha5_model.dynamics.kernel_numbers import arm_parameters
from alpha5_model.dynamics.load import load
from alpha5_model.dynamics.regression import regressor_rows
from alpha5_model.dynamics.states import is_one_state, rows
from alpha5_model.numbers import parameters as records
from alpha5_model.numbers.fluids import SEA_WATER
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.studies.uncertainty import printed
from alpha5_model.studies.uncertainty.linear_maps import (
    SYMMETRIC,
    LinkNumbers,
    grouping,
    link_map,
    split,
)
from alpha5_model.studies.uncertainty.printed import Names

#: Rounding of doubles, relative to the sum of all parts.
_ROUNDING = 1e-14


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
    """Bounds that no numbers that round to the printed ones can pass, for a motion.

    Args:
        q, v, a: (4,) each, or (N, 4); one row is used for all states.
        arm: On a fixed base. Its fluid, gravity, payload and corrections are taken as
            known; None for the bare arm in sea water.
        alternatives: Names of `ALTERNATIVES` to believe.

    Raises:
        InputError: As of `Arm.inverse_dynamics_batch`, or an arm on a floating base or
            with jaws that move.
        UnknownNameError: An alternative that is not recorded.
    """
    arm = load() if arm is None else instance("arm", arm, Arm)
    one = is_one_state(q, v, a)
    gravity = arm_parameters(arm)[-3:]
    q, v, a = rows(arm._model, q=q, v=v, a=a)
    torque_and_wrench = regressor_rows(q, v, a, gravity)
    kinetic = _kinetic_energy_rows(q, v)
    potential = _potential_energy_rows(q, gravity)

    chosen = printed.believed(alternatives)
    bare = records.parameters(arm.parameters.corrections)
    known = payload(arm, bare)

    def interval(linear: FloatArray) -> Interval:
        density = arm.fluid_density
        lower, upper = extremes(linear, known, density, chosen, bare)
        return Interval(
            lower=lower[0] if one else lower, upper=upper[0] if one else upper
        )

    return Bounds(
        torque=interval(torque_and_wrench[:, :4]),
        base_wrench=interval(torque_and_wrench[:, 4:]),
        kinetic_energy=interval(kinetic),
        potential_energy=interval(potential),
    )


def _kinetic_energy_rows(q: FloatArray, v: FloatArray) -> FloatArray:
    """Kinetic energy by base parameters, (N, 38).

    It is half the power of v under the torque of an acceleration v from rest.
    """
    still = np.zeros_like(v)
    torque = regressor_rows(q, still, v, np.zeros(3))[:, :4]
    return np.asarray((v[:, :, None] * torque).sum(axis=1) / 2)


def _potential_energy_rows(q: FloatArray, gravity: FloatArray) -> FloatArray:
    """Potential energy by base parameters, (N, 38).

    Moments of weights, sums of r x n g, for two directions of g contain all of the sum
    of n r.
    """
    still = np.zeros_like(q)
    along_x, along_y, _ = np.eye(3)
    x = regressor_rows(q, still, still, along_x)[:, 7:]
    y = regressor_rows(q, still, still, along_y)[:, 7:]
    first_moments = [y[:, 2], -x[:, 2], x[:, 1]]
    return -np.tensordot(gravity, first_moments, 1)


def torque_bounds(
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    fluid_density: float = SEA_WATER,
    **options: Any,
) -> Interval:
    """The torques of `bounds`, ``(lower, upper)``, (4,) each or (N, 4) [N m].

    Args:
        q, v, a: As of `bounds`.
        fluid_density: [kg/m^3].
        options: As of `bounds`.
    """
    return bounds(q, v, a, **{"arm": load(fluid_density), **options}).torque


def torque_margin(arm: Arm, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> FloatArray:
    """How far the digits move the torques of any arm on a fixed base.

    Payload, moving water and the jaws, which are taken out of link 4, are as known.

    Returns:
        Lowest and highest, (2, nv) or (2, N, nv).

    Raises:
        InputError: An arm with other dimensions than the catalogue's, whose digits they
            are.
    """
    check_dimensions(arm._model, "the margin of the printed digits")
    bare = load(arm.fluid_density, gravity=arm.model.gravity.linear)
    out = np.zeros((2, *np.shape(q)))
    q, v, a = (np.asarray(x)[..., :4] for x in (q, v, a))
    nominal = bare.inverse_dynamics_batch(q, v, a).reshape(q.shape)
    out[..., :4] = np.array(bounds(q, v, a, bare).torque) - nominal
    return out


def payload(arm: Arm, parameters: Alpha5Parameters) -> FloatArray:
    """What an arm's base parameters have beyond those of the bare arm, (38,).

    Args:
        arm: On a fixed base, with its jaws locked.
        parameters: Of the bare arm, with the same corrections.
    """
    bare = base_parameters(parameters.links, arm.fluid_density, parameters=parameters)
    return (arm_parameters(arm) - bare)[:-3]


def extremes(
    linear: FloatArray,
    known: FloatArray,
    density: float,
    alternatives: tuple[str, ...],
    parameters: Alpha5Parameters,
) -> FloatArray:
    """Lowest and highest values of quantities that are linear in the base parameters.

    Args:
        linear: (N, ..., 38).
        known: Base parameters that come on top of the printed numbers', (38,).
        density: Of the fluid [kg/m^3].
        alternatives: Checked names of `ALTERNATIVES`.
        parameters: Of the bare arm; only dimensions and corrections are used.

    Returns:
        (2, N, ...).
    """
    to_links = link_map(alternatives, parameters.corrections)
    middle, half = printed.ends(alternatives)
    link = split(np.tensordot(middle, to_links, 1))
    width = split(np.tensordot(half, np.abs(to_links), 1))
    by_moments = np.tensordot(linear, grouping(density, parameters), (-1, -1))
    slope = split(by_moments)  # of (N, ..., 5, 14)

    parts = (
        _of_masses(slope, link, width),
        _of_tensors(slope, to_links, middle, half),
        _of_volumes(slope, link, width),
    )
    slack = _slack(parts)
    total = np.sum(parts, axis=0) + linear @ known
    return np.asarray(total + np.array([-slack, slack]))


def _of_masses(slope: LinkNumbers, link: LinkNumbers, width: LinkNumbers) -> FloatArray:
    """Extremes of the sum of m s(c), (2, N, ...).

    s is taken by its slope at the middle COM, and the largest that its part of second
    degree can be from there on.
    """
    com = link.com
    box = width.com
    curve = slope.second[..., SYMMETRIC] * (np.eye(3) + 1)
    bent = (curve * com[:, None]).sum(axis=-1)
    s = slope.mass + ((slope.com + bent / 2) * com).sum(axis=-1)

    steepest = (
        np.abs(slope.com + bent) + (np.abs(curve) * box[:, None]).sum(axis=-1) / 2
    )
    s_width = (steepest * box).sum(axis=-1)
    ends = _product(link.mass, width.mass, s, s_width)
    return np.asarray(ends.sum(axis=-1))


def _of_tensors(
    slope: LinkNumbers, to_links: FloatArray, middle: FloatArray, half: FloatArray
) -> FloatArray:
    """Extremes of the tensors' share, (2, N, ...).

    Each digit of a tensor is in several second moments.
    """
    to_second = split(to_links).second
    by_digits = np.tensordot(slope.second, to_second, ((-2, -1), (1, 2)))
    spread = np.multiply.outer((-1, 1), np.abs(by_digits) @ half)
    return np.asarray(np.tensordot(by_digits, middle, 1) + spread)


def _of_volumes(
    slope: LinkNumbers, link: LinkNumbers, width: LinkNumbers
) -> FloatArray:
    """Extremes of the sum of V (w_V + w_b . b), (2, N, ...)."""
    lift = slope.volume + (slope.cob * link.cob).sum(axis=-1)
    lift_width = (np.abs(slope.cob) * width.cob).sum(axis=-1)
    ends = _product(link.volume, width.volume, lift, lift_width)
    return np.asarray(ends.sum(axis=-1))


def _slack(parts: tuple[FloatArray, ...]) -> FloatArray:
    """What the rounding of doubles may hide, (N, ...)."""
    slack = _ROUNDING * np.abs(parts).sum(axis=(0, 1))
    if slack.ndim > 1:
        # What is nothing for one joint is the rounding of another's torque.
        slack = slack.max(axis=1, keepdims=True)
    return np.asarray(slack)


def _product(
    x: FloatArray, x_width: FloatArray, y: FloatArray, y_width: FloatArray
) -> FloatArray:
    """Lowest and highest products of numbers of two intervals, (2, ...)."""
    corners = [
        (x - x_width) * (y - y_width),
        (x - x_width) * (y + y_width),
        (x + x_width) * (y - y_width),
        (x + x_width) * (y + y_width),
    ]
    return np.array([np.min(corners, axis=0), np.max(corners, axis=0)])
