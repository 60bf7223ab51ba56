"""Planned motions: how many are found, and how long planning and its proof take.

Each motion leads from a random joint position to a random point. The arm is free of
collision at the first, and at some branch of the second with the wrist of the first.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
from benchmarks.timing import Row

import alpha5_model as a5
from alpha5_model.planning import Obstacle, PlannedMotion
from alpha5_model.planning.planner import MARGIN
from alpha5_model.planning.surroundings import Surroundings

COUNT = 1000
#: Half edge of the cube that points are taken from: beyond the reach [m].
REACH = 0.5
#: A hull with the BlueROV2's length, width and height, and a post beside it [m].
VEHICLE = (
    Obstacle.box("hull", (0.457, 0.338, 0.254), (-0.2, 0.0, -0.14)),
    Obstacle.cylinder("post", 0.03, 1.0, (0.22, 0.15, 0.0)),
)
SCENES = {"the arm alone": (), "beside a vehicle": VEHICLE}


def rows() -> list[Row]:
    """Measured rows of this subject."""
    found = []
    for seed, (scene, obstacles) in enumerate(SCENES.items()):
        surroundings = Surroundings(a5.parameters(), obstacles, MARGIN)
        found += _rows(scene, surroundings, obstacles, seed)
    return found


def _rows(
    scene: str, surroundings: Surroundings, obstacles: Sequence[Obstacle], seed: int
) -> list[Row]:
    motions: list[PlannedMotion] = []
    of_found: list[float] = []
    of_all: list[float] = []
    for q0, point in _cases(surroundings, seed):
        start = time.perf_counter()
        try:
            motion = a5.plan(q0, point, obstacles=obstacles)
        except a5.Alpha5Error:
            motion = None
        of_all.append(time.perf_counter() - start)
        if motion is not None:
            motions.append(motion)
            of_found.append(of_all[-1])

    proving = []
    proved = []
    for motion in motions:
        start = time.perf_counter()
        blocked = [surroundings.obstruction(*line) for line in pairwise(motion.way)]
        proving.append(time.perf_counter() - start)
        proved.append(not any(blocked))

    # The first call builds the scene.
    times = {
        f"median of {COUNT}": float(np.median(of_all[1:])),
        "slowest but one in 100": float(np.quantile(of_found[1:], 0.99)),
        "slowest motion found": max(of_found[1:]),
        "slowest answer": max(of_all[1:]),
    }
    proofs = {"median": float(np.median(proving)), "longest": max(proving)}
    solved = len(motions) / COUNT
    share = float(np.mean(proved))
    return [
        *(Row(f"plan, {scene}", name, x, solved) for name, x in times.items()),
        *(
            Row(f"proof of a motion, {scene}", name, x, share)
            for name, x in proofs.items()
        ),
    ]


def _cases(
    surroundings: Surroundings, seed: int
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Starts (4,) [rad] and points (3,) [m] that are free at both ends."""
    limits = a5.load().limits
    rng = np.random.default_rng(seed)
    made = 0
    while made < COUNT:
        q0 = rng.uniform(limits.lower, limits.upper)
        point = rng.uniform(-REACH, REACH, 3)
        solutions = a5.inverse_kinematics(point, q0[3])
        ends = solutions.q[solutions.within_limits]
        if surroundings.touches(q0[None])[0] or surroundings.touches(ends).all():
            continue
        yield q0, point
        made += 1
