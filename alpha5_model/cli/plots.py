"""Pictures of diagrams that commands write."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from alpha5_model.viewer import figures

_DOTS_PER_INCH = 150


def write_plot(page: Any, path: Path) -> None:
    """Write a figure of matplotlib.

    Raises:
        OutputError: The file cannot be written.
    """
    figures.write_figure(page, path, dpi=_DOTS_PER_INCH)
