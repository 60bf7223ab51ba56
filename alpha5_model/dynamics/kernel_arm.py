"""The arm on the generated kernels, which the compiled module calls for one state."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import wraps
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray
from alpha5_model.codegen.kernels import choice as kernels
from alpha5_model.dynamics.arm import Arm, Forces
from alpha5_model.dynamics.buoyancy import Displacement
from alpha5_model.dynamics.kernel_numbers import kernel_name
from alpha5_model.dynamics.states import state_vectors
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Alpha5Parameters

#: Method of `Arm` with a kernel of the same name -> its inputs.
_INPUTS = {
    "jacobian": ("q",),
    "mass_matrix": ("q",),
    "gravity_torque": ("q",),
    "buoyancy_torque": ("q",),
    "hydrostatic_torque": ("q",),
    "hydrostatic_torque_derivative": ("q",),
    "coriolis_matrix": ("q", "v"),
    "nonlinear_effects": ("q", "v"),
    "inverse_dynamics": ("q", "v", "a"),
    "inverse_dynamics_derivatives": ("q", "v", "a"),
    "base_wrench_derivatives": ("q", "v", "a"),
    "forward_dynamics": ("q", "v", "tau"),
    "forward_dynamics_derivatives": ("q", "v", "tau"),
}
_NO_FORCE = pin.Force.Zero()


class KernelArm(Arm):
    """An `Arm` on a fixed base with locked jaws.

    The methods of an instance are compiled kernels, which accept plain states only.
    They call the methods of the class for any other input. Those convert the state for
    the kernel, or call Pinocchio.
    """

    def __init__(
        self,
        model: pin.Model,
        displacements: Iterable[Displacement],
        fluid_density: float,
        *,
        parameters: Alpha5Parameters | None = None,
    ) -> None:
        super().__init__(model, displacements, fluid_density, parameters=parameters)
        numbers = self._kernel_parameters
        if numbers is None:
            expected = "the joints of a Reach Alpha 5 on a fixed base"
            raise InputError("model", model, expected)

        bind = kernels.module().bind
        names = {method: kernel_name(method, numbers) for method in _INPUTS}
        self._kernels = {
            method: bind(kernel, numbers) for method, kernel in names.items()
        }
        self._kernels["base_wrench"] = bind("base_wrench", numbers)
        # The fallbacks are methods of another object. Methods of this one would make a
        # reference cycle, which keeps its memory until the garbage collector runs.
        plain = object.__new__(type(self))
        plain.__dict__ |= self.__dict__
        for method, kernel in names.items():
            self.__dict__[method] = bind(kernel, numbers, getattr(plain, method))

    def base_wrench(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, fext: Forces = None
    ) -> Any:
        if fext is not None:
            return super().base_wrench(q, v, a, fext)
        kernel = self._kernels["base_wrench"]
        out = kernel(q, v, a)
        if out is None:
            out = kernel(*self._converted(q=q, v=v, a=a))
        # This takes a fifth of the time of making a pin.Force from an array.
        wrench = _NO_FORCE.copy()
        wrench.vector = out
        return wrench

    def _converted(self, **state: Any) -> Iterable[FloatArray]:
        """A state, converted for the kernels.

        Raises:
            InputError: Not a state of this arm.
        """
        return map(np.ascontiguousarray, state_vectors(self._model, **state))

    def _rebuilt_afloat(
        self, model: pin.Model, displacements: Iterable[Displacement]
    ) -> Arm:
        # The kernels do not know a floating base.
        density = self.fluid_density
        return Arm(model, displacements, density, parameters=self.parameters)


def _strict(name: str, inputs: Sequence[str]) -> Callable[..., Any]:
    """A method that converts a state for its kernel, or raises an error.

    If it gets more than a state, such as external forces, Pinocchio computes.
    """
    method = getattr(Arm, name)

    @wraps(method)
    def strict(self: KernelArm, *given: Any, **named: Any) -> Any:
        missing = set(inputs[len(given) :])
        if len(given) > len(inputs) or named.keys() != missing:
            return method(self, *given, **named)
        state = dict(zip(inputs, given, strict=False), **named)
        in_order = {key: state[key] for key in inputs}
        return self._kernels[name](*self._converted(**in_order))

    return strict


for _name, _inputs in _INPUTS.items():
    setattr(KernelArm, _name, _strict(_name, _inputs))
