"""Fit another model's joint axes to ours, as lines, by least squares.

The unknowns are the pose of the other base, the zeros of axis_d and axis_c, and the
dimensions of our arm. The axes do not show the other two zeros: a shifted zero of
axis_e looks like a yaw of the base, and one of axis_b like a roll of the last body.
"""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import rotation_about, transform, wrap
from alpha5_model.proofs.comparison.alignment import Alignment
from alpha5_model.proofs.comparison.axis_lines import (
    AxisLines,
    foot,
    z_axes,
)
from alpha5_model.proofs.comparison.four_joint_arm import FourJointArm
from alpha5_model.proofs.comparison.line_screws import (
    BASE_SCREWS,
    POSE_UNKNOWNS,
    POSITIONS,
    UNKNOWNS,
    dimension_screws,
    line_derivatives,
    zero_screws,
)
from alpha5_model.proofs.comparison.own_arm import DIMENSIONS, OwnArm, random_positions
from alpha5_model.proofs.comparison.poses import origin_of, rotation_of

#: Joint positions at which a first guess is judged: fewer than a fit takes.
GUESS_POSITIONS = 4
#: Most steps of a fit, and how often a step that does not help is cut.
STEPS, CUTS = 50, 20


class Linearized(NamedTuple):
    """How far the axes of an alignment are apart, and the derivative of that.

    Attributes:
        alignment: The alignment.
        error: Their axes minus ours, (24 * POSITIONS,): for each axis and position the
            moment about our root [m] and the direction.
        jacobian: Derivative by the `UNKNOWNS`, (24 * POSITIONS, 16).
        squared_error: Sum of the squares of the error.
    """

    alignment: Alignment
    error: FloatArray
    jacobian: FloatArray
    squared_error: float


@dataclass(frozen=True, eq=False)
class AxisFit:
    """Two arms whose joint axes are to coincide."""

    our_arm: OwnArm
    their_arm: FourJointArm

    def their_axes(self, alignment: Alignment, q: FloatArray) -> AxisLines:
        """Their axes at our positions q (..., 4), in our root, directed as ours."""
        points, directions = self.their_arm.axis_lines(alignment.theirs(q))
        rotation = rotation_of(alignment.base)
        shift = origin_of(alignment.base)
        return AxisLines(
            points=points @ rotation.T + shift,
            directions=directions @ rotation.T * alignment.sign[:, None],
        )

    def closed_form(self, sign: FloatArray, dimensions: FloatArray) -> Alignment:
        """The alignment with these signs and dimensions, exact if they are right.

        Args:
            sign: +1 or -1 per joint, (4,).
            dimensions: Changes of our arm's dimensions, (8,) [m, rad].

        The first two axes cross at a right angle: they place the base. A turn about
        axis_d then brings axis_c to its place behind the shoulder, and a turn about
        axis_c brings the wrist axis into its direction.
        """
        at_zero = np.zeros(4)
        our_axes = z_axes(self.our_arm.frames(at_zero, dimensions))

        start = Alignment(sign=sign, dimensions=dimensions)
        their_axes = self.their_axes(start, at_zero)
        turn = _base_frame(our_axes) @ _base_frame(their_axes).T
        shift = foot(our_axes, 0, 1) - turn @ foot(their_axes, 0, 1)
        with_base = replace(start, base=transform(turn, shift))

        their_axes = self.their_axes(with_base, at_zero)
        zero_of_axis_d = sign[1] * _angle_about(
            our_axes.directions[1],
            start=_upper_arm(their_axes),
            end=_upper_arm(our_axes),
        )
        zero = np.array([0.0, zero_of_axis_d, 0.0, 0.0])
        with_axis_d = replace(with_base, zero=zero)

        their_axes = self.their_axes(with_axis_d, at_zero)
        zero_of_axis_c = sign[2] * _angle_about(
            our_axes.directions[2],
            start=their_axes.directions[3],
            end=our_axes.directions[3],
        )
        zero = np.array([0.0, zero_of_axis_d, zero_of_axis_c, 0.0])
        return replace(with_axis_d, zero=zero)

    def guess_error(self, alignment: Alignment) -> float:
        """Root mean square of the difference of the axes, at `GUESS_POSITIONS`."""
        q = random_positions(self.our_arm.parameters, POSITIONS)[:GUESS_POSITIONS]
        our_axes = z_axes(self.our_arm.frames(q, alignment.dimensions))
        their_axes = self.their_axes(alignment, q)
        moments = their_axes.moments - our_axes.moments
        directions = their_axes.directions - our_axes.directions
        return math.sqrt(np.square([moments, directions]).mean())

    def fit(self, start: Alignment, free: Collection[str]) -> Alignment:
        """The best alignment near a start, by Gauss-Newton.

        Args:
            start: The alignment to start from.
            free: The `UNKNOWNS` that may change.
        """
        columns = [k for k, name in enumerate(UNKNOWNS) if name in free]
        best = self.linearized(start)
        for _ in range(STEPS):
            step = _newton_step(best, columns)
            tried, step = self._cut_until_it_helps(best, step)
            gain = best.squared_error - tried.squared_error
            if gain > 0:
                best = tried
            if gain <= 1e-9 * tried.squared_error or np.abs(step).max() < 1e-9:
                break

        zero = wrap(best.alignment.zero)
        return replace(best.alignment, zero=zero, residual=_residual(best.error))

    def _cut_until_it_helps(
        self, best: Linearized, step: FloatArray
    ) -> tuple[Linearized, FloatArray]:
        """The result of a step, cut until the error does not grow, and that step."""
        for _ in range(CUTS):
            tried = self.linearized(_changed(best.alignment, step))
            if best.squared_error - tried.squared_error >= 0:
                break
            step = step / 4
        return tried, step

    def linearized(self, alignment: Alignment) -> Linearized:
        """The difference of the axes and its derivative.

        A screw with rotation w and translation v changes the moment m of a line by
        ``w x m + v x d`` and its direction d by ``w x d``.
        """
        q = random_positions(self.our_arm.parameters, POSITIONS)
        # From here on the first index is the axis, the second the position.
        frames = np.moveaxis(self.our_arm.frames(q, alignment.dimensions), 1, 0)
        our_axes = z_axes(frames)
        their_axes = _by_axis(self.their_axes(alignment, q))
        our_moments = our_axes.moments
        their_moments = their_axes.moments

        moment_errors = their_moments - our_moments
        direction_errors = their_axes.directions - our_axes.directions
        error = np.concatenate([moment_errors, direction_errors], axis=-1).ravel()

        screws = {
            **BASE_SCREWS,
            **zero_screws(alignment.sign, their_axes.directions, their_moments),
            **dimension_screws(self.our_arm, frames, alignment.dimensions),
        }
        # The first unknowns (base, zeros) move their axes, the dimensions move ours.
        # The error is theirs minus ours, so ours count with the opposite sign.
        counts = [len(POSE_UNKNOWNS), len(DIMENSIONS)]
        moments = [their_moments, -our_moments]
        directions = [their_axes.directions, -our_axes.directions]
        derivatives = line_derivatives(
            list(screws.values()),
            moments=np.repeat(moments, counts, axis=0),
            directions=np.repeat(directions, counts, axis=0),
        )
        return Linearized(
            alignment=alignment,
            error=error,
            jacobian=derivatives.T,
            squared_error=float(error @ error),
        )


