"""Calls of functions and methods with drawn arguments, good or spoiled."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from fuzzing.cases import Case, Target
from fuzzing.good_values import GOOD, Draws, always
from fuzzing.values import TEXTS, Rng, pick, spoil

#: Draws a call; spoiled, some of its arguments may be of any sort.
Draw = Callable[[Rng, bool], Case]

#: Counts, names of axes, and what may be infinite or has no effect: a call with a bad
#: value of these may still have an answer.
LENIENT = {
    "limits",
    "samples",
    "number",
    "orientations",
    "threads",
    "starts",
    "steps",
    "start",
    "stop",
    "sigma",
    "lower",
    "upper",
    "bandwidth",
}
#: Parameters that stay at their default.
NOT_DRAWN = {
    "progress",
    "options",
    "kwargs",
    "seed",
    "fext",
    "reference_frame",
    "strips",
    "accept",
}
#: Parameters that are objects of the package; they are never spoiled.
OBJECTS = {"arm", "chain", "vehicle", "model"}
#: Parameters with one row for each state.
ROWS = {"q", "v", "a", "tau"}


def of(make: Callable[[Rng], Callable[..., Any]], /, **own: Draws) -> Draw:
    """Calls of what ``make`` gives.

    Args:
        make: Draws the function.
        own: Draws of arguments, by the names of its parameters; the others are drawn by
            `GOOD`.
    """

    def draw(rng: Rng, spoiled: bool) -> Case:
        call = make(rng)
        arguments: dict[str, Any] = {}
        hopeless = False
        for name, parameter in inspect.signature(call).parameters.items():
            optional = parameter.default is not parameter.empty
            if name in NOT_DRAWN or (optional and rng.integers(2)):
                continue
            draw_value = own.get(name) or GOOD.get(name, always(None))
            arguments[name] = draw_value(rng)
            if spoiled and name not in OBJECTS:
                arguments[name], bad = _perhaps_spoiled(rng, arguments[name])
                hopeless |= bad and name not in LENIENT
        return Case(call, arguments, hopeless)

    return draw


def _perhaps_spoiled(rng: Rng, value: Any) -> tuple[Any, bool]:
    """A value, spoiled one time in four; whether nothing but a refusal is right."""
    if rng.integers(4) == 0:
        return spoil(rng, value)
    if rng.integers(40) == 0:
        return pick(rng, TEXTS), False
    return value, False


def of_function(function: Callable[..., Any], /, **own: Draws) -> Draw:
    """Calls of a function."""
    return of(lambda rng: function, **own)


def of_method(make: Draws, method: str, /, **own: Draws) -> Draw:
    """Calls of a method of drawn objects."""
    return of(lambda rng: getattr(make(rng), method), **own)


def with_the_same_rows(draw: Draw) -> Draw:
    """The same number of rows in each argument, most of the time."""

    def drawn(rng: Rng, spoiled: bool) -> Case:
        case = draw(rng, spoiled)
        if rng.integers(8) == 0:
            return case
        rows = int(rng.integers(1, 5))
        for name in ROWS & {*case.arguments}:
            value = case.arguments[name]
            if isinstance(value, np.ndarray) and value.ndim == 2 and len(value):
                case.arguments[name] = value[np.arange(rows) % len(value)]
        return replace(case, hopeless=False)  # what was bad may be left out

    return drawn


def spoiling(draw: Draw) -> Target:
    """The target of a draw."""
    return lambda rng, folder: draw(rng, True)
