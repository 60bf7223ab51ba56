"""The CasADi Functions agree with Pinocchio, and so do CasADi's derivatives of them."""

from __future__ import annotations

import pickle
import sys
from importlib import import_module
from typing import TYPE_CHECKING

import numpy as np
import pytest
from dynamics_cases import PAYLOAD
from ik_targets import ordinary
from product_cases import ARMS, DYNAMICS, states

import alpha5_model as a5
from alpha5_model.errors import MissingDependencyError

if TYPE_CHECKING:
    import casadi


def called(function: casadi.Function, *inputs: object) -> list[np.ndarray]:
    """Outputs as arrays, columns as vectors."""
    import casadi

    found = function.call([casadi.DM(np.asarray(x)) for x in inputs])
    return [np.array(x)[:, 0] if x.is_column() else np.array(x) for x in found]


pytestmark = pytest.mark.tools


@pytest.mark.parametrize("fold", [True, False])
@pytest.mark.parametrize("name", ARMS)
def test_every_function_gives_what_pinocchio_gives(name: str, fold: bool) -> None:
    from alpha5_model.casadi import load
    from alpha5_model.codegen.c_library.self_test import answer

    arm = ARMS[name]()
    functions = load(arm, fold=fold)
    rest = [] if fold else [functions.parameters]
    for state in states(5, seed=1):
        for method in DYNAMICS:
            function = getattr(functions, method)
            given = {n: state[n] for n in function.name_in() if n in state}
            more = rest if "parameters" in function.name_in() else []
            found = called(function, *given.values(), *more)
            for got, want in zip(found, answer(arm, method, given), strict=True):
                bound = 1e-9 if "forward_d" in method else 1e-12
                assert np.abs(got - want).max() < bound * max(
                    1.0, np.abs(want).max()
                ), method


def test_casadis_own_derivatives_are_pinocchios() -> None:
    from alpha5_model.casadi import load

    arm = a5.load()
    functions = load()
    (state,) = states(2, seed=2)[1:]
    q, v, a, tau = state.values()
    for method, last in (
        ("inverse_dynamics", a),
        ("forward_dynamics", tau),
        ("base_wrench", a),
    ):
        found = called(
            getattr(functions, method).jacobian(),
            q,
            v,
            last,
            np.zeros(6 if "base" in method else 4),
        )
        for got, want in zip(
            found, getattr(arm, method + "_derivatives")(q, v, last), strict=True
        ):
            assert np.abs(got - want).max() < 1e-9 * max(1.0, np.abs(want).max())


def test_a_payload_is_an_input_too() -> None:
    """The torque is linear in the payload's mass, and has a derivative by it."""
    import casadi

    from alpha5_model.casadi import load

    functions = load(fold=False)
    arm = a5.load()
    mass = casadi.SX.sym("mass")
    rest = [np.array(PAYLOAD[name]) for name in ("com", "inertia", "volume", "cob")]
    loaded = functions.with_payload(functions.parameters, mass, *rest)
    q, v, a, _ = states(2, seed=3)[1].values()
    torque = functions.inverse_dynamics(q, v, a, loaded)
    f = casadi.Function("f", [mass], [torque, casadi.jacobian(torque, mass)])
    found, slope = called(f, PAYLOAD["mass"])
    zero, _ = called(f, 0.0)
    expected = arm.with_payload(**PAYLOAD).inverse_dynamics(q, v, a)
    np.testing.assert_allclose(found, expected, atol=1e-13)
    np.testing.assert_allclose(slope, (found - zero) / PAYLOAD["mass"], atol=1e-12)


def test_inverse_kinematics_with_its_flags() -> None:
    from alpha5_model.casadi import load

    solve = load().inverse_kinematics
    position, wrist = ordinary(60, 4)
    expected = a5.inverse_kinematics(position, wrist)
    for i in range(len(position)):
        q, exists, within, singular = called(solve, position[i], wrist[i])
        np.testing.assert_allclose(q, expected.q[i], atol=1e-12)
        assert (exists == expected.exists[i]).all()
        assert (within == expected.within_limits[i]).all()
        assert singular == expected.singular[i]


def test_names_shapes_and_units_are_documented() -> None:
    from alpha5_model.casadi import load

    functions = load()
    assert functions.inverse_dynamics.__doc__.startswith("Joint torque for a motion")
    for line in (
        "q (4): joint positions, base to tip [rad]",
        "tau (4): joint torques [N m]",
    ):
        assert line in functions.inverse_dynamics.__doc__
    for name, function in vars(functions).items():
        if name != "parameters":
            assert function.name() == name
            assert "[" in function.__doc__, name
            assert ": \n" not in function.__doc__ + "\n", name
    again = pickle.loads(pickle.dumps(functions.inverse_dynamics))
    still = np.zeros(4)
    np.testing.assert_array_equal(
        called(again, *[still] * 3), called(functions.inverse_dynamics, *[still] * 3)
    )


def test_a_buffered_call_gives_the_same() -> None:
    from alpha5_model.casadi import load

    function = load().inverse_dynamics
    state = states(2, seed=5)[1]
    buffer, evaluate = function.buffer()
    tau = np.zeros(4)
    for i, name in enumerate("qva"):
        buffer.set_arg(i, memoryview(state[name]))
    buffer.set_res(0, memoryview(tau))
    evaluate()
    np.testing.assert_array_equal(tau, called(function, *(state[n] for n in "qva"))[0])


@pytest.mark.parametrize("options", [{"floating_base": True}, {"gripper": "jaws"}])
def test_arms_that_it_has_no_equations_for_are_refused(options: dict) -> None:
    from alpha5_model.casadi import load

    with pytest.raises(a5.Alpha5Error, match="fixed base with its jaws locked"):
        load(**options)
    with pytest.raises(a5.Alpha5Error, match="arm"):
        load(3)


def test_without_casadi_it_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for name in [
        name for name in sys.modules if name.startswith("alpha5_model.codegen")
    ]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "casadi", None)
    with pytest.raises(MissingDependencyError, match="pip install"):
        import_module("alpha5_model.codegen.arm_functions")
