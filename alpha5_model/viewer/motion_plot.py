"""Plot of an analysed motion: positions, torques, currents, power, mount, path."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.viewer.figures import CAUSES, Color, new_figure, number, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from alpha5_model.trajectory.analysis import Analysis

#: Most stretches of a curve; of a longer one, the extremes of each are drawn.
_STRETCHES = 2000
#: Most points at which the band of the printed digits is computed.
_BAND_POINTS = 500
#: Widths of the curves of `CAUSES`.
_CAUSE_WIDTHS = (3.8, 3.2, 2.9, 1.3, 1.3)
#: Least heights of the panels of torques [N m] and currents [A].
_LEAST_TORQUE = 1e-3
_LEAST_CURRENT = 1e-2
_GRAY = "#999999"
#: Behind a text, so that it stays readable over a curve.
_PAPER = {"facecolor": "white", "alpha": 0.75, "linewidth": 0, "pad": 0.5}


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

    One row for each joint (position, torque by cause, motor current) and one for the
    whole arm (power, load on the mount, TCP path).
    """
    rows = len(analysis.smooth.joints)
    page = new_figure(16, 2.35 * rows + 4.2)
    page.get_layout_engine().set(h_pad=0.06, w_pad=0.08)
    panels = page.subplots(rows + 1, 3, height_ratios=[1.0] * rows + [1.6])
    # All but the path of the TCP, which is the last, have the same time axis.
    for axes in page.axes[1:-1]:
        axes.sharex(page.axes[0])

    for k, (position, torque, current) in enumerate(panels[:-1]):
        _draw_position(position, analysis, k)
        _draw_torque(torque, analysis, k)
        _draw_current(current, analysis, k)
        for axes in (position, torque, current):
            axes.tick_params(labelbottom=False)
    power, mount, path = panels[-1]
    _draw_power(power, analysis)
    _draw_mount(mount, analysis)
    _draw_path(path, analysis)
    for axes in (power, mount, path):
        axes.legend(loc="upper left", bbox_to_anchor=(0.0, -0.13), ncols=3)

    # The lowest current has the path below it, which has no time axis.
    lowest_current = panels[-2, 2]
    lowest_current.tick_params(labelbottom=True)
    for axes in (lowest_current, power, mount):
        axes.set_xlabel("time [s]")
    _title_columns(panels[:-1], analysis)
    _title_page(page, panels[0, 1], analysis)
    return page


def _title_columns(panels: Any, analysis: Analysis) -> None:
    """Titles over the columns of the joints' panels (n, 3)."""
    positions, torques, currents = panels.T
    positions[0].set_title("joint position (dots: samples)")
    joints = analysis.smooth.joints
    most = _most(analysis.torque, joints, "N·m")
    torques[0].set_title(f"joint torque by cause, {most}")
    most = _most(analysis.current, joints, "A")
    currents[0].set_title(f"motor current, {most}; band: friction")


def _most(values: FloatArray, joints: tuple[str, ...], unit: str) -> str:
    """The largest magnitude of values (N, n) among the rotary joints, and its joint."""
    sizes = np.nanmax(np.abs(values[:, :4]), axis=0)
    return f"at most {number(sizes.max())} {unit} ({joints[int(sizes.argmax())]})"


