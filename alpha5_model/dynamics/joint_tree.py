"""The tree of an arm's joints, in which each joint has coordinates of its own.

An arm with jaws has fewer coordinates than joints: each finger is at ``q_finger =
multiplier q_rod + offset``. Pinocchio's mimic joints work in kinematics, RNEA and CRBA.
Its forward dynamics, derivatives and energies refuse them, and its Coriolis matrix
silently omits terms (4.1). On the tree every algorithm works. Its coordinates are
affine functions of the arm's, so the chain rule is exact: ``tau = G^T tau_tree``, ``M =
G^T M_tree G``, and likewise for every derivative.

With the tree on a free-flyer, the first six torques are the load on the mount.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from alpha5_model._support.checks import FloatArray
from alpha5_model.description.urdf_robot import UrdfJoint
from alpha5_model.dynamics.model_changes import on_free_flyer

#: Position of a free-flyer at the world's origin: xyz and quaternion (x, y, z, w).
AT_ORIGIN = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])


class JointTree(NamedTuple):
    """The tree of an arm's joints, and the linear map from the arm's coordinates.

    ``q_tree = G_q q + g_0`` and ``v_tree = G v``.

    Attributes:
        model: pin.Model of the bodies.
        fluid: pin.Model of the displaced fluid.
        g: G, (tree nv, nv).
        g_q: G_q, (tree nq, nq).
        g_0: (tree nq,).
        is_arm: The tree has the arm's own coordinates: the map is the identity.
    """

    model: pin.Model
    fluid: pin.Model
    g: FloatArray
    g_q: FloatArray
    g_0: FloatArray
    is_arm: bool = False

    def expand(self, q: FloatArray, *rates: FloatArray) -> list[FloatArray]:
        """States of the tree, from states of the arm.

        Args:
            q: (..., nq).
            rates: Velocity, acceleration, (..., nv) each.
        """
        if self.is_arm:
            return [q, *rates]
        rates_of_tree = [rate @ self.g.T for rate in rates]
        return [q @ self.g_q.T + self.g_0, *rates_of_tree]

    def project(self, matrix: FloatArray) -> FloatArray:
        """A matrix (tree nv, tree nv) in the coordinates of the arm, (nv, nv)."""
        return matrix if self.is_arm else np.asarray(self.g.T @ matrix @ self.g)


def tree_of_model(model: pin.Model, fluid: pin.Model) -> JointTree:
    """The tree of an arm whose joints all have coordinates of their own."""
    return JointTree(
        model=model,
        fluid=fluid,
        g=np.eye(model.nv),
        g_q=np.eye(model.nq),
        g_0=np.zeros(model.nq),
        is_arm=True,
    )


def tree_under_mimics(
    model: pin.Model, tree: pin.Model, fluid: pin.Model, mimics: Iterable[UrdfJoint]
) -> JointTree:
    """The tree of an arm in which some joints follow others.

    Args:
        model: pin.Model of the arm, with mimic joints.
        tree: pin.Model in which they are joints of their own.
        fluid: Its displaced-fluid model.
        mimics: The joints that follow.
    """
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
    return JointTree(model=tree, fluid=fluid, g=g, g_q=g_q, g_0=g_0)


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


def tree_on_free_flyer(tree: JointTree) -> JointTree:
    """A tree on a fixed base, put on a free-flyer that stays at the world's origin."""
    of_base_velocity = np.zeros((6, tree.g.shape[1]))
    of_base_position = np.zeros((7, tree.g_q.shape[1]))
    return JointTree(
        model=on_free_flyer(tree.model),
        fluid=on_free_flyer(tree.fluid),
        g=np.vstack([of_base_velocity, tree.g]),
        g_q=np.vstack([of_base_position, tree.g_q]),
        g_0=np.append(AT_ORIGIN, tree.g_0),
    )
