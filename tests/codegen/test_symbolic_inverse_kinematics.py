"""The symbolic inverse kinematics is the same in CasADi, plain Python and as text."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from fk import tip
from ik_reference import solved
from ik_targets import EDGES, at_edge, ordinary
from loops import each
from reference import LOWER, UPPER

import alpha5_model as a5
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.kinematics.tolerances import DOUBLE, SINGLE


def solve(
    position: np.ndarray, wrist: np.ndarray, tolerances: Any = DOUBLE
) -> list[np.ndarray]:
    """q (N, 4, 4), exists and within_limits (N, 4), singular (N,)."""
    import casadi

    from alpha5_model.codegen.casadi_functions import folded
    from alpha5_model.codegen.inverse_kinematics import inverse_kinematics

    count = len(position)
    function = folded(
        inverse_kinematics(),
        parameters=Geometry.of(a5.parameters()).ik_parameters_with(tolerances),
    )
    solver = function.map(count)
    found = (
        np.array(x) for x in solver.call([casadi.DM(position.T), casadi.DM(wrist).T])
    )
    q, exists, within, singular = found
    return [q.reshape(4, count, 4).swapaxes(0, 1), exists.T, within.T, singular[0]]


def test_four_branches_put_the_tcp_on_the_target() -> None:
    position, wrist = ordinary(40_000, seed=1)
    q, exists, within, singular = solve(position, wrist)
    off = tip(q) - position[:, None]
    assert singular.mean() < 3e-4
    assert np.linalg.norm(off, axis=-1)[exists > 0].max() < 1e-12
    turns = (q[..., 3] - wrist[:, None])[exists > 0] / (2 * np.pi)
    assert np.abs(turns - np.rint(turns)).max() < 1e-14
    np.testing.assert_array_equal(np.isfinite(q).all(axis=-1), exists)
    with np.errstate(invalid="ignore"):
        inside = ((q >= LOWER) & (q <= UPPER)).all(axis=-1)
    np.testing.assert_array_equal(within, inside)


@each("edge", [None, *EDGES])
def test_it_is_as_the_second_route_has_it(edge: str | None) -> None:
    count = 4000
    if edge is None:
        position, wrist = ordinary(count, seed=2)
    else:
        rng = np.random.default_rng(3)
        gap = rng.choice([-1.0, 1.0], count) * 10 ** rng.uniform(-9.0, -2.0, count)
        gap[: count // 4] = rng.choice([0.0, 1e-13, -1e-11], count // 4)
        position, wrist = at_edge(edge, count, 4, gap)
    q, *flags = solve(position, wrist)
    expected, *wanted = solved(position, wrist)
    for got, want in zip(flags, wanted, strict=True):
        np.testing.assert_array_equal(got, want)
    clear = wanted[0] & ~wanted[2][:, None]
    assert np.abs(q - expected)[clear].max() < 1e-10 if edge != "stretched" else 1e-7


def test_every_branch_and_flag_at_every_edge() -> None:
    gap = np.random.default_rng(1).choice(
        [0.0, 5e-11, -5e-11, 2e-10, -2e-10, 2e-9, -2e-9], 300
    )
    targets = [
        ordinary(1000, 1),
        *(at_edge(edge, 300, i, gap) for i, edge in enumerate(EDGES)),
    ]
    position, wrist = (np.concatenate(parts) for parts in zip(*targets, strict=True))
    expected = a5.inverse_kinematics(position, wrist)
    q, exists, within, singular = solve(position, wrist)
    np.testing.assert_array_equal(exists, expected.exists)
    np.testing.assert_array_equal(within, expected.within_limits)
    np.testing.assert_array_equal(singular, expected.singular)
    assert 100 < singular.sum() < len(singular) / 2
    assert 500 < within.sum() < exists.sum() < exists.size
    np.testing.assert_array_equal(np.isnan(q).any(axis=-1), ~exists.astype(bool))
    target = np.broadcast_to(position[:, None], (*exists.shape, 3))[exists > 0]
    # The largest errors are on the yaw axis.
    assert np.linalg.norm(tip(q[exists > 0]) - target, axis=-1).max() < 1.1e-9


def test_a_wrist_at_its_limit_is_within_and_beyond_rounding_it_is_not() -> None:
    target = np.full((1, 3), 0.15)
    for limit, out in ((LOWER[3], -1.0), (UPPER[3], 1.0)):
        for turns in (-1, 0, 2):
            for gap, fits in (
                (0.0, True),
                (5e-13, True),
                (1e-11, False),
                (-1e-11, True),
            ):
                wrist = limit + out * gap + 2 * np.pi * turns
                q, _, within, _ = solve(target, np.array([wrist]))
                assert within[0, 0] == fits, wrist
                assert not 0.0 < out * (q[0, 0, 3] - limit) < 1e-12


def test_looser_tolerances_forgive_more() -> None:
    """Single precision's tolerances reach 1e-6 m beyond the stretched arm."""
    far = np.array([[0.02 + 0.33181301122930 + 1e-6, 0.0, 0.0462]])
    for tolerances, reached in ((DOUBLE, 0), (SINGLE, 1)):
        assert solve(far, np.zeros(1), tolerances)[1].any() == reached


