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
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray
from alpha5_model.dynamics import batch
from alpha5_model.dynamics.arm import Arm, Forces
from alpha5_model.dynamics.hydrostatics import Displacement
from alpha5_model.dynamics.payload import Payload
from alpha5_model.dynamics.water import SEA_WATER


class JawArm(Arm):
    """An `Arm` whose last coordinate ``axis_a`` [m] also turns the fingers; see there."""

    def __init__(
        self,
        model: Any,
        tree: Any,
        displacements: Iterable[Displacement],
        fluid_density: float = SEA_WATER,
    ) -> None:
        super().__init__(model, displacements, fluid_density)
        self._tree = Arm(tree, self.displacements, fluid_density)
        self._g, self._g_q, self._g_0 = _expansion(self._model, tree)

    def coriolis_matrix(self, q: ArrayLike, v: ArrayLike) -> FloatArray:
        q, v = self._checked(q=q, v=v)
        return self._project(self._tree.coriolis_matrix(self._expand(q), self._g @ v))

    def forward_dynamics(
        self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, fext: Forces = None
    ) -> FloatArray:
        q, v, tau = self._checked(q=q, v=v, tau=tau)
        bias = self.inverse_dynamics(q, v, np.zeros_like(v), fext)
        out: FloatArray = np.linalg.solve(self.mass_matrix(q), tau - bias)
        return out

    def forward_dynamics_batch(
        self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, threads: int | None = None
    ) -> FloatArray:
        q, v, tau = batch.rows(self._model, q=q, v=v, tau=tau)
        rest = tau - self.inverse_dynamics_batch(q, v, np.zeros((1, self._model.nv)), threads)
        mass = np.array([self.mass_matrix(row) for row in q])
        out: FloatArray = np.linalg.solve(mass, rest[..., None])[..., 0]
        return out

    def inverse_dynamics_derivatives(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        q, v, a = self._checked(q=q, v=v, a=a)
        g = self._g
        dq, dv, da = self._tree.inverse_dynamics_derivatives(self._expand(q), g @ v, g @ a)
        return self._project(dq), self._project(dv), self._project(da)

    def hydrostatic_torque_derivative(self, q: ArrayLike) -> FloatArray:
        q = self._checked_q(q)
        return self._project(self._tree.hydrostatic_torque_derivative(self._expand(q)))

    def base_wrench_batch(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, threads: int | None = None
    ) -> FloatArray:
        q, v, a = batch.rows(self._model, q=q, v=v, a=a)
        g = self._g.T
        return self._tree.base_wrench_batch(q @ self._g_q.T + self._g_0, v @ g, a @ g, threads)

    def kinetic_energy(self, q: ArrayLike, v: ArrayLike) -> float:
        q, v = self._checked(q=q, v=v)
        return self._tree.kinetic_energy(self._expand(q), self._g @ v)

    def potential_energy(self, q: ArrayLike) -> float:
        return self._tree.potential_energy(self._expand(self._checked_q(q)))

    def _expand(self, q: FloatArray) -> FloatArray:
        out: FloatArray = self._g_q @ q + self._g_0
        return out

    def _project(self, matrix: FloatArray) -> FloatArray:
        out: FloatArray = self._g.T @ matrix @ self._g
        return out

    def _holding(self, payload: Payload, frame: str) -> Self:
        self._frame(frame)
        model, displacement = payload.attached(self._model, frame)
        tree, _ = payload.attached(self._tree._model, frame)
        return type(self)(model, tree, (*self.displacements, displacement), self.fluid_density)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (
            self._model,
            self._tree._model,
            self.displacements,
            self.fluid_density,
        )


def _expansion(model: Any, tree: Any) -> tuple[FloatArray, FloatArray, FloatArray]:
    """G (tree.nv, nv), its form for positions (tree.nq, nq) and g_0 (tree.nq,).

    They are read off the tree's joints by name; a joint that the model does not let move by itself follows
    the one that it mimics.
    """
    g, g_q, g_0 = np.zeros((tree.nv, model.nv)), np.zeros((tree.nq, model.nq)), np.zeros(tree.nq)
    for i in range(1, model.njoints):
        joint, inner = model.joints[i], tree.joints[tree.getJointId(model.names[i])]
        scale = 1.0
        if i in model.mimicking_joints:
            mimic = joint.extract()
            scale, g_0[inner.idx_q] = mimic.scaling, mimic.offset
        for k in range(inner.nv):
            g[inner.idx_v + k, joint.idx_v + k] = scale
        for k in range(inner.nq):
            g_q[inner.idx_q + k, joint.idx_q + k] = scale
    return g, g_q, g_0
