"""A tree of joints in moving water: every joint its own, the base on a free-flyer.

The velocities of an arm are ``G v`` in it, so the arm's torques are ``G^T tau``; on a fixed base the first six of the
tree's torques are the load on the mount. Nothing is checked here.

The water's forces follow from the velocities relative to it: added mass in Kirchhoff's form,
``f = -(A dnu + nu x* A nu)`` [Fossen2011]_, and drag as a sum of resistances: each has two rows b of a twist, to the slip
``s = B nu``, and resists with ``-B^T (linear + quadratic |s|) s``. A strip is one resistance across it at each of its
Gauss points, and one along it. All joints and N states are computed at once; twists are linear before angular, each in
its joint's frame.

.. [Fossen2011] Fossen: Handbook of marine craft hydrodynamics and motion control, 2011, sections 6.3 and 6.4.
"""

from __future__ import annotations

import threading
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Any

import numpy as np
import pinocchio as pin

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import cross_matrix
from alpha5_model.dynamics.states import expanded
from alpha5_model.errors import InputError
from alpha5_model.numbers.hydrodynamics import (
    WATER_DENSITY,
    BodyHydrodynamics,
    gauss_points,
)

#: Two rows of a twist, linear and quadratic resistance.
Resistance = tuple[FloatArray, FloatArray, float, float]
#: States that are computed at once: what a processor's cache holds.
_BLOCK = 384
#: q, v, a of the tree; of batches, in rows.
State = Sequence[FloatArray]


