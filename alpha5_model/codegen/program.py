"""A CasADi function as a straight line of instructions, and these as statements of a language.

Each register is written once. Equal expressions are computed once, and the sine and cosine of one
angle stand next to each other, so that an emitter can make one call of the two.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from alpha5_model.errors import InputError, needing

with needing("making code of the equations", "pip install casadi"):
    import casadi

#: What goes in and comes out, and what computes it, by name; how languages write an operation.
WORDS = tomllib.loads(Path(__file__).with_name("words.toml").read_text("utf-8"))
_LANGUAGES = tomllib.loads(
    Path(__file__).with_name("languages.toml").read_text("utf-8")
)
_TABLES = {
    language: {**_LANGUAGES["double"], **own} for language, own in _LANGUAGES.items()
}
#: Operations that make truth values, 0 or 1; two ``if_else_zero`` become an ``if_else``, which CasADi has not.
TRUTHS = ("lt", "le", "and", "or", "not")
OPERATIONS = [
    name for name in _LANGUAGES["double"] if hasattr(casadi, f"OP_{name.upper()}")
]
_OTHERS = ("const", "input", "output", "assign")
_NAMES = {
    getattr(casadi, f"OP_{name.upper()}"): name for name in (*OPERATIONS, *_OTHERS)
}
_COMMUTATIVE = ("add", "mul")


@dataclass(frozen=True)
class Slot:
    """An input or output.

    Attributes:
        name: Of the input or output.
        size: Number of elements.
        text: Unit and meaning.
        shape: (n,) or (rows, columns), whose elements are numbered row by row.
    """

    name: str
    size: int
    text: str
    shape: tuple[int, ...]


class Step(NamedTuple):
    """One instruction.

    Attributes:
        op: CasADi's name in lower case.
        result: Register that is written, of no meaning for ``output``.
        arguments: Registers that are read; for ``input`` slot and element, for ``output`` slot, element
            and register.
        value: Of a ``const``, else None.
    """

    op: str
    result: int
    arguments: tuple[int, ...]
    value: float | None = None

    @property
    def read(self) -> tuple[int, ...]:
        """The registers that it reads."""
        return {"input": (), "output": self.arguments[2:]}.get(self.op, self.arguments)


@dataclass(frozen=True)
class Program:
    """A function in static-single-assignment form: each register is written once."""

    name: str
    inputs: tuple[Slot, ...]
    outputs: tuple[Slot, ...]
    steps: tuple[Step, ...]

    def documentation(self, summary: str) -> str:
        """What it is, then name, shape, meaning and unit of all that goes in and comes out."""
        lines = [summary]
        for title, slots in (("Inputs", self.inputs), ("Outputs", self.outputs)):
            lines += ["", f"{title}:"]
            for slot in slots:
                shape = (
                    ""
                    if slot.shape == (1,)
                    else f" ({', '.join(map(str, slot.shape))})"
                )
                lines.append(f"    {slot.name}{shape}: {slot.text}")
        return "\n".join(lines)

    @property
    def flops(self) -> int:
        """Number of operations: all but constants, inputs and outputs."""
        return sum(step.op not in _OTHERS for step in self.steps)


def program(function: casadi.Function) -> Program:
    """The instructions of an SX function.

    Args:
        function: CasADi Function of SX kind with named inputs and outputs, all dense.

    Raises:
        InputError: A sparse input or output, or an instruction that emitters do not know.
    """
    inputs = tuple(
        _slot(name, function.sparsity_in(name)) for name in function.name_in()
    )
    outputs = tuple(
        _slot(name, function.sparsity_out(name)) for name in function.name_out()
    )
    steps: dict[tuple[object, ...], Step] = {}
    arguments: tuple[int, ...]
    register: dict[
        int, int
    ] = {}  # CasADi's work elements, which it writes again and again
    for i in range(function.n_instructions()):
        op = _NAMES.get(function.instruction_id(i))
        if op is None:
            name, known = (
                f"instruction {i} of {function.name()}",
                ", ".join(_NAMES.values()),
            )
            raise InputError(name, function.instruction_id(i), f"one of {known}")
        read, written = function.instruction_input(i), function.instruction_output(i)
        value = None
        if op == "const":
            arguments, value = (), float(function.instruction_constant(i))
        elif op == "input":
            arguments = read[0], _by_rows(inputs[read[0]].shape, read[1])
        elif op == "output":
            slot, element = written
            arguments = slot, _by_rows(outputs[slot].shape, element), register[read[0]]
        else:
            arguments = tuple(register[element] for element in read)
        if op == "assign":
            register[written[0]] = arguments[0]
            continue
        same = tuple(sorted(arguments)) if op in _COMMUTATIVE else arguments
        step = steps.setdefault(
            (op, same, str(value)), Step(op, len(steps), arguments, value)
        )
        if op != "output":
            register[written[0]] = step.result
    return Program(
        function.name(), inputs, outputs, _paired(_selecting([*steps.values()]))
    )


def _selecting(steps: list[Step]) -> list[Step]:
    """One step for ``(c ? x : 0) + (!c ? y : 0)``, and without what is then read no more."""
    for i, step in enumerate(steps):
        parts = [steps[r] for r in step.arguments] if step.op == "add" else []
        if [part.op for part in parts] == ["if_else_zero"] * 2:
            for yes, no in (parts, parts[::-1]):
                opposite = steps[no.arguments[0]]
                if opposite.op == "not" and opposite.arguments == yes.arguments[:1]:
                    steps[i] = Step("if_else", i, (*yes.arguments, no.arguments[1]))
    used = {i for i, step in enumerate(steps) if step.op == "output"}
    for step in reversed(steps):
        used |= {*step.read} if step.result in used else set()
    return [step for i, step in enumerate(steps) if i in used]


def _paired(steps: Iterable[Step]) -> tuple[Step, ...]:
    """Each sine and the cosine of the same register, whichever comes first, one after the other."""
    angles: dict[tuple[int, ...], list[Step]] = {}
    out: list[list[Step]] = []
    for step in steps:
        group = (
            angles.setdefault(step.arguments, []) if step.op in ("sin", "cos") else []
        )
        if not group:
            out.append(group)
        group.append(step)
    return tuple(step for group in out for step in group)


def _slot(name: str, sparsity: casadi.Sparsity) -> Slot:
    rows, columns = sparsity.shape
    if not sparsity.is_dense():
        raise InputError(
            name, f"{sparsity.nnz()} of {rows * columns} elements", "a dense matrix"
        )
    shape = (rows,) if columns == 1 else (rows, columns)
    return Slot(name, rows * columns, WORDS["quantities"].get(name, ""), shape)


def _by_rows(shape: tuple[int, ...], element: int) -> int:
    """CasADi numbers elements column by column."""
    column, row = divmod(element, shape[0])
    return row * shape[-1] + column if len(shape) == 2 else element


def named(
    name: str, inputs: dict[str, casadi.SX], out: dict[str, casadi.SX]
) -> casadi.Function:
    """A function of those inputs that the outputs, made dense, depend on."""
    dense = [casadi.densify(x) for x in out.values()]
    used = {str(x) for x in casadi.symvar(casadi.veccat(*dense))}
    given = {k: x for k, x in inputs.items() if used & {*map(str, casadi.symvar(x))}}
    return casadi.Function(name, [*given.values()], dense, [*given], [*out])


def folded(function: casadi.Function, **values: Any) -> casadi.Function:
    """The same function with numbers in place of some inputs: fewer operations."""
    names = function.name_in()
    free = {
        k: casadi.SX.sym(k, function.sparsity_in(k)) for k in names if k not in values
    }
    given = [free[k] if k in free else casadi.DM(values[k]) for k in names]
    outputs = [casadi.densify(out) for out in function.call(given)]
    return casadi.Function(
        function.name(), [*free.values()], outputs, [*free], function.name_out()
    )


def constant(value: float, language: str) -> str:
    """A number."""
    table = _TABLES[language]
    text = table["nan"] if math.isnan(value) else table["constant"].format(repr(value))
    return f"({text})" if value < 0.0 else text


def statements(
    program: Program,
    language: str,
    element: Callable[[Slot, int], str],
    reuse: bool = False,
) -> tuple[list[str], list[list[str]]]:
    """A program's statements, and what stands for the elements of each output.

    Everything that comes in is read first, so that what goes out may take its place. A language that has a
    statement ``store`` reads and hands out each element where it is computed with: less is held at a time.

    Args:
        program: What to compute.
        language: How to write it.
        element: Text of an element of an input.
        reuse: Give names again, so that memory is.
    """
    table, names, flags = _TABLES[language], dict[int, str](), set[int]()
    store = table.get("store")
    steps = sorted(program.steps, key=lambda step: not store and step.op != "input")
    last = {r: i for i, step in enumerate(steps) for r in step.read}
    last |= {r: len(steps) for step in steps if step.op == "output" for r in step.read}
    free, lines = list[str](), list[str]()
    results = [[""] * slot.size for slot in program.outputs]
    for i, (op, register, arguments, value) in enumerate(steps):
        if op == "output":
            slot, index, source = arguments
            text = table["flag"] if source in flags else "{}"
            results[slot][index] = text = text.format(names[source])
            place = sum(before.size for before in program.outputs[:slot]) + index
            lines += [store.format(place, text)] if store else []
        elif op == "const":
            names[register] = constant(float(value or 0.0), language)
        else:
            if op == "input":
                text = element(program.inputs[arguments[0]], arguments[1])
            else:
                text = table[op].format(*(names[r] for r in arguments))
            done = (names[r] for r in {*steps[i].read} if reuse and last[r] == i)
            free += [name for name in done if name.startswith("r")]
            names[register] = name = free.pop() if free else f"r{register}"
            flags |= {register} if op in TRUTHS else set()
            lines.append(
                table["truth" if op in TRUTHS else "number"].format(name, text)
            )
    return lines, results


def element(slot: Slot, index: int) -> str:
    """An element of an array, or the number itself."""
    return slot.name if slot.shape == (1,) else f"{slot.name}[{index}]"
