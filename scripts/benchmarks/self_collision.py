"""Self-collision by tables, exactly and by coal, and what it adds to the solutions.

Joint positions are random within the limits. coal is asked as Pinocchio asks it: all
pairs of bodies, each with a fresh request. Before anything is timed, its verdicts are
compared with ours.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any
from unittest import mock

import numpy as np
from benchmarks.timing import Row, measure

import alpha5_model as a5
from alpha5_model.collision import self_collision as module
from alpha5_model.collision.bodies import collision_bodies
from alpha5_model.collision.self_collision import SelfCollision
from pinocchio_collision import CollisionModel

COUNT = 100_000
#: Positions that coal is asked about.
FEW = 60
#: How near coal's verdict may be wrong [m].
COAL = 1e-6


def missing() -> list[str]:
    """Peers that are not installed: coal comes with Pinocchio."""
    return []


def rows() -> list[Row]:
    """Measured rows of this section."""
    arm = a5.load()
    q = np.random.default_rng(7).uniform(arm.limits.lower, arm.limits.upper, (COUNT, 4))
    coal = CollisionModel(arm.model)
    agreed = _agreed(arm, coal, q[:2000])
    return [
        *_positions(arm, coal, q, agreed),
        *_solutions(q),
        *_edges(q[:2000]),
    ]


def _agreed(arm: a5.Arm, coal: CollisionModel, q: np.ndarray) -> float:
    """Share of the verdicts that are coal's, where it is sure."""
    distance = np.array([coal.clearance(row).distance for row in q])
    sure = np.abs(distance) > COAL
    same = np.asarray(arm.in_collision(q)) == (distance < 0.0)
    return float(same[sure].mean())


def _positions(
    arm: a5.Arm, coal: CollisionModel, q: np.ndarray, agreed: float
) -> list[Row]:
    scene = SelfCollision(collision_bodies(a5.parameters()))
    with mock.patch.object(module, "committed_cells", return_value=()):
        exact = SelfCollision(scene.bodies)
        exact.touches(q[:1])
    with mock.patch.object(module, "is_compiled", return_value=False):
        in_numpy = SelfCollision(scene.bodies)
        in_numpy.touches(q[:1])

    one = q[0].copy()
    calls: dict[str, tuple[Callable[[], Any], int]] = {
        "in_collision, one position": (partial(arm.in_collision, one), 1),
        "in_collision, 100 000 positions": (partial(arm.in_collision, q), COUNT),
        "without tables, 100 000 positions": (partial(exact.touches, q), COUNT),
        "without a compiler, 2 000 positions": (
            partial(in_numpy.touches, q[:2000]),
            2000,
        ),
        "collision_distance, one position": (partial(arm.collision_distance, one), 1),
        "coal's distances": (lambda: [coal.clearance(x) for x in q[:FEW]], FEW),
    }
    found = []
    for name, (call, per_call) in calls.items():
        seconds = measure({name: call}, per_call=per_call)[name]
        found.append(
            Row(
                work="self-collision of one position",
                candidate=name,
                seconds=seconds,
                success=agreed if name.startswith("in_collision") else None,
                target=700.0 if name.startswith("coal") else None,
            )
        )
    return found


def _solutions(q: np.ndarray) -> list[Row]:
    """What flags and the choice cost beside the solutions."""
    chain = a5.dh.DHChain.alpha5()
    position = np.ascontiguousarray(chain.forward_kinematics(q)[:, :3, 3])
    wrist = np.ascontiguousarray(q[:, 3])
    solved = a5.inverse_kinematics(position, wrist)
    free = (solved.within_limits & ~solved.collides).any(axis=-1)
    one = a5.inverse_kinematics(position[free][0], float(wrist[free][0]))
    reference = q[1].copy()
    many = measure(
        {
            "inverse_kinematics": partial(a5.inverse_kinematics, position, wrist),
            "flags of self-collision for them": lambda: solved.collides,
        },
        per_call=COUNT,
    )
    single = measure(
        {
            "inverse_kinematics": partial(
                a5.inverse_kinematics, position[free][0], float(wrist[free][0])
            ),
            "best(), free of collision": partial(one.best, reference),
        }
    )
    works = {
        "IK of 100 000 positions with wrist angles": many,
        "IK of the same position again and again": single,
    }
    return [
        Row(work=work, candidate=name, seconds=seconds)
        for work, times in works.items()
        for name, seconds in times.items()
    ]


def _edges(q: np.ndarray) -> list[Row]:
    """Straight lines of joint positions, proved free as far as they are."""
    scene = SelfCollision(collision_bodies(a5.parameters()))
    near = q + np.random.default_rng(8).normal(scale=0.05, size=q.shape)
    lines = {
        "a line between random positions": partial(scene.free_shares, q[:-1], q[1:]),
        "a line to a position nearby": partial(scene.free_shares, q[:-1], near[:-1]),
    }
    seconds = measure(lines, per_call=len(q) - 1, rounds=3)
    return [
        Row(
            work="a line between random positions, proved free",
            candidate=name,
            seconds=time,
        )
        for name, time in seconds.items()
    ]
