"""The C functions of the compiled module as CasADi calls them, here by ctypes."""

from __future__ import annotations

import ctypes

import numpy as np
import pytest

from alpha5_model._support.checks import LARGEST
from alpha5_model.codegen.arm_functions import functions
from alpha5_model.codegen.compiled_code import PARAMETERS
from alpha5_model.codegen.instructions import Program, program
from alpha5_model.numbers.parameters import parameters

compiled = pytest.importorskip(
    "alpha5_model.codegen.kernels._compiled", exc_type=ImportError
)
PROGRAMS = {
    name: program(function) for name, function in functions(parameters()).items()
}
each_function = pytest.mark.parametrize("name", PROGRAMS)


@pytest.fixture(scope="module")
def library() -> ctypes.CDLL:
    return ctypes.CDLL(compiled.__file__)


def sizes(of: Program) -> list[int]:
    """The sizes of a program's inputs; the parameters are last."""
    ordered = sorted(of.inputs, key=lambda slot: slot.name == PARAMETERS)
    return [slot.size for slot in ordered]


def called(library: ctypes.CDLL, name: str, given: list, wanted: list[bool]) -> list:
    """The wanted outputs, else None. An input of None is a null pointer."""
    of = PROGRAMS[name]
    pointer = ctypes.POINTER(ctypes.c_double)
    results = [np.full(slot.size, -7.0) for slot in of.outputs]
    into = [
        x.ctypes.data_as(pointer) if want else None
        for x, want in zip(results, wanted, strict=True)
    ]
    come = [None if x is None else x.ctypes.data_as(pointer) for x in given]
    function = getattr(library, f"alpha5_{name}")
    arguments = (pointer * len(come))(*come)
    outputs = (pointer * len(into))(*into)
    assert function(arguments, outputs, None, None, 0) == 0
    return results


def states(of: Program) -> list[np.ndarray]:
    rng = np.random.default_rng(3)
    return [rng.uniform(0.1, 1.0, size) for size in sizes(of)]


def expected(name: str, given: list[np.ndarray]) -> list[np.ndarray]:
    """The outputs of the bound kernel."""
    of = PROGRAMS[name]
    has_parameters = any(slot.name == PARAMETERS for slot in of.inputs)
    parameters = given[-1] if has_parameters else None
    state = given[:-1] if has_parameters else given
    found = compiled.bind(name, parameters)(*state)
    found = found if isinstance(found, tuple) else (found,)
    return [x.ravel() for x in found]


@each_function
def test_casadi_is_told_the_sizes(library, name):
    of = PROGRAMS[name]
    for question in ("sparsity_in", "sparsity_out"):
        function = getattr(library, f"alpha5_{name}_{question}")
        function.restype = ctypes.POINTER(ctypes.c_longlong)
        function.argtypes = [ctypes.c_longlong]
    assert getattr(library, f"alpha5_{name}_n_in")() == len(of.inputs)
    assert getattr(library, f"alpha5_{name}_n_out")() == len(of.outputs)
    for place, size in enumerate(sizes(of)):
        column = getattr(library, f"alpha5_{name}_sparsity_in")(place)
        assert column[:3] == [size, 1, 1]
    for place, slot in enumerate(of.outputs):
        column = getattr(library, f"alpha5_{name}_sparsity_out")(place)
        assert column[:3] == [slot.size, 1, 1]


@each_function
def test_the_same_as_bound(library, name):
    given = states(PROGRAMS[name])
    found = called(library, name, given, [True] * len(PROGRAMS[name].outputs))
    for one, other in zip(found, expected(name, given), strict=True):
        assert np.array_equal(one, other, equal_nan=True)


@each_function
def test_a_null_pointer_stands_for_zeros(library, name):
    of = PROGRAMS[name]
    for place in range(len(of.inputs)):
        given = states(of)
        zeros = [*given]
        zeros[place] = np.zeros_like(given[place])
        given[place] = None
        found = called(library, name, given, [True] * len(of.outputs))
        for one, other in zip(found, expected(name, zeros), strict=True):
            assert np.array_equal(one, other, equal_nan=True)


@each_function
def test_what_nobody_wants_is_not_written(library, name):
    of = PROGRAMS[name]
    given = states(of)
    wanted = expected(name, given)
    for place in range(len(of.outputs)):
        flags = [other != place for other in range(len(of.outputs))]
        found = called(library, name, given, flags)
        for one, other, flag in zip(found, wanted, flags, strict=True):
            assert np.array_equal(one, other if flag else np.full(one.size, -7.0), True)


@each_function
@pytest.mark.parametrize("value", [np.nan, np.inf, -2 * LARGEST])
def test_what_cannot_be_computed_is_nan(library, name, value):
    of = PROGRAMS[name]
    given = states(of)
    given[0][-1] = value
    for found in called(library, name, given, [True] * len(of.outputs)):
        assert np.isnan(found).all()