def _by_axis(lines: AxisLines) -> AxisLines:
    """The lines of positions and axes (N, 4, 3), by axes first (4, N, 3)."""
    return AxisLines(
        points=np.moveaxis(lines.points, 1, 0),
        directions=np.moveaxis(lines.directions, 1, 0),
    )


def _newton_step(at: Linearized, columns: list[int]) -> FloatArray:
    """The step (16,) that minimizes the error if it is taken as linear."""
    step = np.zeros(len(UNKNOWNS))
    solution = np.linalg.lstsq(at.jacobian[:, columns], at.error, rcond=None)[0]
    step[columns] = -solution
    return step


def _changed(alignment: Alignment, step: FloatArray) -> Alignment:
    """The alignment after a step (16,), in the order of the `UNKNOWNS`."""
    rotation = step[:3]
    shift = step[3:6]
    zeros = step[6:8]
    dimensions = step[8:]

    angle = float(np.linalg.norm(rotation))
    turn = rotation_about(rotation / angle, angle) if angle else None
    base = transform(turn) @ alignment.base
    base[:3, 3] += shift
    return replace(
        alignment,
        base=base,
        zero=alignment.zero + np.array([0.0, zeros[0], zeros[1], 0.0]),
        dimensions=alignment.dimensions + dimensions,
    )


def _residual(error: FloatArray) -> tuple[float, float]:
    """Root mean square of an error: of its entries [m], and of the angles [rad]."""
    directions = error.reshape(-1, 6)[:, 3:]
    squared_angles = np.square(directions).sum(axis=1)
    return math.sqrt(np.square(error).mean()), math.sqrt(squared_angles.mean())


def _base_frame(lines: AxisLines) -> FloatArray:
    """Axes x, y, z as columns: z along axis_e, axis_d in the y-z plane, (3, 3)."""
    z = lines.directions[0]
    normal = np.cross(lines.directions[1], z)
    length = np.linalg.norm(normal)
    # If both axes are parallel, any x across them will do.
    x = normal / length if length > 1e-9 else np.linalg.svd(z[None])[2][1]
    return np.stack([x, np.cross(z, x), z], axis=1)


def _upper_arm(lines: AxisLines) -> FloatArray:
    """From axis_d to axis_c, (3,) [m]."""
    return np.asarray(lines.points[2] - lines.points[1])


def _angle_about(axis: FloatArray, start: FloatArray, end: FloatArray) -> float:
    """Angle about a unit vector that turns one vector (3,) towards another [rad]."""
    sine = np.cross(start, end) @ axis
    cosine = start @ end - (start @ axis) * (end @ axis)
    return math.atan2(sine, cosine)
