"""Self-collision of an arm: whether it touches itself, how near it is, along a line.

The bodies are primitives that enclose the drawn ones within 3 mm
(`alpha5_model.geometry.collision_shapes`). Links that turn against each other at a
joint are not compared, and neither are those that cannot meet
(`alpha5_model.collision.link_pairs`).

Three routes give the same answers. Tables hold most joint positions of the catalogue's
arm, with a proof (`alpha5_model.collision.cells`). For the rest, and for other arms,
open jaws and margins, the compiled kernels test the shapes; without a compiler coal
does. How deep bodies overlap is always coal's answer; without coal it stays unknown.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model.collision.bodies import CollisionBodies, body_poses, collision_bodies
from alpha5_model.collision.cells import FREE, HIT, Cells
from alpha5_model.collision.cells_file import committed_cells
from alpha5_model.collision.coal_scene import CoalScene, Contact
from alpha5_model.collision.compiled import CompiledScene, is_compiled
from alpha5_model.collision.turning_radii import distance_rates
from alpha5_model.errors import MissingDependencyError, needing
from alpha5_model.numbers.parameters import Alpha5Parameters

#: A line that comes nearer to a contact than this is not proved free [m].
SHORTEST = 1e-6


@lru_cache(maxsize=16)
def self_collision(arm: Alpha5Parameters, gripper: str = "locked") -> SelfCollision:
    """The self-collision of an arm, made once.

    Args:
        arm: Its record.
        gripper: ``locked`` or ``jaws``.
    """
    return SelfCollision(collision_bodies(arm, gripper))


class SelfCollision:
    """The self-collision of one arm. Threads may share it.

    Angles are those of all bodies but the first: theta_0 to theta_3 [rad], with jaws
    also those of both fingers' hinges.

    Attributes:
        bodies: What is compared.
    """

    def __init__(self, bodies: CollisionBodies) -> None:
        self.bodies = bodies

    @cached_property
    def _tables(self) -> tuple[Cells, ...]:
        return committed_cells(self.bodies)

    @cached_property
    def _compiled(self) -> CompiledScene | None:
        """The compiled scene; None without the compiled kernels."""
        return CompiledScene(self.bodies, self._tables) if is_compiled() else None

    @cached_property
    def _coal(self) -> CoalScene:
        needed_for = "the depth of an overlap, or self-collision without a compiler,"
        with needing(needed_for, "pip install coal"):
            import coal  # noqa: F401
        return CoalScene(self.bodies)

    @cached_property
    def rates(self) -> FloatArray:
        """How fast joints change each pair's distance at most, (P, B-1) [m/rad]."""
        return np.array(
            [distance_rates(self.bodies, pair) for pair in self.bodies.pairs]
        )

    def touches(
        self,
        angles: FloatArray,
        margin: float = 0.0,
        asked: BoolArray | None = None,
    ) -> BoolArray:
        """Whether the arm comes within a margin of itself.

        Args:
            angles: (N, B-1); a row with NaN does not collide.
            margin: [m], at least 0.
            asked: (N,); rows where it is False do not collide. None for all.

        Returns:
            (N,) bool.
        """
        rows = _plain(angles)
        if self._compiled is not None:
            if asked is not None:
                asked = np.require(asked, np.bool_, ["C", "A"])
            return self._compiled.touches(rows, margin, asked)

        hits = np.zeros(len(rows), np.bool_)
        undecided = np.ones(len(rows), np.bool_) if asked is None else asked.copy()
        if margin == 0.0 and self._tables:
            codes = np.array([table.look_up(rows) for table in self._tables])
            hits = (codes == HIT).any(axis=0) & undecided
            undecided &= ~hits & ~(codes == FREE).all(axis=0)
        hits[undecided] = self._coal.touches(rows[undecided], margin)
        return hits

    def one(self) -> Callable[[Any, float], bool | None]:
        """A quick function of angles (B-1,) and a margin, float.

        It returns None if the angles are not plainly finite float64 of that shape.
        """
        if self._compiled is not None:
            return self._compiled.one()
        return lambda angles, margin: None

    def best_solution(self) -> Callable[[Any, Any, bool], FloatArray | None]:
        """A quick choice among the solutions of one target.

        A function of `SolutionArrays`, a reference and whether collisions are allowed.
        It returns the nearest valid solution, (4,), or None if that takes more than
        comparing them.
        """
        if self._compiled is not None:
            return self._compiled.best_solution()
        return lambda solutions, q_reference, allow_collision: None

    def distance(self, angles: FloatArray) -> FloatArray:
        """The least distance between compared bodies; below 0 the depth, (N,) [m]."""
        rows = _plain(angles)
        if self._compiled is None:
            return np.array([self._coal.nearest(row).distance for row in rows])
        distance = self._compiled.nearest(rows)[:, 0].copy()
        for row in np.flatnonzero(distance <= 0.0):
            # The exact test may see a contact that coal calls a gap of a nanometre.
            distance[row] = min(0.0, self._coal.nearest(rows[row]).distance)
        return distance

    def nearest(self, angles: FloatArray) -> Contact:
        """The nearest two bodies, or those that overlap most, at angles (B-1,)."""
        if self._compiled is not None:
            row = _plain(angles)
            (found,) = self._compiled.nearest(row[None])
            if found[0] > SHORTEST:
                return _separated(found)
        return self._coal.nearest(angles)

    def links(self, contact: Contact) -> tuple[str, str]:
        """Names of the links of a contact's bodies."""
        return self._links_of(contact.shapes)

    def overlap(self, angles: FloatArray) -> tuple[tuple[str, str], float]:
        """Which two links overlap most at angles (B-1,), and how deep [m].

        Without coal it is the first two links that are found to overlap, and the depth
        is NaN.
        """
        try:
            contact = self.nearest(angles)
        except MissingDependencyError:
            if self._compiled is None:
                raise
            distance, *shapes = self._compiled.nearest(_plain(angles)[None])[0, :3]
            depth = math.nan if distance <= 0.0 else 0.0
            return self._links_of([int(shape) for shape in shapes]), depth
        return self.links(contact), max(0.0, -contact.distance)

    def _links_of(self, shapes: Sequence[int]) -> tuple[str, str]:
        one, other = (self.bodies.shapes[shape][0] for shape in shapes)
        return self.bodies.names[one], self.bodies.names[other]

    def gradient(self, angles: FloatArray) -> FloatArray:
        """Derivative of the least distance by the angles (B-1,), (B-1,) [m/rad].

        Where two pairs are equally near, that of one of them. [Gilbert1985] Distance
        functions and their application to robot path planning.
        """
        contact = self.nearest(angles)
        poses = body_poses(self.bodies, angles)
        one, other = (self.bodies.shapes[shape][0] for shape in contact.shapes)
        gradient = np.zeros(len(angles))
        for first, side, point in ((one, -1.0, 0), (other, 1.0, 1)):
            number = first
            while number > 0:
                axis = poses[number][:3, 2]
                lever = contact.points[point] - poses[number][:3, 3]
                gradient[number - 1] += side * contact.normal @ np.cross(axis, lever)
                number = self.bodies.bodies[number].parent
        return gradient

    def free_shares(
        self, start: FloatArray, end: FloatArray, margin: float = 0.0
    ) -> FloatArray:
        """How much of straight lines of angles is proved free of self-collision.

        From a place with a distance d beyond the margin, the line is free as long as
        ``sum_j rate_j |angle_j|`` is below d (`alpha5_model.collision.turning_radii`);
        there d is measured again. A line that comes within `SHORTEST` of the margin
        ends there.

        Args:
            start, end: (N, B-1).
            margin: [m], at least 0.

        Returns:
            From 0 to 1, which is all of a line, (N,).
        """
        if self._compiled is not None:
            first = _plain(start)
            last = _plain(end)
            return self._compiled.free_shares(self.rates, first, last, margin)
        return np.array(
            [
                self._free_share(one, other, margin)
                for one, other in zip(start, end, strict=True)
            ]
        )

    def _free_share(self, start: FloatArray, end: FloatArray, margin: float) -> float:
        rate = float((self.rates @ np.abs(end - start)).max())
        share = 0.0
        while True:
            angles = start + share * (end - start)
            room = self._coal.nearest(angles).distance - margin
            if not room > SHORTEST:
                return share
            if rate * (1.0 - share) < room:
                return 1.0
            share += room / rate


def _plain(rows: FloatArray) -> FloatArray:
    """Rows as the kernels take them."""
    return np.require(rows, np.float64, ["C", "A"])


def _separated(found: FloatArray) -> Contact:
    """A contact of a row of the compiled kernels, whose distance is above 0."""
    points = found[3:].reshape(2, 3)
    between = points[1] - points[0]
    return Contact(
        distance=float(found[0]),
        shapes=(int(found[1]), int(found[2])),
        points=points,
        normal=between / np.linalg.norm(between),
    )
