"""Header and source of the C library."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from string import Template
from typing import Any

import numpy as np

from alpha5_model.base_parameters import BASE_PARAMETERS
from alpha5_model.checks import FloatArray
from alpha5_model.description.bodies import provenance
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.kernels import arm_parameters
from alpha5_model.kinematics import plane
from alpha5_model.kinematics.ik import BRANCHES
from alpha5_model.parameters import parameters
from alpha5_model.symbolic import SUMMARIES, products
from alpha5_model.symbolic.languages import DOUBLE, FLOAT, Language, element, statements
from alpha5_model.symbolic.program import Program, Slot, folded, program

_FLAGS = ("exists", "within_limits", "singular")
_MEMBERS = [name.replace(".", "_") for name in BASE_PARAMETERS]


def programs(arm: Arm, real: str, struct: bool) -> list[Program]:
    """The functions of the library, of an arm's parameters or of those in a struct."""
    known: dict[str, Any] = {"tolerances": plane.SINGLE if real == "float" else plane.DOUBLE}
    if not struct:
        known["parameters"] = arm_parameters(arm)
    return [
        program(folded(function, **{n: known[n] for n in function.name_in() if n in known}))
        for name, function in products().items()
        if struct or name != "with_payload"
    ]


def header(arm: Arm, made: Sequence[Program], real: str, corrections: Iterable[str]) -> str:
    """``alpha5.h``."""
    declared = []
    for one in made:
        comment = one.documentation(SUMMARIES[one.name]).replace("\n", "\n * ")
        declared.append(f"\n/* {comment}\n */\n{_prototype(one)};\n".replace(" \n", "\n"))
    units = zip(_MEMBERS, BASE_PARAMETERS.values(), strict=True)
    members = "\n".join(f"    alpha5_real {name}; /* {unit} */" for name, unit in units)
    return template(
        "alpha5.h",
        **provenance(parameters(corrections)),
        fluid_density=f"{arm.fluid_density:g}",
        gravity=", ".join(f"{x:g}" for x in arm.model.gravity.linear),
        real=real,
        branches=",\n".join(f"    ALPHA5_{name.upper()}" for name in BRANCHES),
        parameters=template("parameters.h", members=members) if has_struct(made) else "",
        functions="".join(declared),
    )


def source(arm: Arm, made: Sequence[Program], real: str) -> str:
    """``alpha5.c``."""
    limits = np.array(plane.arm_plane().limits)
    parts = [
        '#include "alpha5.h"\n\n#include <math.h>\n',
        f"const alpha5_real alpha5_lower[4] = {numbers(limits[:, 0], real)};",
        f"const alpha5_real alpha5_upper[4] = {numbers(limits[:, 1], real)};",
    ]
    if has_struct(made):
        values = numbers(arm_parameters(arm), real)
        parts.append(f"const alpha5_parameters alpha5_default_parameters = {values};")
    return "\n".join([*parts, *(_definition(one, real) for one in made), ""])


def has_struct(made: Iterable[Program]) -> bool:
    """Whether some function takes the parameters."""
    return any(slot.name == "parameters" for one in made for slot in one.inputs)


def numbers(values: FloatArray, real: str) -> str:
    """An array, or a struct, in braces."""
    language = FLOAT if real == "float" else DOUBLE
    parts = (numbers(x, real) if np.ndim(x) else language.constant(float(x)) for x in values)
    return f"{{{', '.join(parts)}}}"


def template(name: str, **values: Any) -> str:
    """A file in ``templates/``, with values in place of its ``$names`` if there are any."""
    text = (Path(__file__).with_name("templates") / name).read_text(encoding="utf-8")
    return Template(text).substitute(values) if values else text


def _prototype(one: Program) -> str:
    inputs = sorted(one.inputs, key=lambda slot: slot.name != "parameters")
    arguments = [_argument(slot, "const ") for slot in inputs]
    arguments += [_argument(slot) for slot in one.outputs]
    return f"void alpha5_{one.name}({', '.join(arguments)})"


def _argument(slot: Slot, const: str = "") -> str:
    if slot.name.startswith("parameters"):
        return f"{const}alpha5_parameters *{slot.name}"
    kind = "int" if slot.name in _FLAGS else "alpha5_real"
    if slot.shape == (1,):
        return f"{kind} {slot.name}" if const else f"{kind} *{slot.name}"
    # A pointer to a matrix without const is no pointer to one with const in C.
    shape = (slot.size,) if const else slot.shape
    return f"{const}{kind} {slot.name}{''.join(f'[{n}]' for n in shape)}"


def _element(slot: Slot, index: int) -> str:
    if slot.name.startswith("parameters"):
        return f"{slot.name}->{_MEMBERS[index]}"
    return element(slot, index)


def _place(slot: Slot, index: int) -> str:
    if slot.shape == (1,):
        return f"*{slot.name}"
    if len(slot.shape) == 1:
        return _element(slot, index)
    row, column = divmod(index, slot.shape[1])
    return f"{slot.name}[{row}][{column}]"


def _definition(one: Program, real: str) -> str:
    language: Language = FLOAT if real == "float" else DOUBLE
    lines, results = statements(one, language, _element)
    read = {step.arguments[0] for step in one.steps if step.op == "input"}
    lines += [f"(void){s.name};" for i, s in enumerate(one.inputs) if i not in read]
    for slot, values in zip(one.outputs, results, strict=True):
        lines += [f"{_place(slot, i)} = {value};" for i, value in enumerate(values)]
    return f"\n{_prototype(one)}\n{{\n" + "".join(f"    {line}\n" for line in lines) + "}"
