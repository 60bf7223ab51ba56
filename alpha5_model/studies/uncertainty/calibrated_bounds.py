"""Bounds of what a calibrated arm does, by numbers that are known together.

The numbers are within the ellipsoid of their covariance whose half widths are those of
the arm file. A quantity with gradient g changes by at most ``|R^T g|`` there, with R
the root of the covariance, to first order in all numbers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.dynamics.arm import Arm
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.numbers.arm_checks import LENGTHS
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.studies.uncertainty.arm_numbers import ArmNumbers, are_lengths
from alpha5_model.studies.uncertainty.carried import base_parameters_carried
from alpha5_model.studies.uncertainty.linear_maps import split

#: Of central differences by angles and lengths [rad, m].
_STEP = 1e-5
#: Quantities by base parameters, (N, ..., 38), of a `Geometry`'s dimensions (24,).
Linear = Callable[[FloatArray], FloatArray]


def without_calibrated(numbers: ArmNumbers) -> ArmNumbers:
    """The same numbers, those of the covariance taken as known."""
    assert numbers.calibrated is not None
    half_width = numbers.half_width.copy()
    half_width[numbers.calibrated.rows] = 0.0
    return replace(numbers, half_width=half_width)


def calibrated_half_width(linear: Linear, arm: Arm, numbers: ArmNumbers) -> FloatArray:
    """How far the numbers of a covariance move quantities, (N, ...).

    Args:
        linear: The quantities.
        arm: On a fixed base, with its jaws locked and all that it carries.
        numbers: Of its record, with a covariance.
    """
    found = numbers.calibrated
    assert found is not None
    at_middle = linear(_dimensions(numbers.arm))
    by_bodies = at_middle @ _body_slopes(numbers, arm.fluid_density)[found.rows].T
    for k, row in enumerate(found.rows.tolist()):
        moved = _moved(numbers.arm, numbers.names[row])
        if moved is not None:
            after, before = (_value(linear, arm, other) for other in moved)
            by_bodies[..., k] = (after - before) / (2 * _STEP)
    return np.asarray(np.linalg.norm(by_bodies @ found.root, axis=-1))


def half_width_by_lengths(linear: Linear, arm: Arm, numbers: ArmNumbers) -> FloatArray:
    """How far the digits of the lengths move quantities, each alone, (N, ...).

    Args:
        linear: The quantities.
        arm: On a fixed base, with its jaws locked and all that it carries.
        numbers: Of its record.
    """
    total = np.zeros(1)
    rows = [] if numbers.calibrated is None else numbers.calibrated.rows.tolist()
    for k in np.flatnonzero(are_lengths(numbers.names) & (numbers.half_width > 0)):
        if k in rows:
            continue
        ends = []
        for side in (-1, 1):
            values = numbers.middle.copy()
            values[k] += side * numbers.half_width[k]
            ends.append(_value(linear, arm, numbers.parameters(values)))
        total = total + np.abs(ends[1] - ends[0]) / 2
    return np.asarray(total)


def _value(linear: Linear, arm: Arm, record: Alpha5Parameters) -> FloatArray:
    """Quantities of an arm with the links and joints of another record, (N, ...)."""
    carried = base_parameters_carried(arm, record)
    return np.asarray(linear(_dimensions(record)) @ carried)


def _body_slopes(numbers: ArmNumbers, density: float) -> FloatArray:
    """Derivative of the base parameters by the numbers, at the middle, (K, 38)."""
    bodies = split(numbers.bodies(numbers.middle))
    change = split(numbers.to_bodies)
    mass = bodies.mass[..., None]
    volume = bodies.volume[..., None]
    by_mass = change.mass[..., None]
    rows, columns = np.triu_indices(3)
    square = _products(change.com, bodies.com, rows, columns)
    parts = [
        by_mass,
        by_mass * bodies.com + mass * change.com,
        change.second
        + by_mass * bodies.com[..., rows] * bodies.com[..., columns]
        + mass * square,
        change.volume[..., None],
        change.volume[..., None] * bodies.cob + volume * change.cob,
    ]
    moments = np.concatenate(parts, axis=-1)
    return np.asarray(np.tensordot(moments, numbers.grouping(density), 2))


def _products(one: FloatArray, other: FloatArray, rows: Any, columns: Any) -> Any:
    """Entries of ``a b^T + b a^T`` for vectors a and b."""
    return one[..., rows] * other[..., columns] + other[..., rows] * one[..., columns]


def _moved(
    arm: Alpha5Parameters, name: str
) -> tuple[Alpha5Parameters, Alpha5Parameters] | None:
    """The arm with a zero or a length a step longer and shorter; None for others."""
    place = _place(name)
    if place is None:
        return None
    row, field = place
    return _with(arm, row, field, _STEP), _with(arm, row, field, -_STEP)


def _place(name: str) -> tuple[int, str] | None:
    """Row and field of Table 1 of a zero or length."""
    table, _, key = name.partition(".")
    if table == "zeros":
        return JOINT_NAMES.index(key), "theta_offset"
    for length, (row, field) in LENGTHS.items():
        if name in (f"lengths.{length}", f"link_{row}.{field}"):
            return row, field
    return None


def _with(
    arm: Alpha5Parameters, row: int, field: str, change: float
) -> Alpha5Parameters:
    rows = list(arm.dh)
    own: dict[str, Any] = {field: getattr(rows[row], field) + change}
    rows[row] = replace(rows[row], **own)
    # No torque depends on the tool, which a spacer keeps at the end of the last length.
    return replace(arm, dh=tuple(rows), tool=None)


def _dimensions(arm: Alpha5Parameters) -> FloatArray:
    return Geometry.of(arm).dimensions
