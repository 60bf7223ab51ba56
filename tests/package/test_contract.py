"""Each public function refuses what it cannot use, by the package's own error.

The error is a `ValueError` or an `OSError` too, has one line, and names the argument.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import (
    Alpha5Error,
    ImplausibleWarning,
    InputError,
    ShapeError,
    UnknownNameError,
)

#: Function and the arguments with which it answers.
Case = tuple[Callable[..., Any], dict[str, Any]]
#: Name, case, argument, and the array that it is.
ArrayCase = tuple[str, Case, str, np.ndarray]

#: Results, which check nothing, and functions inside the package.
UNCHECKED = (
    "check_inside",
    "frame_positions",
    "torque_margin",
    "torque_terms",
    "water_terms",
    "Arc.",
    "Segment.",
)
#: Where NaN is what was not measured, as documented.
NOT_MEASURED = {("session", "readings"), ("with_readings", "readings")}
#: Names under which an argument is refused as well: parts that are made of it.
ALSO = {
    ("DHChain.from_table", "rows"): ("vector", "links"),
    ("DHChain.from_axes", "limits"): ("lower", "upper"),
    ("PlanarArm.part", "start"): ("lengths",),
    ("PlanarArm.part", "stop"): ("lengths",),
    ("Vehicle", "mass"): ("inertia",),
    ("check_possible", "inertia"): ("inertia_com",),
    ("q_from_devices", "d"): ("devices",),
    ("q_from_devices", "e"): ("devices",),
    ("spatial_dexterity", "positions"): ("q",),
}


class Foreign:
    """No value of any kind."""


#: What no array of numbers can be made of.
NO_NUMBERS: dict[str, Callable[[np.ndarray], Any]] = {
    "text": lambda array: "x",
    "bytes": lambda array: b"x",
    "an object": lambda array: Foreign(),
    "objects": lambda array: np.full(array.shape, None),
    "texts": lambda array: np.full(array.shape, "1"),
    "complex": lambda array: array + 1j,
    "true and false": lambda array: array > 0,
    "masked": lambda array: np.ma.masked_array(array, mask=array == array),
    "infinity": lambda array: np.full(array.shape, np.inf),
    "NaN": lambda array: np.full(array.shape, np.nan),
}
#: Of any other argument: some are refused, and no other error may come.
ANYTHING: tuple[Any, ...] = (
    None,
    True,
    0,
    -1,
    -5.5,
    10**400,
    1e308,
    np.inf,
    np.nan,
    1j,
    Foreign(),
    "abc",
    "",
    b"x",
    [],
    [1],
    {1: 2},
    set(),
    [[1, 2], [3]],
    range(3),
    [True] * 4,
    np.array([1.0, 2.0]),
    np.zeros((0, 3)),
    np.zeros((2, 2, 2)),
    np.array(["a"]),
    np.array([None]),
    [[1e300] * 3],
    np.full(3, np.nan),
    np.ma.masked_all(4),
)


def outcome(function: Callable[..., Any], given: dict[str, Any]) -> Exception | None:
    """The error of a call, or None for an answer."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ImplausibleWarning)
        try:
            function(**given)
        except Exception as error:
            return error
    return None


def fault(error: Exception | None, *arguments: str) -> str:
    """What is wrong with an error that may name these arguments, or nothing."""
    if error is None:
        return ""
    said = f"{type(error).__name__}: {error}"
    if not isinstance(error, Alpha5Error) or not isinstance(
        error, ValueError | OSError
    ):
        return f"no error of ours: {said}"
    if "\n" in str(error):
        return f"more than a line: {said}"
    if isinstance(error, InputError) and not names(error, arguments):
        return f"names {error.name!r}: {said}"
    return ""


def names(error: InputError, arguments: tuple[str, ...]) -> bool:
    """Whether an error names an argument: alone, with its place, or beside others."""
    words = re.split(r"\W+", error.name)
    return any(argument in words for argument in arguments)


# --- arrays ---------------------------------------------------------------------------


@pytest.fixture(
    scope="module",
    params=["arm", "kinematics", pytest.param("theory", marks=pytest.mark.slow)],
)
def array_cases(request: pytest.FixtureRequest) -> list[ArrayCase]:
    """The arrays of each public function of a room, each once."""
    import array_functions

    found: dict[tuple[str, str], ArrayCase] = {}
    for name, call in getattr(array_functions, f"{request.param}_calls")():
        if name.startswith(UNCHECKED):
            continue
        given = {**call.arrays, **call.others}
        for argument, array in call.arrays.items():
            case = name, (call.function, given), argument, np.asarray(array)
            found.setdefault((name, argument), case)
    assert len(found) >= 20
    return [*found.values()]


