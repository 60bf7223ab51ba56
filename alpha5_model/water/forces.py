"""The forces of moving water on the bodies of an arm: added mass and drag.

They follow from the velocities relative to the water. Added mass acts in Kirchhoff's
form, ``f = -(A dnu + nu x* A nu)`` [Fossen2011]_. Drag is a sum of resistances: each
has two rows b of a twist, which give the slip ``s = B nu``, and resists with ``-B^T
(linear + quadratic |s|) s``. A strip is one resistance across it at each of its Gauss
points, and one along it.

Twists are linear before angular, each in its joint's frame. Nothing is checked here.

.. [Fossen2011] Fossen: Handbook of marine craft hydrodynamics and motion control, 2011,
   sections 6.3 and 6.4.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import cross_matrix
from alpha5_model.numbers.hydrodynamics import (
    WATER_DENSITY,
    BodyHydrodynamics,
    DragStrip,
    gauss_points,
)


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

    @property
    def plain(self) -> bool:
        """Whether it has no further damping and strips in the joint's frame only."""
        if self.linear.any() or self.quadratic.any():
            return False
        return not self.data.strips or np.array_equal(self.action, np.eye(6))


class Resistance(NamedTuple):
    """A resistance to two components of a twist.

    Attributes:
        one, other: Rows that give the two components of the slip, (6,) each.
        linear: Force per speed.
        quadratic: Force per speed squared.
    """

    one: FloatArray
    other: FloatArray
    linear: float
    quadratic: float


