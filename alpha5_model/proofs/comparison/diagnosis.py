"""Why a body differs: hypotheses from the tables, each tested with the other model's numbers.

Nothing here looks at names. The diagnosis is the fewest mistakes that give the number to its
printed digits; a difference that none explain has no diagnosis. Tensors that depend on a size
nobody printed (solid bodies, water, another point) are recomputed from the size that fits best: few
unknowns for six numbers.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers.fluids import FRESH_WATER
from alpha5_model.numbers.inertia import (
    combine,
    flip_products,
    point_mass_tensor,
    principal_moments,
)
from alpha5_model.numbers.parameters import LinkParameters
from alpha5_model.proofs.comparison import arm, hypotheses
from alpha5_model.proofs.comparison.hypotheses import (
    I_LINK,
    MOST_MISTAKES,
    SOLIDWORKS,
    Hypotheses,
)
from alpha5_model.proofs.comparison.reading import last_place

#: How closely a hypothesis must give a number: the half of its last digit, within these.
MASS_DIGITS = (5e-5, 5e-4)  # [kg]
COM_DIGITS = (1e-4, 5e-4)  # [m]
INERTIA_DIGITS = (1e-3, 1e-2)  # of the largest entry
#: Products and differences of moments below this are rounding.
GUESS_DIGITS = 1e-4  # of the largest moment
#: A link frame that lies closer to ours was meant to be ours; the rest is an error of the geometry.
SAME_FRAME = (0.002, 0.02)  # [m], [rad]
#: A lighter link is a dummy: some tools ask for a mass on every link.
TOKEN_MASS = 1e-3  # [kg]
#: How far a solid of the body's size may exceed its bounds.
SIZE_SLACK = 1.25

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
        _, com, tensor = arm.carried(self, self.pose)
        return replace(self, com=com, inertia=tensor, pose=np.eye(4))

    @property
    def meant_in_our_frame(self) -> bool:
        """Whether its frame is ours but for an error of the geometry."""
        near = np.linalg.norm(self.pose[:3, 3]) < SAME_FRAME[0]
        return bool(
            near and np.trace(self.pose[:3, :3]) > 1 + 2 * np.cos(SAME_FRAME[1])
        )


def subjects(written: Sequence[Inertial]) -> list[Inertial]:
    """What may carry a printed number: the whole body without dummies, then its heaviest link."""
    solid = sorted(
        (w for w in written if abs(w.mass) > TOKEN_MASS), key=lambda w: -abs(w.mass)
    )
    if len(solid) < 2 or sum(w.mass for w in solid) == 0:
        return solid[:1]
    whole = combine(*zip(*(arm.carried(w, w.pose) for w in solid), strict=True))
    return [Inertial("", *whole, np.eye(4)), solid[0]]


#: Why a number of what carries it is not that of a link of the tables, if a hypothesis gives it.
Explain = Callable[[LinkParameters, Inertial], str | None]


def reason(link: LinkParameters, written: Sequence[Inertial], explain: Explain) -> str:
    """The first subject whose number is explained, and which links stand beside it."""
    for subject in subjects(written):
        if words := explain(link, subject):
            beside = [
                w
                for w in written
                if abs(w.mass) > TOKEN_MASS and w.link != subject.link
            ]
            if not subject.link or not beside:
                return f": {words}"
            grams = sum(w.mass for w in beside) * 1e3
            names = ", ".join(w.link for w in beside)
            return f": {subject.link} has {words}; beside it {names} with {grams:.0f} g"
    return ""


def _index(link: LinkParameters) -> int:
    """0 for link_0 to 4 for link_4."""
    return int(link.name[-1])


def explain_mass(link: LinkParameters, subject: Inertial) -> str | None:
    """Why a mass is not Table 2's; None if no hypothesis gives it."""
    if water := added_water(link, subject):
        return water[0]
    number, within = (
        np.array(subject.mass),
        _last_digit(MASS_DIGITS, subject, subject.mass),
    )
    views: list[View] = [("", number, 0, 1.0), ("in grams", number, 1, 1e3)]
    return _fit(hypotheses.wrong_masses(_index(link)), views, (within, within))


