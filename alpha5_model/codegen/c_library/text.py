"""Templates of the C library's files, and numbers in C."""

from __future__ import annotations

from pathlib import Path
from string import Template
from typing import Any

import numpy as np

from alpha5_model.codegen.dialects import constant


def template(name: str, **values: Any) -> str:
    """A file in ``templates/``; values, if given, replace its ``$names``."""
    path = Path(__file__).with_name("templates") / name
    text = path.read_text(encoding="utf-8")
    return Template(text).substitute(values) if values else text


def numbers(values: Any, real: str) -> str:
    """A number, or an array or struct in braces."""
    if isinstance(values, list | tuple | np.ndarray):
        elements = ", ".join(numbers(value, real) for value in values)
        return f"{{{elements}}}"
    return constant(float(values), real)
