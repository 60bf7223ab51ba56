"""One target of the inverse kinematics: what the kernels take, refuse and give back."""

from __future__ import annotations

import math
import sys
from types import ModuleType

import numpy as np
import pytest
from compiled_kernels import compiled_kernels

import alpha5_model as a5
from alpha5_model.codegen.kernels import numpy_kernels
from alpha5_model.kinematics import ik
from alpha5_model.kinematics.solver import ON_AXIS, shape_of_kernels


@pytest.fixture(params=["compiled", "numpy"])
def kernels(request: pytest.FixtureRequest) -> ModuleType:
    """The kernels in NumPy, and the compiled ones if they are installed."""
    return compiled_kernels() if request.param == "compiled" else numpy_kernels


TARGET = [0.2, -0.1, 0.15]
LONG = 10**400


class Real(float):
    """A subclass whose meaning is unknown."""


#: A position is three plain numbers, and a wrist is one.
UNFIT = {
    "two numbers": (TARGET[:2], 0.5),
    "four numbers": ([*TARGET, 0.0], 0.5),
    "a row": (np.array([TARGET]), 0.5),
    "a text": ("abc", 0.5),
    "nothing": (None, 0.5),
    "numbers of a subclass": ([Real(0.2), -0.1, 0.15], 0.5),
    "numbers of numpy": ([0.2, -0.1, np.float64(0.15)], 0.5),
    "a truth value": ([0.2, True, 0.15], 0.5),
    "NaN": ([0.2, np.nan, 0.15], 0.5),
    "infinite": ([0.2, -0.1, -math.inf], 0.5),
    "an integer without end": ([LONG, 0.1, 0.1], 0.5),
    "NaN as wrist": (TARGET, math.nan),
    "a large wrist": (TARGET, -1e300),
    "no wrist": (TARGET, None),
    "a text as wrist": (TARGET, "1.0"),
    "a truth value as wrist": (TARGET, True),
    "an array as wrist": (TARGET, np.array(1.0)),
    "a wrist without end": (TARGET, -LONG),
}
#: What the compiled kernel does not read; NumPy reads the numbers of any array.
UNREAD = {
    "every second": np.repeat(TARGET, 2)[::2],
    "the other byte order": np.array(TARGET).view(np.dtype(np.float64).newbyteorder()),
    "single precision": np.array(TARGET, np.float32),
}


def test_what_is_not_plainly_a_target_gets_none(kernels: ModuleType) -> None:
    unfit = dict(UNFIT)
    if kernels is not numpy_kernels:
        unfit |= {name: (position, 0.5) for name, position in UNREAD.items()}
    solve = kernels.inverse_kinematics
    taken = [name for name, given in unfit.items() if solve(ik.Solutions, *given)]
    assert not taken


def test_what_is_plainly_a_target_is_taken(kernels: ModuleType) -> None:
    wanted = kernels.inverse_kinematics(ik.Solutions, TARGET, -1.0)
    assert wanted.exists.any()
    for position in (tuple(TARGET), np.array(TARGET)):
        answer = kernels.inverse_kinematics(ik.Solutions, position, -1.0)
        assert type(answer) is ik.Solutions
        assert np.array_equal(answer.q, wanted.q, equal_nan=True)
        assert np.array_equal(answer.position, TARGET)
    # Minus one is also what Python's numbers say after an error.
    behind = kernels.inverse_kinematics(ik.Solutions, [-1.0, -1.0, -1.0], -1.0)
    assert not behind.exists.any()
    assert np.array_equal(behind.position, [-1.0, -1.0, -1.0])


def test_the_compiled_kernel_makes_named_tuples_only() -> None:
    compiled = compiled_kernels()
    given = (ik.Solutions, TARGET, 0.5)
    for arguments in (
        (list, TARGET, 0.5),
        (object, TARGET, 0.5),
        (None, TARGET, 0.5),
        ((), TARGET, 0.5),
        given[:2],
        (*given, 1.0),
        (),
    ):
        with pytest.raises(TypeError, match="kind of tuple, position and wrist"):
            compiled.inverse_kinematics(*arguments)
    assert type(compiled.inverse_kinematics(tuple, TARGET, 0.5)) is tuple


def test_only_a_bound_solver_is_the_kernel_of_an_arm() -> None:
    """Neither one with as many outputs nor one with as many inputs."""
    compiled = compiled_kernels()
    solver = compiled.bind(ON_AXIS, shape_of_kernels().numbers)
    for name in ("link_poses", "coriolis_matrix"):
        bound = compiled.bind(name, a5.load()._kernel_parameters)
        for wrong in (bound, name, None):
            with pytest.raises(TypeError):
                compiled.inverse_kinematics(ik.Solutions, TARGET, 0.5, wrong)
    arguments = (ik.Solutions, TARGET, 0.5, solver)
    one = compiled.inverse_kinematics(*arguments)
    other = compiled.inverse_kinematics(*arguments[:3])
    np.testing.assert_allclose(one.q, other.q, rtol=0, atol=1e-12)


def test_references_of_a_target_are_given_back() -> None:
    compiled = compiled_kernels()
    numbers = [0.2, -0.1, 0.15]
    unfit = [0.2, -0.1, Real(0.15)]
    array = np.array(TARGET)
    wrist = 0.5

    def every() -> None:
        for position in (numbers, array, unfit):
            compiled.inverse_kinematics(ik.Solutions, position, wrist)

    every()
    counted = (numbers, *numbers, unfit, *unfit, array, wrist, ik.Solutions)
    before = [*map(sys.getrefcount, counted)]
    for _ in range(100):
        every()
    assert [*map(sys.getrefcount, counted)] == before


def test_answers_cannot_be_written(kernels: ModuleType) -> None:
    for array in kernels.inverse_kinematics(ik.Solutions, TARGET, 0.5):
        assert not array.flags.writeable
