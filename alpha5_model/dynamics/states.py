"""Input checks of states, one or many.

One state that is plainly clean is known by a single call. What is not (a list, integers, a wrong shape,
NaN, masked, too large, no unit quaternion) goes through `array`, which converts it or says what is wrong.
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
from alpha5_model.codegen.kernels import choice as kernels
from alpha5_model.errors import InputError, NonFiniteError, ShapeError

#: Derivatives with respect to positions, velocities and accelerations or torques.
Partials = tuple[FloatArray, FloatArray, FloatArray]
#: How an arm lies in a tree: G (tree nv, nv), G_q (tree nq, nq) and g_0 (tree nq,).
Embedding = tuple[FloatArray, FloatArray, FloatArray]


def state_check(model: Any, *rates: str) -> Callable[..., Any]:
    """A function of q and of rates with these names, which raises if they cannot be used.

    It returns them, converted if need be: q alone, or all of them.
    """
    nq, nv, fixed, plain = (
        model.nq,
        model.nv,
        model.nq == model.nv,
        kernels.module().is_state,
    )

    def check(*state: Any) -> Any:
        good = plain(nq, nv, *state)
        if good and (fixed or pin.isNormalized(model, state[0], ROTATION_TOLERANCE)):
            return state if rates else state[0]
        clean = state_vectors(
            model, state[0], **dict(zip(rates, state[1:], strict=True))
        )
        return clean if rates else clean[0]

    return check


def state_vectors(model: Any, q: Any, **rates: Any) -> list[FloatArray]:
    """Check and convert one state: q, then rates of the length of v by their names."""
    position = array("q", q, model.nq)
    if model.nq > model.nv:
        _check_quaternions(position)
    return [position, *(array(name, x, model.nv) for name, x in rates.items())]


def rows(model: Any, **states: ArrayLike) -> list[FloatArray]:
    """Check and convert states in rows; the first one has nq columns, the others nv, a current 3.

    Raises:
        InputError: Not real numbers, too large ones, or a quaternion without unit norm.
        ShapeError: Wrong number of columns, or of rows.
        NonFiniteError: NaN or infinity.
    """
    arrays: dict[str, FloatArray] = {}
    for name, value in states.items():
        n = 3 if name == "current" else model.nv if arrays else model.nq
        given = bounded(name, float_array(name, value, (n,)))
        if given.ndim > 2:
            raise ShapeError(name, given.shape, f"shape (N, {n})")
        arrays[name] = np.atleast_2d(given)
    n_rows = max(map(len, arrays.values()), key=lambda n: (n != 1, n))
    for name, given in arrays.items():
        if len(given) not in (1, n_rows):
            raise ShapeError(name, given.shape, f"{n_rows} rows, as the others, or one")
    if model.nq > model.nv:
        _check_quaternions(arrays["q"])
    whole = (np.broadcast_to(x, (n_rows, x.shape[1])) for x in arrays.values())
    return [*map(np.ascontiguousarray, whole)]


def is_one_state(*states: ArrayLike) -> bool:
    """Whether none of these has rows; of what is no array at all, `rows` says what is wrong."""
    try:
        return all(np.ndim(state) < 2 for state in states)
    except ValueError:  # lists of different lengths
        return False


def _check_quaternions(q: FloatArray) -> None:
    norms = np.linalg.norm(q[..., 3:7], axis=-1)
    for row in np.argwhere(np.abs(norms - 1.0) > ROTATION_TOLERANCE):
        place, norm = ", ".join([*map(str, row), "3:7"]), norms[tuple(row)]
        raise InputError(
            f"q[{place}]", f"norm {norm:.6g}", "a unit quaternion (x, y, z, w)"
        )


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
    if len(given) != njoints or not all(
        isinstance(force, pin.Force) for force in given
    ):
        raise InputError("fext", fext, expected)
    for joint, force in enumerate(given):
        if not isfinite(sum(force.vector.tolist())):
            raise NonFiniteError("fext", force.vector.tolist(), (joint,))
        bounded(f"fext[{joint}]", force.vector)
    return fext if isinstance(fext, pin.StdVec_Force) else pin.StdVec_Force(given)


def expanded(
    embedding: Embedding, q: FloatArray, *rates: FloatArray
) -> list[FloatArray]:
    """States (..., n) of a tree in which an arm is embedded: ``G_q q + g_0``, then ``G v`` of each rate.

    Args:
        embedding: Of the arm.
        q: (..., nq).
        rates: Velocity, acceleration, (..., nv) each.
    """
    g, g_q, g_0 = embedding
    return [q @ g_q.T + g_0, *(rate @ g.T for rate in rates)]
