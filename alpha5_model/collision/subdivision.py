"""The pairs of shapes of two bodies that can ever touch, by subdivision.

The box of the joints' ranges is divided into cells. A pair is done with a cell if a
lower bound of its distance over the cell is positive
(`alpha5_model.collision.distance_bounds`), and altogether if a joint position is found
where it touches. What is left of a cell is halved along the joint that can change the
distances most. A pair that is done with all cells never touches.

Witnesses are found at the centres of cells and, for pairs that touch in a corner of the
ranges only, by descent from the smallest distance seen.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model.collision.distance_bounds import (
    Cells,
    IntArray,
    PairDistances,
)
from alpha5_model.collision.link_chain import BodyPair

#: By how much a bound must exceed the margin [m]: coal's distances are good to 1e-6.
TOLERANCE = 1e-5
#: Pairs of shapes and cells that a proof may look at before it gives up.
EFFORT = 2_000_000
#: How many of them are computed at once: some ten megabytes.
_AT_ONCE = 10_000
#: Descents start after so many halvings, and again every few of them.
_FIRST_DESCENT = 18
_NEXT_DESCENT = 6
#: First step of a descent, and the last one [rad].
_LARGE_STEP = 0.1
_SMALL_STEP = 1e-5

ShapePair = tuple[int, int]


@dataclass(frozen=True, eq=False)
class Proof:
    """Which shapes of two bodies can touch, by their numbers in the bodies.

    Attributes:
        bodies: The two bodies.
        witnesses: Pair that can touch -> angles of the joints between the bodies at
            which it does, (m,) [rad].
        undecided: Pairs for which there is neither a witness nor a proof.
        nearest: The smallest distance that was seen [m].
        effort: How many pairs of shapes and cells were looked at.
    """

    bodies: BodyPair
    witnesses: dict[ShapePair, FloatArray]
    undecided: tuple[ShapePair, ...]
    nearest: float
    effort: int

    @property
    def never(self) -> bool:
        """Whether it is proven that no pair ever touches."""
        return not self.witnesses and not self.undecided


def prove(
    bodies: BodyPair,
    margin: float = 0.0,
    effort: int = EFFORT,
    until_contact: bool = False,
) -> Proof:
    """Decide for each pair of shapes of two bodies whether it can ever touch.

    Args:
        bodies: The two bodies.
        margin: Shapes that come so near count as touching [m].
        effort: Pairs of shapes and cells to look at before giving up.
        until_contact: Stop at the first contact; all other pairs are then undecided.
    """
    search = _Search(bodies, margin)
    level = 0
    while search.is_open and search.effort < effort:
        search.look_at_cells()
        descends = level - _FIRST_DESCENT
        if descends >= 0 and descends % _NEXT_DESCENT == 0:
            search.descend()
        if until_contact and search.witnesses:
            break
        search.halve()
        level += 1
    return Proof(
        bodies=bodies,
        witnesses=search.witnesses,
        undecided=search.undecided,
        nearest=search.nearest,
        effort=search.effort,
    )


class _Search:
    """Cells and the pairs that are not done with them.

    Attributes:
        witnesses: See `Proof`.
        effort: See `Proof`.
    """

    def __init__(self, bodies: BodyPair, margin: float) -> None:
        self._bodies = bodies
        self._margin = margin
        self._distances = PairDistances(bodies)
        first, second, joints = self._distances.radii.shape
        number = np.arange(first * second)
        self._first = number // second
        self._second = number % second
        self._radii = self._distances.radii.reshape(-1, joints)

        middle = (bodies.lower + bodies.upper) / 2
        half = (bodies.upper - bodies.lower) / 2
        self._cells = Cells(centre=middle[None], half=half[None])
        # An item is a pair that is not done with a cell.
        self._cell = np.zeros(len(number), np.intp)
        self._pair = number
        self._nearest = np.full(len(number), np.inf)
        self._nearest_at = np.tile(middle, (len(number), 1))
        self.witnesses: dict[ShapePair, FloatArray] = {}
        self.effort = 0

    @property
    def is_open(self) -> bool:
        """Whether any pair is not done with any cell."""
        return len(self._pair) > 0

    @property
    def nearest(self) -> float:
        """The smallest distance that was seen [m]."""
        return float(self._nearest.min())

    @property
    def undecided(self) -> tuple[ShapePair, ...]:
        """Pairs that are not done."""
        return tuple(self._shapes(pair) for pair in np.unique(self._pair))

    def look_at_cells(self) -> None:
        """Drop the items with a positive bound, and the pairs that touch."""
        frames = self._distances.frames(self._cells.centre)
        pieces = range(0, len(self._pair), _AT_ONCE)
        items = [slice(start, start + _AT_ONCE) for start in pieces]
        left = [self._is_left(self._cell[i], self._pair[i], frames) for i in items]
        self.effort += len(self._pair)
        self._keep(np.concatenate(left))

    def _is_left(self, cell: IntArray, pair: IntArray, frames: FloatArray) -> BoolArray:
        """Whether each item is still open after the three bounds, (k,)."""
        distances = self._distances
        reach = np.einsum("ij,ij->i", self._radii[pair], self._cells.half[cell])
        enough = self._margin + TOLERANCE
        placed = distances.placed(
            frames[cell, -1], self._first[pair], self._second[pair]
        )
        left = np.asarray(distances.of_boxes(placed) - reach <= enough)

        near = np.flatnonzero(left)
        distance, between = distances.of_coal(placed.only(left))
        self._remember(pair[near], distance, self._cells.centre[cell[near]])
        left[near] = distance - reach[near] <= enough

        # A witness ends the pair; the third bound is for those without.
        apart = left[near] & (distance > self._margin)
        near = near[apart]
        bound = distances.by_taylor(
            placed.only(np.isin(np.arange(len(pair)), near)),
            frames[cell[near]],
            self._cells.half[cell[near]],
            between[apart],
        )
        left[near] = bound <= enough
        return left

    def _remember(self, pair: IntArray, distance: FloatArray, q: FloatArray) -> None:
        """Keep the smallest distance of each pair, and the contacts."""
        # From large to small: of several items of a pair, the last one counts.
        order = np.argsort(-distance, kind="stable")
        order = order[distance[order] < self._nearest[pair[order]]]
        self._nearest[pair[order]] = distance[order]
        self._nearest_at[pair[order]] = q[order]
        for i in np.flatnonzero(distance <= self._margin):
            self.witnesses.setdefault(self._shapes(pair[i]), q[i])

    def descend(self) -> None:
        """From the smallest distance of each open pair, go downhill to a contact."""
        for pair in np.unique(self._pair):
            self._descend(int(pair))
        self._keep(np.ones(len(self._pair), np.bool_))

    def _descend(self, pair: int) -> None:
        """Pattern search within the ranges: the best of a step each way, by joint."""
        steps = np.concatenate([np.eye(len(self._bodies.joints))] * 2)
        steps[len(steps) // 2 :] *= -1.0
        numbers = np.full(len(steps), pair)
        size = _LARGE_STEP
        while size > _SMALL_STEP and self._nearest[pair] > self._margin:
            before = self._nearest[pair]
            q = self._nearest_at[pair] + size * steps
            q = np.clip(q, self._bodies.lower, self._bodies.upper)
            self._remember(numbers, self._distance(numbers, q), q)
            if self._nearest[pair] >= before:
                size /= 3

    def _distance(self, pair: IntArray, q: FloatArray) -> FloatArray:
        """coal's distances of pairs (k,) at q (k, m), (k,)."""
        frame = self._distances.frames(q)[:, -1]
        placed = self._distances.placed(frame, self._first[pair], self._second[pair])
        distance, _ = self._distances.of_coal(placed)
        self.effort += len(pair)
        return distance

    def halve(self) -> None:
        """Halve each cell along the joint that can change its distances most."""
        cells, item_cell = np.unique(self._cell, return_inverse=True)
        half = self._cells.half[cells]
        radius = np.zeros_like(half)
        np.maximum.at(radius, item_cell, self._radii[self._pair])
        row = np.arange(len(cells))
        joint = np.argmax(radius * half, axis=1)

        half[row, joint] /= 2
        below = self._cells.centre[cells]
        above = below.copy()
        below[row, joint] -= half[row, joint]
        above[row, joint] += half[row, joint]
        self._cells = Cells(
            centre=np.concatenate([below, above]), half=np.concatenate([half, half])
        )
        self._cell = np.concatenate([item_cell, item_cell + len(cells)])
        self._pair = np.concatenate([self._pair, self._pair])

    def _keep(self, left: BoolArray) -> None:
        """Keep these items, without those of pairs that touch."""
        touching = [
            one * len(self._bodies.second.half) + other for one, other in self.witnesses
        ]
        left = left & ~np.isin(self._pair, touching)
        self._cell = self._cell[left]
        self._pair = self._pair[left]

    def _shapes(self, pair: int) -> ShapePair:
        """Numbers of the two shapes of a pair."""
        return int(self._first[pair]), int(self._second[pair])
