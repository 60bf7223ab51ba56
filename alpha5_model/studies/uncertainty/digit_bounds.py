"""Bounds of torques, loads and energies that no numbers within the digits can exceed.

The docstring of the package explains the method.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, flag, instance
from alpha5_model.codegen.regrouping import base_parameters
from alpha5_model.dynamics.actuators import Interval
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.dimensions import check_dimensions
from alpha5_model.dynamics.kernel_numbers import arm_dimensions, arm_parameters
from alpha5_model.dynamics.load import load
from alpha5_model.dynamics.regression import regressor_rows
from alpha5_model.dynamics.states import is_one_state, rows
from alpha5_model.numbers.fluids import SEA_WATER
from alpha5_model.studies.uncertainty import printed
from alpha5_model.studies.uncertainty.arm_numbers import ArmNumbers, arm_numbers
from alpha5_model.studies.uncertainty.calibrated_bounds import (
    Linear,
    calibrated_half_width,
    half_width_by_lengths,
    without_calibrated,
)
from alpha5_model.studies.uncertainty.linear_maps import (
    SYMMETRIC,
    LinkNumbers,
    groups,
    split,
)
from alpha5_model.studies.uncertainty.printed import Names

#: Joints of the arm without its jaws.
_JOINTS = 4
#: Rounding error of doubles, relative to the sum of all terms.
_ROUNDING = 1e-14


class Bounds(NamedTuple):
    """Lower and upper bounds; one state has no axis N.

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
    lengths: bool = False,
) -> Bounds:
    """Bounds that no numbers which round to the printed ones can exceed.

    For an arm of your own, the values with a half width in its file lie within it, and
    its other numbers keep the half width of the printed digits. Lengths, zeros, mount
    and tool are taken as known, and so are place, turn and spacer of attached bodies
    except for a half width of ``at``. The numbers of a calibrated arm, zeros and
    lengths too, lie within the ellipsoid of their covariance, to first order.

    Args:
        q, v, a: (4,) each, or (N, 4); one row is used for all states.
        arm: On a fixed base. Its fluid, gravity, payload, corrections, and jaws that
            are taken out of link 4, are known; None for the bare arm in sea water.
        alternatives: Names of `ALTERNATIVES` to believe, of the catalogue's arm.
        lengths: Whether the digits of the lengths count, too, to first order. The
            bounds are guaranteed only without them. `sample` has the same choice.

    Raises:
        InputError: As of `Arm.inverse_dynamics_batch`, or an arm on a floating base.
            Also alternatives for an arm of your own.
        UnknownNameError: An alternative that is not recorded.
    """
    arm = load() if arm is None else instance("arm", arm, Arm)
    with_lengths = flag("lengths", lengths)
    if not arm.floating_base and arm.model.nv > _JOINTS:
        return _bounds_with_jaws(arm, q, v, a, alternatives, with_lengths)
    one = is_one_state(q, v, a)
    gravity = arm_parameters(arm)[-3:]
    dimensions = arm_dimensions(arm)
    q, v, a = rows(arm._model, q=q, v=v, a=a)

    def torque(dimensions: FloatArray) -> FloatArray:
        return regressor_rows(q, v, a, gravity, dimensions)[:, :4]

    def wrench(dimensions: FloatArray) -> FloatArray:
        return regressor_rows(q, v, a, gravity, dimensions)[:, 4:]

    def kinetic(dimensions: FloatArray) -> FloatArray:
        return _kinetic_energy_rows(q, v, dimensions)

    def potential(dimensions: FloatArray) -> FloatArray:
        return _potential_energy_rows(q, gravity, dimensions)

    chosen = printed.believed(alternatives)
    numbers = arm_numbers(arm.parameters, chosen)
    known = payload(arm, numbers)

    def interval(linear: Linear) -> Interval:
        density = arm.fluid_density
        at_middle = linear(dimensions)
        if numbers.calibrated is None:
            lower, upper = extremes(at_middle, known, density, numbers)
        else:
            others = without_calibrated(numbers)
            lower, upper = extremes(at_middle, known, density, others)
            half = calibrated_half_width(linear, arm, numbers)
            lower = lower - half
            upper = upper + half
        if with_lengths:
            half = half_width_by_lengths(linear, arm, numbers)
            lower = lower - half
            upper = upper + half
        return Interval(
            lower=lower[0] if one else lower, upper=upper[0] if one else upper
        )

    return Bounds(
        torque=interval(torque),
        base_wrench=interval(wrench),
        kinetic_energy=interval(kinetic),
        potential_energy=interval(potential),
    )


