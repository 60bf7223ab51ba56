"""Matplotlib figures without a window: style, files; plots of a comparison, a current, a motion."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import PathLike, atomic_write, output_format
from alpha5_model.errors import InputError, needing
from alpha5_model.numbers.hydrodynamics import LEVELS

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm
    from alpha5_model.proofs.comparison.records import Comparison
    from alpha5_model.trajectory.analysis import Analysis

#: Directions of a current; the last is the first again.
_DIRECTIONS = 73
#: Most points of a curve, longer ones are thinned and keep the extremes of each stretch; most points
#: at which the band of the printed digits is computed.
_POINTS, _BAND_POINTS = 4000, 500
FORMATS = (".png", ".pdf", ".svg")


class Color(StrEnum):
    """Okabe and Ito's colours, told apart by colour-blind readers as well."""

    BLACK = "#222222"
    ORANGE = "#E69F00"
    SKY = "#56B4E9"
    GREEN = "#009E73"
    BLUE = "#0072B2"
    VERMILION = "#D55E00"
    PINK = "#CC79A7"


#: Terms of the torque and their colours; the first are drawn widest, so that none hides another.
CAUSES = {
    "weight": Color.ORANGE,
    "buoyancy": Color.SKY,
    "inertia": Color.PINK,
    "coriolis": Color.GREEN,
    "moving_water": Color.BLUE,
}


def _matplotlib() -> Any:
    with needing("a picture", "pip install 'alpha5-model[plot]'", "matplotlib"):
        import matplotlib.backends.backend_agg  # noqa: F401, used by name
        import matplotlib.figure
    return matplotlib


@contextmanager
def style(**changes: Mapping[str, Any]) -> Iterator[None]:
    """The figures' common settings of matplotlib with some changes; also a decorator.

    Args:
        changes: Settings by group, as matplotlib's ``rc`` takes them: ``axes={"grid": True}``.

    Raises:
        MissingDependencyError: matplotlib is not installed.
    """
    changed = {
        f"{group}.{key}": v
        for group, some in changes.items()
        for key, v in some.items()
    }
    with _matplotlib().rc_context(changed, Path(__file__).with_suffix(".mplstyle")):
        yield


def new_figure(width: float, height: float) -> Any:
    """A matplotlib Figure outside of pyplot's global state; width and height in inches.

    Raises:
        MissingDependencyError: matplotlib is not installed.
    """
    mpl = _matplotlib()
    figure = mpl.figure.Figure(figsize=(width, height), layout="constrained")
    return mpl.backends.backend_agg.FigureCanvasAgg(figure).figure


def write_figure(figure: Any, path: PathLike, dpi: int) -> Path:
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


