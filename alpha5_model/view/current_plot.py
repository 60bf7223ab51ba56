"""Load on the mount over the direction of a current, as two polar pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.hydrodynamics import LEVELS
from alpha5_model.view.figures import Color, new_figure, style

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm

#: Directions of the current; the last is the first again.
_DIRECTIONS = 73


@style(axes={"grid": True, "titlesize": 11, "titlepad": 18}, legend={"fontsize": 8})
def figure(arm: Arm, q: ArrayLike, speed: float) -> Any:
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
    names = ("force [N]", Color.BLUE), ("moment [N m]", Color.VERMILION)
    for axes, (name, color), (low, nominal, high) in zip(
        subplots, names, sizes.transpose(2, 0, 1), strict=True
    ):
        axes.fill_between(
            angle, low, high, color=color, alpha=0.2, linewidth=0, label="low to high"
        )
        axes.plot(angle, nominal, color=color, linewidth=1.6, label="nominal")
        axes.set(title=name, rmin=0.0)
        axes.set_xticks(np.arange(0, 2 * np.pi, np.pi / 2), ["x", "y", "-x", "-y"])
        axes.legend(loc="lower left", bbox_to_anchor=(-0.12, -0.12))
    pose = ", ".join(f"{x:.2f}" for x in np.asarray(q))
    title = f"load of a current of {speed:g} m/s on the mount, by where it flows to; estimated, not published"
    page.suptitle(f"{title}\nq = ({pose}), fluid {arm.fluid_density:g} kg/m³", fontsize=10)
    return page
