"""The arm with jaws: two fingers that follow the rod, ``q_finger = multiplier q_rod + offset``.

Pinocchio's mimic joints carry the kinematics, RNEA and CRBA with nv = 5. Its forward dynamics, derivatives
and energies refuse them, and its Coriolis matrix leaves out terms without a word (4.1). Those come here from the
tree, in which the fingers are joints of their own. With ``q_tree = G q + g_0`` and constant G the chain
rule is exact: ``tau = G^T tau_tree``, ``M = G^T M_tree G``, and so for every derivative.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Self

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray
from alpha5_model.description.urdf_reading import UrdfJoint
from alpha5_model.dynamics import batch
from alpha5_model.dynamics.arm import Arm, Forces
from alpha5_model.dynamics.hydrostatics import Displacement
from alpha5_model.dynamics.payload import Payload
from alpha5_model.fluids import SEA_WATER


def mimicking(tree: Any, mimics: Iterable[UrdfJoint]) -> Any:
    """A copy of a model in which the named joints follow their leaders."""
    model = tree.copy()
    for m in mimics:
        leader, joint = model.getJointId(m.mimic), model.getJointId(m.name)
        model = pin.transformJointIntoMimic(model, leader, joint, m.multiplier, m.offset)
    return model


class JawArm(Arm):
    """An `Arm` whose last coordinate ``axis_a`` [m] also turns the fingers; see there."""

    def __init__(
        self,
        tree: Any,
        mimics: Iterable[UrdfJoint],
        displacements: Iterable[Displacement],
        fluid_density: float = SEA_WATER,
    ) -> None:
        self._mimics = tuple(mimics)
        model = mimicking(tree, self._mimics)
        super().__init__(model, displacements, fluid_density)
        self._tree = Arm(tree, self.displacements, fluid_density)
        self._g, self._g_q, self._g_0 = _expansion(model, tree, self._mimics)

    def coriolis_matrix(self, q: ArrayLike, v: ArrayLike) -> FloatArray:
        q, v = self._clean_qv(q, v)
        return self._project(self._tree.coriolis_matrix(self._expand(q), self._g @ v))

    def forward_dynamics(
        self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, fext: Forces = None
    ) -> FloatArray:
        q, v, tau = self._clean_qvtau(q, v, tau)
        bias = self.inverse_dynamics(q, v, np.zeros_like(v), fext)
        return np.asarray(np.linalg.solve(self.mass_matrix(q), tau - bias), dtype=np.float64)

    def forward_dynamics_batch(
        self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, threads: int | None = None
    ) -> FloatArray:
        q, v, tau = batch.rows(self._model, q=q, v=v, tau=tau)
        rest = tau - self.inverse_dynamics_batch(q, v, np.zeros((1, self._model.nv)), threads)
        rows = [np.linalg.solve(self.mass_matrix(row), r) for row, r in zip(q, rest, strict=True)]
        return np.array(rows, dtype=np.float64).reshape(rest.shape)

    def inverse_dynamics_derivatives(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        q, v, a = self._clean_qva(q, v, a)
        g = self._g
        dq, dv, da = self._tree.inverse_dynamics_derivatives(self._expand(q), g @ v, g @ a)
        return self._project(dq), self._project(dv), self._project(da)

    def hydrostatic_torque_derivative(self, q: ArrayLike) -> FloatArray:
        q = self._clean_q(q)
        return self._project(self._tree.hydrostatic_torque_derivative(self._expand(q)))

    def base_wrench_batch(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, threads: int | None = None
    ) -> FloatArray:
        q, v, a = batch.rows(self._model, q=q, v=v, a=a)
        g = self._g.T
        return self._tree.base_wrench_batch(q @ self._g_q.T + self._g_0, v @ g, a @ g, threads)

    def base_wrench_derivatives(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        q, v, a = self._clean_qva(q, v, a)
        g = self._g
        dq, dv, da = self._tree.base_wrench_derivatives(self._expand(q), g @ v, g @ a)
        return dq @ g, dv @ g, da @ g

    def kinetic_energy(self, q: ArrayLike, v: ArrayLike) -> float:
        q, v = self._clean_qv(q, v)
        return self._tree.kinetic_energy(self._expand(q), self._g @ v)

    def potential_energy(self, q: ArrayLike) -> float:
        return self._tree.potential_energy(self._expand(self._clean_q(q)))

    def _expand(self, q: FloatArray) -> FloatArray:
        out: FloatArray = self._g_q @ q + self._g_0
        return out

    def _project(self, matrix: FloatArray) -> FloatArray:
        out: FloatArray = self._g.T @ matrix @ self._g
        return out

    def _holding(self, payload: Payload, frame: str) -> Self:
        self._frame(frame)
        tree, displacement = payload.attached(self._tree._model, frame)
        displaced = (*self.displacements, displacement)
        return type(self)(tree, self._mimics, displaced, self.fluid_density)

    def __reduce__(self) -> tuple[Any, ...]:
        # Pinocchio 4.1 pickles mimic joints into a model that crashes; the tree is sound.
        return type(self), (
            self._tree._model,
            self._mimics,
            self.displacements,
            self.fluid_density,
        )


def _expansion(
    model: Any, tree: Any, mimics: tuple[UrdfJoint, ...]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """G (tree.nv, nv), its form for positions (tree.nq, nq) and g_0 (tree.nq,)."""
    g, g_q, g_0 = np.zeros((tree.nv, model.nv)), np.zeros((tree.nq, model.nq)), np.zeros(tree.nq)
    following = {mimic.name: mimic for mimic in mimics}
    for name in tree.names[1:]:
        inner, scale = tree.joints[tree.getJointId(name)], 1.0
        leader = name
        if name in following:
            mimic = following[name]
            leader, scale, g_0[inner.idx_q] = mimic.source, mimic.multiplier, mimic.offset
        joint = model.joints[model.getJointId(leader)]
        for k in range(inner.nv):
            g[inner.idx_v + k, joint.idx_v + k] = scale
        for k in range(inner.nq):
            g_q[inner.idx_q + k, joint.idx_q + k] = scale
    return g, g_q, g_0
