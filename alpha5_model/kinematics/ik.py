"""Inverse kinematics of the tcp position in closed form, with all solutions.

The plane of the arm (`alpha5_model.kinematics.geometry`) can face the target or face
away from it, and in the plane two links reach a point with the elbow on either side:
four branches. The document prints the first two (Sections 1.3 and 1.4;
`alpha5_model.published_inverse_kinematics`).

The formulas, for any lengths and any tool point, and at every edge of reach, of the yaw
axis and of a joint's range, are in `alpha5_model.codegen.inverse_kinematics`. The
kernel that is called here is generated from them.

References:
    [ReachAlpha] Manufacturer's document, Sections 1.3 and 1.4.
    [Siciliano2009] Siciliano, Sciavicco, Villani, Oriolo: Robotics, section 2.12.2.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import BoolArray, FloatArray, float_array
from alpha5_model._support.text import short_repr
from alpha5_model.errors import InputError
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.kinematics.solver import Branches, solve, solve_rows
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm

#: Names of the branches: the arm faces the target (underarm) or faces away (overarm);
#: flipped is the other elbow.
BRANCHES = ("underarm", "overarm", "underarm_flipped", "overarm_flipped")

Kind = TypeVar("Kind", bound=tuple[Any, ...])


class Solutions(Branches):
    """All solutions of a set of targets. Arrays are read-only.

    Attributes:
        q: Joint positions, (..., 4, 4): branch axis (`BRANCHES`), joint axis [rad]; NaN
            if the branch does not reach the target. Angles are shifted by full turns
            into the joint's range, or as near to its middle as possible.
        exists: The branch reaches the target, limits aside, (..., 4).
        within_limits: It exists and respects all four joint limits, (..., 4).
        singular: The target lies on the yaw axis, or at the edge of a branch that
            reaches it: arm stretched or folded, where the two elbows coincide, (...).
        position: The targets, (..., 3) [m].
    """

    __slots__ = ()

    def __repr__(self) -> str:
        """Of one target all numbers, of many the shapes."""
        one_target = self.position.ndim == 1
        return super().__repr__() if one_target else short_repr(self)

    @property
    def arm(self) -> Alpha5Parameters:
        """Record of the arm that was solved."""
        return chosen_arm(None)

    @property
    def collides(self) -> BoolArray:
        """It is within the limits, and the arm touches itself there, (..., 4).

        The jaws are closed, and bodies are as in `Arm.in_collision`.
        """
        from alpha5_model.kinematics import choosing

        return choosing.collides(self, self.arm)

    def best(self, q_reference: ArrayLike, allow_collision: bool = False) -> FloatArray:
        """The solution nearest to a joint position, within limits and free.

        Nearest means the least Euclidean norm of the four joint differences [rad]. On
        the yaw axis theta_0 is free: the reference's is taken, clipped to its range. If
        the arm touches itself there, the nearest theta_0 at which it does not is taken.

        Args:
            q_reference: (4,) or (..., 4) [rad].
            allow_collision: Choose also among the solutions that collide.

        Returns:
            (..., 4) [rad].

        Raises:
            UnreachableError: A target that no branch reaches within the limits, with
                the distance to the nearest point that is reached and that point. Both
                are NaN with a tool beside the wrist axis.
            SelfCollisionError: A kind of `UnreachableError`: all branches within the
                limits collide. It names the links and what would free the target.
            JointLimitError: The given wrist angle is beyond the limits of axis_b.
        """
        from alpha5_model.kinematics import choosing

        return choosing.best(self, self.arm, q_reference, allow_collision)


def inverse_kinematics(
    position: ArrayLike,
    wrist: ArrayLike = 0.0,
    *,
    arm: Alpha5Parameters | None = None,
) -> Solutions:
    """Every joint position that puts the tcp at a point.

    On the yaw axis (within 1e-9 m of it) theta_0 is free: the middle of its range is
    returned, the tcp is put on the axis itself and ``singular`` is set. A batch of N
    targets needs memory for its output, 137 bytes per target, and a scratch that does
    not grow with N.

    An arm of your own has its lengths, zeros, limits and tool point. If the tool point
    is beside the wrist axis, theta_3 moves it: a target may be out of reach at one
    wrist angle, and within reach at another.

    Args:
        position: tcp in ``base_link``, (..., 3) [m].
        wrist: theta_3, which moves no point of the wrist axis; it broadcasts against
            ``position``'s leading axes [rad].
        arm: Record of the arm; None is the catalogue's.

    Returns:
        Four branches per target, whether each exists and respects the limits.

    Raises:
        InputError: Not real numbers, or shapes that do not fit (`NonFiniteError` names
            a bad row), or an arm that is not a vertical plane with two links in it.
    """
    record = chosen_arm(arm)
    geometry = Geometry.of(record)
    target = float_array("position", position, (3,))
    angle = float_array("wrist", wrist, ())
    plausibility.check_largest("wrist", angle, plausibility.ANGLE)

    answer: tuple[Any, ...]
    if target.ndim == 1 and angle.ndim == 0:
        q, *flags = solve_rows(geometry, target[None], angle.reshape(1))
        exists, within_limits, singular = (flag[0] != 0.0 for flag in flags)
        answer = (q[0], exists, within_limits, singular.reshape(()), target.copy())
    else:
        try:
            lead = np.broadcast_shapes(target.shape[:-1], angle.shape)
        except ValueError:
            expected = f"a shape that broadcasts with {target.shape[:-1]}"
            raise InputError("wrist", angle.shape, expected) from None
        target = np.broadcast_to(target, (*lead, 3))
        answer = solve(geometry, target, angle)

    for array in answer:
        array.flags.writeable = False
    return answer_of(Solutions, record, answer)


def answer_of(
    kind: type[Kind], record: Alpha5Parameters, arrays: tuple[Any, ...]
) -> Kind:
    """Arrays as `Solutions` or `PoseSolutions` of an arm.

    The arm belongs to the class of the answer. So it stays with ``_replace``, with
    ``type(s)(*(x[0] for x in s))``, and with copies.
    """
    if record is not chosen_arm(None):
        kind = _kind_of(kind, record)
    return tuple.__new__(kind, arrays)


@lru_cache(maxsize=64)
def _kind_of(kind: type[Kind], record: Alpha5Parameters) -> type[Kind]:
    """The class of the answers of one arm."""

    def reduced(answer: tuple[Any, ...]) -> Any:
        """What ``copy`` and ``pickle`` make the answer of."""
        return answer_of, (kind, record, tuple(answer))

    body = {
        "__doc__": kind.__doc__,
        "__slots__": (),
        "arm": record,
        "__reduce__": reduced,
    }
    return type(kind.__name__, (kind,), body)