@style(xtick={"labelsize": 8}, ytick={"labelsize": 8})
def plot_comparison(comparison: Comparison, path: PathLike) -> Path:
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
    rows = [(b.mass_error, b.com_error, b.inertia_error) for b in comparison.bodies]
    errors = [
        *(np.array(rows).T * [[1e3], [1e3], [1e6]]),
        np.array(comparison.gravity_error),
    ]
    bodies = [body.name for body in comparison.bodies]
    heads = (
        ("mass", "g"),
        ("COM", "mm"),
        ("inertia", "kg·mm²"),
        ("gravity torque", "N·m"),
    )
    names = (bodies, bodies, bodies, [*comparison.joints])
    figure = new_figure(11, 3.4)
    panels = zip(figure.subplots(1, 4), heads, names, errors, strict=True)
    for axes, (title, unit), labels, values in panels:
        # Rounding errors alone would fill the panel.
        values = np.where(np.abs(values) > 1e-9, values, 0.0)
        bars = axes.barh(labels, values, color=Color.VERMILION)
        axes.bar_label(bars, fmt=number, padding=3, fontsize=8)
        axes.invert_yaxis()
        axes.margins(x=0.3)
        axes.axvline(0, color="black", linewidth=0.8)
        axes.set_title(f"{title}, up to {number(np.abs(values).max())} {unit}")
    verdict = "agrees with" if comparison.agrees else "differs from"
    figure.suptitle(
        f"The arm in {comparison.name} {verdict} the tables: errors", fontsize=11
    )
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
    sizes = np.linalg.norm(wrenches.reshape(3, _DIRECTIONS, 2, 3), axis=3).transpose(
        2, 0, 1
    )
    page = new_figure(10.5, 5.4)
    panels = page.subplots(1, 2, subplot_kw={"projection": "polar"})
    heads = ("force", "N", Color.BLUE), ("moment", "N·m", Color.VERMILION)
    for axes, (name, unit, color), (low, nominal, high) in zip(
        panels, heads, sizes, strict=True
    ):
        look = {"color": color, "alpha": 0.2, "linewidth": 0}
        axes.fill_between(angle, low, high, label="all numbers low to all high", **look)
        axes.plot(angle, nominal, color=color, linewidth=1.6, label="nominal")
        least, most = number(nominal.min()), number(nominal.max())
        axes.set(title=f"{name}, {least} to {most} {unit}", rmin=0.0)
        axes.set_xticks(
            np.arange(0, 2 * np.pi, np.pi / 2), ["x", "y", "\u2212x", "\u2212y"]
        )
        axes.tick_params(axis="y", labelsize=8)
        for text in axes.get_yticklabels():
            text.set_bbox(
                {"facecolor": "white", "alpha": 0.75, "linewidth": 0, "pad": 1}
            )
        axes.legend(loc="lower left", bbox_to_anchor=(-0.12, -0.12))
    pose = ", ".join(f"{x:.2f}" for x in np.asarray(q)).replace("-", "\u2212")
    force, moment = map(number, sizes[:, 1].max(axis=1))
    load = f"at most {force} N and {moment} N·m by where it flows to; estimated, not published"
    title = f"A current of {speed:g} m/s loads the mount with {load}"
    page.suptitle(
        f"{title}\nq = ({pose}), fluid {arm.fluid_density:g} kg/m³", fontsize=10
    )
    return page


