"""The points of a path with their solutions, and ways from one point to another."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import BoolArray, FloatArray, instance
from alpha5_model.collision.self_collision import SelfCollision
from alpha5_model.errors import DiscontinuousPathError, SelfCollisionError
from alpha5_model.kinematics.arm_shape import ArmShape
from alpha5_model.kinematics.choosing import require_solution
from alpha5_model.kinematics.colliding import collision_error
from alpha5_model.kinematics.solutions import SolutionArrays
from alpha5_model.numbers.parameters import JointParameters


class Front(NamedTuple):
    """The joint positions that the arm may have after some points.

    Attributes:
        q: Joint positions, (M, 4) [rad]; NaN if the path may start anywhere.
        travel: Least joint travel to each, (M,) [rad].
    """

    q: FloatArray
    travel: FloatArray


class Ways(NamedTuple):
    """Ways of least travel from a front through the next L points.

    Attributes:
        first: Number of the first of these points.
        q: Joint positions at the points, (M, L, 4) [rad].
        travel: Joint travel since the start of the path, (M,) [rad].
        origin: Index in the front of the position where each way begins, (M,).
    """

    first: int
    q: FloatArray
    travel: FloatArray
    origin: NDArray[np.intp]

    @property
    def front(self) -> Front:
        """The ends of the ways."""
        return Front(q=self.q[:, -1], travel=self.travel)

    @property
    def stop(self) -> int:
        """Number of the first point after them."""
        return self.first + int(self.q.shape[1])


class PathPoints(NamedTuple):
    """The points of a path.

    Attributes:
        solutions: All solutions of all N points.
        hits: Which of them touch the arm itself, (N, 4).
        max_step: No joint moves farther than this from one point to the next [rad].
        shape: Lengths, zeros and limits of the arm.
        wrist: The arm's joint 3.
        scene: Where the arm touches itself; None if it may.
    """

    solutions: SolutionArrays
    hits: BoolArray
    max_step: float
    shape: ArmShape
    wrist: JointParameters
    scene: SelfCollision | None

    @property
    def number(self) -> int:
        """Number of points, N."""
        return len(self.solutions.position)

    def options(self, k: int) -> FloatArray:
        """Free solutions of point k within the limits, (M, 4).

        Raises:
            UnreachableError, JointLimitError: There is none.
            SelfCollisionError: All of them touch the arm itself.
        """
        within_limits = self.options_at_any_yaw(k)
        options: FloatArray = self.solutions.q[k][
            self.solutions.within_limits[k] & ~self.hits[k]
        ]
        if not len(options) and self.scene is not None:
            raise collision_error(
                self.solutions.position[k],
                within_limits[0],
                self.shape,
                self.scene,
                f" (row {k})",
            )
        return options

    def options_at_any_yaw(self, k: int) -> FloatArray:
        """Solutions of point k within the limits, (M, 4).

        On the yaw axis they may collide at the theta_0 that they have, and not at
        another.

        Raises:
            UnreachableError, JointLimitError: There is none.
        """
        options: FloatArray = self.solutions.q[k][self.solutions.within_limits[k]]
        if not len(options):
            so_far = SolutionArrays._make(array[: k + 1] for array in self.solutions)
            require_solution(so_far, self.shape, self.wrist)
        return options

    def are_free(self, start: FloatArray, end: FloatArray) -> BoolArray:
        """Whether straight lines of joint positions (M, 4) are proved free, (M,).

        A line from nowhere, NaN, is.
        """
        free = np.ones(len(start), np.bool_)
        if self.scene is not None:
            known = ~np.isnan(start).any(axis=1)
            free[known] = self.scene.free_shares(start[known], end[known]) == 1.0
        return free

    def collision(
        self, k: int, start: FloatArray, end: FloatArray
    ) -> SelfCollisionError:
        """The error to raise if the step from start to end (4,), at point k, collides.

        Raises:
            InputError: The scene is None, so that nothing collides.
        """
        scene = instance("scene", self.scene, SelfCollision)
        share = scene.free_shares(start[None], end[None])[0]
        links, depth = scene.overlap(start + share * (end - start))
        return SelfCollisionError(
            self.solutions.position[k],
            links=links,
            depth=depth,
            place=f" from the position before (row {k})",
        )

    def jump(self, k: int, needed: float) -> DiscontinuousPathError:
        """The error to raise if no continuous motion reaches point k."""
        position = self.solutions.position[k]
        return DiscontinuousPathError(k, position, needed, self.max_step)


def step_sizes(step: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Euclidean norm and largest joint of steps (..., J), (...) each.

    Both are 0 if a position is NaN, which means that it is free.
    """
    with np.errstate(over="ignore"):
        norm = np.sqrt(np.square(step).sum(axis=-1))
    largest = np.abs(step).max(axis=-1)
    return np.nan_to_num(norm, posinf=np.inf), np.nan_to_num(largest)
