"""The wrong numbers that known mistakes would give, made from the tables of two revisions.

Version 7 of the document, and the earlier revision whose numbers public models carry
(``numbers/earlier_revision.toml``; supplementary, no document seen). The model itself knows
version 7 only. Each table of hypotheses holds what one mistake or two at a time make of a printed
number.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import moved
from alpha5_model.numbers.fluids import FRESH_WATER, SEA_WATER
from alpha5_model.numbers.inertia import flip_products, point_mass_tensor, rotate_tensor
from alpha5_model.numbers.jaws import split_link_4
from alpha5_model.numbers.parameters import in_si, parameters
from alpha5_model.numbers.printed import published
from alpha5_model.numbers.reading import earlier_revision
from alpha5_model.proofs.comparison.arm import our_arm

#: Two mistakes at a time; with three, some combination fits any number.
MOST_MISTAKES = 2

I_LINK = "I_Link used as I_COM (about the link frame, not the COM: the parallel-axis term twice)"
SOLIDWORKS = "products of inertia have the SolidWorks sign, that of the document"


@dataclass(frozen=True, eq=False)
class Revision:
    """Tables 2 and 3 of one revision in SI units, base to tip.

    Attributes:
        numbers: What its numbers are called, "Table 2's numbers".
        mass: (5,) [kg].
        com, cob: Centres of mass and of buoyancy, (5, 3) [m].
        inertia: At the COM, URDF sign, (5, 3, 3) [kg m^2].
        inertia_link: At the origin of the link frame, URDF sign, (5, 3, 3) [kg m^2].
        volume: (5,) [m^3].
    """

    numbers: str
    mass: FloatArray
    com: FloatArray
    inertia: FloatArray
    inertia_link: FloatArray
    volume: FloatArray
    cob: FloatArray


@cache
def revisions() -> tuple[Revision, Revision]:
    """Version 7, then the earlier revision."""
    document, earlier = published(), earlier_revision()
    now = _revision("Table 2's numbers", document.table_2.rows, document.table_3.rows)
    return now, _revision("an earlier revision's numbers", earlier, earlier)


def _revision(
    numbers: str, inertial: Iterable[Any], buoyancy: Iterable[Any]
) -> Revision:
    """From the printed rows of its two tables."""

    def column(rows: Iterable[Any], name: str) -> FloatArray:
        return np.array([in_si(getattr(row, name)) for row in rows])

    mass, com = column(inertial, "mass"), column(inertial, "com")
    at_com, at_link = (
        column(inertial, f"inertia_{point}") for point in ("com", "link")
    )
    volume, cob = column(buoyancy, "volume"), column(buoyancy, "cob")
    return Revision(
        numbers, mass, com, flip_products(at_com), flip_products(at_link), volume, cob
    )


#: The mistakes, as a person would say them; the mass (), COM (3,) or tensor (3, 3) that they give,
#: SI; and how many they are.
Hypothesis = tuple[str, FloatArray, int]
#: Several, each of the three side by side, fewest mistakes first.
Hypotheses = tuple[tuple[str, ...], FloatArray, NDArray[np.int_]]
Step = tuple[str, Callable[[FloatArray], FloatArray]]


def _table(found: Iterable[Hypothesis]) -> Hypotheses:
    words, values, mistakes = zip(*sorted(found, key=lambda one: one[2]), strict=True)
    return words, np.array(values), np.array(mistakes)


def _with_mistakes(sources: list[Hypothesis], *stages: list[Step]) -> Hypotheses:
    """What the steps, at most one of each stage, make of the sources."""
    found = []
    for source in sources:
        made = [source]
        for stage in stages:
            pairs = itertools.product(
                [one for one in made if one[2] < MOST_MISTAKES], stage
            )
            made += [
                (f"{old}, {new}", change(x), n + 1)
                for (old, x, n), (new, change) in pairs
            ]
        found += made
    return _table(found)


def frames(body: int) -> dict[str, FloatArray]:
    """Other frames a number may be taken from: words -> transform_body_to_frame (4, 4), at zero."""
    ours, here = our_arm(), our_arm().poses(np.zeros(4))
    there = {
        name: here[i] @ ours.link_poses[name]
        for i in range(5)
        for name in ours.links[i]
    }
    named = {f"in DH frame {{{k}}}": f"dh_{k}" for k in range(1, 6)}
    named |= {f"in the frame of link_{k}": f"link_{k}" for k in range(5) if k != body}
    return {
        words: np.linalg.inv(there[name]) @ here[body] for words, name in named.items()
    }


def _signed_axes() -> Iterator[tuple[str, FloatArray]]:
    """The 47 ways to exchange and reverse axes; one reversed axis before two that contain it."""
    for order in itertools.permutations(range(3)):
        for signs in itertools.product((1, -1), repeat=3):
            axes = [
                f"{'-' * (s < 0)}{'xyz'[k]}" for s, k in zip(signs, order, strict=True)
            ]
            words = f"in the wrong axes ({', '.join(axes)})"
            if order == (0, 1, 2):
                wrong = [axis[1:] for axis in axes if axis.startswith("-")]
                right = [axis for axis in axes if not axis.startswith("-")]
                one = f"the sign of {''.join(wrong)} is wrong (mirrored)"
                two = f"turned by pi about {''.join(right)}"
                words = ("", one, two, "mirrored through the origin")[len(wrong)]
            if words:
                yield words, np.diag(signs) @ np.eye(3)[list(order)]


def _sources(name: str, body: int) -> list[Hypothesis]:
    """The quantity of this body, the COB for a COM, and those of other bodies; both revisions."""
    found: list[Hypothesis] = []
    for table, whose in zip(
        revisions(), ("Table 3", "an earlier revision"), strict=True
    ):
        numbers, values = table.numbers, getattr(table, name)
        found.append((numbers, values[body], 0))
        if name == "com":
            found.append((f"the centre of buoyancy of {whose}", table.cob[body], 1))
        found += [
            (f"{numbers} of link_{k}", values[k], 1) for k in range(5) if k != body
        ]
    return found


@cache
def wrong_coms(body: int) -> Hypotheses:
    """COMs of a body in its own link frame, (3,) [m], the right one among them."""
    axes: list[Step] = [(words, partial(np.dot, m)) for words, m in _signed_axes()]
    elsewhere: list[Step] = [
        (words, partial(moved, t)) for words, t in frames(body).items()
    ]
    return _with_mistakes(_sources("com", body), axes, elsewhere)


@cache
def wrong_tensors(body: int) -> Hypotheses:
    """Tensors of a body in its own link's axes, (3, 3) [kg m^2], the right one among them."""
    sources = _sources("inertia", body)
    for table in revisions():
        own, term = (
            table.inertia[body],
            point_mass_tensor(table.mass[body], table.com[body]),
        )
        words = f"{table.numbers}, {I_LINK}"
        for tensor in (table.inertia_link[body], own + term):
            # Pasted as the document prints it: one slip, although two things are wrong.
            sources += [
                (words, tensor, 1),
                (f"{words}, {SOLIDWORKS}", flip_products(tensor), 1),
            ]
        words = f"{table.numbers}, the parallel-axis term taken off I_COM"
        sources.append((words, own - term, 1))
    zeroed = "the products of inertia are zeroed"
    signs = [_products(SOLIDWORKS, -1, -1, -1), _products(zeroed, 0, 0, 0)]
    rotations = [(words, m) for words, m in _signed_axes() if np.linalg.det(m) > 0]
    rotations += [(words, pose[:3, :3]) for words, pose in frames(body).items()]
    turns: list[Step] = [(words, partial(rotate_tensor, r)) for words, r in rotations]
    flips = zip(("xy", "xz", "yz"), 1 - 2 * np.eye(3), strict=True)
    single = [
        _products(f"i{entry} has the wrong sign", *signs) for entry, signs in flips
    ]
    return _with_mistakes(sources, signs, turns, single)