class HydrodynamicTree:
    """The tree of an arm, and the water around it.

    Attributes:
        g: G, (tree nv, nv).
        water: What moves.
    """

    def __init__(self, still: Any, bodies: Iterable[JointWater]) -> None:
        self._tree, self._fluid, embedding = still._free
        self.g, self._joints = embedding[0], range(1, self._tree.njoints)
        #: States (..., n) of the tree.
        self.expand = partial(expanded, embedding)
        self.water = MovingWater([*self._tree.names][1:], bodies, still.fluid_density)
        self._own = _Memory(self._tree, self._fluid)

    def jacobians(self, q: FloatArray) -> FloatArray:
        """Twist of each of the tree's joints, in its frame, by the arm's velocities, (joints, 6, nv)."""
        data = self._own.data
        pin.computeJointJacobians(self._tree, data, q)
        found = [
            pin.getJointJacobian(self._tree, data, i, pin.LOCAL) for i in self._joints
        ]
        return np.asarray(np.array(found) @ self.g)

    def motion(
        self, state: State, current: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Velocities of the tree's joints relative to the water, and their rates, (joints, 6, 1)."""
        own, (q, v, a) = self._own, state
        if current.any():
            # An arm that moves as this one does, seen from the water: its base drifts against the current.
            stream = current @ pin.XYZQUATToSE3(q[:7]).rotation
            v, a = v.copy(), a.copy()
            v[:3] -= stream
            a[:3] += cross_matrix(v[3:6]) @ stream
        pin.forwardKinematics(self._tree, own.data, q, v, a)
        return np.array(own.velocities)[..., None], np.array(own.accelerations)[
            ..., None
        ]

    def mass(self, q: FloatArray) -> FloatArray:
        """Of the arm and of the water, in the arm's coordinates, (nv, nv)."""
        jacobians = self.jacobians(q)
        out = self.g.T @ pin.crba(self._tree, self._own.data, q) @ self.g
        out += np.einsum("jai,jab,jbk->ik", jacobians, self.water.added_mass, jacobians)
        return np.asarray((out + out.T) / 2)

    def coriolis(self, q: FloatArray, v: FloatArray) -> FloatArray:
        """In still water, in the arm's coordinates, (nv, nv)."""
        tree, data, added = self._tree, self._own.data, self.water.added_mass
        out = self.g.T @ pin.computeCoriolisMatrix(tree, data, q, v) @ self.g
        jacobians = self.jacobians(q)
        pin.computeJointJacobiansTimeVariation(tree, data, q, v)
        rates = [
            pin.getJointJacobianTimeVariation(tree, data, i, pin.LOCAL)
            for i in self._joints
        ]
        nu, _ = self.motion((q, v, np.zeros_like(v)), np.zeros(3))
        inner = (
            added @ (np.array(rates) @ self.g)
            + kirchhoff((added @ nu)[..., 0]) @ jacobians
        )
        return np.asarray(out + np.einsum("jai,jak->ik", jacobians, inner))

    def kinetic_energy(self, state: State, current: FloatArray) -> float:
        """Of the arm in the world and of the water relative to itself [J]."""
        q, v, _ = state
        nu, _ = self.motion(state, current)
        water = float((self.water.added_mass @ nu * nu).sum()) / 2
        return float(pin.computeKineticEnergy(self._tree, self._own.data, q, v)) + water

    def torque(
        self, state: State, current: FloatArray, outside: FloatArray | None = None
    ) -> FloatArray:
        """Inverse dynamics, (tree nv,); ``outside`` are further forces on the joints, (joints, 6)."""
        own = self._own
        force = self.water.force(*self.motion(state, current))[..., 0]
        if outside is not None:
            force += outside
        own.press(force)
        tau: FloatArray = pin.rnea(self._tree, own.data, *state, own.forces)
        tau -= pin.computeGeneralizedGravity(self._fluid, own.fluid_data, state[0])
        return tau

    def water_torques(self, states: State, currents: FloatArray) -> FloatArray:
        """What moving water adds to `torque`, of each row, (N, tree nv).

        Raises:
            InputError: A joint that neither turns about one axis nor slides along one.
        """
        out = np.empty((len(currents), self._tree.nv))
        for here in (slice(i, i + _BLOCK) for i in range(0, len(out), _BLOCK)):
            block = (np.ascontiguousarray(x[here].T) for x in (*states, currents))
            out[here] = self._water_torques(*block).T
        return out

    def _water_torques(self, *columns: FloatArray) -> FloatArray:
        """The same of columns of q, v, a and currents: twists down the tree, forces up, all states at once."""
        q, v, a, currents = columns
        motion = np.empty(
            (len(self._joints), 2, 6, q.shape[1])
        )  # twists and their rates
        motion[0] = v[:6], a[:6]
        axis, w = q[3:6], q[6]
        aside = np.cross(axis, currents, axis=0)
        stream = currents + 2 * (np.cross(axis, aside, axis=0) - w * aside)
        motion[0, 0, :3] -= stream
        motion[0, 1, :3] += np.cross(v[3:6], stream, axis=0)
        weights = []
        for i, (parent, terms, s, turns, at) in enumerate(self._links, 1):
            angle, rate, acceleration = q[at[0]], v[at[1]], a[at[1]]
            # exp(-angle [s]x): of a turn by Rodrigues' formula, of a slide its first two terms.
            first, second = (
                (np.sin(angle), 1 - np.cos(angle)) if turns else (angle, 0 * angle)
            )
            weights.append(np.stack([np.ones_like(angle), first, second])[:, None])
            up = (terms @ motion[parent]).reshape(2, 3, 6, -1)
            motion[i] = up[:, 0] + first * up[:, 1] + second * up[:, 2]
            motion[i, 0] += s[:, None] * rate
            motion[i, 1] += (
                s[:, None] * acceleration + (cross_force(s).T @ motion[i, 0]) * rate
            )
        force, tau = self.water.force(motion[:, 0], motion[:, 1]), np.empty_like(v)
        for i in range(len(self._links), 0, -1):
            parent, terms, s, _, at = self._links[i - 1]
            tau[at[1]] = -s @ force[i]
            force[parent] += terms.T @ (weights[i - 1] * force[i]).reshape(18, -1)
        tau[:6] = -force[0]
        return tau

    @cached_property
    def _links(self) -> list[tuple[int, FloatArray, FloatArray, bool, tuple[int, int]]]:
        """Of each joint but the first: parent, three terms of the twist into it (18, 6), axis (6,),
        whether it turns, and its places in q and v."""
        tree, out = self._tree, []
        data = tree.createData()
        pin.computeJointJacobians(tree, data, pin.neutral(tree))
        for i in self._joints[1:]:
            joint = tree.joints[i]
            if joint.nq != 1:
                expected = "joints that turn about or slide along an axis"
                raise InputError("model", joint.shortname(), expected)
            s = pin.getJointJacobian(tree, data, i, pin.LOCAL)[:, joint.idx_v]
            place, cross = (
                tree.jointPlacements[i].actionInverse,
                cross_force(s).T,
            )  # minus [s]x
            terms = np.vstack([place, cross @ place, cross @ cross @ place])
            at = joint.idx_q, joint.idx_v
            out.append((tree.parents[i] - 1, terms, s, bool(s[3:].any()), at))
        return out

    def derivatives(self, state: State, current: FloatArray) -> tuple[FloatArray, ...]:
        """Of `torque`, by the arm's q, v, a, (tree nv, nv) each, and by the current, (tree nv, 3)."""
        own, water, tree, data = self._own, self.water, self._tree, self._own.data
        nu, dnu = self.motion(state, current)
        stream = current @ np.array(own.rotations)
        own.press(water.force(nu, dnu)[..., 0])
        dq, dv, da = (
            x.copy() for x in pin.computeRNEADerivatives(tree, data, *state, own.forces)
        )
        dq -= pin.computeGeneralizedGravityDerivatives(
            self._fluid, own.fluid_data, state[0]
        )
        # Next, how each joint's velocity and acceleration in its frame change with the state.
        pin.computeForwardKinematicsDerivatives(tree, data, *state)
        of = partial(pin.getJointAccelerationDerivatives, tree, data)
        found = zip(*(of(i, pin.LOCAL) for i in self._joints), strict=True)
        v_q, a_q, a_v, a_a = map(np.array, found)
        v_v, rotations = a_a, np.array(own.rotations)
        # A turn of the joint's frame turns the stream in it the other way.
        stream_q, stream_u = cross_matrix(stream) @ v_v[:, 3:], rotations.swapaxes(1, 2)
        spin, back = cross_matrix(nu[:, 3:, 0]), -cross_matrix(stream)
        v_q[:, :3] -= stream_q
        a_q[:, :3] += spin @ stream_q + back @ v_q[:, 3:]
        a_v[:, :3] += back @ v_v[:, 3:]
        by_velocity, added, linear = (
            water.force_by_velocity(nu),
            water.added_mass,
            slice(3),
        )
        dq -= np.einsum("jai,jak->ik", v_v, by_velocity @ v_q - added @ a_q)
        dv -= np.einsum("jai,jak->ik", v_v, by_velocity @ v_v - added @ a_v)
        da += np.einsum("jai,jak->ik", v_v, added @ a_a)
        change = -by_velocity[:, :, linear] @ stream_u - added[:, :, linear] @ (
            spin @ stream_u
        )
        du = -np.einsum("jai,jak->ik", v_v, change)
        return dq @ self.g, dv @ self.g, da @ self.g, du


class _Memory(threading.local):
    """What Pinocchio computes in, one set for each thread, and views of what it finds there."""

    def __init__(self, tree: Any, fluid: Any) -> None:
        self.data, self.fluid_data = data, _ = tree.createData(), fluid.createData()
        joints = range(1, tree.njoints)
        self.velocities = [data.v[i].vector for i in joints]
        self.accelerations = [data.a[i].vector for i in joints]
        self.rotations = [data.oMi[i].rotation for i in joints]
        self.forces = pin.StdVec_Force([pin.Force.Zero()] * tree.njoints)
        self._views = [self.forces[i].vector for i in joints]

    def press(self, forces: FloatArray) -> None:
        """Set the forces on the joints, (joints, 6)."""
        for view, one in zip(self._views, forces, strict=True):
            view[:] = one


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
        """Whether it has no such damping, and strips, if any, in the joint's frame."""
        damped = self.linear.any() or self.quadratic.any()
        return not damped and (
            not self.data.strips or np.array_equal(self.action, np.eye(6))
        )


class MovingWater:
    """Added mass and drag on the joints of a tree, in a fluid; twists and forces are (joints, 6, N).

    Attributes:
        added_mass: (joints, 6, 6), in the joints' frames.
    """

    def __init__(
        self, joints: Iterable[str], bodies: Iterable[JointWater], density: float
    ) -> None:
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
                self._linear[i, k], self._quadratic[i, k] = (
                    share * linear,
                    share * quadratic,
                )
        self._rows = pairs.reshape(n, -1, 6) if pairs.size else np.zeros((n, 0, 6))
        self._columns = np.ascontiguousarray(self._rows.swapaxes(1, 2))
        # nu x* A nu is quadratic in nu: 36 products of two components, times constants.
        crossed = np.array([cross_force(axis) for axis in np.eye(6)])
        self._whirl = np.einsum("bac,jcd->jabd", crossed, self.added_mass).reshape(
            n, 6, 36
        )

    def force(self, nu: FloatArray, dnu: FloatArray) -> FloatArray:
        """Force of the water on each joint's bodies.

        Args:
            nu: Velocity relative to the water.
            dnu: Its rate of change in the joint's frame.
        """
        joints, _, n = nu.shape
        products = (nu[:, :, None] * nu[:, None]).reshape(joints, 36, n)
        slip, resistance, _ = self._slip(nu)
        drag = self._columns @ (slip * resistance[:, None]).reshape(
            joints, self._rows.shape[1], n
        )
        return np.asarray(-(self.added_mass @ dnu + self._whirl @ products + drag))

    def force_by_velocity(self, nu: FloatArray) -> FloatArray:
        """Derivative of `force` with respect to nu, of one state, (joints, 6, 6)."""
        slip, resistance, speed = self._slip(nu)
        growth = np.divide(
            self._quadratic, speed, out=np.zeros_like(speed), where=speed > 0
        )
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
        line = strip.end - strip.start
        # Rows of the last two right singular vectors of the line are across it.
        axes = np.linalg.svd(line[None])[2]
        face = WATER_DENSITY / 2 * strip.diameter * float(np.linalg.norm(line))
        for point, share in gauss_points(strip):
            _, one, other = axes @ np.hstack([np.eye(3), -cross_matrix(point)])
            yield one, other, 0.0, strip.across * face * share
        # The velocity along a line is the same at all its points.
        along = axes[0] @ np.hstack([np.eye(3), -cross_matrix(strip.start)])
        yield along, nothing, 0.0, strip.along * face
    for row, linear, quadratic in zip(
        np.eye(6), body.linear, body.quadratic, strict=True
    ):
        if linear or quadratic:
            yield row, nothing, float(linear), float(quadratic)


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
