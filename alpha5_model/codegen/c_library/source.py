"""Texts of the C library: header, source, and a program that tests them with what Pinocchio answers.

Options are those of `alpha5_model.codegen.c_library.files.COptions`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from string import Template
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.codegen import program as symbolic
from alpha5_model.codegen.base_parameters import BASE_PARAMETERS
from alpha5_model.codegen.functions import SUMMARIES, products
from alpha5_model.codegen.program import Program, Slot
from alpha5_model.description.bodies import provenance
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.batch import arm_parameters
from alpha5_model.kinematics import plane, workspace
from alpha5_model.kinematics.ik import BRANCHES, inverse_kinematics
from alpha5_model.numbers.parameters import parameters

_FLAGS = ("exists", "within_limits", "singular")
_MEMBERS = [name.replace(".", "_") for name in BASE_PARAMETERS]
_DEFAULT = "&alpha5_default_parameters"
#: States that are tested.
_STATES = 20
#: Of equal functions in C: differences allowed, as a share; those that divide by M lose digits to its condition.
_BOUNDS = {"double": (1e-12, 1e-9), "float": (2e-5, 2e-3)}
#: Of the tcp on the yaw axis, onto which it is put, and elsewhere [m]; of a joint [rad].
_MISSES = {"double": (2e-9, 1e-12, 1e-9), "float": (5e-6, 2e-6, 1e-3)}


def programs(arm: Arm, options: Any) -> list[Program]:
    """The functions of the library, of an arm's parameters or of those in a struct."""
    tolerances = {"double": plane.DOUBLE, "float": plane.SINGLE}[options.real]
    known: dict[str, Any] = {"tolerances": tolerances}
    if not options.struct:
        known["parameters"] = arm_parameters(arm)
    return [
        symbolic.program(
            symbolic.folded(f, **{n: known[n] for n in f.name_in() if n in known})
        )
        for name, f in products(parameters()).items()
        if options.struct or name != "with_payload"
    ]


def header(arm: Arm, made: Iterable[Program], options: Any) -> str:
    """``alpha5.h``."""
    declared = ""
    for one in made:
        comment = one.documentation(SUMMARIES[one.name]).replace("\n", "\n * ")
        declared += f"\n/* {comment}\n */\n{_prototype(one)};\n".replace(" \n", "\n")
    units = zip(_MEMBERS, BASE_PARAMETERS.values(), strict=True)
    members = "\n".join(f"    alpha5_real {name}; /* {unit} */" for name, unit in units)
    values = provenance(parameters(options.corrections)) | {"real": options.real}
    values["fluid_density"] = f"{arm.fluid_density:g}"
    values["gravity"] = ", ".join(f"{x:g}" for x in arm.model.gravity.linear)
    values["branches"] = ",\n".join(f"    ALPHA5_{name.upper()}" for name in BRANCHES)
    values["parameters"] = (
        template("parameters.h", members=members) if options.struct else ""
    )
    return template("alpha5.h", functions=declared, **values)


def source(arm: Arm, made: Iterable[Program], options: Any) -> str:
    """``alpha5.c``."""
    text, g, real = (
        '#include "alpha5.h"\n\n#include <math.h>\n\n',
        plane.arm_plane(),
        options.real,
    )
    for name, limits in (("lower", g.lower), ("upper", g.upper)):
        text += f"const alpha5_real alpha5_{name}[4] = {numbers(limits, real)};\n"
    if options.struct:
        values = numbers(arm_parameters(arm), real)
        text += f"const alpha5_parameters alpha5_default_parameters = {values};\n"
    for one in made:
        lines, results = symbolic.statements(one, real, _element)
        read = {step.arguments[0] for step in one.steps if step.op == "input"}
        lines += [f"(void){s.name};" for i, s in enumerate(one.inputs) if i not in read]
        for slot, elements in zip(one.outputs, results, strict=True):
            lines += [
                f"{_place(slot, i)} = {element};" for i, element in enumerate(elements)
            ]
        body = "".join(f"    {line}\n" for line in lines)
        text += f"\n{_prototype(one)}\n{{\n{body}}}\n"
    return text


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
    return symbolic.element(slot, index)


def _place(slot: Slot, index: int) -> str:
    if len(slot.shape) == 2:
        return slot.name + "".join(
            f"[{i}]" for i in np.unravel_index(index, slot.shape)
        )
    return "*" * (slot.shape == (1,)) + _element(slot, index)


