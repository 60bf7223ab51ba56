"""A page of curves of an analysed motion, drawn with matplotlib."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.parameters import parameters
from alpha5_model.view.figures import Color, new_figure, number, style

if TYPE_CHECKING:
    from alpha5_model.trajectory.analysis import Analysis

#: Terms of the torque and their colours; the first are drawn widest, so that none hides another.
CAUSES = {
    "weight": Color.ORANGE,
    "buoyancy": Color.SKY,
    "inertia": Color.PINK,
    "coriolis": Color.GREEN,
    "moving_water": Color.BLUE,
}
#: Most points of a curve; longer ones are thinned and keep the extremes of each stretch.
_POINTS = 4000
#: Points at which the band of the printed digits is computed, at most.
_BAND_POINTS = 500


@style(
    axes={"grid": True, "labelsize": 10, "titlelocation": "left", "titlesize": 11},
    grid={"color": "#E6E6E6", "linewidth": 0.6},
    legend={"fontsize": 8},
    lines={"linewidth": 1.0},
    xtick={"labelsize": 9},
    ytick={"labelsize": 9},
)
def figure(analysis: Analysis) -> Any:
    """Plot the motion, as a matplotlib Figure.

    One row for each joint (position, torque by cause, motor current) and one for the whole arm
    (power, load on the mount, TCP path).
    """
    a = analysis
    rows = len(a.smooth.joints)
    page = new_figure(16, 2.35 * rows + 4.2)
    page.get_layout_engine().set(h_pad=0.06, w_pad=0.08)
    grid = page.add_gridspec(rows + 1, 3, height_ratios=[1.0] * rows + [1.6])
    time: Any = None
    for k in range(rows):
        for column, draw in enumerate((_position, _torque, _current)):
            axes: Any = page.add_subplot(grid[k, column], sharex=time)
            time = time or axes
            axes.tick_params(labelbottom=False)
            draw(axes, a, k)
    # The last of the time axes that has nothing below it.
    axes.tick_params(labelbottom=True)
    axes.set_xlabel("time [s]")
    _power(page.add_subplot(grid[-1, 0], sharex=time), a)
    _mount(page.add_subplot(grid[-1, 1], sharex=time), a)
    _path(page.add_subplot(grid[-1, 2]), a)
    columns = page.axes[: 3 * rows]
    for unit in ("N·m", "A"):
        _same_scale([axes for axes in columns if axes.get_ylabel().endswith(f"[{unit}]")])
    columns[0].set_title("joint position (dots: samples)")
    columns[1].set_title(f"joint torque by cause, {_most(a, a.torque, 'N·m')}")
    columns[2].set_title(f"motor current, {_most(a, a.current, 'A')}; band: friction")
    names = page.axes[1].get_legend_handles_labels()
    # Beside the title there is room for five.
    columns = -(-len(names[1]) // (1 + len(names[1]) // 6))
    page.legend(*names, ncols=columns, fontsize=10, loc="outside upper right")
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
    joint = parameters().joints[k]
    scale, unit = (1e3, "mm") if joint.name == "axis_a" else (180 / np.pi, "°")
    samples = thin(a.motion.time, scale * a.motion.position[:, k])
    axes.plot(*samples, ".", color="#999999", markersize=4, label="samples")
    _curve(axes, a, scale * a.smooth.position[:, k], color=Color.BLUE)
    # What rests does not fill the panel with its noise.
    (low, high), least = axes.get_ylim(), 0.04 * scale * (joint.upper - joint.lower)
    spare = max(0.0, least - (high - low)) / 2
    axes.set_ylim(low - spare, high + spare)
    _bounds(axes, scale * joint.lower, scale * joint.upper)
    axes.set_ylabel(f"{joint.name} [{unit}]")


def _torque(axes: Any, a: Analysis, k: int) -> None:
    from alpha5_model.uncertainty.effects import torque_margin

    causes = a.causes()
    for width, (cause, color) in zip((3.8, 3.2, 2.9, 1.3, 1.3), CAUSES.items(), strict=True):
        if cause in causes:
            line = {"color": color, "linewidth": width, "label": cause.replace("_", " ")}
            _curve(axes, a, causes[cause][:, k], **line)
    if a.moving_water is not None:
        _band(axes, a, *a.moving_water.torque[:, [0, 2], k].T)
    s, few = a.smooth, slice(None, None, -(-len(a.smooth.time) // _BAND_POINTS))
    state = (x[few] for x in (s.position, s.velocity, s.acceleration))
    low, high = a.torque[few, k] + torque_margin(a.arm, *state)[..., k]
    axes.fill_between(s.time[few], low, high, color="#999999", linewidth=0, label="printed digits")
    _curve(axes, a, a.torque[:, k], color=Color.BLACK, linewidth=1.3, label="torque")
    if a.motion.effort is not None:
        there = np.isfinite(a.motion.effort[:, k])
        recorded = thin(a.smooth.time[there], a.motion.effort[there, k])
        axes.plot(*recorded, color="#999999", zorder=1, label="recorded effort")
    _mark(axes, a.smooth.time, a.torque[:, k])
    axes.set_ylabel(f"{a.smooth.joints[k]} [{'N' if k == 4 else 'N·m'}]")


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
    electrical, mechanical = np.nansum(a.electrical_power, axis=1), a.mechanical_power.sum(axis=1)
    _curve(axes, a, electrical, color=Color.BLUE, linewidth=1.1, label="electrical")
    _curve(axes, a, mechanical, color=Color.VERMILION, linewidth=1.1, label="mechanical")
    most = f"at most {number(electrical.max())} W, {number(mechanical.max())} W mechanical"
    axes.set(title=f"power of all motors, {most}", xlabel="time [s]", ylabel="power [W]")
    axes.legend()


def _mount(axes: Any, a: Analysis) -> None:
    force, moment = np.linalg.norm(a.base_wrench[:, :3], axis=1), a.base_wrench[:, 3:].T
    colors = (Color.VERMILION, Color.GREEN, Color.BLUE)
    for name, color, width, values in zip("xyz", colors, (2.6, 1.8, 1.0), moment, strict=True):
        _curve(axes, a, values, color=color, linewidth=width, label=f"moment {name}")
    most = number(np.linalg.norm(moment, axis=0).max())
    title = f"moment on the mount, at most {most} N·m (force {number(force.max())} N)"
    axes.set(title=title, xlabel="time [s]", ylabel="moment [N·m]")
    axes.legend()


def _path(axes: Any, a: Analysis) -> None:
    step = max(1, len(a.tcp) // _POINTS)
    x, y, z = 1e3 * a.tcp[::step].T
    axes.plot(x, z, color=Color.BLUE, linewidth=1.2, label="side (x, z)")
    axes.plot(x, y, color=Color.ORANGE, linewidth=1.2, label="top (x, y)")
    for other in (z, y):
        axes.plot(x[0], other[0], "o", color="white", markeredgecolor=Color.BLACK, markersize=6)
        axes.plot(x[-1], other[-1], "o", color=Color.BLACK, markersize=5)
    axes.plot(0, 0, "+", color=Color.VERMILION, markersize=10, label="base_link")
    axes.set_aspect("equal", adjustable="datalim")
    length = np.linalg.norm(np.diff(a.tcp, axis=0), axis=1).sum()
    axes.set(
        title=f"path of the TCP, {number(1e3 * length)} mm from ○ to ●",
        xlabel="x [mm]",
        ylabel="z or y [mm]",
    )
    axes.legend()


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
    look = {"xytext": (0, 6 if value > 0 else -14), "textcoords": "offset points", "fontsize": 8}
    box = {"facecolor": "white", "alpha": 0.75, "linewidth": 0, "pad": 0.5}
    axes.annotate(number(value), (time[at], value), ha="center", bbox=box, **look)


def _bounds(axes: Any, *bounds: float) -> None:
    """Dashed lines at those bounds that are in sight; they do not change what is."""
    low, high = axes.get_ylim()
    axes.set_ylim(low, high)
    for bound in bounds:
        if low <= bound <= high:
            axes.axhline(bound, color=Color.VERMILION, linestyle="--")


def _most(a: Analysis, values: FloatArray, unit: str) -> str:
    """The largest value (N, n) of the arm's joints, and whose it is."""
    sizes = np.nanmax(np.abs(values[:, :4]), axis=0)
    return f"at most {number(sizes.max())} {unit} ({a.smooth.joints[int(sizes.argmax())]})"


def _same_scale(panels: list[Any]) -> None:
    """What is small beside another joint's stays small to see: noise fills no panel."""
    ends = np.array([axes.get_ylim() for axes in panels if axes.has_data()])
    for axes in panels:
        axes.set_ylim(ends[:, 0].min(), ends[:, 1].max())


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
