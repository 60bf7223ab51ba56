"""The arm whose single calls run on the generated kernels, too."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, TypeVar

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model import kernels
from alpha5_model.checks import FloatArray
from alpha5_model.dynamics.arm import Arm, Forces, Partials
from alpha5_model.dynamics.hydrostatics import Displacement
from alpha5_model.dynamics.states import state_vectors
from alpha5_model.errors import InputError

_ALIGNED, _NO_FORCE = pin.LOCAL_WORLD_ALIGNED, pin.Force.Zero()
_Kernel = Callable[..., FloatArray]
_Kernels = Callable[..., Partials]
_Result = TypeVar("_Result")


class KernelArm(Arm):
    """An `Arm` on a fixed base with locked jaws; see there.

    A kernel answers None where an argument is not plainly a state; it is then converted or refused.
    """

    def __init__(
        self, model: Any, displacements: Iterable[Displacement], fluid_density: float
    ) -> None:
        super().__init__(model, displacements, fluid_density)
        if self._kernel_parameters is None:
            raise InputError("model", model, "the joints of a Reach Alpha 5 on a fixed base")

        def bound(name: str) -> Any:
            return kernels.module().bind(name, self._kernel_parameters)

        self._gravity_torque: _Kernel = bound("gravity_torque")
        self._buoyancy_torque: _Kernel = bound("buoyancy_torque")
        self._hydrostatic_torque: _Kernel = bound("hydrostatic_torque")
        self._hydrostatic_derivative: _Kernel = bound("hydrostatic_torque_derivative")
        self._mass_matrix: _Kernel = bound("mass_matrix")
        self._coriolis_matrix: _Kernel = bound("coriolis_matrix")
        self._nonlinear_effects: _Kernel = bound("nonlinear_effects")
        self._inverse_dynamics: _Kernel = bound("inverse_dynamics")
        self._inverse_derivatives: _Kernels = bound("inverse_dynamics_derivatives")
        self._forward_dynamics: _Kernel = bound("forward_dynamics")
        self._forward_derivatives: _Kernels = bound("forward_dynamics_derivatives")
        self._base_wrench: _Kernel = bound("base_wrench")
        self._wrench_derivatives: _Kernels = bound("base_wrench_derivatives")
        self._jacobian: _Kernel = kernels.module().bind("jacobian", np.empty(0))

    def jacobian(
        self, q: ArrayLike, frame: str = "tcp", reference_frame: Any = _ALIGNED
    ) -> FloatArray:
        if reference_frame is not _ALIGNED or type(frame) is not str or frame != "tcp":
            return super().jacobian(q, frame, reference_frame)
        out = self._jacobian(q)
        return self._converted(self._jacobian, q) if out is None else out

    def gravity_torque(self, q: ArrayLike) -> FloatArray:
        out = self._gravity_torque(q)
        return self._converted(self._gravity_torque, q) if out is None else out

    def buoyancy_torque(self, q: ArrayLike) -> FloatArray:
        out = self._buoyancy_torque(q)
        return self._converted(self._buoyancy_torque, q) if out is None else out

    def hydrostatic_torque(self, q: ArrayLike) -> FloatArray:
        out = self._hydrostatic_torque(q)
        return self._converted(self._hydrostatic_torque, q) if out is None else out

    def hydrostatic_torque_derivative(self, q: ArrayLike) -> FloatArray:
        out = self._hydrostatic_derivative(q)
        return self._converted(self._hydrostatic_derivative, q) if out is None else out

    def mass_matrix(self, q: ArrayLike) -> FloatArray:
        out = self._mass_matrix(q)
        return self._converted(self._mass_matrix, q) if out is None else out

    def coriolis_matrix(self, q: ArrayLike, v: ArrayLike) -> FloatArray:
        out = self._coriolis_matrix(q, v)
        return self._converted(self._coriolis_matrix, q, v=v) if out is None else out

    def nonlinear_effects(self, q: ArrayLike, v: ArrayLike) -> FloatArray:
        out = self._nonlinear_effects(q, v)
        return self._converted(self._nonlinear_effects, q, v=v) if out is None else out

    def inverse_dynamics_derivatives(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Partials:
        out = self._inverse_derivatives(q, v, a)
        return self._converted(self._inverse_derivatives, q, v=v, a=a) if out is None else out

    def forward_dynamics_derivatives(self, q: ArrayLike, v: ArrayLike, tau: ArrayLike) -> Partials:
        out = self._forward_derivatives(q, v, tau)
        return self._converted(self._forward_derivatives, q, v=v, tau=tau) if out is None else out

    def base_wrench_derivatives(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Partials:
        out = self._wrench_derivatives(q, v, a)
        return self._converted(self._wrench_derivatives, q, v=v, a=a) if out is None else out

    def inverse_dynamics(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, fext: Forces = None
    ) -> FloatArray:
        if fext is not None:
            return super().inverse_dynamics(q, v, a, fext)
        out = self._inverse_dynamics(q, v, a)
        return self._converted(self._inverse_dynamics, q, v=v, a=a) if out is None else out

    def forward_dynamics(
        self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, fext: Forces = None
    ) -> FloatArray:
        if fext is not None:
            return super().forward_dynamics(q, v, tau, fext)
        out = self._forward_dynamics(q, v, tau)
        return self._converted(self._forward_dynamics, q, v=v, tau=tau) if out is None else out

    def base_wrench(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, fext: Forces = None) -> Any:
        if fext is not None:
            return super().base_wrench(q, v, a, fext)
        out = self._base_wrench(q, v, a)
        out = self._converted(self._base_wrench, q, v=v, a=a) if out is None else out
        wrench = _NO_FORCE.copy()  # a fifth of the time that a pin.Force of an array takes
        wrench.vector = out
        return wrench

    def _converted(
        self, kernel: Callable[..., _Result], q: ArrayLike, **rates: ArrayLike
    ) -> _Result:
        return kernel(*map(np.ascontiguousarray, state_vectors(self._model, q, **rates)))

    @property
    def _afloat(self) -> type[Arm]:
        return Arm
