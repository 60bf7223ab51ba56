"""Public functions with arguments of every sort, and with arrays of every form."""

from __future__ import annotations

import math
from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import oracle
import pytest
from hypothesis import given, note
from hypothesis import strategies as st

import alpha5_model as a5
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.errors import Alpha5Error

pytestmark = pytest.mark.slow

NUMBERS = (0.0, -0.0, 1.0, -1.0, 1e-9, 1e-300, 5e-324, 1e9, 1e154, 1e300, -1e300)
SCALES = (0.0, -1.0, 1e-12, 1e9, 1e50, 1e300)
NOT_FINITE = (math.nan, math.inf, -math.inf)
#: Nothing of these is an array of real numbers, whatever the parameter.
NO_NUMBERS: tuple[Any, ...] = (
    *("", "abc", "1", b"1", {}, {1: 2}, {1.0}, object(), len, Path("x"), 1 + 2j),
    *([1, [2, 3]], [None], [[1.0], "a"]),
    np.array(["1", "2", "3"]),
    np.array([1 + 1j, 0, 0]),
    np.array([None, 1, 2]),
    np.array("2020-01-01", "datetime64"),
    np.array([True, False, True]),
    np.zeros(3, [("x", float)]),
)
#: Odd, but someone may have a reason.
ODD: tuple[Any, ...] = (
    *(None, True, False, 0, 1, -1, 2**70, -(2**63), 3.7, Decimal("1.5")),
    *(Fraction(1, 3), [], (), [[]], range(4), np.float32(1.5), np.int8(3)),
    *(np.zeros(0), np.zeros((0, 3)), np.zeros((3, 0)), np.zeros((2, 2, 2))),
    *(np.zeros(4, np.float16), np.eye(3, dtype=int)),
)
TEXTS = (
    *("", " ", "tcp", "link_3", "axis_b", "base_frame", "locked", "jaws", "printed"),
    *("a\0b", "\udcff", "é", "a\nb", "${1/0}", "<x>", "nan", "[red]", "x" * 5000),
)
#: Functions that take checked arrays, and curves, which are results and check nothing.
UNCHECKED = (
    *("check_inside", "frame_positions", "torque_margin", "torque_terms"),
    *("water_terms", "Arc.", "Segment."),
)
#: Functions that take long; they are drawn less often.
SLOW = ("plan", "placements", "analyse", "without_self_collision")
#: Function -> parts of its answer that may be NaN or infinite, as documented: branches
#: that do not exist, absent limits, what the motor cannot do, missing readings.
INFINITE = {
    "inverse_kinematics": {"q"},
    "inverse_kinematics_pose": {"q", "rotation_error"},
    "published_inverse_kinematics": {"answer"},
    "approach_directions": {"directions"},
    "torque_limits": {"lower", "upper"},
    "plan": {"limit"},
    "plan_poses": {"readings"},
    "session": {"readings"},
    "with_readings": {"answer"},
}


@cache
def calls() -> list[tuple[str, Any]]:
    """Public functions with good arrays, the quick ones more often."""
    import array_functions as functions

    every = [
        *functions.arm_calls(),
        *functions.kinematics_calls(),
        *functions.theory_calls(),
    ]
    checked = [(name, call) for name, call in every if not name.startswith(UNCHECKED)]
    quick = [(name, call) for name, call in checked if not name.startswith(SLOW)]
    return quick * 5 + checked


def drawn_call(data: st.DataObject) -> tuple[str, Any]:
    """A function's name and its call; only the name is printed if it fails."""
    number = data.draw(st.integers(0, len(calls()) - 1))
    note(calls()[number][0])
    return calls()[number]


def infinite(name: str) -> frozenset[str]:
    """Parts of the answer of a function that may be infinite."""
    if name.startswith("DH"):
        return frozenset({"lower", "upper"})
    return frozenset(INFINITE.get(name.rpartition(".")[2], ()))


def at(array: np.ndarray, place: int, value: float) -> np.ndarray:
    changed = array.astype(float)
    changed.flat[place % array.size] = value
    return changed


def masked(array: np.ndarray, place: int) -> np.ndarray:
    mask = np.zeros(array.shape, bool)
    mask.flat[place % array.size] = True
    return np.ma.MaskedArray(array, mask)


@st.composite
def spoiled(draw: st.DrawFn, array: np.ndarray) -> tuple[Any, bool]:
    """Something in place of an array, and whether nothing but a refusal is right."""
    place = draw(st.integers(0, 300))
    ways: list[Callable[[], tuple[Any, bool]]] = [
        lambda: (draw(st.sampled_from(NO_NUMBERS)), True),
        lambda: (draw(st.sampled_from(ODD)), False),
    ]
    if array.size:
        ways += [
            lambda: (at(array, place, draw(st.sampled_from(NOT_FINITE))), True),
            lambda: (masked(array, place), True),
            *[lambda: (at(array, place, draw(st.sampled_from(NUMBERS))), False)] * 3,
            *[lambda: (array * draw(st.sampled_from(SCALES)), False)] * 3,
        ]
    if array.ndim:
        ways += [
            lambda: (array[..., :-1], False),
            lambda: (array[..., None], False),
            lambda: (np.moveaxis(array, 0, -1), False),
            lambda: (array[:0], False),
            lambda: (np.broadcast_to(array, (1, 1, 1, *array.shape)), False),
        ]
    with np.errstate(over="ignore"):
        return draw(st.sampled_from(ways))()


