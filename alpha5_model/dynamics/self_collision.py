"""Which joint positions are free of self-collision, many at a time, at some wrist angle.

The wrist turns the hand about an axis through the tcp and moves no point, so a point of the workspace is
reached without self-collision if any wrist angle is free of it. The bodies are those of
`alpha5_model.dynamics.collision`, the jaws closed.

References:
    [ReachAlpha] Manufacturer's document, Figure 2: "without self collision".
    [Pan2012] Pan, Chitta, Manocha: FCL: A general purpose library for collision and proximity queries,
        ICRA 2012 (dynamic AABB trees).
"""

from __future__ import annotations

from functools import cache
from typing import Any

import coal
import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model.checks import BoolArray, FloatArray, count, float_array
from alpha5_model.dynamics.collision import collision_geometry
from alpha5_model.dynamics.loading import load
from alpha5_model.parameters import parameters

#: Wrist angles that are tried, evenly over the range of axis_b: one every 15 degrees.
WRISTS = 25


def without_self_collision(q: ArrayLike, wrists: int = WRISTS) -> BoolArray:
    """Whether the arm stands free of itself at some wrist angle.

    Args:
        q: (..., 4) [rad]; theta_3 is the first wrist angle that is tried.
        wrists: How many more are tried, evenly over the range of axis_b. A window that is narrower than
            their distance can be missed.

    Returns:
        (...) bool.

    Raises:
        InputError: Not finite real numbers of that shape, or no whole number of wrist angles.
    """
    position = float_array("q", q, (4,))
    joint = parameters().joints[3]
    turns = np.linspace(joint.lower, joint.upper, count("wrists", wrists))
    rows = position.reshape(-1, 4).copy()
    model, before_wrist, with_wrist = _model()
    free = np.zeros(len(rows), np.bool_)
    left = np.flatnonzero(~_collides(model, before_wrist, rows))
    for angle in (None, *turns):
        if angle is not None:
            rows[left, 3] = angle
        hits = _collides(model, with_wrist, rows[left])
        free[left[~hits]] = True
        left = left[hits]
        if not len(left):
            break
    return free.reshape(position.shape[:-1])


@cache
def _model() -> tuple[Any, Any, Any]:
    """The arm, its pairs of bodies that the wrist does not move, and those that it does."""
    model = load().model
    wrist = model.getJointId(parameters().joints[3].name)
    parts = []
    for moved in (False, True):
        geometry = collision_geometry(model)
        for pair in list(geometry.collisionPairs):
            joints = (geometry.geometryObjects[i].parentJoint for i in (pair.first, pair.second))
            if (wrist in joints) != moved:
                geometry.removeCollisionPair(pair)
        parts.append(geometry)
    return model, *parts


def _collides(model: Any, geometry: Any, q: FloatArray) -> BoolArray:
    """Whether any pair touches at q, (N, 4)."""
    data, objects = model.createData(), geometry.createData()
    # A search that starts where the last one ended was seen to miss overlaps.
    objects.collisionRequests[:] = [coal.CollisionRequest()] * len(objects.collisionRequests)
    tree = pin.BroadPhaseManager_DynamicAABBTreeCollisionManager(model, geometry, objects)
    return np.array([pin.computeCollisions(model, data, tree, row, True) for row in q], np.bool_)
