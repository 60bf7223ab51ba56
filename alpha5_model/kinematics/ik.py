"""Inverse kinematics of the tcp position in closed form: every solution, one target or a million.

The plane of the arm (`alpha5_model.kinematics.plane`) can face the target or face away from it,
and in the plane two links reach a point with the elbow on either side: four branches. The document
prints the first two (Sections 1.3 and 1.4; `published_inverse_kinematics`), whose arccos are
written here with half angles, which lose no digits at the edge of reach:

    rho^2 = (+-R - a_0)^2 + (z - d_0)^2
    t = tan(gamma / 2) = sqrt((rho^2 - (l_1 - l_2)^2) / ((l_1 + l_2)^2 - rho^2))
    phi = atan2(z - d_0, +-R - a_0) -+ alpha
    alpha = pi/2 - atan(t) + atan(k / t),     k = (l_2 - l_1) / (l_2 + l_1)     (law of tangents)

The kernels, made from `alpha5_model.codegen.inverse_kinematics`, compute the same with fewer
arctangents, at every edge, too: of the yaw axis, of reach, of a joint's range.

References:
    [ReachAlpha] Manufacturer's document, Sections 1.3 and 1.4.
    [Siciliano2009] Siciliano, Sciavicco, Villani, Oriolo: Robotics, section 2.12.2.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import BoolArray, FloatArray, float_array
from alpha5_model.codegen.kernels.choice import module
from alpha5_model.errors import InputError, JointLimitError, UnreachableError
from alpha5_model.kinematics.plane import (
    LIMIT_TOLERANCE,
    arm_plane,
    on_axis,
    solve_batch,
)
from alpha5_model.numbers.parameters import parameters

#: The plane faces the target (underarm) or faces away (overarm); flipped is the other elbow.
BRANCHES = ("underarm", "overarm", "underarm_flipped", "overarm_flipped")


class Solutions(NamedTuple):
    """All solutions of a set of targets. Arrays are read-only.

    Attributes:
        q: Joint positions, (..., 4, 4): branch axis (`BRANCHES`), joint axis [rad]; NaN where the
            branch does not reach the target. Each angle is the 2 pi shift that lies in its joint's
            range, where there is one, else the one nearest to the range's middle.
        exists: The branch reaches the target, limits aside, (..., 4).
        within_limits: It exists and respects all four joint limits, (..., 4).
        singular: The target lies on the yaw axis, or at the edge of a branch that reaches it: arm
            stretched or folded, where the two elbows coincide, (...).
        position: The targets, (..., 3) [m].
    """

    q: FloatArray
    exists: BoolArray
    within_limits: BoolArray
    singular: BoolArray
    position: FloatArray

    def best(self, q_reference: ArrayLike) -> FloatArray:
        """The solution within the limits that is nearest to a joint position.

        Nearest is the Euclidean norm of the four joint differences [rad]. On the yaw axis, where
        theta_0 is free, it is the reference's, moved into its range.

        Args:
            q_reference: (4,) or (..., 4) [rad].

        Returns:
            (..., 4) [rad].

        Raises:
            UnreachableError: A target that no branch reaches within the limits, with the distance
                to the nearest point that is reached and that point.
            JointLimitError: The wrist angle asked for is beyond the limits of axis_b.
        """
        require_solution(self.q, self.within_limits, self.position)
        return nearest(self.q, q_reference, self.within_limits, on_axis(self.position))


def inverse_kinematics(position: ArrayLike, wrist: ArrayLike = 0.0) -> Solutions:
    """Every joint position that puts the tcp at a point.

    On the yaw axis (within 1e-9 m of it) theta_0 is free: the middle of its range is returned, the
    tcp is put on the axis itself and ``singular`` is set. A batch of N targets needs memory
    for its output, 137 bytes per target, and a scratch that does not grow with N.

    Args:
        position: tcp in ``base_link``, (..., 3) [m].
        wrist: theta_3, which moves no point; it broadcasts against ``position``'s leading axes
            [rad].

    Returns:
        Four branches per target, whether each exists and respects the limits.

    Raises:
        InputError: Not real numbers, or shapes that do not fit; `NonFiniteError` names a bad row.
    """
    solved: Solutions | None = module().inverse_kinematics(Solutions, position, wrist)
    if solved is not None:
        return solved
    # What the kernel of one target does not take: other types and shapes, errors.
    target = float_array("position", position, (3,))
    angle = float_array("wrist", wrist, ())
    try:
        lead = np.broadcast_shapes(target.shape[:-1], angle.shape)
    except ValueError:
        expected = f"a shape that broadcasts with {target.shape[:-1]}"
        raise InputError("wrist", angle.shape, expected) from None
    target = np.broadcast_to(target, (*lead, 3)) if lead else target.copy()
    solutions = Solutions(*solve_batch(target, angle), target)
    for array in solutions:
        array.flags.writeable = False
    return solutions


def nearest(
    q: FloatArray, q_reference: ArrayLike, valid: BoolArray, free: BoolArray
) -> FloatArray:
    """The valid solution of q (..., 4, 4) nearest to a reference, its theta_0 where free, (..., 4)."""
    reference, shape = float_array("q_reference", q_reference, (4,)), (*q.shape[:-2], 4)
    try:
        reference = np.broadcast_to(reference, shape)
    except ValueError:
        raise InputError(
            "q_reference", reference.shape, f"shape (4,) or {shape}"
        ) from None
    if free.any():
        g, q = arm_plane(), q.copy()
        kept = np.clip(reference[..., 0], g.lower[0], g.upper[0])
        q[..., 0] = np.where(
            free[..., None] & ~np.isnan(q[..., 0]), kept[..., None], q[..., 0]
        )
    with np.errstate(over="ignore"):
        travel = np.square(q - reference[..., None, :]).sum(axis=-1)
    travel = np.minimum(travel, np.finfo(np.float64).max)  # however far the reference
    index = np.where(valid, travel, np.inf).argmin(axis=-1)
    return np.ascontiguousarray(
        np.take_along_axis(q, index[..., None, None], axis=-2)[..., 0, :]
    )


def require_solution(
    q: FloatArray, within_limits: BoolArray, position: FloatArray
) -> None:
    """Raise for the first target that has no solution within the limits.

    Raises:
        JointLimitError: It is within reach, and only its wrist angle is beyond the limits.
        UnreachableError: It is out of reach.
    """
    solved = within_limits.any(axis=-1)
    if solved.all():
        return
    # Late: few targets are refused, and `reach` itself solves in batches.
    from alpha5_model.kinematics.reach import nearest_reachable, reachable

    index = tuple(int(i) for i in np.argwhere(~solved)[0])
    target = position[index]
    if bool(reachable(target)):
        joint = parameters().joints[3]
        angle = float(np.nanmin(q[index][:, 3]))  # the same of every branch
        if not joint.lower - LIMIT_TOLERANCE <= angle <= joint.upper + LIMIT_TOLERANCE:
            bound = joint.lower if angle < joint.lower else joint.upper
            raise JointLimitError(joint.name, angle, bound)
    closest = nearest_reachable(target)
    place = f" (row {', '.join(map(str, index))})" if index else ""
    off = math.hypot(*(target - closest))
    raise UnreachableError(target, off, closest, f" within the joint limits{place}")


def published_inverse_kinematics(position: ArrayLike) -> FloatArray:
    """The two poses that the document solves, by its formulas to the letter.

    No angle is wrapped, no limit checked, and the wrist is not mentioned there;
    `inverse_kinematics` gives all four solutions with flags.

    Args:
        position: tcp in ``base_link``, (..., 3) [m].

    Returns:
        theta_0, theta_1, theta_2 of the underarm pose (Section 1.3) and the overarm pose (Section
        1.4), (..., 2, 3) [rad]; NaN where the formulas have no value.

    Raises:
        InputError: Not real numbers of that shape; `NonFiniteError` names a bad row.
    """
    target = float_array("position", position, (3,))
    dh = parameters().dh
    a_0, a_1, a_2, d_0, d_3 = dh[0].a, dh[1].a, dh[2].a, dh[0].d, dh[3].d
    x, y, z = np.moveaxis(target, -1, 0)
    l_1, l_2 = a_1, np.sqrt(a_2**2 + d_3**2)
    out = np.empty((*target.shape[:-1], 2, 3))
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        R = np.sqrt(x**2 + y**2)
        underarm, overarm = np.arctan2(z - d_0, R - a_0), np.arctan2(z - d_0, R + a_0)
        out[..., 0, 0] = np.arctan2(y, x) + np.pi
        out[..., 0, 1] = np.pi / 2 + underarm
        out[..., 1, 0] = np.arctan2(y, x)
        out[..., 1, 1] = 3 * np.pi / 2 - overarm
        # The rest is printed alike for both.
        l_3 = np.sqrt(
            np.stack([R - a_0, R + a_0], axis=-1) ** 2 + (z - d_0)[..., None] ** 2
        )
        out[..., 1] -= np.arccos((l_1**2 + l_3**2 - l_2**2) / (2 * l_1 * l_3))
        out[..., 1] -= np.arcsin(2 * a_2 / l_1)
        out[..., 2] = np.arccos((l_1**2 + l_2**2 - l_3**2) / (2 * l_1 * l_2))
        out[..., 2] -= np.arcsin(2 * a_2 / l_1)
        out[..., 2] -= np.arcsin(a_2 / l_2)
    return np.where(np.isnan(out).any(axis=-1, keepdims=True), np.nan, out)
