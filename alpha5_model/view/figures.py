"""Figures of matplotlib that no window shows, and how they become files."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import Any

from alpha5_model.errors import MissingDependencyError
from alpha5_model.files import atomic_write, output_format

FORMATS = (".png", ".pdf", ".svg")


def new_figure(width: float, height: float) -> Any:
    """A matplotlib Figure that no window or global state knows of; sizes in inches.

    Raises:
        MissingDependencyError: matplotlib is not installed.
    """
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingDependencyError(
            "matplotlib", "a picture", "pip install 'alpha5-model[plot]'"
        ) from None
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def check_format(path: str | os.PathLike[str]) -> str:
    """The suffix of a picture's path, one of `FORMATS`; that of PNG for ``-``, devices and pipes.

    Raises:
        UnknownNameError: Another suffix.
    """
    return output_format("picture format", path, FORMATS)


def write_figure(figure: Any, path: str | os.PathLike[str], dpi: int) -> Path:
    """Write a figure; the suffix says how: one of `FORMATS`.

    Raises:
        UnknownNameError: Another suffix.
        OutputError: It cannot be written; nothing is left half-written.
    """
    suffix = check_format(path)
    buffer = io.BytesIO()
    figure.savefig(buffer, format=suffix[1:], dpi=dpi)
    return atomic_write(path, buffer.getvalue())
