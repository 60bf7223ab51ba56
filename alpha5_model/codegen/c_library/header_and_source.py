"""The functions of the C library: header and source."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from alpha5_model.codegen.arm_functions import SUMMARIES, products
from alpha5_model.codegen.c_library.options import COptions
from alpha5_model.codegen.c_library.text import numbers, template
from alpha5_model.codegen.casadi_functions import folded
from alpha5_model.codegen.dialects import element, statements
from alpha5_model.codegen.instructions import Program, Slot, program
from alpha5_model.codegen.regrouping import BASE_PARAMETERS
from alpha5_model.description.xml import provenance
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.kernel_numbers import arm_parameters
from alpha5_model.kinematics.ik import BRANCHES
from alpha5_model.kinematics.tolerances import DOUBLE, SINGLE

#: Outputs that are truth values.
_FLAGS = ("exists", "within_limits", "singular")
#: Names of the base parameters in a struct.
_MEMBERS = [name.replace(".", "_") for name in BASE_PARAMETERS]


def programs(arm: Arm, options: COptions) -> list[Program]:
    """The functions of the library.

    They contain the arm's base parameters, or take them as a struct.
    """
    tolerances = SINGLE if options.real == "float" else DOUBLE
    known: dict[str, Any] = {}
    if not options.struct:
        known["parameters"] = arm_parameters(arm)

    made = []
    for name, function in products(arm.parameters, tolerances).items():
        if name == "with_payload" and not options.struct:
            continue
        given = {key: known[key] for key in function.name_in() if key in known}
        made.append(program(folded(function, **given)))
    return made


def header(arm: Arm, made: Iterable[Program], options: COptions) -> str:
    """``alpha5.h``."""
    functions = "".join(_declaration(one) for one in made)
    branches = [f"    ALPHA5_{name.upper()}" for name in BRANCHES]
    return template(
        "alpha5.h",
        **provenance(arm.parameters),
        real=options.real,
        fluid_density=f"{arm.fluid_density:g}",
        gravity=", ".join(f"{x:g}" for x in arm.model.gravity.linear),
        branches=",\n".join(branches),
        parameters=_struct() if options.struct else "",
        functions=functions,
    )


def _struct() -> str:
    """The struct of base parameters."""
    units = zip(_MEMBERS, BASE_PARAMETERS.values(), strict=True)
    members = [f"    alpha5_real {name}; /* {unit} */" for name, unit in units]
    return template("parameters.h", members="\n".join(members))


def _declaration(function: Program) -> str:
    """A prototype below its documentation."""
    comment = function.documentation(SUMMARIES[function.name]).replace("\n", "\n * ")
    text = f"\n/* {comment}\n */\n{_prototype(function)};\n"
    return text.replace(" \n", "\n")


def source(arm: Arm, made: Iterable[Program], options: COptions) -> str:
    """``alpha5.c``."""
    real = options.real
    joints = arm.parameters.joints[:4]
    lower = numbers([joint.lower for joint in joints], real)
    upper = numbers([joint.upper for joint in joints], real)
    parts = [
        '#include "alpha5.h"\n\n#include <math.h>\n\n',
        f"const alpha5_real alpha5_lower[4] = {lower};\n",
        f"const alpha5_real alpha5_upper[4] = {upper};\n",
    ]
    if options.struct:
        values = numbers(arm_parameters(arm), real)
        parts.append(f"const alpha5_parameters alpha5_default_parameters = {values};\n")
    parts += [_definition(one, real) for one in made]
    return "".join(parts)


def _definition(function: Program, real: str) -> str:
    lines, results = statements(function, real, _element)
    lines += _unread(function)
    for slot, elements in zip(function.outputs, results, strict=True):
        for index, text in enumerate(elements):
            lines.append(f"{_place(slot, index)} = {text};")

    body = "".join(f"    {line}\n" for line in lines)
    return f"\n{_prototype(function)}\n{{\n{body}}}\n"


def _unread(function: Program) -> list[str]:
    """Statements against a compiler's warnings of unused arguments."""
    read = {step.arguments[0] for step in function.steps if step.op == "input"}
    return [
        f"(void){slot.name};" for i, slot in enumerate(function.inputs) if i not in read
    ]


def _prototype(function: Program) -> str:
    parameters_first = sorted(
        function.inputs, key=lambda slot: slot.name != "parameters"
    )
    arguments = [_input(slot) for slot in parameters_first]
    arguments += [_output(slot) for slot in function.outputs]
    return f"void alpha5_{function.name}({', '.join(arguments)})"


def _input(slot: Slot) -> str:
    """An argument that is read."""
    if slot.name.startswith("parameters"):
        return f"const alpha5_parameters *{slot.name}"
    kind = _type(slot)
    if slot.shape == (1,):
        return f"{kind} {slot.name}"
    # Flat: in C, a pointer to a matrix without const is no pointer to one with const.
    return f"const {kind} {slot.name}{_brackets([slot.size])}"


def _output(slot: Slot) -> str:
    """An argument that is written."""
    if slot.name.startswith("parameters"):
        return f"alpha5_parameters *{slot.name}"
    kind = _type(slot)
    if slot.shape == (1,):
        return f"{kind} *{slot.name}"
    return f"{kind} {slot.name}{_brackets(slot.shape)}"


def _type(slot: Slot) -> str:
    return "int" if slot.name in _FLAGS else "alpha5_real"


def _brackets(numbers: Iterable[Any]) -> str:
    return "".join(f"[{number}]" for number in numbers)


def _element(slot: Slot, index: int) -> str:
    """An element of an argument."""
    if slot.name.startswith("parameters"):
        return f"{slot.name}->{_MEMBERS[index]}"
    return element(slot, index)


def _place(slot: Slot, index: int) -> str:
    """Where an element of an output is written."""
    if len(slot.shape) == 2:
        place: Sequence[Any] = np.unravel_index(index, slot.shape)
        return f"{slot.name}{_brackets(place)}"
    if slot.shape == (1,):
        return f"*{_element(slot, index)}"
    return _element(slot, index)
