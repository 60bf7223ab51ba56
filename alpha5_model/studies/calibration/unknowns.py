"""The numbers of an arm that a calibration may change, and what is known before it.

Each is named by its key in an arm file and its component: ``links.link_2.com.x``,
``zeros.axis_d``, ``lengths.a_1``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray, choice, real
from alpha5_model.errors import InputError
from alpha5_model.numbers.arm_checks import LENGTHS
from alpha5_model.numbers.arm_schema import NUMBERS
from alpha5_model.numbers.parameters import Alpha5Parameters, LinkParameters
from alpha5_model.numbers.tables import BODY_NAMES
from alpha5_model.studies.uncertainty.arm_numbers import ArmNumbers, arm_numbers
from alpha5_model.studies.uncertainty.calibrated import printed_name
from alpha5_model.studies.uncertainty.linear_maps import UPPER
from alpha5_model.studies.uncertainty.sampling import DEVIATION

#: What is known of the bodies before a calibration.
PRIORS = ("digits", "loose")
#: Lengths that a load depends on; d_3 moves the tool only.
USED_LENGTHS = ("a_0", "d_0", "a_1", "a_2")
#: Numbers of a body in their order, and those of all bodies.
PER_BODY = 14
OF_BODIES = PER_BODY * len(BODY_NAMES)
#: Standard deviations of the loose prior: relative ones, and of centres [m].
_LOOSE = 0.10
_LOOSE_CENTRE = 0.005


#: Names of all numbers: of the bodies, the zeros, the lengths, (78,).
NAMES = tuple(name for name in NUMBERS if name != "lengths.d_3")


@dataclass(frozen=True, eq=False)
class ArmUnknowns:
    """Values of `NAMES` before a calibration, and how well they are known.

    Attributes:
        arm: The record that they are of.
        middle: (78,) SI units; products of inertia as in URDF, zeros 0.
        deviation: Standard deviations, (78,); 0 for what is known.
        prior: Where these come from, one of `PRIORS`.
    """

    arm: Alpha5Parameters
    middle: FloatArray
    deviation: FloatArray
    prior: str

    def record(self, values: FloatArray) -> Alpha5Parameters:
        """The arm with other values (78,)."""
        if np.array_equal(values, self.middle):
            return self.arm
        links = tuple(
            _with_numbers(link, numbers)
            for link, numbers in zip(self.arm.links, by_body(values), strict=True)
        )
        return replace(self.arm, links=links, dh=self._rows(values))

    def lengthened(self, values: FloatArray) -> Alpha5Parameters:
        """The arm with other zeros and lengths, and its own bodies."""
        return replace(self.arm, dh=self._rows(values))

    def _rows(self, values: FloatArray) -> tuple[Any, ...]:
        """The rows of Table 1."""
        rows = list(self.arm.dh)
        of_zeros = values[OF_BODIES : OF_BODIES + 4].tolist()
        for i, zero in enumerate(of_zeros):
            rows[i] = replace(rows[i], theta_offset=rows[i].theta_offset + zero)
        for name, length in zip(USED_LENGTHS, values[-4:].tolist(), strict=True):
            i, field = LENGTHS[name]
            own: dict[str, Any] = {field: length}
            rows[i] = replace(rows[i], **own)
        return tuple(rows)


def by_body(values: FloatArray) -> FloatArray:
    """The numbers of the bodies, (..., 5, 14), of values (..., 78)."""
    shape = (*values.shape[:-1], len(BODY_NAMES), PER_BODY)
    return values[..., :OF_BODIES].reshape(shape)


def arm_unknowns(
    arm: Alpha5Parameters,
    prior: str = "digits",
    zeros: float = np.radians(1.0),
    moving: bool = False,
) -> ArmUnknowns:
    """What is known of an arm before its calibration.

    Args:
        arm: Its record. Half widths of its file replace those of the digits.
        prior: ``digits``: each number is as good as its printed digits. ``loose``: the
            standard deviation of masses and volumes is 10 %, that of centres 5 mm, and
            that of moments of inertia 10 % of the largest.
        zeros: Standard deviation of the joints' zeros [rad].
        moving: Whether the arm moves in the data. If not, nothing is learnt of the
            moments of inertia, which are left out.

    Raises:
        UnknownNameError: No such prior.
        InputError: A deviation below 0, or an arm that has been calibrated.
    """
    if arm.covariance is not None:
        expected = "one before any calibration; fit all sessions together"
        raise InputError("arm", f"{arm.name}, calibrated", expected)
    choice("prior", prior, PRIORS)
    zeros = real("zeros", zeros, minimum=0.0)
    middle = np.concatenate([*map(_numbers, arm.links), np.zeros(4), _lengths(arm)])
    numbers = arm_numbers(arm)
    half_widths = {**_of_digits(numbers), **_of_measured(arm)}
    known = [
        DEVIATION * half_widths[name] if name in half_widths else zeros
        for name in NAMES
    ]
    deviation = np.array(known)
    if prior == "loose":
        deviation[:OF_BODIES] = np.ravel([_loose(link) for link in by_body(middle)])
    if not moving:
        deviation[[".inertia." in name for name in NAMES]] = 0.0
    return ArmUnknowns(arm=arm, middle=middle, deviation=deviation, prior=prior)


def _of_digits(numbers: ArmNumbers) -> dict[str, float]:
    """Name -> half width, by the digits or an arm file."""
    known = dict(zip(numbers.names, numbers.half_width.tolist(), strict=True))
    named = {name: printed_name(name) for name in NAMES}
    found = {name: known[one] for name, one in named.items() if one in known}
    sides = [known["elbow.opposite"], known["elbow.adjacent"]]
    found.setdefault("lengths.a_1", _elbow(numbers.arm, *sides))
    return found


def _elbow(arm: Alpha5Parameters, opposite: float, adjacent: float) -> float:
    """Half width of a_1, the hypotenuse of two printed lengths."""
    share = np.array([np.sin(arm.theta_c), np.cos(arm.theta_c)])
    return float(np.linalg.norm(share * [opposite, adjacent]))


def _of_measured(arm: Alpha5Parameters) -> dict[str, float]:
    """Name -> half width, of zeros that an arm file gives."""
    return {
        one.key: one.half_width
        for one in arm.measurements
        if one.key.startswith("zeros.") and one.half_width is not None
    }


def _numbers(link: LinkParameters) -> list[float]:
    """The numbers of a link in the order of `NAMES`."""
    return [link.mass, *link.com, *link.inertia[UPPER], link.volume, *link.cob]


def _lengths(arm: Alpha5Parameters) -> list[float]:
    found = []
    for name in USED_LENGTHS:
        row, field = LENGTHS[name]
        found.append(float(getattr(arm.dh[row], field)))
    return found


def _loose(numbers: FloatArray) -> FloatArray:
    """Standard deviations of a body's numbers by the loose prior, (14,)."""
    deviation = np.full(PER_BODY, _LOOSE_CENTRE)
    deviation[0] = _LOOSE * numbers[0]
    deviation[4:10] = _LOOSE * np.abs(numbers[4:10]).max()
    deviation[10] = _LOOSE * numbers[10]
    return deviation


def _with_numbers(link: LinkParameters, numbers: FloatArray) -> LinkParameters:
    """A link with other numbers (14,); those that are the same stay to the bit."""
    inertia = np.empty((3, 3))
    inertia[UPPER] = numbers[4:10]
    inertia.T[UPPER] = numbers[4:10]
    return replace(
        link,
        mass=float(numbers[0]),
        com=numbers[1:4],
        inertia=inertia,
        volume=float(numbers[10]),
        cob=numbers[11:],
    )
