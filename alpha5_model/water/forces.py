"""The forces of moving water on the bodies of an arm: added mass and drag.

They follow from the velocities relative to the water. Added mass acts in Kirchhoff's
form, ``f = -(A dnu + nu x* A nu)`` [Fossen2011]_. Drag is a sum over elements. The
matrix B (2, 6) of an element picks two components of a twist, the slip ``s = B nu``.
The damping of this slip is ``d = linear + quadratic |s|``, and the element's wrench is
``-B^T d s``. A drag strip has one element across it at each of its Gauss points, and
one element along it.

Twists are linear before angular, each in its joint's frame. Arguments are not checked.

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
    """Added mass and drag of one body, which a joint carries.

    Attributes:
        body: Name of the body's frame.
        joint: Name of the joint; ``universe`` for a fixed base.
        action: Matrix from a twist at the joint to one in the body's frame, (6, 6).
        data: Added mass and drag strips, in the body's frame.
        linear, quadratic: Further damping of each component of the twist in the body's
            frame, (6,).
    """

    body: str
    joint: str
    action: FloatArray
    data: BodyHydrodynamics
    linear: FloatArray = field(default_factory=lambda: np.zeros(6))
    quadratic: FloatArray = field(default_factory=lambda: np.zeros(6))


class DragElement(NamedTuple):
    """Drag against two components of a twist, the slip.

    Attributes:
        one, other: Rows of B, which give the two components of the slip, (6,) each.
        linear: Force per speed.
        quadratic: Force per speed squared.
    """

    one: FloatArray
    other: FloatArray
    linear: float
    quadratic: float


class MovingWater:
    """Added mass and drag on the joints of a tree.

    Twists and forces of N states are (joints, 6, N).

    Attributes:
        added_mass: (joints, 6, 6), in the joints' frames.
    """

    def __init__(
        self, joints: Iterable[str], bodies: Iterable[JointWater], density: float
    ) -> None:
        """Collect the added mass and the drag elements of each joint.

        Args:
            joints: Names of the tree's joints. The first one also carries the bodies
                on joints that are not in the tree: those of a fixed base.
            bodies: The bodies with added mass and drag.
            density: Of the fluid [kg/m^3].
        """
        names = list(joints)
        # Added mass and drag are given for fresh water.
        density_ratio = density / WATER_DENSITY
        self.added_mass = np.zeros((len(names), 6, 6))
        elements: list[list[DragElement]] = [[] for _ in names]
        for body in bodies:
            joint = names.index(body.joint) if body.joint in names else 0
            to_body = body.action
            added_mass = density_ratio * to_body.T @ body.data.added_mass @ to_body
            self.added_mass[joint] += added_mass
            elements[joint] += [
                _at_joint(element, to_body) for element in _drag_elements(body)
            ]

        self._set_drag(elements, density_ratio)
        self._coriolis = _coriolis_coefficients(self.added_mass)

    def _set_drag(
        self, elements: Sequence[Sequence[DragElement]], density_ratio: float
    ) -> None:
        """Set the arrays of the drag elements, padded with zeros to equal numbers."""
        joints = len(elements)
        most = max(map(len, elements))
        rows = np.zeros((joints, 2, most, 6))
        self._linear = np.zeros((joints, most, 1))
        self._quadratic = np.zeros((joints, most, 1))
        for joint, of_joint in enumerate(elements):
            for k, element in enumerate(of_joint):
                rows[joint, 0, k] = element.one
                rows[joint, 1, k] = element.other
                self._linear[joint, k] = density_ratio * element.linear
                self._quadratic[joint, k] = density_ratio * element.quadratic

        # B of all elements of a joint, and its transpose.
        self._to_slip = rows.reshape(joints, 2 * most, 6)
        self._to_wrench = np.ascontiguousarray(self._to_slip.swapaxes(1, 2))

    def force(self, nu: FloatArray, dnu: FloatArray) -> FloatArray:
        """Force of the water on each joint's bodies, a wrench.

        Args:
            nu: Velocity relative to the water.
            dnu: Its rate of change in the joint's frame.
        """
        joints, _, n = nu.shape
        products = (nu[:, :, None] * nu[:, None]).reshape(joints, 36, n)
        slip, damping, _ = self._slip(nu)
        forces = (slip * damping[:, None]).reshape(joints, self._to_slip.shape[1], n)
        drag = self._to_wrench @ forces
        return np.asarray(-(self.added_mass @ dnu + self._coriolis @ products + drag))

    def force_by_velocity(self, nu: FloatArray) -> FloatArray:
        """Derivative of `force` with respect to nu, of one state, (joints, 6, 6)."""
        # The product rule on nu x* h with the momentum h = A nu.
        momentum = (self.added_mass @ nu)[..., 0]
        at_fixed_velocity = cross_force(nu[..., 0]) @ self.added_mass
        at_fixed_momentum = coriolis_matrix(momentum)
        drag = self._drag_by_velocity(nu)
        return np.asarray(-(at_fixed_velocity + at_fixed_momentum + drag))

    def _drag_by_velocity(self, nu: FloatArray) -> FloatArray:
        """Derivative of ``B^T d s``, summed over the elements, (joints, 6, 6).

        With slip ``s = (x, y)`` and growth ``g = quadratic / |s|``, the derivative of
        ``d s`` with respect to s is ``[[d + g x x, g x y], [g x y, d + g y y]]``.
        """
        slip, damping, speed = self._slip(nu)
        growth = np.divide(
            self._quadratic, speed, out=np.zeros_like(speed), where=speed > 0
        )
        x = slip[:, 0]
        y = slip[:, 1]
        one, other = np.split(self._to_slip, 2, axis=1)
        one_transposed = one.swapaxes(1, 2)
        other_transposed = other.swapaxes(1, 2)

        mixed = one_transposed @ (growth * x * y * other)
        of_one = one_transposed @ ((damping + growth * x * x) * one) + mixed
        of_other = other_transposed @ ((damping + growth * y * y) * other)
        return of_one + (of_other + mixed.swapaxes(1, 2))

    def dissipated_power(self, nu: FloatArray) -> FloatArray:
        """Power that drag takes out of the motion relative to the water, (N,) [W].

        It is never negative.
        """
        _, damping, speed = self._slip(nu)
        return np.asarray((damping * speed**2).sum(axis=(0, 1)))

    def _slip(self, nu: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Slip of each of k drag elements, its damping and its speed.

        Returns:
            s (joints, 2, k, N), d (joints, k, N) and |s| (joints, k, N).
        """
        joints, k, _ = self._linear.shape
        slip = (self._to_slip @ nu).reshape(joints, 2, k, nu.shape[2])
        speed = np.sqrt(slip[:, 0] ** 2 + slip[:, 1] ** 2)
        damping = self._linear + self._quadratic * speed
        return slip, damping, speed


