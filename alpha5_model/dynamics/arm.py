"""The arm in motion under water: ``M(q) a + C(q, v) v + g(q) = tau + tau_buoyancy(q)``.

This is a thin layer over Pinocchio: single calls of the dynamics and kinematics are its
algorithms, on the models of the arm and of the fluid that it displaces
(`alpha5_model.dynamics.arm_model`). Batches run on generated kernels if those know the
arm (`alpha5_model.dynamics.batch`). Self-collision has a test of its own
(`alpha5_model.collision`). The fluid acts by its pressure at rest (buoyancy)
only. Nothing is published about drag and added mass; they are estimated, and
`Arm.with_hydrodynamics` returns an arm that has them.

Thread safety: an arm never changes after it is made, and each thread computes in its
own pin.Data, so one arm may be used from any number of threads. Results belong to the
caller.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model._support.checks import BoolArray, FloatArray, flag
from alpha5_model._support.renaming import renamed
from alpha5_model.dynamics.arm_model import ArmModel
from alpha5_model.dynamics.batch import kernel_rows, solved
from alpha5_model.dynamics.dimensions import check_dimensions, check_limits
from alpha5_model.dynamics.joint_tree import AT_ORIGIN, JointTree
from alpha5_model.dynamics.linear_model import LinearModel, linear_model
from alpha5_model.dynamics.model_changes import added_body, with_payload
from alpha5_model.dynamics.regression import Regressor, regressor
from alpha5_model.dynamics.states import Partials, forces
from alpha5_model.errors import InputError
from alpha5_model.numbers.jaws import tip_height
from alpha5_model.numbers.pose import tool_of

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm_collision import ArmCollision
    from alpha5_model.kinematics.pose import ApproachDirections
    from alpha5_model.water.arm import ArmOnVehicle, HydrodynamicArm
    from alpha5_model.water.vehicle import Vehicle

# Pinocchio's algorithms, bound once: a call takes 0.3 us, so that looking up the
# attribute of a module can be measured.
_Algorithm = Callable[..., FloatArray]
_rnea: _Algorithm = pin.rnea
_aba: _Algorithm = pin.aba
_crba: _Algorithm = pin.crba
_coriolis: _Algorithm = pin.computeCoriolisMatrix
_nonlinear_effects: _Algorithm = pin.nonLinearEffects
_gravity: _Algorithm = pin.computeGeneralizedGravity
_jacobian: _Algorithm = pin.computeFrameJacobian

#: External forces: one pin.Force for each joint, the universe included, in the joint's
#: frame.
Forces = Sequence[Any] | None


class Arm(ArmModel):
    """An arm in a fluid. Make one with `alpha5_model.load`.

    Arguments named q are (nq,), those named v, a, tau are (nv,); with a fixed base both
    are the number of joints. With a floating base, v and a begin with the spatial
    velocity and acceleration of base_link in its own axes, and tau with the wrench on
    it (linear before angular).

    Every method raises `InputError` or one of its kinds (`ShapeError`,
    `NonFiniteError`) for input that it cannot use.

    Attributes:
        model: pin.Model of the arm, for the caller. The arm computes on a copy, so
            changes of this one do not change the results of its methods. With jaws it
            has mimic joints, which not every algorithm of Pinocchio supports: see
            `alpha5_model.dynamics.joint_tree`.
        fluid_model: pin.Model of the displaced fluid: point masses ``rho V`` at the
            centres of buoyancy.
        displacements: The displaced volumes.
        fluid_density: [kg/m^3].
        parameters: The record that the arm was made from; the catalogue's for an arm
            that you made of a model of your own.
        floating_base: Whether the first joint is Pinocchio's free-flyer.
    """

    def forward_kinematics(self, q: ArrayLike, frame: str = "tcp") -> Any:
        """Pose of a frame.

        Beside the frames of the model there is ``tip``, midway between the tips of the
        fingers, with the axes of the tcp (`alpha5_model.tool_at_tip`). The jaws are
        closed, or moved by axis_a.

        Args:
            q: Joint positions, (nq,) [rad, and m for axis_a]; with a floating base,
                position [m] and quaternion (x, y, z, w) of base_link come first.
            frame: Name of a frame of the model, or ``tip``.

        Returns:
            pin.SE3 ``transform_frame_to_world``; the world is base_link if the base is
            fixed.

        Raises:
            InputError: q has the wrong shape or is not finite, or its quaternion has no
                unit norm.
            UnknownNameError: No such frame.
        """
        q = self._clean_q(q)
        scratch = self._scratch
        pin.framesForwardKinematics(self._model, scratch.data, q)
        if _is_tip(frame):
            placement, _ = self._tip(q)
            return scratch.placements[self._frame("link_4")] * placement
        return scratch.placements[self._frame(frame)].copy()

    def jacobian(
        self,
        q: ArrayLike,
        frame: str = "tcp",
        reference_frame: Any = pin.LOCAL_WORLD_ALIGNED,
    ) -> FloatArray:
        """Geometric Jacobian of a frame.

        Args:
            q: (nq,).
            frame: Name of a frame of the model, or ``tip``, which axis_a moves.
            reference_frame: Axes and point of the twist, a pin.ReferenceFrame. The
                default is the velocity of the frame's origin in the axes of the world.

        Returns:
            (6, nv), linear rows [m/rad] above angular rows, as Pinocchio has them.
        """
        q = self._clean_q(q)
        if type(reference_frame) is not pin.ReferenceFrame:
            expected = "pin.LOCAL, pin.WORLD or LOCAL_WORLD_ALIGNED"
            raise InputError("reference_frame", reference_frame, expected)
        if _is_tip(frame):
            return self._tip_jacobian(q, reference_frame)
        index = self._frame(frame)
        return _jacobian(self._model, self._scratch.data, q, index, reference_frame)

    def _tip(self, q: FloatArray) -> tuple[pin.SE3, FloatArray]:
        """Pose of the tip in link_4, and the velocity at unit rate of axis_a, (3,)."""
        record = self.parameters
        jaw = record.joints[4]
        moves = jaw.name in self.joint_names
        height, rate = tip_height(record, float(q[-1]) if moves else jaw.lower)
        rotation = tool_of(record).rotation
        placement = pin.SE3(rotation, np.array([0.0, 0.0, -height]))
        return placement, np.array([0.0, 0.0, -rate if moves else 0.0])

    def _tip_jacobian(self, q: FloatArray, reference_frame: Any) -> FloatArray:
        """Geometric Jacobian of the tip, (6, nv)."""
        placement, rate = self._tip(q)
        link_4 = self._frame("link_4")
        of_link = _jacobian(self._model, self._scratch.data, q, link_4, pin.LOCAL)
        jacobian: FloatArray = placement.inverse().action @ of_link
        jacobian[:3, -1] += placement.rotation.T @ rate
        if reference_frame == pin.LOCAL:
            return jacobian
        tip = self.forward_kinematics(q, "tip")
        if reference_frame == pin.LOCAL_WORLD_ALIGNED:
            tip.translation = np.zeros(3)
        return np.asarray(tip.action @ jacobian)

    def approach_directions(self, position: ArrayLike) -> ApproachDirections:
        """From which directions the arm reaches points; see `ApproachDirections`.

        Args:
            position: tcp in ``base_link``, (..., 3) [m].

        Raises:
            InputError: Also an arm whose model has other dimensions or limits than its
                record, or whose tool point is beside the wrist axis.
        """
        needed_for = "the inverse kinematics"
        check_dimensions(self._model, needed_for, arm=self.parameters)
        check_limits(self._model, needed_for, self.parameters)
        # These imports would delay the start of every command.
        from alpha5_model.kinematics import pose

        return pose.approach_directions(position, arm=self.parameters)

    def gravity_torque(self, q: ArrayLike) -> FloatArray:
        """Torque that holds the weight.

        This is g(q) on the left side of the equation of motion.

        Args:
            q: (nq,).

        Returns:
            (nv,) [N m, N].
        """
        return _gravity(self._model, self._scratch.data, self._clean_q(q))

    def buoyancy_torque(self, q: ArrayLike) -> FloatArray:
        """Generalized force that the fluid applies.

        This is on the right side of the equation of motion.

        Args:
            q: (nq,).

        Returns:
            (nv,) [N m, N].
        """
        return _gravity(self._fluid, self._scratch.fluid_data, self._clean_q(q))

    def hydrostatic_torque(self, q: ArrayLike) -> FloatArray:
        """Torque that holds the arm still in the fluid.

        This is ``gravity_torque - buoyancy_torque``.

        Args:
            q: (nq,).

        Returns:
            (nv,) [N m, N].
        """
        q = self._clean_q(q)
        scratch = self._scratch
        torque = _gravity(self._model, scratch.data, q)
        torque -= _gravity(self._fluid, scratch.fluid_data, q)
        return torque

    def hydrostatic_torque_derivative(self, q: ArrayLike) -> FloatArray:
        """Derivative of `hydrostatic_torque` with respect to q.

        On a floating base, q stands for its tangent space.

        Args:
            q: (nq,).

        Returns:
            (nv, nv): row = torque, column = coordinate.
        """
        tree = self._joint_tree
        data, fluid_data = self._data_of(tree)
        (position,) = tree.expand(self._clean_q(q))
        slope = pin.computeGeneralizedGravityDerivatives(tree.model, data, position)
        slope -= pin.computeGeneralizedGravityDerivatives(
            tree.fluid, fluid_data, position
        )
        return tree.project(slope)

    def buoyancy_wrenches(self, q: ArrayLike) -> Any:
        """Buoyancy as one wrench for each joint.

        Each acts at a centre of buoyancy (Archimedes).

        Args:
            q: (nq,).

        Returns:
            pin.StdVec_Force of length njoints, each in its joint's frame: Pinocchio's
            ``fext``. Entry 0 is what the fluid applies to bodies fixed to the universe,
            link_0 on a fixed base.
        """
        q = self._clean_q(q)
        data = self._scratch.data
        pin.forwardKinematics(self._model, data, q)
        out = pin.StdVec_Force([pin.Force.Zero()] * self._model.njoints)
        up = -self._model.gravity
        for joint, body in enumerate(self._fluid.inertias):
            if body.mass:
                # rho V g, acting at the centre
                out[joint] = body * data.oMi[joint].actInv(up)
        return out

    def potential_energy(self, q: ArrayLike) -> float:
        """Potential energy of weight and buoyancy [J].

        It is zero for a point at the world's origin.

        Its gradient is `hydrostatic_torque`. link_0 counts, on a fixed base as a
        constant.
        """
        tree = self._joint_tree
        data, fluid_data = self._data_of(tree)
        (position,) = tree.expand(self._clean_q(q))
        energy = pin.computePotentialEnergy(tree.model, data, position)
        energy -= pin.computePotentialEnergy(tree.fluid, fluid_data, position)
        # Pinocchio leaves out what is fixed to the universe.
        body, water = self._model.inertias[0], self._fluid.inertias[0]
        moment = body.mass * body.lever - water.mass * water.lever
        return float(energy - self._model.gravity.linear @ moment)

    def center_of_mass(self, q: ArrayLike) -> FloatArray:
        """Centre of mass of the whole arm, link_0 included, in base_link, (3,) [m]."""
        moving = pin.centerOfMass(self._model, self._scratch.data, self._in_base(q))
        # Pinocchio leaves out what is fixed to the universe.
        fixed = self._model.inertias[0]
        share = fixed.mass / self.total_mass
        return np.asarray(moving * (1.0 - share) + fixed.lever * share)

    def center_of_buoyancy(self, q: ArrayLike) -> FloatArray:
        """Centroid of the displaced volume in base_link, (3,) [m].

        This is of the whole arm, link_0 included.

        It does not depend on the fluid, and is there in air too.

        Raises:
            InputError: Also for an arm that displaces nothing.
        """
        q = self._in_base(q)
        if not self.displaced_volume:
            raise InputError("displacements", self.displacements, "a volume above 0")
        data = self._scratch.data
        pin.forwardKinematics(self._model, data, q)
        moment = np.zeros(3)
        for body in self.displacements:
            placement = data.oMi[self._model.getJointId(body.joint)]
            moment += body.volume * placement.act(np.array(body.cob))
        return moment / self.displaced_volume

    def in_collision(self, q: ArrayLike, margin: float = 0.0) -> bool | BoolArray:
        """Whether the arm touches itself.

        The bodies are primitives that enclose the drawn ones within 3 mm; links that
        turn against each other at a joint are not compared. Payloads and attached
        bodies have no shape. If an arm of your own has other lengths, the bodies stay
        in the frames of their links; a spacer (`AttachedBody`) moves the jaws' bodies.

        The answer is exact for these bodies: an overlap deeper than a nanometre is
        found. `alpha5_model.collision.self_collision` says how.

        Args:
            q: (nq,), or (..., nq) for many positions.
            margin: The arm must stay farther than this from itself [m].

        Returns:
            bool, or (...) bool.

        Raises:
            InputError: Also an arm with other dimensions than those of its record.
        """
        hit = self._collision.one(q, margin)
        return self._collision.touches(q, margin) if hit is None else hit

    def collision_distance(self, q: ArrayLike) -> float | FloatArray:
        """Smallest distance between two links that `in_collision` compares [m].

        It is negative if they overlap: the depth, to a micrometre.
        `closest_links` also says which.

        Args:
            q: (nq,), or (..., nq) for many positions.

        Returns:
            float, or (...).
        """
        return self._collision.distance(q)

    def closest_links(self, q: ArrayLike) -> tuple[tuple[str, str], float]:
        """The two links that are nearest to each other, or that overlap most.

        Args:
            q: (nq,).

        Returns:
            Their names, and their distance as of `collision_distance` [m].
        """
        return self._collision.closest(q)

    def collision_distance_gradient(self, q: ArrayLike) -> FloatArray:
        """Derivative of `collision_distance` by q, (nv,) [m/rad, and 1 for axis_a].

        The distance has kinks where another pair of bodies, or another point of them,
        becomes the nearest; there it is the derivative of one side. On a floating base,
        q stands for its tangent space, and the first six are 0.

        Args:
            q: (nq,).
        """
        return self._collision.gradient(q)

    def mass_matrix(self, q: ArrayLike) -> FloatArray:
        """Joint-space inertia M(q), (nv, nv), symmetric positive definite [kg m^2]."""
        return _crba(self._model, self._scratch.data, self._clean_q(q))

    def coriolis_matrix(self, q: ArrayLike, v: ArrayLike) -> FloatArray:
        """Coriolis matrix C(q, v), (nv, nv).

        C v is the Coriolis and centrifugal torque; ``dM/dt - 2 C`` is skew-symmetric.
        """
        tree = self._joint_tree
        data, _ = self._data_of(tree)
        state = tree.expand(*self._clean_qv(q, v))
        return tree.project(_coriolis(tree.model, data, *state))

    def nonlinear_effects(self, q: ArrayLike, v: ArrayLike) -> FloatArray:
        """``C(q, v) v + hydrostatic_torque(q)``, (nv,) [N m]."""
        q, v = self._clean_qv(q, v)
        water = _gravity(self._fluid, self._scratch.fluid_data, q)
        return _nonlinear_effects(self._model, self._scratch.data, q, v) - water

    def inverse_dynamics(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, fext: Forces = None
    ) -> FloatArray:
        """Joint torque for a motion, water included.

        It is computed by the recursive Newton-Euler algorithm.

        Args:
            q: (nq,).
            v: (nv,) [rad/s].
            a: (nv,) [rad/s^2].
            fext: Further external forces, one pin.Force for each joint in its frame.

        Returns:
            tau, (nv,) [N m].
        """
        q, v, a = self._clean_qva(q, v, a)
        scratch = self._scratch
        outside = () if fext is None else (forces(fext, self._model.njoints),)
        tau = _rnea(self._model, scratch.data, q, v, a, *outside)
        tau -= _gravity(self._fluid, scratch.fluid_data, q)
        return tau

    def regressor(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Regressor:
        """Inverse dynamics as a matrix times the base parameters, water included.

        Args:
            q: (4,), or (N, 4) for many states; a single row is used for all, here and
                below.
            v: (4,) or (N, 4).
            a: (4,) or (N, 4).

        Returns:
            The matrix (4, 38) or (N, 4, 38), the arm's base parameters (38,), their
            names and units.

        Raises:
            InputError: Also for an arm on a floating base, or with jaws that move.
        """
        return regressor(self, q, v, a)

    def forward_dynamics(
        self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, fext: Forces = None
    ) -> FloatArray:
        """Joint acceleration under a torque, water included.

        It is computed by the articulated-body algorithm.

        Args:
            q: (nq,).
            v: (nv,) [rad/s].
            tau: (nv,) [N m].
            fext: Further external forces, one pin.Force for each joint in its frame.

        Returns:
            a, (nv,) [rad/s^2].
        """
        q, v, tau = self._clean_qvtau(q, v, tau)
        if self._mimics:  # which ABA refuses
            bias = self.inverse_dynamics(q, v, np.zeros_like(v), fext)
            return solved(self.mass_matrix(q), tau - bias)
        scratch = self._scratch
        outside = () if fext is None else (forces(fext, self._model.njoints),)
        total = tau + _gravity(self._fluid, scratch.fluid_data, q)
        return _aba(self._model, scratch.data, q, v, total, *outside)

    def inverse_dynamics_derivatives(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike
    ) -> Partials:
        """Analytic derivatives of `inverse_dynamics` [Carpentier2018], water included.

        [Carpentier2018] Carpentier, Mansard: Analytical derivatives of rigid body
            dynamics algorithms, RSS 2018.

        Args:
            q: (nq,).
            v: (nv,).
            a: (nv,).

        Returns:
            dtau/dq, dtau/dv, dtau/da = M, each (nv, nv); dq in the tangent space for a
            floating base.
        """
        tree = self._joint_tree
        data, fluid_data = self._data_of(tree)
        state = tree.expand(*self._clean_qva(q, v, a))
        dq, dv, da = pin.computeRNEADerivatives(tree.model, data, *state)
        water = pin.computeGeneralizedGravityDerivatives(
            tree.fluid, fluid_data, state[0]
        )
        # Pinocchio hands out views of its data.
        slopes = dq - water, dv.copy(), da.copy()
        of_q, of_v, of_a = map(tree.project, slopes)
        return of_q, of_v, of_a

    def forward_dynamics_derivatives(
        self, q: ArrayLike, v: ArrayLike, tau: ArrayLike
    ) -> Partials:
        """Analytic derivatives of `forward_dynamics`, from those of its inverse.

        Args:
            q: (nq,).
            v: (nv,).
            tau: (nv,).

        Returns:
            da/dq, da/dv, da/dtau = M^-1, each (nv, nv); dq in the tangent space for a
            floating base.
        """
        a = self.forward_dynamics(q, v, tau)
        dq, dv, mass = self.inverse_dynamics_derivatives(q, v, a)
        inverse = np.asarray(np.linalg.inv(mass), dtype=np.float64)
        return -inverse @ dq, -inverse @ dv, inverse

    def linearized(
        self,
        q: ArrayLike,
        v: ArrayLike,
        tau: ArrayLike,
        dt: float | None = None,
        motors: bool = False,
    ) -> LinearModel:
        """The linear model ``dx/dt = A x + B u`` about a state.

        x = (dq, dv) departs from q and v, and u from tau. If tau does not hold the
        state, the state itself moves on, and x is what departs from this motion.

        Args:
            q: (nq,).
            v: (nv,).
            tau: (nv,) [N m]; ``hydrostatic_torque(q)`` holds an arm at rest.
            dt: Time step [s] of the exact discrete model ``x[k+1] = A x[k] + B u[k]``
                whose torque is held for a step; None for continuous time.
            motors: Adds the rotors' inertia and viscous friction, of those motors of
                the arm's record that were measured. Like all other methods it leaves
                them out unless asked. Coulomb friction is not linear: tau is without
                the torque that overcomes it.

        Returns:
            A, (2 nv, 2 nv), and B, (2 nv, nv); dq in the tangent space for a floating
            base.

        Raises:
            InputError: Also a step that is not above 0, or so long that A overflows.

        Warns:
            ImplausibleWarning: A step above 1 s, or ``motors`` of a record without
                rotor inertia and viscous friction.
        """
        q, v, tau = self._clean_qvtau(q, v, tau)
        return linear_model(self, q, v, tau, dt, flag("motors", motors))

    def base_wrench(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, fext: Forces = None
    ) -> Any:
        """Wrench that the arm exerts on its mount.

        Weight and buoyancy of link_0 are included.

        At rest it is the weight minus the buoyancy of the whole arm. With a floating
        base it is the wrench on whatever carries base_link through the motion q, v, a.

        Args:
            q: (nq,).
            v: (nv,).
            a: (nv,).
            fext: Further external forces on the arm, one pin.Force for each joint in
                its frame (entry 0: on link_0 of a fixed base).

        Returns:
            pin.Force at the origin and in the axes of base_link, force [N] and moment
            [N m].
        """
        q, v, a = self._clean_qva(q, v, a)
        scratch = self._scratch
        outside = () if fext is None else (forces(fext, self._model.njoints),)
        _rnea(self._model, scratch.data, q, v, a, *outside)
        _gravity(self._fluid, scratch.fluid_data, q)

        # The load of the first joint; on a floating base that is base_link itself.
        load = scratch.data.f[1] - scratch.fluid_data.f[1]
        if self.floating_base:
            return -load
        # RNEA stops at the first joint. The last step adds the fixed bodies.
        load = scratch.data.liMi[1].act(load) - self._weight_of_fixed
        return outside[0][0] - load if outside else -load

    def base_wrench_derivatives(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike
    ) -> Partials:
        """Analytic derivatives of `base_wrench`.

        Args:
            q: (nq,).
            v: (nv,).
            a: (nv,).

        Returns:
            dw/dq, dw/dv, dw/da, each (6, nv), force rows above moment rows; the
            coupling between arm and vehicle, linearised.
        """
        tree = self._floating_tree
        data, fluid_data = self._data_of(tree)
        state = tree.expand(*self._clean_qva(q, v, a))
        dq, dv, da = pin.computeRNEADerivatives(tree.model, data, *state)
        water = pin.computeGeneralizedGravityDerivatives(
            tree.fluid, fluid_data, state[0]
        )
        return (water - dq)[:6] @ tree.g, -dv[:6] @ tree.g, -da[:6] @ tree.g

    def kinetic_energy(self, q: ArrayLike, v: ArrayLike) -> float:
        """``v^T M(q) v / 2`` [J]."""
        _, velocity = self._clean_qv(q, v)
        return float(velocity @ self.mass_matrix(q) @ velocity) / 2

    def inverse_dynamics_batch(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, threads: int | None = None
    ) -> FloatArray:
        """`inverse_dynamics` of many states, in parallel.

        Args:
            q: (N, nq), one state in each row; a single row is used for all states, here
                and below.
            v: (N, nv).
            a: (N, nv).
            threads: At most, for Pinocchio, which computes an arm on a floating base or
                with jaws that move. None for all that this process may use. There is
                one for each full 5000 states, and only one in a forked process. For
                all other arms the kernels use one thread (`alpha5_model.backend`).

        Returns:
            (N, nv).
        """
        return kernel_rows(self, "inverse_dynamics", threads, q=q, v=v, a=a)

    def forward_dynamics_batch(
        self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, threads: int | None = None
    ) -> FloatArray:
        """`forward_dynamics` of many states, in parallel.

        Arguments are as of `inverse_dynamics_batch`.
        """
        return kernel_rows(self, "forward_dynamics", threads, q=q, v=v, tau=tau)

    def base_wrench_batch(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, threads: int | None = None
    ) -> FloatArray:
        """`base_wrench` of many states, in parallel.

        Args:
            q: (N, nq).
            v: (N, nv).
            a: (N, nv).
            threads: As in `inverse_dynamics_batch`.

        Returns:
            (N, 6): force [N] and moment [N m] on the mount, in base_link.
        """
        return kernel_rows(self, "base_wrench", threads, q=q, v=v, a=a)

    def with_payload(
        self,
        mass: float,
        com: ArrayLike = (0.0, 0.0, 0.0),
        inertia: ArrayLike | None = None,
        volume: float = 0.0,
        cob: ArrayLike | None = None,
        frame: str = "tcp",
    ) -> Self:
        """A new arm that holds a rigid body; this one stays as it is.

        Args:
            mass: [kg].
            com: Centre of mass in ``frame``, (3,) [m].
            inertia: At the COM in the axes of ``frame``, URDF sign, (3, 3) [kg m^2];
                None for a point mass.
            volume: Displaced volume [m^3].
            cob: Centre of buoyancy in ``frame``, (3,) [m]; None for the COM.
            frame: Name of the frame that carries it.

        Returns:
            The arm with one more body frame, ``payload`` (``payload_2``, ... for
            further ones).

        Raises:
            InputError: Negative mass or volume, or an inertia that no body can have.
            UnknownNameError: No such frame.

        Warns:
            ImplausibleWarning: A mass, distance, volume or density that is most likely
                meant in another unit, such as 500 g or 20 mm.
        """
        body = added_body(mass, com, inertia, volume, cob)
        model, displaced = with_payload(self._joint_tree.model, frame, body)
        return self._rebuilt(model, (*self.displacements, displaced))

    @renamed("current", "water_velocity")
    def with_hydrodynamics(
        self,
        water_velocity: ArrayLike = (0.0, 0.0, 0.0),
        level: str = "nominal",
        numbers: str = "estimated",
    ) -> HydrodynamicArm:
        """The same arm in moving water: with added mass and drag.

        They are estimated, not published, for the bodies of the catalogue. Of an arm of
        your own, they are in the frames of its links; what is attached adds none.

        Args:
            water_velocity: Velocity of the water, uniform, in base_link, also if the
                arm has a mount, (3,) [m/s]; in the world if the base floats.
            level: ``low``, ``nominal`` or ``high`` end of the numbers' interval.
            numbers: ``estimated`` (our own), or ``supplementary`` (strip theory of
                public repositories; worse).

        Raises:
            UnknownNameError: No such level or numbers, or a model without the arm's
                links.
            InputError: A model with other dimensions than its record. Make an arm with
                numbers of your own: ``HydrodynamicArm(arm, bodies, water_velocity)``.

        Warns:
            ImplausibleWarning: A current that no water has.
        """
        from alpha5_model.water.arm import in_moving_water

        return in_moving_water(self, water_velocity, level, numbers)

    def on_vehicle(self, vehicle: Vehicle) -> ArmOnVehicle:
        """This arm, afloat, with a vehicle in place of the mount.

        Only the vehicle has added mass and drag. For an arm that has them, too:
        ``arm.with_hydrodynamics().on_vehicle(vehicle)``.
        """
        from alpha5_model.water.arm import HydrodynamicArm

        return HydrodynamicArm(self, ()).on_vehicle(vehicle)

    def _in_base(self, q: ArrayLike) -> FloatArray:
        """q with base_link at the world's origin."""
        checked: FloatArray = self._clean_q(q)
        if not self.floating_base:
            return checked
        return np.concatenate([AT_ORIGIN, checked[7:]])

    @cached_property
    def _weight_of_fixed(self) -> Any:
        """Weight less buoyancy of what is fixed to the universe: link_0, a pin.Force.

        On a fixed base only; on a floating one link_0 moves.
        """
        gravity = self._model.gravity
        return self._model.inertias[0] * gravity - self._fluid.inertias[0] * gravity

    def _data_of(self, tree: JointTree) -> tuple[Any, Any]:
        """pin.Data of the bodies and of the fluid of a tree, of this thread."""
        if tree.is_arm:
            return self._scratch.data, self._scratch.fluid_data
        pool = self._scratch.pool
        return pool(tree.model).getData(0), pool(tree.fluid).getData(0)

    @cached_property
    def _collision(self) -> ArmCollision:
        from alpha5_model.dynamics.arm_collision import ArmCollision

        return ArmCollision(self._model, self.parameters)


def _is_tip(frame: Any) -> bool:
    """Whether a frame is the one between the finger tips, which no model has."""
    return isinstance(frame, str) and frame == "tip"
