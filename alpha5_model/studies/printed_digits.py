"""The interval that the printed digits of each number of Tables 1 to 4 leave open.

A printed number stands for all numbers that round to it: 0.38 kg is 0.375 to 0.385 kg.
Friction has the tolerance that is printed with it. Zeros of Table 1 are exact, since
axes that intersect are not measured.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from alpha5_model.numbers.arm_checks import LENGTHS
from alpha5_model.numbers.arm_schema import ACTUATORS
from alpha5_model.numbers.printed import published
from alpha5_model.numbers.quantity import Quantity
from alpha5_model.numbers.tables import BODY_NAMES, JOINT_NAMES

#: Entries of a symmetric matrix by their names in an arm file, in its order.
UPPER = {
    "xx": (0, 0),
    "xy": (0, 1),
    "xz": (0, 2),
    "yy": (1, 1),
    "yz": (1, 2),
    "zz": (2, 2),
}
#: Makes a symmetric matrix of these entries: ``six[SYMMETRIC]`` is (3, 3).
SYMMETRIC = np.array([[0, 1, 2], [1, 3, 4], [2, 4, 5]])


@dataclass(frozen=True)
class PrintedNumber:
    """A number of Tables 1 to 4 and its interval, SI units.

    Attributes:
        name: Its key in an arm file and its component: ``links.link_2.mass``,
            ``links.link_3.cob.z``, ``lengths.a_2``, ``motors.friction.axis_e``. The
            length a_1 and the elbow's angle follow from ``elbow.opposite`` and
            ``elbow.adjacent``, the two lengths in Table 1's caption.
        printed: Digits and unit as printed.
        value: Of the printed digits. Products of inertia have URDF's sign.
        half_width: The true value is within this of it.
    """

    name: str
    printed: Quantity
    value: float
    half_width: float

    @property
    def lower(self) -> float:
        """Lower end of the interval."""
        return self.value - self.half_width

    @property
    def upper(self) -> float:
        """Upper end of the interval."""
        return self.value + self.half_width


def printed_numbers() -> dict[str, PrintedNumber]:
    """Every uncertain number of Tables 1 to 4 by its name, see `PrintedNumber`."""
    return dict(_printed_numbers())


@cache
def _printed_numbers() -> dict[str, PrintedNumber]:
    tables = published()
    found: dict[str, Quantity] = {}
    bodies = zip(BODY_NAMES, tables.table_2.rows, tables.table_3.rows, strict=True)
    for link, inertial, buoyancy in bodies:
        key = f"links.{link}"
        found[f"{key}.mass"] = inertial.mass
        for axis, number in zip("xyz", inertial.com, strict=True):
            found[f"{key}.com.{axis}"] = number
        for axes, (row, column) in UPPER.items():
            found[f"{key}.inertia.{axes}"] = inertial.inertia_com[row][column]
        found[f"{key}.volume"] = buoyancy.volume
        for axis, number in zip("xyz", buoyancy.cob, strict=True):
            found[f"{key}.cob.{axis}"] = number

    for length, (i, field) in LENGTHS.items():
        if length != "a_1":
            found[f"lengths.{length}"] = getattr(tables.table_1.rows[i], field)
    found["elbow.opposite"] = tables.elbow.opposite
    found["elbow.adjacent"] = tables.elbow.adjacent

    for joint, motor in zip(JOINT_NAMES, tables.table_4.rows, strict=True):
        for field in ACTUATORS:
            if field != "friction_tolerance":
                found[f"motors.{field}.{joint}"] = getattr(motor, field)

    out = {}
    for name, number in found.items():
        is_product = ".inertia." in name and name[-1] != name[-2]
        out[name] = PrintedNumber(
            name=name,
            printed=number,
            value=-number.si if is_product else number.si,
            half_width=number.rounding,
        )
    for joint, motor in zip(JOINT_NAMES, tables.table_4.rows, strict=True):
        name = f"motors.friction.{joint}"
        tolerance = motor.friction.si * motor.friction_tolerance.si
        out[name] = PrintedNumber(
            name=name,
            printed=motor.friction,
            value=motor.friction.si,
            half_width=max(motor.friction.rounding, tolerance),
        )
    return out
