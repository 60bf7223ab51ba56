"""Figures of matplotlib that no window shows: their style, what they share, how they become files."""

from __future__ import annotations

import io
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.errors import MissingDependencyError
from alpha5_model.files import atomic_write, output_format

FORMATS = (".png", ".pdf", ".svg")
_STYLE: dict[Any, Any] = {
    "axes.axisbelow": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlesize": 10,
    "legend.frameon": False,
}


class Color(StrEnum):
    """Okabe and Ito's colours, told apart by colour-blind readers as well."""

    BLACK = "#222222"
    ORANGE = "#E69F00"
    SKY = "#56B4E9"
    GREEN = "#009E73"
    BLUE = "#0072B2"
    VERMILION = "#D55E00"
    PINK = "#CC79A7"


@contextmanager
def _matplotlib() -> Iterator[None]:
    try:
        yield
    except ImportError:
        raise MissingDependencyError(
            "matplotlib", "a picture", "pip install 'alpha5-model[plot]'"
        ) from None


@contextmanager
def style(changes: Mapping[Any, Any] | None = None) -> Iterator[None]:
    """The figures' common settings of matplotlib with some changes; also a decorator.

    Raises:
        MissingDependencyError: matplotlib is not installed.
    """
    with _matplotlib():
        from matplotlib import rc_context
    with rc_context({**_STYLE, **(changes or {})}):
        yield


def new_figure(width: float, height: float) -> Any:
    """A matplotlib Figure that no window or global state knows of; sizes in inches.

    Raises:
        MissingDependencyError: matplotlib is not installed.
    """
    with _matplotlib():
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def write_figure(figure: Any, path: str | os.PathLike[str], dpi: int) -> Path:
    """Write a figure; the suffix says how: one of `FORMATS`, PNG for ``-``, devices and pipes.

    Raises:
        UnknownNameError: Another suffix.
        OutputError: It cannot be written; nothing is left half-written.
    """
    suffix = output_format("picture format", path, FORMATS)
    buffer = io.BytesIO()
    figure.savefig(buffer, format=suffix[1:], dpi=dpi)
    return atomic_write(path, buffer.getvalue())


def joined(
    lines: Iterable[FloatArray], gap: Callable[[FloatArray, FloatArray], float]
) -> list[FloatArray]:
    """Put lines (N, 2) end to end, each time the one with the smallest gap, until a loop closes.

    Args:
        lines: Each in the sense in which the loop runs.
        gap: Distance from the end of one line to the start of the next.
    """
    rest, loops = list(lines), []
    while rest:
        loop = [rest.pop(0)]
        while rest:
            gaps = [gap(loop[-1][-1], line[0]) for line in rest]
            nearest = int(np.argmin(gaps))
            if gap(loop[-1][-1], loop[0][0]) <= gaps[nearest]:
                break
            loop.append(rest.pop(nearest))
        loops.append(np.concatenate(loop))
    return loops


def fill(axes: Any, loops: Iterable[FloatArray], color: str, **options: Any) -> None:
    """Fill what loops (N, 2) bound; the ones that run the other way around are holes."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Outline

    outlines = [Outline(np.vstack([loop, loop[:1]]), closed=True) for loop in loops]
    if outlines:
        whole = Outline.make_compound_path(*outlines)
        axes.add_patch(PathPatch(whole, facecolor=color, linewidth=0, **options))


def legend(axes: Any, drop: float, **options: Any) -> None:
    """A legend under the axes, ``drop`` of their height below them, each label once."""
    unique = {
        label: handle for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    axes.legend(
        unique.values(), unique.keys(), loc="upper center", bbox_to_anchor=(0.5, -drop), **options
    )
