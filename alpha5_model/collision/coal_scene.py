"""Distances of an arm's bodies by coal: signed, and without a compiler.

coal is asked about the pairs of shapes that balls around them leave. Each question is
a fresh request: one that starts from the answer of the last has missed overlaps.

Whether the arm touches itself is first asked of Pinocchio's broad phase with a margin,
which is quick. Alone it has missed overlaps of 0.3 mm, with a margin of 0.1 mm none of
thousands near contact. What it finds is measured.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from threading import local
from typing import Any

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model._support.spatial import pose
from alpha5_model.collision.bodies import CollisionBodies, body_poses, shape_numbers
from alpha5_model.geometry.primitives import Primitive

#: Margin of the broad phase beyond the one that is asked for [m].
_ADDED = 1e-4


@dataclass(frozen=True, eq=False)
class Contact:
    """The nearest two shapes, or those that overlap most.

    Attributes:
        distance: [m]; below 0 it is the depth of penetration.
        shapes: Their numbers.
        points: The nearest point of each in link_0, (2, 3) [m].
        normal: Unit vector from the first to the second in link_0, (3,).
    """

    distance: float
    shapes: tuple[int, int]
    points: FloatArray
    normal: FloatArray


def coal_shape(shape: Primitive) -> Any:
    """A box or a cylinder as coal has it, about its own centre."""
    import coal

    kind = coal.Cylinder if shape.kind == "cylinder" else coal.Box
    return kind(*shape.size)


class CoalScene:
    """The bodies of an arm as coal takes them."""

    def __init__(self, bodies: CollisionBodies) -> None:
        self._bodies = bodies
        numbers = shape_numbers(bodies)
        self._owner = numbers[:, 0].astype(np.intp)
        self._placements = np.zeros((len(numbers), 4, 4))
        self._placements[:, :3] = numbers[:, 5:].reshape(-1, 3, 4)
        self._placements[:, 3, 3] = 1.0
        is_round = numbers[:, 1] != 0.0
        half = numbers[:, 2:5]
        across = np.where(is_round, half[:, 0], np.hypot(half[:, 0], half[:, 1]))
        self._radius = np.hypot(across, half[:, 2])
        self._pairs = _shape_pairs(bodies, self._owner)
        self._of_thread = local()

    @cached_property
    def _shapes(self) -> list[Any]:
        """coal's own, made on first use."""
        return [coal_shape(shape) for _, shape in self._bodies.shapes]

    def nearest(self, angles: FloatArray) -> Contact:
        """The least signed distance at angles of all bodies but the first, (B-1,)."""
        poses = self._poses(angles)
        bounds = self._least_distances(poses)
        order = np.argsort(bounds, kind="stable")
        nearest = self._contact(poses, self._pairs[order[0]])
        for number in order[1:]:
            if bounds[number] > nearest.distance:
                break
            contact = self._contact(poses, self._pairs[number])
            if contact.distance < nearest.distance:
                nearest = contact
        return nearest

    def touches(self, angles: FloatArray, margin: float) -> BoolArray:
        """Whether the arm comes within a margin of itself, (N,); not where NaN is."""
        may_touch = self._broad_phase(margin)
        hits = [
            bool(np.isfinite(row).all())
            and may_touch(row)
            and self._touches(row, margin)
            for row in angles
        ]
        return np.array(hits, np.bool_)

    def _broad_phase(self, margin: float) -> Callable[[FloatArray], bool]:
        """`_broad_phase` of this thread."""
        known, may_touch = getattr(self._of_thread, "broad_phase", (None, None))
        if known != margin or may_touch is None:
            may_touch = _broad_phase(self._bodies, self._pairs, margin + _ADDED)
            self._of_thread.broad_phase = (margin, may_touch)
        return may_touch

    def _touches(self, angles: FloatArray, margin: float) -> bool:
        poses = self._poses(angles)
        bounds = self._least_distances(poses)
        order = np.argsort(bounds, kind="stable")
        near = order[bounds[order] <= margin]
        return any(
            self._contact(poses, pair).distance <= margin for pair in self._pairs[near]
        )

    def _poses(self, angles: FloatArray) -> FloatArray:
        """Poses of all shapes in link_0, (S, 4, 4)."""
        of_bodies = np.array(body_poses(self._bodies, angles))
        return np.asarray(of_bodies[self._owner] @ self._placements)

    def _least_distances(self, poses: FloatArray) -> FloatArray:
        """Distances of the balls around the shapes of each pair, (P,) [m].

        Below 0 as well, no pair's signed distance is less.
        """
        centres = poses[:, :3, 3]
        one, other = self._pairs.T
        apart = np.linalg.norm(centres[one] - centres[other], axis=1)
        return np.asarray(apart - self._radius[one] - self._radius[other])

    def _contact(self, poses: FloatArray, pair: NDArray[np.intp]) -> Contact:
        import coal

        one, other = (int(number) for number in pair)
        result = coal.DistanceResult()
        coal.distance(
            self._shapes[one],
            _coal_pose(poses[one]),
            self._shapes[other],
            _coal_pose(poses[other]),
            coal.DistanceRequest(),
            result,
        )
        points = [result.getNearestPoint1(), result.getNearestPoint2()]
        return Contact(
            distance=float(result.min_distance),
            shapes=(one, other),
            points=np.array(points),
            normal=np.array(result.normal),
        )


def _broad_phase(
    bodies: CollisionBodies, pairs: NDArray[np.intp], margin: float
) -> Callable[[FloatArray], bool]:
    """A function of angles: whether some of these pairs may come within a margin.

    Pinocchio computes in memory that threads may not share.
    """
    import pinocchio as pin

    model = pin.Model()
    for body in bodies.bodies[1:]:
        placement = pin.SE3(body.placement)
        model.addJoint(body.parent, pin.JointModelRZ(), placement, body.name)
    geometry = pin.GeometryModel()
    for number, (owner, shape) in enumerate(bodies.shapes):
        placement = pin.SE3(pose(shape.xyz, shape.rpy))
        geometry.addGeometryObject(
            pin.GeometryObject(str(number), owner, placement, coal_shape(shape))
        )
    for one, other in pairs.tolist():
        geometry.addCollisionPair(pin.CollisionPair(one, other))

    memory = geometry.createData()
    for request in memory.collisionRequests:
        request.security_margin = margin
    manager = pin.BroadPhaseManager_DynamicAABBTreeCollisionManager(
        model, geometry, memory
    )
    data = model.createData()

    def may_touch(angles: FloatArray) -> bool:
        callback = pin.CollisionCallBackDefault(geometry, memory, True)
        pin.updateGeometryPlacements(model, data, geometry, memory, angles)
        manager.update(False)
        return bool(pin.computeCollisions(manager, callback))

    return may_touch


def _shape_pairs(bodies: CollisionBodies, owner: NDArray[np.intp]) -> NDArray[np.intp]:
    """Numbers of all pairs of shapes that are compared, (P, 2)."""
    pairs = []
    for one, other in bodies.pairs:
        shapes = np.meshgrid(
            np.flatnonzero(owner == one), np.flatnonzero(owner == other)
        )
        pairs.append(np.stack(shapes, axis=-1).reshape(-1, 2))
    return np.concatenate(pairs)


def _coal_pose(pose: FloatArray) -> Any:
    import coal

    return coal.Transform3s(pose[:3, :3], pose[:3, 3])