def check_program(arm: Arm, made: Iterable[Program], options: Any) -> str:
    """``test_alpha5.c``: random states, a payload, and targets."""
    rng, g, real, tests = np.random.default_rng(5), plane.arm_plane(), options.real, {}
    kind = np.float32 if real == "float" else np.float64
    states = {
        name: rng.normal(scale=2.0, size=(_STATES, 4))
        for name in ("q", "v", "a", "tau")
    }
    states["q"] = rng.uniform(g.lower, g.upper, (_STATES, 4))
    states = {name: x.astype(kind).astype(np.float64) for name, x in states.items()}
    rows = [
        dict(zip(states, row, strict=True))
        for row in zip(*states.values(), strict=True)
    ]
    for one in made:
        names = [slot.name for slot in one.inputs if slot.name in states]
        if names:
            given = [_DEFAULT] * (len(names) < len(one.inputs)) + [
                f"{n}[row]" for n in names
            ]
            expected = [
                answer(arm, one.name, {n: row[n] for n in names}) for row in rows
            ]
            call = f"alpha5_{one.name}({', '.join(given)}"
            tests[one.name] = _test(one.name, call, expected, real)
    if options.struct:
        inertia = [[4e-4, 1e-5, -2e-5], [1e-5, 5e-4, 3e-5], [-2e-5, 3e-5, 6e-4]]
        body = 0.6, [0.01, -0.02, 0.05], inertia, 2.3e-4, [-0.01, 0.015, 0.04]
        loaded = arm.with_payload(*body)
        call = f"alpha5_parameters loaded; alpha5_with_payload({_DEFAULT}"
        for x in (*body, arm.fluid_density):
            text = numbers(np.ravel(x), real)
            call += (
                f", (const alpha5_real[]){text}" if np.ndim(x) else f", {text[1:-1]}"
            )
        call += ", &loaded); alpha5_inverse_dynamics(&loaded, q[row], v[row], a[row]"
        expected = [
            [loaded.inverse_dynamics(row["q"], row["v"], row["a"])] for row in rows
        ]
        tests["with_payload"] = _test("with_payload", call, expected, real)
    values: dict[str, Any] = {name: numbers(x, real) for name, x in states.items()}
    values |= zip(("edge", "miss", "turn"), _MISSES[real], strict=True)
    values |= {"count": _STATES, "targets": numbers(_targets(arm), real)}
    values["calls"] = "\n".join(f"    test_{name}();" for name in tests)
    return template("test_alpha5.c", tests="".join(tests.values()), **values)


def answer(arm: Arm, name: str, given: Mapping[str, FloatArray]) -> list[FloatArray]:
    """What Pinocchio says of one of `alpha5_model.codegen.functions.products`, output by output: poses (4, 4), forces (6,).

    Args:
        arm: Whose method of that name is asked.
        name: Of the function.
        given: Its inputs q, v, a, tau.
    """
    if name == "link_poses":
        result = tuple(
            arm.forward_kinematics(given["q"], f"link_{i}") for i in range(1, 5)
        )
    else:
        result = getattr(arm, name)(*given.values())
    parts = result if isinstance(result, tuple) else (result,)
    return [np.array(getattr(x, "homogeneous", getattr(x, "vector", x))) for x in parts]


def _test(
    name: str, call: str, expected: Sequence[Sequence[FloatArray]], real: str
) -> str:
    """A test of a call that lacks its outputs, in every state; each output is a share of its own largest number."""
    ends = np.cumsum([0, *(part.size for part in expected[0])]).tolist()
    bound, checks = _BOUNDS[real][name.startswith("forward_dynamics")], ""
    for at, end in pairwise(ends):
        where = f"out + {at}, expected_{name}[row] + {at}, {end - at}"
        checks += f'        compare("{name}", row, {where}, {bound});\n'
        call += f", (void *)(out + {at})"
    table = numbers(
        [np.concatenate([part.ravel() for part in row]) for row in expected], real
    )
    values = {
        "call": call,
        "checks": checks,
        "size": ends[-1],
        "count": _STATES,
        "table": table,
    }
    return template("test_function.c", function=name, **values)


def _targets(arm: Arm) -> list[list[Any]]:
    """Anywhere in the workspace, at joint limits, stretched, on the yaw axis, out of reach, wrist turned too far."""
    rng, g = np.random.default_rng(7), plane.arm_plane()
    q = rng.uniform(g.lower, g.upper, (40, 4))
    q[10:26, 1:] = np.where(rng.random((16, 3)) < 0.5, g.lower[1:], g.upper[1:])
    q[26:34, 2] = workspace.singular_elbow_angles()["stretched"]
    places = [(arm.forward_kinematics(row).translation, row[3], row) for row in q]
    places += [((0.0, 0.0, height), 1.0, ()) for height in (-0.1, 0.1, 0.3)]
    places += [(point, 6.25, ()) for point in rng.uniform(0.3, 0.6, (4, 3))]
    rows = []
    for position, wrist, known in places:
        s = inverse_kinematics(position, float(wrist))
        clear = len(known) and not s.singular
        flags = s.exists, s.within_limits, bool(s.singular), clear
        rows.append([position, wrist, *flags, known if len(known) else np.zeros(4)])
    return rows


def numbers(values: Any, real: str) -> str:
    """An array, or a struct, in braces."""
    if isinstance(values, list | tuple | np.ndarray):
        return f"{{{', '.join(numbers(x, real) for x in values)}}}"
    return symbolic.constant(float(values), real)


def template(name: str, **values: Any) -> str:
    """A file in ``templates/``, with values in place of its ``$names`` if there are any."""
    text = (Path(__file__).with_name("templates") / name).read_text(encoding="utf-8")
    return Template(text).substitute(values) if values else text
