"""The arm in motion under water: ``M(q) a + C(q, v) v + g(q) = tau + tau_buoyancy(q)``.

A thin layer over Pinocchio: every method is one or two of its algorithms, on the arm and on the fluid
that the arm displaces. The fluid acts by its pressure at rest (buoyancy) only: there is no drag and no
added mass, for which nothing is published.

Thread safety: an arm never changes after it is made, and each thread computes in its own pin.Data, so
one arm may be used from any number of threads. What a method returns belongs to the caller.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import Any, Self

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray
from alpha5_model.dynamics import batch
from alpha5_model.dynamics.hydrostatics import Displacement
from alpha5_model.dynamics.mount import Mount
from alpha5_model.dynamics.payload import Payload
from alpha5_model.dynamics.statics import Statics
from alpha5_model.dynamics.vectors import forces, motion_check, state_check
from alpha5_model.dynamics.water import SEA_WATER

# Bound once: where a whole call takes 0.6 us, looking up a module's attribute is seen.
_rnea, _aba, _crba = pin.rnea, pin.aba, pin.crba
_gravity, _kinetic_energy = pin.computeGeneralizedGravity, pin.computeKineticEnergy

#: External forces: one pin.Force for each joint, the universe included, in the joint's frame.
Forces = Sequence[Any] | None


class Arm(Statics):
    """An arm in a fluid. Make one with `alpha5_model.load`.

    Arguments named q are (nq,), those named v, a, tau are (nv,); with a fixed base both are the number
    of joints. With a floating base, v and a begin with the spatial velocity and acceleration of base_link in
    its own axes, and tau with the wrench on it (linear before angular).

    Every method raises `InputError` or one of its kinds (`ShapeError`, `NonFiniteError`) for input that it
    cannot use.
    """

    def __init__(
        self,
        model: Any,
        displacements: Iterable[Displacement],
        fluid_density: float = SEA_WATER,
    ) -> None:
        super().__init__(model, displacements, fluid_density)
        self._clean_qv = state_check(self._model)
        self._clean_qva = motion_check(self._model, "a")
        self._clean_qvtau = motion_check(self._model, "tau")

    def mass_matrix(self, q: ArrayLike) -> FloatArray:
        """Joint-space inertia M(q), (nv, nv), symmetric positive definite [kg m^2]."""
        q = self._clean_q(q)
        out: FloatArray = _crba(self._model, self._own.data, q)
        return out

    def coriolis_matrix(self, q: ArrayLike, v: ArrayLike) -> FloatArray:
        """C(q, v), (nv, nv), with ``dM/dt - 2 C`` skew-symmetric; C v is Coriolis and centrifugal."""
        q, v = self._clean_qv(q, v)
        out: FloatArray = pin.computeCoriolisMatrix(self._model, self._own.data, q, v)
        return out

    def nonlinear_effects(self, q: ArrayLike, v: ArrayLike) -> FloatArray:
        """``C(q, v) v + hydrostatic_torque(q)``, (nv,) [N m]."""
        q, v = self._clean_qv(q, v)
        own = self._own
        out: FloatArray = pin.nonLinearEffects(self._model, own.data, q, v) - _gravity(
            self._fluid, own.fluid_data, q
        )
        return out

    def inverse_dynamics(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, fext: Forces = None
    ) -> FloatArray:
        """Joint torque for a motion, by the recursive Newton-Euler algorithm, water included.

        Args:
            q: (nq,).
            v: (nv,) [rad/s].
            a: (nv,) [rad/s^2].
            fext: Further external forces, one pin.Force for each joint in its frame.

        Returns:
            tau, (nv,) [N m].
        """
        q, v, a = self._clean_qva(q, v, a)
        own = self._own
        tau: FloatArray
        if fext is None:
            tau = _rnea(self._model, own.data, q, v, a)
        else:
            tau = _rnea(self._model, own.data, q, v, a, forces(fext, self._model.njoints))
        tau -= _gravity(self._fluid, own.fluid_data, q)
        return tau

    def forward_dynamics(
        self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, fext: Forces = None
    ) -> FloatArray:
        """Joint acceleration under a torque, by the articulated-body algorithm, water included.

        Args:
            q: (nq,).
            v: (nv,) [rad/s].
            tau: (nv,) [N m].
            fext: Further external forces, one pin.Force for each joint in its frame.

        Returns:
            a, (nv,) [rad/s^2].
        """
        q, v, tau = self._clean_qvtau(q, v, tau)
        own = self._own
        outside = () if fext is None else (forces(fext, self._model.njoints),)
        total = tau + _gravity(self._fluid, own.fluid_data, q)
        out: FloatArray = _aba(self._model, own.data, q, v, total, *outside)
        return out

    def inverse_dynamics_derivatives(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Analytic derivatives of `inverse_dynamics` [Carpentier2018], water included.

        [Carpentier2018] Carpentier, Mansard: Analytical derivatives of rigid body dynamics algorithms,
        RSS 2018.

        Args:
            q: (nq,).
            v: (nv,).
            a: (nv,).

        Returns:
            dtau/dq, dtau/dv, dtau/da = M, each (nv, nv); dq in the tangent space for a floating base.
        """
        q, v, a = self._clean_qva(q, v, a)
        own = self._own
        dq, dv, da = pin.computeRNEADerivatives(self._model, own.data, q, v, a)
        water = pin.computeGeneralizedGravityDerivatives(self._fluid, own.fluid_data, q)
        # Pinocchio hands out views of its data here.
        return dq - water, dv.copy(), da.copy()

    def forward_dynamics_derivatives(
        self, q: ArrayLike, v: ArrayLike, tau: ArrayLike
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Analytic derivatives of `forward_dynamics`, from those of its inverse.

        Args:
            q: (nq,).
            v: (nv,).
            tau: (nv,).

        Returns:
            da/dq, da/dv, da/dtau = M^-1, each (nv, nv); dq in the tangent space for a floating base.
        """
        a = self.forward_dynamics(q, v, tau)
        dq, dv, mass = self.inverse_dynamics_derivatives(q, v, a)
        inverse = np.asarray(np.linalg.inv(mass), dtype=np.float64)
        return -inverse @ dq, -inverse @ dv, inverse

    def base_wrench(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, fext: Forces = None) -> Any:
        """Wrench that the arm exerts on its mount, weight and buoyancy of link_0 included.

        At rest it is the weight minus the buoyancy of the whole arm. With a floating base it is the
        wrench on whatever carries base_link through the motion q, v, a.

        Args:
            q: (nq,).
            v: (nv,).
            a: (nv,).
            fext: Further external forces on the arm, one pin.Force for each joint in its frame (entry 0:
                on link_0 of a fixed base).

        Returns:
            pin.Force at the origin and in the axes of base_link, force [N] and moment [N m].
        """
        q, v, a = self._clean_qva(q, v, a)
        own = self._own
        outside = () if fext is None else (forces(fext, self._model.njoints),)
        _rnea(self._model, own.data, q, v, a, *outside)
        _gravity(self._fluid, own.fluid_data, q)
        # What the first joint carries; with a floating base that is base_link itself.
        load = own.data.f[1] - own.fluid_data.f[1]
        if self.floating_base:
            return -load
        # RNEA stops at the first joint: the last step down to the bodies of the universe is taken here.
        load = self._link_0_load + own.data.liMi[1].act(load)
        return outside[0][0] - load if outside else -load

    def base_wrench_derivatives(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Analytic derivatives of `base_wrench`.

        Args:
            q: (nq,).
            v: (nv,).
            a: (nv,).

        Returns:
            dw/dq, dw/dv, dw/da, each (6, nv), force rows above moment rows; the coupling between arm and
            vehicle, linearised.
        """
        q, v, a = self._clean_qva(q, v, a)
        if self.floating_base:
            dq, dv, da = self.inverse_dynamics_derivatives(q, v, a)
            return -dq[:6], -dv[:6], -da[:6]
        return self._mount.derivatives(q, v, a)

    def kinetic_energy(self, q: ArrayLike, v: ArrayLike) -> float:
        """``v^T M(q) v / 2`` [J]."""
        q, v = self._clean_qv(q, v)
        energy: float = _kinetic_energy(self._model, self._own.data, q, v)
        return energy

    def inverse_dynamics_batch(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, threads: int | None = None
    ) -> FloatArray:
        """`inverse_dynamics` of many states, in parallel.

        Args:
            q: (N, nq), one state in each row; a single row is used for all states, here and below.
            v: (N, nv).
            a: (N, nv).
            threads: How many to use at most; None for all that this process may use. One for each full
                5000 states is used, and only one in a forked process.

        Returns:
            (N, nv).
        """
        states = batch.rows(self._model, q=q, v=v, a=a)
        return batch.inverse_dynamics(self._model, self._fluid, self._own.pools, threads, *states)

    def forward_dynamics_batch(
        self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, threads: int | None = None
    ) -> FloatArray:
        """`forward_dynamics` of many states, in parallel; arguments as `inverse_dynamics_batch`."""
        states = batch.rows(self._model, q=q, v=v, tau=tau)
        return batch.forward_dynamics(self._model, self._fluid, self._own.pools, threads, *states)

    def base_wrench_batch(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, threads: int | None = None
    ) -> FloatArray:
        """`base_wrench` of many states, in parallel.

        Args:
            q: (N, nq); v: (N, nv); a: (N, nv); threads: as in `inverse_dynamics_batch`.

        Returns:
            (N, 6): force [N] and moment [N m] on the mount, in base_link.
        """
        q, v, a = batch.rows(self._model, q=q, v=v, a=a)
        if self.floating_base:
            return -self.inverse_dynamics_batch(q, v, a, threads)[:, :6]
        return self._mount.wrenches(self._own.pools, threads, q, v, a)

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
            inertia: At the COM in the axes of ``frame``, URDF sign, (3, 3) [kg m^2]; None for a point mass.
            volume: Displaced volume [m^3].
            cob: Centre of buoyancy in ``frame``, (3,) [m]; None for the COM.
            frame: Name of the frame that carries it.

        Returns:
            The arm with one more body frame, ``payload`` (``payload_2``, ... for further ones).

        Raises:
            InputError: Negative mass or volume, or an inertia that no body can have.
            UnknownNameError: No such frame.
        """
        return self._holding(Payload.checked(mass, com, inertia, volume, cob), frame)

    def _holding(self, payload: Payload, frame: str) -> Self:
        self._frame(frame)
        model, displacement = payload.attached(self._model, frame)
        return type(self)(model, (*self.displacements, displacement), self.fluid_density)

    @cached_property
    def _mount(self) -> Mount:
        return Mount(self._model, self._fluid)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._model, self.displacements, self.fluid_density)

    def __repr__(self) -> str:
        base = "floating" if self.floating_base else "fixed"
        return (
            f"{type(self).__name__}({', '.join(self.joint_names)}; {base} base, "
            f"fluid {self.fluid_density:g} kg/m^3)"
        )
