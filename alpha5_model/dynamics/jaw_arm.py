"""The arm with jaws: two fingers that follow the rod, ``q_finger = multiplier q_rod + offset``.

Pinocchio's mimic joints serve for kinematics, RNEA and CRBA, with nv = 5. Its forward dynamics,
derivatives and energies refuse them, and its Coriolis matrix silently leaves out terms (4.1). Those
are computed here on the tree, in which the fingers are joints of their own. With ``q_tree = G q +
g_0`` and constant G the chain rule is exact: ``tau = G^T tau_tree``, ``M = G^T M_tree G``, and so
for every derivative.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray
from alpha5_model.description.urdf_reading import UrdfJoint
from alpha5_model.dynamics.arm import Arm, Forces, Partials
from alpha5_model.dynamics.batch import solved_rows
from alpha5_model.dynamics.hydrostatics import Displacement
from alpha5_model.dynamics.states import expanded, rows


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
        displacements: Iterable[Displacement],
        fluid_density: float,
        mimics: Iterable[UrdfJoint],
    ) -> None:
        self._mimics = tuple(mimics)
        model = mimicking(tree, self._mimics)
        super().__init__(model, displacements, fluid_density)
        self._tree = Arm(tree, self.displacements, fluid_density)
        self._g, self._g_q, self._g_0 = _expansion(model, tree, self._mimics)

    def coriolis_matrix(self, q: ArrayLike, v: ArrayLike) -> FloatArray:
        state = self._expand(*self._clean_qv(q, v))
        return self._project(self._tree.coriolis_matrix(*state))

    def forward_dynamics(
        self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, fext: Forces = None
    ) -> FloatArray:
        q, v, tau = self._clean_qvtau(q, v, tau)
        bias = self.inverse_dynamics(q, v, np.zeros_like(v), fext)
        return np.asarray(np.linalg.solve(self.mass_matrix(q), tau - bias), dtype=np.float64)

    def forward_dynamics_batch(
        self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, threads: int | None = None
    ) -> FloatArray:
        return solved_rows(self, q, v, tau, threads)

    def inverse_dynamics_derivatives(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Partials:
        state = self._expand(*self._clean_qva(q, v, a))
        dq, dv, da = self._tree.inverse_dynamics_derivatives(*state)
        return self._project(dq), self._project(dv), self._project(da)

    def hydrostatic_torque_derivative(self, q: ArrayLike) -> FloatArray:
        state = self._expand(self._clean_q(q))
        return self._project(self._tree.hydrostatic_torque_derivative(*state))

    def base_wrench_batch(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, threads: int | None = None
    ) -> FloatArray:
        q, v, a = self._expand(*rows(self._model, q=q, v=v, a=a))
        return self._tree.base_wrench_batch(q, v, a, threads)

    def base_wrench_derivatives(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Partials:
        state = self._expand(*self._clean_qva(q, v, a))
        dq, dv, da = self._tree.base_wrench_derivatives(*state)
        return dq @ self._g, dv @ self._g, da @ self._g

    def kinetic_energy(self, q: ArrayLike, v: ArrayLike) -> float:
        return self._tree.kinetic_energy(*self._expand(*self._clean_qv(q, v)))

    def potential_energy(self, q: ArrayLike) -> float:
        return self._tree.potential_energy(*self._expand(self._clean_q(q)))

    def _expand(self, q: FloatArray, *rates: FloatArray) -> list[FloatArray]:
        """States (..., n) of the tree."""
        return expanded(self._embedding, q, *rates)

    def _project(self, matrix: FloatArray) -> FloatArray:
        out: FloatArray = self._g.T @ matrix @ self._g
        return out

    @property
    def _embedding(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        return self._g, self._g_q, self._g_0

    @property
    def _arguments(self) -> tuple[Any, ...]:
        # Pinocchio 4.1 pickles mimic joints into a model that crashes; the tree is sound.
        return self._tree._model, self.displacements, self.fluid_density, self._mimics


def _expansion(
    model: Any, tree: Any, mimics: Iterable[UrdfJoint]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """G (tree.nv, nv), its form for positions (tree.nq, nq) and g_0 (tree.nq,)."""
    g, g_q, g_0 = np.zeros((tree.nv, model.nv)), np.zeros((tree.nq, model.nq)), np.zeros(tree.nq)
    following = {m.name: (m.mimic, m.multiplier, m.offset) for m in mimics}
    for name in tree.names[1:]:
        leader, scale, offset = following.get(name, (name, 1.0, 0.0))
        inner, joint = tree.joints[tree.getJointId(name)], model.joints[model.getJointId(leader)]
        n, n_q = np.arange(inner.nv), np.arange(inner.nq)
        g[inner.idx_v + n, joint.idx_v + n] = scale
        g_q[inner.idx_q + n_q, joint.idx_q + n_q] = scale
        g_0[inner.idx_q] = offset
    return g, g_q, g_0