@oracle.fuzzed
@given(st.data())
def test_arguments_of_any_sort(data: st.DataObject) -> None:
    name, call = drawn_call(data)
    given = dict(call.arrays)
    hopeless = False
    chosen = data.draw(st.sets(st.sampled_from([*given]), min_size=1, max_size=2))
    for parameter in sorted(chosen):
        value, bad = data.draw(spoiled(np.asarray(given[parameter])), label=parameter)
        given[parameter] = value
        hopeless |= bad and parameter != "readings"
    others = dict(call.others)
    if others and data.draw(st.booleans()):
        parameter = data.draw(st.sampled_from(sorted(others)))
        values = st.sampled_from((*NUMBERS, *ODD, *TEXTS))
        others[parameter] = data.draw(values, label=parameter)
    oracle.answer(
        lambda: call.function(**given, **others),
        hopeless=hopeless,
        infinite=infinite(name),
    )


# --- forms of arrays ------------------------------------------------------------------


def misaligned(array: np.ndarray) -> np.ndarray:
    """At an address that is no multiple of 8."""
    buffer = b"xyz" + array.tobytes()
    return np.frombuffer(buffer, array.dtype, offset=3).reshape(array.shape)


def packed(array: np.ndarray) -> np.ndarray:
    """A field of records without padding."""
    records = np.zeros(array.shape, [("a", "u1"), ("x", array.dtype), ("b", "u2")])
    records["x"] = array
    return records["x"]


def spread(array: np.ndarray) -> np.ndarray:
    """Every second number of a larger array, others between them."""
    larger = np.full([2 * n + 1 for n in array.shape], 7.7e77)
    place = tuple(slice(0, 2 * n, 2) for n in array.shape)
    larger[place] = array
    return larger[place]


def read_only(array: np.ndarray) -> np.ndarray:
    copy = array.copy()
    copy.flags.writeable = False
    return copy


#: The same numbers in another form.
FORMS: dict[str, Callable[[np.ndarray], Any]] = {
    "misaligned": misaligned,
    "packed": packed,
    "spread": spread,
    "byte-swapped": lambda array: array.astype(array.dtype.newbyteorder(">")),
    "negative strides": lambda array: np.flip(np.flip(array).copy()),
    "Fortran order": lambda array: np.asfortranarray(array) if array.ndim else array,
    "read-only": read_only,
    "long double": lambda array: array.astype(np.longdouble),
    "lists": lambda array: array.tolist(),
}


@oracle.fuzzed
@given(st.data())
def test_the_form_of_an_array_changes_nothing(data: st.DataObject) -> None:
    name, call = drawn_call(data)
    plain = {key: np.array(value, float) for key, value in call.arrays.items()}
    first = data.draw(st.sampled_from([*FORMS]))
    second = data.draw(st.sampled_from([*FORMS]))
    other = {}
    for key, array in plain.items():
        form = FORMS[first](array)
        other[key] = form if isinstance(form, list | float) else FORMS[second](form)
    before = {key: np.array(value, float) for key, value in other.items()}

    def answer(given: dict[str, Any]) -> Any:
        return oracle.answer(
            lambda: call.function(**given, **call.others), infinite=infinite(name)
        )

    wanted = answer(plain)
    found = answer(other)
    assert isinstance(wanted, Alpha5Error) == isinstance(found, Alpha5Error)
    pairs = zip(oracle.leaves(wanted), oracle.leaves(found), strict=True)
    for (place, one), (_, two) in pairs:
        same = np.allclose(one, two, rtol=1e-9, atol=1e-9, equal_nan=True)
        assert same or one.dtype.kind not in "fiub", place
    for key, array in before.items():
        assert np.array_equal(np.array(other[key], float), array), f"changed {key}"


# --- other arguments ------------------------------------------------------------------

Strategy = st.SearchStrategy[Any]


def one_of(*values: Any) -> Strategy:
    return st.sampled_from(values)


