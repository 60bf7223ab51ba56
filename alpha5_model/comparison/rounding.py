"""What the printed digits of a URDF leave open: multiples of pi cut short, and the last decimal place."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from decimal import Decimal
from functools import cache

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.description.urdf_reading import UrdfJoint, UrdfRobot
from alpha5_model.spatial import pose

#: Fractions of a turn that people write: multiples of 15 deg, up to a full turn.
PARTS = np.arange(1, 25)[:, None] / 12


def as_meant(robot: UrdfRobot) -> UrdfRobot:
    """The robot with every multiple of pi in its joints' rpy exact, however few digits it is printed with."""
    joints = {name: replace(j, transform=_meant(j)) for name, j in robot.joints.items()}
    return replace(robot, joints=joints)


def _meant(joint: UrdfJoint) -> FloatArray:
    angles = [meant_angle(text) for text in joint.printed[1].split()]
    return pose(joint.transform[:3, 3], angles) if angles else joint.transform


@cache
def meant_angle(text: str) -> float:
    """The multiple of pi that a printed angle stands for; the angle itself if it is none.

    It is one if it equals, to its last printed digit, a multiple of 15 deg computed from pi cut or
    rounded to 3 digits or more: 3.1415 and 1.57075, but neither 1.5 nor 1.572.
    """
    angle, unit = float(text), _last_place(text)
    with_digits = [10.0**n for n in range(2, 16)]
    pis = [f(math.pi * n) / n for n in with_digits for f in (math.floor, round)]
    # Two decimals are too few to tell thirds of pi from any other angle.
    parts = PARTS if unit < 5e-3 else PARTS[5::6]
    # Angles computed from a short pi are not exact; no last digit is worth more than what 3.14 leaves open.
    unit = min(1.01 * unit + 1e-12, (math.pi - 3.14) * abs(angle) / 3)
    near = (np.abs(parts * pis - abs(angle)) <= unit).any(axis=1)
    return math.copysign(float(parts[near][0, 0]) * math.pi, angle) if near.any() else angle


def last_digits(joints: Iterable[UrdfJoint]) -> tuple[float, float, float]:
    """What the digits of the joints' origins leave open: lengths [m], angles and multiples of pi [rad].

    Of lengths and angles half of the last decimal place, added in quadrature. A number may have lost its
    trailing zeros: the most decimals among the lengths are taken for all of them, and so for the
    angles. Zeros and integers are exact. Of the multiples of pi the most that one is off by.
    """
    texts: list[list[str]] = [[], []]
    for joint in joints:
        for k, found in enumerate(texts):
            found += [text for text in joint.printed[k].split() if float(text) % 1 != 0]
    pi = max((abs(meant_angle(text) - float(text)) for text in texts[1]), default=0.0)
    texts[1] = [text for text in texts[1] if meant_angle(text) == float(text)]
    length, angle = (
        0.5 * min(map(_last_place, found), default=0.0) * math.sqrt(len(found)) for found in texts
    )
    return length, angle, pi


def _last_place(text: str) -> float:
    exponent = Decimal(text).as_tuple().exponent
    return 10.0**exponent if isinstance(exponent, int) else 0.0