def _coriolis_coefficients(added_mass: FloatArray) -> FloatArray:
    """``nu x* A nu`` as constants times the 36 products of two components of nu.

    Returns:
        (joints, 6, 36).
    """
    crossed = np.array([cross_force(axis) for axis in np.eye(6)])
    coefficients = np.einsum("bac,jcd->jabd", crossed, added_mass)
    return np.asarray(coefficients.reshape(len(added_mass), 6, 36))


def _at_joint(element: DragElement, to_body: FloatArray) -> DragElement:
    """An element for twists at the joint, from one for twists in the body's frame."""
    return element._replace(one=element.one @ to_body, other=element.other @ to_body)


def _drag_elements(body: JointWater) -> list[DragElement]:
    """Elements of a body's strips and further damping, for twists in its frame."""
    out = []
    for strip in body.data.strips:
        out += _elements_of_strip(strip)
    damping = zip(np.eye(6), body.linear, body.quadratic, strict=True)
    for row, linear, quadratic in damping:
        if linear or quadratic:
            out.append(
                DragElement(
                    one=row,
                    other=np.zeros(6),
                    linear=float(linear),
                    quadratic=float(quadratic),
                )
            )
    return out


def _elements_of_strip(strip: DragStrip) -> list[DragElement]:
    line = strip.end - strip.start
    # The last two right singular vectors of the line are across it.
    axes = np.linalg.svd(line[None])[2]
    # Half the density times the frontal area.
    drag_per_coefficient = (
        WATER_DENSITY / 2 * strip.diameter * float(np.linalg.norm(line))
    )

    out = []
    for point, weight in gauss_points(strip):
        _, one, other = axes @ _velocity_at(point)
        out.append(
            DragElement(
                one=one,
                other=other,
                linear=0.0,
                quadratic=strip.across * drag_per_coefficient * weight,
            )
        )
    # The velocity along a line is the same at all its points.
    along = DragElement(
        one=axes[0] @ _velocity_at(strip.start),
        other=np.zeros(6),
        linear=0.0,
        quadratic=strip.along * drag_per_coefficient,
    )
    return [*out, along]


def _velocity_at(point: FloatArray) -> FloatArray:
    """Matrix from a body's twist to the velocity of one of its points, (3, 6)."""
    return np.hstack([np.eye(3), -cross_matrix(point)])


def cross_force(nu: FloatArray) -> FloatArray:
    """Matrix of the spatial cross product ``nu x* f`` with a force, (..., 6, 6)."""
    linear = cross_matrix(nu[..., :3])
    angular = cross_matrix(nu[..., 3:])
    out = np.zeros((*nu.shape, 6))
    out[..., :3, :3] = angular
    out[..., 3:, :3] = linear
    out[..., 3:, 3:] = angular
    return out


def coriolis_matrix(momentum: FloatArray) -> FloatArray:
    """Skew-symmetric Coriolis matrix C with ``C nu = nu x* h``, (..., 6, 6).

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