def _products(words: str, xy: float, xz: float, yz: float) -> Step:
    """The step that multiplies the products of inertia by these factors."""
    return words, partial(
        np.multiply, np.array([[1, xy, xz], [xy, 1, yz], [xz, yz, 1]])
    )


@cache
def wrong_masses(body: int) -> Hypotheses:
    """Masses of a body, () [kg]."""
    now, before = revisions()
    found = [("the mass of Table 2", now.mass[body])]
    found.append(("an earlier revision's mass", before.mass[body]))
    for table, words in ((now, "that"), (before, "an earlier revision's")):
        found += [
            (f"{words} of link_{k}", table.mass[k]) for k in range(5) if k != body
        ]
    found.append(("that of the whole arm", now.mass.sum()))
    found.append(("that of the displaced water", now.volume[body] * FRESH_WATER))
    # Many public models pair the earlier revision's masses with version 7's volumes.
    for dry, wet in ((now, now), (before, before), (before, now)):
        whose = "Tables 2 and 3's" if dry is now else "an earlier revision's"
        volume = "its volume" if dry is wet else "Table 3's volume"
        for density in (FRESH_WATER, SEA_WATER):
            water = wet.volume[body] * density
            words = f"{whose} mass and the water's added mass of {volume}, {water * 1e3:.0f} g"
            found.append((words, dry.mass[body] + water))
    if body == 4:
        parts = sum(part.mass for part in split_link_4(parameters()).bodies[1:])
        found.append(("the jaws are counted twice", now.mass[4] + parts))
    return _table([(words, value, 1) for words, value in found])
