"""What the page on dexterity claims of four joints, by a second route."""

from __future__ import annotations

import itertools
import math

import numpy as np

import alpha5_model as a5


def turning_4r(links: np.ndarray, tip_distance: np.ndarray) -> np.ndarray:
    """Whether link 4 turns fully with the tip pinned.

    Its wrist then stays in the annulus of links 1 to 3.
    """
    first = links[:, :3]
    outer = first.sum(axis=1)
    inner = np.maximum(2 * first.max(axis=1) - outer, 0.0)
    angle = np.linspace(0, math.tau, 181)[:, None]
    x = tip_distance - links[:, 3] * np.cos(angle)
    y = -links[:, 3] * np.sin(angle)
    wrist = np.hypot(x, y)
    inside = (wrist <= outer + 1e-12) & (wrist >= inner - 1e-12)
    return np.asarray(inside.all(axis=0))


def test_the_theorem_predicts_no_4r_arm_that_turns_fully() -> None:
    """Lengths uniform in 0 to 1, the tip at a distance uniform in the reach."""
    rng = np.random.default_rng(0)
    links = rng.uniform(0, 1, (5000, 4))
    distance = rng.uniform(0, 1, len(links)) * links.sum(axis=1)
    turns = turning_4r(links, distance)
    assert 0.01 < turns.mean() < 0.9

    half = (links.sum(axis=1) + distance) / 2
    others = np.column_stack([links[:, :3], distance])
    pairs = [
        others[:, list(pair)].sum(axis=1)
        for pair in itertools.combinations(range(4), 2)
    ]
    assert not (np.min(pairs, axis=0) >= half).any()

    exact = [
        a5.planar.turns_fully(a5.planar.PlanarArm(lengths), radius)
        for lengths, radius in zip(links[:400], distance[:400], strict=True)
    ]
    assert np.array_equal(exact, turns[:400])
    other = turning_4r(links[:400], 1.1 * distance[:400])
    assert not np.array_equal(exact, other), "another distance is seen"


def test_the_example_of_four_joints() -> None:
    distances = np.linspace(0.0, 8.0, 801)
    assert turning_4r(np.tile([3.0, 3, 3, 1], (801, 1)), distances).all()
    assert not turning_4r(np.array([[3.0, 3, 3, 1]]), np.array([8.01])).any()
