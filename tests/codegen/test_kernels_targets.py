"""One target of the inverse kinematics: what the kernels take, refuse and give back."""

from __future__ import annotations

import math
import sys
from types import ModuleType

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.kinematics import ik
from alpha5_model.kinematics.solver import ON_AXIS, shape_of_kernels


@pytest.fixture(params=["_compiled", "numpy_kernels"])
def kernels(request: pytest.FixtureRequest) -> ModuleType:
    """The kernels in NumPy, and the compiled ones if they are installed."""
    name = f"alpha5_model.codegen.kernels.{request.param}"
    return pytest.importorskip(name, exc_type=ImportError)


COMPILED = "alpha5_model.codegen.kernels._compiled"
TARGET = [0.2, -0.1, 0.15]
LONG = 10**400


class Real(float):
    """A subclass whose meaning is unknown."""


class Three(list):
    """Another subclass whose meaning is unknown."""


UNFIT_POSITIONS = {
    "two numbers": TARGET[:2],
    "four numbers": [*TARGET, 0.0],
    "no number": [],
    "two numbers in an array": np.array(TARGET[:2]),
    "four numbers in an array": np.array([*TARGET, 0.0]),
    "a row": np.array([TARGET]),
    "a column": np.array(TARGET).reshape(3, 1),
    "a number": 0.2,
    "a text": "abc",
    "nothing": None,
    "a set": {0.1, 0.2, 0.3},
    "a subclass": Three(TARGET),
    "numbers of a subclass": [Real(0.2), -0.1, 0.15],
    "numbers of numpy": [0.2, -0.1, np.float64(0.15)],
    "a truth value": [0.2, True, 0.15],
    "single precision": np.array(TARGET, np.float32),
    "integers": np.array([0, 1, 2]),
    "every second": np.repeat(TARGET, 2)[::2],
    "the other byte order": np.array(TARGET).view(np.dtype(np.float64).newbyteorder()),
    "NaN": [0.2, np.nan, 0.15],
    "infinite": [0.2, -0.1, -math.inf],
    "an integer without end": [LONG, 0.1, 0.1],
    "a nested list": [TARGET, TARGET, TARGET],
}
#: Which the compiled kernel alone refuses.
ANY_ARRAY = ("every second", "the other byte order", "single precision")
UNFIT_WRISTS = {
    "NaN": math.nan,
    "infinite": math.inf,
    "too large": -1e300,
    "nothing": None,
    "text": "1.0",
    "a truth value": True,
    "a subclass": Real(1.0),
    "of numpy": np.float64(1.0),
    "an array": np.array(1.0),
    "an integer without end": -LONG,
}


@pytest.mark.parametrize("unfit", UNFIT_POSITIONS)
def test_what_is_not_plainly_a_position_gets_none(
    kernels: ModuleType, unfit: str
) -> None:
    if "numpy" in kernels.__name__ and unfit in ANY_ARRAY:
        pytest.skip("NumPy reads the numbers of any array")
    assert kernels.inverse_kinematics(ik.Solutions, UNFIT_POSITIONS[unfit], 0.5) is None


@pytest.mark.parametrize("unfit", UNFIT_WRISTS)
def test_what_is_not_plainly_an_angle_gets_none(
    kernels: ModuleType, unfit: str
) -> None:
    assert kernels.inverse_kinematics(ik.Solutions, TARGET, UNFIT_WRISTS[unfit]) is None


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


def test_integers_are_numbers_for_the_compiled_kernel() -> None:
    compiled = pytest.importorskip(COMPILED, exc_type=ImportError)
    whole = compiled.inverse_kinematics(ik.Solutions, [0, -1, 2], -1)
    real = compiled.inverse_kinematics(ik.Solutions, [0.0, -1.0, 2.0], -1.0)
    for one, other in zip(whole, real, strict=True):
        assert np.array_equal(one, other, equal_nan=True)


def test_the_compiled_kernel_makes_named_tuples_only() -> None:
    compiled = pytest.importorskip(COMPILED, exc_type=ImportError)
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


@pytest.mark.parametrize(
    "name", ["forward_kinematics", "link_poses", "coriolis_matrix", "forward_dynamics"]
)
def test_only_a_bound_solver_is_the_kernel_of_an_arm(name: str) -> None:
    """Neither one with as many outputs nor one with as many inputs."""
    compiled = pytest.importorskip(COMPILED, exc_type=ImportError)
    bound = compiled.bind(name, a5.load()._kernel_parameters)
    for wrong in (bound, name, None, compiled):
        with pytest.raises(TypeError, match="the bound kernel of an arm"):
            compiled.inverse_kinematics(ik.Solutions, TARGET, 0.5, wrong)
    solver = compiled.bind(ON_AXIS, shape_of_kernels().numbers)
    arguments = (ik.Solutions, TARGET, 0.5, solver)
    one = compiled.inverse_kinematics(*arguments)
    other = compiled.inverse_kinematics(*arguments[:3])
    np.testing.assert_allclose(one.q, other.q, rtol=0, atol=1e-12)
    with pytest.raises(TypeError, match="the bound kernel of an arm"):
        compiled.inverse_kinematics(*arguments, solver)


def test_references_of_a_target_are_given_back() -> None:
    compiled = pytest.importorskip(COMPILED, exc_type=ImportError)
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
