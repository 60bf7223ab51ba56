"""The files that are generated from the equations and committed."""

from __future__ import annotations

from functools import cache

from alpha5_model.symbolic import c_source, functions
from alpha5_model.symbolic.numpy_source import python_source
from alpha5_model.symbolic.program import program


@cache
def generated_sources() -> dict[str, str]:
    """Path in the repository -> text; the same every time."""
    programs = [program(function) for function in functions().values()]
    files = {"formulas.py": python_source(programs), **c_source.kernels(programs)}
    return {f"alpha5_model/kernels/generated/{name}": text for name, text in files.items()}
