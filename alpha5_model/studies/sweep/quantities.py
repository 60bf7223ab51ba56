"""The quantities of a study, computed for the states of a case."""

from __future__ import annotations

from collections.abc import Set

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.dynamics import batch
from alpha5_model.studies.sweep.arms import ArmOfCase
from alpha5_model.trajectory import SmoothMotion
from alpha5_model.trajectory.motors import motor_columns

_OF_TORQUE = {"torque", "current", "power", "margin"}
_OF_MOTORS = {"current", "power"}
_OF_MOUNT = {"mount_force", "mount_moment"}


def quantities_of(
    case: ArmOfCase, motion: SmoothMotion, wanted: Set[str]
) -> dict[str, FloatArray]:
    """Quantities by name, (n, columns) each: those that are wanted, and perhaps more.

    Args:
        case: The arm and its motors.
        motion: Of n states.
        wanted: Names of the quantities.
    """
    arm = case.arm
    q = motion.position
    v = motion.velocity
    a = motion.acceleration
    found: dict[str, FloatArray] = {}

    if wanted & _OF_TORQUE:
        torque = arm.inverse_dynamics_batch(q, v, a, 1)
        found["torque"] = torque
        if "margin" in wanted:
            # No rating is published; this is the placeholder of public models.
            found["margin"] = arm.limits.effort - np.abs(torque)
        if wanted & _OF_MOTORS:
            of_motors = motor_columns(case.motors, motion, torque)
            found["current"] = of_motors["current"]
            found["power"] = of_motors["electrical_power"]
    if wanted & _OF_MOUNT:
        wrench = arm.base_wrench_batch(q, v, a, 1)
        found["mount_force"] = _with_norm(wrench[:, :3])
        found["mount_moment"] = _with_norm(wrench[:, 3:])
    if "trim" in wanted and case.trim is not None:
        found["trim"] = case.trim.angles(q)
    if "reach" in wanted:
        still = getattr(arm, "still", arm)
        found["reach"] = _with_norm(batch.frame_positions(still, q))
    return found


def _with_norm(vectors: FloatArray) -> FloatArray:
    """Vectors (n, 3) and their norms, (n, 4)."""
    norm = np.sqrt((vectors**2).sum(axis=1))
    return np.column_stack([vectors, norm])
