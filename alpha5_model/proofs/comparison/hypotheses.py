"""The wrong numbers that known mistakes make of the tables of two revisions.

A table of hypotheses holds the numbers that one mistake, or two at once, make of a
printed number.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import moved
from alpha5_model.numbers.fluids import FRESH_WATER, SEA_WATER
from alpha5_model.numbers.inertia import flip_products, point_mass_tensor, rotate_tensor
from alpha5_model.numbers.jaws import split_link_4
from alpha5_model.numbers.parameters import LinkParameters
from alpha5_model.proofs.comparison.document_revisions import Revision, revisions
from alpha5_model.proofs.comparison.hypothesis_tables import (
    Hypothesis,
    HypothesisTable,
    Step,
    mass_hypothesis,
    products_step,
    signed_axes,
    table_of,
    with_mistakes,
)
from alpha5_model.proofs.comparison.own_arm import OwnArm
from alpha5_model.proofs.comparison.poses import rotation_of

I_LINK = (
    "I_Link used as I_COM (about the link frame, not the COM: "
    "the parallel-axis term twice)"
)
SOLIDWORKS = "products of inertia have the SolidWorks sign, that of the document"
ZEROED = "the products of inertia are zeroed"


@dataclass(frozen=True, eq=False)
class BodyHypotheses:
    """The numbers that known mistakes make of the printed ones of one body.

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
        return table_of(found)

    @cached_property
    def coms(self) -> HypothesisTable:
        """COMs in the body's own link frame, (N, 3) [m], the right one among them."""
        axes = [Step(words, partial(np.dot, matrix)) for words, matrix in signed_axes()]
        elsewhere = [
            Step(words, partial(moved, to_frame))
            for words, to_frame in self.frames().items()
        ]
        return with_mistakes(self._sources("com"), axes, elsewhere)

    @cached_property
    def tensors(self) -> HypothesisTable:
        """Tensors in the body's axes, (N, 3, 3) [kg m^2], the right one among them."""
        sources = self._sources("inertia")
        for revision in revisions():
            sources += self._parallel_axis_mistakes(revision)
        signs = [
            products_step(SOLIDWORKS, xy=-1, xz=-1, yz=-1),
            products_step(ZEROED, xy=0, xz=0, yz=0),
        ]
        single_signs = [
            products_step("ixy has the wrong sign", xy=-1, xz=1, yz=1),
            products_step("ixz has the wrong sign", xy=1, xz=-1, yz=1),
            products_step("iyz has the wrong sign", xy=1, xz=1, yz=-1),
        ]
        return with_mistakes(sources, signs, self._turns(), single_signs)

    def frames(self) -> dict[str, FloatArray]:
        """Other frames in which a number may have been written.

        Returns:
            Words -> transform_body_to_frame at zero, (4, 4).
        """
        names = {f"in DH frame {{{k}}}": f"dh_{k}" for k in range(1, 6)}
        for k in self.others:
            names[f"in the frame of link_{k}"] = f"link_{k}"

        body = self.ours.reduced.poses(np.zeros(4))[self.body]
        frames = self.ours.frame_poses
        return {
            words: np.linalg.inv(frames[name]) @ body for words, name in names.items()
        }

    def _sources(self, name: str) -> list[Hypothesis]:
        """A quantity of this body and of the others, and the COB for a COM."""
        found = []
        for revision in revisions():
            numbers = revision.numbers
            values = getattr(revision, name)
            own = values[self.body]
            found.append(Hypothesis(words=numbers, value=own, mistakes=0))
            if name == "com":
                words = f"the centre of buoyancy of {revision.buoyancy_table}"
                cob = revision.cob[self.body]
                found.append(Hypothesis(words=words, value=cob, mistakes=1))
            for k in self.others:
                words = f"{numbers} of link_{k}"
                found.append(Hypothesis(words=words, value=values[k], mistakes=1))
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
        found = []
        for about_link in (printed, at_com + term):
            flipped = flip_products(about_link)
            found.append(Hypothesis(words=words, value=about_link, mistakes=1))
            found.append(Hypothesis(words=pasted, value=flipped, mistakes=1))

        words = f"{revision.numbers}, the parallel-axis term taken off I_COM"
        found.append(Hypothesis(words=words, value=at_com - term, mistakes=1))
        return found

    def _turns(self) -> list[Step]:
        """Tensors in wrong axes or other frames."""
        rotations = {
            words: matrix
            for words, matrix in signed_axes()
            if np.linalg.det(matrix) > 0
        }
        for words, to_frame in self.frames().items():
            rotations[words] = rotation_of(to_frame)
        return [
            Step(words, partial(rotate_tensor, rotation))
            for words, rotation in rotations.items()
        ]

    def _masses_of_revisions(self) -> Iterator[Hypothesis]:
        """Masses of this body and of others, of the whole arm, and of the water."""
        now, earlier = revisions()
        body = self.body
        yield mass_hypothesis("the mass of Table 2", now.mass[body])
        yield mass_hypothesis("an earlier revision's mass", earlier.mass[body])
        for k in self.others:
            yield mass_hypothesis(f"that of link_{k}", now.mass[k])
        for k in self.others:
            yield mass_hypothesis(f"an earlier revision's of link_{k}", earlier.mass[k])
        yield mass_hypothesis("that of the whole arm", now.mass.sum())
        yield mass_hypothesis(
            "that of the displaced water", now.volume[body] * FRESH_WATER
        )

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
            yield mass_hypothesis(words, dry.mass[self.body] + water)

    def _masses_with_jaws(self) -> Iterator[Hypothesis]:
        """The mass of link_4 with its jaws counted again."""
        if self.body != 4:
            return
        now, _ = revisions()
        jaws = split_link_4(self.ours.parameters).bodies[1:]
        jaw_mass = sum(jaw.mass for jaw in jaws)
        yield mass_hypothesis("the jaws are counted twice", now.mass[4] + jaw_mass)


@lru_cache(maxsize=20)
def hypotheses_of(ours: OwnArm, body: int) -> BodyHypotheses:
    """The hypotheses of one body, the same object for the same arm."""
    return BodyHypotheses(ours=ours, body=body)
