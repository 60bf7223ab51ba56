"""The files that are generated from the equations and committed."""

from __future__ import annotations

from functools import cache

from alpha5_model.symbolic import functions
from alpha5_model.symbolic.numpy_source import python_source
from alpha5_model.symbolic.program import program


@cache
def generated_sources() -> dict[str, str]:
    """Path in the repository -> text; the same every time."""
    programs = [program(function) for function in functions().values()]
    return {"alpha5_model/kernels/generated/formulas.py": python_source(programs)}
