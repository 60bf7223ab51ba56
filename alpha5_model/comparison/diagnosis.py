"""Why a body differs: hypotheses made from the tables, each tested against the other model's numbers.

Nothing here looks at names. The diagnosis is the fewest mistakes that give the number to its
printed digits; where none do, the difference stands without one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import cache

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.comparison.arm import FourJointArm
from alpha5_model.comparison.hypotheses import (
    MOST_MISTAKES,
    Hypothesis,
    added_water,
    solid_of_size,
    wrong_coms,
    wrong_masses,
    wrong_point,
    wrong_tensors,
)
from alpha5_model.inertia import combine, rotate_tensor
from alpha5_model.parameters import LinkParameters

#: What still agrees with the tables: a model may print fewer digits.
MASS_TOLERANCE = 1e-3  # of the mass
COM_TOLERANCE = 1e-4  # [m]
INERTIA_TOLERANCE = 5e-3  # of the largest moment
#: How closely a hypothesis must give a number: the half of its last digit, within these.
MASS_DIGITS = (5e-5, 5e-4)  # [kg]
COM_DIGITS = (1e-4, 5e-4)  # [m]
INERTIA_DIGITS = (1e-3, 1e-2)  # of the largest entry
#: Products and differences of moments below this are rounding.
GUESS_DIGITS = 1e-4  # of the largest moment
#: A link frame that lies closer to ours was meant to be ours; the rest is an error of the geometry.
SAME_FRAME = (0.002, 0.02)  # [m], [rad]
#: A lighter link is a dummy, there to please a tool.
TOKEN_MASS = 1e-3  # [kg]

#: Words, the number seen that way, the mistakes in it, and by what the hypotheses are multiplied.
View = tuple[str, FloatArray, int, float]


@dataclass(frozen=True, eq=False)
class Inertial:
    """What one link of the other model writes, or several together.

    Attributes:
        link: Its name; empty for several.
        mass: [kg].
        com: In its own frame, (3,) [m].
        inertia: At the COM, in its own axes, (3, 3) [kg m^2].
        pose: transform_link_to_ours, (4, 4).
    """

    link: str
    mass: float
    com: FloatArray
    inertia: FloatArray
    pose: FloatArray

    def in_our_frame(self) -> Inertial:
        """The same, in our link frame."""
        rotation, origin = self.pose[:3, :3], self.pose[:3, 3]
        com, tensor = rotation @ self.com + origin, rotate_tensor(rotation, self.inertia)
        return replace(self, com=com, inertia=tensor, pose=np.eye(4))

    @property
    def meant_in_our_frame(self) -> bool:
        """Whether its frame is ours but for an error of the geometry."""
        shift, turn = self.pose[:3, 3], self.pose[:3, :3] - self.pose[:3, :3].T
        facing = np.trace(self.pose[:3, :3]) > 1.0
        near = np.linalg.norm(shift) < SAME_FRAME[0]
        return bool(near and facing and np.linalg.norm(turn) < np.sqrt(8) * np.sin(SAME_FRAME[1]))


def subjects(written: Sequence[Inertial]) -> list[Inertial]:
    """What may carry a printed number: the body as a whole without its dummies, then its heaviest link."""
    solid = sorted((w for w in written if abs(w.mass) > TOKEN_MASS), key=lambda w: -abs(w.mass))
    if len(solid) < 2 or sum(w.mass for w in solid) == 0:
        return solid[:1]
    seen = [w.in_our_frame() for w in solid]
    whole = combine([w.mass for w in seen], [w.com for w in seen], [w.inertia for w in seen])
    return [Inertial("", *whole, np.eye(4)), solid[0]]


def explain_mass(link: LinkParameters, subject: Inertial) -> str | None:
    """Why a mass is not Table 2's; None if no hypothesis gives it."""
    mass, body = subject.mass, int(link.name[-1])
    within = _last_digit(MASS_DIGITS, subject, mass)
    if water := _water(link, subject):
        return water[0]
    views: list[View] = [("", np.array(mass), 0, 1.0), ("in grams", np.array(mass), 1, 1e3)]
    fit = _fit(wrong_masses(body), views, (within, within))
    return fit.words if fit else None


def explain_com(ours: FourJointArm, link: LinkParameters, subject: Inertial) -> str | None:
    """Why a COM is not Table 2's; None if no hypothesis gives it."""
    body = int(link.name[-1])
    views: list[View] = [("", subject.in_our_frame().com, 0, 1.0)]
    if subject.link:
        if not subject.com.any():
            return "missing or zero: at the origin of the other model's link frame"
        frame = f"in a frame that is not inertial frame {{{body}}}"
        same = subject.meant_in_our_frame
        views += [
            ("", subject.com, 0, 1.0) if same else (frame, subject.com, 1, 1.0),
            ("written in millimetres", subject.com, 1, 1e3),
            ("written in kilometres", subject.com, 1, 1e-3),
        ]
    rounded = _last_digit(COM_DIGITS, subject, *subject.com)
    fit = _fit(wrong_coms(ours, body), views, (rounded, COM_DIGITS[0]))
    return fit.words if fit else None


