"""Name the single mistake that turns a right number of a body into the written one.

`MISTAKES` is one table of the mistakes that people make with mass, COM and tensor.
`wrong_numbers` makes each of them with our numbers. The first one that gives the
written number to its digits explains it. A number that no mistake gives has no
explanation.

Numbers are compared in the frame of the link that says them, because there they were
typed. A number agrees if it differs by no more than half a unit of its last digit, for
every link alike; see `Digits`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal
from functools import partial
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import moved, pose
from alpha5_model.description.frames import fixed_frames, joint_placements
from alpha5_model.description.urdf_robot import UrdfRobot
from alpha5_model.errors import InputError
from alpha5_model.numbers.fluids import FRESH_WATER
from alpha5_model.numbers.inertia import flip_products, inconsistencies
from alpha5_model.numbers.jaws import loaded_links, split_link_4
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.rigid_body import RigidBody
from alpha5_model.proofs.comparison.document_revisions import Revision, revisions

I_LINK = (
    "I_Link used as I_COM (about the link frame, not the COM: "
    "the parallel-axis term twice)"
)
SOLIDWORKS = "products of inertia have the SolidWorks sign, that of the document"

Quantity = Literal["mass", "com", "inertia"]
QUANTITIES: tuple[Quantity, ...] = ("mass", "com", "inertia")

# ---------------------------------------------------------------------------- records


class Body(NamedTuple):
    """Mass, COM and tensor of a body, all in one frame.

    Attributes:
        mass: [kg].
        com: (3,) [m].
        inertia: At the COM, in the frame's axes, URDF sign, (3, 3) [kg m^2].
    """

    mass: float
    com: FloatArray
    inertia: FloatArray

    def at(self, transform: FloatArray) -> Body:
        """The body in the frame that a transform (4, 4) leads to."""
        rotation = transform[:3, :3]
        return Body(
            mass=self.mass,
            com=moved(transform, self.com),
            inertia=rotation @ self.inertia @ rotation.T,
        )


class Part(NamedTuple):
    """One link of the other model, of those that make up one of our bodies.

    Attributes:
        link: Its name.
        body: What its ``<inertial>`` says, in its own frame.
        pose: transform_link_to_ours: its pose in our link frame, (4, 4).
    """

    link: str
    body: Body
    pose: FloatArray


class WrongNumber(NamedTuple):
    """A number of a link that has to be changed.

    Attributes:
        link: The link of the other model.
        quantity: ``mass``, ``com`` or ``inertia``.
        mistake: What gives the written number; None if nothing in the table does.
        right: What the link should say, in its own frame: our body less the other
            links that make it up. A mass of 0 means that its inertial has to go.
    """

    link: str
    quantity: Quantity
    mistake: Mistake | None
    right: Body


@dataclass(frozen=True, eq=False)
class Case:
    """The right numbers of a body, with which a mistake is made, and the written ones.

    Attributes:
        index: 0 for link_0 to 4 for link_4.
        source: Tables of the arm that the right numbers are from.
        right: The right body, in the frame in which the mistake is made.
        in_ours: The right body in our link frame.
        to_link: transform_ours_to_link: from our link frame to that of the link, or to
            ours if the mistake is made there, (4, 4).
        frames: Name of a frame of our arm -> transform_body_to_frame at zero, (4, 4).
        written: What the link says, in its own frame.
    """

    index: int
    source: Revision
    right: Body
    in_ours: Body
    to_link: FloatArray
    frames: dict[str, FloatArray]
    written: Body

    def with_inertia(self, *tensors: FloatArray) -> list[Body]:
        """The right body with each of some tensors (3, 3) [kg m^2]."""
        return [self.right._replace(inertia=tensor) for tensor in tensors]


class Mistake(NamedTuple):
    """A mistake that people make with the numbers of a body.

    Attributes:
        id: Its name in scripts, such as ``i_link``; the same in every version. A dot
            separates two: ``earlier_revision.i_link`` is the mistake ``i_link`` made
            with an earlier revision's numbers.
        words: It in words, to follow "COM 20 mm off: ".
        make: What it makes of the right body; several bodies if it has variants.
    """

    id: str
    words: str
    make: Callable[[Case], Iterable[Body]]


# ----------------------------------------------------------------------------- digits

#: Closer numbers are the same, whatever their digits: rounding of conversions.
LEAST = {"mass": 1e-6, "com": 5e-7, "inertia": 5e-10}  # [kg], [m], [kg m^2]
#: Files with fewer digits are compared as closely as this: they would hide mistakes.
MOST = {"mass": 5e-4, "com": 5e-4, "inertia": 1e-6}
#: A lighter link only has an inertial because some program wants one [kg].
TOKEN = 1e-6
#: A frame whose pose differs by less in every entry was meant to be ours [m, rad].
SAME_FRAME = 2e-3


class Precision(NamedTuple):
    """How precisely the numbers of one kind are written in a file.

    Attributes:
        place: The finest decimal place that any of them has, such as 0.001.
        figures: The most significant figures that any of them has.
    """

    place: float = 0.0
    figures: int = 17

    def half_digit(self, numbers: ArrayLike) -> FloatArray:
        """Half a unit of the last digit of each number.

        A number may have lost its trailing zeros. So it is taken to be rounded like the
        others: to as many decimals, or to as many significant figures.
        """
        values = np.abs(np.asarray(numbers, np.float64))
        decades = np.floor(np.log10(np.where(values > 0, values, 1e-300)))
        return np.asarray(
            0.5 * np.maximum(self.place, 10.0 ** (decades + 1 - self.figures))
        )

    def rounded(self, numbers: ArrayLike, most: float) -> FloatArray:
        """The numbers with as many digits as the file has.

        More digits would make the file look more precise than its other numbers are.

        Args:
            numbers: Any shape.
            most: The largest error that rounding may make.
        """
        half = np.clip(self.half_digit(numbers), 1e-15, most)
        decimals = -np.floor(np.log10(2 * half) + 1e-9)
        scale = 10.0**decimals
        return np.asarray(np.rint(np.asarray(numbers) * scale) / scale + 0.0)


class Digits(NamedTuple):
    """The digits of a file's inertials, the same for every link.

    Attributes:
        mass, com, inertia: How precisely these are written.
        length: By how much rounded joint origins misplace a body [m].
        angle: By how much they turn it [rad].
    """

    mass: Precision = Precision()
    com: Precision = Precision()
    inertia: Precision = Precision()
    length: float = 0.0
    angle: float = 0.0


def digits_of(robot: UrdfRobot) -> Digits:
    """The digits that a file writes in its inertials."""
    links = [link for link in robot.links.values() if (link.mass or 0) > TOKEN]
    return Digits(
        mass=_precision(link.mass for link in links if link.mass),
        com=_precision(itertools.chain.from_iterable(link.com for link in links)),
        inertia=_precision(
            itertools.chain.from_iterable(link.inertia.flat for link in links)
        ),
    )


def _precision(numbers: Iterable[float]) -> Precision:
    """The finest place and the most figures of some numbers; zeros have none."""
    texts = [Decimal(repr(float(x))).normalize().as_tuple() for x in numbers if x]
    if not texts:
        return Precision()
    exponents = [int(text.exponent) for text in texts]
    figures = [len(text.digits) for text in texts]
    return Precision(place=10.0 ** min(exponents), figures=max(figures))


# -------------------------------------------------------------------------- the table


def _products(case: Case, xy: float, xz: float, yz: float) -> list[Body]:
    """Products of inertia multiplied by factors."""
    factors = np.array([[1, xy, xz], [xy, 1, yz], [xz, yz, 1]])
    return case.with_inertia(case.right.inertia * factors)


def _turned(case: Case, matrix: FloatArray) -> list[Body]:
    """COM and tensor in exchanged or reversed axes, (3, 3)."""
    tensor = matrix @ case.right.inertia @ matrix.T
    return [case.right._replace(com=matrix @ case.right.com, inertia=tensor)]


def _scaled(case: Case, mass: float, com: float, inertia: float) -> list[Body]:
    """All numbers multiplied by factors."""
    right = case.right
    return [Body(right.mass * mass, right.com * com, right.inertia * inertia)]


def _elements(tensor: FloatArray) -> FloatArray:
    """xx, yy, zz, xy, xz, yz of a tensor, (6,)."""
    return np.array([*np.diag(tensor), tensor[0, 1], tensor[0, 2], tensor[1, 2]])


def _tensor(elements: FloatArray) -> FloatArray:
    """The tensor of xx, yy, zz, xy, xz, yz."""
    xx, yy, zz, xy, xz, yz = elements
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _ordered(case: Case, order: Sequence[int]) -> list[Body]:
    """The six elements of the tensor in another order."""
    return case.with_inertia(_tensor(_elements(case.right.inertia)[list(order)]))


def _any_order(case: Case) -> list[Body]:
    """The six elements in the order of the written ones by size."""
    ranks = _elements(case.written.inertia).argsort().argsort()
    return case.with_inertia(_tensor(np.sort(_elements(case.right.inertia))[ranks]))


def _principal(case: Case) -> list[Body]:
    """Principal moments without their rotation, in any order."""
    moments = np.linalg.eigvalsh(case.right.inertia)
    return case.with_inertia(*map(np.diag, itertools.permutations(moments)))


def _parallel_axis(mass: float, com: FloatArray) -> FloatArray:
    """The parallel-axis term of a COM (3,), (3, 3) [kg m^2]."""
    return np.asarray(mass * (com @ com * np.eye(3) - np.outer(com, com)))


def _about_link(case: Case) -> list[Body]:
    """I_Link: the tensor about the link frame, computed and as printed."""
    right = case.right
    computed = right.inertia + _parallel_axis(right.mass, right.com)
    rotation = case.to_link[:3, :3]
    printed = rotation @ case.source.inertia_link[case.index] @ rotation.T
    return case.with_inertia(computed, printed)


def _pasted_about_link(case: Case) -> list[Body]:
    """I_Link pasted as the document prints it: one slip, although two are wrong."""
    return case.with_inertia(
        *(flip_products(body.inertia) for body in _about_link(case))
    )


def _less_term(case: Case) -> list[Body]:
    """I_COM less the parallel-axis term."""
    right = case.right
    return case.with_inertia(right.inertia - _parallel_axis(right.mass, right.com))


def _without_parallel_axis(case: Case) -> list[Body]:
    """The tensor less the term of two or three parts that were put together.

    The written tensor tells where the parts were. Their second moments cannot be
    negative, and two parts lie on one line through the COM, three in one plane.
    """
    missing = case.right.inertia - case.written.inertia
    moments = np.trace(missing) / 2 * np.eye(3) - missing
    values, vectors = np.linalg.eigh(moments)
    made = []
    for parts in (1, 2):
        kept = np.where(np.arange(3) < 3 - parts, 0.0, np.maximum(values, 0.0))
        spread = vectors @ np.diag(kept) @ vectors.T
        term = np.trace(spread) * np.eye(3) - spread
        made.append(case.right.inertia - term)
    return case.with_inertia(*made)


def _about_another_point(case: Case) -> list[Body]:
    """The tensor about another point than the COM, which the written one tells."""
    added = case.written.inertia - case.right.inertia
    outer = np.trace(added) / 2 * np.eye(3) - added
    values, vectors = np.linalg.eigh(outer)
    point = vectors[:, 2] * math.sqrt(max(values[2], 0.0))
    return case.with_inertia(case.right.inertia + _parallel_axis(1.0, point))


def _of_another_link(case: Case, k: int) -> list[Body]:
    """The numbers of link_k."""
    source = case.source
    if k == case.index:
        return []
    return [Body(float(source.mass[k]), source.com[k], source.inertia[k])]


def _in_frame(case: Case, name: str) -> list[Body]:
    """COM and tensor in another frame of the arm."""
    if name == f"link_{case.index}":
        return []
    return [case.in_ours.at(case.frames[name])]


def _whole_body(case: Case) -> list[Body]:
    """The numbers of the whole body, although other links are parts of it."""
    source = case.source
    k = case.index
    whole = Body(float(source.mass[k]), source.com[k], source.inertia[k])
    return [whole.at(case.to_link)]


def _with_water(case: Case) -> list[Body]:
    """The mass of the displaced water, alone and added."""
    water = FRESH_WATER * float(case.source.volume[case.index])
    mass = case.right.mass
    return [case.right._replace(mass=water), case.right._replace(mass=mass + water)]


def _buoyancy(case: Case) -> list[Body]:
    """The centre of buoyancy as COM."""
    return [case.right._replace(com=moved(case.to_link, case.source.cob[case.index]))]


def _by_mass(case: Case) -> list[Body]:
    """The tensor scaled with the written mass."""
    return case.with_inertia(case.right.inertia * (case.written.mass / case.right.mass))


def _by_a_factor(case: Case) -> list[Body]:
    """The tensor multiplied by whatever factor its trace has."""
    factor = np.trace(case.written.inertia) / np.trace(case.right.inertia)
    return case.with_inertia(case.right.inertia * factor)


def _signed_axes() -> Iterator[tuple[str, FloatArray]]:
    """The ways to exchange axes, in words and as matrices (3, 3)."""
    for order in itertools.permutations(range(3)):
        for signs in itertools.product((1, -1), repeat=3):
            if order == (0, 1, 2):
                continue
            names = [
                ("-" if s < 0 else "") + "xyz"[k]
                for k, s in zip(order, signs, strict=True)
            ]
            yield ", ".join(names), np.diag(signs) @ np.eye(3)[list(order)]


def _orders() -> Iterator[tuple[str, tuple[int, ...]]]:
    """Orders of the six elements that are taken for one another, by their names."""
    names = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    for i, j in ((3, 4), (3, 5), (4, 5), (0, 1), (0, 2), (1, 2)):
        order = list(range(6))
        order[i], order[j] = j, i
        yield f"{names[i]} and {names[j]} are exchanged", tuple(order)

    layouts = {
        "row by row": (0, 3, 4, 1, 5, 2),
        "column by column": (0, 3, 1, 4, 5, 2),
        "moments first": (0, 1, 2, 3, 4, 5),
        "Voigt's": (0, 1, 2, 5, 4, 3),
    }
    for (was, listed), (read, places) in itertools.permutations(layouts.items(), 2):
        order = [listed[places.index(element)] for element in range(6)]
        yield f"elements in the order {was}, read as {read}", tuple(order)


def _com_times(case: Case, *factors: float) -> list[Body]:
    """The COM with its coordinates multiplied by factors."""
    return [case.right._replace(com=case.right.com * factors)]


def _rows(make: Callable[..., Iterable[Body]], *rows: tuple[Any, ...]) -> list[Mistake]:
    """Mistakes that one function makes, from rows of id, words and its arguments."""
    return [Mistake(row[0], row[1], partial(_call, make, row[2:])) for row in rows]


def _call(
    make: Callable[..., Iterable[Body]], arguments: Sequence[Any], case: Case
) -> Iterable[Body]:
    return make(case, *arguments)


HALF_TURNS = {"x": (1, -1, -1), "y": (-1, 1, -1), "z": (-1, -1, 1)}

#: The most specific first: a sign before a turn, a turn before any exchange of axes.
MISTAKES: tuple[Mistake, ...] = (
    *_rows(_scaled, ("zero", "missing or zero", 0, 0, 0)),
    *_rows(
        _products,
        ("sign_ixy", "ixy has the wrong sign", -1, 1, 1),
        ("sign_ixz", "ixz has the wrong sign", 1, -1, 1),
        ("sign_iyz", "iyz has the wrong sign", 1, 1, -1),
        ("solidworks", SOLIDWORKS, -1, -1, -1),
        ("products_zeroed", "the products of inertia are zeroed", 0, 0, 0),
    ),
    *_rows(
        _com_times,
        ("com_sign_x", "x has the wrong sign", -1, 1, 1),
        ("com_sign_y", "y has the wrong sign", 1, -1, 1),
        ("com_sign_z", "z has the wrong sign", 1, 1, -1),
        ("com_mirrored", "mirrored through the origin", -1, -1, -1),
    ),
    *_rows(
        _scaled,
        # id, words, factors of mass, COM and tensor
        ("grams", "in grams", 1e3, 1, 1),
        ("thousandth", "a thousandth, divided by 1000 twice", 1e-3, 1e-3, 1e-3),
        ("pounds", "in pounds", 1 / 0.45359237, 1, 1),
        ("millimetres", "in millimetres", 1, 1e3, 1),
        ("centimetres", "in centimetres", 1, 1e2, 1),
        ("inches", "in inches", 1, 1 / 0.0254, 1),
        ("g_mm2", "in g mm^2", 1, 1, 1e9),
        ("g_cm2", "in g cm^2", 1, 1, 1e7),
        ("kg_mm2", "in kg mm^2", 1, 1, 1e6),
        ("kg_cm2", "in kg cm^2", 1, 1, 1e4),
        ("g_m2", "in g m^2", 1, 1, 1e3),
        ("lb_in2", "in lb in^2", 1, 1, 1 / (0.45359237 * 0.0254**2)),
        ("millionth", "a millionth, from kg mm^2 twice", 1, 1, 1e-6),
        ("billionth", "a billionth, from g mm^2 twice", 1, 1, 1e-9),
    ),
    Mistake("principal", "principal moments, their rotation is lost", _principal),
    Mistake("i_link", I_LINK, _about_link),
    Mistake("i_link_solidworks", f"{I_LINK}, {SOLIDWORKS}", _pasted_about_link),
    Mistake("term_subtracted", "the parallel-axis term is taken off I_COM", _less_term),
    Mistake("cob", "the centre of buoyancy", _buoyancy),
    Mistake(
        "whole_body", "that of the whole body, parts are counted twice", _whole_body
    ),
    *_rows(
        _of_another_link, *((f"link_{k}", f"that of link_{k}", k) for k in range(5))
    ),
    Mistake("water", "with or of the displaced water", _with_water),
    *_rows(
        _turned,
        *(
            (f"turned_{axis}", f"turned by pi about {axis}", np.diag(signs))
            for axis, signs in HALF_TURNS.items()
        ),
    ),
    *_rows(
        _in_frame,
        *((f"dh_{k}", f"in DH frame {{{k}}}", f"dh_{k}") for k in range(6)),
        *((f"frame_{k}", f"in the frame of link_{k}", f"link_{k}") for k in range(5)),
    ),
    *_rows(_ordered, *(("order", words, order) for words, order in _orders())),
    *_rows(_turned, *(("axes", words, matrix) for words, matrix in _signed_axes())),
    Mistake("scaled_with_mass", "scaled with the wrong mass", _by_mass),
)

#: Mistakes of an unknown size, which is taken from the written number itself. They fit
#: more numbers than the others, so they come last.
FITTED: tuple[Mistake, ...] = (
    Mistake("order", "the six elements are in another order", _any_order),
    Mistake("scaled", "multiplied by a factor", _by_a_factor),
    Mistake(
        "no_parallel_axis",
        "the parallel-axis terms of its parts are missing",
        _without_parallel_axis,
    ),
    Mistake("wrong_point", "about another point than the COM", _about_another_point),
)

# ---------------------------------------------------------------------- wrong numbers


def wrong_numbers(
    record: Alpha5Parameters, index: int, parts: Sequence[Part], digits: Digits
) -> list[WrongNumber]:
    """What the links of a body say wrong, each number with the mistake that gives it.

    If several links make up the body, as few numbers as possible are taken to be wrong,
    and rather those that a mistake explains.

    Args:
        record: Our arm.
        index: Which of its bodies: 0 for link_0 to 4 for link_4.
        parts: The links that make it up, without those that the user is told to empty
            (dummies, vehicles).
        digits: Of the file.

    Returns:
        Empty if the body agrees to the digits of the file.
    """
    ours = _body_of(loaded_links(record)[index])
    arm = _Arm(record, index)
    heaviest = sorted(parts, key=lambda part: -abs(part.body.mass))
    solid = [part for part in heaviest if part.body.mass or part.body.inertia.any()]
    heaviest = solid or heaviest[:1]  # frames without a body are no parts
    if len(heaviest) == 1:
        return _wrong_in_link(arm, ours, heaviest, 0, digits)

    options = []
    for place, part in enumerate(heaviest):
        others = [other.body.at(other.pose) for other in heaviest if other is not part]
        right = _less(ours, others)
        if right is not None:
            options.append(_wrong_in_link(arm, right, heaviest, place, digits))
    nominal = _jaws(record, heaviest) if index == 4 else None
    if nominal and all(options):
        found = []
        for place, right in enumerate(nominal):
            found += _wrong_in_link(arm, right, heaviest, place, digits)
        options.insert(0, found)
    if options:
        return min(options, key=_unlikely)

    # Too much is there: the heaviest link is the body, and the others have no mass.
    nothing = Body(mass=0.0, com=np.zeros(3), inertia=np.zeros((3, 3)))
    whole = _wrong_in_link(arm, ours, heaviest[:1], 0, digits)
    for part in heaviest[1:]:
        whole.append(WrongNumber(part.link, "mass", None, nothing))
    return whole


def _unlikely(wrong: Sequence[WrongNumber]) -> int:
    """A count of wrong numbers: those that no mistake explains count twice.

    A fitted mistake fits more than one link, so it counts as one and a half.
    """
    fitted = [mistake.id for mistake in FITTED]
    score = 0
    for number in wrong:
        score += 4
        if number.mistake:
            score -= 1 if number.mistake.id.split(".")[-1] in fitted else 2
    return score


def _body_of(link: RigidBody) -> Body:
    return Body(mass=link.mass, com=link.com, inertia=link.inertia)


def _less(whole: Body, others: Sequence[Body]) -> Body | None:
    """A body without some of its parts, all in one frame; None if none remains."""
    mass = whole.mass - sum(body.mass for body in others)
    if mass <= 0:
        return None
    moment = whole.mass * whole.com - sum(body.mass * body.com for body in others)
    com = moment / mass
    inertia = whole.inertia + _parallel_axis(whole.mass, whole.com - com)
    for body in others:
        inertia -= body.inertia + _parallel_axis(body.mass, body.com - com)
    if inconsistencies(mass, com, inertia):
        return None
    return Body(mass=mass, com=com, inertia=inertia)


def _jaws(record: Alpha5Parameters, parts: Sequence[Part]) -> list[Body] | None:
    """The bodies of our opened link 4 that stand where some links do, in link_4.

    Returns:
        None if the links are not wrist, rod and fingers.
    """
    try:
        jaws = split_link_4(record)
    except InputError:  # the arm's link_4 leaves no possible wrist
        return None
    found = []
    for part in parts:
        for body, closed in zip(jaws.bodies, jaws.closed, strict=True):
            ours = pose(body.origin, (body.roll, 0.0, 0.0))
            if np.abs(part.pose - ours).max() < SAME_FRAME:
                found.append(_body_of(closed))
    return found if len(found) == len(parts) == len(jaws.bodies) else None


class _Arm:
    """What the mistakes need of our arm."""

    def __init__(self, record: Alpha5Parameters, index: int) -> None:
        self.index = index
        links = loaded_links(record)
        mass = np.array([link.mass for link in links])
        com = np.array([link.com for link in links])
        inertia = np.array([link.inertia for link in links])
        terms = [_parallel_axis(m, c) for m, c in zip(mass, com, strict=True)]
        self.own = Revision(
            numbers="",
            buoyancy_table="",
            mass=mass,
            com=com,
            inertia=inertia,
            inertia_link=inertia + np.array(terms),
            volume=np.array([link.volume for link in links]),
            cob=np.array([link.cob for link in links]),
        )
        self.frames = _frames(record, index)


def _frames(record: Alpha5Parameters, index: int) -> dict[str, FloatArray]:
    """Name of a frame of our arm -> transform_body_to_frame at zero, (4, 4)."""
    at = {"base_link": np.eye(4)}
    fixed = fixed_frames(record)
    placements = {"link_0": fixed.pop("link_0")}
    for k, placement in enumerate(joint_placements(record), start=1):
        placements[f"link_{k}"] = placement
    for name, placement in {**placements, **fixed}.items():
        at[name] = at[placement.parent] @ pose(placement.xyz, placement.rpy)
    at["dh_0"] = at["base_link"]
    body = at[f"link_{index}"]
    return {name: np.linalg.inv(frame) @ body for name, frame in at.items()}


def _wrong_in_link(
    arm: _Arm, right: Body, parts: Sequence[Part], place: int, digits: Digits
) -> list[WrongNumber]:
    """The wrong numbers of one link.

    Args:
        arm: Our arm.
        right: What the link should say, in our link frame.
        parts: All links of the body.
        place: Which of them it is.
        digits: Of the file.
    """
    part = parts[place]
    here = right.at(np.linalg.inv(part.pose))
    slack = _slack(parts, place, digits)
    found = []
    for quantity in QUANTITIES:
        tolerance = _Tolerance(quantity, here, digits, slack[quantity])
        written = getattr(part.body, quantity)
        if not tolerance.holds(getattr(here, quantity), written):
            mistake = _explained(arm, right, part, tolerance)
            found.append(WrongNumber(part.link, quantity, mistake, here))
    return found


def _slack(parts: Sequence[Part], place: int, digits: Digits) -> dict[str, float]:
    """How much of each number rounding elsewhere may change: in joints, other links."""
    part = parts[place]
    body = part.body.at(part.pose)
    lever = float(np.linalg.norm(body.com))
    spread = float(np.abs(body.inertia).max())
    slack = {
        "mass": 0.0,
        "com": digits.length + digits.angle * lever,
        "inertia": 2 * digits.angle * spread,
    }
    for other in (*parts[:place], *parts[place + 1 :]):
        off = min(float(digits.com.half_digit(other.body.com).max()), MOST["com"])
        apart = float(np.linalg.norm(other.body.at(other.pose).com - body.com))
        tensor = float(digits.inertia.half_digit(other.body.inertia).max())
        mass = abs(other.body.mass)
        slack["com"] += off * mass / max(abs(body.mass), 1e-3)
        slack["inertia"] += min(tensor, MOST["inertia"]) + 2 * mass * apart * off
    return slack


class _Tolerance:
    """How closely two numbers of a kind must agree to be the same.

    Attributes:
        quantity: Which kind.
    """

    def __init__(
        self, quantity: Quantity, right: Body, digits: Digits, slack: float
    ) -> None:
        self.quantity = quantity
        self._size = float(np.abs(getattr(right, quantity)).max())
        self._precision: Precision = getattr(digits, quantity)
        self._slack = slack

    def holds(self, computed: ArrayLike, written: ArrayLike) -> bool:
        """Whether a computed number is the written one, to its digits."""
        computed = np.asarray(computed)
        # A number in another unit has its least difference in that unit.
        unit = float(np.abs(computed).max()) / self._size if self._size else 1.0
        half = np.minimum(
            self._precision.half_digit(written), MOST[self.quantity] * unit
        )
        # The slack follows from written numbers, so it is in their unit already.
        least = LEAST[self.quantity] * unit + self._slack
        return bool((np.abs(computed - written) <= half + least).all())


def _explained(
    arm: _Arm, right: Body, part: Part, tolerance: _Tolerance
) -> Mistake | None:
    """The first mistake that gives the written number; None if none does."""
    written = getattr(part.body, tolerance.quantity)
    for prefix, case, mistakes in _attempts(arm, right, part):
        unchanged = getattr(case.right, tolerance.quantity)
        for mistake in mistakes:
            for body in mistake.make(case):
                number = getattr(body, tolerance.quantity)
                is_mistake = mistake is RIGHT or not np.array_equal(number, unchanged)
                if is_mistake and tolerance.holds(number, written):
                    return _joined(prefix, mistake)
    return None


def _joined(*mistakes: Mistake) -> Mistake:
    """Two mistakes as one; `RIGHT` is none."""
    named = [mistake for mistake in mistakes if mistake.id]
    return Mistake(
        id=".".join(mistake.id for mistake in named),
        words=", ".join(mistake.words for mistake in named),
        make=named[-1].make,
    )


def _attempts(
    arm: _Arm, right: Body, part: Part
) -> Iterator[tuple[Mistake, Case, Sequence[Mistake]]]:
    """Right numbers and mistakes to make with them, the fewest mistakes first.

    Yields:
        What is already wrong with these numbers, the case, the mistakes.
    """
    to_link = np.linalg.inv(part.pose)
    elsewhere = np.abs(part.pose - np.eye(4)).max() > SAME_FRAME
    frame = Mistake("other_frame", f"in a frame that is not link_{arm.index}'s", _right)
    sources = [(RIGHT, arm.own, right)]
    for name, revision in zip(
        ("catalogue", "earlier_revision"), revisions(), strict=True
    ):
        body = _of_revision(revision, arm.index)
        sources.append((Mistake(name, revision.numbers, _right), revision, body))

    cases = []
    for source, table, in_ours in sources:
        for moved_by, view in ((to_link, RIGHT), (np.eye(4), frame)):
            if view is RIGHT or elsewhere:
                case = Case(
                    index=arm.index,
                    source=table,
                    right=in_ours.at(moved_by),
                    in_ours=in_ours,
                    to_link=moved_by,
                    frames=arm.frames,
                    written=part.body,
                )
                already = [m for m in (source, view) if m is not RIGHT]
                prefix = _joined(*already) if already else RIGHT
                cases.append((len(already), prefix, case))

    for count, prefix, case in cases:
        if count == 0:
            yield prefix, case, MISTAKES
        else:
            yield prefix, case, (RIGHT,)
    for count, prefix, case in cases:
        if count:
            yield prefix, case, MISTAKES
    for _, prefix, case in cases:
        yield prefix, case, FITTED


def _of_revision(revision: Revision, k: int) -> Body:
    return Body(float(revision.mass[k]), revision.com[k], revision.inertia[k])


def _right(case: Case) -> list[Body]:
    return [case.right]


#: No mistake.
RIGHT = Mistake("", "", _right)