def test_what_are_no_numbers_is_refused(array_cases: list[ArrayCase]) -> None:
    faults = []
    for name, (function, given), argument, array in array_cases:
        for kind, spoil in NO_NUMBERS.items():
            if kind == "NaN" and (name, argument) in NOT_MEASURED:
                continue
            error = outcome(function, {**given, argument: spoil(array)})
            also = ALSO.get((name, argument), ())
            problem = fault(error, argument, *also) if error else "accepted"
            if problem:
                faults.append(f"{name}({argument}) with {kind}: {problem}")
    assert not faults, "\n".join(faults)


def test_arrays_of_another_shape_are_refused(array_cases: list[ArrayCase]) -> None:
    """A last axis that is one longer, where the function does not broadcast."""
    faults = []
    shapes = 0
    for name, (function, given), argument, array in array_cases:
        if array.ndim == 0:
            continue
        longer = np.concatenate([array, array[..., -1:]], axis=-1)
        error = outcome(function, {**given, argument: longer})
        shapes += isinstance(error, ShapeError)
        # Of two shapes that differ, either may be named.
        also = ALSO.get((name, argument), ())
        if problem := fault(error, *given, *also):
            faults.append(f"{name}({argument}): {problem}")
    assert shapes > 10
    assert not faults, "\n".join(faults)


def test_rows_of_another_width_are_refused_even_if_there_is_none() -> None:
    arm = a5.load()
    none = np.zeros((0, 4))
    states = {"q": none, "v": none, "tau": none}
    assert arm.forward_dynamics_batch(**states).shape == (0, 4)
    for name in ("v", "tau"):
        for wrong in (np.zeros(0), np.zeros((0, 0)), np.zeros((0, 7)), []):
            with pytest.raises(ShapeError) as caught:
                arm.forward_dynamics_batch(**{**states, name: wrong})
            assert caught.value.name == name


@pytest.mark.slow
def test_every_public_function_of_arrays_is_called() -> None:
    import array_functions as functions

    calls = [
        *functions.arm_calls(),
        *functions.kinematics_calls(),
        *functions.theory_calls(),
        *functions.jax_calls(),
    ]
    called = {functions.short(name) for name, _ in calls}
    taking = functions.taking_arrays()
    assert len(taking) > 100
    missing = [
        name
        for name in taking
        if functions.short(name) not in called and not functions.left_out(name)
    ]
    assert missing == [], "add a call of it to array_functions.py"


# --- all other arguments --------------------------------------------------------------


def kinematics() -> list[Case]:
    space = a5.workspace
    p = np.array([0.2, 0.1, 0.1])
    q = np.array([3.0, 1.0, 1.0, 1.0])
    reach = {"positions": p, "limits": True}
    path = {"positions": p[None], "q_start": None, "wrist": None, "max_step": 0.5}
    both = {"side": "both", "limits": True}
    return [
        (a5.inverse_kinematics, {"position": p, "wrist": 0.0}),
        (a5.inverse_kinematics(p).best, {"q_reference": q}),
        (a5.inverse_kinematics_path, path),
        (a5.reachable, reach),
        (a5.distance_to_reach, reach),
        (a5.nearest_reachable, reach),
        (space.boundary, both),
        (space.cross_section_area, both),
        (space.volume, {"limits": True}),
        (space.published_but_unreachable, {"side": "both"}),
        (space.reachable_but_unpublished, {"side": "both"}),
        (space.in_half_plane, {"radius": [0.2], "z": [0.1], **both}),
        (space.singularities(q).near, {"angle": 1e-6, "distance": 1e-6}),
        (a5.named_pose, {"name": "home"}),
        (a5.devices_from_q, {"q": q}),
    ]


