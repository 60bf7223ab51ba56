"""Joint motion from arrays."""

from __future__ import annotations

from collections.abc import Sequence

from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, float_array, listed, named
from alpha5_model.errors import InputError, ShapeError
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.trajectory.checks import ArrayOrigin, checked
from alpha5_model.trajectory.current_units import refuse_milliamperes
from alpha5_model.trajectory.motions import Motion


def motion(
    time: ArrayLike,
    position: ArrayLike,
    velocity: ArrayLike | None = None,
    joints: Sequence[str] | None = None,
    effort: ArrayLike | None = None,
    arm: Alpha5Parameters | None = None,
    current: ArrayLike | None = None,
) -> Motion:
    """A motion from arrays, with the same checks as one from a file.

    Args:
        time: (N,) [s], increasing, uniform or not. Of samples with the same time the
            first counts.
        position: (N, n) [rad], jaw rod [m].
        velocity: (N, n), optional.
        joints: Names of the columns, in any order; base to tip if None.
        effort: Recorded joint torques, (N, n) [N m], jaw rod [N], optional.
        arm: Record of an arm of your own, for its ranges and rated speeds; None for the
            catalogue's.
        current: Recorded currents of the motors, (N, n) [A], optional.

    Raises:
        InputError: Time runs back, a joint is missing or named twice, too few samples,
            not finite, angles in degrees, currents in milliamperes.
    """
    t = float_array("time", time, ())
    if t.ndim != 1:
        raise ShapeError("time", t.shape, "shape (N,)")
    q = float_array("position", position, ())
    if q.ndim != 2 or q.shape[0] != t.size or q.shape[1] not in (4, 5):
        expected = f"shape ({t.size}, 4), or ({t.size}, 5) with axis_a"
        raise ShapeError("position", q.shape, expected)

    wanted = JOINT_NAMES[: q.shape[1]]
    names = wanted if joints is None else _listed_joints(joints)
    v = _like_position("velocity", velocity, q)
    tau = _like_position("effort", effort, q)
    amperes = _like_position("current", current, q)

    named("joint", names, JOINT_NAMES)
    if sorted(names) != sorted(wanted):
        raise InputError("joints", names, f"each of {', '.join(wanted)} once")

    order = [names.index(name) for name in wanted]
    raw = Motion(
        time=t,
        joints=wanted,
        position=q[:, order],
        velocity=None if v is None else v[:, order],
        effort=None if tau is None else tau[:, order],
        current=None if amperes is None else amperes[:, order],
    )
    parameters = chosen_arm(arm)
    if raw.current is not None:
        refuse_milliamperes(raw.current, parameters)
    return checked(raw, parameters, ArrayOrigin())


def _listed_joints(joints: Sequence[str]) -> tuple[str, ...]:
    """The names of joints as a tuple."""
    return tuple(listed("joints", joints, "names of joints"))


def _like_position(
    name: str, value: ArrayLike | None, position: FloatArray
) -> FloatArray | None:
    """An optional array that has the shape of the positions."""
    if value is None:
        return None
    array = float_array(name, value, ())
    if array.shape != position.shape:
        expected = f"the shape of position, {position.shape}"
        raise ShapeError(name, array.shape, expected)
    return array