def _bounds_with_jaws(
    arm: Arm, q: ArrayLike, v: ArrayLike, a: ArrayLike, *options: Any
) -> Bounds:
    """Bounds of an arm whose jaws move: those of the arm with its jaws locked, moved.

    Args:
        arm: On a fixed base.
        q, v, a: (nv,) each, or (N, nv).
        options: Alternatives, and whether lengths count.
    """
    one = is_one_state(q, v, a)
    q, v, a = rows(arm._model, q=q, v=v, a=a)
    locked = locked_jaws(arm)
    of_locked = bounds(q[:, :_JOINTS], v[:, :_JOINTS], a[:, :_JOINTS], locked, *options)
    torque, wrench, kinetic, potential = (np.array(interval) for interval in of_locked)
    ours = _values(arm, q, v, a)
    known = _values(locked, q[:, :_JOINTS], v[:, :_JOINTS], a[:, :_JOINTS])
    rod = np.zeros((2, len(q), arm.model.nv))
    rod[..., :_JOINTS] = torque - known.torque
    found = Bounds(
        torque=Interval(*(rod + ours.torque)),
        base_wrench=Interval(*(wrench + ours.base_wrench - known.base_wrench)),
        kinetic_energy=Interval(*(kinetic + ours.kinetic - known.kinetic)),
        potential_energy=Interval(*(potential + ours.potential - known.potential)),
    )
    if not one:
        return found
    return Bounds(*(Interval(low[0], high[0]) for low, high in found))


class _Values(NamedTuple):
    """What an arm's own numbers give, in rows of states.

    Attributes:
        torque: (N, nv).
        base_wrench: (N, 6).
        kinetic, potential: (N,).
    """

    torque: FloatArray
    base_wrench: FloatArray
    kinetic: FloatArray
    potential: FloatArray


def _values(arm: Arm, q: FloatArray, v: FloatArray, a: FloatArray) -> _Values:
    """The quantities of `Bounds` for the numbers that an arm has."""
    states = list(zip(q, v, strict=True))
    return _Values(
        torque=arm.inverse_dynamics_batch(q, v, a),
        base_wrench=arm.base_wrench_batch(q, v, a),
        kinetic=np.array([arm.kinetic_energy(*state) for state in states]),
        potential=np.array([arm.potential_energy(row) for row in q]),
    )


def locked_jaws(arm: Arm) -> Arm:
    """The bare arm of a record in its fluid and gravity, with its jaws locked."""
    record = arm.parameters
    check_dimensions(arm._model, "the margin of the printed digits", arm=record)
    # Gravity is in base_link already, so not to be turned by a mount.
    unmounted = record if record.mount is None else replace(record, mount=None)
    gravity = arm.model.gravity.linear
    return load(arm.fluid_density, gravity=gravity, arm=unmounted)


def _kinetic_energy_rows(
    q: FloatArray, v: FloatArray, dimensions: FloatArray
) -> FloatArray:
    """Derivative of the kinetic energy by the base parameters, (N, 38).

    The energy v^T M v / 2 is half of v times the torque M v, which accelerates the arm
    from rest by v.
    """
    still = np.zeros_like(v)
    torque = regressor_rows(q, still, v, np.zeros(3), dimensions)[:, :4]
    return np.asarray((v[:, :, None] * torque).sum(axis=1) / 2)


def _potential_energy_rows(
    q: FloatArray, gravity: FloatArray, dimensions: FloatArray
) -> FloatArray:
    """Derivative of the potential energy by the base parameters, (N, 38).

    It follows from the sum of the first moments n r of all links, whose components are
    read from the moments r x n g on the mount for gravity along x and along y.
    """
    still = np.zeros_like(q)
    along_x, along_y, _ = np.eye(3)
    x = regressor_rows(q, still, still, along_x, dimensions)[:, 7:]
    y = regressor_rows(q, still, still, along_y, dimensions)[:, 7:]
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
    """How far the digits can move the torques of any arm on a fixed base.

    Payload, moving water, and the jaws that are taken out of link 4 count as known. The
    half widths of an arm of your own replace those of the digits, see `bounds`.

    Returns:
        Lowest and highest difference, (2, nv) or (2, N, nv).

    Raises:
        InputError: An arm with other dimensions than those of its record, whose digits
            they are.
    """
    bare = locked_jaws(arm)
    out = np.zeros((2, *np.shape(q)))
    q, v, a = (np.asarray(x)[..., :4] for x in (q, v, a))
    nominal = bare.inverse_dynamics_batch(q, v, a).reshape(q.shape)
    out[..., :4] = np.array(bounds(q, v, a, bare).torque) - nominal
    return out


def payload(arm: Arm, numbers: ArmNumbers) -> FloatArray:
    """What an arm carries beside the bodies of its numbers, as base parameters, (38,).

    Args:
        arm: On a fixed base, with its jaws locked.
        numbers: Of its record.
    """
    density = arm.fluid_density
    if numbers.offset is None:
        record = numbers.arm
        bare = base_parameters(record.links, density, parameters=record)[:-3]
    else:
        bodies = numbers.bodies(numbers.middle)
        bare = groups(bodies, numbers.grouping(density))
    return np.asarray(arm_parameters(arm)[:-3] - bare)


