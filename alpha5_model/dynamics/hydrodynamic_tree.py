"""A tree of joints in moving water: every joint its own, the base on a free-flyer.

The velocities of an arm are ``G v`` in it, so the arm's torques are ``G^T tau``; on a fixed base the first six of the
tree's torques are the load on the mount. Nothing is checked here.
"""

from __future__ import annotations

import threading
from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import Any

import numpy as np
import pinocchio as pin

from alpha5_model.checks import FloatArray
from alpha5_model.dynamics.hydrostatics import displaced_fluid_model
from alpha5_model.dynamics.models import on_free_flyer
from alpha5_model.dynamics.moving_water import JointWater, MovingWater, cross_force, kirchhoff
from alpha5_model.dynamics.states import expanded
from alpha5_model.errors import InputError
from alpha5_model.spatial import cross_matrix

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
        tree, displaced, density = still._arguments[:3]
        fluid = displaced_fluid_model(tree, displaced, density)
        self.g, self._g_q, self._g_0 = still._embedding
        if not still.floating_base:
            tree, fluid = on_free_flyer(tree), on_free_flyer(fluid)
            self.g = np.vstack([np.zeros((6, self.g.shape[1])), self.g])
            self._g_q = np.vstack([np.zeros((7, self._g_q.shape[1])), self._g_q])
            self._g_0 = np.concatenate([pin.neutral(tree)[:7], self._g_0])
        self._tree, self._fluid, self._joints = tree, fluid, range(1, tree.njoints)
        self.water = MovingWater(list(tree.names)[1:], bodies, density)
        self._own = _Memory(tree, fluid)

    def expand(self, q: FloatArray, *rates: FloatArray) -> list[FloatArray]:
        """States (..., n) of the tree."""
        return expanded((self.g, self._g_q, self._g_0), q, *rates)

    def jacobians(self, q: FloatArray) -> FloatArray:
        """Twist of each of the tree's joints, in its frame, by the arm's velocities, (joints, 6, nv)."""
        data = self._own.data
        pin.computeJointJacobians(self._tree, data, q)
        found = [pin.getJointJacobian(self._tree, data, i, pin.LOCAL) for i in self._joints]
        return np.asarray(np.array(found) @ self.g)

    def motion(self, state: State, current: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Velocities of the tree's joints relative to the water, and their rates, (joints, 6, 1)."""
        own, (q, v, a) = self._own, state
        if current.any():
            # An arm that moves as this one does, seen from the water: its base drifts against the current.
            stream = current @ pin.XYZQUATToSE3(q[:7]).rotation
            v, a = v.copy(), a.copy()
            v[:3] -= stream
            a[:3] += cross_matrix(v[3:6]) @ stream
        pin.forwardKinematics(self._tree, own.data, q, v, a)
        return np.array(own.velocities)[..., None], np.array(own.accelerations)[..., None]

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
        rates = [pin.getJointJacobianTimeVariation(tree, data, i, pin.LOCAL) for i in self._joints]
        nu, _ = self.motion((q, v, np.zeros_like(v)), np.zeros(3))
        inner = added @ (np.array(rates) @ self.g) + kirchhoff((added @ nu)[..., 0]) @ jacobians
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
        for view, one in zip(own.force_views, force, strict=True):
            view[:] = one
        tau: FloatArray = pin.rnea(self._tree, own.data, *state, own.forces)
        tau -= pin.computeGeneralizedGravity(self._fluid, own.fluid_data, state[0])
        return tau

    def water_torques(self, states: State, currents: FloatArray) -> FloatArray:
        """What moving water adds to `torque`, of each row, (N, tree nv).

        Raises:
            InputError: A joint that neither turns about one axis nor slides along one.
        """
        found = [
            self._water_torques(
                *(np.ascontiguousarray(x[i : i + _BLOCK].T) for x in (*states, currents))
            )
            for i in range(0, len(currents), _BLOCK)
        ]
        return np.concatenate([np.zeros((0, self._tree.nv)), *(tau.T for tau in found)])

    def _water_torques(
        self, q: FloatArray, v: FloatArray, a: FloatArray, currents: FloatArray
    ) -> FloatArray:
        """The same of columns: twists down the tree, forces up, all states at once."""
        motion = np.empty((len(self._joints), 2, 6, q.shape[1]))  # twists and their rates
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
            first, second = (np.sin(angle), 1 - np.cos(angle)) if turns else (angle, 0 * angle)
            weights.append(np.stack([np.ones_like(angle), first, second])[:, None])
            up = (terms @ motion[parent]).reshape(2, 3, 6, -1)
            motion[i] = up[:, 0] + first * up[:, 1] + second * up[:, 2]
            motion[i, 0] += s[:, None] * rate
            motion[i, 1] += s[:, None] * acceleration + (cross_force(s).T @ motion[i, 0]) * rate
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
            place, cross = tree.jointPlacements[i].actionInverse, cross_force(s).T  # minus [s]x
            terms = np.vstack([place, cross @ place, cross @ cross @ place])
            at = joint.idx_q, joint.idx_v
            out.append((tree.parents[i] - 1, terms, s, bool(s[3:].any()), at))
        return out

    def derivatives(
        self, state: State, current: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Of `torque`, by the arm's q, v, a, (tree nv, nv) each, and by the current, (tree nv, 3)."""
        own, water, tree, data = self._own, self.water, self._tree, self._own.data
        nu, dnu = self.motion(state, current)
        stream = current @ np.array(own.rotations)
        for view, one in zip(own.force_views, water.force(nu, dnu)[..., 0], strict=True):
            view[:] = one
        dq, dv, da = (x.copy() for x in pin.computeRNEADerivatives(tree, data, *state, own.forces))
        dq -= pin.computeGeneralizedGravityDerivatives(self._fluid, own.fluid_data, state[0])
        # Next, how each joint's velocity and acceleration in its frame change with the state.
        pin.computeForwardKinematicsDerivatives(tree, data, *state)
        found = [
            pin.getJointAccelerationDerivatives(tree, data, i, pin.LOCAL) for i in self._joints
        ]
        v_q, a_q, a_v, a_a = (np.array(x) for x in zip(*found, strict=True))
        v_v, rotations = a_a, np.array(own.rotations)
        # A turn of the joint's frame turns the stream in it the other way.
        stream_q, stream_u = cross_matrix(stream) @ v_v[:, 3:], rotations.swapaxes(1, 2)
        spin, back = cross_matrix(nu[:, 3:, 0]), -cross_matrix(stream)
        v_q[:, :3] -= stream_q
        a_q[:, :3] += spin @ stream_q + back @ v_q[:, 3:]
        a_v[:, :3] += back @ v_v[:, 3:]
        by_velocity, added, linear = water.force_by_velocity(nu), water.added_mass, slice(3)
        dq -= np.einsum("jai,jak->ik", v_v, by_velocity @ v_q - added @ a_q)
        dv -= np.einsum("jai,jak->ik", v_v, by_velocity @ v_v - added @ a_v)
        da += np.einsum("jai,jak->ik", v_v, added @ a_a)
        change = -by_velocity[:, :, linear] @ stream_u - added[:, :, linear] @ (spin @ stream_u)
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
        self.force_views = [self.forces[i].vector for i in joints]
