"""Figures of matplotlib that no window shows, and how they become files."""

from __future__ import annotations

import io
import math
import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray
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


def joined(
    lines: Iterable[FloatArray], gap: Callable[[FloatArray, FloatArray], float] = math.dist
) -> list[FloatArray]:
    """Lines (N, 2) put end to end, each next to the one that ``gap`` calls nearest: closed outlines."""
    rest, loops = list(lines), []
    while rest:
        loop = [rest.pop(0)]
        while rest:
            gaps = [gap(loop[-1][-1], line[0]) for line in rest]
            if gap(loop[-1][-1], loop[0][0]) <= min(gaps):
                break
            loop.append(rest.pop(gaps.index(min(gaps))))
        points = np.concatenate(loop)
        loops.append(np.vstack([points, points[:1]]))
    return loops


def fill(axes: Any, loops: Iterable[FloatArray], **style: Any) -> None:
    """Fill outlines, (N, 2); those that run the other way round are holes and stay open."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Outline

    outlines = [Outline(loop, closed=True) for loop in loops]
    if outlines:
        axes.add_patch(PathPatch(Outline.make_compound_path(*outlines), **style))


def tidy(axes: Any, **grid: Any) -> None:
    """No frame above and to the right; a grid behind everything, if its style is given."""
    axes.spines[["top", "right"]].set_visible(False)
    if grid:
        axes.grid(**grid)
        axes.set_axisbelow(True)


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
