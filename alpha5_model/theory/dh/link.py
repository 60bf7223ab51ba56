"""Rows of a standard Denavit-Hartenberg table, and the frames that joint axes give them.

``x_j`` lies on the common normal of ``z_{j-1}`` and ``z_j`` and points from the first to the
second; the origin of {j} is where it meets ``z_j``. Where the rule leaves a choice:

- intersecting axes: ``x_j`` along ``z_{j-1} x z_j``, so alpha_j lies in (0, pi);
- parallel axes: the normal through the origin of {j-1}, so d_j is zero;
- one and the same axis: ``x_j = x_{j-1}``, same origin, so theta_j, d_j, a_j are zero;
- {0}: the world frame if its z is the first joint's axis, else the frame on that axis that makes
  theta_1 and d_1 zero;
- {N}: ``z_N`` is the z axis of the end effector, and what is left of its pose is the chain's tool.
  Where that axis is parallel to the last joint's, {N} has the end effector's origin, and on the
  same axis its x too: then nothing is left.

References:
    [Lecture7.1] Describing Robot Arms, "Frame assignment".
    [Siciliano2009] Siciliano et al.: Robotics, section 2.8.2 (the cases where it is not unique).
    [Corke2011] Corke: Robotics, Vision and Control, section 7.2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, float_array, real, shaped, together
from alpha5_model._support.spatial import transform
from alpha5_model.errors import InputError


def dh_transform(
    theta: ArrayLike, d: ArrayLike, a: ArrayLike, alpha: ArrayLike
) -> FloatArray:
    """The relative pose A_j, ``Rz(theta) Tz(d) Tx(a) Rx(alpha)`` [Lecture7.1], [Corke2011, 7.2].

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
    ct, st, ca, sa = np.cos(theta), np.sin(theta), np.cos(alpha), np.sin(alpha)
    out = np.zeros((*shape, 4, 4))
    out[..., 0, 0], out[..., 0, 1], out[..., 0, 2], out[..., 0, 3] = (
        ct,
        -st * ca,
        st * sa,
        a * ct,
    )
    out[..., 1, 0], out[..., 1, 1], out[..., 1, 2], out[..., 1, 3] = (
        st,
        ct * ca,
        -ct * sa,
        a * st,
    )
    out[..., 2, 1], out[..., 2, 2], out[..., 2, 3] = sa, ca, d
    out[..., 3, 3] = 1.0
    return out


@dataclass(frozen=True)
class DHLink:
    """A row of a standard DH table: a link and the joint that moves it.

    The place of the joint's own variable (theta if revolute, d if prismatic) holds its value at the
    drawn configuration, `home`; `transform` takes the variable from its argument, as Corke's
    ``Link.A(q)`` does.

    Attributes:
        theta: Angle about z_{j-1} [rad].
        d: Distance along z_{j-1} [m].
        a: Distance along x_j [m].
        alpha: Angle about x_j [rad].
        sigma: 0 revolute, 1 prismatic.
        offset: Added to the joint variable, ``theta = q + offset`` or ``d = q + offset`` [rad or
            m].
        lower, upper: Limits of the joint variable [rad or m]; infinite where there is none.

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
        sigma = (
            None
            if isinstance(self.sigma, bool | np.bool_)
            else real("sigma", self.sigma)
        )
        if sigma not in (0.0, 1.0):
            raise InputError("sigma", self.sigma, "0 (revolute) or 1 (prismatic)")
        object.__setattr__(self, "sigma", int(sigma))
        for name in ("lower", "upper"):
            value = getattr(self, name)
            infinite = isinstance(value, float) and math.isinf(value)
            object.__setattr__(
                self, name, float(value) if infinite else real(name, value)
            )
        if (
            not self.lower <= self.upper
            or self.lower == math.inf
            or self.upper == -math.inf
        ):
            raise InputError("lower, upper", (self.lower, self.upper), "lower <= upper")

    @classmethod
    def from_vector(cls, vector: ArrayLike) -> DHLink:
        """A link from ``[theta, d, a, alpha, sigma]``, as in the notes and in Corke's ``Link``.

        Args:
            vector: (5,) [rad, m, m, rad, -]; also (4,), which is revolute, and (6,) with the
                offset.
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
        """Joint variable at the drawn configuration: theta if the joint is revolute, else d."""
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


