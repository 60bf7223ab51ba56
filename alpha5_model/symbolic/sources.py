"""The files that are generated from the equations and committed."""

from __future__ import annotations

from functools import cache

from alpha5_model.symbolic import c_source, functions
from alpha5_model.symbolic.javascript import javascript
from alpha5_model.symbolic.numpy_source import python_source
from alpha5_model.symbolic.products import products
from alpha5_model.symbolic.program import program


@cache
def generated_sources() -> dict[str, str]:
    """Path in the repository -> text; the same every time."""
    known = functions()
    programs = [program(function) for function in known.values()]
    more = [program(f) for name, f in products().items() if known.get(name) is not f]
    files = {"formulas.py": python_source(programs), "products.py": python_source(more)}
    files |= c_source.kernels(programs)
    made = {f"alpha5_model/kernels/generated/{name}": text for name, text in files.items()}
    return {**made, "alpha5_model/view/formulas.js": javascript()}
