"""A picture of how far another model is off."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from alpha5_model.errors import InputError
from alpha5_model.view.figures import new_figure, style, write_figure

if TYPE_CHECKING:
    from alpha5_model.comparison.records import Comparison


@style({"xtick.labelsize": 8, "ytick.labelsize": 8})
def plot_comparison(comparison: Comparison, path: str | os.PathLike[str]) -> Path:
    """Draw the errors of mass, COM and inertia per body and of the gravity torque per joint.

    Args:
        comparison: What `alpha5_model.compare` returns.
        path: Picture to write; the suffix says how: ``.png``, ``.pdf`` or ``.svg``.

    Raises:
        InputError: Of another arm, which has no errors to draw.
        UnknownNameError: Another suffix.
        MissingDependencyError: matplotlib is not installed.
        OutputError: It cannot be written.
    """
    if not comparison.joints:
        raise InputError("comparison", comparison.verdict, "one of a Reach Alpha 5")
    bodies = [body.name for body in comparison.bodies]
    panels = (
        ("mass [g]", bodies, [body.mass_error * 1e3 for body in comparison.bodies]),
        ("COM [mm]", bodies, [body.com_error * 1e3 for body in comparison.bodies]),
        ("inertia [kg mm²]", bodies, [body.inertia_error * 1e6 for body in comparison.bodies]),
        ("gravity torque [N m]", list(comparison.joints), list(comparison.gravity_error)),
    )
    figure = new_figure(11, 3.2)
    for axes, (title, names, values) in zip(figure.subplots(1, 4), panels, strict=True):
        # Rounding of the arithmetic is no error to look at: it would stretch to the full width.
        values = [value if abs(value) > 1e-9 else 0.0 for value in values]
        bars = axes.barh(names, values, color="#c0504d")
        axes.bar_label(bars, fmt=lambda v: f"{v:.3g}", padding=3, fontsize=8)
        axes.invert_yaxis()
        axes.margins(x=0.25)
        axes.axvline(0, color="black", linewidth=0.8)
        axes.set_title(title)
    verdict = "agrees with" if comparison.agrees else "differs from"
    figure.suptitle(f"{comparison.name} {verdict} the tables: largest errors", fontsize=11)
    return write_figure(figure, path, dpi=150)
