"""Arrays from files, buffers and records give the answers of NumPy's own arrays.

A batch once returned uninitialized memory if the numbers of an array had odd addresses.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from importlib import import_module
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from array_functions import (
    Call,
    arm_calls,
    jax_calls,
    kinematics_calls,
    theory_calls,
)

import alpha5_model as a5
from alpha5_model.dynamics.regression import regressor_rows
from alpha5_model.errors import KernelError
from alpha5_model.kernels import choice as kernels


def shifted(x: np.ndarray) -> np.ndarray:
    """At an address that is no multiple of 8."""
    memory = np.zeros(x.nbytes + 16, np.uint8)
    out = memory[4 : 4 + x.nbytes].view(np.float64).reshape(x.shape)
    out[...] = x
    return out


def from_buffer(x: np.ndarray) -> np.ndarray:
    """Read-only, behind a header of 12 bytes."""
    return np.frombuffer(b"header 12 by" + x.tobytes(), offset=12).reshape(x.shape)


_NUMBER = count()


def mapped(x: np.ndarray, folder: Path) -> np.ndarray:
    """The same, in a file."""
    path = folder / f"{next(_NUMBER)}.bin"
    path.write_bytes(b"header 12 by" + x.tobytes())
    return np.memmap(path, "f8", mode="r", offset=12, shape=x.shape)


def of_records(x: np.ndarray) -> np.ndarray:
    """A field of packed records, one for each row."""
    records = np.zeros(
        x.shape[:1], [("tag", "u1"), ("x", "f8", x.shape[1:]), ("more", "f4")]
    )
    records["x"] = x
    return records["x"]


def backwards(x: np.ndarray) -> np.ndarray:
    """Of negative strides."""
    return np.flip(np.flip(x).copy())


def spread(x: np.ndarray) -> np.ndarray:
    """Every other number of a larger array."""
    wide = np.zeros([2 * n for n in x.shape])
    view = wide[tuple(slice(None, None, 2) for _ in x.shape)]
    view[...] = x
    return view


def locked(x: np.ndarray) -> np.ndarray:
    """Read-only."""
    out = x.copy()
    out.flags.writeable = False
    return out


LAYOUTS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "shifted": shifted,
    "buffer": from_buffer,
    "records": of_records,
    "swapped": lambda x: x.astype(">f8"),
    "backwards": backwards,
    "spread": spread,
    "Fortran": np.asfortranarray,
    "read-only": locked,
}


def numbers(value: Any) -> Iterator[np.ndarray]:
    """All numbers of an answer."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        for field in dataclasses.fields(value):
            yield from numbers(getattr(value, field.name))
    elif isinstance(value, dict):
        yield from numbers([*value.values()])
    elif hasattr(value, "homogeneous"):
        yield value.homogeneous
    elif hasattr(value, "vector"):
        yield value.vector
    elif isinstance(value, str) or value is None:
        return
    elif isinstance(value, list | tuple) or type(value).__name__.startswith("StdVec"):
        for one in value:
            yield from numbers(one)
    else:
        array = np.asarray(value)
        assert array.dtype != object, f"{type(value)} holds unknown numbers"
        yield array


def same(one: Any, other: Any) -> bool:
    """Whether two answers have the same numbers, but for their last digits."""
    ours = [*numbers(one)]
    theirs = [*numbers(other)]
    return len(ours) == len(theirs) and all(
        x.shape == y.shape and np.allclose(x, y, rtol=1e-11, atol=1e-12, equal_nan=True)
        for x, y in zip(ours, theirs, strict=True)
    )


def differing(calls: list[tuple[str, Call]], folder: Path) -> list[str]:
    """Names and layouts whose answers differ from those of plain arrays."""
    layouts = {**LAYOUTS, "mapped": lambda x: mapped(x, folder)}
    wrong = []
    for name, call in calls:
        wanted = call.function(**call.arrays, **call.others)
        for layout, changed in layouts.items():
            arrays = {
                key: changed(np.ascontiguousarray(x)) for key, x in call.arrays.items()
            }
            if not same(call.function(**arrays, **call.others), wanted):
                wrong.append(f"{name}: {layout}")
    return wrong


