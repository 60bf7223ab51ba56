"""Figures of guides and concepts that plot numbers instead of bodies."""

from __future__ import annotations

from typing import Any

import alpha5_model as a5
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


FIGURES = {"uncertainty.png": uncertainty_figure}
