"""Figures of guides and concepts that plot numbers instead of bodies."""

from __future__ import annotations

from typing import Any

import numpy as np
from figures.concept_figures import ALONG_Y, side_view

import alpha5_model as a5
from alpha5_model.viewer import mount_plot
from alpha5_model.viewer.figures import Color, new_figure, number, style

#: The joint whose torque the digits leave open most, and the pose that is shown.
JOINT, POSE = "axis_d", "reach"
#: How many of the printed numbers are shown.
MOST = 9


@style()
def uncertainty_figure() -> Any:
    """What each printed number contributes to the uncertainty of one torque."""
    arm = a5.load()
    q = a5.named_pose(POSE)
    found = a5.uncertainty.sensitivity(
        lambda parameters: a5.uncertainty.arm(parameters).hydrostatic_torque(q)
    )
    joint = arm.joint_names.index(JOINT)
    shown = found.most(joint, count=MOST)
    names = [name for name, _ in shown]
    widths = [1e3 * abs(width) for _, width in shown]

    page = new_figure(7.0, 3.6)
    axes = page.add_subplot()
    axes.barh(names, widths, color=Color.BLUE)
    for place, width in enumerate(widths):
        axes.annotate(f" {number(width)}", (width, place), va="center")
    axes.invert_yaxis()
    axes.margins(x=0.12)
    axes.set_xlabel(f"share of the half width of the torque of {JOINT} [mN m]")
    axes.set_title(f"Which digits matter at the pose {POSE}, in sea water")
    return page


#: Speeds of the current [m/s], and how many random poses and directions.
FASTEST, POSES = 1.5, 4000


def loads_of_current(level: str) -> np.ndarray:
    """Median load of 1 m/s: force [N], moment, axis_e, axis_d, axis_c [N m], (5,)."""
    rng = np.random.default_rng(0)
    arm = a5.load()
    wet = arm.with_hydrodynamics(level=level)
    limits = arm.limits
    q = rng.uniform(limits.lower, limits.upper, (POSES, 4))
    direction = rng.normal(size=(POSES, 3))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    still = np.zeros_like(q)
    torque = wet.inverse_dynamics_batch(q, still, still, water_velocity=direction)
    torque -= arm.inverse_dynamics_batch(q, still, still)
    wrench = wet.base_wrench_batch(q, still, still, water_velocity=direction)
    wrench -= arm.base_wrench_batch(q, still, still)
    sizes = np.linalg.norm(wrench.reshape(-1, 2, 3), axis=2)
    return np.median(np.column_stack([sizes, np.abs(torque[:, :3])]), axis=0)


@style(axes={"grid": True}, grid={"color": "#E6E6E6", "linewidth": 0.6})
def current_figure() -> Any:
    """The load of a current over its speed, each with its interval."""
    low, nominal, high = (loads_of_current(x) for x in ("low", "nominal", "high"))
    speed = np.linspace(0.0, FASTEST, 61)
    names = ("force", "moment", "axis_e", "axis_d", "axis_c")
    colors = (Color.BLUE, Color.BLUE, Color.VERMILION, Color.GREEN, Color.PINK)
    panels = ((0,), (1,), (2, 3, 4))
    titles = ("force on the mount [N]", "moment on it [N m]", "joint torque [N m]")

    page = new_figure(10.0, 3.2)
    for axes, shown, title in zip(page.subplots(1, 3), panels, titles, strict=True):
        for k in shown:
            band = (low[k] * speed**2, high[k] * speed**2)
            axes.fill_between(speed, *band, color=colors[k], alpha=0.15, linewidth=0)
            line = nominal[k] * speed**2
            axes.plot(speed, line, color=colors[k], label=names[k])
        axes.set_title(title)
        axes.set_xlabel("current [m/s]")
        axes.set_xlim(0.0, FASTEST)
        axes.set_ylim(bottom=0.0)
        if len(shown) > 1:
            axes.legend(loc="upper left", frameon=False)
    return page


#: Devices 5, 4, 3, 2 in the poses by which a reader checks an arm [rad], and from
#: where each is seen: from the side, or from above.
TURN = np.pi / 2
ABOVE = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
CHECK_POSES = (
    ((2 * TURN, TURN, TURN, 0.0), ALONG_Y),
    ((2 * TURN, TURN, 2 * TURN, 0.0), ALONG_Y),
    ((3 * TURN, TURN, TURN, TURN), ABOVE),
)


def check_position(devices: tuple[float, ...]) -> np.ndarray:
    """The joint position of devices 5, 4, 3, 2, (4,) [rad]."""
    return a5.q_from_devices(dict(zip((5, 4, 3, 2), devices, strict=True)))


@style()
def check_poses_figure() -> Any:
    """The three poses of the guide "From the arm to q", each with its tip."""
    arm = a5.load()
    page = new_figure(10.0, 3.2)
    panels = page.subplots(1, len(CHECK_POSES))
    for number_of, (axes, (devices, view)) in enumerate(
        zip(panels, CHECK_POSES, strict=True), start=1
    ):
        q = check_position(devices)
        side_view(axes, q, view)
        tip = 1e3 * view @ arm.forward_kinematics(q, "tcp").translation
        axes.plot(0.0, 0.0, "+", color=Color.BLACK, markersize=10)
        axes.plot(*tip, "o", color=Color.VERMILION)
        text = f"tip {tip[0]:z.0f}, {tip[1]:z.0f}"
        side = "right" if tip[0] > 250 else "left"
        axes.annotate(text, tip, (8, 8), textcoords="offset points", ha=side)
        across = "z" if view is ALONG_Y else "y"
        seen = "from the side" if view is ALONG_Y else "from above"
        axes.set_title(f"pose {number_of}, seen {seen}")
        axes.set_xlabel("x [mm]")
        axes.set_ylabel(f"{across} [mm]")
        axes.set_aspect("equal")
        axes.set_xlim(-200, 460)
        axes.set_ylim(-160, 340)
    return page


def mount_load_figure() -> Any:
    """The load of a current of 0.5 m/s on the mount, over its direction."""
    return mount_plot.mount_load_figure(a5.load(), a5.named_pose("reach"), speed=0.5)


FIGURES = {
    "mount_load.png": mount_load_figure,
    "uncertainty.png": uncertainty_figure,
    "current.png": current_figure,
    "check_poses.png": check_poses_figure,
}
