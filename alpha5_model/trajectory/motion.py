"""A joint motion over time, recorded or planned, checked."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray, choice, float_array, frozen
from alpha5_model.errors import Alpha5Error, InputError, ShapeError
from alpha5_model.parameters import parameters
from alpha5_model.published.tables import JOINT_NAMES

#: Base to tip; the first four are the arm, the last is the jaw rod, which a motion may leave out.
JOINTS = JOINT_NAMES
#: Fewer samples give no useful acceleration.
MINIMUM_SAMPLES = 5
#: A step is a jump beyond this share of the joint's range plus twice its rated speed.
JUMP_SHARE = 0.1
#: A position beyond a limit by less than this share of the joint's range is at the limit.
LIMIT_SLACK = 1e-3
#: A gap is longer than this many median sample times.
GAP_FACTOR = 10.0

#: Larger positions [rad], velocities and times [s] are refused: derivatives would overflow.
_MOST = 1e9
_MOST_TIME = 1e12
#: Times nearer than this are the same [s].
_LEAST_STEP = 1e-9

#: (sample, joint or None for the time) -> the place of that number, for messages.
Place = Callable[[int, "str | None"], str]
#: (sample, joint or None for the time, what was given, what is expected) -> the error to raise.
Refuse = Callable[[int, "str | None", float, str], Alpha5Error]
#: (stage, part done, 0 to 1)
Progress = Callable[[str, float], None]


@dataclass(frozen=True)
class MotionWarning:
    """Something odd in a motion that does not stop the computation.

    Attributes:
        kind: ``"repeated_time"``, ``"gap"``, ``"jump"``, ``"outside_limits"``, ``"velocity"``,
            ``"effort"`` or ``"time_unit"``; of a bag also ``"missing_joints"``,
            ``"not_finite"``, ``"no_stamp"``, ``"out_of_order"`` or ``"publishers"``.
        count: How often.
        first: Where it happens first.
        text: What it is, and what is done about it.
    """

    kind: str
    count: int
    first: str
    text: str

    def __str__(self) -> str:
        return f"{self.text}: {self.count} x, first: {self.first}"


@dataclass(frozen=True, eq=False)
class Motion:
    """Samples of a joint motion, as given; times strictly increase.

    Attributes:
        time: (N,) [s].
        joints: Names of the n joints, base to tip: four, or five with the jaw rod ``axis_a``.
        position: (N, n) [rad], jaw rod [m].
        velocity: (N, n) [rad/s], jaw rod [m/s]; None if not given.
        warnings: What was found odd.
        source: File name, or ``"arrays"``.
        ignored: Columns of the file that were not used.
        time_unit: Of the file's time column: ``"s"``, ``"ms"``, ``"us"``, ``"ns"``; `time` is in s.
        effort: Joint torques as recorded, (N, n) [N m], jaw rod [N], NaN where there is none; None
            if not given. Compared with the model's torque, never used for it.
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


def motion(
    time: ArrayLike,
    position: ArrayLike,
    velocity: ArrayLike | None = None,
    joints: Sequence[str] | None = None,
    effort: ArrayLike | None = None,
) -> Motion:
    """A motion from arrays, with the same checks as one from a file.

    Args:
        time: (N,) [s], increasing, uniform or not. Of samples with the same time the first counts.
        position: (N, n) [rad], jaw rod [m].
        velocity: (N, n), optional.
        joints: Names of the columns, in any order; base to tip if None.
        effort: Recorded joint torques, (N, n) [N m], jaw rod [N], optional.

    Raises:
        InputError: Time runs back, a joint is missing or named twice, too few samples, not finite.
    """
    t = float_array("time", time, ())
    if t.ndim != 1:
        raise ShapeError("time", t.shape, "shape (N,)")
    q = float_array("position", position, ())
    if q.ndim != 2 or q.shape[0] != t.size or q.shape[1] not in (4, 5):
        raise ShapeError("position", q.shape, f"shape ({t.size}, 4), or ({t.size}, 5) with axis_a")

    def like_position(name: str, value: ArrayLike | None) -> FloatArray | None:
        table = None if value is None else float_array(name, value, ())
        if table is not None and table.shape != q.shape:
            raise ShapeError(name, table.shape, f"the shape of position, {q.shape}")
        return table

    v, e = like_position("velocity", velocity), like_position("effort", effort)
    names = JOINTS[: q.shape[1]] if joints is None else tuple(joints)
    for name in names:
        choice("joint", name, JOINTS)
    wanted = JOINTS[: q.shape[1]]
    if sorted(names) != sorted(wanted):
        raise InputError("joints", names, f"each of {', '.join(wanted)} once")
    order = [names.index(name) for name in wanted]

    def place(sample: int, joint: str | None) -> str:
        return f"sample {sample}" + (f" of {joint}" if joint else "")

    def refuse(sample: int, joint: str | None, value: float, expected: str) -> Alpha5Error:
        return InputError(f"{joint or 'time'}[{sample}]", float(value), expected)

    v, e = (table if table is None else table[:, order] for table in (v, e))
    return checked(Motion(t, wanted, q[:, order], v, effort=e), place, refuse)


