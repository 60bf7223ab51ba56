"""Warnings about a motion."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class MotionWarning:
    """Something implausible in a motion that does not stop the computation.

    Attributes:
        kind: ``"repeated_time"``, ``"gap"``, ``"jump"``, ``"outside_limits"``,
            ``"wrapped"``, ``"spike"``, ``"drop_out"``, ``"joined"``, ``"velocity"``,
            ``"effort_unit"``, ``"current_unit"``, ``"time_unit"``, ``"time_column"``,
            ``"command"``, ``"not_used"`` or ``"bad_row"``; of a bag also
            ``"missing_joints"``, ``"not_finite"``, ``"no_stamp"``, ``"out_of_order"``
            or ``"publishers"``.
        count: How often it occurs.
        first: Where it occurs first.
        text: What it is, and how it is handled.
    """

    kind: str
    count: int
    first: str
    text: str

    def __str__(self) -> str:
        return f"{self.text}: {self.count} x, first: {self.first}"
