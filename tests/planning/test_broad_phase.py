"""Bounds on which free lines rest: rates of the joints, and balls around links.

They are no public names. A bound that is too small by little would let a link pass
through a thin obstacle, which few random plans would show.
"""

from __future__ import annotations

import numpy as np
import pytest
from reference import LOWER, UPPER

import alpha5_model as a5
from alpha5_model.collision.bodies import body_poses, collision_bodies
from alpha5_model.planning import Mesh
from alpha5_model.planning.broad_phase import BroadPhase

BODIES = collision_bodies(a5.parameters())
RNG = np.random.default_rng(1)
Q = RNG.uniform(LOWER[:4], UPPER[:4], (40, 4))


def triangle(at: tuple[float, float, float]) -> BroadPhase:
    corners = 0.05 * np.array([[0.0, 0, 0], [1, 0, 0.2], [0.3, 1, 0]]) + at
    return BroadPhase(BODIES, Mesh(vertices=corners, triangles=np.array([[0, 1, 2]])))


def test_joints_move_links_no_faster_than_their_rates() -> None:
    phase = triangle((0.25, 0.2, 0.1))
    step = 1e-3
    fastest = np.zeros((4, 4))
    for q in Q:
        before = phase.distances(q)
        far = before > 0.01
        for joint, unit in enumerate(np.eye(4)):
            change = np.abs(phase.distances(q + step * unit) - before) / step
            fastest[far, joint] = np.maximum(fastest[far, joint], change[far])
    assert (fastest <= phase.rates + 1e-3).all()
    before_the_joint = np.arange(4)[:, None] < np.arange(4)
    assert not phase.rates[before_the_joint].any()
    assert (phase.rates[~before_the_joint] > 0.01).all()
    # Each link's own joint, and the first one, move it as fast as that, nearly.
    assert (phase.rates[2:, 0] < 1.6 * fastest[2:, 0]).all()
    assert (phase.rates < 0.45).all()


@pytest.mark.parametrize("at", [(0.25, 0.2, 0.1), (-0.6, 0.5, -0.4), (0.1, -0.7, 0.5)])
def test_a_ball_around_a_link_is_nearer_than_the_link(
    at: tuple[float, float, float],
) -> None:
    """But by no more than its diameter and that of the box around the mesh."""
    phase = triangle(at)
    for q in Q[:20]:
        poses = body_poses(BODIES, q)
        distances = phase.distances(q)
        for number in range(1, 5):
            bound = phase._apart(number, poses[number])
            _, radius = phase._balls[number - 1]
            assert bound <= distances[number - 1] + 1e-9
            assert bound > distances[number - 1] - 2 * radius - 0.08