def frames_on_axes(
    p: FloatArray, z: FloatArray, end: FloatArray | None, tolerance: float
) -> list[FloatArray]:
    """Frames {0} ... {N} of a serial arm drawn at one configuration, (4, 4) each, in the world.

    Args:
        p: A point on each joint axis, (N, 3) [m].
        z: Unit direction of each axis, (N, 3).
        end: transform_end_effector_to_world, (4, 4); without one {N} is {N-1}.
        tolerance: Axes within this angle [rad] count as parallel, within this distance [m] as
            intersecting.
    """
    tolerance = real("tolerance", tolerance, minimum=0.0)
    if end is not None:
        p, z = np.vstack([p, end[:3, 3]]), np.vstack([z, end[:3, 2]])
    first = _frame(p[0], np.eye(3)[np.abs(z[0]).argmin()], z[0])  # farthest from z
    off_axis = max(math.hypot(*z[0, :2]), math.hypot(*p[0, :2]))
    if off_axis <= tolerance and z[0, 2] > 0:
        first = np.eye(4)
    elif len(p) > 1:  # {0} is {1} seen from the first axis: theta_1 = d_1 = 0
        x, _, foot = _normal(first, p[1], z[1], tolerance)
        first = _frame(foot, x, z[0])
    frames = [first]
    for point, direction in zip(p[1:], z[1:], strict=True):
        x, origin, _ = _normal(frames[-1], point, direction, tolerance)
        frames.append(_frame(origin, x, direction))
    if end is None:
        frames.append(frames[-1])
    elif np.linalg.norm(np.cross(z[-2], z[-1])) <= tolerance:
        away = np.cross(np.cross(z[-1], end[:3, 3] - p[-2]), z[-1])
        same_axis = np.linalg.norm(away) <= tolerance
        frames[-1] = _frame(
            end[:3, 3], (end if same_axis else frames[-1])[:3, 0], z[-1]
        )
    return frames


def table_row(step: FloatArray) -> tuple[float, float, float, float]:
    """theta, d, a, alpha of a relative pose that has the form of A_j."""
    theta, alpha = (
        math.atan2(step[1, 0], step[0, 0]),
        math.atan2(step[2, 1], step[2, 2]),
    )
    a = step[0, 3] * step[0, 0] + step[1, 3] * step[1, 0]
    return theta, float(step[2, 3]), float(a), alpha


def common_normal(
    point_1: ArrayLike,
    direction_1: ArrayLike,
    point_2: ArrayLike,
    direction_2: ArrayLike,
) -> tuple[FloatArray, FloatArray]:
    """Feet of the common normal of two lines that are not parallel.

    Args:
        point_1, direction_1: A point (3,) [m] and the direction (3,) of the first line.
        point_2, direction_2: The same of the second line.

    Returns:
        The nearest point of the first line and that of the second, (3,) each [m].
    """
    p1, z1 = shaped("point_1", point_1, (3,)), shaped("direction_1", direction_1, (3,))
    p2, z2 = shaped("point_2", point_2, (3,)), shaped("direction_2", direction_2, (3,))
    cross = np.cross(z1, z2)
    square = cross @ cross
    if square == 0:
        raise InputError(
            "direction_2", z2.tolist(), "a line that is not parallel to the first"
        )
    between = p2 - p1
    s1 = np.cross(between, z2) @ cross / square
    s2 = np.cross(between, z1) @ cross / square
    return p1 + s1 * z1, p2 + s2 * z2


def _normal(
    previous: FloatArray, point: FloatArray, z: FloatArray, tolerance: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Direction of x_j, origin of {j}, and the foot of the common normal on z_{j-1}."""
    origin, x_before, z_before = previous[:3, 3], previous[:3, 0], previous[:3, 2]
    cross = np.cross(z_before, z)
    sine = math.sqrt(cross @ cross)
    if sine > tolerance:
        foot_1, foot_2 = common_normal(origin, z_before, point, z)
        side = (foot_2 - foot_1) @ cross
        x = cross / sine
        return (-x if side / sine < -tolerance else x), foot_2, foot_1
    across = point - origin
    along = across @ z_before
    across = across - along * z_before
    distance = math.sqrt(across @ across)
    x = across / distance if distance > tolerance else x_before
    # Any normal will do: at the origin, unless that is so far away that the tilt counts there.
    if sine * abs(along) > tolerance:
        return x, point, point - across
    return x, origin + across, origin


def _frame(origin: FloatArray, x: FloatArray, z: FloatArray) -> FloatArray:
    x = x - (x @ z) * z
    x = x / math.sqrt(x @ x)
    return transform(np.column_stack([x, np.cross(z, x), z]), origin)


def unit_vectors(name: str, value: ArrayLike, axes: int = 1) -> FloatArray:
    """Directions (..., 3) of so many axes, none of them zero, scaled to length 1.

    Raises:
        InputError: Anything else.
    """
    v = float_array(name, value, (3,))
    largest = np.abs(v).max(axis=-1, keepdims=True)
    if v.ndim != axes or not largest.all():
        expected = (
            "one direction that is not zero"
            if axes == 1
            else "directions that are not zero"
        )
        raise InputError(name, value, expected)
    v = v / largest  # squares of large numbers overflow
    return np.asarray(v / np.linalg.norm(v, axis=-1, keepdims=True))
