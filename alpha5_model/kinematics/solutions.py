"""Arrays of all solutions of targets, which the inverse kinematics return.

They hold no reference to their arm. `alpha5_model.kinematics.ik.Solutions` and
`alpha5_model.kinematics.pose.PoseSolutions` are the same arrays for the catalogue's
arm, with a method that chooses the best solution.
"""

from __future__ import annotations

from typing import NamedTuple

from alpha5_model._support.checks import BoolArray, FloatArray

#: A rotation error below this counts as none [rad]; on the edge of reach, rounding of
#: the position turns the wrist axis by some 1e-8.
EXACT_TOLERANCE = 1e-7
#: Names of the branches: the arm faces the target (underarm) or faces away (overarm);
#: flipped is the other elbow.
BRANCHES = ("underarm", "overarm", "underarm_flipped", "overarm_flipped")


class SolutionArrays(NamedTuple):
    """All solutions of a set of target points.

    Attributes:
        q, exists, within_limits, singular, position: As for
            `alpha5_model.kinematics.ik.Solutions`.
    """

    q: FloatArray
    exists: BoolArray
    within_limits: BoolArray
    singular: BoolArray
    position: FloatArray


class PoseSolutionArrays(NamedTuple):
    """All solutions of a set of target poses.

    Attributes:
        q, exists, within_limits, singular, position, rotation_error, exact: As for
            `alpha5_model.kinematics.pose.PoseSolutions`.
    """

    q: FloatArray
    exists: BoolArray
    within_limits: BoolArray
    singular: BoolArray
    position: FloatArray
    rotation_error: FloatArray
    exact: BoolArray


def pose_answer(
    q: FloatArray,
    exists: BoolArray,
    within_limits: BoolArray,
    singular: BoolArray,
    position: FloatArray,
    error: FloatArray,
) -> PoseSolutionArrays:
    """Solutions of poses, made read-only; error is the rotation error."""
    solutions = PoseSolutionArrays(
        q=q,
        exists=exists,
        within_limits=within_limits,
        singular=singular,
        position=position,
        rotation_error=error,
        exact=error <= EXACT_TOLERANCE,
    )
    for array in solutions:
        array.flags.writeable = False
    return solutions
