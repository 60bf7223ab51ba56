"""The arm whose single calls run on the generated kernels, too."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import wraps
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model import kernels
from alpha5_model.checks import FloatArray
from alpha5_model.dynamics.arm import Arm, Forces
from alpha5_model.dynamics.hydrostatics import Displacement
from alpha5_model.dynamics.states import state_vectors
from alpha5_model.errors import InputError

#: Inputs -> methods of `Arm` that the kernels of the same names compute.
_METHODS = {
    "q": "jacobian mass_matrix gravity_torque buoyancy_torque hydrostatic_torque hydrostatic_torque_derivative",
    "q v": "coriolis_matrix nonlinear_effects",
    "q v a": "inverse_dynamics inverse_dynamics_derivatives base_wrench_derivatives",
    "q v tau": "forward_dynamics forward_dynamics_derivatives",
}
_NO_FORCE = pin.Force.Zero()


class KernelArm(Arm):
    """An `Arm` on a fixed base with locked jaws; see there.

    The methods of an instance are its kernels. They leave to those of the class what is not plainly a state.
    """

    def __init__(
        self, model: Any, displacements: Iterable[Displacement], fluid_density: float
    ) -> None:
        super().__init__(model, displacements, fluid_density)
        parameters, bind = self._kernel_parameters, kernels.module().bind
        if parameters is None:
            raise InputError("model", model, "the joints of a Reach Alpha 5 on a fixed base")
        names = " ".join(_METHODS.values()).split()
        self._kernels = {name: bind(name, parameters) for name in [*names, "base_wrench"]}
        # Of another object: a circle through this one would keep its memory for long.
        plain = object.__new__(type(self))
        plain.__dict__ |= self.__dict__
        self.__dict__ |= {name: bind(name, parameters, getattr(plain, name)) for name in names}

    def base_wrench(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, fext: Forces = None) -> Any:
        if fext is not None:
            return super().base_wrench(q, v, a, fext)
        kernel, wrench = self._kernels["base_wrench"], _NO_FORCE.copy()
        out = kernel(q, v, a)
        # A fifth of the time that a pin.Force of an array takes.
        wrench.vector = kernel(*self._converted(q=q, v=v, a=a)) if out is None else out
        return wrench

    def _converted(self, **state: Any) -> Iterable[FloatArray]:
        return map(np.ascontiguousarray, state_vectors(self._model, **state))

    @property
    def _afloat(self) -> type[Arm]:
        return Arm


def _strict(name: str, inputs: Sequence[str]) -> Callable[..., Any]:
    """A method that converts or refuses a state, and leaves what is more than a state to Pinocchio."""
    method = getattr(Arm, name)

    @wraps(method)
    def strict(self: KernelArm, *given: Any, **named: Any) -> Any:
        if len(given) > len(inputs) or named.keys() != {*inputs[len(given) :]}:
            return method(self, *given, **named)
        state = dict(zip(inputs, given, strict=False), **named)
        return self._kernels[name](*self._converted(**{key: state[key] for key in inputs}))

    return strict


for _inputs, _names in _METHODS.items():
    for _name in _names.split():
        setattr(KernelArm, _name, _strict(_name, _inputs.split()))
