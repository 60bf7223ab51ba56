"""Plot of the errors that `alpha5_model.compare` finds."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import PathLike
from alpha5_model.errors import InputError
from alpha5_model.viewer.figures import Color, new_figure, number, style, write_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from alpha5_model.proofs.comparison.described import Described
    from alpha5_model.proofs.comparison.result import Comparison

#: Smaller errors are rounding, in any of the panels' units.
_ROUNDING = 1e-9


class _Panel(NamedTuple):
    """Errors of one quantity, for each body or joint.

    Attributes:
        quantity, unit: Its name and unit.
        names: Of the bodies or joints.
        errors: In the unit.
    """

    quantity: str
    unit: str
    names: list[str]
    errors: FloatArray


@style(xtick={"labelsize": 8}, ytick={"labelsize": 8})
def plot_comparison(comparison: Comparison, path: PathLike) -> Path:
    """Draw the errors of the lengths, of each body, and of gravity torque by joint.

    Args:
        comparison: What `alpha5_model.compare` returns.
        path: Picture to write: ``.png``, ``.pdf`` or ``.svg``.

    Raises:
        InputError: Of another arm, which has no errors to draw.
        UnknownNameError: Another suffix.
        MissingDependencyError: matplotlib is not installed.
        OutputError: It cannot be written.
    """
    alignment = comparison.alignment
    if alignment is None:
        raise InputError("comparison", comparison.verdict, "one of a Reach Alpha 5")
    figure = new_figure(13.5, 3.6)
    panels = _panels(comparison, alignment)
    for axes, panel in zip(figure.subplots(1, 5), panels, strict=True):
        _draw(axes, panel)
    verdict = "agrees with" if comparison.agrees else "differs from"
    title = f"The arm in {comparison.name} {verdict} the tables: errors"
    figure.suptitle(title, fontsize=11, wrap=True)
    return write_figure(figure, path)


def _panels(comparison: Comparison, alignment: Described) -> list[_Panel]:
    bodies = comparison.bodies
    names = [body.name for body in bodies]
    joints = list(comparison.joints)
    lengths = np.array(alignment.changes[:4])
    mass = np.array([body.mass_error for body in bodies])
    com = np.array([body.com_error for body in bodies])
    inertia = np.array([body.inertia_error for body in bodies])
    gravity = np.array(comparison.gravity_error)
    return [
        _Panel("length", "mm", ["a_0", "a_1", "a_2", "d_1"], 1e3 * lengths),
        _Panel("mass", "g", names, 1e3 * mass),
        _Panel("COM", "mm", names, 1e3 * com),
        _Panel("inertia", "kg·mm²", names, 1e6 * inertia),
        _Panel("gravity torque", "N·m", joints, gravity),
    ]


def _draw(axes: Axes, panel: _Panel) -> None:
    # Rounding errors alone would fill the panel.
    errors = np.where(np.abs(panel.errors) > _ROUNDING, panel.errors, 0.0)
    bars = axes.barh(panel.names, errors, color=Color.VERMILION)
    axes.bar_label(bars, fmt=number, padding=3, fontsize=8)
    axes.invert_yaxis()
    axes.margins(x=0.3)
    axes.axvline(0, color="black", linewidth=0.8)
    largest = number(np.abs(errors).max())
    axes.set_title(f"{panel.quantity}\nup to {largest} {panel.unit}")