def explain_inertia(ours: FourJointArm, link: LinkParameters, subject: Inertial) -> str | None:
    """Why a tensor is not Table 2's; None if no hypothesis gives it."""
    body, seen = int(link.name[-1]), subject.in_our_frame().inertia
    if not seen.any():
        return "missing or zero"
    views: list[View] = [("", seen, 0, 1.0)]
    if subject.link:
        axes = f"in axes that are not those of inertial frame {{{body}}}"
        same = subject.meant_in_our_frame
        views.append(("", subject.inertia, 0, 1.0) if same else (axes, subject.inertia, 1, 1.0))
    views.append(("scaled with the wrong mass", seen, 1, subject.mass / link.mass))
    views += [
        (f"wrong unit, a factor of 1e{power}", seen, 1, 10.0**power)
        for power in (9, 6, 3, -3, -6, -9)
    ]
    within = _tensor_digits(subject)
    if fit := _fit(wrong_tensors(ours, body), views, (within, within)):
        return fit.words
    if water := _water(link, subject):
        return water[1]
    return wrong_point(body, subject.mass, seen, within)


def _water(link: LinkParameters, subject: Inertial) -> tuple[str, str] | None:
    """Water in mass and tensor as they lie, or as it is written where its axes are not ours."""
    tensors = (subject.in_our_frame().inertia, subject.inertia)
    within = (_last_digit(MASS_DIGITS, subject, subject.mass), _tensor_digits(subject))
    waters = (added_water(link, subject.mass, tensor, within) for tensor in tensors)
    return next(filter(None, waters), None)


def explain_guess(link: LinkParameters, written: Sequence[Inertial]) -> str | None:
    """What solids the tensors were guessed from; None if they have products and are not of solids."""
    solid = [w for w in written if abs(w.mass) > TOKEN_MASS]
    words, plain = [], True
    for w in solid:
        moments = np.diag(w.inertia)
        # an <origin rpy> of few digits leaves products of its own rounding
        plain &= bool(np.abs(w.inertia - np.diag(moments)).max() <= GUESS_DIGITS * moments.max())
        shape = solid_of_size(link, w.mass, w.inertia)
        if plain and np.ptp(moments) <= GUESS_DIGITS * moments.max():
            shape = f"a dummy, {moments[0]:g} kg m^2 about every axis"
        if shape:
            words.append(f"{w.link} {shape}" if len(solid) > 1 else shape)
    if not plain and len(words) < len(solid):
        return None
    head = "a guess without products of inertia" if plain else "a guess"
    return ": ".join(filter(None, (head, "; ".join(words))))


@cache
def _stacked(hypotheses: tuple[Hypothesis, ...]) -> tuple[FloatArray, FloatArray]:
    values = np.array([hypothesis.value for hypothesis in hypotheses])
    return values, np.array([hypothesis.mistakes for hypothesis in hypotheses])


def _fit(
    hypotheses: tuple[Hypothesis, ...], views: Sequence[View], within: tuple[float, float]
) -> Hypothesis | None:
    """The fewest mistakes that give the number; ``within`` for one mistake and for more."""
    values, mistakes = _stacked(hypotheses)
    axes = tuple(range(1, values.ndim))
    errors = [
        np.abs(values * scale - number).max(axis=axes, initial=0.0) for _, number, _, scale in views
    ]
    for total in range(MOST_MISTAKES + 1):
        for (words, _, more, _), error in zip(views, errors, strict=True):
            hits = (mistakes + more == total) & (error <= within[total > 1])
            if hits.any():
                hit = hypotheses[int(hits.argmax())]
                return replace(
                    hit, words=", ".join(filter(None, (hit.words, words))), mistakes=total
                )
    return None


def _last_digit(limits: tuple[float, float], subject: Inertial, *numbers: float) -> float:
    """Half of the last decimal place that any of the numbers is written with, within the limits."""
    places = [Decimal(repr(float(x))).as_tuple().exponent for x in numbers if x]
    if not subject.link or not places:
        return limits[0]
    return float(np.clip(0.5 * 10.0 ** min(int(place) for place in places), *limits))


def _tensor_digits(subject: Inertial) -> float:
    largest = float(np.abs(subject.inertia).max())
    low, high = INERTIA_DIGITS
    return _last_digit((low * largest, high * largest), subject, *subject.inertia.ravel())
