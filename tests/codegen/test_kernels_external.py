"""The C functions of the compiled module as CasADi calls them, here by ctypes."""

from __future__ import annotations

import ctypes
import math

import numpy as np
import pytest
from compiled_kernels import compiled_kernels

from alpha5_model._support.checks import LARGEST
from alpha5_model.codegen.kernels.generated.formulas import KERNELS

compiled = compiled_kernels()
#: The most numbers of a state are fewer: a pose of a vehicle has seven.
LEAST_PARAMETERS = 10


@pytest.fixture(scope="module")
def library() -> ctypes.CDLL:
    return ctypes.CDLL(compiled.__file__)


def called(library: ctypes.CDLL, name: str, given: list, wanted: list[bool]) -> list:
    """The wanted outputs, else None. An input of None is a null pointer."""
    pointer = ctypes.POINTER(ctypes.c_double)
    results = [np.full(math.prod(shape), -7.0) for shape in KERNELS[name][2]]
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


def states(name: str) -> list[np.ndarray]:
    """Random inputs; the parameters are last."""
    rng = np.random.default_rng(3)
    return [rng.uniform(0.1, 1.0, size) for (size,) in KERNELS[name][1]]


def expected(name: str, given: list[np.ndarray]) -> list[np.ndarray]:
    """The outputs of the bound kernel."""
    if given[-1].size < LEAST_PARAMETERS:
        found = compiled.bind(name, None)(*given)
    else:
        found = compiled.bind(name, given[-1])(*given[:-1])
    found = found if isinstance(found, tuple) else (found,)
    return [x.ravel() for x in found]


def same(one: list[np.ndarray], other: list[np.ndarray]) -> bool:
    pairs = zip(one, other, strict=True)
    return all(np.array_equal(x, y, equal_nan=True) for x, y in pairs)


def test_casadi_is_told_the_sizes(library: ctypes.CDLL) -> None:
    for name, (_, inputs, outputs) in KERNELS.items():
        for question, shapes in (("in", inputs), ("out", outputs)):
            assert getattr(library, f"alpha5_{name}_n_{question}")() == len(shapes)
            function = getattr(library, f"alpha5_{name}_sparsity_{question}")
            function.restype = ctypes.POINTER(ctypes.c_longlong)
            function.argtypes = [ctypes.c_longlong]
            columns = [function(place)[:3] for place in range(len(shapes))]
            assert columns == [[math.prod(shape), 1, 1] for shape in shapes], name


def test_the_same_as_bound_and_a_null_pointer_stands_for_zeros(
    library: ctypes.CDLL,
) -> None:
    different = []
    for name, (_, inputs, outputs) in KERNELS.items():
        every = [True] * len(outputs)
        given = states(name)
        if not same(called(library, name, given, every), expected(name, given)):
            different.append(name)
        for place in range(len(inputs)):
            zeros = [*given]
            zeros[place] = np.zeros_like(given[place])
            null: list = [*given]
            null[place] = None
            if not same(called(library, name, null, every), expected(name, zeros)):
                different.append((name, place))
    assert not different


def test_what_nobody_wants_is_not_written(library: ctypes.CDLL) -> None:
    different = []
    for name, (_, _, outputs) in KERNELS.items():
        given = states(name)
        for place in range(len(outputs)):
            wanted = expected(name, given)
            wanted[place][:] = -7.0
            flags = [other != place for other in range(len(outputs))]
            if not same(called(library, name, given, flags), wanted):
                different.append((name, place))
    assert not different


def test_what_cannot_be_computed_is_nan(library: ctypes.CDLL) -> None:
    computed = []
    for name, (_, _, outputs) in KERNELS.items():
        for value in (np.nan, np.inf, -2 * LARGEST):
            given = states(name)
            given[0][-1] = value
            found = called(library, name, given, [True] * len(outputs))
            if not all(np.isnan(x).all() for x in found):
                computed.append((name, value))
    assert not computed
