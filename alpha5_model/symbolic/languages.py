"""A program as statements of a language: C99 and its vectors, JavaScript, Python for arrays and for numbers.

A language says how it writes what it does not write as C does; the rest is the same in all.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from alpha5_model.symbolic.program import TRUTHS, Program, Slot

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
    "if_else": "{0} ? {1} : {2}",
    "if_else_zero": "{0} ? {1} : 0",
}


@dataclass(frozen=True)
class Language:
    """How a language writes.

    Attributes:
        number, truth: Statement that names a number or a truth value, of name and value.
        function: Name of one of C's functions.
        operators: Operations that it does not write as C does.
        nan: Not a number.
        suffix: Behind a constant.
        flag: A truth value that goes out.
        reuses: Names are given again, so that memory is; others are written once.
    """

    number: str
    truth: str
    function: Callable[[str], str] = str
    operators: Mapping[str, str] = field(default_factory=dict)
    nan: str = "NAN"
    suffix: str = ""
    flag: str = "{}"
    reuses: bool = False

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


DOUBLE = Language("const double {} = {};", "const int {} = {};")
FLOAT = Language("const float {} = {};", "const int {} = {};", "{}f".format, suffix="f")
VECTOR = Language(
    "const V {} = {};",
    "const M {} = {};",
    str.upper,
    {
        "inv": "1.0 / {0}",
        "lt": "LESS(SPLAT({0}), SPLAT({1}))",
        "and": "{0} & {1}",
        "or": "{0} | {1}",
        "not": "NOT({0})",
        "if_else": "SELECT({0}, SPLAT({1}), SPLAT({2}))",
        "if_else_zero": "IF({0}, {1})",
    },
    flag="IF({}, 1.0)",
)
_SHORT = {"fmin": "min", "fmax": "max", "fabs": "abs"}
JAVASCRIPT = Language(
    "const {} = {};", "const {} = {};", lambda f: f"Math.{_SHORT.get(f, f)}", nan="NaN"
)
_LONG = {"atan": "arctan", "atan2": "arctan2"}
#: Of arrays; ``m`` is NumPy, or a library with its names.
ARRAYS = Language(
    "{} = {}",
    "{} = {}",
    lambda f: f"m.{_LONG.get(f, f)}",
    {
        "fabs": "abs({0})",  # NumPy's fabs takes four times as long
        "and": "{0} & {1}",
        "or": "{0} | {1}",
        "not": "m.logical_not({0})",
        "if_else": "m.where({0}, {1}, {2})",
        "if_else_zero": "m.where({0}, {1}, 0.0)",
    },
    "m.nan",
    reuses=True,
)
#: Of Python's numbers; ``m`` is its math.
NUMBERS = Language(
    "{} = {}",
    "{} = {}",
    "m.{}".format,
    {
        "fabs": "abs({0})",
        "fmin": "{0} if {0} < {1} else {1}",
        "fmax": "{1} if {0} < {1} else {0}",
        "and": "{0} and {1}",
        "or": "{0} or {1}",
        "not": "not {0}",
        "if_else": "{1} if {0} else {2}",
        "if_else_zero": "{1} if {0} else 0.0",
    },
    "m.nan",
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
    steps = sorted(program.steps, key=lambda step: step.op != "input")
    last = {r: i for i, step in enumerate(steps) for r in step.read}
    last |= {r: len(steps) for step in steps if step.op == "output" for r in step.read}
    names: dict[int, str] = {}
    flags: set[int] = set()
    free: list[str] = []
    lines: list[str] = []
    results = [[""] * slot.size for slot in program.outputs]
    for i, step in enumerate(steps):
        op, register, arguments, value = step
        if op == "output":
            slot, index, source = arguments
            text = language.flag if source in flags else "{}"
            results[slot][index] = text.format(names[source])
            continue
        if op == "const":
            names[register] = language.constant(float(value or 0.0))
            continue
        if op == "input":
            text = element(program.inputs[arguments[0]], arguments[1])
        else:
            text = language.expression(op, [names[r] for r in arguments])
        done = (names[r] for r in {*step.read} if last[r] == i)
        free += [name for name in done if language.reuses and name.startswith("r")]
        names[register] = name = free.pop() if free else f"r{register}"
        flags |= {register} if op in TRUTHS else set()
        lines.append((language.truth if op in TRUTHS else language.number).format(name, text))
    return lines, results


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
