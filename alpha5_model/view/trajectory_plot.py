"""A page of curves of an analysed motion, drawn with matplotlib."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from alpha5_model.parameters import parameters
from alpha5_model.view.figures import check_format, new_figure, tidy, write_figure

if TYPE_CHECKING:
    from alpha5_model.trajectory.analysis import Analysis

#: Okabe and Ito's colours, told apart by colour-blind readers as well.
_CAUSES = {
    "weight": "#E69F00",
    "buoyancy": "#56B4E9",
    "inertia": "#CC79A7",
    "coriolis": "#009E73",
}
_TOTAL, _LIMIT = "#222222", "#D55E00"
#: More points than a page can show are thinned, keeping the extremes of each stretch.
_POINTS = 4000


def write(analysis: Analysis, path: str | os.PathLike[str]) -> Path:
    """Draw the page and write it; the suffix says how: ``.png``, ``.pdf`` or ``.svg``.

    Raises:
        UnknownNameError: Another suffix.
        MissingDependencyError: matplotlib is not installed.
        OutputError: The file cannot be written.
    """
    check_format(path)
    return write_figure(figure(analysis), path, dpi=110)


def figure(analysis: Analysis) -> Any:
    """The page as a matplotlib Figure that no window or global state knows of.

    One row for each joint (position, torque by cause, motor current) and one for the whole arm (power,
    load on the mount, TCP path).
    """
    a = analysis
    joints = a.smooth.joints
    page = new_figure(16, 2.35 * len(joints) + 4.2)
    page.get_layout_engine().set(h_pad=0.06, w_pad=0.08)
    grid = page.add_gridspec(len(joints) + 1, 3, height_ratios=[1.0] * len(joints) + [1.6])
    first: Any = None
    axes: Any
    for row in range(len(joints)):
        for column, draw in enumerate((_position, _torque, _current)):
            axes = page.add_subplot(grid[row, column], sharex=first)
            first = first or axes
            draw(axes, a, row)
    _power(page.add_subplot(grid[-1, 0], sharex=first), a)
    _mount(page.add_subplot(grid[-1, 1], sharex=first), a)
    _path(page.add_subplot(grid[-1, 2]), a)
    for axes in page.axes:
        tidy(axes, color="#E6E6E6", linewidth=0.6)
        axes.tick_params(labelsize=9)
    _title(page.axes[0], "joint position (dots: samples)")
    _title(page.axes[1], "joint torque by cause")
    _title(page.axes[2], "motor current, band: tolerance of friction")
    causes = page.axes[1].get_legend_handles_labels()
    page.legend(*causes, ncols=5, fontsize=10, frameon=False, loc="outside upper right")
    last_current = page.axes[3 * len(joints) - 1]
    for axes in page.axes[: 3 * len(joints) - 1]:
        axes.tick_params(labelbottom=False)
    last_current.set_xlabel("time [s]", fontsize=10)
    page.align_ylabels()
    width = a.smooth.bandwidth
    page.suptitle(
        f"{Path(a.motion.source).name}   "
        f"({len(a.smooth.time)} samples; fluid {a.arm.fluid_density:g} kg/m³; "
        f"{a.smooth.method}{'' if width is None else f' {width:.3g} Hz'}; "
        f"motor constants: {a.actuators[0].constants})",
        fontsize=12,
        x=0.01,
        ha="left",
    )
    return page


def _position(axes: Any, a: Analysis, k: int) -> None:
    name = a.smooth.joints[k]
    joint = next(j for j in parameters().joints if j.name == name)
    scale, unit = (1e3, "mm") if name == "axis_a" else (180 / np.pi, "°")
    raw = scale * a.motion.position[:, k]
    axes.plot(*thin(a.motion.time, raw), ".", color="#999999", markersize=4, label="samples")
    _line(axes, a, scale * a.smooth.position[:, k])
    low, high = axes.get_ylim()
    least = 0.02 * scale * (joint.upper - joint.lower)
    middle, half = (low + high) / 2, max((high - low) / 2, least)
    axes.set_ylim(middle - half, middle + half)
    for bound in (scale * joint.lower, scale * joint.upper):
        if middle - half <= bound <= middle + half:
            axes.axhline(bound, color=_LIMIT, linewidth=1, linestyle="--")
    axes.set_ylabel(f"{name} [{unit}]", fontsize=10)


def _torque(axes: Any, a: Analysis, k: int) -> None:
    for cause, colour in _CAUSES.items():
        _line(axes, a, getattr(a, cause)[:, k], color=colour, label=cause)
    torque = a.torque[:, k]
    _line(axes, a, torque, color=_TOTAL, linewidth=1.5, label="torque")
    at = int(np.abs(torque).argmax())
    _widen(axes, 1e-3)
    _mark(axes, a.smooth.time[at], torque[at])
    axes.set_ylabel("N" if a.smooth.joints[k] == "axis_a" else "N m", fontsize=10)


def _current(axes: Any, a: Analysis, k: int) -> None:
    axes.set_ylabel("A", fontsize=10)
    current = a.current[:, k]
    if not np.isfinite(current).all():
        words, middle = (
            "the lead of the jaw's screw is not published",
            {"ha": "center", "va": "center"},
        )
        axes.text(0.5, 0.5, words, transform=axes.transAxes, color="#777777", fontsize=9, **middle)
        axes.set_yticks([])
        return
    time, low = thin(a.smooth.time, a.current_lower[:, k])
    high = np.interp(time, a.smooth.time, a.current_upper[:, k])
    axes.fill_between(time, low, high, color="#9ECAE9", linewidth=0)
    _line(axes, a, current)
    _widen(axes, 1e-3)
    if a.current_limit is not None:
        for bound in (-a.current_limit, a.current_limit):
            if axes.get_ylim()[0] <= bound <= axes.get_ylim()[1]:
                axes.axhline(bound, color=_LIMIT, linewidth=1, linestyle="--")
    at = int(np.abs(current).argmax())
    _mark(axes, a.smooth.time[at], current[at])


def _power(axes: Any, a: Analysis) -> None:
    electrical, mechanical = np.nansum(a.electrical_power, axis=1), a.mechanical_power.sum(axis=1)
    _line(axes, a, electrical, linewidth=1.1, label="electrical")
    _line(axes, a, mechanical, color=_LIMIT, linewidth=1.1, label="mechanical")
    _frame(axes, "power of all motors", "time [s]", "W")


def _mount(axes: Any, a: Analysis) -> None:
    for k, (name, colour) in enumerate(zip("xyz", ("#D55E00", "#009E73", "#0072B2"), strict=True)):
        moment = a.base_wrench[:, 3 + k]
        _line(axes, a, moment, color=colour, linewidth=1.2, label=f"moment {name}")
    force = np.linalg.norm(a.base_wrench[:, :3], axis=1)
    title = f"moment on the mount (force {force.min():.2f} to {force.max():.2f} N)"
    _frame(axes, title, "time [s]", "N m")


def _path(axes: Any, a: Analysis) -> None:
    step = max(1, len(a.tcp) // _POINTS)
    x, y, z = 1e3 * a.tcp[::step].T
    axes.plot(x, z, color="#0072B2", linewidth=1.2, label="side (x, z)")
    axes.plot(x, y, color="#E69F00", linewidth=1.2, label="top (x, y)")
    for other in (z, y):
        axes.plot(x[0], other[0], "o", color="white", markeredgecolor=_TOTAL, markersize=6)
        axes.plot(x[-1], other[-1], "o", color=_TOTAL, markersize=5)
    axes.plot(0, 0, "+", color=_LIMIT, markersize=10, label="base_link")
    axes.set_aspect("equal", adjustable="datalim")
    _frame(axes, "path of the TCP, from ○ to ●", "x [mm]", "z or y [mm]")


def _line(axes: Any, a: Analysis, values: Any, **style: Any) -> None:
    axes.plot(*thin(a.smooth.time, values), **{"color": "#0072B2", "linewidth": 1.0, **style})


def _title(axes: Any, text: str) -> None:
    axes.set_title(text, loc="left", fontsize=11)


def _frame(axes: Any, title: str, x: str, y: str) -> None:
    _title(axes, title)
    axes.set_xlabel(x, fontsize=10)
    axes.set_ylabel(y, fontsize=10)
    axes.legend(fontsize=8, frameon=False)


def _mark(axes: Any, time: float, value: float) -> None:
    axes.margins(y=0.18)
    axes.plot(time, value, "o", color=_TOTAL, markersize=4)
    beside = {"xytext": (0, 6 if value > 0 else -14), "textcoords": "offset points"}
    axes.annotate(f"{value:.3g}", (time, value), **beside, ha="center", fontsize=8)


def _widen(axes: Any, least: float) -> None:
    """Keep rounding noise from filling the panel."""
    low, high = axes.get_ylim()
    if high - low < least:
        middle = (low + high) / 2
        axes.set_ylim(middle - least / 2, middle + least / 2)


def thin(time: Any, values: Any) -> tuple[Any, Any]:
    """At most `_POINTS` points: the lowest and the highest of each stretch."""
    stretch = -(-len(time) // (_POINTS // 2))
    if stretch <= 2:
        return time, values
    whole = len(time) // stretch * stretch
    rows = np.asarray(values[:whole]).reshape(-1, stretch)
    start = np.arange(0, whole, stretch)
    picked = np.sort(np.stack([start + rows.argmin(axis=1), start + rows.argmax(axis=1)], axis=1))
    index = np.append(picked.ravel(), len(time) - 1)
    return time[index], values[index]
