"""Tables of joint positions in which an arm certainly is, or is not, in self-collision.

The ranges of the joints are divided into cells. Between the middle of a cell and any
other place in it, the distance of two bodies changes by at most

    delta = sum_j rate_j h_j,

with the rates of `alpha5_model.collision.turning_radii` and half the edges h of the
cell. So a cell is certainly free if every pair is farther apart than delta in its
middle. It is certainly a hit if, in its middle, some pair touches with the shapes of
one body smaller by delta on all sides: a point that both then share stays in both.
All others are undecided, and the exact test is asked.

A table depends on the joints between the bodies of its pairs (`PLANS`). Where it is
undecided, the exact test is asked about its pairs only. Link 4 turns about its own
axis, and the tables hold for every theta_3: a cell is free if link 4 is, replaced by
cylinders about the axis that enclose its shapes; it is a hit if the wrist's own
cylinder is.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model.collision.bodies import Body, CollisionBodies
from alpha5_model.collision.turning_radii import corners_around, distance_rates
from alpha5_model.geometry.primitives import Primitive

FREE, HIT, UNDECIDED = range(3)
#: Cells are larger by this for rounding of an index [rad], distances by rounding [m].
_ROUNDING = 1e-9
#: Largest distance of a cylinder's centre from the axis that it is about [m], and of
#: its axis' cosine from 1.
_COAXIAL = 1e-9
#: Joint positions that are asked at a time.
_AT_ONCE = 1 << 18

#: Whether bodies come within a margin [m] at angles (N, B-1): (N,) bool.
Touches = Callable[[CollisionBodies, FloatArray, float], FloatArray]
#: Numbers of two bodies.
Pair = tuple[int, int]


class Plan(NamedTuple):
    """A table that is to be made.

    Attributes:
        pairs: The pairs of bodies that it answers for.
        joint: The first joint that it depends on.
        counts: Cells along this joint and the next ones.
    """

    pairs: tuple[Pair, ...]
    joint: int
    counts: tuple[int, ...]


#: All pairs of link_0 to link_4 that are compared.
PLANS = (
    Plan(pairs=((0, 2),), joint=0, counts=(1024, 1024)),
    Plan(pairs=((1, 4),), joint=1, counts=(512, 512)),
    Plan(pairs=((2, 4),), joint=2, counts=(4096,)),
    Plan(pairs=((0, 3), (0, 4)), joint=0, counts=(64, 64, 128)),
)


@dataclass(frozen=True, eq=False)
class Cells:
    """A table of joint positions.

    Attributes:
        pairs: The pairs of bodies that it answers for.
        joint: The first of the J neighbouring joints that it depends on.
        lower, upper: Their ranges, (J,) [rad].
        codes: `FREE`, `HIT` or `UNDECIDED` in each cell, uint8, J axes.
    """

    pairs: tuple[Pair, ...]
    joint: int
    lower: FloatArray
    upper: FloatArray
    codes: np.ndarray

    @property
    def per_radian(self) -> FloatArray:
        """Cells per radian along each joint, (J,)."""
        return np.asarray(self.codes.shape / (self.upper - self.lower))

    def look_up(self, q: FloatArray) -> np.ndarray:
        """Codes of joint positions (N, 4); `UNDECIDED` beyond the ranges or for NaN."""
        angles = q[:, self.joint : self.joint + len(self.codes.shape)]
        place = (angles - self.lower) * self.per_radian
        known = ((place >= 0.0) & (place <= self.codes.shape)).all(axis=1)
        cell = np.zeros(place.shape, np.intp)
        cell[known] = np.minimum(place[known], np.array(self.codes.shape) - 1)
        codes = self.codes[tuple(cell.T)]
        return np.where(known, codes, np.uint8(UNDECIDED))


def certified_cells(
    bodies: CollisionBodies, lower: FloatArray, upper: FloatArray, touches: Touches
) -> tuple[Cells, ...]:
    """The tables of an arm with closed jaws.

    Args:
        bodies: Of the arm, link_0 to link_4.
        lower, upper: Limits of theta_0 to theta_3, (4,) [rad].
        touches: The exact test.
    """
    return tuple(_table(plan, bodies, lower, upper, touches) for plan in PLANS)


def _table(
    plan: Plan,
    bodies: CollisionBodies,
    lower: FloatArray,
    upper: FloatArray,
    touches: Touches,
) -> Cells:
    """One of the tables, see `certified_cells`."""
    outer = _with_shapes(bodies, 4, _cylinders_around(bodies.bodies[4]))
    inner = _with_shapes(bodies, 4, _cylinders_about_axis(bodies.bodies[4]))
    joints = slice(plan.joint, plan.joint + len(plan.counts))
    counts = plan.counts
    lower = lower[joints]
    upper = upper[joints]
    half = (upper - lower) / counts / 2 + _ROUNDING
    middles = [
        low + (np.arange(count) + 0.5) * (high - low) / count
        for low, high, count in zip(lower, upper, counts, strict=True)
    ]
    grid = np.stack(np.meshgrid(*middles, indexing="ij"), axis=-1)
    angles = np.zeros((math.prod(counts), 4))
    angles[:, joints] = grid.reshape(-1, len(counts))

    free = np.ones(len(angles), np.bool_)
    hit = np.zeros(len(angles), np.bool_)
    for pair in plan.pairs:
        first = pair[0]
        for shape in outer.bodies[first].shapes:
            one = _with_shapes(replace(outer, pairs=(pair,)), first, [shape])
            rates = distance_rates(one, pair)[joints]
            delta = float(rates @ half) + _ROUNDING
            near = _in_blocks(touches, one, angles, delta)
            free &= ~near

            asked = np.flatnonzero(near & ~hit)
            core = _with_shapes(
                replace(inner, pairs=(pair,)), first, _shrunk(shape, delta)
            )
            hit[asked] = _in_blocks(touches, core, angles[asked], 0.0)

    codes = np.full(len(angles), UNDECIDED, np.uint8)
    codes[free] = FREE
    codes[hit] = HIT
    return Cells(
        pairs=plan.pairs,
        joint=plan.joint,
        lower=lower,
        upper=upper,
        codes=codes.reshape(counts),
    )


def _in_blocks(
    touches: Touches, bodies: CollisionBodies, angles: FloatArray, margin: float
) -> BoolArray:
    hits = [
        touches(bodies, angles[start : start + _AT_ONCE], margin)
        for start in range(0, len(angles), _AT_ONCE)
    ]
    return np.concatenate(hits) if hits else np.zeros(0, np.bool_)


def _with_shapes(
    bodies: CollisionBodies, number: int, shapes: Sequence[Primitive]
) -> CollisionBodies:
    """Bodies of which one has other shapes."""
    every = list(bodies.bodies)
    every[number] = replace(every[number], shapes=tuple(shapes))
    return replace(bodies, bodies=tuple(every))


def _shrunk(shape: Primitive, by: float) -> list[Primitive]:
    """A shape smaller on all sides; none if it is too thin."""
    less = (by, 2 * by) if shape.kind == "cylinder" else (2 * by,) * 3
    size = tuple(length - cut for length, cut in zip(shape.size, less, strict=True))
    return [replace(shape, size=size)] if min(size) > 0.0 else []


def _cylinders_around(link: Body) -> tuple[Primitive, ...]:
    """Cylinders about a link's z axis, one around each of its shapes."""
    cylinders = []
    for shape in link.shapes:
        corners = corners_around(shape)
        low, high = corners[:, 2].min(), corners[:, 2].max()
        radius = np.hypot(corners[:, 0], corners[:, 1]).max()
        cylinders.append(
            Primitive(
                kind="cylinder",
                size=(float(radius), float(high - low)),
                xyz=(0.0, 0.0, float(low + high) / 2),
            )
        )
    return tuple(cylinders)


def _cylinders_about_axis(link: Body) -> tuple[Primitive, ...]:
    """The shapes of a link that are cylinders about its z axis."""
    return tuple(
        shape
        for shape in link.shapes
        if shape.kind == "cylinder"
        and math.hypot(*shape.xyz[:2]) < _COAXIAL
        and math.cos(shape.rpy[0]) * math.cos(shape.rpy[1]) > 1.0 - _COAXIAL
    )
