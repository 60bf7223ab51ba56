"""The record of a joint motion over time, recorded or planned, and its warnings."""

from __future__ import annotations

from dataclasses import dataclass

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.text import short_repr


@dataclass(frozen=True)
class MotionWarning:
    """Something implausible in a motion that does not stop the computation.

    Attributes:
        kind: ``"repeated_time"``, ``"gap"``, ``"jump"``, ``"outside_limits"``,
            ``"wrapped"``, ``"spike"``, ``"drop_out"``, ``"joined"``, ``"velocity"``,
            ``"effort_unit"``, ``"current_unit"``, ``"time_unit"``, ``"time_column"``,
            ``"command"``, ``"not_used"`` or ``"bad_row"``; of a bag also
            ``"missing_joints"``, ``"no_stamp"``, ``"out_of_order"`` or
            ``"publishers"``.
        count: How often it occurs.
        first: Where it occurs first.
        text: What it is, and how it is handled.
        joint: The only joint that it is about; None if it is about several, or none.
    """

    kind: str
    count: int
    first: str
    text: str
    joint: str | None = None

    def __str__(self) -> str:
        return f"{self.text}: {self.count} x, first: {self.first}"


@dataclass(frozen=True, eq=False)
class Motion:
    """Samples of a joint motion, as given; times strictly increase.

    Attributes:
        time: (N,) [s].
        joints: Names of the n joints, base to tip: four, or five with the jaw rod
            ``axis_a``.
        position: (N, n) [rad], jaw rod [m].
        velocity: (N, n) [rad/s], jaw rod [m/s]; None if not given.
        warnings: Warnings about the samples.
        source: File name, or ``"arrays"``.
        ignored: Columns of the file that were not used.
        time_unit: Unit of the file's time column: ``"s"``, ``"ms"``, ``"us"``,
            ``"ns"``, or ``"min"``. `time` is in s.
        effort: Recorded joint torques, (N, n) [N m], jaw rod [N]; NaN if unknown, None
            if not given. They are compared with the model's torque, which does not
            depend on them. Efforts that are milliamperes are found by `analyse`.
        current: Recorded currents of the motors, (N, n) [A]; NaN if unknown, None if
            not given.
    """

    time: FloatArray
    joints: tuple[str, ...]
    position: FloatArray
    velocity: FloatArray | None = None
    warnings: tuple[MotionWarning, ...] = ()
    source: str = "arrays"
    ignored: tuple[str, ...] = ()
    time_unit: str = "s"
    effort: FloatArray | None = None
    current: FloatArray | None = None

    __repr__ = short_repr
