"""Records, arrays and figures as lines of text, for snapshots that you can read."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

#: Longer arrays are described by sums.
SHORT = 16


def described(name: str, value: Any, depth: int = 2) -> Iterator[str]:
    """Lines of a value: one for each of its parts down to a depth."""
    parts = _parts(value)
    if depth and parts is not None:
        for key, part in parts.items():
            yield from described(f"{name}.{key}", part, depth - 1)
    else:
        yield f"{name}: {inline(value)}"


def inline(value: Any) -> str:
    """A value within a line."""
    parts = _parts(value)
    if parts is not None:
        inner = " ".join(f"{key}={inline(part)}" for key, part in parts.items())
        return f"{{{inner}}}"
    if isinstance(value, np.ndarray):
        return array(value)
    if isinstance(value, list | tuple):
        return array(np.array(value))
    return number(value) if isinstance(value, float) else repr(value)


def _parts(value: Any) -> dict[str, Any] | None:
    """Fields of a record, values of a mapping, elements of a list of parts."""
    if dataclasses.is_dataclass(value):
        return {f.name: getattr(value, f.name) for f in dataclasses.fields(value)}
    if hasattr(value, "_asdict"):
        return dict(value._asdict())
    if isinstance(value, Mapping):
        return {str(key): part for key, part in value.items()}
    if isinstance(value, list | tuple) and not _only_numbers(value):
        return {str(number): part for number, part in enumerate(value)}
    return None


def _only_numbers(values: list[Any] | tuple[Any, ...]) -> bool:
    return all(isinstance(value, int | float) for value in values)


def number(value: float) -> str:
    """Six digits, none beyond 1e-7: a machine's rounding does not show."""
    return f"{round(float(value), 7) + 0.0:.6g}"


def array(values: np.ndarray) -> str:
    """The elements; of a long array its shape, its sum and a weighted sum."""
    if values.dtype.kind not in "fiub":
        return repr(values.tolist())
    flat = values.astype(np.float64).ravel()
    if len(flat) <= SHORT:
        return f"{values.shape} {' '.join(map(number, flat))}"
    # Weights that tell any two places apart.
    weighted = flat @ np.cos(np.arange(len(flat)))
    return f"{values.shape} sums {number(np.nansum(flat))} {number(weighted)}"


def figure(page: Any) -> Iterator[str]:
    """Lines of a matplotlib figure: size, and each axes with what is drawn in it."""
    page.canvas.draw()
    yield f"size: {array(page.get_size_inches())}"
    yield from _texts("page", page.texts)
    for number_of_axes, axes in enumerate(page.axes):
        name = f"axes {number_of_axes}"
        yield f"{name}: place {array(np.array(axes.get_position().bounds))}"
        yield f"{name}: x {array(np.array(axes.get_xlim()))} {axes.get_xlabel()!r}"
        yield f"{name}: y {array(np.array(axes.get_ylim()))} {axes.get_ylabel()!r}"
        yield f"{name}: title {axes.get_title()!r} {axes.get_title(loc='left')!r}"
        for line in axes.lines:
            points = np.ma.filled(np.ma.asarray(line.get_xydata(), float), np.nan)
            style = line.get_color(), line.get_linewidth(), line.get_linestyle()
            look = f"{style}{_marks(line)}"
            yield f"{name}: line {line.get_label()!r} {look} {array(points)}"
        for patch in axes.patches:
            corners = patch.get_path().vertices
            color = array(np.array(patch.get_facecolor()))
            yield f"{name}: patch {color} {array(corners)}"
        for drawn in axes.collections:
            colors = array(np.array(drawn.get_facecolor()))
            corners = [path.vertices for path in drawn.get_paths()]
            whole = np.concatenate(corners) if corners else np.zeros((0, 2))
            yield f"{name}: {type(drawn).__name__} {colors} {array(whole)}"
        yield from _texts(name, axes.texts)
        if axes.get_legend():
            yield from _texts(f"{name}: legend", axes.get_legend().get_texts())


def _marks(line: Any) -> str:
    """The look of the marks at a line's points, if it has any."""
    if line.get_marker() in ("None", ""):
        return ""
    colors = line.get_markerfacecolor(), line.get_markeredgecolor()
    return f" {line.get_marker()!r} {number(line.get_markersize())} {colors}"


def _texts(name: str, texts: Any) -> Iterator[str]:
    for text in texts:
        look = text.get_color(), text.get_fontsize()
        place = array(np.array(text.get_position(), float))
        yield f"{name}: text {text.get_text()!r} {look} {place}{_paper(text)}"


def _paper(text: Any) -> str:
    """The look of what lies behind a text, if anything does."""
    paper = text.get_bbox_patch()
    if paper is None:
        return ""
    pad = paper.get_boxstyle().pad
    color = array(np.array(paper.get_facecolor()))
    return f" on {color} pad {number(pad)} line {number(paper.get_linewidth())}"
