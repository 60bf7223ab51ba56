"""Plot of the load of a current on the mount of an arm."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers.hydrodynamics import LEVELS
from alpha5_model.viewer.figures import (
    Color,
    new_figure,
    number,
    style,
    with_minus_signs,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from alpha5_model.dynamics.arm import Arm

#: Directions of the current; the last is the first again.
_DIRECTIONS = 73


class _Load(NamedTuple):
    """Size of the load by direction, (`_DIRECTIONS`,), by level of the estimates."""

    low: FloatArray
    nominal: FloatArray
    high: FloatArray


@style(axes={"grid": True, "titlesize": 11, "titlepad": 18}, legend={"fontsize": 8})
def mount_load_figure(arm: Arm, q: ArrayLike, speed: float) -> Any:
    """Plot the load of a level current on the mount, as a matplotlib Figure.

    Force and moment are those of an arm at rest, for each direction of the current.

    Lines are nominal, bands go from all numbers low to all high; they are estimated,
    not published.

    Args:
        arm: On a fixed base.
        q: (nq,).
        speed: Of the current, in the plane x, y of base_link [m/s].
    """
    angle = np.linspace(0, 2 * np.pi, _DIRECTIONS)
    force, moment = _loads(arm, q, speed, angle)
    page = new_figure(10.5, 5.4)
    left, right = page.subplots(1, 2, subplot_kw={"projection": "polar"})
    _draw(left, angle, force, "force", "N", Color.BLUE)
    _draw(right, angle, moment, "moment", "N·m", Color.VERMILION)

    most = f"{number(force.nominal.max())} N and {number(moment.nominal.max())} N·m"
    load = f"at most {most} by where it flows to; estimated, not published"
    title = f"A current of {speed:g} m/s loads the mount with {load}"
    pose = with_minus_signs(", ".join(f"{x:.2f}" for x in np.asarray(q)))
    state = f"q = ({pose}), fluid {arm.fluid_density:g} kg/m³"
    page.suptitle(f"{title}\n{state}", fontsize=10)
    return page


def _loads(
    arm: Arm, q: ArrayLike, speed: float, angle: FloatArray
) -> tuple[_Load, _Load]:
    """Size of the force [N] and of the moment [N m] on the mount."""
    directions = np.column_stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)])
    currents = speed * directions
    forces = []
    moments = []
    for level in LEVELS:
        wet = arm.with_hydrodynamics(level=level)
        wrenches = np.array([wet.current_load(q, velocity)[1] for velocity in currents])
        forces.append(np.linalg.norm(wrenches[:, :3], axis=1))
        moments.append(np.linalg.norm(wrenches[:, 3:], axis=1))
    return _Load(*forces), _Load(*moments)


def _draw(
    axes: Axes, angle: FloatArray, load: _Load, name: str, unit: str, color: Color
) -> None:
    axes.fill_between(
        angle,
        load.low,
        load.high,
        label="all numbers low to all high",
        color=color,
        alpha=0.2,
        linewidth=0,
    )
    axes.plot(angle, load.nominal, color=color, linewidth=1.6, label="nominal")
    least = number(load.nominal.min())
    most = number(load.nominal.max())
    axes.set(title=f"{name}, {least} to {most} {unit}", rmin=0.0)
    quarters = np.arange(0, 2 * np.pi, np.pi / 2)
    axes.set_xticks(quarters, ["x", "y", "\u2212x", "\u2212y"])
    axes.tick_params(axis="y", labelsize=8)
    for text in axes.get_yticklabels():
        text.set_bbox({"facecolor": "white", "alpha": 0.75, "linewidth": 0, "pad": 1})
    axes.legend(loc="lower left", bbox_to_anchor=(-0.12, -0.12))
