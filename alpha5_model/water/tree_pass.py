"""What moving water adds to the torques of a tree of joints, for many states at once.

As in the recursive Newton-Euler algorithm, twists are computed from the base to the tip
and forces from the tip to the base. One pass serves all states: the last axis of every
array runs over the states.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from alpha5_model._support.checks import FloatArray
from alpha5_model.errors import InputError
from alpha5_model.water.forces import MovingWater, cross_force

#: Offset of a joint's axis from its origin that is rounding [m]; a screw moves further
#: along its axis in each radian.
_ROUNDING = 1e-9


class _Step(NamedTuple):
    """The step from a joint to the next one.

    Attributes:
        parent: Number of the joint before.
        terms: Three matrices (6, 6), stacked. Their sum with `_weights` transforms a
            twist of the parent into the joint's frame.
        axis: Twist of the joint at unit rate, (6,).
        turns: Whether the joint turns; else it slides.
        at_q, at_v: Indices of the joint in q and v.
    """

    parent: int
    terms: FloatArray
    axis: FloatArray
    turns: bool
    at_q: int
    at_v: int


class TreePass:
    """The pass over one tree in one water.

    Raises:
        InputError: A joint that neither turns about one axis nor slides along one.
    """

    def __init__(self, tree: pin.Model, water: MovingWater) -> None:
        self._water = water
        data = tree.createData()
        pin.computeJointJacobians(tree, data, pin.neutral(tree))
        self._steps = [_step(tree, data, joint) for joint in range(2, tree.njoints)]

    def torques(
        self, q: FloatArray, v: FloatArray, a: FloatArray, currents: FloatArray
    ) -> FloatArray:
        """What the water adds to the torques, (tree nv, N).

        Args:
            q: (tree nq, N).
            v: (tree nv, N).
            a: (tree nv, N).
            currents: In the world, (3, N).
        """
        weights = [_weights(step, q) for step in self._steps]
        motion = self._motion(q, v, a, currents, weights)
        force = self._water.force(motion[:, 0], motion[:, 1])

        tau = np.empty_like(v)
        for joint in range(len(self._steps), 0, -1):
            step = self._steps[joint - 1]
            tau[step.at_v] = -step.axis @ force[joint]
            weighted = (weights[joint - 1] * force[joint]).reshape(18, -1)
            force[step.parent] += step.terms.T @ weighted
        tau[:6] = -force[0]
        return tau

    def _motion(
        self,
        q: FloatArray,
        v: FloatArray,
        a: FloatArray,
        currents: FloatArray,
        weights: list[FloatArray],
    ) -> FloatArray:
        """Twists of the joints relative to the water, and their rates.

        Returns:
            (joints, 2, 6, N).
        """
        motion = np.empty((len(self._steps) + 1, 2, 6, q.shape[1]))
        _set_base_motion(motion[0], q, v, a, currents)
        for joint, (step, weight) in enumerate(
            zip(self._steps, weights, strict=True), 1
        ):
            rate = v[step.at_v]
            acceleration = a[step.at_v]
            axis = step.axis[:, None]
            _, first, second = weight[:, 0]

            terms = (step.terms @ motion[step.parent]).reshape(2, 3, 6, -1)
            motion[joint] = terms[:, 0] + first * terms[:, 1] + second * terms[:, 2]
            motion[joint, 0] += axis * rate
            turned = cross_force(step.axis).T @ motion[joint, 0]
            motion[joint, 1] += axis * acceleration + turned * rate
        return motion


def _set_base_motion(
    motion: FloatArray,
    q: FloatArray,
    v: FloatArray,
    a: FloatArray,
    currents: FloatArray,
) -> None:
    """Set the twist of the base relative to the water and its rate, (2, 6, N)."""
    axis = q[3:6]
    w = q[6]
    aside = np.cross(axis, currents, axis=0)
    stream = currents + 2 * (np.cross(axis, aside, axis=0) - w * aside)

    motion[0] = v[:6]
    motion[1] = a[:6]
    motion[0, :3] -= stream
    motion[1, :3] += np.cross(v[3:6], stream, axis=0)


def _weights(step: _Step, q: FloatArray) -> FloatArray:
    """Weights of the three `terms` of a step, (3, 1, N).

    A twist is transformed by ``exp(-q [s]x)`` with the axis s. For a joint that turns,
    this is Rodrigues' formula ``1 - sin(q) [s]x + (1 - cos(q)) [s]x^2``. For a joint
    that slides, the series ends after ``1 - q [s]x``.
    """
    angle = q[step.at_q]
    first = np.sin(angle) if step.turns else angle
    second = 1 - np.cos(angle) if step.turns else np.zeros_like(angle)
    return np.stack([np.ones_like(angle), first, second])[:, None]


def _step(tree: pin.Model, data: Any, number: int) -> _Step:
    """The step to a joint of a pin.Model, whose data hold the Jacobians."""
    joint = tree.joints[number]
    axis = pin.getJointJacobian(tree, data, number, pin.LOCAL)[:, joint.idx_v]
    turns = bool(axis[3:].any())
    slides = np.abs(axis[:3]).max() > _ROUNDING
    if joint.nq != 1 or (turns and slides):
        expected = "joints that turn about or slide along an axis"
        raise InputError("model", joint.shortname(), expected)

    placement = tree.jointPlacements[number].actionInverse
    back = cross_force(axis).T  # minus [s]x
    return _Step(
        parent=tree.parents[number] - 1,
        terms=np.vstack([placement, back @ placement, back @ back @ placement]),
        axis=axis,
        turns=turns,
        at_q=joint.idx_q,
        at_v=joint.idx_v,
    )
