"""The single mistakes that people make with the numbers of a body, in one table.

Each makes a wrong body of the right one. `wrong_numbers` tries them in this order. The
first that gives the written number to its digits explains it; a number that none gives
has no explanation.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import moved
from alpha5_model.numbers.fluids import FRESH_WATER
from alpha5_model.numbers.inertia import flip_products, point_mass_tensor
from alpha5_model.proofs.comparison.document_revisions import Revision

I_LINK = (
    "I_Link used as I_COM (about the link frame, not the COM: "
    "the parallel-axis term twice)"
)
SOLIDWORKS = "products of inertia have the SolidWorks sign, that of the document"

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

    @property
    def to_link(self) -> FloatArray:
        """transform_ours_to_link, (4, 4)."""
        return np.asarray(np.linalg.inv(self.pose), np.float64)


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


def _about_link(case: Case) -> list[Body]:
    """I_Link: the tensor about the link frame, computed and as printed."""
    right = case.right
    computed = right.inertia + point_mass_tensor(right.mass, right.com)
    rotation = case.to_link[:3, :3]
    printed = rotation @ case.source.inertia_link[case.index] @ rotation.T
    return case.with_inertia(computed, printed)


def _pasted_about_link(case: Case) -> list[Body]:
    """I_Link pasted as the document prints it: one slip, although two are wrong."""
    return case.with_inertia(
        *(flip_products(body.inertia) for body in _about_link(case))
    )


def _pasted_from_solidworks(case: Case, per_si: float) -> list[Body]:
    """I_COM pasted from SolidWorks, or the document: unit and signs are wrong."""
    return case.with_inertia(flip_products(case.right.inertia) * per_si)


def _less_term(case: Case) -> list[Body]:
    """I_COM less the parallel-axis term."""
    right = case.right
    return case.with_inertia(right.inertia - point_mass_tensor(right.mass, right.com))


def _without_terms(case: Case) -> list[Body]:
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
    return case.with_inertia(case.right.inertia + point_mass_tensor(1.0, point))


def _in_other_axes(case: Case) -> list[Body]:
    """The principal moments in the axes of the written tensor."""
    moments = np.linalg.eigvalsh(case.right.inertia)
    _, axes = np.linalg.eigh(case.written.inertia)
    return case.with_inertia(axes @ np.diag(moments) @ axes.T)


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
            words = f"in the wrong axes ({', '.join(names)})"
            yield words, np.diag(signs) @ np.eye(3)[list(order)]


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
    *_rows(
        _pasted_from_solidworks,
        ("kg_mm2_solidworks", f"in kg mm^2, {SOLIDWORKS}", 1e6),
        ("g_mm2_solidworks", f"in g mm^2, {SOLIDWORKS}", 1e9),
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
        "other_axes", "the principal moments are right, not their axes", _in_other_axes
    ),
    Mistake(
        "no_parallel_axis",
        "the parallel-axis terms of its parts are missing",
        _without_terms,
    ),
    Mistake("wrong_point", "about another point than the COM", _about_another_point),
)
