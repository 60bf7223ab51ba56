"""A CasADi function as a straight line of instructions.

Each register is written once. Equal expressions are computed once. The sine and the
cosine of one angle stand next to each other, so that one call can compute both.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from alpha5_model.codegen.words import DIALECTS, WORDS
from alpha5_model.errors import InputError, needing

with needing("making code of the equations", "pip install 'alpha5-model[symbolic]'"):
    import casadi

#: Operations that make truth values, 0 or 1.
TRUTHS = ("lt", "le", "and", "or", "not")
#: CasADi's operations that dialects can write.
OPERATIONS = [
    name for name in DIALECTS["double"] if hasattr(casadi, f"OP_{name.upper()}")
]
_COMMUTATIVE = ("add", "mul")
#: Instructions that compute nothing.
_OTHERS = ("const", "input", "output", "assign")
#: CasADi's number of an instruction -> its name.
_NAMES = {
    getattr(casadi, f"OP_{name.upper()}"): name for name in (*OPERATIONS, *_OTHERS)
}


@dataclass(frozen=True)
class Slot:
    """An input or output.

    Attributes:
        name: Of the input or output.
        size: Number of elements.
        text: Unit and meaning.
        shape: (n,) or (rows, columns); elements are numbered row by row.
    """

    name: str
    size: int
    text: str
    shape: tuple[int, ...]


class Step(NamedTuple):
    """One instruction.

    Attributes:
        op: CasADi's name in lower case, or ``if_else``, which CasADi does not have.
        result: Register that is written; no meaning for ``output``.
        arguments: Registers that are read. For ``input``, slot and element; for
            ``output``, slot, element and register.
        value: Of a ``const``, else None.
    """

    op: str
    result: int
    arguments: tuple[int, ...]
    value: float | None = None

    @property
    def read(self) -> tuple[int, ...]:
        """The registers that it reads."""
        if self.op == "input":
            return ()
        if self.op == "output":
            return self.arguments[2:]
        return self.arguments


@dataclass(frozen=True, eq=False)
class Program:
    """A function in static-single-assignment form: each register is written once."""

    name: str
    inputs: tuple[Slot, ...]
    outputs: tuple[Slot, ...]
    steps: tuple[Step, ...]

    def documentation(self, summary: str) -> str:
        """A summary, then name, shape, meaning and unit of each input and output."""
        lines = [summary]
        for title, slots in (("Inputs", self.inputs), ("Outputs", self.outputs)):
            lines += ["", f"{title}:"]
            for slot in slots:
                lengths = ", ".join(map(str, slot.shape))
                shape = "" if slot.shape == (1,) else f" ({lengths})"
                lines.append(f"    {slot.name}{shape}: {slot.text}")
        return "\n".join(lines)


def program(function: casadi.Function) -> Program:
    """The instructions of an SX function.

    Args:
        function: CasADi Function of SX kind with named inputs and outputs, all dense.

    Raises:
        InputError: A sparse input or output, or an instruction that no language has.
    """
    inputs = tuple(
        _slot(name, function.sparsity_in(name)) for name in function.name_in()
    )
    outputs = tuple(
        _slot(name, function.sparsity_out(name)) for name in function.name_out()
    )
    steps = _steps(function, inputs, outputs)
    return Program(
        name=function.name(),
        inputs=inputs,
        outputs=outputs,
        steps=_paired(_used(_selecting(steps))),
    )


def _slot(name: str, sparsity: casadi.Sparsity) -> Slot:
    rows, columns = sparsity.shape
    size = rows * columns
    if not sparsity.is_dense():
        raise InputError(name, f"{sparsity.nnz()} of {size} elements", "a dense matrix")
    return Slot(
        name=name,
        size=size,
        text=WORDS["quantities"].get(name, ""),
        shape=(rows,) if columns == 1 else (rows, columns),
    )


def _steps(
    function: casadi.Function, inputs: Sequence[Slot], outputs: Sequence[Slot]
) -> list[Step]:
    """The instructions of a function, equal ones once."""
    steps: dict[tuple[object, ...], Step] = {}
    # CasADi writes its work elements again and again; each has a register for a while.
    registers: dict[int, int] = {}
    for i in range(function.n_instructions()):
        op = _operation(function, i)
        read = function.instruction_input(i)
        written = function.instruction_output(i)
        if op == "assign":
            registers[written[0]] = registers[read[0]]
            continue

        value = None
        if op == "const":
            value = float(function.instruction_constant(i))
        if op == "input":
            arguments = _in_slot(inputs, *read)
        elif op == "output":
            arguments = (*_in_slot(outputs, *written), registers[read[0]])
        else:
            arguments = tuple(registers[element] for element in read)

        new = Step(op=op, result=len(steps), arguments=arguments, value=value)
        step = steps.setdefault(_what_it_computes(new), new)
        if op != "output":
            registers[written[0]] = step.result
    return [*steps.values()]


def _operation(function: casadi.Function, i: int) -> str:
    """Name of an instruction."""
    number = function.instruction_id(i)
    if number not in _NAMES:
        known = ", ".join(_NAMES.values())
        place = f"instruction {i} of {function.name()}"
        raise InputError(place, number, f"one of {known}")
    return _NAMES[number]


def _in_slot(slots: Sequence[Slot], slot: int, element: int) -> tuple[int, ...]:
    """A slot, and the number row by row of an element; CasADi numbers by columns."""
    shape = slots[slot].shape
    if len(shape) == 1:
        return slot, element
    rows, columns = shape
    column, row = divmod(element, rows)
    return slot, row * columns + column


def _what_it_computes(step: Step) -> tuple[object, ...]:
    """The same for two steps whose results are equal."""
    arguments = step.arguments
    if step.op in _COMMUTATIVE:
        arguments = tuple(sorted(arguments))
    return step.op, arguments, str(step.value)


def _selecting(steps: Sequence[Step]) -> list[Step]:
    """One ``if_else`` for each ``(c ? x : 0) + (!c ? y : 0)``."""
    return [_selection(step, steps) or step for step in steps]


def _selection(step: Step, steps: Sequence[Step]) -> Step | None:
    """The ``if_else`` that a step stands for; None if it stands for none."""
    if step.op != "add":
        return None
    one, other = (steps[register] for register in step.arguments)
    if one.op != "if_else_zero" or other.op != "if_else_zero":
        return None

    for yes, no in ((one, other), (other, one)):
        condition, if_true = yes.arguments
        opposite, if_false = no.arguments
        negation = steps[opposite]
        if negation.op == "not" and negation.arguments == (condition,):
            return Step(
                op="if_else",
                result=step.result,
                arguments=(condition, if_true, if_false),
            )
    return None


def _used(steps: Sequence[Step]) -> list[Step]:
    """The steps that an output depends on."""
    used = {step.result for step in steps if step.op == "output"}
    for step in reversed(steps):
        if step.result in used:
            used |= {*step.read}
    return [step for step in steps if step.result in used]


def _paired(steps: Iterable[Step]) -> tuple[Step, ...]:
    """The steps with each sine next to the cosine of the same register."""
    angles: dict[tuple[int, ...], list[Step]] = {}
    groups: list[list[Step]] = []
    for step in steps:
        group: list[Step] = []
        if step.op in ("sin", "cos"):
            group = angles.setdefault(step.arguments, group)
        if not group:
            groups.append(group)
        group.append(step)
    return tuple(step for group in groups for step in group)
