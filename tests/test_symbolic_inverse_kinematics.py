"""The symbolic inverse kinematics, evaluated by CasADi: against forward kinematics and `solve_one`."""

from __future__ import annotations

import casadi
import numpy as np
import pytest
from fk import tip
from ik_targets import EDGES, at_edge, ordinary
from reference import LOWER, UPPER

from alpha5_model.kinematics.ik.one import solve_one
from alpha5_model.symbolic import functions
from alpha5_model.symbolic.program import program

FUNCTION = functions()["inverse_kinematics"]


def evaluated(position: np.ndarray, wrist: np.ndarray) -> list[np.ndarray]:
    """q (N, 4, 4), reach (N, 2), limits (N, 4), clearance (N,)."""
    count = len(position)
    out = FUNCTION.map(count).call([casadi.DM(position.T), casadi.DM(wrist).T])
    q, reach, limits, clearance = (np.array(x) for x in out)
    return [q.reshape(4, count, 4).swapaxes(0, 1), reach.T, limits.T, clearance[0]]


def test_four_branches_put_the_tcp_on_the_target() -> None:
    position, wrist = ordinary(40_000, seed=1)
    q, reach, limits, clearance = evaluated(position, wrist)
    exists = np.tile(reach > 0.0, 2)
    off = tip(q) - position[:, None]
    clear = clearance > 0.0
    assert clear.mean() > 0.9995
    assert np.linalg.norm(off, axis=-1)[exists & clear[:, None]].max() < 1e-12
    turns = (q[..., 3] - wrist[:, None]) / (2 * np.pi)
    assert np.abs(turns - np.rint(turns)).max() < 1e-14
    assert np.isfinite(q).all()
    inside = ((q >= LOWER) & (q <= UPPER)).all(axis=-1)
    assert np.array_equal((limits >= 0.0)[clear], inside[clear])


@pytest.mark.parametrize("edge", [None, *EDGES])
def test_what_is_clear_is_as_solve_one_has_it(edge: str | None) -> None:
    count = 4000
    if edge is None:
        position, wrist = ordinary(count, seed=2)
    else:
        rng = np.random.default_rng(3)
        gap = rng.choice([-1.0, 1.0], count) * 10 ** rng.uniform(-9.0, -2.0, count)
        position, wrist = at_edge(edge, count, 4, gap)
    q, reach, limits, clearance = evaluated(position, wrist)
    exists = np.tile(reach > 0.0, 2)
    within = exists & (limits >= 0.0)
    rows = np.flatnonzero(clearance > 0.0)
    assert len(rows) > count / 3
    for row in rows.tolist():
        angles, reached, fits, singular = solve_one(*position[row].tolist(), float(wrist[row]))
        assert [reached >> b & 1 for b in range(4)] == exists[row].tolist()
        assert [fits >> b & 1 for b in range(4)] == within[row].tolist()
        assert not singular
        off = (q[row] - np.reshape(angles, (4, 4)))[exists[row]]
        assert np.abs(off).max(initial=0.0) < 1e-10


@pytest.mark.parametrize("edge", EDGES[:-1])
@pytest.mark.parametrize("gap", [0.0, 1e-13, -1e-11])
def test_what_an_edge_runs_through_is_not_clear(edge: str, gap: float) -> None:
    position, wrist = at_edge(edge, 500, 5, np.full(500, gap))
    *_, clearance = evaluated(position, wrist)
    assert (clearance <= 0.0).all()


def test_a_wrist_at_its_limit_is_within_to_the_bit_and_beyond_rounding_it_is_not() -> None:
    target = np.full((1, 3), 0.15)
    for limit, out in ((LOWER[3], -1.0), (UPPER[3], 1.0)):
        for turns in (-1, 0, 2):
            for gap, fits in ((0.0, True), (5e-13, True), (1e-11, False), (-1e-11, True)):
                wrist = limit + out * gap + 2 * np.pi * turns
                q, _, limits, clearance = evaluated(target, np.array([wrist]))
                assert clearance > 0.0
                assert np.array_equal(limits[0, 0] >= 0.0, fits), (wrist, limits)
                assert not 0.0 < out * (q[0, 0, 3] - limit) < 1e-12


def test_it_is_short() -> None:
    assert program(FUNCTION).flops < 170
