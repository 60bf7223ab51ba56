"""The arms beside `Arm`: with jaws, and on the generated kernels.

The jaws are two fingers that follow the rod, ``q_finger = multiplier q_rod + offset``.

Pinocchio's mimic joints serve for kinematics, RNEA and CRBA, with nv = 5. Its forward dynamics,
derivatives and energies refuse them, and its Coriolis matrix silently leaves out terms (4.1). Those
are computed here on the tree, in which the fingers are joints of their own. With ``q_tree = G q +
g_0`` and constant G the chain rule is exact: ``tau = G^T tau_tree``, ``M = G^T M_tree G``, and so
for every derivative.

Of the arm on kernels single calls are those of the compiled module themselves.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial, wraps
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray
from alpha5_model.codegen.kernels import choice as kernels
from alpha5_model.description.reading import UrdfJoint
from alpha5_model.dynamics.arm import Arm, Forces
from alpha5_model.dynamics.buoyancy import Displacement
from alpha5_model.dynamics.states import Embedding, Partials, expanded, state_vectors
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Alpha5Parameters

#: Inputs -> methods of `Arm` that the kernels of the same names compute.
_METHODS = {
    "q": "jacobian mass_matrix gravity_torque buoyancy_torque hydrostatic_torque hydrostatic_torque_derivative",
    "q v": "coriolis_matrix nonlinear_effects",
    "q v a": "inverse_dynamics inverse_dynamics_derivatives base_wrench_derivatives",
    "q v tau": "forward_dynamics forward_dynamics_derivatives",
}
_NO_FORCE = pin.Force.Zero()


def mimicking(tree: Any, mimics: Iterable[UrdfJoint]) -> Any:
    """A copy of a model in which the named joints follow their leaders."""
    model = tree.copy()
    for m in mimics:
        leader, joint = model.getJointId(m.mimic), model.getJointId(m.name)
        model = pin.transformJointIntoMimic(
            model, leader, joint, m.multiplier, m.offset
        )
    return model


class JawArm(Arm):
    """An `Arm` whose last coordinate ``axis_a`` [m] also turns the fingers; see there."""

    def __init__(
        self,
        tree: Any,
        displacements: Iterable[Displacement],
        fluid_density: float,
        mimics: Iterable[UrdfJoint],
        *,
        parameters: Alpha5Parameters | None = None,
    ) -> None:
        self._mimics = tuple(mimics)
        model = mimicking(tree, self._mimics)
        super().__init__(model, displacements, fluid_density, parameters=parameters)
        self._tree = Arm(
            tree, self.displacements, fluid_density, parameters=self.parameters
        )
        embedding = _expansion(model, tree, self._mimics)
        self._embedded = self._tree._model, self._tree._fluid, embedding
        self._g, self._expand = embedding[0], partial(expanded, embedding)

    def coriolis_matrix(self, q: ArrayLike, v: ArrayLike) -> FloatArray:
        return self._project(
            self._tree.coriolis_matrix(*self._expand(*self._clean_qv(q, v)))
        )

    def forward_dynamics(
        self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, fext: Forces = None
    ) -> FloatArray:
        q, v, tau = self._clean_qvtau(q, v, tau)
        bias = self.inverse_dynamics(q, v, np.zeros_like(v), fext)
        return np.asarray(
            np.linalg.solve(self.mass_matrix(q), tau - bias), dtype=np.float64
        )

    def inverse_dynamics_derivatives(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike
    ) -> Partials:
        state = self._expand(*self._clean_qva(q, v, a))
        dq, dv, da = map(self._project, self._tree.inverse_dynamics_derivatives(*state))
        return dq, dv, da

    def hydrostatic_torque_derivative(self, q: ArrayLike) -> FloatArray:
        tree = self._expand(self._clean_q(q))
        return self._project(self._tree.hydrostatic_torque_derivative(*tree))

    def kinetic_energy(self, q: ArrayLike, v: ArrayLike) -> float:
        return self._tree.kinetic_energy(*self._expand(*self._clean_qv(q, v)))

    def potential_energy(self, q: ArrayLike) -> float:
        return self._tree.potential_energy(*self._expand(self._clean_q(q)))

    def _project(self, matrix: FloatArray) -> FloatArray:
        return np.asarray(self._g.T @ matrix @ self._g)

    @property
    def _arguments(self) -> tuple[Any, ...]:
        # Pinocchio 4.1 pickles mimic joints into a model that crashes; the tree is sound.
        return self._tree._model, self.displacements, self.fluid_density, self._mimics


def _expansion(model: Any, tree: Any, mimics: Iterable[UrdfJoint]) -> Embedding:
    """G (tree.nv, nv), its form for positions (tree.nq, nq) and g_0 (tree.nq,)."""
    g, g_q, g_0 = (
        np.zeros((tree.nv, model.nv)),
        np.zeros((tree.nq, model.nq)),
        np.zeros(tree.nq),
    )
    following = {m.name: (m.mimic, m.multiplier, m.offset) for m in mimics}
    for name in tree.names[1:]:
        leader, scale, offset = following.get(name, (name, 1.0, 0.0))
        inner, joint = (
            tree.joints[tree.getJointId(name)],
            model.joints[model.getJointId(leader)],
        )
        n, n_q = np.arange(inner.nv), np.arange(inner.nq)
        g[inner.idx_v + n, joint.idx_v + n] = scale
        g_q[inner.idx_q + n_q, joint.idx_q + n_q] = scale
        g_0[inner.idx_q] = offset
    return g, g_q, g_0


class KernelArm(Arm):
    """An `Arm` on a fixed base with locked jaws; see there.

    The methods of an instance are its kernels. They leave to those of the class what is not plainly a state.
    """

    def __init__(
        self,
        model: Any,
        displacements: Iterable[Displacement],
        fluid_density: float,
        *,
        parameters: Alpha5Parameters | None = None,
    ) -> None:
        super().__init__(model, displacements, fluid_density, parameters=parameters)
        numbers = self._kernel_parameters
        bind = kernels.module().bind
        if numbers is None:
            raise InputError(
                "model", model, "the joints of a Reach Alpha 5 on a fixed base"
            )
        names = " ".join(_METHODS.values()).split()
        self._kernels = {name: bind(name, numbers) for name in [*names, "base_wrench"]}
        # Of another object: a circle through this one would keep its memory for long.
        plain = object.__new__(type(self))
        plain.__dict__ |= self.__dict__
        self.__dict__ |= {
            name: bind(name, numbers, getattr(plain, name)) for name in names
        }

    def _afloat(self, model: Any, displacements: Iterable[Displacement]) -> Arm:
        # The kernels do not know a floating base.
        density = self.fluid_density
        return Arm(model, displacements, density, parameters=self.parameters)

    def base_wrench(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, fext: Forces = None
    ) -> Any:
        if fext is not None:
            return super().base_wrench(q, v, a, fext)
        kernel, wrench = self._kernels["base_wrench"], _NO_FORCE.copy()
        out = kernel(q, v, a)
        # A fifth of the time that a pin.Force of an array takes.
        wrench.vector = kernel(*self._converted(q=q, v=v, a=a)) if out is None else out
        return wrench

    def _converted(self, **state: Any) -> Iterable[FloatArray]:
        return map(np.ascontiguousarray, state_vectors(self._model, **state))


def _strict(name: str, inputs: Sequence[str]) -> Callable[..., Any]:
    """A method that converts or refuses a state, and leaves what is more than a state to Pinocchio."""
    method = getattr(Arm, name)

    @wraps(method)
    def strict(self: KernelArm, *given: Any, **named: Any) -> Any:
        if len(given) > len(inputs) or named.keys() != {*inputs[len(given) :]}:
            return method(self, *given, **named)
        state = dict(zip(inputs, given, strict=False), **named)
        return self._kernels[name](
            *self._converted(**{key: state[key] for key in inputs})
        )

    return strict


for _inputs, _names in _METHODS.items():
    for _name in _names.split():
        setattr(KernelArm, _name, _strict(_name, _inputs.split()))
