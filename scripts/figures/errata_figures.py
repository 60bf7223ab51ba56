"""Figures of the errata that matter: the base body, link 3's COB, and the motors."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from figures.concept_figures import ALONG_Y, SIDE, look_at, outline, written_at

import alpha5_model as a5
from alpha5_model._support.paths import REPOSITORY_PATH
from alpha5_model.viewer.figures import Color, new_figure, number, style

MESHES = Path(REPOSITORY_PATH, "meshes")


@style()
def base_frame_figure() -> Any:
    """The base body with COM and COB, in the text's frame {0} and in ours."""
    page = new_figure(9.0, 2.3)
    titles = {
        (): "the text: DH frame {0} after the rotation π",
        ("base_frame",): "ours: DH frame {0} itself",
    }
    for axes, (corrections, title) in zip(
        page.subplots(1, 2, sharey=True), titles.items(), strict=True
    ):
        base = a5.parameters(corrections=corrections).links[0]
        pose = a5.load(corrections=corrections).forward_kinematics(SIDE, "link_0")
        color = Color.GREEN if corrections else Color.VERMILION
        outline(axes, str(MESHES / "link_0.obj"), np.eye(4), ALONG_Y)
        for name, point, shift in (("COM", base.com, 12), ("COB", base.cob, -13)):
            _point(axes, name, ALONG_Y @ pose.act(point), color, shift)
        axes.set_title(title)
        look_at(axes, (-150, 120), (-40, 40))
    return page


@style()
def link3_cob_figure() -> Any:
    """Link 3 with its COB as printed, and as the correction reads it."""
    page = new_figure(5.0, 4.0)
    axes = page.subplots()
    outline(axes, str(MESHES / "link_3.obj"), np.eye(4), ALONG_Y)
    for corrections, name, color in (
        ((), "printed", Color.VERMILION),
        (("link3_cob",), "link3_cob", Color.GREEN),
    ):
        link = a5.parameters(corrections=corrections).links[3]
        _point(axes, name, ALONG_Y @ link.cob, color)
    look_at(axes, (-30, 55), (-30, 40), "z of link_3 [mm]")
    axes.set_xlabel("x of link_3 [mm]")
    axes.set_title("link 3's centre of buoyancy")
    return page


@style()
def motors_figure() -> Any:
    """Friction beside the arm's weight, and the two torques per ampere of Table 4."""
    page = new_figure(9.0, 3.2)
    left, right = page.subplots(1, 2)
    rows = {row.claim: row for row in a5.audit()}

    friction = [rows[f"friction.actuator_{k}"].measured for k in range(4)]
    weight = rows["friction.actuator_0"].expected
    left.barh(JOINTS, friction, color=Color.VERMILION, height=0.5)
    left.axvline(weight, color=Color.BLACK, lw=1.2)
    left.annotate(
        f"largest torque of\nthe arm's weight\n{number(weight)} N·m",
        (weight, 3),
        (30, -6),
        textcoords="offset points",
        fontsize=8,
        arrowprops={"arrowstyle": "-", "lw": 0.6},
    )
    left.set_title("friction at the joint, F·Gr")
    left.set_xlabel("[N·m]")

    at = np.arange(len(JOINTS))
    for offset, constants, label, color in (
        (-0.17, "torque", "by K_t", Color.BLUE),
        (0.17, "voltage", "by K_v", Color.GREEN),
    ):
        per_ampere = [_torque_per_ampere(k, constants) for k in range(4)]
        right.barh(at + offset, per_ampere, height=0.3, color=color, label=label)
    right.set_yticks(at, JOINTS)
    right.set_title("torque per ampere")
    right.set_xlabel("[N·m/A]")
    right.legend(fontsize=8)
    for axes in (left, right):
        axes.invert_yaxis()
    return page


#: Joints of actuators 0 to 3.
JOINTS = ("axis_e", "axis_d", "axis_c", "axis_b")


def _torque_per_ampere(actuator: int, constants: str) -> float:
    p = a5.parameters().actuators[actuator]
    constant = p.torque_constant if constants == "torque" else p.voltage_constant
    return float(constant * p.gear_ratio * p.efficiency)


def _point(axes: Any, name: str, at: np.ndarray, color: str, shift: int = 11) -> None:
    mm = at * 1e3
    axes.plot(*mm, "o", ms=6, color=color, zorder=6)
    written_at(
        axes,
        f"{name} ({', '.join(f'{x:z.0f}' for x in mm)})",
        mm,
        (0, shift),
        ha="center",
    )


FIGURES = {
    "errata_base.png": base_frame_figure,
    "errata_cob.png": link3_cob_figure,
    "errata_motors.png": motors_figure,
}
