"""Which kernels run: the generated formulas, compiled or in NumPy.

The compiled kernels run if they are installed; ``ALPHA5_KERNELS=numpy`` or
``compiled`` forces a choice. Both compute the same, to rounding.

A checkout that is not installed compiles in place with ``python hatch_build.py``.
"""

from __future__ import annotations

import hashlib
import os
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

from alpha5_model._support.checks import FloatArray, choice
from alpha5_model.errors import MissingDependencyError

_MODULES = {
    "compiled": "alpha5_model.kernels._compiled",
    "numpy": "alpha5_model.kernels.numpy_kernels",
}


@cache
def module() -> Any:
    """The module of the kernels, with ``rows`` and ``is_state``.

    ``is_state(nq, nv, q, *rates)`` says whether arrays are plain C-contiguous float64
    (nq,), (nv,), ... of finite numbers of at most `LARGEST`, and joint positions of at
    most two turns.

    Raises:
        UnknownNameError: ``ALPHA5_KERNELS`` is neither numpy nor compiled.
        MissingDependencyError: It is compiled, and they are not installed; or they were
            compiled of other sources.
    """
    wanted = os.environ.get("ALPHA5_KERNELS")
    candidates = tuple(_MODULES)
    if wanted:
        candidates = (choice("ALPHA5_KERNELS", wanted, candidates),)

    for name in candidates:
        try:
            found = import_module(_MODULES[name])
        except ImportError:
            continue
        if name == "compiled":
            _check_sources(found.SOURCES)
        return found
    raise MissingDependencyError(
        _MODULES["compiled"],
        "ALPHA5_KERNELS=compiled",
        "install alpha5-model where a C compiler is, "
        "or compile with python hatch_build.py",
    )


def _check_sources(made_of: str) -> None:
    """Check that the compiled module belongs to the sources beside it.

    Raises:
        MissingDependencyError: It was compiled of others, which `git pull` replaced.
    """
    files = sorted(Path(__file__).parent.rglob("*.[ch]"))
    digest = hashlib.sha256(b"".join(file.read_bytes() for file in files))
    if digest.hexdigest() != made_of.split()[0]:
        raise MissingDependencyError(
            "compiled kernels of the present sources",
            "alpha5_model",
            "compile again: python hatch_build.py",
        )


def rows(
    name: str, parameters: FloatArray, *inputs: FloatArray
) -> tuple[FloatArray, ...]:
    """A kernel for each row of its inputs.

    Threads that compute at the same time do not wait for each other, and Ctrl-C ends a
    batch.

    Args:
        name: Of a kernel, see `alpha5_model.codegen.sources`.
        parameters: What all rows have in common, float64.
        inputs: C-contiguous float64, one state in each row; or one row for all, by
            `numpy.broadcast_to`.

    Returns:
        An array for each output, with a row for each state.

    Raises:
        KernelError: No such kernel, or an input that it cannot compute with: of another
            size or type, not finite, or above `LARGEST`.
    """
    outputs: tuple[FloatArray, ...] = module().rows(name, parameters, *inputs)
    return outputs


def backend() -> str:
    """Which kernels compute batches, inverse kinematics and self-collision here.

    Returns:
        "compiled" or "numpy".
    """
    return "compiled" if hasattr(module(), "scene") else "numpy"
