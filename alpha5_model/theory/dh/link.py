"""A row of a standard Denavit-Hartenberg table, and its transform.

References:
    [Lecture7.1] Describing Robot Arms, "Standard Denavit-Hartenberg parameters".
    [Corke2011] Corke: Robotics, Vision and Control, section 7.2, equation (7.2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, float_array, real, together
from alpha5_model.errors import InputError


def dh_transform(
    theta: ArrayLike, d: ArrayLike, a: ArrayLike, alpha: ArrayLike
) -> FloatArray:
    """The relative pose A_j, ``Rz(theta) Tz(d) Tx(a) Rx(alpha)``.

    See [Lecture7.1] and [Corke2011, 7.2].

    Args:
        theta: Angle about z_{j-1} from x_{j-1} to x_j, (...) [rad].
        d: Distance along z_{j-1}, (...) [m].
        a: Distance along x_j, (...) [m].
        alpha: Angle about x_j from z_{j-1} to z_j, (...) [rad].

    Returns:
        (..., 4, 4) over the broadcast shape of the arguments.

    Raises:
        InputError: Not finite real numbers, or shapes that do not broadcast.
    """
    values = together(theta=theta, d=d, a=a, alpha=alpha)
    return _transform(values[0].shape, *values)


def _transform(
    shape: tuple[int, ...],
    theta: ArrayLike,
    d: ArrayLike,
    a: ArrayLike,
    alpha: ArrayLike,
) -> FloatArray:
    """A_j, (..., 4, 4), for parameters that broadcast to a shape (...)."""
    ct = np.cos(theta)
    st = np.sin(theta)
    ca = np.cos(alpha)
    sa = np.sin(alpha)
    out = np.zeros((*shape, 4, 4))
    out[..., 0, 0] = ct
    out[..., 0, 1] = -st * ca
    out[..., 0, 2] = st * sa
    out[..., 0, 3] = a * ct
    out[..., 1, 0] = st
    out[..., 1, 1] = ct * ca
    out[..., 1, 2] = -ct * sa
    out[..., 1, 3] = a * st
    out[..., 2, 1] = sa
    out[..., 2, 2] = ca
    out[..., 2, 3] = d
    out[..., 3, 3] = 1.0
    return out


@dataclass(frozen=True)
class DHLink:
    """A row of a standard DH table: a link and the joint that moves it.

    The joint's own variable is theta if it is revolute, and d if it is prismatic. The
    field holds its value at the drawn configuration (`home`). `transform` takes the
    variable as an argument, as Corke's ``Link.A(q)`` does.

    Attributes:
        theta: Angle about z_{j-1} [rad].
        d: Distance along z_{j-1} [m].
        a: Distance along x_j [m].
        alpha: Angle about x_j [rad].
        sigma: 0 revolute, 1 prismatic.
        offset: Added to the joint variable, ``theta = q + offset`` or ``d = q +
            offset`` [rad or m].
        lower, upper: Limits of the joint variable [rad or m]; infinite if there is
            none.

    Raises:
        InputError: A sigma that is neither 0 nor 1, limits the wrong way round.
        NonFiniteError: A parameter that is not finite.
    """

    theta: float
    d: float
    a: float
    alpha: float
    sigma: int = 0
    offset: float = 0.0
    lower: float = -math.inf
    upper: float = math.inf

    def __post_init__(self) -> None:
        for name in ("theta", "d", "a", "alpha", "offset"):
            object.__setattr__(self, name, real(name, getattr(self, name)))
        object.__setattr__(self, "sigma", _joint_type(self.sigma))
        for name in ("lower", "upper"):
            object.__setattr__(self, name, _limit(name, getattr(self, name)))
        empty = self.lower == math.inf or self.upper == -math.inf
        if empty or not self.lower <= self.upper:
            raise InputError("lower, upper", (self.lower, self.upper), "lower <= upper")

    @classmethod
    def from_vector(cls, vector: ArrayLike) -> DHLink:
        """A link from ``[theta, d, a, alpha, sigma]``, as in Corke's ``Link``.

        Args:
            vector: (5,) [rad, m, m, rad, -]; also (4,), which is revolute, and (6,)
                with the offset.
        """
        row = float_array("vector", vector, ())
        if row.ndim != 1 or row.size not in (4, 5, 6):
            raise InputError("vector", vector, "[theta, d, a, alpha, sigma]")
        return cls(*row.tolist())

    @property
    def revolute(self) -> bool:
        """Whether the joint turns; otherwise it slides."""
        return self.sigma == 0

    @property
    def home(self) -> float:
        """Joint variable at the drawn configuration: theta or d [rad or m]."""
        return self.theta if self.revolute else self.d

    def transform(self, q: ArrayLike) -> FloatArray:
        """A_j at a joint position.

        Args:
            q: Joint variable, (...) [rad or m].

        Returns:
            transform_j_to_j-1, (..., 4, 4).
        """
        variable = float_array("q", q, ()) + self.offset
        theta, d = (variable, self.d) if self.revolute else (self.theta, variable)
        return _transform(variable.shape, theta, d, self.a, self.alpha)


def _joint_type(sigma: Any) -> int:
    """A joint type as the integer 0 or 1."""
    number = None if isinstance(sigma, bool | np.bool_) else real("sigma", sigma)
    if number not in (0.0, 1.0):
        raise InputError("sigma", sigma, "0 (revolute) or 1 (prismatic)")
    return int(number)


def _limit(name: str, value: Any) -> float:
    """A finite number, or infinity."""
    if isinstance(value, float) and math.isinf(value):
        return float(value)
    return real(name, value)
