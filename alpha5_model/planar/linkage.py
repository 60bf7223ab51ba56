"""A serial arm in the plane with revolute and prismatic joints.

Joint j is followed by link j, which leaves along the local x axis. Seen from link j-1 the next link
is turned by ``angles[j]``; a revolute joint adds q_j to this angle, a prismatic joint adds q_j to
the length of the link. So ``PlanarArm((5, 4, 1))`` is the notes' 3R arm, and a prismatic joint is a
link of varying length, as they put it.

References:
    [Lecture7.1] Describing Robot Arms, section "Workspace".
    [Siciliano2009] Siciliano et al.: Robotics, section 2.9.1 (three-link planar arm).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from operator import index
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import BoolArray, FloatArray, bounded, float_array, listed
from alpha5_model.errors import InputError, MissingParameterError, ShapeError

Limits = Sequence[tuple[float, float] | None]


@dataclass(frozen=True)
class Linkage:
    """Links and joints of a planar arm, base at the origin: `PlanarArm` without its workspace.

    Attributes:
        lengths: Link lengths [m]: positive after a revolute joint, zero or more after a prismatic
            one.
        limits: (lower, upper) per joint [rad or m]; None, for one or all, where a revolute joint
            has no limits. A range of a full turn or more counts as none.
        joints: One letter per joint, ``"R"`` or ``"P"``; all revolute by default.
        angles: Constant angle of each link to the one before [rad]; zero by default.

    Raises:
        InputError: No links, a length that is negative or zero, limits the wrong way round, an
            unknown joint type.
        MissingParameterError: A prismatic joint without limits.
    """

    lengths: tuple[float, ...]
    limits: tuple[tuple[float, float] | None, ...] = ()
    joints: str = ""
    angles: tuple[float, ...] = ()

    def __init__(
        self,
        lengths: ArrayLike,
        limits: Limits | None = None,
        joints: str | None = None,
        angles: ArrayLike | None = None,
    ) -> None:
        values = float_array("lengths", lengths, ())
        if values.ndim != 1 or values.size == 0:
            raise ShapeError("lengths", values.shape, "shape (N,), at least one link")
        n = values.size
        kinds = "R" * n if joints is None else joints
        if not isinstance(kinds, str) or len(kinds) != n or set(kinds) - {"R", "P"}:
            raise InputError("joints", joints, f"{n} letters R or P, one per link")
        for value, kind in zip(values.tolist(), kinds, strict=True):
            if value <= 0 if kind == "R" else value < 0:
                bound = "positive" if kind == "R" else "not negative"
                raise InputError("lengths", value, f"a length that is {bound}")
        turn = np.zeros(n) if angles is None else float_array("angles", angles, (n,))
        if turn.ndim != 1:
            raise ShapeError("angles", turn.shape, f"shape ({n},)")
        expected = f"one (lower, upper) or None for {n} joints"
        ranges = [None] * n if limits is None else listed("limits", limits, expected)
        if len(ranges) != n:
            raise ShapeError("limits", (len(ranges),), expected)
        checked = tuple(_range(*pair) for pair in zip(ranges, kinds, strict=True))
        object.__setattr__(self, "lengths", tuple(values.tolist()))
        object.__setattr__(self, "limits", checked)
        object.__setattr__(self, "joints", kinds)
        object.__setattr__(self, "angles", tuple(turn.tolist()))
        if not math.isfinite(4 * math.pi * self.reach * self.reach):
            raise InputError("lengths", self.lengths, "an arm whose area is a finite number")

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.lengths)

    @property
    def reach(self) -> float:
        """No point of the arm is ever farther from the base [m]."""
        rows = zip(self.joints, self.limits, strict=True)
        travel = [max(map(abs, r)) if kind == "P" and r else 0.0 for kind, r in rows]
        return sum(map(sum, zip(self.lengths, travel, strict=True)))

    @property
    def length_ranges(self) -> tuple[tuple[float, float], ...] | None:
        """Range of the distance between one revolute joint and the next (last: to the tip) [m].

        None unless the first joint is revolute, no revolute joint has limits, and every prismatic
        joint slides along its link: then the workspace depends on these ranges only.
        """
        ranges: list[list[float]] = []
        rows = zip(self.lengths, self.limits, self.joints, self.angles, strict=True)
        for length, limit, kind, angle in rows:
            if kind == "R":
                if limit is not None:
                    return None
                ranges.append([length, length])
            else:
                if not ranges or angle != 0.0 or limit is None:
                    return None
                ranges[-1][0] += length + limit[0]
                ranges[-1][1] += length + limit[1]
        return tuple((max(0.0, low, -high), max(-low, high)) for low, high in map(tuple, ranges))

    def part(self, start: int, stop: int | None = None) -> Self:
        """The arm of joints start to stop - 1 only, in the frame of the link before, as a slice."""
        try:
            cut = slice(index(start), None if stop is None else index(stop))
        except TypeError:
            raise InputError("start, stop", (start, stop), "whole numbers") from None
        return type(self)(self.lengths[cut], self.limits[cut], self.joints[cut], self.angles[cut])

    def poses(self, q: ArrayLike) -> FloatArray:
        """Base, every link's end, and the direction there.

        Args:
            q: (..., N) [rad or m].

        Returns:
            x [m], y [m], orientation [rad]: (..., N + 1, 3); row 0 is the base, the last the tip.
        """
        position = bounded("q", float_array("q", q, (self.n,)))
        revolute = np.array([kind == "R" for kind in self.joints])
        heading = np.cumsum(np.where(revolute, position, 0.0) + np.array(self.angles), axis=-1)
        length = np.where(revolute, 0.0, position) + np.array(self.lengths)
        out = np.zeros((*position.shape[:-1], self.n + 1, 3))
        out[..., 1:, 0] = np.cumsum(length * np.cos(heading), axis=-1)
        out[..., 1:, 1] = np.cumsum(length * np.sin(heading), axis=-1)
        out[..., 1:, 2] = heading
        return out

    def forward_kinematics(self, q: ArrayLike) -> FloatArray:
        """Tip x [m], y [m] and orientation [rad], (..., 3), at q (..., N) [rad or m]."""
        return np.ascontiguousarray(self.poses(q)[..., -1, :])

    def jacobian(self, q: ArrayLike) -> FloatArray:
        """Derivative of `forward_kinematics`, (..., 3, N), at q (..., N) [rad or m]."""
        poses = self.poses(q)
        to_tip = poses[..., -1:, :2] - poses[..., :-1, :2]
        heading = poses[..., 1:, 2]
        revolute = np.array([kind == "R" for kind in self.joints])
        out = np.empty((*poses.shape[:-2], 3, self.n))
        out[..., 0, :] = np.where(revolute, -to_tip[..., 1], np.cos(heading))
        out[..., 1, :] = np.where(revolute, to_tip[..., 0], np.sin(heading))
        out[..., 2, :] = revolute
        return out


def within_limits(arm: Linkage, joint: int, q: FloatArray, slack: Any) -> BoolArray:
    """Whether positions q of a joint lie in its limits, up to `slack` (broadcast); NaN does not."""
    limit = arm.limits[joint]
    if limit is None:
        return ~np.isnan(q)
    low, high = limit
    over = q - low + slack
    with np.errstate(invalid="ignore"):
        if arm.joints[joint] == "R":
            over = np.mod(over, math.tau)
        return np.asarray((over >= 0.0) & (over <= high - low + 2 * slack))


def _range(limit: Any, kind: str) -> tuple[float, float] | None:
    if limit is None:
        if kind == "P":
            raise MissingParameterError("limits (lower, upper) of each", "a prismatic joint")
        return None
    values = float_array("limits", limit, (2,))
    if values.ndim != 1:
        raise ShapeError("limits", values.shape, "a pair (lower, upper) per joint")
    lower, upper = values.tolist()
    if lower > upper:
        raise InputError("limits", (lower, upper), "lower <= upper")
    return None if kind == "R" and upper - lower >= 2 * math.pi else (lower, upper)
