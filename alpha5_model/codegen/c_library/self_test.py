"""A program that tests the C library with what Pinocchio answers."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise, product
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import wrap
from alpha5_model.codegen.c_library.options import COptions
from alpha5_model.codegen.c_library.text import numbers, template
from alpha5_model.codegen.instructions import Program
from alpha5_model.dynamics.arm import Arm
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.kinematics.ik import inverse_kinematics
from alpha5_model.numbers.parameters import Alpha5Parameters

_DEFAULT = "&alpha5_default_parameters"
#: States that are tested.
_STATES = 20


class _Bounds(NamedTuple):
    """How far equal functions may differ in C.

    Attributes:
        plain: As a share of the largest number.
        over_mass: The same of functions that divide by M, whose condition costs digits.
        edge: Of the tcp on the yaw axis, onto which it is put [m].
        miss: Of the tcp elsewhere [m].
        turn: Of a joint [rad].
    """

    plain: float
    over_mass: float
    edge: float
    miss: float
    turn: float


_BOUNDS = {
    "double": _Bounds(plain=1e-12, over_mass=1e-9, edge=2e-9, miss=1e-12, turn=1e-9),
    "float": _Bounds(plain=2e-5, over_mass=2e-3, edge=5e-6, miss=2e-6, turn=1e-3),
}
#: Name of an input -> its value in one state.
State = Mapping[str, FloatArray]


def test_program(arm: Arm, made: Iterable[Program], options: COptions) -> str:
    """``test_alpha5.c``: random states, a payload, and targets."""
    real = options.real
    bounds = _BOUNDS[real]
    states = _states(arm.parameters, real)

    tests = {}
    for function in made:
        takes_a_state = any(slot.name in states[0] for slot in function.inputs)
        if takes_a_state:
            tests[function.name] = _test_of_states(function, arm, states, real)
    if options.struct:
        tests["with_payload"] = _test_of_payload(arm, states, real)

    columns = {}
    for name in states[0]:
        columns[name] = numbers([state[name] for state in states], real)
    return template(
        "test_alpha5.c",
        **columns,
        count=_STATES,
        edge=bounds.edge,
        miss=bounds.miss,
        turn=bounds.turn,
        targets=numbers(_targets(arm), real),
        tests="".join(tests.values()),
        calls="\n".join(f"    test_{name}();" for name in tests),
    )


def _states(parameters: Alpha5Parameters, real: str) -> list[dict[str, FloatArray]]:
    """Random q, v, a and tau, rounded to the type of the library."""
    rng = np.random.default_rng(5)
    kind = np.float32 if real == "float" else np.float64
    shape = (_STATES, 4)
    drawn = {}
    for name in ("q", "v", "a", "tau"):
        drawn[name] = rng.normal(size=shape)
    lower, upper = _limits(parameters)
    drawn["q"] = rng.uniform(lower, upper, shape)

    rounded = {name: x.astype(kind).astype(np.float64) for name, x in drawn.items()}
    states = []
    for i in range(_STATES):
        states.append({name: x[i] for name, x in rounded.items()})
    return states


def _limits(parameters: Alpha5Parameters) -> tuple[list[float], list[float]]:
    """Lower and upper limits of theta_0 to theta_3."""
    joints = parameters.joints[:4]
    lower = [joint.lower for joint in joints]
    upper = [joint.upper for joint in joints]
    return lower, upper


def _test_of_states(
    function: Program, arm: Arm, states: Sequence[State], real: str
) -> str:
    """A test of a function in every state."""
    inputs = [slot.name for slot in function.inputs if slot.name in states[0]]
    given = [f"{name}[row]" for name in inputs]
    if len(inputs) < len(function.inputs):
        given.insert(0, _DEFAULT)

    expected = []
    for state in states:
        values = {name: state[name] for name in inputs}
        expected.append(answer(arm, function.name, values))
    call = f"alpha5_{function.name}({', '.join(given)}"
    return _test(function.name, call, expected, real)


def _test_of_payload(arm: Arm, states: Sequence[State], real: str) -> str:
    """A test of an arm that holds a body: its torques in every state."""
    # The arm holds another link_1: a body whose numbers are all unlike 0.
    _, link_1, *_ = arm.parameters.links
    names = ("mass", "com", "inertia", "volume", "cob")
    body: dict[str, Any] = {name: getattr(link_1, name) for name in names}
    call = f"alpha5_parameters loaded; alpha5_with_payload({_DEFAULT}"
    for value in (*body.values(), arm.fluid_density):
        if np.ndim(value):
            call += f", (const alpha5_real[]){numbers(np.ravel(value), real)}"
        else:
            call += f", {numbers(value, real)}"
    call += ", &loaded); alpha5_inverse_dynamics(&loaded, q[row], v[row], a[row]"

    loaded = arm.with_payload(**body)
    expected = [
        [loaded.inverse_dynamics(state["q"], state["v"], state["a"])]
        for state in states
    ]
    return _test("with_payload", call, expected, real)


def _test(
    name: str, call: str, expected: Sequence[Sequence[FloatArray]], real: str
) -> str:
    """A test of a call in every state.

    Args:
        name: Of the test; differences are shares of each output's own largest number.
        call: C without the outputs and what comes after them.
        expected: Outputs in each state.
        real: Type of the library.
    """
    bounds = _BOUNDS[real]
    divides = name.startswith("forward_dynamics")
    bound = bounds.over_mass if divides else bounds.plain

    sizes = [output.size for output in expected[0]]
    ends = np.cumsum([0, *sizes]).tolist()
    checks = ""
    for start, end in pairwise(ends):
        call += f", (void *)(out + {start})"
        where = f"out + {start}, expected_{name}[row] + {start}, {end - start}"
        checks += f'        compare("{name}", row, {where}, {bound});\n'

    rows = [np.concatenate([output.ravel() for output in row]) for row in expected]
    return template(
        "test_function.c",
        function=name,
        call=call,
        checks=checks,
        size=ends[-1],
        count=_STATES,
        table=numbers(rows, real),
    )


def answer(arm: Arm, name: str, given: State) -> list[FloatArray]:
    """What Pinocchio computes for one of the functions, output by output.

    Args:
        arm: Whose method of that name is called.
        name: Of the function, see `alpha5_model.codegen.arm_functions.products`.
        given: Its inputs q, v, a, tau.

    Returns:
        Arrays; poses are (4, 4), forces (6,).
    """
    if name == "link_poses":
        frames = [f"link_{i}" for i in range(1, 5)]
        result: Any = tuple(
            arm.forward_kinematics(given["q"], frame) for frame in frames
        )
    else:
        result = getattr(arm, name)(*given.values())
    outputs = result if isinstance(result, tuple) else (result,)
    return [_as_array(output) for output in outputs]


def _as_array(output: Any) -> FloatArray:
    """An array, a pin.SE3 or a pin.Force as an array."""
    if hasattr(output, "homogeneous"):
        return np.array(output.homogeneous)
    return np.array(getattr(output, "vector", output))


def _targets(arm: Arm) -> list[list[Any]]:
    """Rows of a target, its solutions' flags and, if they are known, its joint angles.

    Targets are anywhere in the workspace, at all ends of the joint limits, and
    stretched. Each comes on the yaw axis, too, and with the wrist turned too far. The
    last one is out of reach.
    """
    rng = np.random.default_rng(7)
    lower, upper = np.array(_limits(arm.parameters))
    anywhere = rng.uniform(lower, upper, (8, 4))
    at_limits = anywhere.copy()
    at_limits[:, 1:] = [*product(*zip(lower[1:], upper[1:], strict=True))]
    stretched = anywhere.copy()
    stretched[:, 2] = [_stretched(arm.parameters, wrist) for wrist in stretched[:, 3]]
    *_, too_far = np.mean([lower, upper], axis=0) + math.pi

    rows = []
    for angles in (*anywhere, *at_limits, *stretched):
        position = arm.forward_kinematics(angles).translation
        *_, wrist = angles
        on_axis = position * [0.0, 0.0, 1.0]
        rows.append(_target(arm.parameters, position, wrist, angles))
        rows.append(_target(arm.parameters, on_axis, wrist))
        rows.append(_target(arm.parameters, position, too_far))
    rows.append(_target(arm.parameters, np.ones(3), wrist))
    return rows


def _stretched(record: Alpha5Parameters, wrist: float) -> float:
    """theta_2 of the stretched arm [rad]; a tool beside the wrist axis changes it."""
    geometry = Geometry.of(record)
    if geometry.tool_on_axis:
        return math.pi - geometry.gamma_offset
    along, _ = geometry.tool_in_forearm(np.asarray(wrist))
    stretched = math.pi - geometry.gamma_offset_at(float(along))
    return float(wrap(stretched - geometry.middle[2])) + geometry.middle[2]


def _target(
    record: Alpha5Parameters,
    position: FloatArray,
    wrist: float,
    angles: FloatArray | None = None,
) -> list[Any]:
    """A target, and what is known of its solutions."""
    solutions = inverse_kinematics(position, float(wrist), arm=record)
    singular = bool(solutions.singular)
    return [
        position,
        wrist,
        solutions.exists,
        solutions.within_limits,
        singular,
        angles is not None and not singular,
        np.zeros(4) if angles is None else angles,
    ]
