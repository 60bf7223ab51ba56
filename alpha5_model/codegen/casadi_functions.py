"""CasADi Functions made of expressions, and of other Functions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import casadi


def named(
    name: str, inputs: Mapping[str, casadi.SX], outputs: Mapping[str, casadi.SX]
) -> casadi.Function:
    """A Function with dense outputs, of those inputs that they depend on."""
    dense = [casadi.densify(out) for out in outputs.values()]
    needed = _symbols(casadi.veccat(*dense))
    used = {}
    for key, symbol in inputs.items():
        if needed & _symbols(symbol):
            used[key] = symbol
    return casadi.Function(
        name,
        list(used.values()),
        dense,
        list(used),
        list(outputs),
    )


def _symbols(expression: casadi.SX) -> set[str]:
    return {str(symbol) for symbol in casadi.symvar(expression)}


def folded(function: casadi.Function, **values: Any) -> casadi.Function:
    """The same Function with numbers in place of some inputs.

    This saves operations.
    """
    free = {}
    given: list[Any] = []
    for name in function.name_in():
        if name in values:
            given.append(casadi.DM(values[name]))
        else:
            free[name] = casadi.SX.sym(name, function.sparsity_in(name))
            given.append(free[name])

    outputs = [casadi.densify(out) for out in function.call(given)]
    return casadi.Function(
        function.name(),
        list(free.values()),
        outputs,
        list(free),
        function.name_out(),
    )
