"""Forces of moving water on the bodies of a tree, from their velocities relative to the water.

Added mass in Kirchhoff's form, ``f = -(A dnu + nu x* A nu)`` [Fossen2011]_, and drag as a sum of resistances: each
has two rows b of a twist, to the slip ``s = B nu``, and resists with ``-B^T (linear + quadratic |s|) s``. A strip
is one resistance across it at each of its Gauss points, and one along it.

All joints and N states are computed at once; twists are linear before angular, each in its joint's frame.

.. [Fossen2011] Fossen: Handbook of marine craft hydrodynamics and motion control, 2011, sections 6.3 and 6.4.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.hydrodynamics import WATER_DENSITY, BodyHydrodynamics, DragStrip, gauss_points
from alpha5_model.spatial import cross_matrix

#: Two rows of a twist, linear and quadratic resistance.
Resistance = tuple[FloatArray, FloatArray, float, float]


@dataclass(frozen=True, eq=False)
class JointWater:
    """A body of moving water, carried by a joint.

    Attributes:
        body: Name of the frame that it belongs to.
        joint: Name of the joint; ``universe`` for a fixed base.
        action: Twist at the joint to twist in the body's frame, (6, 6).
        data: What the water does, in that frame.
        linear, quadratic: Further damping of each component of that twist, (6,).
    """

    body: str
    joint: str
    action: FloatArray
    data: BodyHydrodynamics
    linear: FloatArray = field(default_factory=lambda: np.zeros(6))
    quadratic: FloatArray = field(default_factory=lambda: np.zeros(6))


class MovingWater:
    """Added mass and drag on the joints of a tree, in a fluid; twists and forces are (joints, 6, N).

    Attributes:
        added_mass: (joints, 6, 6), in the joints' frames.
    """

    def __init__(self, joints: Iterable[str], bodies: Iterable[JointWater], density: float) -> None:
        names = list(joints)  # the first one carries what a fixed base carries
        share, n = density / WATER_DENSITY, len(names)
        self.added_mass = np.zeros((n, 6, 6))
        found: list[list[Resistance]] = [[] for _ in names]
        for body in bodies:
            i = names.index(body.joint) if body.joint in names else 0
            x = body.action
            self.added_mass[i] += share * x.T @ body.data.added_mass @ x
            found[i] += [(b @ x, c @ x, d, e) for b, c, d, e in _resistances(body)]
        pairs = np.zeros((n, 2, max(map(len, found)), 6))
        self._linear, self._quadratic = np.zeros((2, n, pairs.shape[2], 1))
        for i, entries in enumerate(found):
            for k, (one, other, linear, quadratic) in enumerate(entries):
                pairs[i, :, k] = one, other
                self._linear[i, k], self._quadratic[i, k] = share * linear, share * quadratic
        self._rows = pairs.reshape(n, -1, 6) if pairs.size else np.zeros((n, 0, 6))
        self._columns = np.ascontiguousarray(self._rows.swapaxes(1, 2))
        # nu x* A nu is quadratic in nu: 36 products of two components, times constants.
        crossed = np.array([cross_force(axis) for axis in np.eye(6)])
        self._whirl = np.einsum("bac,jcd->jabd", crossed, self.added_mass).reshape(n, 6, 36)

    def force(self, nu: FloatArray, dnu: FloatArray) -> FloatArray:
        """Force of the water on each joint's bodies.

        Args:
            nu: Velocity relative to the water.
            dnu: Its rate of change in the joint's frame.
        """
        joints, _, n = nu.shape
        products = (nu[:, :, None] * nu[:, None]).reshape(joints, 36, n)
        slip, resistance, _ = self._slip(nu)
        drag = self._columns @ (slip * resistance[:, None]).reshape(joints, self._rows.shape[1], n)
        return np.asarray(-(self.added_mass @ dnu + self._whirl @ products + drag))

    def force_by_velocity(self, nu: FloatArray) -> FloatArray:
        """Derivative of `force` with respect to nu, of one state, (joints, 6, 6)."""
        slip, resistance, speed = self._slip(nu)
        growth = np.divide(self._quadratic, speed, out=np.zeros_like(speed), where=speed > 0)
        (x, y), (one, other) = slip.swapaxes(0, 1), np.split(self._rows, 2, axis=1)
        one_t, other_t = one.swapaxes(1, 2), other.swapaxes(1, 2)
        mixed = one_t @ (growth * x * y * other)
        drag = one_t @ ((resistance + growth * x * x) * one) + mixed
        drag += other_t @ ((resistance + growth * y * y) * other) + mixed.swapaxes(1, 2)
        whirl = kirchhoff((self.added_mass @ nu)[..., 0])
        return np.asarray(-(cross_force(nu[..., 0]) @ self.added_mass + whirl + drag))

    def dissipated_power(self, nu: FloatArray) -> FloatArray:
        """Power that drag takes out of the motion relative to the water, (N,) [W]; never negative."""
        _, resistance, speed = self._slip(nu)
        return np.asarray((resistance * speed**2).sum(axis=(0, 1)))

    def _slip(self, nu: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Slip (joints, 2, k, N) of each resistance, its resistance and speed (joints, k, N)."""
        joints, k, _ = self._linear.shape
        slip = (self._rows @ nu).reshape(joints, 2, k, nu.shape[2])
        speed = np.sqrt(slip[:, 0] ** 2 + slip[:, 1] ** 2)
        return slip, self._linear + self._quadratic * speed, speed


def _resistances(body: JointWater) -> Iterable[Resistance]:
    nothing = np.zeros(6)
    for strip in body.data.strips:
        yield from _of_strip(strip)
    for row, linear, quadratic in zip(np.eye(6), body.linear, body.quadratic, strict=True):
        if linear or quadratic:
            yield row, nothing, float(linear), float(quadratic)


def _of_strip(strip: DragStrip) -> Iterable[Resistance]:
    line = strip.end - strip.start
    length = float(np.linalg.norm(line))
    # Rows of the last two right singular vectors of the line are across it.
    along, one, other = np.linalg.svd(line[None])[2]
    face = WATER_DENSITY / 2 * strip.diameter * length
    for point, share in gauss_points(strip):
        at = -cross_matrix(point)
        rows = [np.concatenate([axis, axis @ at]) for axis in (one, other)]
        yield rows[0], rows[1], 0.0, strip.across * face * share
    # The velocity along a line is the same at all its points.
    row = np.concatenate([along, along @ -cross_matrix(strip.start)])
    yield row, np.zeros(6), 0.0, strip.along * face


def cross_force(nu: FloatArray) -> FloatArray:
    """The matrices of ``nu x* f`` on forces, (..., 6, 6)."""
    out = np.zeros((*nu.shape, 6))
    out[..., :3, :3] = out[..., 3:, 3:] = cross_matrix(nu[..., 3:])
    out[..., 3:, :3] = cross_matrix(nu[..., :3])
    return out


def kirchhoff(momentum: FloatArray) -> FloatArray:
    """Skew-symmetric C with ``C nu = nu x* h`` for the momentum h = A nu, (..., 6, 6)."""
    out = np.zeros((*momentum.shape, 6))
    linear = cross_matrix(momentum[..., :3])
    out[..., :3, 3:] = out[..., 3:, :3] = -linear
    out[..., 3:, 3:] = -cross_matrix(momentum[..., 3:])
    return out