def explain_com(link: LinkParameters, subject: Inertial) -> str | None:
    """Why a COM is not Table 2's; None if no hypothesis gives it."""
    body, written = _index(link), subject.com
    frame = f"in a frame that is not inertial frame {{{body}}}"
    views = _views(subject, subject.in_our_frame().com, written, frame)
    if subject.link:
        if not written.any():
            return "missing or zero: at the origin of the other model's link frame"
        views.append(("written in millimetres", written, 1, 1e3))
        views.append(("written in kilometres", written, 1, 1e-3))
    rounded = _last_digit(COM_DIGITS, subject, *written)
    return _fit(hypotheses.wrong_coms(body), views, (rounded, COM_DIGITS[0]))


def explain_inertia(link: LinkParameters, subject: Inertial) -> str | None:
    """Why a tensor is not Table 2's; None if no hypothesis gives it."""
    body, seen = _index(link), subject.in_our_frame().inertia
    if not seen.any():
        return "missing or zero"
    axes = f"in axes that are not those of inertial frame {{{body}}}"
    views = _views(subject, seen, subject.inertia, axes)
    views.append(("scaled with the wrong mass", seen, 1, subject.mass / link.mass))
    views += [
        (f"wrong unit, a factor of 1e{p}", seen, 1, 10.0**p)
        for p in (9, 6, 3, -3, -6, -9)
    ]
    within = _tensor_digits(subject)
    if words := _fit(hypotheses.wrong_tensors(body), views, (within, within)):
        return words
    water = added_water(link, subject)
    return water[1] if water else wrong_point(body, subject.mass, seen, within)


def _views(
    subject: Inertial, seen: FloatArray, written: FloatArray, elsewhere: str
) -> list[View]:
    """A number as it lies in our frame, and as one link writes it in its own."""
    own = (
        ("", written, 0, 1.0)
        if subject.meant_in_our_frame
        else (elsewhere, written, 1, 1.0)
    )
    return [("", seen, 0, 1.0), *([own] if subject.link else [])]


def explain_guess(link: LinkParameters, written: Sequence[Inertial]) -> str | None:
    """The solids that the tensors were guessed from; None if they have products and fit none."""
    solid = [w for w in written if abs(w.mass) > TOKEN_MASS]
    words, plain = [], True
    for w in solid:
        moments = np.diag(w.inertia)
        # an <origin rpy> of few digits leaves products of its own rounding
        plain &= bool(
            np.abs(w.inertia - np.diag(moments)).max() <= GUESS_DIGITS * moments.max()
        )
        shape = solid_of_size(link, w.mass, w.inertia)
        if plain and np.ptp(moments) <= GUESS_DIGITS * moments.max():
            shape = f"a dummy, {moments[0]:g} kg m^2 about every axis"
        if shape:
            words.append(f"{w.link} {shape}" if len(solid) > 1 else shape)
    if not plain and len(words) < len(solid):
        return None
    head = "a guess without products of inertia" if plain else "a guess"
    return ": ".join(filter(None, (head, "; ".join(words))))


def _fit(
    table: Hypotheses, views: Sequence[View], within: tuple[float, float]
) -> str | None:
    """The fewest mistakes that give the number, in words; ``within`` for one and for more."""
    words, values, mistakes = table
    axes = tuple(range(1, values.ndim))
    errors = [
        np.abs(values * scale - x).max(axes, initial=0.0) for _, x, _, scale in views
    ]
    totals = np.array([mistakes + more for _, _, more, _ in views])
    hits = (totals <= MOST_MISTAKES) & (
        errors <= np.where(totals > 1, within[1], within[0])
    )
    if not hits.any():
        return None
    best = int(np.where(hits, totals, MOST_MISTAKES + 1).argmin())
    view, hit = divmod(best, len(words))
    return ", ".join(filter(None, (words[hit], views[view][0])))


def _last_digit(
    limits: tuple[float, float], subject: Inertial, *numbers: float
) -> float:
    """Half of the last decimal place that any of the numbers is written with, within the limits."""
    places = [last_place(repr(float(x))) for x in numbers if x]
    if not subject.link or not places:
        return limits[0]
    return float(np.clip(0.5 * min(places), *limits))


def _tensor_digits(subject: Inertial) -> float:
    low, high = np.array(INERTIA_DIGITS) * np.abs(subject.inertia).max()
    return _last_digit((low, high), subject, *subject.inertia.ravel())