def chains() -> list[Case]:
    from alpha5_model.theory.dh import dh_transform, types_and_tasks

    dh = a5.dh
    chain = dh.DHChain.alpha5()
    q = np.array([3.0, 1.0, 1.0, 1.0])
    row = {"theta": 0.0, "d": 0.0, "a": 1.0, "alpha": 0.0}
    axes = {
        "points": [[0.0, 0, 0], [1, 0, 0]],
        "directions": [[0.0, 0, 1], [0, 0, 1]],
        "sigma": None,
        "end_effector": None,
        "q": None,
        "limits": None,
        "name": "n",
        "joint_names": (),
    }
    return [
        (dh.DHChain, {"links": chain.links, "name": "x", "joint_names": ()}),
        (dh.DHChain.from_table, {"rows": [[0, 0, 1, 0, 0]], "joint_names": ()}),
        (dh.DHChain.alpha5, {"corrections": ()}),
        (dh.DHChain.from_pinocchio, {"model": a5.load().model, "frame": None}),
        (dh.DHChain.from_urdf, {"path": a5.URDF_PATH, "frame": None}),
        (chain.forward_kinematics, {"q": q, "frame": "tool"}),
        (chain.jacobian, {"q": q, "frame": 2}),
        (dh_transform, row),
        (dh.DHLink, {**row, "sigma": 0, "lower": -1.0, "upper": 1.0}),
        (chain.links[0].transform, {"q": 0.3}),
        (dh.DHChain.from_axes, axes),
        (types_and_tasks.classify, {"chain": chain}),
        (types_and_tasks.task_capability, {"chain": chain}),
    ]


def planar_arms() -> list[Case]:
    planar = a5.planar
    arm = planar.PlanarArm((5.0, 4.0, 1.0))
    made = {"lengths": (5.0, 4.0), "limits": None, "joints": "RR", "angles": None}
    counts = {"orientations": 4, "samples": 3}
    bars = {"l_1": 5.0, "l_2": 4.0, "l_3": 1.0, "l_4": 3.0}
    return [
        (planar.PlanarArm, made),
        (arm.part, {"start": 0, "stop": 1}),
        (arm.poses, {"q": [0.0, 0, 0]}),
        (planar.dexterity, {"arm": arm, "points": [0.0, 1.0], **counts}),
        (planar.dexterity_map, {"arm": arm, "resolution": 3, **counts}),
        (planar.dexterous_area, {"arm": arm}),
        (planar.dexterous_radii, {"arm": arm}),
        (planar.necessary_conditions, {"arm": arm}),
        (planar.turns_fully, {"arm": arm, "radius": 3.0}),
        (planar.lecture_theorem, bars),
        (planar.theorem_radii, {key: bars[key] for key in ("l_1", "l_2", "l_3")}),
    ]


def arms() -> list[Case]:
    arm = a5.load()
    q = np.array([3.0, 1.0, 1.0, 1.0])
    loaded = {
        "fluid_density": 1025.0,
        "gripper": "locked",
        "floating_base": False,
        "gravity": (0.0, 0.0, -9.81),
        "corrections": (),
        "arm": None,
    }
    payload = {"mass": 0.5, "com": (0, 0, 0.1), "volume": 1e-4, "frame": "tcp"}
    motor = {"joint": "axis_d", "rotor_inertia": None, "efficiency": "gearbox"}
    body = {"mass": 9.0, "com": (0, 0, 0), "inertia": np.eye(3), "volume": 0.009}
    strip = {"start": (0, 0, 0), "end": (0, 0, 1), "diameter": 0.1, "across": 1.0}
    return [
        (a5.load, loaded),
        (a5.parameters, {"corrections": ()}),
        (a5.gravity_in_base, {"rotation": np.eye(3), "gravity": (0, 0, -9.81)}),
        (arm.forward_kinematics, {"q": q, "frame": "tcp"}),
        (arm.jacobian, {"q": q, "frame": "tcp"}),
        (arm.in_collision, {"q": q, "margin": 0.0}),
        (arm.inverse_dynamics_batch, {"q": [q], "v": [q], "a": [q], "threads": 1}),
        (arm.with_payload, payload),
        (arm.with_hydrodynamics, {"level": "nominal", "numbers": "estimated"}),
        (a5.actuators.actuator, motor),
        (a5.Vehicle, {**body, "cob": (0, 0, 0.1)}),
        (a5.DragStrip, strip),
        (a5.without_self_collision, {"q": q, "wrists": 2}),
    ]


def motions() -> list[Case]:
    time = np.arange(0.0, 1.0, 0.05)
    q = np.outer(np.sin(time), [0.1] * 4) + a5.named_pose("home")
    trajectory = a5.trajectory
    motion = trajectory.motion(time, q)
    return [
        (trajectory.motion, {"time": time, "position": q, "effort": None}),
        (partial(trajectory.smooth, motion), {"method": "interpolate"}),
        (partial(trajectory.analyse, motion), {"arm": None}),
    ]


