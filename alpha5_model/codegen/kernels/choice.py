"""The generated formulas, ready to run: compiled for single states and batches, or in NumPy.

``ALPHA5_KERNELS=numpy`` or ``compiled`` forces one; without it the compiled ones are taken where they
are installed. Both offer `bind` and `batch` for the functions of `alpha5_model.codegen`, by name,
with the same results to rounding and the same answers to unfit numbers: None and False, upon which
the caller says what is wrong.

A checkout that is not installed compiles in place with ``python hatch_build.py``, once and after each
change of a generated or C file.
"""

from __future__ import annotations

import os
from functools import cache
from importlib import import_module
from typing import Any

from alpha5_model._support.checks import FloatArray, choice
from alpha5_model.errors import KernelError, MissingDependencyError

_MODULES = {"compiled": "_compiled", "numpy": "numpy_kernels"}


@cache
def module() -> Any:
    """The module with ``bind(name, parameters)`` and ``batch(name, parameters, *inputs, *outputs)``.

    ``bind`` returns a function that keeps the constants of its parameters, takes the kernel's inputs
    and returns a new array, or a tuple of them where there are several outputs. Where an input is not a
    C-contiguous float64 array of the right shape with finite numbers of at most `LARGEST`, it returns
    what a third argument makes of them, whose name, signature and documentation it has; None without
    one. ``is_state(nq, nv, q, *rates)`` asks just that of arrays (nq,), (nv,), ...

    ``batch`` takes arrays with one state in each row, inputs also with one row for all by
    `numpy.broadcast_to`, and writes the outputs; False, and nothing in them to rely on, in the same
    cases. Threads that compute at the same time do not wait for each other. Signals are answered
    every few hundredths of a second, so that Ctrl-C ends a batch.

    Raises:
        UnknownNameError: ``ALPHA5_KERNELS`` is neither numpy nor compiled.
        MissingDependencyError: It is compiled, and they are not installed.
    """
    wanted = os.environ.get("ALPHA5_KERNELS") or None
    if wanted is not None:
        choice("ALPHA5_KERNELS", wanted, tuple(_MODULES))
    for name in (wanted,) if wanted else _MODULES:
        try:
            return import_module(f"alpha5_model.codegen.kernels.{_MODULES[name]}")
        except ImportError:
            continue
    remedy = "install alpha5-model where a C compiler is, or compile with python hatch_build.py"
    wanted = "ALPHA5_KERNELS=compiled"
    raise MissingDependencyError(
        "alpha5_model.codegen.kernels._compiled", wanted, remedy
    )


def compute(name: str, parameters: FloatArray, *arrays: FloatArray) -> None:
    """Run a kernel over rows: inputs, then outputs, as `module`'s ``batch`` takes them.

    Nothing else calls ``batch``, so that no output is handed on which was not written.

    Raises:
        KernelError: It computed nothing. The outputs hold nothing to rely on.
    """
    if not module().batch(name, parameters, *arrays):
        raise KernelError(name)


def backend() -> str:
    """Which kernels run: "compiled (avx512)", "(avx2)", "(sse2)", "(neon)", "(scalar)" or "numpy"."""
    running = module()
    return f"compiled ({running.width(0)})" if hasattr(running, "width") else "numpy"
