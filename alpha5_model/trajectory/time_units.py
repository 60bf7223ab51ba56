"""The unit of a column of time, from its name, its steps and the joints' speeds."""

from __future__ import annotations

import re

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.trajectory.file_table import PER_SECOND

#: Names of the time with a unit: ``time_ms``, ``time [ms]``, ``Time (us)``.
TIME_WITH_UNIT = re.compile(r"time[ _\[(]+([mun]?s)(?:ecs?)?[\])]?", re.IGNORECASE)
#: Names that loggers give the time: ``t``, ``timestamp``, ``wall_time_sec``;
#: PlotJuggler's ``__time``, ``%time`` of rostopic, and the stamp of a message.
CLOCK = re.compile(
    r"(?:t|timestamp|(?:elapsed|replay|ros|sim|wall)_time|__time|%time"
    r"|(?:.*[./])?header[./]stamp(?:[./]secs?)?)"
    r"(?:[ _\[(]+([mun]?s)(?:ecs?)?[\])]?)?",
    re.IGNORECASE,
)


def time_unit(
    name: str, time: FloatArray, position: FloatArray, parameters: Alpha5Parameters
) -> tuple[str, str]:
    """The unit of a column of time, and a warning if it is doubtful.

    Args:
        name: Of the column; a unit in it counts.
        time: (N,) In the unit of the column.
        position: (N, n) [rad], jaw rod [m].
        parameters: The arm, for the rated speeds of its joints.

    Returns:
        A key of `PER_SECOND`, and the text of the warning, ``""`` if there is none.
    """
    likely = _likely_unit(time, position, parameters)
    doubtful = likely != "s"
    stated = _stated_unit(name)
    if stated is None:
        doubt = (
            f"{name} read as {likely}, which its steps and speeds fit; "
            "call it time_secs if it is in seconds"
        )
        return likely, doubt if doubtful else ""

    doubt = (
        f"{name} read as seconds, though its steps and speeds fit {likely}: "
        f"is it time_{likely}?"
    )
    return stated, doubt if doubtful and stated == "s" else ""


def _stated_unit(name: str) -> str | None:
    """The unit in the name of a column, if there is one."""
    match = TIME_WITH_UNIT.fullmatch(name) or CLOCK.fullmatch(name)
    if match is None or match[1] is None:
        return None
    unit: str = match[1]
    return unit.lower()


def _likely_unit(
    time: FloatArray, position: FloatArray, parameters: Alpha5Parameters
) -> str:
    """The largest unit that makes a time step shorter than a second.

    But it is seconds if that unit would make the mean speed of a joint exceed twice its
    rated speed. This happens in a plan of few points.
    """
    with np.errstate(over="ignore"):
        steps = np.diff(time)
        path = np.abs(np.diff(position, axis=0)).sum(axis=0)
    steps = steps[steps > 0]
    if not steps.size:
        return "s"
    median = float(np.median(steps))
    if median < 1.0:
        return "s"

    smaller = [unit for unit, count in PER_SECOND.items() if median < count]
    unit = smaller[0] if smaller else "ns"
    duration = (steps / PER_SECOND[unit]).sum()
    rated = np.array([joint.velocity for joint in parameters.joints[: path.size]])
    too_fast = path / duration > 2 * rated
    return "s" if too_fast.any() else unit
