"""Self-collision by C and by coal, and what it adds to the solutions.

Joint positions are random within the limits. coal is asked for all pairs of bodies.
Before anything is timed, its verdicts are compared with ours.
"""

from __future__ import annotations

from functools import partial
from unittest import mock

import numpy as np
from benchmarks.timing import Row, compare

import alpha5_model as a5
from alpha5_model.collision import self_collision as module
from alpha5_model.collision.bodies import collision_bodies
from alpha5_model.collision.coal_scene import CoalScene
from alpha5_model.collision.self_collision import SelfCollision
from alpha5_model.kernels import numpy_kernels

COUNT = 100_000
#: Positions that a slow candidate is asked about.
SOME = 2000
FEW = 60
#: How near coal's verdict may be wrong [m].
COAL = 1e-6


def rows() -> list[Row]:
    """Measured rows of this subject."""
    limits = a5.load().limits
    q = np.random.default_rng(7).uniform(limits.lower, limits.upper, (COUNT, 4))
    return [*_positions(q), *_solutions(q), *_edges(q[:SOME])]


def _positions(q: np.ndarray) -> list[Row]:
    arm = a5.load()
    bodies = collision_bodies(a5.parameters())
    coal = CoalScene(bodies)
    with mock.patch.object(module, "module", return_value=numpy_kernels):
        in_numpy = SelfCollision(bodies)
        in_numpy.touches(q[:1])

    distance = np.array([coal.nearest(row).distance for row in q[:SOME]])
    same = np.asarray(arm.in_collision(q[:SOME])) == (distance < 0.0)
    agreed = float(same[np.abs(distance) > COAL].mean())

    one = q[0].copy()
    candidates = {
        "in_collision, one position": (lambda: arm.in_collision(one), 1),
        "in_collision, 100 000 positions": (lambda: arm.in_collision(q), COUNT),
        "without a compiler, 2 000 positions": (
            lambda: in_numpy.touches(q[:SOME]),
            SOME,
        ),
        "collision_distance, one position": (lambda: arm.collision_distance(one), 1),
        "coal's distances": (lambda: [coal.nearest(x) for x in q[:FEW]], FEW),
    }
    found = []
    # One after the other: some leave the processor's caches to the next.
    for name, (call, units) in candidates.items():
        success = {name: agreed} if name.startswith("in_collision") else None
        work = "self-collision of one position"
        found += compare(work, {name: call}, units, success=success)
    return found


def _solutions(q: np.ndarray) -> list[Row]:
    """What flags and the choice cost beside the solutions."""
    chain = a5.dh.DHChain.alpha5()
    position = np.ascontiguousarray(chain.forward_kinematics(q)[:, :3, 3])
    wrist = np.ascontiguousarray(q[:, 3])
    solved = a5.inverse_kinematics(position, wrist)
    free = (solved.within_limits & ~solved.collides).any(axis=-1)
    point, angle = position[free][0], float(wrist[free][0])
    one = a5.inverse_kinematics(point, angle)
    reference = q[1].copy()
    many = {
        "inverse_kinematics": partial(a5.inverse_kinematics, position, wrist),
        "flags of self-collision for them": lambda: solved.collides,
    }
    single = {
        "inverse_kinematics": partial(a5.inverse_kinematics, point, angle),
        "best(), free of collision": partial(one.best, reference),
    }
    return [
        *compare("IK of 100 000 positions with wrist angles", many, COUNT),
        *compare("IK of the same position again and again", single),
    ]


def _edges(q: np.ndarray) -> list[Row]:
    """Straight lines of joint positions, proved free as far as they are."""
    scene = SelfCollision(collision_bodies(a5.parameters()))
    near = q + np.random.default_rng(8).normal(scale=0.05, size=q.shape)
    lines = {
        "a line between random positions": partial(scene.free_shares, q[:-1], q[1:]),
        "a line to a position nearby": partial(scene.free_shares, q[:-1], near[:-1]),
    }
    work = "a line between random positions, proved free"
    return compare(work, lines, len(q) - 1, rounds=3)