def added_water(link: LinkParameters, subject: Inertial) -> tuple[str, str] | None:
    """If mass and tensor are printed ones with a cylinder of water of the body's width added.

    Strip theory: ``rho pi r^2 L^3 / 3`` about either axis across for a tensor about the cylinder's
    end (I_Link), ``/ 12`` about its middle (I_COM), and ``rho pi r^2 L`` in the mass. Six of seven
    numbers test the one unknown, L. The tensor is taken as it lies, or as it is written where its
    axes are not ours.

    Returns:
        Where the mass is from, and where the tensor is from.
    """
    body, radius = _index(link), _radius(link)
    near, close = (
        _last_digit(MASS_DIGITS, subject, subject.mass),
        _tensor_digits(subject),
    )
    line, longest = (
        FRESH_WATER * np.pi * radius**2,
        SIZE_SLACK * np.ptp(link.bounds, axis=1).max(),
    )
    tensors = (subject.in_our_frame().inertia, subject.inertia)
    choices = (tensors, hypotheses.revisions(), (True, False), (False, True), range(3))
    for tensor, table, about_end, solidworks, axis in itertools.product(*choices):
        base = (table.inertia_link if about_end else table.inertia)[body]
        surplus = tensor - (flip_products(base) if solidworks else base)
        across = float(np.delete(np.diag(surplus), axis).mean())
        rest = surplus - across * np.diag(np.arange(3) != axis)
        if across <= 5 * close or np.abs(rest).max() > close:
            continue
        length = float(np.cbrt((3 if about_end else 12) * across / line))
        water = line * length
        # L follows from the tensor to a third of its relative error.
        allowed = near + water * close / (3 * across)
        if (
            length <= longest
            and abs(subject.mass - table.mass[body] - water) <= allowed
        ):
            size = f"of radius {radius * 1e3:.0f} mm and length {length * 1e3:.0f} mm"
            whose, cylinder = (
                table.numbers.removesuffix(" numbers"),
                f"a cylinder of water {size}",
            )
            mass = f"{whose} mass and the water's added mass, {water * 1e3:.0f} g, of {cylinder}"
            point = I_LINK if about_end else "I_COM"
            numbers = f"{table.numbers}, {point}{f', {SOLIDWORKS}' * solidworks}"
            return (
                mass,
                f"{numbers}, with the added inertia of {cylinder} (strip theory)",
            )
    return None


def wrong_point(
    body: int, mass: float, tensor: FloatArray, tolerance: float
) -> str | None:
    """If it is the printed I_COM, but about another point: three unknowns, six numbers."""
    for table, solidworks in itertools.product(hypotheses.revisions(), (False, True)):
        right = (
            flip_products(table.inertia[body]) if solidworks else table.inertia[body]
        )
        shift = (tensor - right) / mass
        square = float(np.trace(shift)) / 2
        values, vectors = np.linalg.eigh(square * np.eye(3) - shift)  # p p^T
        point = vectors[:, 2] * np.sqrt(max(values[2], 0.0))
        error = np.abs(tensor - right - point_mass_tensor(mass, point)).max()
        if mass * square > 5 * tolerance and error <= tolerance:
            words = f"{table.numbers}, about the wrong point, {np.sqrt(square) * 1e3:.1f} mm from the COM"
            return words + f", {SOLIDWORKS}" * solidworks
    return None


def solid_of_size(link: LinkParameters, mass: float, tensor: FloatArray) -> str | None:
    """A solid cylinder or box of about the body's size with these principal moments, if any."""
    moments = principal_moments(tensor)
    sizes = np.sort(SIZE_SLACK * np.ptp(link.bounds, axis=1))
    if mass <= 0 or moments[0] <= 0:
        return None
    for axis in range(3):
        one, two = np.delete(moments, axis)
        radius = np.sqrt(2 * moments[axis] / mass)
        square = 12 * one / mass - 3 * radius**2
        round_ = two - one <= 1e-3 * moments[2] and radius <= SIZE_SLACK * _radius(link)
        if round_ and 0 < square <= sizes[2] ** 2:
            length = np.sqrt(square) * 1e3
            return f"a solid cylinder of radius {radius * 1e3:.1f} mm and length {length:.1f} mm"
    sides = np.sqrt(np.maximum(6 / mass * (moments.sum() - 2 * moments), 0.0))[::-1]
    # Any three moments are those of some box: only sides of whole millimetres show a guess.
    whole = np.abs(sides * 1e3 - np.round(sides * 1e3)).max() < 0.05
    if whole and sides[0] > 1e-3 and (sides <= sizes).all():
        x, y, z = sides * 1e3
        return f"a solid box of {x:.0f} x {y:.0f} x {z:.0f} mm"
    return None


def _radius(link: LinkParameters) -> float:
    """Half the least width of the body: all are turned parts [m]."""
    return float(np.ptp(link.bounds, axis=1).min() / 2)
