"""Fit another model's joint axes to ours, as lines, by least squares.

Free are the pose of the other base, the zeros of axis_d and axis_c, and the dimensions
of our arm. A shifted zero of axis_e is a yaw of the base, and one of axis_b a roll of
the last body: the axes do not show them.
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
    columns_of,
    dimension_screws,
    zero_screws,
)
from alpha5_model.proofs.comparison.own_arm import DIMENSIONS, OwnArm, random_positions
from alpha5_model.proofs.comparison.poses import origin_of, rotation_of

#: Fewer positions tell how well a first guess fits.
GUESS_POSITIONS = 4
#: Steps of a fit, and how often a step that does not help is cut.
STEPS, CUTS = 50, 20


class Linearized(NamedTuple):
    """Difference of the lines of an alignment, and its derivative.

    Attributes:
        alignment: Where they are taken.
        error: Their axes minus ours, (24 * POSITIONS,): for each axis and position the
            moment about our root [m] and the direction.
        jacobian: Derivative by the `UNKNOWNS`, (24 * POSITIONS, 16).
        square: Sum of the squares of the error.
    """

    alignment: Alignment
    error: FloatArray
    jacobian: FloatArray
    square: float


@dataclass(frozen=True, eq=False)
class AxisFit:
    """Our axes and theirs, to be brought together.

    Attributes:
        ours: Our arm.
        theirs: The other arm.
    """

    ours: OwnArm
    theirs: FourJointArm

    def their_lines(self, alignment: Alignment, q: FloatArray) -> AxisLines:
        """Their axes at our positions q (..., 4), in our root frame and sense."""
        points, directions = self.theirs.axis_lines(alignment.theirs(q))
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
            dimensions: Changes of ours, (8,) [m, rad].

        The first two axes, which cross at a right angle, place the base. A turn about
        axis_d brings axis_c to its side of the shoulder, and one about axis_c brings
        the wrist into its direction.
        """
        zero = np.zeros(4)
        ours = z_axes(self.ours.frames(zero, dimensions))

        start = Alignment(sign=sign, dimensions=dimensions)
        theirs = self.their_lines(start, zero)
        turn = _base_frame(ours) @ _base_frame(theirs).T
        shift = foot(ours, 0, 1) - turn @ foot(theirs, 0, 1)
        with_base = replace(start, base=transform(turn, shift))

        theirs = self.their_lines(with_base, zero)
        shoulder = sign[1] * _angle_about(
            ours.directions[1],
            start=_upper_arm(theirs),
            end=_upper_arm(ours),
        )
        with_shoulder = replace(with_base, zero=np.array([0.0, shoulder, 0.0, 0.0]))

        theirs = self.their_lines(with_shoulder, zero)
        elbow = sign[2] * _angle_about(
            ours.directions[2],
            start=theirs.directions[3],
            end=ours.directions[3],
        )
        return replace(with_shoulder, zero=np.array([0.0, shoulder, elbow, 0.0]))

    def line_error(self, alignment: Alignment) -> float:
        """Root mean square of the difference of the lines, from fewer positions."""
        q = random_positions(self.ours.parameters, POSITIONS)[:GUESS_POSITIONS]
        ours = z_axes(self.ours.frames(q, alignment.dimensions))
        theirs = self.their_lines(alignment, q)
        moments = theirs.moments - ours.moments
        directions = theirs.directions - ours.directions
        return math.sqrt(np.square([moments, directions]).mean())

    def fit(self, start: Alignment, free: Collection[str]) -> Alignment:
        """The best alignment near a first one, by Gauss-Newton.

        Args:
            start: The first one.
            free: Those of `UNKNOWNS` that may change.
        """
        columns = [k for k, name in enumerate(UNKNOWNS) if name in free]
        best = self.linearized(start)
        for _ in range(STEPS):
            step = _newton_step(best, columns)
            tried, step = self._cut_until_it_helps(best, step)
            gain = best.square - tried.square
            if gain > 0:
                best = tried
            if gain <= 1e-9 * tried.square or np.abs(step).max() < 1e-9:
                break

        zero = wrap(best.alignment.zero)
        return replace(best.alignment, zero=zero, residual=_residual(best.error))

    def _cut_until_it_helps(
        self, best: Linearized, step: FloatArray
    ) -> tuple[Linearized, FloatArray]:
        """Take a step, cut until it makes the error no larger; and the step (16,)."""
        for _ in range(CUTS):
            tried = self.linearized(_changed(best.alignment, step))
            if best.square - tried.square >= 0:
                break
            step = step / 4
        return tried, step

    def linearized(self, alignment: Alignment) -> Linearized:
        """The difference of the lines and its derivative.

        A screw (w, v) moves a line with moment m and direction d by ``w x m + v x d``
        and ``w x d``.
        """
        q = random_positions(self.ours.parameters, POSITIONS)
        frames = np.moveaxis(self.ours.frames(q, alignment.dimensions), 1, 0)
        ours = z_axes(frames)  # axis, position
        theirs = _by_axis(self.their_lines(alignment, q))
        our_moments = ours.moments
        their_moments = theirs.moments

        moment_errors = their_moments - our_moments
        direction_errors = theirs.directions - ours.directions
        error = np.concatenate([moment_errors, direction_errors], axis=-1).ravel()

        screws = {
            **BASE_SCREWS,
            **zero_screws(alignment.sign, theirs.directions, their_moments),
            **dimension_screws(self.ours, frames, alignment.dimensions),
        }
        # The base and the zeros move their lines, the dimensions move ours.
        counts = [len(POSE_UNKNOWNS), len(DIMENSIONS)]
        columns = columns_of(
            list(screws.values()),
            moments=np.repeat([their_moments, -our_moments], counts, axis=0),
            directions=np.repeat([theirs.directions, -ours.directions], counts, axis=0),
        )
        return Linearized(
            alignment=alignment,
            error=error,
            jacobian=columns.T,
            square=float(error @ error),
        )


def _by_axis(lines: AxisLines) -> AxisLines:
    """Lines (position, axis, 3), by axis first."""
    return AxisLines(
        points=np.moveaxis(lines.points, 1, 0),
        directions=np.moveaxis(lines.directions, 1, 0),
    )


def _newton_step(at: Linearized, columns: list[int]) -> FloatArray:
    """The step (16,) that would make the error least if it were linear."""
    step = np.zeros(len(UNKNOWNS))
    solution = np.linalg.lstsq(at.jacobian[:, columns], at.error, rcond=None)[0]
    step[columns] = -solution
    return step


def _changed(alignment: Alignment, step: FloatArray) -> Alignment:
    """The alignment, changed by a step (16,) in order of the `UNKNOWNS`."""
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
    """Root mean square of an error: of all coordinates [m], and of the angles [rad]."""
    directions = error.reshape(-1, 6)[:, 3:]
    squared_angles = np.square(directions).sum(axis=1)
    return math.sqrt(np.square(error).mean()), math.sqrt(squared_angles.mean())


def _base_frame(lines: AxisLines) -> FloatArray:
    """Rotation with z along the first axis and the second in the y-z plane, (3, 3)."""
    z = lines.directions[0]
    normal = np.cross(lines.directions[1], z)
    length = np.linalg.norm(normal)
    # If both have one direction, any x across it will do.
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
