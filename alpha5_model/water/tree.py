"""The dynamics of an arm's tree of joints in moving water.

Each joint of the tree has coordinates of its own, and its base is on a free-flyer
(`alpha5_model.dynamics.joint_tree`). The tree moves at ``v_tree = G v``, so the arm's
torques are ``G^T tau_tree``. On a fixed base, the first six of the tree's torques are
the load on the mount.

All joints of a state are computed at once. Twists are linear before angular, each in
its joint's frame. Arguments are not checked.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import cross_matrix
from alpha5_model.water.forces import JointWater, MovingWater, coriolis_matrix
from alpha5_model.water.tree_pass import TreePass

#: States that are computed at once: as many as the processor's cache holds.
_BLOCK = 384
#: q, v, a of the tree; of batches, in rows.
State = Sequence[FloatArray]


class _MotionDerivatives(NamedTuple):
    """Derivatives of the joints' velocities and accelerations relative to the water.

    Each is (joints, 6, tree nv), in the joints' frames.

    Attributes:
        v_q: Of the velocity, with respect to the position.
        v_v: Of the velocity, with respect to the velocity; also of the acceleration,
            with respect to the acceleration.
        a_q: Of the acceleration, with respect to the position.
        a_v: Of the acceleration, with respect to the velocity.
    """

    v_q: FloatArray
    v_v: FloatArray
    a_q: FloatArray
    a_v: FloatArray


class HydrodynamicTree:
    """The tree of an arm's joints, and the water around it.

    Attributes:
        g: G, (tree nv, nv).
        expand: Function from states of the arm to states of the tree.
        water: Added mass and drag.
    """

    def __init__(self, still: Any, bodies: Iterable[JointWater]) -> None:
        tree = still._floating_tree
        self._tree, self._fluid = tree.model, tree.fluid
        self._joints = range(1, self._tree.njoints)
        self.g = tree.g
        self.expand: Callable[..., list[FloatArray]] = tree.expand
        self.water = MovingWater([*self._tree.names][1:], bodies, still.fluid_density)
        self._scratch = _Scratch(self._tree, self._fluid)

    def jacobians(self, q: FloatArray) -> FloatArray:
        """Jacobians of the tree's joints for the arm's velocities, (joints, 6, nv)."""
        return np.asarray(self._tree_jacobians(q) @ self.g)

    def _tree_jacobians(self, q: FloatArray) -> FloatArray:
        """Jacobians of the tree's joints for its own velocities, (joints, 6, nv)."""
        data = self._scratch.data
        pin.computeJointJacobians(self._tree, data, q)
        of_tree = [
            pin.getJointJacobian(self._tree, data, joint, pin.LOCAL)
            for joint in self._joints
        ]
        return np.array(of_tree)

    def motion(
        self, state: State, water_velocity: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Velocities of the joints relative to the water, and their rates.

        Returns:
            (joints, 6, 1) each.
        """
        q, v, a = state
        if water_velocity.any():
            # In the frame of the water, the base drifts against the current.
            stream = water_velocity @ pin.XYZQUATToSE3(q[:7]).rotation
            v = v.copy()
            a = a.copy()
            v[:3] -= stream
            a[:3] += cross_matrix(v[3:6]) @ stream
        scratch = self._scratch
        pin.forwardKinematics(self._tree, scratch.data, q, v, a)
        velocities = np.array(scratch.velocities)
        accelerations = np.array(scratch.accelerations)
        return velocities[..., None], accelerations[..., None]

    def mass(self, q: FloatArray) -> FloatArray:
        """Mass matrix of the arm and of the water, (nv, nv)."""
        jacobians = self.jacobians(q)
        mass = self.g.T @ pin.crba(self._tree, self._scratch.data, q) @ self.g
        mass += np.einsum(
            "jai,jab,jbk->ik", jacobians, self.water.added_mass, jacobians
        )
        return np.asarray((mass + mass.T) / 2)

    def coriolis(self, q: FloatArray, v: FloatArray) -> FloatArray:
        """Coriolis matrix of the arm in still water, (nv, nv)."""
        tree = self._tree
        data = self._scratch.data
        added_mass = self.water.added_mass
        of_arm = self.g.T @ pin.computeCoriolisMatrix(tree, data, q, v) @ self.g

        jacobians = self.jacobians(q)
        pin.computeJointJacobiansTimeVariation(tree, data, q, v)
        of_tree = [
            pin.getJointJacobianTimeVariation(tree, data, joint, pin.LOCAL)
            for joint in self._joints
        ]
        rates = np.array(of_tree) @ self.g
        nu, _ = self.motion((q, v, np.zeros_like(v)), np.zeros(3))
        momentum = (added_mass @ nu)[..., 0]
        of_joints = added_mass @ rates + coriolis_matrix(momentum) @ jacobians
        return np.asarray(of_arm + np.einsum("jai,jak->ik", jacobians, of_joints))

    def kinetic_energy(self, state: State, water_velocity: FloatArray) -> float:
        """Energy of the arm in the world and of the water relative to itself [J]."""
        q, v, _ = state
        nu, _ = self.motion(state, water_velocity)
        of_water = float((self.water.added_mass @ nu * nu).sum()) / 2
        of_arm = float(pin.computeKineticEnergy(self._tree, self._scratch.data, q, v))
        return of_arm + of_water

    def torque(
        self,
        state: State,
        water_velocity: FloatArray,
        outside: FloatArray | None = None,
    ) -> FloatArray:
        """Inverse dynamics, (tree nv,).

        Args:
            state: q, v, a of the tree.
            water_velocity: In the world, (3,).
            outside: Further forces on the joints, (joints, 6).
        """
        scratch = self._scratch
        nu, dnu = self.motion(state, water_velocity)
        force = self.water.force(nu, dnu)[..., 0]
        if outside is not None:
            force += outside
        scratch.set_forces(force)
        tau: FloatArray = pin.rnea(self._tree, scratch.data, *state, scratch.forces)
        tau -= pin.computeGeneralizedGravity(self._fluid, scratch.fluid_data, state[0])
        return tau

    def torque_of_accelerating_water(
        self, q: FloatArray, acceleration: FloatArray
    ) -> FloatArray:
        """What an acceleration of all water adds to `torque`, (tree nv,).

        Relative to the water, the bodies accelerate the other way. Their added mass and
        the water that they displace resist that.

        Args:
            q: Of the tree.
            acceleration: Of the water in the world, (3,).
        """
        at_rest = np.zeros(self._tree.nv)
        relative = np.zeros(self._tree.nv)
        relative[:3] = -acceleration @ pin.XYZQUATToSE3(q[:7]).rotation

        fluid_data = self._scratch.fluid_data
        tau: FloatArray = pin.rnea(self._fluid, fluid_data, q, at_rest, relative).copy()
        tau -= pin.computeGeneralizedGravity(self._fluid, fluid_data, q)

        jacobians = self._tree_jacobians(q)
        forces = self.water.added_mass @ (jacobians @ relative)[..., None]
        tau += np.einsum("jai,jak->i", jacobians, forces)
        return tau

    def water_torques(self, states: State, currents: FloatArray) -> FloatArray:
        """What moving water adds to `torque`, for each state, (N, tree nv).

        Args:
            states: q, v, a of the tree, (N, tree nq) and (N, tree nv).
            currents: In the world, (N, 3).

        Raises:
            InputError: A joint that neither turns about one axis nor slides along one.
        """
        out = np.empty((len(currents), self._tree.nv))
        for start in range(0, len(out), _BLOCK):
            block = slice(start, start + _BLOCK)
            columns = [np.ascontiguousarray(x[block].T) for x in (*states, currents)]
            out[block] = self._pass.torques(*columns).T
        return out

    @cached_property
    def _pass(self) -> TreePass:
        return TreePass(self._tree, self.water)

    def derivatives(
        self, state: State, water_velocity: FloatArray
    ) -> tuple[FloatArray, ...]:
        """Derivatives of `torque` with respect to the arm's q, v, a and to the current.

        Returns:
            (tree nv, nv) three times, and (tree nv, 3).
        """
        nu, dnu = self.motion(state, water_velocity)
        rotations = np.array(self._scratch.rotations)
        stream = water_velocity @ rotations
        self._scratch.set_forces(self.water.force(nu, dnu)[..., 0])
        dq, dv, da = self._derivatives_at_fixed_forces(state)

        motion = self._motion_derivatives(state, nu, stream)
        by_velocity = self.water.force_by_velocity(nu)
        added_mass = self.water.added_mass

        def joint_torques(forces: FloatArray) -> FloatArray:
            """Generalized forces of forces on the joints, ``J^T f``."""
            return np.asarray(np.einsum("jai,jak->ik", motion.v_v, forces))

        dq -= joint_torques(by_velocity @ motion.v_q - added_mass @ motion.a_q)
        dv -= joint_torques(by_velocity @ motion.v_v - added_mass @ motion.a_v)
        da += joint_torques(added_mass @ motion.v_v)

        # How the stream in each joint's frame changes with the current.
        stream_u = rotations.swapaxes(1, 2)
        spin = cross_matrix(nu[:, 3:, 0])
        by_stream = -by_velocity[:, :, :3] @ stream_u
        by_stream_rate = added_mass[:, :, :3] @ (spin @ stream_u)
        du = -joint_torques(by_stream - by_stream_rate)
        return dq @ self.g, dv @ self.g, da @ self.g, du

    def _derivatives_at_fixed_forces(
        self, state: State
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Derivatives of `torque` while the forces of the water stay as they are."""
        scratch = self._scratch
        views = pin.computeRNEADerivatives(
            self._tree, scratch.data, *state, scratch.forces
        )
        dq, dv, da = (view.copy() for view in views)
        dq -= pin.computeGeneralizedGravityDerivatives(
            self._fluid, scratch.fluid_data, state[0]
        )
        return dq, dv, da

    def _motion_derivatives(
        self, state: State, nu: FloatArray, stream: FloatArray
    ) -> _MotionDerivatives:
        """How the motion relative to the water changes with the state of the tree.

        Args:
            state: q, v, a of the tree.
            nu: Velocities relative to the water, (joints, 6, 1).
            stream: The current in each joint's frame, (joints, 3).
        """
        data = self._scratch.data
        pin.computeForwardKinematicsDerivatives(self._tree, data, *state)
        found = [
            pin.getJointAccelerationDerivatives(self._tree, data, joint, pin.LOCAL)
            for joint in self._joints
        ]
        v_q, a_q, a_v, v_v = map(np.array, zip(*found, strict=True))

        # A turn of the joint's frame turns the stream in it the other way.
        stream_q = cross_matrix(stream) @ v_v[:, 3:]
        spin = cross_matrix(nu[:, 3:, 0])
        back = -cross_matrix(stream)
        v_q[:, :3] -= stream_q
        a_q[:, :3] += spin @ stream_q + back @ v_q[:, 3:]
        a_v[:, :3] += back @ v_v[:, 3:]
        return _MotionDerivatives(v_q=v_q, v_v=v_v, a_q=a_q, a_v=a_v)


class _Scratch(threading.local):
    """The memory that Pinocchio computes in, one set for each thread.

    Attributes:
        data, fluid_data: pin.Data of the tree and of the displaced fluid.
        velocities, accelerations, rotations: Views of `data`, one for each joint; the
            next computation changes them.
        forces: External forces on the joints, pin.StdVec_Force.
    """

    def __init__(self, tree: pin.Model, fluid: pin.Model) -> None:
        self.data = tree.createData()
        self.fluid_data = fluid.createData()
        joints = range(1, tree.njoints)
        self.velocities = [self.data.v[i].vector for i in joints]
        self.accelerations = [self.data.a[i].vector for i in joints]
        self.rotations = [self.data.oMi[i].rotation for i in joints]
        self.forces = pin.StdVec_Force([pin.Force.Zero()] * tree.njoints)
        self._views = [self.forces[i].vector for i in joints]

    def set_forces(self, forces: FloatArray) -> None:
        """Set the forces on the joints, (joints, 6)."""
        for view, force in zip(self._views, forces, strict=True):
            view[:] = force
