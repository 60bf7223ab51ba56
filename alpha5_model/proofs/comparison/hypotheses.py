"""The wrong numbers that known mistakes would give, made from the tables of two revisions.

Each table of hypotheses holds what one mistake or two at a time make of a printed number.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import moved
from alpha5_model.numbers.fluids import FRESH_WATER, SEA_WATER
from alpha5_model.numbers.inertia import flip_products, point_mass_tensor, rotate_tensor
from alpha5_model.numbers.jaws import split_link_4
from alpha5_model.numbers.parameters import LinkParameters
from alpha5_model.proofs.comparison.own_arm import OwnArm
from alpha5_model.proofs.comparison.revisions import Revision, revisions

#: Two mistakes at a time; with three, some combination fits any number.
MOST_MISTAKES = 2

I_LINK = (
    "I_Link used as I_COM (about the link frame, not the COM: "
    "the parallel-axis term twice)"
)
SOLIDWORKS = "products of inertia have the SolidWorks sign, that of the document"
ZEROED = "the products of inertia are zeroed"


class Hypothesis(NamedTuple):
    """A wrong number.

    Attributes:
        words: The mistakes, as a person would say them.
        value: The mass (), COM (3,) or tensor (3, 3) that they give, SI.
        mistakes: How many they are.
    """

    words: str
    value: FloatArray
    mistakes: int


class HypothesisTable(NamedTuple):
    """Several hypotheses side by side, those with the fewest mistakes first.

    Attributes:
        words: (N,).
        values: (N,), (N, 3) or (N, 3, 3).
        mistakes: (N,).
    """

    words: tuple[str, ...]
    values: FloatArray
    mistakes: NDArray[np.int_]


class Step(NamedTuple):
    """A mistake in words, and what it makes of a number."""

    words: str
    change: Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, eq=False)
class BodyHypotheses:
    """What known mistakes make of the printed numbers of one body.

    Attributes:
        ours: Our arm.
        body: 0 for link_0 to 4 for link_4.
    """

    ours: OwnArm
    body: int

    @property
    def link(self) -> LinkParameters:
        """The body of our arm."""
        return self.ours.parameters.links[self.body]

    @property
    def others(self) -> list[int]:
        """Indices of the other bodies."""
        return [index for index in range(5) if index != self.body]

    @cached_property
    def masses(self) -> HypothesisTable:
        """Masses, (N,) [kg], the right one among them."""
        found = [
            *self._masses_of_revisions(),
            *self._masses_with_water(),
            *self._masses_with_jaws(),
        ]
        return _table(found)

    @cached_property
    def coms(self) -> HypothesisTable:
        """COMs in the body's own link frame, (N, 3) [m], the right one among them."""
        axes = [Step(words, partial(np.dot, matrix)) for words, matrix in signed_axes()]
        elsewhere = [
            Step(words, partial(moved, to_frame))
            for words, to_frame in self.frames().items()
        ]
        return _with_mistakes(self._sources("com"), axes, elsewhere)

    @cached_property
    def tensors(self) -> HypothesisTable:
        """Tensors in the body's own axes, (N, 3, 3) [kg m^2], the right one among them."""
        sources = self._sources("inertia")
        for revision in revisions():
            sources += self._parallel_axis_mistakes(revision)
        signs = [
            _products(SOLIDWORKS, xy=-1, xz=-1, yz=-1),
            _products(ZEROED, xy=0, xz=0, yz=0),
        ]
        single_signs = [
            _products("ixy has the wrong sign", xy=-1, xz=1, yz=1),
            _products("ixz has the wrong sign", xy=1, xz=-1, yz=1),
            _products("iyz has the wrong sign", xy=1, xz=1, yz=-1),
        ]
        return _with_mistakes(sources, signs, self._turns(), single_signs)

    def frames(self) -> dict[str, FloatArray]:
        """Other frames that a number may be taken from.

        Returns:
            Words -> transform_body_to_frame at zero, (4, 4).
        """
        names = {f"in DH frame {{{k}}}": f"dh_{k}" for k in range(1, 6)}
        names |= {f"in the frame of link_{k}": f"link_{k}" for k in self.others}

        arm = self.ours.reduced
        poses = arm.poses(np.zeros(4))
        found = {}
        for words, name in names.items():
            (body,) = (k for k, links in enumerate(arm.links) if name in links)
            frame = poses[body] @ arm.link_poses[name]
            found[words] = np.linalg.inv(frame) @ poses[self.body]
        return found

    def _sources(self, name: str) -> list[Hypothesis]:
        """A quantity of this body and of the others, and the COB for a COM."""
        found = []
        for revision, owner in zip(
            revisions(), ("Table 3", "an earlier revision"), strict=True
        ):
            numbers = revision.numbers
            values = getattr(revision, name)
            found.append(Hypothesis(numbers, values[self.body], 0))
            if name == "com":
                words = f"the centre of buoyancy of {owner}"
                found.append(Hypothesis(words, revision.cob[self.body], 1))
            for k in self.others:
                found.append(Hypothesis(f"{numbers} of link_{k}", values[k], 1))
        return found

    def _parallel_axis_mistakes(self, revision: Revision) -> list[Hypothesis]:
        """Tensors about a wrong point: I_Link for I_COM, or the term taken off."""
        at_com = revision.inertia[self.body]
        com = revision.com[self.body]
        term = point_mass_tensor(revision.mass[self.body], com)
        printed = revision.inertia_link[self.body]

        words = f"{revision.numbers}, {I_LINK}"
        # Pasted as the document prints it: one slip, although two things are wrong.
        pasted = f"{words}, {SOLIDWORKS}"
        taken_off = f"{revision.numbers}, the parallel-axis term taken off I_COM"
        return [
            Hypothesis(words, printed, 1),
            Hypothesis(pasted, flip_products(printed), 1),
            Hypothesis(words, at_com + term, 1),
            Hypothesis(pasted, flip_products(at_com + term), 1),
            Hypothesis(taken_off, at_com - term, 1),
        ]

    def _turns(self) -> list[Step]:
        """Tensors in wrong axes or other frames."""
        rotations = {
            words: matrix
            for words, matrix in signed_axes()
            if np.linalg.det(matrix) > 0
        }
        for words, to_frame in self.frames().items():
            rotations[words] = to_frame[:3, :3]
        return [
            Step(words, partial(rotate_tensor, rotation))
            for words, rotation in rotations.items()
        ]

    def _masses_of_revisions(self) -> Iterator[Hypothesis]:
        """Masses of this body and of others, of the whole arm, and of the water."""
        now, earlier = revisions()
        body = self.body
        yield _mass("the mass of Table 2", now.mass[body])
        yield _mass("an earlier revision's mass", earlier.mass[body])
        for k in self.others:
            yield _mass(f"that of link_{k}", now.mass[k])
        for k in self.others:
            yield _mass(f"an earlier revision's of link_{k}", earlier.mass[k])
        yield _mass("that of the whole arm", now.mass.sum())
        yield _mass("that of the displaced water", now.volume[body] * FRESH_WATER)

    def _masses_with_water(self) -> Iterator[Hypothesis]:
        """Masses with the water's added mass of the body's volume.

        Many public models pair the earlier revision's masses with version 7's volumes.
        """
        now, earlier = revisions()
        tables = "Tables 2 and 3's"
        old = "an earlier revision's"
        yield from self._with_water(tables, now, "its volume", now)
        yield from self._with_water(old, earlier, "its volume", earlier)
        yield from self._with_water(old, earlier, "Table 3's volume", now)

    def _with_water(
        self, owner: str, dry: Revision, volume: str, wet: Revision
    ) -> Iterator[Hypothesis]:
        """Masses of one revision with the water of a volume of one, in two waters."""
        for density in (FRESH_WATER, SEA_WATER):
            water = wet.volume[self.body] * density
            words = (
                f"{owner} mass and the water's added mass of {volume}, "
                f"{water * 1e3:.0f} g"
            )
            yield _mass(words, dry.mass[self.body] + water)

    def _masses_with_jaws(self) -> Iterator[Hypothesis]:
        """The mass of link_4 with its jaws counted again."""
        if self.body != 4:
            return
        now, _ = revisions()
        jaws = split_link_4(self.ours.parameters).bodies[1:]
        jaw_mass = sum(jaw.mass for jaw in jaws)
        yield _mass("the jaws are counted twice", now.mass[4] + jaw_mass)