def extremes(
    linear: FloatArray, known: FloatArray, density: float, numbers: ArmNumbers
) -> FloatArray:
    """Lowest and highest values of quantities that are linear in the base parameters.

    Args:
        linear: (N, ..., 38).
        known: Base parameters to add to those of the numbers, (38,).
        density: Of the fluid [kg/m^3].
        numbers: Of the arm.

    Returns:
        (2, N, ...).
    """
    middle = split(numbers.bodies(numbers.middle))
    half_width = split(np.tensordot(numbers.half_width, np.abs(numbers.to_bodies), 1))
    by_moments = np.tensordot(linear, numbers.grouping(density), (-1, -1))
    slope = split(by_moments)  # of (N, ..., B, 14)

    terms = (
        _mass_terms(slope, middle, half_width),
        _tensor_terms(slope, numbers),
        _volume_terms(slope, middle, half_width),
    )
    rounding = _rounding(terms)
    total = np.sum(terms, axis=0) + linear @ known
    return np.asarray(total + np.array([-rounding, rounding]))


def _mass_terms(
    slope: LinkNumbers, middle: LinkNumbers, half_width: LinkNumbers
) -> FloatArray:
    """Extremes of the sum of m s(c), (2, N, ...).

    With Hessian H, s is ``s_0 + g . c + c . H c / 2``. About the middle of c it changes
    by at most ``(|g + H c| + |H| h / 2) . h``, where h is the half width of c.
    """
    com = middle.com
    com_half_width = half_width.com
    # The slopes belong to c_x^2, c_x c_y and so on: second derivatives double squares.
    hessian = slope.second[..., SYMMETRIC] * (np.eye(3) + 1)
    hessian_times_com = (hessian * com[:, None]).sum(axis=-1)
    s = slope.mass + ((slope.com + hessian_times_com / 2) * com).sum(axis=-1)

    gradient = np.abs(slope.com + hessian_times_com)
    curvature = (np.abs(hessian) * com_half_width[:, None]).sum(axis=-1) / 2
    s_half_width = ((gradient + curvature) * com_half_width).sum(axis=-1)
    extremes_of_links = _product(middle.mass, half_width.mass, s, s_half_width)
    return np.asarray(extremes_of_links.sum(axis=-1))


def _tensor_terms(slope: LinkNumbers, numbers: ArmNumbers) -> FloatArray:
    """Extremes of the sum of w . I, (2, N, ...).

    A printed number of a tensor is part of several second moments, so the extremes are
    taken over the printed numbers.
    """
    to_second = split(numbers.to_bodies).second
    by_numbers = np.tensordot(slope.second, to_second, ((-2, -1), (1, 2)))
    spread = np.multiply.outer((-1, 1), np.abs(by_numbers) @ numbers.half_width)
    middle = np.tensordot(by_numbers, numbers.middle, 1)
    if numbers.offset is not None:
        offset = split(numbers.offset).second
        middle = middle + np.tensordot(slope.second, offset, 2)
    return np.asarray(middle + spread)


def _volume_terms(
    slope: LinkNumbers, middle: LinkNumbers, half_width: LinkNumbers
) -> FloatArray:
    """Extremes of the sum of V (w_V + w_b . b), (2, N, ...)."""
    lift = slope.volume + (slope.cob * middle.cob).sum(axis=-1)
    lift_half_width = (np.abs(slope.cob) * half_width.cob).sum(axis=-1)
    extremes_of_links = _product(
        middle.volume, half_width.volume, lift, lift_half_width
    )
    return np.asarray(extremes_of_links.sum(axis=-1))


def _rounding(terms: tuple[FloatArray, ...]) -> FloatArray:
    """Rounding error of doubles in the sum of the terms, (N, ...)."""
    rounding = _ROUNDING * np.abs(terms).sum(axis=(0, 1))
    if rounding.ndim > 1:
        # A torque that is exactly 0 still has the rounding error of the others.
        rounding = rounding.max(axis=1, keepdims=True)
    return np.asarray(rounding)


def _product(
    x: FloatArray, x_half_width: FloatArray, y: FloatArray, y_half_width: FloatArray
) -> FloatArray:
    """Extremes of the product of two numbers in intervals, (2, ...).

    Args:
        x, y: Middles of the intervals.
        x_half_width, y_half_width: Half of their widths.
    """
    corners = [
        (x - x_half_width) * (y - y_half_width),
        (x - x_half_width) * (y + y_half_width),
        (x + x_half_width) * (y - y_half_width),
        (x + x_half_width) * (y + y_half_width),
    ]
    return np.array([np.min(corners, axis=0), np.max(corners, axis=0)])
