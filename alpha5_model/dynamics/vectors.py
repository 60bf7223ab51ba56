"""Input checks that cost a tenth of the microsecond that Pinocchio needs.

``hypot(*x.tolist()) < LARGEST`` tells a clean vector in 0.1 us where ``numpy.isfinite(x).all()`` takes 1 us. A
vector that is not plainly clean (a list, integers, a wrong shape, NaN, masked, too large) takes the slow road
through `vector`, which converts it or says what is wrong.
"""

from __future__ import annotations

from collections.abc import Callable
from math import hypot, isfinite
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model.checks import LARGEST, ROTATION_TOLERANCE, FloatArray, bounded, shaped
from alpha5_model.errors import InputError, NonFiniteError

_ARRAY, _FLOAT64 = np.ndarray, np.dtype(np.float64)


def position_check(model: Any) -> Callable[[Any], FloatArray]:
    """A function that returns q if it can be used, converted if need be, and raises if it cannot."""
    nq = model.nq

    def slowly(q: Any) -> FloatArray:
        checked = vector("q", q, nq)
        if nq != model.nv and not pin.isNormalized(model, checked, ROTATION_TOLERANCE):
            norm = float(np.linalg.norm(checked[3:7]))
            raise InputError("q[3:7]", f"norm {norm:.6g}", "a unit quaternion (x, y, z, w)")
        return checked

    def check(q: Any) -> FloatArray:
        try:
            if (
                type(q) is _ARRAY
                and q.dtype is _FLOAT64
                and len(q) == nq
                and hypot(*q.tolist()) < LARGEST  # a second axis would make it a list of lists
            ):
                clean: FloatArray = q
                return clean
        except TypeError:
            pass
        return slowly(q)

    return check if nq == model.nv else slowly


def state_check(model: Any) -> Callable[[Any, Any], tuple[FloatArray, FloatArray]]:
    """The same for q and v."""
    position, nq, nv = position_check(model), model.nq, model.nv

    def slowly(q: Any, v: Any) -> tuple[FloatArray, FloatArray]:
        return position(q), vector("v", v, nv)

    def check(q: Any, v: Any) -> tuple[FloatArray, FloatArray]:
        try:
            if (
                type(q) is type(v) is _ARRAY
                and q.dtype is v.dtype is _FLOAT64
                and len(q) == nq == len(v)
                and hypot(*q.tolist(), *v.tolist()) < LARGEST
            ):
                return q, v
        except TypeError:
            pass
        return slowly(q, v)

    return check if nq == nv else slowly


def motion_check(
    model: Any, name: str
) -> Callable[[Any, Any, Any], tuple[FloatArray, FloatArray, FloatArray]]:
    """The same for q, v and a third vector of the length of v."""
    position, nq, nv = position_check(model), model.nq, model.nv

    def slowly(q: Any, v: Any, x: Any) -> tuple[FloatArray, FloatArray, FloatArray]:
        return position(q), vector("v", v, nv), vector(name, x, nv)

    def check(q: Any, v: Any, x: Any) -> tuple[FloatArray, FloatArray, FloatArray]:
        try:
            if (
                type(q) is type(v) is type(x) is _ARRAY
                and q.dtype is v.dtype is x.dtype is _FLOAT64
                and len(q) == nq == len(v) == len(x)
                and hypot(*q.tolist(), *v.tolist(), *x.tolist()) < LARGEST
            ):
                return q, v, x
        except TypeError:
            pass
        return slowly(q, v, x)

    return check if nq == nv else slowly


def vector(name: str, value: ArrayLike, n: int) -> FloatArray:
    """Check and convert one vector.

    Raises:
        InputError: Not real numbers, or too large to compute with.
        ShapeError: Not of shape (n,).
        NonFiniteError: NaN or infinity.
    """
    return bounded(name, shaped(name, value, (n,)))


def forces(fext: Any, njoints: int) -> Any:
    """Check and convert external forces, one for each joint, in the joint's frame.

    Returns:
        pin.StdVec_Force of length njoints.

    Raises:
        InputError: Not a sequence of ``njoints`` pin.Force.
        NonFiniteError: NaN or infinity in a force; an InputError if it is too large.
    """
    try:
        count = len(fext)
        if not all(isinstance(force, pin.Force) for force in fext):
            count = -1
    except TypeError:
        count = -1
    if count != njoints:
        raise InputError("fext", fext, f"{njoints} pin.Force, one for each joint and the universe")
    for joint, force in enumerate(fext):
        if not isfinite(sum(force.vector.tolist())):
            raise NonFiniteError("fext", force.vector.tolist(), (joint,))
        bounded(f"fext[{joint}]", force.vector)
    return fext if isinstance(fext, pin.StdVec_Force) else pin.StdVec_Force(list(fext))
