"""Input checks of states, one or many.

A single fast call accepts a plain state: finite float64 arrays of the right shapes. Any
other input (lists, integers, a wrong shape, NaN, a mask, too large numbers, no unit
quaternion) goes through `array`, which converts it or raises an error.
"""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    ROTATION_TOLERANCE,
    FloatArray,
    array,
    bounded,
    float_array,
    listed,
)
from alpha5_model.errors import InputError, NonFiniteError, ShapeError
from alpha5_model.kernels import choice as kernels
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.tables import JOINT_NAMES

#: Derivatives with respect to positions, velocities and accelerations or torques.
Partials = tuple[FloatArray, FloatArray, FloatArray]
#: The jaw rod, the last joint of an arm that has it.
_ROD = JOINT_NAMES[4]
#: A longer travel of the rod is most likely in mm [m].
_LONGEST_ROD = plausibility.JAW_LENGTH.ranges[0][1]


def state_check(model: pin.Model, *rates: str) -> Callable[..., Any]:
    """A function that checks and converts q, and rates with these names.

    It returns q alone if there are no rates, else q and the rates.
    """
    nq = model.nq
    nv = model.nv
    fixed_base = nq == nv
    has_rod = model.existJointName(_ROD)
    is_plain_state = kernels.module().is_state

    def check(*state: Any) -> Any:
        if (
            is_plain_state(nq, nv, *state)
            and (fixed_base or pin.isNormalized(model, state[0], ROTATION_TOLERANCE))
            and not (has_rod and abs(state[0][-1]) > _LONGEST_ROD)
        ):
            return state if rates else state[0]
        given_rates = dict(zip(rates, state[1:], strict=True))
        clean = state_vectors(model, state[0], **given_rates)
        return clean if rates else clean[0]

    return check


def state_vectors(model: pin.Model, q: Any, **rates: Any) -> list[FloatArray]:
    """Check and convert one state: q, then rates of the length of v by their names."""
    position = array("q", q, model.nq)
    if model.nq > model.nv:
        _check_quaternions(position)
    _check_units(model, position)
    checked_rates = [array(name, rate, model.nv) for name, rate in rates.items()]
    return [position, *checked_rates]


def rows(model: pin.Model, **states: ArrayLike) -> list[FloatArray]:
    """Check and convert states in rows.

    The first one has nq columns, the others nv; ``water_velocity`` has 3. A single row
    is used for all.

    Raises:
        InputError: Not real numbers, too large ones, or a quaternion without unit norm.
        ShapeError: Wrong number of columns, or of rows.
        NonFiniteError: NaN or infinity.
    """
    arrays: dict[str, FloatArray] = {}
    for name, value in states.items():
        columns = model.nv if arrays else model.nq
        if name == "water_velocity":
            columns = 3
        arrays[name] = _as_rows(name, value, columns)
    n_rows = _number_of_rows(arrays)
    if model.nq > model.nv:
        _check_quaternions(arrays["q"])
    if "q" in arrays:
        _check_units(model, arrays["q"])
    # One row for all is not copied: what computes may be asked for millions of rows.
    return [
        np.broadcast_to(np.ascontiguousarray(given), (n_rows, given.shape[1]))
        for given in arrays.values()
    ]


def _as_rows(name: str, value: ArrayLike, columns: int) -> FloatArray:
    given = bounded(name, float_array(name, value, (columns,)))
    if given.ndim > 2:
        raise ShapeError(name, given.shape, f"shape (N, {columns})")
    return np.atleast_2d(given)


def _number_of_rows(arrays: dict[str, FloatArray]) -> int:
    """Common number of rows of arrays; one row fits any number."""
    lengths = [len(given) for given in arrays.values()]
    several = [length for length in lengths if length != 1]
    n_rows = max(several, default=1)
    for name, given in arrays.items():
        if len(given) not in (1, n_rows):
            raise ShapeError(name, given.shape, f"{n_rows} rows, as the others, or one")
    return n_rows


def is_one_state(*states: ArrayLike) -> bool:
    """Whether none of these has rows.

    It raises no error: `rows` does so for values that are not arrays.
    """
    try:
        return all(np.ndim(state) < 2 for state in states)
    except ValueError:  # lists of different lengths
        return False


def _check_quaternions(q: FloatArray) -> None:
    norms = np.linalg.norm(q[..., 3:7], axis=-1)
    for row in np.argwhere(np.abs(norms - 1.0) > ROTATION_TOLERANCE):
        place = ", ".join([*map(str, row), "3:7"])
        norm = norms[tuple(row)]
        expected = "a unit quaternion (x, y, z, w)"
        raise InputError(f"q[{place}]", f"norm {norm:.6g}", expected)


def _check_units(model: pin.Model, q: FloatArray) -> None:
    """Warn of joint positions (..., nq) that are most likely in degrees or mm."""
    joints = q[..., 7:] if model.nq > model.nv else q
    if model.existJointName(_ROD):
        plausibility.check_largest("q", joints[..., -1], plausibility.JAW_LENGTH)
        joints = joints[..., :-1]
    plausibility.check_largest("q", joints, plausibility.ANGLE)


def forces(fext: Any, njoints: int) -> Any:
    """Check and convert external forces, one for each joint, in the joint's frame.

    Returns:
        pin.StdVec_Force of length njoints.

    Raises:
        InputError: Not a sequence of ``njoints`` pin.Force.
        NonFiniteError: NaN or infinity in a force; an InputError if it is too large.
    """
    expected = f"{njoints} pin.Force, one for each joint and the universe"
    given = listed("fext", fext, expected)
    all_forces = all(isinstance(force, pin.Force) for force in given)
    if len(given) != njoints or not all_forces:
        raise InputError("fext", fext, expected)
    for joint, force in enumerate(given):
        components = force.vector.tolist()
        if not isfinite(sum(components)):
            raise NonFiniteError("fext", components, (joint,))
        bounded(f"fext[{joint}]", force.vector)
    return fext if isinstance(fext, pin.StdVec_Force) else pin.StdVec_Force(given)
