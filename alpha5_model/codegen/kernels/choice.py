"""Which kernels run: the generated formulas, compiled or in NumPy.

The compiled kernels run if they are installed; ``ALPHA5_KERNELS=numpy`` or
``compiled`` forces a choice. Both offer `bind` and `batch` for the functions of
`alpha5_model.codegen`, by name, with the same results to rounding. Both answer None or
False to numbers that they cannot compute with; the caller then says what is wrong.

A checkout that is not installed compiles in place with ``python hatch_build.py``, once
and after each change of a generated or C file.
"""

from __future__ import annotations

import os
from functools import cache
from importlib import import_module
from typing import Any

from alpha5_model._support.checks import FloatArray, choice
from alpha5_model.errors import KernelError, MissingDependencyError

_MODULES = {
    "compiled": "alpha5_model.codegen.kernels._compiled",
    "numpy": "alpha5_model.codegen.kernels.numpy_kernels",
}


@cache
def module() -> Any:
    """The module of the kernels, with ``bind``, ``batch`` and ``is_state``.

    ``bind(name, parameters)`` returns a function that keeps the constants of its
    parameters, takes the kernel's inputs and returns a new array, or a tuple of them if
    there are several outputs. If an input is not a C-contiguous float64 array of the
    right shape with finite numbers of at most `LARGEST`, it returns what a third
    argument makes of the inputs, whose name, signature and documentation it has; None
    without one. ``is_state(nq, nv, q, *rates)`` checks the same of arrays (nq,), (nv,),
    ...

    ``batch(name, parameters, *arrays)`` takes inputs, then outputs, with one state in
    each row; inputs may also be one row for all by `numpy.broadcast_to`. It writes the
    outputs and returns True. In the same cases as above it returns False, and the
    outputs hold nothing to rely on. Threads that compute at the same time do not wait
    for each other. Signals are answered every few hundredths of a second, so that
    Ctrl-C ends a batch.

    Raises:
        UnknownNameError: ``ALPHA5_KERNELS`` is neither numpy nor compiled.
        MissingDependencyError: It is compiled, and they are not installed.
    """
    wanted = os.environ.get("ALPHA5_KERNELS")
    candidates = tuple(_MODULES)
    if wanted:
        candidates = (choice("ALPHA5_KERNELS", wanted, candidates),)

    for name in candidates:
        try:
            return import_module(_MODULES[name])
        except ImportError:
            continue
    raise MissingDependencyError(
        _MODULES["compiled"],
        "ALPHA5_KERNELS=compiled",
        "install alpha5-model where a C compiler is, "
        "or compile with python hatch_build.py",
    )


def compute(name: str, parameters: FloatArray, *arrays: FloatArray) -> None:
    """Run a kernel over rows: inputs, then outputs, as `module`'s ``batch`` takes them.

    Nothing else calls ``batch``, so that no output is handed on that was not written.

    Raises:
        KernelError: It computed nothing. The outputs hold nothing to rely on.
    """
    if not module().batch(name, parameters, *arrays):
        raise KernelError(name)


def backend() -> str:
    """Which kernels compute batches, inverse kinematics and self-collision here.

    Returns:
        "compiled (avx512)", "(avx2)", "(sse2)", "(neon)" or "(scalar)", or "numpy".
    """
    running = module()
    return f"compiled ({running.width(0)})" if hasattr(running, "width") else "numpy"