def test_folding_leaves_the_function_and_takes_the_input_away() -> None:
    import casadi

    from alpha5_model.codegen.casadi_functions import folded
    from alpha5_model.codegen.instructions import program

    x = casadi.SX.sym("x", 2)
    y = casadi.SX.sym("y")
    function = casadi.Function("f", [x, y], [casadi.sin(y) * x + y], ["x", "y"], ["z"])
    less = folded(function, y=2.0)
    assert less.name_in() == ["x"]
    assert less.name_out() == ["z"]
    assert np.allclose(np.array(less([1.0, 3.0])), np.array(function([1.0, 3.0], 2.0)))
    assert "sin" not in {step.op for step in program(less).steps}


def test_decisions_as_statements() -> None:
    import casadi

    from alpha5_model.codegen.instructions import TRUTHS, program
    from alpha5_model.codegen.python_code import python_source

    x = casadi.SX.sym("x")
    y = casadi.SX.sym("y")
    less = x < y
    same = casadi.logic_and(x <= y, casadi.logic_not(x < y))
    out = [
        less,
        same,
        casadi.logic_or(less, y < 0),
        casadi.if_else(less, -x, casadi.inf * 0),
    ]
    out += [
        casadi.if_else(less, x, 0),
        casadi.fmin(x, y),
        casadi.fmax(x, y),
        casadi.fabs(y),
    ]
    decide = program(casadi.Function("f", [x, y], out, ["x", "y"], list("abcdefgh")))
    assert {s.op for s in decide.steps} >= {*TRUTHS, "if_else", "if_else_zero"}
    names: dict[str, Any] = {}
    exec(python_source([decide]), names)
    for given in ((1.0, 2.0), (2.0, 2.0), (3.0, 2.0), (3.0, -2.0)):
        found = [float(x) for (x,) in names["f"](*([np.float64(x)] for x in given), np)]
        smaller = given[0] < given[1]
        expected = [smaller, given[0] == given[1], smaller or given[1] < 0]
        assert found[:3] == expected
        assert found[3] == -given[0] if smaller else math.isnan(found[3])
        assert found[4:] == [
            given[0] * smaller,
            min(given),
            max(given),
            abs(given[1]),
        ]


@pytest.mark.parametrize("wrist", [math.nan, math.inf])
def test_what_is_not_a_number_is_within_no_limits(wrist: float) -> None:
    q, _, within, _ = solve(np.array([[0.25, 0.1, 0.1]]), np.array([wrist]))
    assert not within.any()
    assert np.isnan(q[..., 3]).all()
    _, exists, *_ = solve(np.full((1, 3), math.nan), np.zeros(1))
    assert not exists.any()
