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
    # Weights that tell any two places apart; gaps weigh nothing.
    weighted = np.nan_to_num(flat) @ np.cos(np.arange(len(flat)))
    return f"{values.shape} sums {number(np.nansum(flat))} {number(weighted)}"


def figure(page: Any) -> Iterator[str]:
    """Lines of a matplotlib figure: size, and each axes with what is drawn in it."""
    page.canvas.draw()
    yield f"size: {array(page.get_size_inches())}"
    yield from _texts("page", page.texts)
    for legend in page.legends:
        yield _legend("page", legend, page.bbox)
    for number_of_axes, axes in enumerate(page.axes):
        yield from _axes(f"axes {number_of_axes}", axes)


def _axes(name: str, axes: Any) -> Iterator[str]:
    place = array(np.array(axes.get_position().bounds))
    yield f"{name}: place {place} aspect {axes.get_aspect()}"
    yield _axis(f"{name}: x", axes.xaxis)
    yield _axis(f"{name}: y", axes.yaxis)
    for title in (axes.title, axes._left_title):
        if title.get_text():
            yield f"{name}: title {title.get_text()!r} {_font(title)}"
    for line in axes.lines:
        points = np.ma.filled(np.ma.asarray(line.get_xydata(), float), np.nan)
        look = f"{_color(line.get_color())} {_width(line)} {line.get_linestyle()!r}"
        marks = f"{_marks(line)} z {number(line.get_zorder())}"
        yield f"{name}: line {line.get_label()!r} {look}{marks} {array(points)}"
    for patch in axes.patches:
        corners = patch.get_path().vertices
        look = f"{_color(patch.get_facecolor())} {_width(patch)}"
        order = f"z {number(patch.get_zorder())}"
        yield f"{name}: patch {look} {order} {array(corners)}"
    for drawn in axes.collections:
        yield _collection(name, drawn)
    yield from _texts(name, axes.texts)
    if axes.get_legend():
        yield _legend(name, axes.get_legend(), axes.bbox)


def _axis(name: str, axis: Any) -> str:
    """Ends, label, what the ticks say, and the lines of the grid."""
    ends = axis.get_view_interval()
    text = f"{name} {array(np.array(ends))}"
    if axis.label.get_text():
        text += f" {axis.label.get_text()!r} {_font(axis.label)}"
    ticks = [t for t in axis.get_major_ticks() if min(ends) <= t.get_loc() <= max(ends)]
    labelled = [tick for tick in ticks if tick.label1.get_visible()]
    if labelled:
        first = labelled[0].label1
        said = " ".join(map(_tick, labelled))
        text += f" ticks {said} {_font(first)}{_paper(first)}"
    lines = [tick.gridline for tick in ticks if tick.gridline.get_visible()]
    if lines:
        text += f" grid {_color(lines[0].get_color())} {_width(lines[0])}"
    return text


def _tick(tick: Any) -> str:
    """What its label says; and where it is, if that is not a number."""
    text = str(tick.label1.get_text())
    is_number = text.replace("\u2212", "").replace(".", "").isdigit()
    return text if is_number else f"{text}@{number(tick.get_loc())}"


def _collection(name: str, drawn: Any) -> str:
    """Areas or lines that matplotlib draws together."""
    faces = array(np.array(drawn.get_facecolor()))
    edges = array(np.array(drawn.get_edgecolor()))
    widths = array(np.array(drawn.get_linewidth(), float))
    look = f"{faces} edges {edges} {widths} z {number(drawn.get_zorder())}"
    corners = [path.vertices for path in drawn.get_paths()]
    whole = np.concatenate(corners) if corners else np.zeros((0, 2))
    label = drawn.get_label()
    return f"{name}: {type(drawn).__name__} {label!r} {look} {array(whole)}"


def _legend(name: str, legend: Any, around: Any) -> str:
    """Its names, and where it is within what is around it."""
    from matplotlib.transforms import BboxTransformFrom

    texts = legend.get_texts()
    names = [text.get_text() for text in texts]
    box = legend.get_window_extent().transformed(BboxTransformFrom(around))
    place = array(np.array(box.bounds))
    frame = "framed" if legend.get_frame_on() else "no frame"
    return f"{name}: legend {names} {_font(texts[0])} {frame} {place}"


def _color(color: Any) -> str:
    """As matplotlib writes it, with the opacity if it is not 1."""
    from matplotlib.colors import to_hex, to_rgba

    return to_hex(color, keep_alpha=to_rgba(color)[3] < 1)


def _width(line: Any) -> str:
    return number(line.get_linewidth())


def _font(text: Any) -> str:
    return f"{_color(text.get_color())} size {number(text.get_fontsize())}"


def _marks(line: Any) -> str:
    """The look of the marks at a line's points, if it has any."""
    if line.get_marker() in ("None", ""):
        return ""
    inside = line.get_markerfacecolor()
    face = inside if inside == "none" else _color(inside)
    edge = f"{_color(line.get_markeredgecolor())} {number(line.get_markeredgewidth())}"
    return f" {line.get_marker()!r} {number(line.get_markersize())} {face} edge {edge}"


def _texts(name: str, texts: Any) -> Iterator[str]:
    for text in texts:
        place = array(np.array(text.get_position(), float))
        side = f"{text.get_ha()} {text.get_va()}"
        look = f"{_font(text)} {side} {place}{_leader(text)}{_paper(text)}"
        yield f"{name}: text {text.get_text()!r} {look}"


def _leader(text: Any) -> str:
    """Where a text points, and the line from it to there, if it has one."""
    if not hasattr(text, "xy"):
        return ""
    at = f" at {array(np.array(text.xy, float))}"
    return f"{at} line {_width(text.arrow_patch)}" if text.arrow_patch else at


def _paper(text: Any) -> str:
    """The look of what lies behind a text, if anything does."""
    paper = text.get_bbox_patch()
    if paper is None:
        return ""
    pad = paper.get_boxstyle().pad
    return f" on {_color(paper.get_facecolor())} pad {number(pad)} line {_width(paper)}"
