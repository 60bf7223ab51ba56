"""The inverse kinematics with its edges as one symbolic function, against the package's and in plain Python."""

from __future__ import annotations

import math
from typing import Any

import casadi
import numpy as np
import pytest
from fk import tip
from ik_targets import EDGES, at_edge, ordinary

import alpha5_model as a5
from alpha5_model.kinematics.edges import DOUBLE, SINGLE
from alpha5_model.symbolic.numpy_source import python_source
from alpha5_model.symbolic.program import DECISIONS, folded, program
from alpha5_model.symbolic.solutions import solutions


def solve(position: np.ndarray, wrist: np.ndarray, **tolerances: Any) -> list[np.ndarray]:
    """q (N, 4, 4), exists and within_limits (N, 4), singular (N,)."""
    function = folded(solutions(), **tolerances)
    found = [function(p, w) for p, w in zip(position, wrist, strict=True)]
    q, exists, within, singular = (
        np.array(list(map(np.array, c))) for c in zip(*found, strict=True)
    )
    return [q, exists[..., 0], within[..., 0], singular[:, 0, 0]]


def test_every_branch_and_flag_at_every_edge() -> None:
    gap = np.random.default_rng(1).choice([0.0, 5e-11, -5e-11, 2e-10, -2e-10, 2e-9, -2e-9], 300)
    targets = [ordinary(1000, 1), *(at_edge(edge, 300, i, gap) for i, edge in enumerate(EDGES))]
    position, wrist = (np.concatenate(parts) for parts in zip(*targets, strict=True))
    expected = a5.inverse_kinematics(position, wrist)
    q, exists, within, singular = solve(position, wrist, tolerances=DOUBLE)
    np.testing.assert_array_equal(exists, expected.exists)
    np.testing.assert_array_equal(within, expected.within_limits)
    np.testing.assert_array_equal(singular, expected.singular)
    assert 100 < singular.sum() < len(singular) / 2
    assert 500 < within.sum() < exists.sum() < exists.size
    np.testing.assert_array_equal(np.isnan(q).any(axis=-1), ~exists.astype(bool))
    target = np.broadcast_to(position[:, None], (*exists.shape, 3))[exists > 0]
    assert np.linalg.norm(tip(q[exists > 0]) - target, axis=-1).max() < 1.1e-9  # on the yaw axis


def test_looser_tolerances_forgive_more() -> None:
    """As single precision needs it: a micrometre beyond the stretched arm is still there."""
    far = np.array([[0.02 + 0.33181301122930 + 1e-6, 0.0, 0.0462]])
    for tolerances, reached in ((DOUBLE, 0), (SINGLE, 1)):
        assert solve(far, np.zeros(1), tolerances=tolerances)[1].any() == reached


def test_folding_leaves_the_function_and_takes_the_input_away() -> None:
    x, y = casadi.SX.sym("x", 2), casadi.SX.sym("y")
    function = casadi.Function("f", [x, y], [casadi.sin(y) * x + y], ["x", "y"], ["z"])
    less = folded(function, y=2.0)
    assert less.name_in() == ["x"]
    assert less.name_out() == ["z"]
    assert np.allclose(np.array(less([1.0, 3.0])), np.array(function([1.0, 3.0], 2.0)))
    assert program(less).flops < program(function).flops


def test_decisions_as_statements() -> None:
    x, y = casadi.SX.sym("x"), casadi.SX.sym("y")
    less, same = x < y, casadi.logic_and(x <= y, casadi.logic_not(x < y))
    out = [less, same, casadi.logic_or(less, y < 0), casadi.if_else(less, -x, casadi.inf * 0)]
    decide = program(casadi.Function("f", [x, y], out, ["x", "y"], list("abcd")))
    assert {s.op for s in decide.steps} >= {*DECISIONS}
    names: dict[str, Any] = {}
    exec(python_source([decide]), names)
    for given in ((1.0, 2.0), (2.0, 2.0), (3.0, 2.0), (3.0, -2.0)):
        found = [float(x) for (x,) in names["f"](*([np.float64(x)] for x in given), np)]
        smaller = given[0] < given[1]
        expected = [smaller, given[0] == given[1], smaller or given[1] < 0]
        assert found[:3] == expected
        assert found[3] == -given[0] if smaller else math.isnan(found[3])


@pytest.mark.parametrize("wrist", [math.nan, math.inf])
def test_what_is_not_a_number_is_within_no_limits(wrist: float) -> None:
    q, _, within, _ = solve(np.array([[0.25, 0.1, 0.1]]), np.array([wrist]), tolerances=DOUBLE)
    assert not within.any()
    assert np.isnan(q[..., 3]).all()
    _, exists, *_ = solve(np.full((1, 3), math.nan), np.zeros(1), tolerances=DOUBLE)
    assert not exists.any()
