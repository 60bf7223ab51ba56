"""The numbers that a C build is tested with: random states and edges, and what Pinocchio answers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from alpha5_model.c_library.source import has_struct, numbers, template
from alpha5_model.checks import FloatArray
from alpha5_model.dynamics.arm import Arm
from alpha5_model.kinematics.ik import inverse_kinematics
from alpha5_model.kinematics.plane import arm_plane, singular_elbow_angles
from alpha5_model.symbolic.program import Program

_STATES = 20
#: Of equal functions in C: differences allowed, as a share; those that divide by M lose digits to its condition.
_BOUNDS = {"double": (1e-12, 1e-9), "float": (2e-5, 2e-3)}
#: Of the tcp on the yaw axis, onto which it is put, and elsewhere [m]; of a joint [rad].
_MISSES = {"double": (2e-9, 1e-12, 1e-9), "float": (5e-6, 2e-6, 1e-3)}


def answer(arm: Arm, name: str, given: Mapping[str, FloatArray]) -> list[FloatArray]:
    """What Pinocchio says of one of `alpha5_model.symbolic.products`, output by output.

    Args:
        arm: Whose method of that name is asked.
        name: Of the function.
        given: Its inputs q, v, a, tau.
    """
    if name == "link_poses":
        links = (f"link_{i}" for i in range(1, 5))
        return [_array(arm.forward_kinematics(given["q"], frame=link)) for link in links]
    result = getattr(arm, name)(*given.values())
    return [_array(part) for part in (result if isinstance(result, tuple) else (result,))]


def _array(result: Any) -> FloatArray:
    """A pose as (4, 4), a force as (6,)."""
    for attribute in ("homogeneous", "vector"):
        result = getattr(result, attribute, result)
    return np.array(result)


def check_program(arm: Arm, made: Sequence[Program], real: str) -> str:
    """``test_alpha5.c``."""
    rng, g = np.random.default_rng(5), arm_plane()
    kind = np.float32 if real == "float" else np.float64
    states: dict[str, FloatArray] = {
        name: rng.normal(scale=2.0, size=(_STATES, 4)) for name in ("q", "v", "a", "tau")
    }
    states["q"] = rng.uniform(g.lower, g.upper, (_STATES, 4))
    states = {name: x.astype(kind).astype(np.float64) for name, x in states.items()}
    methods = [one for one in made if one.name not in ("inverse_kinematics", "with_payload")]
    tests = {one.name: _test(arm, one, states, real) for one in methods}
    if has_struct(made):
        tests["with_payload"] = _payload_test(arm, states, real)
    edge, miss, turn = _MISSES[real]
    return template(
        "test_alpha5.c",
        count=_STATES,
        **{name: numbers(x, real) for name, x in states.items()},
        tests="".join(tests.values()),
        targets=",\n".join(f"    {{{row}}}" for row in _targets(arm, real)),
        calls="\n".join(f"    test_{name}();" for name in tests),
        edge=edge,
        miss=miss,
        turn=turn,
    )


def _test(arm: Arm, one: Program, states: Mapping[str, FloatArray], real: str) -> str:
    names = [slot.name for slot in one.inputs if slot.name in states]
    rows = [{name: states[name][i] for name in names} for i in range(_STATES)]
    expected = [answer(arm, one.name, row) for row in rows]
    bound = _BOUNDS[real][one.name.startswith("forward_dynamics")]
    struct = any(slot.name == "parameters" for slot in one.inputs)
    given = ["&alpha5_default_parameters"] * struct + [f"{name}[row]" for name in names]
    given += [slot.name + "_out" for slot in one.outputs]
    tables, locals_, checks = "", "", ""
    for k, slot in enumerate(one.outputs):
        table = f"{one.name}_{slot.name}"
        values = numbers(np.array([x[k].ravel() for x in expected]), real)
        shape = "".join(f"[{n}]" for n in slot.shape)
        first = "".join("[0]" for _ in slot.shape)
        tables += f"\nstatic const alpha5_real {table}[{_STATES}][{slot.size}] = {values};"
        locals_ += f"        alpha5_real {slot.name}_out{shape};\n"
        checks += (
            f'        compare("{one.name}", row, &{slot.name}_out{first}, {table}[row], '
            f"{slot.size}, {bound});\n"
        )
    return (
        f"{tables}\n\nstatic void test_{one.name}(void)\n{{\n    int row;\n"
        f"    for (row = 0; row < {_STATES}; ++row) {{\n{locals_}"
        f"        alpha5_{one.name}({', '.join(given)});\n{checks}    }}\n}}\n"
    )


def _payload_test(arm: Arm, states: Mapping[str, FloatArray], real: str) -> str:
    body: dict[str, Any] = {
        "mass": 0.6,
        "volume": 2.3e-4,
        "com": [0.01, -0.02, 0.05],
        "cob": [-0.01, 0.015, 0.04],
    }
    inertia = np.array([[4e-4, 1e-5, -2e-5], [1e-5, 5e-4, 3e-5], [-2e-5, 3e-5, 6e-4]])
    loaded = arm.with_payload(**body, inertia=inertia)
    rows = zip(states["q"], states["v"], states["a"], strict=True)
    given = {"inertia": inertia.ravel(), "tau": [loaded.inverse_dynamics(*row) for row in rows]}
    arrays: dict[str, Any] = {**body, **given, "density": arm.fluid_density}
    texts = {name: numbers(np.atleast_1d(x), real) for name, x in arrays.items()}
    return template("test_payload.c", count=_STATES, bound=_BOUNDS[real][0], **texts)


def _targets(arm: Arm, real: str) -> list[str]:
    """Anywhere in the workspace, at joint limits, stretched, on the yaw axis, out of reach, wrist turned too far."""
    rng, g = np.random.default_rng(7), arm_plane()
    q = rng.uniform(g.lower, g.upper, (40, 4))
    q[10:26, 1:] = np.where(rng.random((16, 3)) < 0.5, g.lower[1:], g.upper[1:])
    q[26:34, 2] = singular_elbow_angles()["stretched"]
    places = [(arm.forward_kinematics(row).translation, row[3], row) for row in q]
    for height in (-0.1, 0.1, 0.3):
        places.append((np.array([0.0, 0.0, height]), 1.0, None))
    for point in rng.uniform(0.3, 0.6, (4, 3)):
        places.append((point, 6.25, None))
    rows = []
    for position, wrist, known in places:
        s = inverse_kinematics(position, float(wrist))
        flags = (s.exists, s.within_limits)
        clear = known is not None and not s.singular
        parts = [numbers(position, real), numbers(np.array([wrist]), real)[1:-1]]
        parts += ["{" + ", ".join(str(int(x)) for x in flag) + "}" for flag in flags]
        parts += [str(int(s.singular)), str(int(clear))]
        parts.append(numbers(np.zeros(4) if known is None else known, real))
        rows.append(", ".join(parts))
    return rows