@lru_cache(maxsize=20)
def hypotheses_of(ours: OwnArm, body: int) -> BodyHypotheses:
    """The hypotheses of one body, the same object for the same arm."""
    return BodyHypotheses(ours=ours, body=body)


def _mass(words: str, value: float) -> Hypothesis:
    """A mass by one mistake."""
    return Hypothesis(words=words, value=np.asarray(value), mistakes=1)


def _products(words: str, *, xy: float, xz: float, yz: float) -> Step:
    """The step that multiplies the products of inertia by these factors."""
    factors = np.array([[1, xy, xz], [xy, 1, yz], [xz, yz, 1]])
    return Step(words=words, change=partial(np.multiply, factors))


def _with_mistakes(
    sources: Iterable[Hypothesis], *stages: Sequence[Step]
) -> HypothesisTable:
    """What the steps, at most one of each stage, make of the sources."""
    found = []
    for source in sources:
        made = [source]
        for stage in stages:
            made += _one_more_mistake(made, stage)
        found += made
    return _table(found)


def _one_more_mistake(
    made: Sequence[Hypothesis], stage: Sequence[Step]
) -> list[Hypothesis]:
    """What each step makes of each hypothesis that has room for a mistake."""
    open_ones = [one for one in made if one.mistakes < MOST_MISTAKES]
    return [
        Hypothesis(
            words=f"{old.words}, {step.words}",
            value=step.change(old.value),
            mistakes=old.mistakes + 1,
        )
        for old, step in itertools.product(open_ones, stage)
    ]


