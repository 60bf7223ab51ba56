"""The JAX functions and their derivatives agree with Pinocchio in both precisions."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from importlib import import_module
from inspect import signature
from typing import TYPE_CHECKING

import numpy as np
import pytest
from dynamics_cases import PAYLOAD
from ik_targets import EDGES, at_edge, ordinary
from product_cases import ARMS, DYNAMICS, states

import alpha5_model as a5
from alpha5_model.errors import MissingDependencyError, ShapeError

if TYPE_CHECKING:
    import jax

    from alpha5_model.jax import Solutions


pytestmark = pytest.mark.tools


@pytest.fixture(autouse=True)
def double() -> Iterator[None]:
    import jax

    with jax.enable_x64(True):
        yield


def largest(found: object, expected: object) -> float:
    """Difference, as a share of the largest entry or of 1."""
    want = np.asarray(expected)
    return float(np.abs(np.asarray(found) - want).max() / max(1.0, np.abs(want).max()))


@pytest.mark.parametrize("name", ["sea", "payload, tilted"])
def test_every_method_gives_what_pinocchio_gives(name: str) -> None:
    from alpha5_model.codegen.c_library.self_test import answer
    from alpha5_model.jax import load

    arm = ARMS[name]()
    ours = load(arm)
    for state in states(2, seed=6):
        for method in DYNAMICS:
            given = {n: state[n] for n in signature(getattr(ours, method)).parameters}
            found = getattr(ours, method)(*given.values())
            found = found if isinstance(found, tuple) else (found,)
            bound = 1e-9 if "forward_d" in method else 1e-12
            for got, want in zip(found, answer(arm, method, given), strict=True):
                assert got.shape == want.shape
                assert largest(got, want) < bound, method


def test_compiled_over_a_batch() -> None:
    import jax

    from alpha5_model.jax import load

    arm = a5.load()
    ours = load()
    q, v, a = (np.array([s[n] for s in states(50, seed=7)]) for n in "qva")
    tau = jax.jit(jax.vmap(ours.inverse_dynamics))(q, v, a)
    assert largest(tau, arm.inverse_dynamics_batch(q, v, a)) < 1e-12


def test_jaxs_own_derivatives_are_pinocchios() -> None:
    import jax

    from alpha5_model.jax import load

    arm = a5.load()
    ours = load()
    q, v, _, tau = states(2, seed=8)[1].values()
    way = np.random.default_rng(8).normal(size=(3, 4))
    _, found = jax.jvp(ours.forward_dynamics, (q, v, tau), tuple(way))
    expected = arm.forward_dynamics_derivatives(q, v, tau)
    assert largest(found, sum(d @ x for d, x in zip(expected, way, strict=True))) < 1e-9
    row = jax.grad(lambda q: ours.hydrostatic_torque(q)[1])(q)
    assert largest(row, arm.hydrostatic_torque_derivative(q)[1]) < 1e-9


def test_a_payload_and_its_gradient() -> None:
    import jax
    import jax.numpy as jnp

    from alpha5_model.jax import load

    arm = a5.load()
    ours = load()
    q = states(2, seed=9)[1]["q"]
    mass = PAYLOAD["mass"]
    rest = {n: PAYLOAD[n] for n in PAYLOAD if n != "mass"}

    def torque(mass: float) -> jax.Array:
        return ours.with_payload(mass, **rest).hydrostatic_torque(q)

    expected = arm.with_payload(**PAYLOAD).hydrostatic_torque(q)
    found, slope = jax.jvp(torque, (mass,), (1.0,))
    assert largest(found, expected) < 1e-12
    # linear in the mass: any two of them give the slope
    more = arm.with_payload(**{**PAYLOAD, "mass": mass + 1.0}).hydrostatic_torque(q)
    assert largest(slope, more - expected) < 1e-9
    point = arm.with_payload(0.4, (0.0, 0.0, 0.1)).hydrostatic_torque(q)
    moved = ours.with_payload(0.4, (0.0, 0.0, jnp.array(0.1)))
    assert largest(moved.hydrostatic_torque(q), point) < 1e-12


def test_an_arm_goes_through_transformations() -> None:
    """A function is compiled once for the parameters of any arm."""
    import jax
    import jax.numpy as jnp

    from alpha5_model.jax import JaxArm, load

    q = states(2, seed=10)[1]["q"]
    holding = jax.jit(lambda arm, q: arm.hydrostatic_torque(q))
    for density in (a5.SEA_WATER, a5.AIR):
        ours = load(fluid_density=density)
        assert largest(holding(ours, q), a5.load(density).hydrostatic_torque(q)) < 1e-12
    assert holding._cache_size() == 1
    stacked = jax.tree.map(
        lambda *x: jnp.stack(x), *(load(fluid_density=d) for d in (0.0, 1e3))
    )
    both = jax.vmap(JaxArm.hydrostatic_torque, (0, None))(stacked, q)
    assert largest(both[1], a5.load(1e3).hydrostatic_torque(q)) < 1e-12


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_the_precision_is_that_of_what_is_given(kind: type) -> None:
    from alpha5_model.jax import load

    q = states(2, seed=11)[1]["q"]
    tau = load().with_payload(0.0).hydrostatic_torque(q.astype(kind))
    assert tau.dtype == kind
    bound = 1e-12 if kind is np.float64 else 1e-5
    assert largest(tau, a5.load().hydrostatic_torque(q)) < bound


def test_single_precision_is_jaxs_default() -> None:
    import jax

    from alpha5_model.jax import inverse_kinematics, load

    q = states(2, seed=12)[1]["q"]
    with jax.enable_x64(False):
        tau = load().hydrostatic_torque(q)
        assert tau.dtype == np.float32
        assert largest(tau, a5.load().hydrostatic_torque(q)) < 1e-5
        # A target on the edge to rounding is on it in single precision, too.
        edge = np.array([0.02 + 0.33181301122930, 0.0, 0.0462])
        stretched = jax.jit(inverse_kinematics)(edge)
    assert stretched.q.dtype == np.float32
    assert stretched.singular
    assert stretched.exists[0]


def test_inverse_kinematics_with_its_flags_and_gradient() -> None:
    import jax

    from alpha5_model.jax import inverse_kinematics

    gap = np.random.default_rng(1).choice(
        [0.0, 5e-11, -5e-11, 2e-10, -2e-10, 2e-9, -2e-9], 40
    )
    targets = [
        ordinary(400, 1),
        *(at_edge(edge, 40, i, gap) for i, edge in enumerate(EDGES)),
    ]
    position, wrist = (np.concatenate(parts) for parts in zip(*targets, strict=True))

    def shoulder(p: jax.Array, w: jax.Array) -> tuple[jax.Array, Solutions]:
        solutions = inverse_kinematics(p, w)
        return solutions.q[0, 1], solutions

    solve = jax.jit(jax.vmap(jax.value_and_grad(shoulder, has_aux=True)))
    (_, found), slope = solve(position, wrist)
    expected = a5.inverse_kinematics(position, wrist)
    clear = ~expected.singular
    # sqrt of rounding near an edge
    np.testing.assert_allclose(found.q[clear], expected.q[clear], atol=1e-6)
    np.testing.assert_array_equal(found.exists, expected.exists)
    np.testing.assert_array_equal(found.within_limits, expected.within_limits)
    np.testing.assert_array_equal(found.singular, expected.singular)
    # where the other pose does not reach, too
    arm = a5.load()
    reached = expected.exists[:400, 0]
    assert not expected.exists[:400][reached, 1].all()
    for i in np.flatnonzero(reached)[:100]:
        linear = arm.jacobian(expected.q[i, 0])[:3, :3]
        np.testing.assert_allclose(
            slope[i], np.linalg.inv(linear)[1], rtol=1e-6, atol=1e-6
        )


@pytest.mark.parametrize(("single", "compiled"), [(False, True), (True, False)])
def test_a_missing_branch_does_not_spoil_the_others(
    single: bool, compiled: bool
) -> None:
    import jax
    import jax.numpy as jnp

    from alpha5_model.jax import inverse_kinematics

    far = np.array([9.0, 0.1, 0.2])
    one_elbow = np.array([0.3, 0.1, 0.05])
    expected = a5.inverse_kinematics(one_elbow).exists
    assert expected.any()
    assert not expected.all()

    def q(position: jax.Array, wrist: jax.Array) -> jax.Array:
        return inverse_kinematics(position, wrist).q

    def chosen(position: jax.Array) -> jax.Array:
        solutions = inverse_kinematics(position)
        return jnp.where(solutions.exists[:, None], solutions.q, 0.0).sum()

    with jax.enable_x64(not single):
        run = jax.jit if compiled else lambda function: function
        for slopes in (jax.jacrev, jax.jacfwd):
            slope = run(slopes(q, (0, 1)))
            by_position, by_wrist = map(np.asarray, slope(one_elbow, 0.3))
            assert np.isfinite(by_position[expected]).all()
            assert np.abs(by_position[expected]).max() > 1.0
            assert np.array_equal(by_wrist[expected][:, 3], np.ones(expected.sum()))
        assert np.isfinite(run(jax.grad(chosen))(one_elbow)).all()
        many = run(jax.vmap(jax.grad(chosen)))(np.array([one_elbow, far]))
        assert np.isfinite(many).all()


def test_wrong_input_is_told() -> None:
    from alpha5_model.jax import load

    with pytest.raises(ShapeError, match=r"shape \(4,\)"):
        load().inverse_dynamics(np.zeros(5), np.zeros(4), np.zeros(4))
    with pytest.raises(ShapeError, match=r"shape \(1,\)"):
        load().with_payload(np.ones(3))
    with pytest.raises(a5.Alpha5Error, match="fixed base with its jaws locked"):
        load(gripper="jaws")


def test_without_jax_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "alpha5_model.jax")
    monkeypatch.setitem(sys.modules, "jax", None)
    with pytest.raises(MissingDependencyError, match="pip install"):
        import_module("alpha5_model.jax")
