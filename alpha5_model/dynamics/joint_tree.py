"""The tree of an arm's joints, in which each joint has coordinates of its own.

An arm with jaws has fewer coordinates than joints: its fingers follow the rod. On the
tree every algorithm of Pinocchio works, and the chain rule takes its results back to
the arm: ``tau = G^T tau_tree``. With the tree on a free-flyer, the first six torques
are the load on the mount.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.dynamics.model_changes import on_free_flyer

if TYPE_CHECKING:
    import pinocchio as pin

#: Position of a free-flyer at the world's origin: xyz and quaternion (x, y, z, w).
AT_ORIGIN = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])


class Embedding(NamedTuple):
    """The linear map from an arm's coordinates to those of its tree.

    ``q_tree = G_q q + g_0`` and ``v_tree = G v``.

    Attributes:
        g: G, (tree nv, nv).
        g_q: G_q, (tree nq, nq).
        g_0: (tree nq,).
    """

    g: FloatArray
    g_q: FloatArray
    g_0: FloatArray

    def expand(self, q: FloatArray, *rates: FloatArray) -> list[FloatArray]:
        """States of the tree, from states of the arm.

        Args:
            q: (..., nq).
            rates: Velocity, acceleration, (..., nv) each.
        """
        rates_of_tree = [rate @ self.g.T for rate in rates]
        return [q @ self.g_q.T + self.g_0, *rates_of_tree]


class JointTree(NamedTuple):
    """The tree of an arm's joints.

    Attributes:
        model: pin.Model of the bodies.
        fluid: pin.Model of the displaced fluid.
        embedding: From the arm's coordinates to the tree's.
    """

    model: pin.Model
    fluid: pin.Model
    embedding: Embedding


def tree_of_model(model: pin.Model, fluid: pin.Model) -> JointTree:
    """The tree of an arm whose joints all have coordinates of their own."""
    identity = Embedding(
        g=np.eye(model.nv), g_q=np.eye(model.nq), g_0=np.zeros(model.nq)
    )
    return JointTree(model=model, fluid=fluid, embedding=identity)


def tree_on_free_flyer(tree: JointTree) -> JointTree:
    """A tree on a fixed base, put on a free-flyer that stays at the world's origin."""
    g, g_q, g_0 = tree.embedding
    of_base_velocity = np.zeros((6, g.shape[1]))
    of_base_position = np.zeros((7, g_q.shape[1]))
    return JointTree(
        model=on_free_flyer(tree.model),
        fluid=on_free_flyer(tree.fluid),
        embedding=Embedding(
            g=np.vstack([of_base_velocity, g]),
            g_q=np.vstack([of_base_position, g_q]),
            g_0=np.append(AT_ORIGIN, g_0),
        ),
    )