def labs() -> list[Case]:
    u = a5.uncertainty
    c = a5.calibrate
    q = np.ones((2, 4))
    still = np.zeros(4)
    state = {"q": still, "v": still, "a": still}
    return [
        (u.sample, {"n": 2, "seed": 0}),
        (u.bounds, {**state, "arm": a5.load(0.0)}),
        (c.weight, {"noise": 1e-3, "gain": 1e-3}),
        (c.efforts, {"noise": 1e-3, "gain": 1e-3, "offset": 0.0}),
        (c.force_torque, {"force_noise": 1e-2, "torque_noise": 1e-3, "gain": 1e-3}),
        (c.session, {"sensor": c.efforts(), "q": q, "fluid_density": 0.0}),
    ]


def plans() -> list[Case]:
    box = {"name": "o", "edges": (0.1, 0.1, 0.1), "xyz": (0.3, 0, 0), "rpy": (0, 0, 0)}
    ball = {"name": "o", "radius": 0.1, "xyz": (0.3, 0, 0)}
    way = {
        "q0": a5.named_pose("home"),
        "target": a5.named_pose("reach"),
        "speed": None,
        "margin": 0.005,
        "line": False,
        "obstacles": (),
    }
    parked = {
        "targets": (0.3, 0.1, 0.1),
        "mount": np.eye(4),
        "clearance": 0.005,
        "wrist": 0.0,
        "hull": (),
        "spacing": 0.2,
        "yaws": 1,
        "tilts": (0.0, 0.0),
    }
    return [
        (a5.Obstacle.box, box),
        (a5.Obstacle.sphere, ball),
        (a5.plan, way),
        (a5.placements, parked),
    ]


ROOMS = (kinematics, chains, planar_arms, arms, motions, labs, plans)


@pytest.mark.parametrize("room", ROOMS)
def test_an_answer_or_an_error_of_the_package(room: Callable[[], list[Case]]) -> None:
    faults = []
    for function, arguments in room():
        name = getattr(function, "__qualname__", function.__class__.__name__)
        for argument in arguments:
            refused = 0
            for bad in ANYTHING:
                error = outcome(function, {**arguments, argument: bad})
                refused += error is not None
                # A number may be wrong only beside the others.
                hopeless = isinstance(bad, str | bytes | complex | Foreign)
                blamed = [argument] if hopeless else arguments
                if problem := fault(error, *blamed, *ALSO.get((name, argument), ())):
                    faults.append(f"{name}({argument}={bad!r:.40}): {problem}")
            if refused < len(ANYTHING) // 3:
                faults.append(f"{name}({argument}) takes anything")
    assert not faults, "\n".join(faults)


def test_limits_are_true_or_false() -> None:
    space = a5.workspace
    p = [[0.2, 0.1, 0.1]]
    for function, first in (
        (a5.reachable, [p]),
        (a5.distance_to_reach, [p]),
        (a5.nearest_reachable, [p]),
        (space.boundary, ["both"]),
        (space.volume, []),
        (space.in_half_plane, [0.2, 0.1, "both"]),
    ):
        for bad in (1, 0, "no", None, [True], np.array([True, False]), np.eye(3)):
            with pytest.raises(InputError) as caught:
                function(*first, bad)
            assert caught.value.name == "limits"
        assert repr(function(*first, np.False_)) == repr(function(*first, False))


def test_unknown_names_say_which_exist() -> None:
    chain = a5.dh.DHChain.alpha5()
    q = np.ones(4)
    for call, bad, choice in (
        (lambda bad: chain.forward_kinematics(q, bad), -1, "tool"),
        (lambda bad: chain.forward_kinematics(q, bad), "tcp", "tool"),
        (a5.workspace.boundary, "left", "underarm"),
        (a5.named_pose, "streach", "stow"),
        (lambda bad: a5.load(gripper=bad), "open", "jaws"),
        (lambda bad: a5.load().forward_kinematics(q, bad), "tpc", "tcp"),
    ):
        with pytest.raises(UnknownNameError) as caught:
            call(bad)
        assert caught.value.name == bad
        assert choice in caught.value.choices


def test_the_contract_sees_a_foreign_error_and_a_wrong_name() -> None:
    assert "no error of ours" in fault(TypeError("x"), "q")
    assert "names 'v'" in fault(InputError("v", 1, "a number"), "q")
    assert fault(InputError("q", 1, "a number"), "q") == ""
    assert fault(None, "q") == ""
