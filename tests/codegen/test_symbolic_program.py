"""Straight-line programs, run in plain Python, agree with CasADi's own evaluation."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest

from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import parameters

if TYPE_CHECKING:
    import casadi

    from alpha5_model.codegen.instructions import Program


OPERATIONS = {
    "add": lambda x, y: x + y,
    "sub": lambda x, y: x - y,
    "mul": lambda x, y: x * y,
    "div": lambda x, y: x / y,
    "fmin": min,
    "fmax": max,
    "neg": lambda x: -x,
    "twice": lambda x: 2 * x,
    "sq": lambda x: x * x,
    "inv": lambda x: 1 / x,
    **{
        name: getattr(math, name)
        for name in ("sqrt", "sin", "cos", "atan", "atan2", "floor", "fabs")
    },
}
DECISIONS = {
    "lt": lambda x, y: x < y,
    "le": lambda x, y: x <= y,
    "and": lambda x, y: x and y,
    "or": lambda x, y: x or y,
    "not": lambda x: not x,
    "if_else": lambda c, x, y: x if c else y,
    "if_else_zero": lambda c, x: x if c else 0.0,
}


def run(of: Program, *inputs: np.ndarray) -> list[np.ndarray]:
    registers: dict[int, float] = {}
    out = [np.full(slot.size, np.nan) for slot in of.outputs]
    for op, result, arguments, value in of.steps:
        if op == "output":
            slot, element, register = arguments
            out[slot][element] = registers[register]
            continue
        assert result not in registers, "written twice"
        if op == "const":
            registers[result] = value
        elif op == "input":
            registers[result] = inputs[arguments[0]].ravel()[arguments[1]]
        else:
            registers[result] = (OPERATIONS | DECISIONS)[op](
                *(registers[i] for i in arguments)
            )
    return [x.reshape(slot.shape) for x, slot in zip(out, of.outputs, strict=True)]


def against_casadi(function: casadi.Function, rng: np.random.Generator) -> None:
    import casadi

    from alpha5_model.codegen.instructions import program

    one = program(function)
    inputs = [rng.uniform(0.1, 1.5, slot.shape) for slot in one.inputs]
    expected = function.call([casadi.DM(x) for x in inputs])
    for got, want in zip(run(one, *inputs), expected, strict=True):
        assert np.allclose(
            got,
            np.array(want).reshape(got.shape),
            rtol=1e-13,
            atol=1e-15,
            equal_nan=True,
        )


def test_every_operation_gives_what_casadi_computes() -> None:
    import casadi

    from alpha5_model.codegen.instructions import OPERATIONS as KNOWN
    from alpha5_model.codegen.instructions import program

    assert {*OPERATIONS, *DECISIONS} == {*KNOWN, "if_else"}
    x = casadi.SX.sym("x", 2)
    y = casadi.SX.sym("y", 2, 3)
    a = x[0]
    b = x[1]
    every = [
        a + b,
        a - b,
        a * b,
        a / b,
        casadi.fmin(a, b),
        casadi.fmax(a, b),
        -a,
        2 * a,
        a * a,
        1 / a,
    ]
    every += [
        getattr(casadi, f)(a) for f in ("sqrt", "sin", "cos", "atan", "floor", "fabs")
    ]
    every += [casadi.atan2(a, b), casadi.SX(0.25), y[0, 2]]
    function = casadi.Function(
        "every",
        [x, y],
        [casadi.vertcat(*every), y.T @ y, x],
        ["x", "y"],
        ["out", "square", "copy"],
    )
    assert {step.op for step in program(function).steps} >= {*OPERATIONS}
    against_casadi(function, np.random.default_rng(1))


def test_the_arms_functions_give_what_casadi_computes() -> None:
    from alpha5_model.codegen.arm_functions import functions

    for function in functions().values():
        against_casadi(function, np.random.default_rng(2))


def test_equal_expressions_are_computed_once_and_sine_stands_beside_cosine() -> None:
    import casadi

    from alpha5_model.codegen.instructions import program

    x = casadi.SX.sym("x", 2)
    a = x[0]
    b = x[1]
    out = casadi.vertcat(
        casadi.sin(a) * b, b * casadi.sin(a) + casadi.cos(b), casadi.cos(a)
    )
    one = program(casadi.Function("f", [x], [out], ["x"], ["out"]))
    ops = [step.op for step in one.steps]
    assert (ops.count("mul"), ops.count("add"), ops.count("sin")) == (1, 1, 1)
    sine = ops.index("sin")
    angle = one.steps[sine].arguments
    cosines = [
        place
        for place, step in enumerate(one.steps)
        if (step.op, step.arguments) == ("cos", angle)
    ]
    assert abs(sine - cosines[0]) == 1


@pytest.mark.parametrize("opposite", ["not", "neg", "sqrt"])
def test_a_sum_is_a_selection_if_one_condition_is_the_others_opposite(
    opposite: str,
) -> None:
    from alpha5_model.codegen.instructions import Step, _selecting

    steps = [
        Step(op="input", result=0, arguments=(0, 0)),
        Step(op=opposite, result=1, arguments=(0,)),
        Step(op="if_else_zero", result=2, arguments=(0, 0)),
        Step(op="if_else_zero", result=3, arguments=(1, 0)),
        Step(op="add", result=4, arguments=(2, 3)),
    ]
    last = _selecting(steps)[-1]
    assert last.op == ("if_else" if opposite == "not" else "add")


def test_what_no_emitter_knows_is_refused() -> None:
    import casadi

    from alpha5_model.codegen.instructions import program

    x = casadi.SX.sym("x", 2)
    for out, message in (
        (casadi.erf(x), "instruction"),
        (casadi.SX(casadi.Sparsity(2, 1)), "dense"),
    ):
        with pytest.raises(InputError, match=message):
            program(casadi.Function("f", [x], [out], ["x"], ["out"]))


def test_slots_are_named_with_shape_unit_and_meaning() -> None:
    from alpha5_model.codegen.arm_functions import functions, products
    from alpha5_model.codegen.instructions import program

    one = program(functions()["inverse_dynamics"])
    assert [slot.name for slot in one.inputs] == ["q", "v", "a", "parameters"]
    assert [slot.shape for slot in one.outputs] == [(4,)]
    assert "[rad]" in one.documentation("Torque.")
    for function in (functions() | products(parameters())).values():
        every = program(function)
        assert all(slot.text for slot in (*every.inputs, *every.outputs)), every.name
