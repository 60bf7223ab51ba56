"""Joint torques by cause, load on the mount and TCP of every sample of a motion.

`analyse` imports this module when it is called: it needs Pinocchio, which reading and
smoothing a motion do not.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, frozen
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.batch import frame_positions
from alpha5_model.dynamics.load import load
from alpha5_model.dynamics.torque_causes import torque_terms
from alpha5_model.errors import InputError
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.trajectory.file_table import CHUNK, Progress
from alpha5_model.trajectory.motions import Motion
from alpha5_model.trajectory.smoothing import SmoothMotion
from alpha5_model.trajectory.warning import MotionWarning
from alpha5_model.water.terms import WaterTerms, water_terms


class Loads(NamedTuple):
    """Torques of the joints and load on the mount, sample by sample.

    Attributes:
        inertia, coriolis, weight, buoyancy: Torques by cause, (N, n) [N m, N].
        base_wrench: Force and moment on the mount in still water, (N, 6) [N, N m].
        tcp: TCP in base_link, (N, 3) [m].
        moving_water: What a water current adds; None without one.
    """

    inertia: FloatArray
    coriolis: FloatArray
    weight: FloatArray
    buoyancy: FloatArray
    base_wrench: FloatArray
    tcp: FloatArray
    moving_water: WaterTerms | None


def default_arm(motion: Motion) -> Arm:
    """The arm in sea water, with jaws if the motion has the jaw rod."""
    return load(gripper="jaws" if "axis_a" in motion.joints else "locked")


def motion_for_arm(motion: Motion, arm: Arm) -> Motion:
    """The motion without the jaw rod, if the arm's gripper is locked.

    Raises:
        InputError: No `Arm` on a fixed base, or a motion without one of its joints.
    """
    if not isinstance(arm, Arm) or arm.has_hydrodynamics:
        expected = "an Arm in still water (moving water: the argument current)"
        raise InputError("arm", type(arm).__name__, expected)
    if arm.floating_base or arm.model.nv not in (4, 5):
        found = f"a model with nv = {arm.model.nv}"
        raise InputError("arm", found, "an arm on a fixed base")

    wanted = JOINT_NAMES[: arm.model.nv]
    if len(wanted) > len(motion.joints):
        expected = "a motion of axis_a too, since the arm's gripper has jaws"
        raise InputError("motion", motion.joints, expected)
    if len(wanted) == len(motion.joints):
        return motion

    velocity = motion.velocity
    effort = motion.effort
    current = motion.current
    return replace(
        motion,
        joints=wanted,
        position=motion.position[:, :4],
        velocity=None if velocity is None else velocity[:, :4],
        warnings=tuple(w for w in motion.warnings if not _is_of_the_rod(w)),
        ignored=(*motion.ignored, "axis_a"),
        effort=None if effort is None else effort[:, :4],
        current=None if current is None else current[:, :4],
    )


def _is_of_the_rod(warning: MotionWarning) -> bool:
    """Whether a warning names the jaw rod and no other joint."""
    named = [name for name in JOINT_NAMES if name in warning.text]
    return named == ["axis_a"]


def loads_of(
    arm: Arm,
    motion: SmoothMotion,
    current: ArrayLike | None,
    threads: int | None,
    progress: Progress | None,
) -> Loads:
    """Torques by cause, load on the mount and TCP of a motion.

    Args:
        arm: On a fixed base.
        motion: Of the arm's joints.
        current: Water current: velocity of the water in base_link, (3,) [m/s]; None for
            still water.
        threads: Of Pinocchio; None for all that this process may use.
        progress: Called with ``"compute"`` and the part done, 0 to 1.
    """
    count = motion.time.size
    parts = []
    for start in range(0, count, CHUNK):
        end = start + CHUNK
        parts.append(_part(arm, motion, slice(start, end), current, threads))
        if progress:
            progress("compute", min(end, count) / count)

    return Loads(
        inertia=np.concatenate([part.inertia for part in parts]),
        coriolis=np.concatenate([part.coriolis for part in parts]),
        weight=np.concatenate([part.weight for part in parts]),
        buoyancy=np.concatenate([part.buoyancy for part in parts]),
        base_wrench=np.concatenate([part.base_wrench for part in parts]),
        tcp=np.concatenate([part.tcp for part in parts]),
        moving_water=_joined([part.moving_water for part in parts]),
    )


def _part(
    arm: Arm,
    motion: SmoothMotion,
    samples: slice,
    current: ArrayLike | None,
    threads: int | None,
) -> Loads:
    """`loads_of` some samples."""
    q = motion.position[samples]
    v = motion.velocity[samples]
    a = motion.acceleration[samples]
    terms = torque_terms(arm, q, v, a, threads)
    return Loads(
        inertia=terms.inertia,
        coriolis=terms.coriolis,
        weight=terms.weight,
        buoyancy=terms.buoyancy,
        base_wrench=arm.base_wrench_batch(q, v, a, threads),
        tcp=frame_positions(arm, q),
        moving_water=None if current is None else water_terms(arm, q, v, a, current),
    )


def _joined(parts: list[WaterTerms | None]) -> WaterTerms | None:
    """What a water current adds to all samples; None without one."""
    found = [part for part in parts if part is not None]
    if not found:
        return None
    first, *_ = found
    return WaterTerms(
        current=first.current,
        torque=frozen(np.concatenate([part.torque for part in found])),
        wrench=frozen(np.concatenate([part.wrench for part in found])),
    )
