"""Inverse kinematics of the tcp position in closed form: every solution, one target or a million.

The plane of the arm (`alpha5_model.kinematics.plane`) can face the target or turn its back to it,
and in the plane two links reach a point with the elbow on either side: four branches. The document
prints the first two (Sections 1.3 and 1.4; `published_inverse_kinematics`), whose arccos are written
here with half angles, which lose no digits at the edge of reach:

    rho^2 = (+-R - a_0)^2 + (z - d_0)^2
    t = tan(gamma / 2) = sqrt((rho^2 - (l_1 - l_2)^2) / ((l_1 + l_2)^2 - rho^2))
    phi = atan2(z - d_0, +-R - a_0) -+ alpha
    alpha = pi/2 - atan(t) + atan(k / t),     k = (l_2 - l_1) / (l_2 + l_1)     (law of tangents)

One target is solved with `math`, in a few microseconds. A batch is solved in blocks that stay in the
processor's cache; rows close to a singularity are handed to the one-target route, which treats the
edges.

References:
    [ReachAlpha] Manufacturer's document, Sections 1.3 and 1.4.
    [Siciliano2009] Siciliano, Sciavicco, Villani, Oriolo: Robotics, section 2.12.2.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import BoolArray, FloatArray, float_array
from alpha5_model.errors import InputError
from alpha5_model.kinematics.ik.batch import solve_batch
from alpha5_model.kinematics.ik.fast import careful_answer, fast_solver

#: The plane faces the target (underarm) or turns its back (overarm); flipped is the other elbow.
BRANCHES = ("underarm", "overarm", "underarm_flipped", "overarm_flipped")

_NEW, _FLOAT = tuple.__new__, np.dtype(np.float64)


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
        # Late: few need the boundary.
        from alpha5_model.kinematics.ik.choice import candidates, pick, require_solution

        require_solution(self.q, self.within_limits, self.position)
        q, reference = candidates(self.q, self.position, q_reference)
        return pick(q, reference, self.within_limits)


def inverse_kinematics(position: ArrayLike, wrist: ArrayLike = 0.0) -> Solutions:
    """Every joint position that puts the tcp at a point.

    On the yaw axis (within 1e-9 m of it) theta_0 is free: the middle of its range is returned, the tcp
    comes to stand on the axis itself and ``singular`` is set. A batch of N targets needs its output, 137 bytes per target, and a fixed scratch.

    Args:
        position: tcp in ``base_link``, (..., 3) [m].
        wrist: theta_3, which moves no point; it broadcasts against ``position``'s leading axes [rad].

    Returns:
        Four branches per target, whether each exists and respects the limits.

    Raises:
        InputError: Not real numbers, or shapes that do not fit; `NonFiniteError` names a bad row.
    """
    # One target in the types that callers use most goes straight to work.
    given: Any = position
    kind = type(given)
    if kind is np.ndarray and given.shape == (3,) and given.dtype is _FLOAT:
        x, y, z = given.tolist()
    elif (kind is list or kind is tuple) and len(given) == 3:
        x, y, z = given
        if not type(x) is type(y) is type(z) is float:
            return _general(position, wrist)
    else:
        return _general(position, wrist)
    if type(wrist) is float and (x + y + z + wrist) * 0.0 == 0.0:  # all finite
        return _one(x, y, z, wrist)
    return _general(position, wrist)


def _general(position: ArrayLike, wrist: ArrayLike) -> Solutions:
    """Checked input of any shape."""
    target = float_array("position", position, (3,))
    angle = float_array("wrist", wrist, ())
    if target.ndim == 1 and angle.ndim == 0:
        x, y, z = target.tolist()
        return _one(x, y, z, float(angle))
    try:
        lead = np.broadcast_shapes(target.shape[:-1], angle.shape)
    except ValueError:
        raise InputError(
            "wrist", angle.shape, f"a shape that broadcasts with {target.shape[:-1]}"
        ) from None
    target = np.broadcast_to(target, (*lead, 3))
    q, exists, within, singular = solve_batch(target, angle)
    for array in (q, exists, within, singular, target):
        if array is not position:  # never lock the caller's own array
            array.flags.writeable = False
    return Solutions(q, exists, within, singular, target)


def _one(x: float, y: float, z: float, wrist: float) -> Solutions:
    """One finite target."""
    answer = fast_solver()(x, y, z, wrist)
    if answer is None:
        answer = careful_answer(x, y, z, wrist)
    # Built as the tuple it is: the keyword constructor would cost as much as the trigonometry.
    return _NEW(Solutions, answer)
