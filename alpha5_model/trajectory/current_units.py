"""Recorded currents in milliamperes, also where efforts are expected."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray, frozen
from alpha5_model.dynamics.actuators import Actuator
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.trajectory.motions import Motion
from alpha5_model.trajectory.warning import MotionWarning

_MILLI = 1e-3
#: Supply of the arm [V], as `alpha5_model.numbers.plausibility` takes it.
_SUPPLY = 24.0
#: A payload may double the torque of the model and its friction. In milliamperes an
#: effort is some 50 times that in N m: Table 4's motors give 1 N m with 43 to 108 mA.
_MOST_OF_TORQUE = 2.0
_EVERYWHERE = "all samples"


def in_amperes(
    current: FloatArray, parameters: Alpha5Parameters, head: str
) -> tuple[FloatArray, list[MotionWarning]]:
    """Currents in A, and a warning if they were in mA.

    They are if any exceeds what the largest motor takes when it stalls at 24 V.

    Args:
        current: (N, n), NaN if unknown, in the unit of the file.
        parameters: The arm, for the resistances of its motors.
        head: Where the names of the columns are in the file.
    """
    most = _most_amperes(parameters)
    too_large = int(np.count_nonzero(np.abs(current) > most))
    if not too_large:
        return current, []
    text = (
        f"currents read in mA: in A they exceed the {most:.3g} A of a stalled motor; "
        "call the columns axis_e_current_A if they are in A"
    )
    warning = MotionWarning(
        kind="current_unit", count=too_large, first=head or _EVERYWHERE, text=text
    )
    return current * _MILLI, [warning]


def refuse_milliamperes(current: FloatArray, parameters: Alpha5Parameters) -> None:
    """Refuse currents of the caller's arrays that no motor of the arm takes.

    Args:
        current: (N, n) [A], NaN if unknown.
        parameters: The arm, for the resistances of its motors.

    Raises:
        InputError: A current beyond what the largest motor takes when it stalls at
            24 V.
    """
    most = _most_amperes(parameters)
    too_large = np.abs(current) > most
    if too_large.any():
        expected = (
            f"currents [A] up to the {most:.3g} A of a stalled motor; "
            "divide milliamperes by 1000"
        )
        raise InputError("current", float(current[too_large][0]), expected)


def _most_amperes(parameters: Alpha5Parameters) -> float:
    """What the largest motor takes when it stalls [A]."""
    least = min(actuator.resistance for actuator in parameters.actuators)
    return _SUPPLY / least


class Recorded(NamedTuple):
    """What a recording says of torques and currents.

    Attributes:
        effort: (N, n) [N m], jaw rod [N]; None if there are none.
        current: (N, n) [A]; None if there are none.
        warnings: About efforts that are currents.
    """

    effort: FloatArray | None
    current: FloatArray | None
    warnings: tuple[MotionWarning, ...]


def efforts_and_currents(
    motion: Motion, torque: FloatArray, motors: Sequence[Actuator]
) -> Recorded:
    """Efforts and currents of a motion; efforts that are milliamperes are currents.

    Recorded currents come before such efforts.

    Args:
        motion: What was recorded.
        torque: At the joints, (N, n) [N m].
        motors: Of the n joints.
    """
    amperes, warnings = _efforts_in_amperes(motion, torque, motors)
    if amperes is None:
        return Recorded(effort=motion.effort, current=motion.current, warnings=())
    current = frozen(amperes) if motion.current is None else motion.current
    return Recorded(effort=None, current=current, warnings=tuple(warnings))


def _efforts_in_amperes(
    motion: Motion, torque: FloatArray, motors: Sequence[Actuator]
) -> tuple[FloatArray | None, list[MotionWarning]]:
    """Efforts that are milliamperes, in A, and a warning; None if they are N m.

    They are milliamperes if they are more than twice what the motion takes with
    friction, and possible as currents. The jaw rod does not count.

    Args:
        motion: Its efforts are judged.
        torque: At the joints, (N, n) [N m].
        motors: Of the n joints.
    """
    effort = motion.effort
    if effort is None:
        return None, []
    turning = slice(0, 4)
    known = np.isfinite(effort[:, turning])
    recorded = np.where(known, effort[:, turning], 0.0)
    friction = np.array([motor.joint_friction for motor in motors[turning]])
    possible = np.where(known, np.abs(torque[:, turning]) + friction, 0.0)
    stalled = max(_SUPPLY / motor.parameters.resistance for motor in motors)

    ratio = float(np.linalg.norm(recorded)) / max(float(np.linalg.norm(possible)), 1e-9)
    largest = float(np.abs(recorded).max())
    if ratio <= _MOST_OF_TORQUE or largest * _MILLI > stalled:
        return None, []
    text = (
        f"efforts read in mA and compared with the currents: as N m they are "
        f"{ratio:.3g} times the torque with friction"
    )
    warning = MotionWarning(kind="effort_unit", count=1, first=_EVERYWHERE, text=text)
    return effort * _MILLI, [warning]