@pytest.fixture(params=["_compiled", "numpy_kernels"])
def kernel_module(
    request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch
) -> Any:
    if request.param == "_compiled":
        pytest.importorskip(
            "alpha5_model.kernels._compiled",
            reason="the kernels are not compiled here",
            exc_type=ImportError,
        )
    chosen = import_module(f"alpha5_model.kernels.{request.param}")
    monkeypatch.setattr(kernels, "module", lambda: chosen)
    return chosen


@pytest.mark.usefixtures("kernel_module")
def test_batches_of_any_layout(tmp_path: Path) -> None:
    """The functions of many rows, which hand arrays to the kernels."""
    arm = a5.load()
    q, v, a = np.random.default_rng(3).normal(size=(3, 70, 4))
    state = {"q": q, "v": v, "a": a}
    calls = [
        ("inverse_dynamics_batch", Call(arm.inverse_dynamics_batch, state, {})),
        ("base_wrench_batch", Call(arm.base_wrench_batch, state, {})),
        ("inverse_kinematics", Call(a5.inverse_kinematics, {"position": q[:, :3]}, {})),
    ]
    assert differing(calls, tmp_path) == []


@pytest.mark.slow
@pytest.mark.usefixtures("kernel_module")
def test_all_functions_of_arms(tmp_path: Path) -> None:
    assert differing(arm_calls(), tmp_path) == []


@pytest.mark.slow
@pytest.mark.usefixtures("kernel_module")
def test_all_functions_of_kinematics(tmp_path: Path) -> None:
    assert differing(kinematics_calls(), tmp_path) == []


#: Searches from sampled starts: last digits of their input may lead elsewhere.
SEARCHES = ("plan_poses", "plan")


@pytest.mark.slow
def test_all_functions_of_theory(tmp_path: Path) -> None:
    calls = [call for call in theory_calls() if call[0] not in SEARCHES]
    assert differing(calls, tmp_path) == []


@pytest.mark.tools
def test_all_functions_of_jax(tmp_path: Path) -> None:
    jax = pytest.importorskip("jax")
    with jax.enable_x64(True):
        assert differing(jax_calls(), tmp_path) == []


def test_another_answer_is_seen(tmp_path: Path) -> None:
    """A function that reads memory as it lies sees another array."""
    x = np.arange(12.0).reshape(3, 4)

    def as_it_lies(x: np.ndarray) -> np.ndarray:
        return np.ravel(x, order="K")

    wrong = differing([("f", Call(as_it_lies, {"x": x}, {}))], tmp_path)
    assert "f: Fortran" in wrong
    assert "f: shifted" not in wrong


def test_layouts_are_what_they_are_called(tmp_path: Path) -> None:
    x = np.arange(12.0).reshape(3, 4)
    arrays = {name: change(x) for name, change in LAYOUTS.items()} | {
        "mapped": mapped(x, tmp_path)
    }
    assert all(np.array_equal(y, x) for y in arrays.values())
    odd = {name for name, y in arrays.items() if not y.flags.aligned}
    assert odd == {"shifted", "buffer", "records", "mapped"}
    assert min(arrays["backwards"].strides) < 0
    assert not arrays["swapped"].dtype.isnative


def test_a_kernel_that_computes_nothing_raises(kernel_module: Any) -> None:
    arm = a5.load()
    q = np.ones((40, 4))
    parameters = arm._kernel_parameters
    (out,) = kernel_module.rows("inverse_dynamics", parameters, q, q, q)
    assert np.array_equal(out, arm.inverse_dynamics_batch(q, q, q))
    for place in range(3):
        arrays = [q, q, q]
        arrays[place] = shifted(q)
        with pytest.raises(KernelError):
            kernel_module.rows("inverse_dynamics", parameters, *arrays)
    with pytest.raises(KernelError):
        regressor_rows(q, shifted(q), q, np.zeros(3), parameters[41:])