def _table(found: Iterable[Hypothesis]) -> HypothesisTable:
    """Hypotheses side by side, those with the fewest mistakes first."""
    ordered = sorted(found, key=lambda one: one.mistakes)
    return HypothesisTable(
        words=tuple(one.words for one in ordered),
        values=np.array([one.value for one in ordered]),
        mistakes=np.array([one.mistakes for one in ordered]),
    )


def signed_axes() -> Iterator[tuple[str, FloatArray]]:
    """The 47 ways to exchange and reverse axes, in words and as matrices (3, 3).

    One reversed axis comes before two that contain it.
    """
    for order in itertools.permutations(range(3)):
        for signs in itertools.product((1, -1), repeat=3):
            words = _axes_in_words(order, signs)
            if words:
                yield words, np.diag(signs) @ np.eye(3)[list(order)]


def _axes_in_words(order: Sequence[int], signs: Sequence[int]) -> str:
    """How axes are exchanged and reversed; empty if they are not."""
    names = ["xyz"[k] for k in order]
    if names != ["x", "y", "z"]:
        signed = [
            f"-{name}" if sign < 0 else name
            for name, sign in zip(names, signs, strict=True)
        ]
        return f"in the wrong axes ({', '.join(signed)})"

    wrong = "".join(name for name, sign in zip(names, signs, strict=True) if sign < 0)
    right = "".join(name for name, sign in zip(names, signs, strict=True) if sign > 0)
    return (
        "",
        f"the sign of {wrong} is wrong (mirrored)",
        f"turned by pi about {right}",
        "mirrored through the origin",
    )[len(wrong)]
