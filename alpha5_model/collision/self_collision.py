"""Self-collision of an arm: whether it touches itself, how near it is, along a line.

The bodies are primitives that enclose the drawn ones within 3 mm
(`alpha5_model.geometry.collision_shapes`). Links that turn against each other at a
joint are not compared, and neither are those that cannot meet
(`alpha5_model.collision.link_pairs`).

The compiled kernels test the shapes and measure distances; without a compiler coal
does. How deep bodies overlap is always coal's answer; without coal it stays unknown.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cached_property, lru_cache, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import BoolArray, FloatArray, count, float_array
from alpha5_model.collision.bodies import (
    Body,
    CollisionBodies,
    body_numbers,
    body_poses,
    collision_bodies,
    shape_numbers,
)
from alpha5_model.collision.coal_scene import CoalScene, Contact
from alpha5_model.collision.turning_radii import distance_rates
from alpha5_model.errors import KernelError, MissingDependencyError, needing
from alpha5_model.kernels.choice import module
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.jaws import Gripper
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm

#: A line that comes nearer to a contact than this is not proved free [m].
SHORTEST = 1e-6
#: Wrist angles that are tried, evenly over the range of axis_b: one every 15 degrees.
WRISTS = 25


@lru_cache(maxsize=16)
def self_collision(arm: Alpha5Parameters, gripper: Gripper = "locked") -> SelfCollision:
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
    def _shapes(self) -> FloatArray:
        """`shape_numbers` of the bodies."""
        return shape_numbers(self.bodies)

    @cached_property
    def _compiled(self) -> _CompiledScene | None:
        """The compiled scene; None without the compiled kernels."""
        if not hasattr(module(), "scene"):
            return None
        return _CompiledScene(self.bodies, self._shapes)

    def carried(self, placement: FloatArray) -> SelfCollision:
        """The same, with all that the first body carries moved.

        Args:
            placement: Of the moved frame in the first body, (4, 4).
        """
        bodies = [
            Body(body.name, 0, placement @ body.placement, body.shapes)
            if body.parent == 0
            else body
            for body in self.bodies.bodies
        ]
        moved = SelfCollision(CollisionBodies(tuple(bodies), self.bodies.pairs))
        moved._shapes = self._shapes
        return moved

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

        if asked is None:
            return self._coal.touches(rows, margin)
        hits = np.zeros(len(rows), np.bool_)
        hits[asked] = self._coal.touches(rows[asked], margin)
        return hits

    def one(self) -> Callable[[Any, float], bool | None]:
        """A quick function of angles (B-1,) and a margin, float.

        It returns None if the angles are not plainly finite float64 of that shape.
        """
        if self._compiled is not None:
            return self._compiled.one
        return lambda angles, margin: None

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


def without_self_collision(
    q: ArrayLike, wrists: int = WRISTS, arm: Alpha5Parameters | None = None
) -> BoolArray:
    """Whether some wrist angle is free of self-collision, with the jaws closed.

    Args:
        q: (..., 4) [rad]; theta_3 is the first wrist angle that is tried.
        wrists: Number of further wrist angles, evenly over the range of axis_b. A free
            window narrower than their distance can be missed.
        arm: Record of an arm of your own; None for the catalogue's. As ``accept`` of
            `alpha5_model.reachable`, use
            ``functools.partial(without_self_collision, arm=arm)``.

    Returns:
        (...) bool.

    Raises:
        InputError: Not finite real numbers of that shape, or no whole number of wrist
            angles; ``arm`` is no record.
    """
    position = float_array("q", q, (4,))
    plausibility.check_largest("q", position, plausibility.ANGLE)
    record = chosen_arm(arm)
    wrist = record.joints[3]
    angles = np.linspace(wrist.lower, wrist.upper, count("wrists", wrists))
    rows = position.reshape(-1, 4).copy()
    scene = self_collision(record)

    hits = scene.touches(rows)
    for angle in angles:
        rows[:, 3] = angle
        hits = scene.touches(rows, asked=hits)
        if not hits.any():
            break
    return ~hits.reshape(position.shape[:-1])


class _CompiledScene:
    """The bodies of an arm as the compiled kernels take them. Threads may share it."""

    def __init__(self, bodies: CollisionBodies, shapes: FloatArray) -> None:
        self._kernels = module()
        self._scene = self._kernels.scene(
            body_numbers(bodies),
            shapes,
            np.array(bodies.pairs, np.float64).reshape(-1, 2),
        )
        self.one = partial(self._kernels.self_collision, self._scene)

    def touches(
        self, angles: FloatArray, margin: float, asked: BoolArray | None
    ) -> BoolArray:
        """Whether the arm comes within a margin of itself, (N,); not where NaN is.

        Rows that are not asked for do not either.
        """
        hits = np.empty(len(angles), np.bool_)
        self._run("self_collision_rows", angles, margin, asked, hits)
        return hits

    def nearest(self, angles: FloatArray) -> FloatArray:
        """Distance, two shapes and their points in link_0, (N, 9)."""
        found = np.empty((len(angles), 9))
        self._run("nearest_bodies_rows", angles, found)
        return found

    def free_shares(
        self, rates: FloatArray, start: FloatArray, end: FloatArray, margin: float
    ) -> FloatArray:
        """How much of the lines between rows is proved free, (N,)."""
        shares = np.empty(len(start))
        self._run("free_shares", rates, start, end, margin, shares)
        return shares

    def _run(self, name: str, *arrays: Any) -> None:
        """Call a function of the kernels, which says whether it wrote its results.

        Raises:
            KernelError: It did not.
        """
        if not getattr(self._kernels, name)(self._scene, *arrays):
            raise KernelError(name, "rows of finite angles")


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
