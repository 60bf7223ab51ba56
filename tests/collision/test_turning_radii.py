"""How far joints move bodies: the bounds against the farthest sampled points."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from own_arm import random_arm

from alpha5_model._support.spatial import pose
from alpha5_model.collision.bodies import (
    CollisionBodies,
    body_poses,
    carriers,
    collision_bodies,
)
from alpha5_model.collision.turning_radii import distance_rates, joints_between
from alpha5_model.geometry.primitives import Primitive
from alpha5_model.numbers.parameters import parameters

#: A circle is enclosed in a polygon, and samples miss the farthest angles a little.
WIDER = 1.01
#: Angles of all joints, all the way round.
SAMPLES = 100
ARMS = ("jaws", "own")


@cache
def bodies_of(arm: str) -> CollisionBodies:
    if arm == "jaws":
        return collision_bodies(parameters(), "jaws")
    return collision_bodies(random_arm(np.random.default_rng(2), off_axis=False))


def rim(shape: Primitive) -> np.ndarray:
    """The corners of a box, points on both circles of a cylinder, in the body."""
    if shape.kind == "box":
        corners = np.indices((2, 2, 2)).reshape(3, 8).T - 0.5
        local = corners * shape.size
    else:
        radius, length = shape.size
        around = np.linspace(0.0, 2.0 * np.pi, 49)
        circle = radius * np.column_stack([np.cos(around), np.sin(around)])
        local = np.vstack([np.insert(circle, 2, z, axis=1) for z in (-0.5, 0.5)])
        local *= [1.0, 1.0, length]
    placed = pose(shape.xyz, shape.rpy)
    return np.asarray(local @ placed[:3, :3].T + placed[:3, 3])


@cache
def from_axes(arm: str) -> dict[tuple[int, int], np.ndarray]:
    """Number of a shape and of a joint -> least and largest distance of its rim."""
    bodies = bodies_of(arm)
    joints = range(1, len(bodies.bodies))
    rims = [(body, rim(shape)) for body, shape in bodies.shapes]
    found = {}
    rng = np.random.default_rng(3)
    angles = rng.uniform(-np.pi, np.pi, (SAMPLES, len(joints)))
    poses = np.array([body_poses(bodies, row) for row in angles])
    for joint in joints:
        into_joint = np.linalg.inv(poses[:, joint])
        for shape, (body, points) in enumerate(rims):
            seen = (into_joint @ poses[:, body])[:, :2]
            places = seen[:, :, :3] @ points.T + seen[:, :, 3:]
            away = np.linalg.norm(places, axis=1)
            found[shape, joint] = np.array([away.min(), away.max()])
    return found


def shapes_of(bodies: CollisionBodies, body: int) -> list[int]:
    return [k for k, (owner, _) in enumerate(bodies.shapes) if owner == body]


def farthest(arm: str, body: int, joint: int) -> float:
    found = from_axes(arm)
    reaches = [found[shape, joint][1] for shape in shapes_of(bodies_of(arm), body)]
    return float(max(reaches))


def is_hardly_above(bound: float, sampled: float) -> bool:
    """Whether a bound holds, and is hardly larger than what was seen."""
    return sampled * (1.0 - 1e-9) <= bound <= WIDER * sampled


@pytest.mark.parametrize("arm", ARMS)
def test_rates_of_bodies_are_the_farthest_points(arm: str) -> None:
    bodies = bodies_of(arm)
    for one, other in bodies.pairs:
        rates = distance_rates(bodies, (one, other))
        between = joints_between(bodies, (one, other))
        assert set(between) == set(carriers(bodies, other)) - set(carriers(bodies, one))
        assert set(np.flatnonzero(rates) + 1) == set(between)
        for joint in between:
            seen = min(farthest(arm, one, joint), farthest(arm, other, joint))
            assert is_hardly_above(rates[joint - 1], seen)
