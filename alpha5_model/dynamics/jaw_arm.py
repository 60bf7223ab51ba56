"""The arm with jaws: two fingers that follow the rod.

Each finger is at ``q_finger = multiplier q_rod + offset``. Pinocchio's mimic joints
work in kinematics, RNEA and CRBA, with nv = 5. Its forward dynamics, derivatives and
energies refuse them, and its Coriolis matrix silently omits terms (4.1). These are
computed here on the tree in which the fingers are joints of their own
(`alpha5_model.dynamics.joint_tree`). Its coordinates are affine functions of the arm's,
so the chain rule is exact: ``tau = G^T tau_tree``, ``M = G^T M_tree G``, and likewise
for every derivative.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray
from alpha5_model.description.urdf_robot import UrdfJoint
from alpha5_model.dynamics.arm import Arm, Forces
from alpha5_model.dynamics.batch import solved
from alpha5_model.dynamics.buoyancy import Displacement
from alpha5_model.dynamics.joint_tree import Embedding, JointTree
from alpha5_model.dynamics.states import Partials
from alpha5_model.numbers.parameters import Alpha5Parameters


class JawArm(Arm):
    """An `Arm` whose last coordinate ``axis_a`` [m] also turns the fingers."""

    def __init__(
        self,
        tree: pin.Model,
        displacements: Iterable[Displacement],
        fluid_density: float,
        mimics: Iterable[UrdfJoint],
        *,
        parameters: Alpha5Parameters | None = None,
    ) -> None:
        """Make the arm.

        Args:
            tree: pin.Model in which the fingers are joints of their own.
            displacements: The volumes on its joints.
            fluid_density: [kg/m^3].
            mimics: The fingers' joints, which follow the rod's.
            parameters: See `Arm`.
        """
        self._mimics = tuple(mimics)
        model = mimicking(tree, self._mimics)
        super().__init__(model, displacements, fluid_density, parameters=parameters)
        self._tree = Arm(
            tree, self.displacements, fluid_density, parameters=self.parameters
        )
        self._embedding = _embedding(model, tree, self._mimics)
        self._joint_tree = JointTree(
            model=self._tree._model,
            fluid=self._tree._fluid,
            embedding=self._embedding,
        )

    def coriolis_matrix(self, q: ArrayLike, v: ArrayLike) -> FloatArray:
        state = self._expand(*self._clean_qv(q, v))
        return self._project(self._tree.coriolis_matrix(*state))

    def forward_dynamics(
        self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, fext: Forces = None
    ) -> FloatArray:
        q, v, tau = self._clean_qvtau(q, v, tau)
        bias = self.inverse_dynamics(q, v, np.zeros_like(v), fext)
        return solved(self.mass_matrix(q), tau - bias)

    def inverse_dynamics_derivatives(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike
    ) -> Partials:
        state = self._expand(*self._clean_qva(q, v, a))
        dq, dv, da = self._tree.inverse_dynamics_derivatives(*state)
        return self._project(dq), self._project(dv), self._project(da)

    def hydrostatic_torque_derivative(self, q: ArrayLike) -> FloatArray:
        state = self._expand(self._clean_q(q))
        return self._project(self._tree.hydrostatic_torque_derivative(*state))

    def kinetic_energy(self, q: ArrayLike, v: ArrayLike) -> float:
        state = self._expand(*self._clean_qv(q, v))
        return self._tree.kinetic_energy(*state)

    def potential_energy(self, q: ArrayLike) -> float:
        state = self._expand(self._clean_q(q))
        return self._tree.potential_energy(*state)

    def _expand(self, q: FloatArray, *rates: FloatArray) -> list[FloatArray]:
        """A state of the arm as one of the tree."""
        return self._embedding.expand(q, *rates)

    def _project(self, matrix: FloatArray) -> FloatArray:
        """A matrix of the tree's coordinates in those of the arm."""
        g = self._embedding.g
        return np.asarray(g.T @ matrix @ g)

    @property
    def _constructor_arguments(self) -> tuple[Any, ...]:
        # Pinocchio 4.1 crashes with a pickled model that has mimic joints. The tree has
        # none.
        return self._tree._model, self.displacements, self.fluid_density, self._mimics


def mimicking(tree: pin.Model, mimics: Iterable[UrdfJoint]) -> pin.Model:
    """A copy of a model in which some joints follow others, as mimic joints.

    Args:
        tree: pin.Model.
        mimics: The joints that follow, with the names of their leaders.
    """
    model = tree.copy()
    for mimic in mimics:
        leader = model.getJointId(mimic.mimic)
        follower = model.getJointId(mimic.name)
        model = pin.transformJointIntoMimic(
            model, leader, follower, mimic.multiplier, mimic.offset
        )
    return model


def _embedding(
    model: pin.Model, tree: pin.Model, mimics: Iterable[UrdfJoint]
) -> Embedding:
    """The map from the coordinates of an arm with jaws to those of its tree."""
    g = np.zeros((tree.nv, model.nv))
    g_q = np.zeros((tree.nq, model.nq))
    g_0 = np.zeros(tree.nq)
    mimic_of = {mimic.name: mimic for mimic in mimics}
    for name in tree.names[1:]:
        mimic = mimic_of.get(name)
        leader = name if mimic is None else mimic.mimic
        scale = 1.0 if mimic is None else mimic.multiplier
        offset = 0.0 if mimic is None else mimic.offset

        inner = tree.joints[tree.getJointId(name)]
        outer = model.joints[model.getJointId(leader)]
        of_velocity = np.arange(inner.nv)
        of_position = np.arange(inner.nq)
        g[inner.idx_v + of_velocity, outer.idx_v + of_velocity] = scale
        g_q[inner.idx_q + of_position, outer.idx_q + of_position] = scale
        g_0[inner.idx_q] = offset
    return Embedding(g=g, g_q=g_q, g_0=g_0)
