"""A program as statements that compute one number at a time: C99, its vectors, JavaScript.

A language says how it writes what it does not write as C does; the rest is the same in all.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from alpha5_model.symbolic.program import Program, Slot

_OPERATORS = {
    "add": "{0} + {1}",
    "sub": "{0} - {1}",
    "mul": "{0} * {1}",
    "div": "{0} / {1}",
    "neg": "-{0}",
    "twice": "{0} + {0}",
    "sq": "{0} * {0}",
    "inv": "1 / {0}",
    "lt": "{0} < {1}",
    "le": "{0} <= {1}",
    "and": "{0} && {1}",
    "or": "{0} || {1}",
    "not": "!{0}",
    "if_else_zero": "{0} ? {1} : 0",
}
_TRUTHS = ("lt", "le", "and", "or", "not")


@dataclass(frozen=True)
class Language:
    """How a language writes.

    Attributes:
        number, truth: Statement that names a number or a truth value, of name and value.
        function: Name of one of C's functions.
        operators: Operations that it does not write as C does.
        nan: Not a number.
        suffix: Behind a constant.
    """

    number: str
    truth: str
    function: Callable[[str], str] = str
    operators: Mapping[str, str] = field(default_factory=dict)
    nan: str = "NAN"
    suffix: str = ""

    def constant(self, value: float) -> str:
        """A number."""
        if math.isnan(value):
            return self.nan
        text = repr(value) + self.suffix
        return f"({text})" if value < 0.0 else text

    def expression(self, op: str, given: Sequence[str]) -> str:
        """An operation on what is given."""
        operators = {**_OPERATORS, **self.operators}
        if op in operators:
            return operators[op].format(*given)
        return f"{self.function(op)}({', '.join(given)})"


_SHORT = {"fmin": "min", "fmax": "max", "fabs": "abs"}
DOUBLE = Language("const double {} = {};", "const int {} = {};")
FLOAT = Language("const float {} = {};", "const int {} = {};", "{}f".format, suffix="f")
JAVASCRIPT = Language(
    "const {} = {};", "const {} = {};", lambda f: f"Math.{_SHORT.get(f, f)}", nan="NaN"
)


def statements(
    program: Program, language: Language, element: Callable[[Slot, int], str]
) -> tuple[list[str], list[list[str]]]:
    """A program's statements, and what stands for the elements of each output.

    Everything that comes in is read first, so that what goes out may take its place.

    Args:
        program: What to compute.
        language: How to write it.
        element: Text of an element of an input.
    """
    names: dict[int, str] = {}
    read: list[str] = []
    computed: list[str] = []
    results = [[""] * slot.size for slot in program.outputs]
    for op, register, arguments, value in program.steps:
        name = f"r{register}"
        if op == "output":
            slot, index, source = arguments
            results[slot][index] = names[source]
            continue
        if op == "const":
            names[register] = language.constant(float(value or 0.0))
            continue
        names[register] = name
        if op == "input":
            slot, index = arguments
            read.append(language.number.format(name, element(program.inputs[slot], index)))
            continue
        text = language.expression(op, [names[argument] for argument in arguments])
        statement = language.truth if op in _TRUTHS else language.number
        computed.append(statement.format(name, text))
    return read + computed, results


def element(slot: Slot, index: int) -> str:
    """An element of an array, or the number itself."""
    return slot.name if slot.shape == (1,) else f"{slot.name}[{index}]"


def nested(elements: list[str], shape: tuple[int, ...]) -> str:
    """An array in brackets, row by row; a number alone."""
    if shape == (1,):
        return elements[0]
    if len(shape) > 1:
        width = len(elements) // shape[0]
        rows = (elements[i : i + width] for i in range(0, len(elements), width))
        elements = [nested(row, shape[1:]) for row in rows]
    return f"[{', '.join(elements)}]"
