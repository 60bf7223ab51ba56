"""No array that two answers share can be written, not even after its flag was set."""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Iterator
from importlib import import_module
from typing import Any

import numpy as np
import public_names
import pytest
from array_functions import kinematics_calls

import alpha5_model as a5
from alpha5_model._support import checks
from alpha5_model.description import srdf
from alpha5_model.kernels import choice as kernels


def arrays(value: Any, depth: int = 8) -> Iterator[np.ndarray]:
    """Every array in an answer: in its fields, items and attributes."""
    if isinstance(value, np.ndarray):
        if value.dtype != object:
            yield value
    elif depth == 0 or isinstance(value, str | bytes | int | float | type(None)):
        return
    elif isinstance(value, dict):
        yield from arrays([*value.values()], depth - 1)
    elif isinstance(value, list | tuple | set | frozenset):
        for one in value:
            yield from arrays(one, depth - 1)
    elif type(value).__module__.startswith("alpha5_model") and hasattr(
        value, "__dict__"
    ):
        yield from arrays(vars(value), depth - 1)
        names = [name for name in dir(type(value)) if not name.startswith("_")]
        for name in names:
            if isinstance(inspect.getattr_static(type(value), name), property):
                yield from arrays(getattr(value, name), depth - 1)


def unlocked(array: np.ndarray) -> bool:
    """Whether a caller can write it, having asked for it."""
    kept = array.flags.writeable
    try:
        array.flags.writeable = True
    except ValueError:
        return False
    array.flags.writeable = kept
    return True


def shared(first: Any, second: Any) -> list[np.ndarray]:
    """Arrays of one answer that lie where some of another do, and can be written."""
    others = [*arrays(second)]
    return [
        x
        for x in arrays(first)
        if unlocked(x) and any(np.may_share_memory(x, y) for y in others)
    ]


def needed(function: Any) -> list[str]:
    """Arguments without a default."""
    parameters = inspect.signature(function).parameters.values()
    return [
        p.name
        for p in parameters
        if p.default is p.empty and p.kind is not p.VAR_KEYWORD
    ]


def answers() -> dict[str, Any]:
    """What gives the same answer twice: functions without arguments, and arms."""
    found: dict[str, Any] = {}
    roots = [
        a5,
        *(
            import_module(f"alpha5_model.{name}")
            for name in public_names.MODULES.values()
        ),
    ]
    roots += [
        a5.workspace,
        a5.uncertainty,
        a5.dh,
        a5.planar,
        a5.actuators,
        a5.trajectory,
    ]
    for root in roots:
        for name in public_names.public(root):
            value = getattr(root, name)
            function = inspect.unwrap(value) if callable(value) else None
            if (
                inspect.isfunction(function)
                and not needed(function)
                and name != "audit"
            ):
                found[f"{root.__name__}.{name}"] = value
            elif not callable(value) and not inspect.ismodule(value):
                found[f"{root.__name__}.{name}"] = lambda value=value: value
    found["named_pose"] = lambda: [a5.named_pose(name) for name in srdf.NAMED_POSES]
    found["moving water"] = lambda: _parts(a5.load().with_hydrodynamics())
    arm = a5.load()
    found["limits"] = lambda: arm.limits
    found["chain"] = a5.dh.DHChain.alpha5
    found["actuator"] = lambda: [
        a5.actuators.actuator(name) for name in arm.joint_names
    ]
    return found


def _parts(wet: Any) -> list[Any]:
    return [wet.water_velocity, wet.bodies, wet.added_mass("link_2")]


ANSWERS = answers()


def test_there_are_many_answers() -> None:
    assert {"a5.parameters", "a5.published"} <= {
        n.replace("alpha5_model", "a5") for n in ANSWERS
    }
    assert len([*arrays(a5.parameters())]) > 15


@pytest.mark.parametrize("name", ANSWERS)
def test_what_two_answers_share_cannot_be_written(name: str) -> None:
    function = ANSWERS[name]
    assert shared(function(), function()) == []


@pytest.mark.parametrize("name", ["_compiled", "numpy_kernels"])
def test_solutions_share_nothing_that_can_be_written(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if name == "_compiled":
        pytest.importorskip("alpha5_model.kernels._compiled", exc_type=ImportError)
    chosen = import_module(f"alpha5_model.kernels.{name}")
    monkeypatch.setattr(kernels, "module", lambda: chosen)
    far, near = (9.0, 0.0, 0.0), (0.2, 0.1, 0.1)
    for target in (far, near):
        one = a5.inverse_kinematics(target)
        assert shared(one, a5.inverse_kinematics(target)) == []
    assert not a5.inverse_kinematics(far).exists.any()
    for _, call in kinematics_calls():
        first, second = (call.function(**call.arrays, **call.others) for _ in range(2))
        given = [*call.arrays.values()]
        assert [x for x in shared(first, second) if not shared(x, given)] == []


def test_frozen_arrays_stay_frozen() -> None:
    for given in ([1.0, 2.0], np.zeros((0, 3)), 3.0, np.arange(6.0).reshape(2, 3).T):
        array = checks.frozen(given)
        assert np.array_equal(array, given)
        assert array.shape == np.shape(given)
        assert array.flags.aligned
        assert not unlocked(array)
    assert dataclasses.is_dataclass(a5.parameters().links[0])
    assert not unlocked(a5.parameters().links[2].inertia)