some = st.floats(-5, 5)
triple = st.lists(some, min_size=3, max_size=3)
anything = st.sampled_from((*NUMBERS, *NOT_FINITE, *NO_NUMBERS, *ODD, *TEXTS))
#: Name -> function, and a strategy for each parameter.
OTHERS: dict[str, tuple[Callable[..., Any], dict[str, Strategy]]] = {
    "load": (
        a5.load,
        {
            "fluid_density": st.floats(0, 2e4),
            "gripper": one_of("locked", "jaws"),
            "floating_base": st.booleans(),
            "corrections": one_of((), ("base_frame",), ("base_frame", "link3_cob")),
        },
    ),
    "parameters": (a5.parameters, {"corrections": one_of((), ("base_frame",))}),
    "named_pose": (a5.named_pose, {"name": one_of("home", "stow")}),
    "q_from_devices": (
        a5.q_from_devices,
        {"devices": st.dictionaries(st.integers(0, 6), st.floats(0, 3))},
    ),
    "actuator": (
        a5.actuators.actuator,
        {
            "joint": one_of("axis_a", "axis_b", "axis_c"),
            "constants": one_of("printed", "torque", "voltage"),
            "rotor_inertia": st.floats(0, 1e-5),
            "screw_lead": st.floats(1e-4, 1e-2),
        },
    ),
    "DHLink": (
        a5.dh.DHLink,
        {**dict.fromkeys(("theta", "d", "a", "alpha"), some), "sigma": one_of(0, 1)},
    ),
    "PlanarArm": (
        lambda **given: a5.planar.PlanarArm(**given).workspace(),
        {
            "lengths": st.lists(st.floats(0.1, 5), min_size=1, max_size=3),
            "joints": one_of(None, "R", "RR", "RPR", "PP", ""),
            "limits": one_of(None, [(-1.0, 1.0)] * 3, [None, (0.0, 2.0)], "none"),
        },
    ),
    "theorem_row": (
        a5.planar.theorem_row,
        {name: st.floats(0.1, 5) for name in ("l_1", "l_2", "l_3", "l_4")},
    ),
    "Variant": (
        lambda **given: len(urdf(Variant(**given))),
        {
            "gripper": one_of("locked", "jaws"),
            "prefix": one_of("", "a_"),
            "parent": one_of("", "rov"),
            "xyz": triple,
            "rpy": triple,
            "collision": one_of("none", "shapes"),
            "dh_frames": st.booleans(),
            "ros2_control": st.booleans(),
            "corrections": one_of((), ("base_frame",)),
        },
    ),
    "Obstacle.sphere": (
        a5.Obstacle.sphere,
        {"name": one_of("ball"), "radius": st.floats(0.01, 1), "xyz": triple},
    ),
}


@oracle.fuzzed
@given(st.data())
def test_names_flags_and_numbers_of_any_sort(data: st.DataObject) -> None:
    name = data.draw(st.sampled_from([*OTHERS]))
    function, parameters = OTHERS[name]
    spoiled = data.draw(st.sets(st.sampled_from([*parameters])))
    given = {
        parameter: data.draw(anything if parameter in spoiled else good)
        for parameter, good in parameters.items()
    }
    oracle.answer(lambda: function(**given), infinite=infinite(name))


# --- plausibility ---------------------------------------------------------------------


def vehicle(**given: float) -> a5.Vehicle:
    values: dict[str, Any] = {
        "mass": 11.5,
        "com": (0.0, 0.0, 0.02),
        "inertia": np.diag([0.2, 0.25, 0.3]),
        "volume": 0.0115,
        "cob": (0.0, 0.0, 0.05),
    }
    return a5.Vehicle(**values | given)


#: Name -> call, a range that any arm may have, numbers that no arm has, which must be
#: told or refused, and numbers that must be refused.
QUANTITIES: dict[str, Any] = {
    "fluid density": (
        lambda x: a5.load(fluid_density=x),
        (990.0, 1035.0),
        (1.025, 1.0, 0.998),
        (-1.0, -1025.0),
    ),
    "gravity": (
        lambda x: a5.load(gravity=(0.0, 0.0, x)),
        (-9.84, -9.76),
        (981.0, -981.0, 9810.0),
        (),
    ),
    "payload mass": (
        lambda x: a5.load().with_payload(x),
        (0.01, 1.5),
        (500.0, 250.0, 1e4),
        (-0.1, -500.0),
    ),
    "payload volume": (
        lambda x: a5.load().with_payload(0.2, volume=x),
        (1e-5, 1e-3),
        (1.0, 200.0),
        (-1e-4,),
    ),
    "payload centre of mass": (
        lambda x: a5.load().with_payload(0.2, com=(0.0, 0.0, x)),
        (-0.1, 0.1),
        (20.0, 50.0, -20.0),
        (),
    ),
    "vehicle mass": (lambda x: vehicle(mass=x), (8.0, 15.0), (), (-1.0,)),
    "vehicle volume": (
        lambda x: vehicle(volume=x),
        (0.010, 0.013),
        (11.4, 11.5),
        (-0.01,),
    ),
}


@oracle.fuzzed
@given(st.data())
def test_what_is_not_plausible_is_told(data: st.DataObject) -> None:
    name = data.draw(st.sampled_from([*QUANTITIES]))
    call, good, odd, impossible = QUANTITIES[name]
    oracle.answer(lambda: call(data.draw(st.floats(*good))))
    for x in odd:
        oracle.answer(lambda x=x: call(x), silent=False)
    for x in impossible:
        oracle.answer(lambda x=x: call(x), hopeless=True)