class MovingWater:
    """Added mass and drag on the joints of a tree, in a fluid.

    Twists and forces are (joints, 6, N).

    Attributes:
        added_mass: (joints, 6, 6), in the joints' frames.
    """

    def __init__(
        self, joints: Iterable[str], bodies: Iterable[JointWater], density: float
    ) -> None:
        """Collect the added mass and the resistances of each joint.

        Args:
            joints: Names; the first one also carries what a fixed base carries.
            bodies: That move water.
            density: Of the fluid [kg/m^3].
        """
        names = list(joints)
        share = density / WATER_DENSITY
        self.added_mass = np.zeros((len(names), 6, 6))
        found: list[list[Resistance]] = [[] for _ in names]
        for body in bodies:
            at = names.index(body.joint) if body.joint in names else 0
            to_body = body.action
            self.added_mass[at] += share * to_body.T @ body.data.added_mass @ to_body
            found[at] += [_carried(one, to_body) for one in _resistances(body)]

        self._set_resistances(found, share)
        # nu x* A nu is quadratic in nu: 36 products of two components, times constants.
        crossed = np.array([cross_force(axis) for axis in np.eye(6)])
        whirl = np.einsum("bac,jcd->jabd", crossed, self.added_mass)
        self._whirl = whirl.reshape(len(names), 6, 36)

    def _set_resistances(
        self, found: Sequence[Sequence[Resistance]], share: float
    ) -> None:
        """Lay out the resistances of the joints as arrays, filled up with zeros."""
        joints = len(found)
        most = max(map(len, found))
        pairs = np.zeros((joints, 2, most, 6))
        self._linear = np.zeros((joints, most, 1))
        self._quadratic = np.zeros((joints, most, 1))
        for joint, resistances in enumerate(found):
            for k, resistance in enumerate(resistances):
                pairs[joint, 0, k] = resistance.one
                pairs[joint, 1, k] = resistance.other
                self._linear[joint, k] = share * resistance.linear
                self._quadratic[joint, k] = share * resistance.quadratic

        # Twist to slip, and resisting force to wrench.
        self._rows = pairs.reshape(joints, 2 * most, 6)
        self._columns = np.ascontiguousarray(self._rows.swapaxes(1, 2))

    def force(self, nu: FloatArray, dnu: FloatArray) -> FloatArray:
        """Force of the water on each joint's bodies.

        Args:
            nu: Velocity relative to the water.
            dnu: Its rate of change in the joint's frame.
        """
        joints, _, n = nu.shape
        products = (nu[:, :, None] * nu[:, None]).reshape(joints, 36, n)
        slip, resistance, _ = self._slip(nu)
        resisting = (slip * resistance[:, None]).reshape(joints, self._rows.shape[1], n)
        drag = self._columns @ resisting
        return np.asarray(-(self.added_mass @ dnu + self._whirl @ products + drag))

    def force_by_velocity(self, nu: FloatArray) -> FloatArray:
        """Derivative of `force` with respect to nu, of one state, (joints, 6, 6)."""
        momentum = (self.added_mass @ nu)[..., 0]
        whirl = kirchhoff(momentum)
        carried = cross_force(nu[..., 0]) @ self.added_mass
        return np.asarray(-(carried + whirl + self._drag_by_velocity(nu)))

    def _drag_by_velocity(self, nu: FloatArray) -> FloatArray:
        slip, resistance, speed = self._slip(nu)
        growth = np.divide(
            self._quadratic, speed, out=np.zeros_like(speed), where=speed > 0
        )
        x = slip[:, 0]
        y = slip[:, 1]
        one, other = np.split(self._rows, 2, axis=1)
        to_one = one.swapaxes(1, 2)
        to_other = other.swapaxes(1, 2)

        mixed = to_one @ (growth * x * y * other)
        of_one = to_one @ ((resistance + growth * x * x) * one) + mixed
        of_other = to_other @ ((resistance + growth * y * y) * other)
        return of_one + (of_other + mixed.swapaxes(1, 2))

    def dissipated_power(self, nu: FloatArray) -> FloatArray:
        """Power that drag takes out of the motion relative to the water, (N,) [W].

        It is never negative.
        """
        _, resistance, speed = self._slip(nu)
        return np.asarray((resistance * speed**2).sum(axis=(0, 1)))

    def _slip(self, nu: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Slip of each of k resistances, its strength and its speed.

        Returns:
            (joints, 2, k, N), (joints, k, N) and (joints, k, N).
        """
        joints, k, _ = self._linear.shape
        slip = (self._rows @ nu).reshape(joints, 2, k, nu.shape[2])
        speed = np.sqrt(slip[:, 0] ** 2 + slip[:, 1] ** 2)
        strength = self._linear + self._quadratic * speed
        return slip, strength, speed


def _carried(resistance: Resistance, action: FloatArray) -> Resistance:
    """A resistance to twists of the joint that carries its body."""
    return resistance._replace(
        one=resistance.one @ action, other=resistance.other @ action
    )


def _resistances(body: JointWater) -> list[Resistance]:
    """Those of a body's strips and of its further damping, to twists of the body."""
    out = []
    for strip in body.data.strips:
        out += _of_strip(strip)
    damping = zip(np.eye(6), body.linear, body.quadratic, strict=True)
    for row, linear, quadratic in damping:
        if linear or quadratic:
            out.append(
                Resistance(
                    one=row,
                    other=np.zeros(6),
                    linear=float(linear),
                    quadratic=float(quadratic),
                )
            )
    return out


def _of_strip(strip: DragStrip) -> list[Resistance]:
    line = strip.end - strip.start
    # The last two right singular vectors of the line are across it.
    axes = np.linalg.svd(line[None])[2]
    face = WATER_DENSITY / 2 * strip.diameter * float(np.linalg.norm(line))

    out = []
    for point, share in gauss_points(strip):
        _, one, other = axes @ _velocity_at(point)
        out.append(
            Resistance(
                one=one,
                other=other,
                linear=0.0,
                quadratic=strip.across * face * share,
            )
        )
    # The velocity along a line is the same at all its points.
    along = Resistance(
        one=axes[0] @ _velocity_at(strip.start),
        other=np.zeros(6),
        linear=0.0,
        quadratic=strip.along * face,
    )
    return [*out, along]


def _velocity_at(point: FloatArray) -> FloatArray:
    """The velocity of a point of a body, linear in the body's twist, (3, 6)."""
    return np.hstack([np.eye(3), -cross_matrix(point)])


def cross_force(nu: FloatArray) -> FloatArray:
    """The matrices of ``nu x* f`` on forces, (..., 6, 6)."""
    linear = cross_matrix(nu[..., :3])
    angular = cross_matrix(nu[..., 3:])
    out = np.zeros((*nu.shape, 6))
    out[..., :3, :3] = angular
    out[..., 3:, :3] = linear
    out[..., 3:, 3:] = angular
    return out


def kirchhoff(momentum: FloatArray) -> FloatArray:
    """Skew-symmetric C with ``C nu = nu x* h``, (..., 6, 6).

    Args:
        momentum: h = A nu, (..., 6).
    """
    linear = cross_matrix(momentum[..., :3])
    angular = cross_matrix(momentum[..., 3:])
    out = np.zeros((*momentum.shape, 6))
    out[..., :3, 3:] = -linear
    out[..., 3:, :3] = -linear
    out[..., 3:, 3:] = -angular
    return out
