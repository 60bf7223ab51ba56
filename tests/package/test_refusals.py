"""What each public function says to arrays that it cannot use.

Most messages follow a rule: they name the parameter, what was expected and what was
given. All others are kept in ``tests/printed/refusals.txt``; after a change that you
meant, run this file with ``ALPHA5_UPDATE_PRINTED=1`` and read the difference.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import array_functions as functions
import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import Alpha5Error, ShapeError

pytestmark = pytest.mark.filterwarnings(
    "ignore::alpha5_model.errors.ImplausibleWarning"
)
KEPT = Path(__file__).parents[1] / "printed" / "refusals.txt"
#: Functions of the package's own that take checked arrays, and methods of curves, which
#: are results and check nothing.
UNCHECKED = (
    "check_inside",
    "frame_positions",
    "torque_margin",
    "torque_terms",
    "water_terms",
    "Arc.",
    "Segment.",
)
#: Where NaN is what was not measured, as documented.
NOT_MEASURED = ("session(readings)", "with_readings(readings)")
#: What is wrong with an array -> what makes it so.
SPOILT: dict[str, Callable[[np.ndarray], Any]] = {
    "a text": lambda array: "x",
    "axes more": lambda array: np.broadcast_to(array, (1, 1, 1, *array.shape)),
    "NaN": lambda array: np.where(np.indices(array.shape).any(axis=0), array, np.nan),
    "an element more": lambda array: np.concatenate([array, array[..., -1:]], axis=-1),
    "nothing in it": lambda array: array[:0],
    "zeros": np.zeros_like,
    "huge numbers": lambda array: np.full(array.shape, 1e300),
}
#: Of these, what a number can be.
OF_NUMBERS = ("a text", "axes more", "zeros", "huge numbers")


def spoilt(array: np.ndarray) -> dict[str, Any]:
    """The array in all ways that it has the axes for."""
    kinds = SPOILT if array.ndim else OF_NUMBERS
    return {kind: SPOILT[kind](array) for kind in kinds}


@cache
def answers() -> list[tuple[str, str, Any, str]]:
    """(Function, parameter, what it was, what came of it) of each call."""
    calls = [
        *functions.arm_calls(),
        *functions.kinematics_calls(),
        *functions.theory_calls(),
    ]
    found = []
    for name, call in calls:
        if name.startswith(UNCHECKED):
            continue
        for parameter, array in call.arrays.items():
            for kind, value in spoilt(np.asarray(array)).items():
                said = answer(call, {**call.arrays, parameter: value})
                found.append(
                    (f"{name}({parameter}) with {kind}", parameter, value, said)
                )
    return found


def answer(call: functions.Call, given: dict[str, Any]) -> str:
    """What comes of a call, in words."""
    try:
        call.function(**given, **call.others)
    except Alpha5Error as error:
        return f"{type(error).__name__}: {error}"
    except Exception as error:
        return f"raises {type(error).__name__}: {error}"
    return "accepted"


def follows_the_rule(parameter: str, value: Any, said: str) -> bool:
    """Whether a message is what any function says to such an array."""
    if isinstance(value, str):
        words = "expected an array of real numbers, without mask or unit, got 'x'"
        return said == f"InputError: {parameter}: {words}"
    too_large = "expected numbers of at most 2.4e+51, else results overflow, got 1e+300"
    if said == f"InputError: {parameter}: {too_large}":
        return bool(np.max(value) == 1e300)
    place = ", ".join("0" * np.ndim(value))
    if (
        said
        == f"NonFiniteError: {parameter}[{place}]: expected finite numbers, got nan"
    ):
        return bool(np.isnan(value).any())
    pattern = rf"ShapeError: {parameter}: expected shape (\(.*\)), got (\(.*\))"
    shape = re.fullmatch(pattern, said)
    return shape is not None and shape[2] == str(np.shape(value)) != shape[1]


@pytest.mark.slow
def test_nothing_but_our_own_errors_is_raised() -> None:
    assert len(answers()) > 2000
    assert [line for line, *_, said in answers() if said.startswith("raises")] == []


def test_what_has_no_meaning_is_refused() -> None:
    for line, _, value, said in answers():
        if line.startswith(NOT_MEASURED):
            continue
        if isinstance(value, str) or np.isnan(value).any():
            assert said != "accepted", line


def test_each_refusal_says_what_it_said() -> None:
    others: dict[str, None] = {}
    for line, parameter, value, said in answers():
        if said != "accepted" and not follows_the_rule(parameter, value, said):
            others[f"{line}: {said}"] = None
    found = "\n".join(others) + "\n"
    if os.environ.get("ALPHA5_UPDATE_PRINTED"):
        KEPT.write_text(found, encoding="utf-8")
    assert found == KEPT.read_text(encoding="utf-8")


@pytest.mark.parametrize("wrong", [np.zeros(0), np.zeros((0, 0)), np.zeros((0, 7)), []])
@pytest.mark.parametrize("name", ["v", "tau"])
def test_rows_of_another_width_are_refused_if_there_is_none(
    wrong: Any, name: str
) -> None:
    arm = a5.load()
    none = np.zeros((0, 4))
    states = {"q": none, "v": none, "tau": none}
    assert arm.forward_dynamics_batch(**states).shape == (0, 4)
    with pytest.raises(ShapeError, match=f"{name}: expected shape"):
        arm.forward_dynamics_batch(**{**states, name: wrong})
