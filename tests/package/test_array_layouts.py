"""Arrays from files, buffers and records give the same bits as NumPy's own arrays.

A batch once returned uninitialized memory if the numbers of an array had odd addresses.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable, Iterator
from importlib import import_module
from itertools import count
from pathlib import Path
from typing import Any

import jax
import numpy as np
import pytest
from array_functions import (
    NOT_CALLED,
    Call,
    arm_calls,
    jax_calls,
    kinematics_calls,
    left_out,
    short,
    taking_arrays,
    theory_calls,
)

import alpha5_model as a5
from alpha5_model.codegen.kernels import choice as kernels
from alpha5_model.dynamics.regression import regressor_rows
from alpha5_model.errors import KernelError


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


def bits(value: Any) -> Iterator[bytes]:
    """All numbers of an answer."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        for field in dataclasses.fields(value):
            yield from bits(getattr(value, field.name))
    elif isinstance(value, dict):
        yield from bits([*value.values()])
    elif hasattr(value, "homogeneous") or hasattr(value, "vector"):
        yield from bits(
            value.homogeneous if hasattr(value, "homogeneous") else value.vector
        )
    elif isinstance(value, str) or value is None:
        yield str(value).encode()
    elif isinstance(value, list | tuple) or type(value).__name__.startswith("StdVec"):
        for one in value:
            yield from bits(one)
    else:
        array = np.asarray(value)
        assert array.dtype != object, f"{type(value)} holds unknown numbers"
        yield array.tobytes()


def differing(calls: list[tuple[str, Call]], folder: Path) -> list[str]:
    """Names and layouts whose answers have other bits than those of plain arrays."""
    layouts = {**LAYOUTS, "mapped": lambda x: mapped(x, folder)}
    wrong = []
    for name, call in calls:
        wanted = [*bits(call.function(**call.arrays, **call.others))]
        assert wanted, name
        for layout, changed in layouts.items():
            arrays = {
                key: changed(np.ascontiguousarray(x)) for key, x in call.arrays.items()
            }
            got = [*bits(call.function(**arrays, **call.others))]
            if got != wanted:
                wrong.append(f"{name}: {layout}")
    return wrong


@pytest.fixture(params=["_compiled", "numpy_kernels"])
def kernel_module(
    request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch
) -> Any:
    if request.param == "_compiled":
        pytest.importorskip(
            "alpha5_model.codegen.kernels._compiled", exc_type=ImportError
        )
    chosen = import_module(f"alpha5_model.codegen.kernels.{request.param}")
    monkeypatch.setattr(kernels, "module", lambda: chosen)
    return chosen


@pytest.mark.slow
@pytest.mark.usefixtures("kernel_module")
def test_dynamics_give_the_same_bits(tmp_path: Path) -> None:
    assert differing(arm_calls(), tmp_path) == []


@pytest.mark.usefixtures("kernel_module")
def test_kinematics_give_the_same_bits(tmp_path: Path) -> None:
    assert differing(kinematics_calls(), tmp_path) == []


@pytest.mark.slow
def test_theory_gives_the_same_bits(tmp_path: Path) -> None:
    assert differing(theory_calls(), tmp_path) == []


@pytest.mark.slow
def test_jax_gives_the_same_bits(tmp_path: Path) -> None:
    with jax.enable_x64(True):
        assert differing(jax_calls(), tmp_path) == []


def test_every_public_function_of_arrays_is_called() -> None:
    called = {
        short(name) for name, _ in arm_calls() + kinematics_calls() + theory_calls()
    }
    called |= {short(name) for name, _ in jax_calls()}
    taking = taking_arrays()
    assert len(taking) > 150
    missing = [
        name for name in taking if short(name) not in called and not left_out(name)
    ]
    assert missing == [], "add a call of it to array_functions.py"
    assert set(NOT_CALLED) - {"ArmVisualizer"} <= {short(name) for name in taking}
    batches = [name for name in called if name.endswith("_batch")]
    assert len(batches) == 9  # of three classes


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
    arm = a5.load(backend="kernels")
    q = np.ones((40, 4))
    out = np.empty((40, 4))
    parameters = arm._kernel_parameters
    kernels.compute("inverse_dynamics", parameters, q, q, q, out)
    assert np.array_equal(out, arm.inverse_dynamics_batch(q, q, q))
    for place in range(4):
        arrays = [q, q, q, np.empty((40, 4))]
        arrays[place] = shifted(arrays[place])
        with pytest.raises(KernelError, match="inverse_dynamics takes only aligned"):
            kernels.compute("inverse_dynamics", parameters, *arrays)
    with pytest.raises(KernelError):
        regressor_rows(q, shifted(q), q, np.zeros(3), parameters[41:])


def test_only_one_place_runs_batches() -> None:
    root = Path(a5.__file__).parent
    users = [
        p
        for p in root.rglob("*.py")
        if re.search(r"\.batch\(|\)\.batch\b", p.read_text("utf-8"))
    ]
    assert users == [root / "codegen" / "kernels" / "choice.py"]
