"""Matplotlib figures without a window: style, shared parts, files; plots of a comparison, of a current."""

from __future__ import annotations

import io
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray
from alpha5_model.errors import InputError, MissingDependencyError
from alpha5_model.files import atomic_write, output_format
from alpha5_model.hydrodynamics import LEVELS

if TYPE_CHECKING:
    from alpha5_model.comparison.records import Comparison
    from alpha5_model.dynamics.arm import Arm

#: Directions of a current; the last is the first again.
_DIRECTIONS = 73
FORMATS = (".png", ".pdf", ".svg")
_STYLE: dict[str, Mapping[str, Any]] = {
    "axes": {"axisbelow": True, "spines.right": False, "spines.top": False, "titlesize": 10},
    "legend": {"frameon": False},
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


def _matplotlib() -> Any:
    try:
        import matplotlib.backends.backend_agg
        import matplotlib.figure
    except ImportError:
        remedy = "pip install 'alpha5-model[plot]'"
        raise MissingDependencyError("matplotlib", "a picture", remedy) from None
    return matplotlib


@contextmanager
def style(**changes: Mapping[str, Any]) -> Iterator[None]:
    """The figures' common settings of matplotlib with some changes; also a decorator.

    Args:
        changes: Settings by group, as matplotlib's ``rc`` takes them: ``axes={"grid": True}``.

    Raises:
        MissingDependencyError: matplotlib is not installed.
    """
    groups = [*_STYLE.items(), *changes.items()]
    with _matplotlib().rc_context({f"{g}.{key}": v for g, s in groups for key, v in s.items()}):
        yield


def new_figure(width: float, height: float) -> Any:
    """A matplotlib Figure outside of pyplot's global state; width and height in inches.

    Raises:
        MissingDependencyError: matplotlib is not installed.
    """
    mpl = _matplotlib()
    figure = mpl.figure.Figure(figsize=(width, height), layout="constrained")
    return mpl.backends.backend_agg.FigureCanvasAgg(figure).figure


def write_figure(figure: Any, path: str | os.PathLike[str], dpi: int) -> Path:
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
    """Three digits, no power of ten where the digits do, a true minus sign."""
    return f"{float(f'{value:.3g}'):.7g}".replace("-", "\u2212")


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
            gaps = [gap(loop[-1][-1], line[0]) for line in (loop[0], *rest)]
            if not (nearest := int(np.argmin(gaps))):
                break
            loop.append(rest.pop(nearest - 1))
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
    handles, labels = axes.get_legend_handles_labels()
    unique = dict(zip(labels, handles, strict=True))
    where = {"loc": "upper center", "bbox_to_anchor": (0.5, -drop)}
    axes.legend(unique.values(), unique.keys(), **where, **options)


@style(xtick={"labelsize": 8}, ytick={"labelsize": 8})
def plot_comparison(comparison: Comparison, path: str | os.PathLike[str]) -> Path:
    """Draw the errors of mass, COM and inertia per body and of the gravity torque per joint.

    Args:
        comparison: What `alpha5_model.compare` returns.
        path: Picture to write: ``.png``, ``.pdf`` or ``.svg``.

    Raises:
        InputError: Of another arm, which has no errors to draw.
        UnknownNameError: Another suffix.
        MissingDependencyError: matplotlib is not installed.
        OutputError: It cannot be written.
    """
    if not comparison.joints:
        raise InputError("comparison", comparison.verdict, "one of a Reach Alpha 5")
    bodies = [body.name for body in comparison.bodies]
    panels = (
        ("mass", "g", bodies, [body.mass_error * 1e3 for body in comparison.bodies]),
        ("COM", "mm", bodies, [body.com_error * 1e3 for body in comparison.bodies]),
        ("inertia", "kg·mm²", bodies, [body.inertia_error * 1e6 for body in comparison.bodies]),
        ("gravity torque", "N·m", list(comparison.joints), list(comparison.gravity_error)),
    )
    figure = new_figure(11, 3.4)
    for axes, (name, unit, names, values) in zip(figure.subplots(1, 4), panels, strict=True):
        # Rounding errors alone would fill the panel.
        values = [value if abs(value) > 1e-9 else 0.0 for value in values]
        bars = axes.barh(names, values, color=Color.VERMILION)
        axes.bar_label(bars, fmt=number, padding=3, fontsize=8)
        axes.invert_yaxis()
        axes.margins(x=0.3)
        axes.axvline(0, color="black", linewidth=0.8)
        axes.set_title(f"{name}, up to {number(max(map(abs, values)))} {unit}")
    verdict = "agrees with" if comparison.agrees else "differs from"
    figure.suptitle(f"The arm in {comparison.name} {verdict} the tables: errors", fontsize=11)
    return write_figure(figure, path, dpi=150)


@style(axes={"grid": True, "titlesize": 11, "titlepad": 18}, legend={"fontsize": 8})
def mount_load_figure(arm: Arm, q: ArrayLike, speed: float) -> Any:
    """Force and moment of a level current on the mount of an arm at rest, as a matplotlib Figure.

    Lines are nominal, bands go from all numbers low to all high; they are estimated, not published.

    Args:
        arm: On a fixed base.
        q: (nq,).
        speed: Of the current, in the plane x, y of base_link [m/s].
    """
    angle = np.linspace(0, 2 * np.pi, _DIRECTIONS)
    flow = speed * np.column_stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)])
    wets = [arm.with_hydrodynamics(level=level) for level in LEVELS]
    wrenches = np.array([[wet.current_load(q, u)[1] for u in flow] for wet in wets])
    sizes = np.linalg.norm(wrenches.reshape(3, _DIRECTIONS, 2, 3), axis=3)
    page = new_figure(10.5, 5.4)
    subplots = page.subplots(1, 2, subplot_kw={"projection": "polar"})
    names = ("force", "N", Color.BLUE), ("moment", "N·m", Color.VERMILION)
    for axes, (name, unit, color), (low, nominal, high) in zip(
        subplots, names, sizes.transpose(2, 0, 1), strict=True
    ):
        look = {"color": color, "alpha": 0.2, "linewidth": 0}
        axes.fill_between(angle, low, high, label="all numbers low to all high", **look)
        axes.plot(angle, nominal, color=color, linewidth=1.6, label="nominal")
        least, most = number(nominal.min()), number(nominal.max())
        axes.set(title=f"{name}, {least} to {most} {unit}", rmin=0.0)
        axes.set_xticks(np.arange(0, 2 * np.pi, np.pi / 2), ["x", "y", "\u2212x", "\u2212y"])
        axes.tick_params(axis="y", labelsize=8)
        for text in axes.get_yticklabels():
            text.set_bbox({"facecolor": "white", "alpha": 0.75, "linewidth": 0, "pad": 1})
        axes.legend(loc="lower left", bbox_to_anchor=(-0.12, -0.12))
    pose = ", ".join(f"{x:.2f}" for x in np.asarray(q)).replace("-", "\u2212")
    force, moment = map(number, sizes[1].max(axis=0))
    load = f"at most {force} N and {moment} N·m by where it flows to; estimated, not published"
    title = f"A current of {speed:g} m/s loads the mount with {load}"
    fluid = f"fluid {arm.fluid_density:g} kg/m³"
    page.suptitle(f"{title}\nq = ({pose}), {fluid}", fontsize=10)
    return page
