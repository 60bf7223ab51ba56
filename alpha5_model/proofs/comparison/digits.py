"""The angles that the printed digits of a URDF stand for, and their rounding."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np

from alpha5_model._support.spatial import pose
from alpha5_model.description.urdf_robot import UrdfJoint, UrdfRobot

#: Angles that people write as fractions of pi: multiples of 15 deg, up to a full turn.
MULTIPLES = np.arange(1, 25)[:, None] / 12
#: The multiples of 90 deg among them.
QUARTERS = MULTIPLES[5::6]
#: Pi, cut and rounded to 2 to 15 decimals.
SHORT_PIS = np.array(
    [cut(math.pi * 10**n) / 10**n for n in range(2, 16) for cut in (math.floor, round)]
)


class Rounding(NamedTuple):
    """By how much printed digits may be off.

    Attributes:
        length: Of lengths [m].
        angle: Of angles [rad].
        pi: Of multiples of pi that are cut short [rad].
    """

    length: float
    angle: float
    pi: float


def as_meant(robot: UrdfRobot) -> UrdfRobot:
    """The robot with exact multiples of pi in the rpy of its joints."""
    joints = dict(robot.joints)
    for name, joint in robot.joints.items():
        texts = joint.printed[1].split()
        angles = [meant_angle(text) for text in texts]
        if angles != [float(text) for text in texts]:
            meant = pose(joint.transform[:3, 3], angles)
            joints[name] = replace(joint, transform=meant)
    return replace(robot, joints=joints)


@cache
def meant_angle(text: str) -> float:
    """The multiple of pi that a printed angle stands for; the angle itself if none.

    An angle stands for a multiple of 15 deg if it equals one to its last printed digit,
    with pi cut or rounded to 3 digits or more: 3.1415 and 1.57075, but neither 1.5 nor
    1.572.
    """
    angle = float(text)
    unit = last_place(text)

    # Two decimals are too few to tell thirds of pi from any other angle.
    multiples = MULTIPLES if unit < 5e-3 else QUARTERS

    # An angle computed from a short pi is not exact. The tolerance must stay below the
    # error of 3.14, or other angles would count.
    error_of_short_pi = (math.pi - 3.14) * abs(angle) / 3
    tolerance = min(1.01 * unit + 1e-12, error_of_short_pi)
    off = np.abs(multiples * SHORT_PIS - abs(angle))
    close = (off <= tolerance).any(axis=1)
    if not close.any():
        return angle
    multiple = float(multiples[close][0, 0])
    return math.copysign(multiple * math.pi, angle)


def last_digits(joints: Sequence[UrdfJoint]) -> Rounding:
    """How much the digits of the joint origins leave open.

    For lengths and angles it is half of the last decimal place, added in quadrature. A
    number may have lost its trailing zeros, so all lengths are taken to have as many
    decimals as the longest of them; the same holds for angles. Zeros and integers are
    exact. For multiples of pi it is the largest error.
    """
    lengths = _fractions(joint.printed[0] for joint in joints)
    angles = _fractions(joint.printed[1] for joint in joints)
    cuts = [abs(meant_angle(text) - float(text)) for text in angles]
    uncut = [text for text, cut in zip(angles, cuts, strict=True) if not cut]
    return Rounding(
        length=_half_last_place(lengths),
        angle=_half_last_place(uncut),
        pi=max(cuts, default=0.0),
    )


def rounded_origins(joints: Sequence[UrdfJoint]) -> Iterator[UrdfJoint]:
    """Each joint with one number of its origin off by half of the last decimal place.

    For multiples of pi, and for numbers that are exact, there is none.
    """
    lengths = _finest(_fractions(joint.printed[0] for joint in joints))
    angles = _finest(_fractions(joint.printed[1] for joint in joints))
    for joint in joints:
        texts = joint.printed[1].split()
        rpy = [meant_angle(text) for text in texts]
        for place, text in enumerate(joint.printed[0].split()):
            if float(text) % 1:
                shifted = joint.transform.copy()
                shifted[place, 3] += lengths / 2
                yield replace(joint, transform=shifted)
        for place, text in enumerate(texts):
            if float(text) % 1 and rpy[place] == float(text):
                turned = [*rpy]
                turned[place] += angles / 2
                yield replace(joint, transform=pose(joint.transform[:3, 3], turned))


def _finest(texts: Iterable[str]) -> float:
    """One unit of the finest last place of printed numbers."""
    return min(map(last_place, texts), default=0.0)


def _fractions(printed: Iterable[str]) -> list[str]:
    """The numbers in some texts that are not integers."""
    texts = " ".join(printed).split()
    return [text for text in texts if float(text) % 1]


def _half_last_place(texts: Sequence[str]) -> float:
    """Half of the finest last place of printed numbers, added in quadrature."""
    return 0.5 * _finest(texts) * math.sqrt(len(texts))


def last_place(text: str) -> float:
    """The value of one unit of the last digit of a printed number."""
    mantissa, _, power = text.lower().partition("e")
    decimals = len(mantissa.partition(".")[2])
    exponent = float(power or 0) - decimals
    return float(10.0 ** np.clip(exponent, -300, 300))