def _title_page(page: Any, torque_axes: Axes, analysis: Analysis) -> None:
    """The legend of the torques beside the title of the page."""
    handles, names = torque_axes.get_legend_handles_labels()
    # There is room for five names in a row.
    columns = -(-len(names) // (1 + len(names) // 6))
    page.legend(handles, names, ncols=columns, fontsize=10, loc="outside upper right")
    page.align_ylabels()
    page.suptitle(_title(analysis), fontsize=12, x=0.01, ha="left")


def _title(analysis: Analysis) -> str:
    """Source, fluid, smoothing and motor constants, in one line."""
    smooth = analysis.smooth
    fluid = f"{len(smooth.time)} samples; fluid {analysis.arm.fluid_density:g} kg/m³"
    if analysis.moving_water is not None:
        current = ", ".join(f"{x:g}" for x in analysis.moving_water.water_velocity)
        fluid += f"; current ({current}) m/s, its effect estimated"
    width = "" if smooth.bandwidth is None else f" {smooth.bandwidth:.3g} Hz"
    constants = analysis.actuators[0].constants
    method = f"{smooth.method}{width}; motor constants: {constants}"
    return f"{Path(analysis.motion.source).name}   ({fluid}; {method})"


# ---- one joint


def _draw_position(axes: Axes, analysis: Analysis, k: int) -> None:
    name = analysis.arm.joint_names[k]
    lower = analysis.arm.limits.lower[k]
    upper = analysis.arm.limits.upper[k]
    scale, unit = (1e3, "mm") if name == "axis_a" else (180 / np.pi, "°")
    samples = thin(analysis.motion.time, scale * analysis.motion.position[:, k])
    axes.plot(*samples, ".", color=_GRAY, markersize=4, label="samples")
    _curve(axes, analysis, scale * analysis.smooth.position[:, k], color=Color.BLUE)

    _span_at_least(axes, 0.04 * scale * (upper - lower))
    _bounds(axes, scale * lower, scale * upper)
    axes.set_ylabel(f"{name} [{unit}]")


def _draw_torque(axes: Axes, analysis: Analysis, k: int) -> None:
    smooth = analysis.smooth
    torque = analysis.torque[:, k]
    _draw_causes(axes, analysis, k)
    if analysis.moving_water is not None:
        low, _, high = analysis.moving_water.torque[:, :, k].T
        _band(axes, analysis, low, high)
    _draw_digits(axes, analysis, k)
    look: dict[str, Any] = {"color": Color.BLACK, "linewidth": 1.3}
    _curve(axes, analysis, torque, **look, label="torque")
    if analysis.effort is not None:
        _draw_recorded(axes, analysis, analysis.effort[:, k], "recorded effort")
    _mark(axes, smooth.time, torque)
    _span_at_least(axes, _LEAST_TORQUE)
    unit = "N" if k == 4 else "N·m"
    axes.set_ylabel(f"{smooth.joints[k]} [{unit}]")


def _draw_recorded(
    axes: Axes, analysis: Analysis, values: FloatArray, label: str
) -> None:
    """What was recorded, behind what was computed."""
    there = np.isfinite(values)
    recorded = thin(analysis.smooth.time[there], values[there])
    axes.plot(*recorded, color=_GRAY, zorder=1, label=label)


def _draw_causes(axes: Axes, analysis: Analysis, k: int) -> None:
    causes = analysis.causes()
    for width, (cause, color) in zip(_CAUSE_WIDTHS, CAUSES.items(), strict=True):
        if cause in causes:
            look: dict[str, Any] = {"color": color, "linewidth": width}
            label = cause.replace("_", " ")
            _curve(axes, analysis, causes[cause][:, k], **look, label=label)


def _draw_digits(axes: Axes, analysis: Analysis, k: int) -> None:
    """The band of torques that the printed digits allow."""
    from alpha5_model.dynamics.dimensions import has_dimensions
    from alpha5_model.numbers.parameters import is_catalogue
    from alpha5_model.studies.uncertainty.digit_bounds import torque_margin

    arm = analysis.arm
    if not has_dimensions(arm._model, arm=arm.parameters):
        return
    smooth = analysis.smooth
    step = -(-len(smooth.time) // _BAND_POINTS)
    margin = torque_margin(
        arm,
        smooth.position[::step],
        smooth.velocity[::step],
        smooth.acceleration[::step],
    )
    low, high = analysis.torque[::step, k] + margin[..., k]
    look: dict[str, Any] = {"color": _GRAY, "linewidth": 0}
    label = "printed digits" if is_catalogue(arm.parameters) else "digits, half widths"
    axes.fill_between(smooth.time[::step], low, high, **look, label=label)


def _draw_current(axes: Axes, analysis: Analysis, k: int) -> None:
    axes.set_ylabel(f"{analysis.smooth.joints[k]} [A]")
    current = analysis.current[:, k]
    if not np.isfinite(current).all():
        axes.text(
            0.5,
            0.5,
            "the lead of the jaw's screw is not published",
            color="#777777",
            fontsize=9,
            ha="center",
            va="center",
            transform=axes.transAxes,
        )
        axes.set_yticks([])
        return
    if analysis.recorded_current is not None:
        recorded = analysis.recorded_current[:, k]
        _draw_recorded(axes, analysis, recorded, "recorded current")
    _band(axes, analysis, analysis.current_lower[:, k], analysis.current_upper[:, k])
    _curve(axes, analysis, current, color=Color.BLUE)
    _mark(axes, analysis.smooth.time, current)
    _span_at_least(axes, _LEAST_CURRENT)
    limit = analysis.current_limits[k] if analysis.current_limits else None
    if limit is not None:
        _bounds(axes, -limit, limit)


# ---- the whole arm


def _draw_power(axes: Axes, analysis: Analysis) -> None:
    electrical = np.nansum(analysis.electrical_power, axis=1)
    mechanical = analysis.mechanical_power.sum(axis=1)
    for values, color, label in (
        (electrical, Color.BLUE, "electrical"),
        (mechanical, Color.VERMILION, "mechanical"),
    ):
        _curve(axes, analysis, values, color=color, linewidth=1.1, label=label)
    most = number(electrical.max())
    most_mechanical = number(mechanical.max())
    sizes = f"at most {most} W, {most_mechanical} W mechanical"
    axes.set(title=f"power of all motors, {sizes}", ylabel="power [W]")


def _draw_mount(axes: Axes, analysis: Analysis) -> None:
    force = analysis.base_wrench[:, :3]
    moment = analysis.base_wrench[:, 3:]
    for component, color, width, name in (
        (0, Color.VERMILION, 2.6, "x"),
        (1, Color.GREEN, 1.8, "y"),
        (2, Color.BLUE, 1.0, "z"),
    ):
        look: dict[str, Any] = {"color": color, "linewidth": width}
        _curve(axes, analysis, moment[:, component], **look, label=f"moment {name}")
    most_force = number(np.linalg.norm(force, axis=1).max())
    most_moment = number(np.linalg.norm(moment.T, axis=0).max())
    most = f"{most_moment} N·m (force {most_force} N)"
    axes.set(title=f"moment on the mount, at most {most}", ylabel="moment [N·m]")


def _draw_path(axes: Axes, analysis: Analysis) -> None:
    x, y, z = 1e3 * analysis.tcp.T
    axes.plot(x, z, color=Color.BLUE, linewidth=1.2, label="side (x, z)")
    axes.plot(x, y, color=Color.ORANGE, linewidth=1.2, label="top (x, y)")
    for other in (z, y):
        (start,) = axes.plot(x[0], other[0], "o", color="white", markersize=6)
        start.set_markeredgecolor(Color.BLACK)
        axes.plot(x[-1], other[-1], "o", color=Color.BLACK, markersize=5)
    axes.plot(0, 0, "+", color=Color.VERMILION, markersize=10, label="base_link")
    axes.set_aspect("equal", adjustable="datalim")
    steps = np.linalg.norm(np.diff(analysis.tcp, axis=0), axis=1)
    title = f"path of the TCP, {number(1e3 * steps.sum())} mm from ○ to ●"
    axes.set(title=title, xlabel="x [mm]", ylabel="z or y [mm]")


# ---- curves, bands and marks


def _curve(axes: Axes, analysis: Analysis, values: FloatArray, **options: Any) -> None:
    """A quantity (N,) over time."""
    axes.plot(*thin(analysis.smooth.time, values), **options)


def _band(axes: Axes, analysis: Analysis, one: FloatArray, other: FloatArray) -> None:
    """What lies between two quantities (N,) over time."""
    time, end = thin(analysis.smooth.time, one)
    other_end = np.interp(time, analysis.smooth.time, other)
    axes.fill_between(time, end, other_end, color="#9ECAE9", linewidth=0)


def _mark(axes: Axes, time: FloatArray, values: FloatArray) -> None:
    """A dot at the value with the largest magnitude, with its number."""
    at = int(np.abs(values).argmax())
    value = values[at]
    axes.margins(y=0.18)
    axes.plot(time[at], value, "o", color=Color.BLACK, markersize=4)
    axes.annotate(
        number(value),
        (time[at], value),
        ha="center",
        bbox=_PAPER,
        xytext=(0, 6 if value > 0 else -14),
        textcoords="offset points",
        fontsize=8,
    )


def _span_at_least(axes: Axes, least: float) -> None:
    """Widen the axis of the values, so that noise does not fill the panel."""
    low, high = axes.get_ylim()
    spare = max(0.0, least - (high - low)) / 2
    axes.set_ylim(low - spare, high + spare)


def _bounds(axes: Axes, *bounds: float) -> None:
    """Dashed lines, which leave the limits of the axis as they are."""
    axes.set_ylim(axes.get_ylim())
    for bound in bounds:
        axes.axhline(bound, color=Color.VERMILION, linestyle="--")


def thin(time: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Lowest and highest point of each of `_STRETCHES` stretches, and the last."""
    stretch = -(-len(time) // _STRETCHES)
    if stretch <= 2:
        return time, values
    whole = len(time) // stretch * stretch
    rows = np.asarray(values[:whole]).reshape(-1, stretch)
    start = np.arange(0, whole, stretch)
    lowest = start + rows.argmin(axis=1)
    highest = start + rows.argmax(axis=1)
    in_order = np.sort(np.stack([lowest, highest], axis=1))
    index = np.append(in_order.ravel(), len(time) - 1)
    return time[index], values[index]
