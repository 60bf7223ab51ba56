"""The instructions of a program as statements of a dialect.

A dialect is a language with its type of numbers: C with ``double``, with ``float`` or
with vectors, JavaScript, Python with arrays. `dialects.toml` has the words of each
dialect. The text around the statements is in the modules that write the
files, such as `alpha5_model.codegen.python_code`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from alpha5_model.codegen.instructions import TRUTHS, Program, Slot, Step
from alpha5_model.codegen.words import DIALECTS


def constant(value: float, dialect: str) -> str:
    """A number."""
    table = DIALECTS[dialect]
    if math.isnan(value):
        return table["nan"]
    text = table["constant"].format(repr(value))
    return f"({text})" if value < 0.0 else text


def element(slot: Slot, index: int) -> str:
    """An element of an array, or the number itself."""
    return slot.name if slot.shape == (1,) else f"{slot.name}[{index}]"


def statements(
    program: Program,
    dialect: str,
    input_element: Callable[[Slot, int], str],
    reuse: bool = False,
) -> tuple[list[str], list[list[str]]]:
    """A program's statements, and the text of each element of each output.

    All inputs are read first, so that outputs may overwrite them.

    Args:
        program: What to compute.
        dialect: Name of the dialect.
        input_element: Text of an element of an input.
        reuse: Use the names of registers again, and so their memory.
    """
    steps = tuple(sorted(program.steps, key=lambda step: step.op != "input"))
    writer = _Writer(program, dialect, input_element, reuse)
    last_uses = _last_uses(steps)
    for i, step in enumerate(steps):
        done = [register for register in {*step.read} if last_uses[register] == i]
        writer.write(step, done)
    return writer.lines, writer.results


def _last_uses(steps: tuple[Step, ...]) -> dict[int, int]:
    """Register -> place of the last step that reads it; outputs are kept to the end."""
    last_uses = {}
    for i, step in enumerate(steps):
        for register in step.read:
            last_uses[register] = i
    for step in steps:
        if step.op == "output":
            for register in step.read:
                last_uses[register] = len(steps)
    return last_uses


class _Writer:
    """Writes the steps of a program one after the other.

    Attributes:
        lines: The statements so far.
        results: Text of each element of each output.
    """

    def __init__(
        self,
        program: Program,
        dialect: str,
        input_element: Callable[[Slot, int], str],
        reuse: bool,
    ) -> None:
        self.lines: list[str] = []
        self.results = [[""] * slot.size for slot in program.outputs]
        self._program = program
        self._dialect = dialect
        self._table = DIALECTS[dialect]
        self._input_element = input_element
        self._reuse = reuse
        self._names: dict[int, str] = {}
        self._truth_registers: set[int] = set()
        self._free_names: list[str] = []

    def write(self, step: Step, done: Sequence[int]) -> None:
        """Write a step.

        Args:
            step: The step.
            done: Registers that no later step reads.
        """
        if step.op == "output":
            self._write_output(step)
        elif step.op == "const":
            value = float(step.value or 0.0)
            self._names[step.result] = constant(value, self._dialect)
        else:
            self._compute(step, done)

    def _write_output(self, step: Step) -> None:
        slot, index, register = step.arguments
        text = self._names[register]
        if register in self._truth_registers:
            text = self._table["flag"].format(text)
        self.results[slot][index] = text

    def _compute(self, step: Step, done: Sequence[int]) -> None:
        text = self._expression(step)
        name = self._name_for(step.result, done)
        form = "number"
        if step.op in TRUTHS:
            form = "truth"
            self._truth_registers.add(step.result)
        self.lines.append(self._table[form].format(name, text))

    def _expression(self, step: Step) -> str:
        if step.op == "input":
            slot, index = step.arguments
            return self._input_element(self._program.inputs[slot], index)
        arguments = [self._names[register] for register in step.arguments]
        return self._table[step.op].format(*arguments)

    def _name_for(self, register: int, done: Sequence[int]) -> str:
        """A name for a register: one that is free, or a new one."""
        if self._reuse:
            names = (self._names[one] for one in done)
            # A name that does not start with r is a constant.
            self._free_names += [name for name in names if name.startswith("r")]
        name = self._free_names.pop() if self._free_names else f"r{register}"
        self._names[register] = name
        return name
