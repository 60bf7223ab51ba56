"""Matplotlib figures without a window: their style, colours, numbers and files."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from enum import StrEnum
from pathlib import Path
from typing import Any

from alpha5_model._support.files import PathLike
from alpha5_model._support.outputs import output_format
from alpha5_model._support.writing import atomic_write
from alpha5_model.errors import needing

#: Suffixes of the files that `write_figure` writes.
FORMATS = (".png", ".pdf", ".svg")


class Color(StrEnum):
    """Okabe and Ito's colours, which colour-blind readers can tell apart."""

    BLACK = "#222222"
    ORANGE = "#E69F00"
    SKY = "#56B4E9"
    GREEN = "#009E73"
    BLUE = "#0072B2"
    VERMILION = "#D55E00"
    PINK = "#CC79A7"


#: Terms of the torque and their colours; the first are drawn widest, so that none hides
#: another.
CAUSES = {
    "weight": Color.ORANGE,
    "buoyancy": Color.SKY,
    "inertia": Color.PINK,
    "coriolis": Color.GREEN,
    "moving_water": Color.BLUE,
}


@contextmanager
def style(**changes: Mapping[str, Any]) -> Iterator[None]:
    """The figures' common settings of matplotlib with some changes; also a decorator.

    Args:
        changes: Settings by group, as matplotlib's ``rc`` takes them: ``axes={"grid":
            True}``.

    Raises:
        MissingDependencyError: matplotlib is not installed.
    """
    with _needing_matplotlib():
        from matplotlib import rc_context
    settings: Any = {}
    for group, values in changes.items():
        settings |= {f"{group}.{name}": value for name, value in values.items()}
    with rc_context(settings, Path(__file__).with_suffix(".mplstyle")):
        yield


def new_figure(width: float, height: float) -> Any:
    """A matplotlib Figure outside of pyplot's global state; width and height in inches.

    Raises:
        MissingDependencyError: matplotlib is not installed.
    """
    with _needing_matplotlib():
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    figure = Figure(figsize=(width, height), layout="constrained")
    return FigureCanvasAgg(figure).figure


def _needing_matplotlib() -> AbstractContextManager[None]:
    return needing("a picture", "pip install 'alpha5-model[plot]'", "matplotlib")


def write_figure(figure: Any, path: PathLike, dpi: int = 150) -> Path:
    """Write a figure in the format of the suffix, one of `FORMATS`.

    Standard output (``-``), devices and pipes get PNG.

    Raises:
        UnknownNameError: Another suffix.
        OutputError: It cannot be written; nothing is left half-written.
    """
    suffix = output_format("picture format", path, FORMATS)
    buffer = io.BytesIO()
    figure.savefig(buffer, format=suffix[1:], dpi=dpi)
    return atomic_write(path, buffer.getvalue())


def number(value: float) -> str:
    """Three digits, a power of ten only if they do not suffice, a true minus sign."""
    rounded = float(f"{value:.3g}")
    return with_minus_signs(f"{rounded:.7g}")


def with_minus_signs(text: str) -> str:
    """The text with true minus signs in place of hyphens."""
    return text.replace("-", "\u2212")