@style(
    axes={"grid": True, "titlelocation": "left", "titlesize": 11},
    grid={"color": "#E6E6E6", "linewidth": 0.6},
    legend={"fontsize": 8},
    lines={"linewidth": 1.0},
    xtick={"labelsize": 9},
    ytick={"labelsize": 9},
)
def motion_figure(analysis: Analysis) -> Any:
    """Plot an analysed motion, as a matplotlib Figure.

    One row for each joint (position, torque by cause, motor current) and one for the whole arm
    (power, load on the mount, TCP path).
    """
    a, rows = analysis, len(analysis.smooth.joints)
    page = new_figure(16, 2.35 * rows + 4.2)
    page.get_layout_engine().set(h_pad=0.06, w_pad=0.08)
    panels = page.subplots(rows + 1, 3, height_ratios=[1.0] * rows + [1.6])
    for axes in page.axes[1:-1]:
        axes.sharex(page.axes[0])
    for k, row in enumerate(panels[:-1]):
        for draw, axes in zip((_position, _torque, _current), row, strict=True):
            draw(axes, a, k)
            axes.tick_params(labelbottom=False)
    for summary, axes in zip((_power, _mount, _path), panels[-1], strict=True):
        summary(axes, a)
        axes.legend()
    # The last of the time axes that has nothing below it.
    panels[-2, 2].tick_params(labelbottom=True)
    for axes in (panels[-2, 2], *panels[-1, :2]):
        axes.set_xlabel("time [s]")
    panels[0, 0].set_title("joint position (dots: samples)")
    torque = 1, "joint torque by cause", a.torque, "N·m", ""
    current = 2, "motor current", a.current, "A", "; band: friction"
    for column, what, values, unit, note in (torque, current):
        sizes = np.nanmax(np.abs(values[:, :4]), axis=0)
        most = f"at most {number(sizes.max())} {unit} ({a.smooth.joints[int(sizes.argmax())]})"
        panels[0, column].set_title(f"{what}, {most}{note}")
        # What is small beside another joint's stays small to see: noise fills no panel.
        alike = [
            axes
            for axes in panels[:-1, column]
            if axes.get_ylabel().endswith(f"[{unit}]")
        ]
        low, high = zip(
            *(axes.get_ylim() for axes in alike if axes.has_data()), strict=True
        )
        for axes in alike:
            axes.set_ylim(min(low), max(high))
    handles, names = panels[0, 1].get_legend_handles_labels()
    # Beside the title there is room for five.
    columns = -(-len(names) // (1 + len(names) // 6))
    page.legend(handles, names, ncols=columns, fontsize=10, loc="outside upper right")
    page.align_ylabels()
    width = "" if a.smooth.bandwidth is None else f" {a.smooth.bandwidth:.3g} Hz"
    fluid = f"{len(a.smooth.time)} samples; fluid {a.arm.fluid_density:g} kg/m³"
    if a.moving_water is not None:
        flow = ", ".join(f"{x:g}" for x in a.moving_water.current)
        fluid += f"; current ({flow}) m/s, its effect estimated"
    method = f"{a.smooth.method}{width}; motor constants: {a.actuators[0].constants}"
    title = f"{Path(a.motion.source).name}   ({fluid}; {method})"
    page.suptitle(title, fontsize=12, x=0.01, ha="left")
    return page


def _position(axes: Any, a: Analysis, k: int) -> None:
    name = a.arm.joint_names[k]
    lower, upper = a.arm.limits.lower[k], a.arm.limits.upper[k]
    scale, unit = (1e3, "mm") if name == "axis_a" else (180 / np.pi, "°")
    samples = thin(a.motion.time, scale * a.motion.position[:, k])
    axes.plot(*samples, ".", color="#999999", markersize=4, label="samples")
    _curve(axes, a, scale * a.smooth.position[:, k], color=Color.BLUE)
    # What rests does not fill the panel with its noise.
    (low, high), least = axes.get_ylim(), 0.04 * scale * (upper - lower)
    spare = max(0.0, least - (high - low)) / 2
    axes.set_ylim(low - spare, high + spare)
    _bounds(axes, scale * lower, scale * upper)
    axes.set_ylabel(f"{name} [{unit}]")


def _torque(axes: Any, a: Analysis, k: int) -> None:
    from alpha5_model.dynamics.dimensions import has_dimensions
    from alpha5_model.studies.uncertainty.effects import torque_margin

    causes = a.causes()
    for width, (cause, color) in zip(
        (3.8, 3.2, 2.9, 1.3, 1.3), CAUSES.items(), strict=True
    ):
        if cause in causes:
            line = {
                "color": color,
                "linewidth": width,
                "label": cause.replace("_", " "),
            }
            _curve(axes, a, causes[cause][:, k], **line)
    if a.moving_water is not None:
        _band(axes, a, *a.moving_water.torque[:, [0, 2], k].T)
    s, few = a.smooth, slice(None, None, -(-len(a.smooth.time) // _BAND_POINTS))
    state = (x[few] for x in (s.position, s.velocity, s.acceleration))
    if has_dimensions(a.arm._model):
        low, high = a.torque[few, k] + torque_margin(a.arm, *state)[..., k]
        axes.fill_between(
            s.time[few], low, high, color="#999999", linewidth=0, label="printed digits"
        )
    _curve(axes, a, a.torque[:, k], color=Color.BLACK, linewidth=1.3, label="torque")
    if a.motion.effort is not None:
        there = np.isfinite(a.motion.effort[:, k])
        recorded = thin(s.time[there], a.motion.effort[there, k])
        axes.plot(*recorded, color="#999999", zorder=1, label="recorded effort")
    _mark(axes, s.time, a.torque[:, k])
    axes.set_ylabel(f"{s.joints[k]} [{'N' if k == 4 else 'N·m'}]")


def _current(axes: Any, a: Analysis, k: int) -> None:
    axes.set_ylabel(f"{a.smooth.joints[k]} [A]")
    current = a.current[:, k]
    if not np.isfinite(current).all():
        missing = "the lead of the jaw's screw is not published"
        middle = {"ha": "center", "va": "center", "transform": axes.transAxes}
        axes.text(0.5, 0.5, missing, color="#777777", fontsize=9, **middle)
        axes.set_yticks([])
        return
    _band(axes, a, a.current_lower[:, k], a.current_upper[:, k])
    _curve(axes, a, current, color=Color.BLUE)
    _mark(axes, a.smooth.time, current)
    if a.current_limit is not None:
        _bounds(axes, -a.current_limit, a.current_limit)


def _power(axes: Any, a: Analysis) -> None:
    electrical, mechanical = (
        np.nansum(a.electrical_power, axis=1),
        a.mechanical_power.sum(axis=1),
    )
    _curve(axes, a, electrical, color=Color.BLUE, linewidth=1.1, label="electrical")
    _curve(
        axes, a, mechanical, color=Color.VERMILION, linewidth=1.1, label="mechanical"
    )
    most = (
        f"at most {number(electrical.max())} W, {number(mechanical.max())} W mechanical"
    )
    axes.set(title=f"power of all motors, {most}", ylabel="power [W]")


def _mount(axes: Any, a: Analysis) -> None:
    force, moment = np.linalg.norm(a.base_wrench[:, :3], axis=1), a.base_wrench[:, 3:].T
    colors = (Color.VERMILION, Color.GREEN, Color.BLUE)
    for name, color, width, values in zip(
        "xyz", colors, (2.6, 1.8, 1.0), moment, strict=True
    ):
        _curve(axes, a, values, color=color, linewidth=width, label=f"moment {name}")
    most = f"{number(np.linalg.norm(moment, axis=0).max())} N·m (force {number(force.max())} N)"
    axes.set(title=f"moment on the mount, at most {most}", ylabel="moment [N·m]")


def _path(axes: Any, a: Analysis) -> None:
    x, y, z = 1e3 * a.tcp[:: max(1, len(a.tcp) // _POINTS)].T
    axes.plot(x, z, color=Color.BLUE, linewidth=1.2, label="side (x, z)")
    axes.plot(x, y, color=Color.ORANGE, linewidth=1.2, label="top (x, y)")
    for other in (z, y):
        axes.plot(
            x[0],
            other[0],
            "o",
            color="white",
            markeredgecolor=Color.BLACK,
            markersize=6,
        )
        axes.plot(x[-1], other[-1], "o", color=Color.BLACK, markersize=5)
    axes.plot(0, 0, "+", color=Color.VERMILION, markersize=10, label="base_link")
    axes.set_aspect("equal", adjustable="datalim")
    length = number(1e3 * np.linalg.norm(np.diff(a.tcp, axis=0), axis=1).sum())
    title = f"path of the TCP, {length} mm from ○ to ●"
    axes.set(title=title, xlabel="x [mm]", ylabel="z or y [mm]")


def _curve(axes: Any, a: Analysis, values: FloatArray, **options: Any) -> None:
    """A quantity (N,) over time."""
    axes.plot(*thin(a.smooth.time, values), **options)


def _band(axes: Any, a: Analysis, one: FloatArray, other: FloatArray) -> None:
    """What lies between two quantities (N,) over time."""
    time, end = thin(a.smooth.time, one)
    other_end = np.interp(time, a.smooth.time, other)
    axes.fill_between(time, end, other_end, color="#9ECAE9", linewidth=0)


def _mark(axes: Any, time: FloatArray, values: FloatArray) -> None:
    """The largest value, with its number."""
    at = int(np.abs(values).argmax())
    value = values[at]
    axes.margins(y=0.18)
    axes.plot(time[at], value, "o", color=Color.BLACK, markersize=4)
    look = {
        "xytext": (0, 6 if value > 0 else -14),
        "textcoords": "offset points",
        "fontsize": 8,
    }
    box = {"facecolor": "white", "alpha": 0.75, "linewidth": 0, "pad": 0.5}
    axes.annotate(number(value), (time[at], value), ha="center", bbox=box, **look)


def _bounds(axes: Any, *bounds: float) -> None:
    """Dashed lines that do not change what is in sight."""
    axes.set_ylim(axes.get_ylim())
    for bound in bounds:
        axes.axhline(bound, color=Color.VERMILION, linestyle="--")


def thin(time: Any, values: Any) -> tuple[Any, Any]:
    """At most `_POINTS` points: the lowest and the highest of each stretch."""
    stretch = -(-len(time) // (_POINTS // 2))
    if stretch <= 2:
        return time, values
    whole = len(time) // stretch * stretch
    rows = np.asarray(values[:whole]).reshape(-1, stretch)
    start = np.arange(0, whole, stretch)
    picked = np.sort(
        np.stack([start + rows.argmin(axis=1), start + rows.argmax(axis=1)], axis=1)
    )
    index = np.append(picked.ravel(), len(time) - 1)
    return time[index], values[index]