def checked(raw: Motion, place: Place, refuse: Refuse) -> Motion:
    """Check finite samples in joint order; times that repeat are dropped and counted."""
    time, position, velocity, effort = raw.time, raw.position, raw.velocity, raw.effort
    if effort is not None:
        effort = np.where(np.isfinite(effort), effort, np.nan)
        effort = None if np.isnan(effort).all() else effort
    if time.size < MINIMUM_SAMPLES:
        why = "; ".join(map(str, raw.warnings))
        name = raw.source + (f" ({why})" if why else "") if raw.source != "arrays" else "time"
        raise InputError(name, time.size, f"at least {MINIMUM_SAMPLES} samples")
    for what, table, most in (
        ("time", time[:, None], _MOST_TIME),
        ("position", position, _MOST),
        ("velocity", velocity, _MOST),
        ("recorded effort", effort, _MOST),
    ):
        if table is not None and (beyond := np.argwhere(np.abs(table) > most)).size:
            sample, k = (int(i) for i in beyond[0])
            joint = None if what == "time" else raw.joints[k]
            raise refuse(sample, joint, table[sample, k], f"a {what} of at most {most:g} in size")
    steps = np.diff(time)
    if (steps < 0).any():
        k = int(np.argmax(steps < 0)) + 1
        raise refuse(k, None, time[k], f"a time of at least {time[k - 1]:.9g} s: time runs back")
    keep = np.concatenate([[True], steps >= _LEAST_STEP])
    samples = np.flatnonzero(keep)
    found = list(raw.warnings)

    def warn(kind: str, bad: np.ndarray, joint: str | None, text: str) -> None:
        if bad.size:
            found.append(MotionWarning(kind, int(bad.size), place(int(bad[0]), joint), text))

    warn("repeated_time", np.flatnonzero(~keep), None, "time repeated, sample dropped")
    t, q = time[keep], position[keep]
    if t.size < MINIMUM_SAMPLES:
        expected = f"at least {MINIMUM_SAMPLES} samples with different times"
        raise refuse(0, None, time[0], expected)
    steps = np.diff(t)
    gap = GAP_FACTOR * float(np.median(steps))
    warn("gap", samples[1:][steps > gap], None, f"more than {gap:.3g} s without a sample, bridged")
    for column, bound in enumerate(parameters().joints[: len(raw.joints)]):
        name, span = bound.name, bound.upper - bound.lower
        unit = "m" if name == "axis_a" else "rad"
        jump = np.abs(np.diff(q[:, column])) > JUMP_SHARE * span + 2 * bound.velocity * steps
        warn("jump", samples[1:][jump], name, f"{name} jumps farther than it can move")
        slack = LIMIT_SLACK * span
        outside = (q[:, column] < bound.lower - slack) | (q[:, column] > bound.upper + slack)
        text = f"{name} outside its range {bound.lower:.6g} to {bound.upper:.6g} {unit}"
        if np.abs(q[:, column]).max() > 4 * bound.upper:
            text += f" (is it in {'mm' if unit == 'm' else 'degrees'}?)"
        warn("outside_limits", samples[outside], name, text)
    v, e = (None if table is None else frozen(table[keep]) for table in (velocity, effort))
    return replace(
        raw, time=frozen(t), position=frozen(q), velocity=v, effort=e, warnings=tuple(found)
    )
