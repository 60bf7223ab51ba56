"""A motion from arrays, and the checks of every motion.

What cannot be a motion is refused; what can be mended is mended, with a warning.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from alpha5_model._support.checks import (
    BoolArray,
    FloatArray,
    float_array,
    frozen,
    listed,
    named,
)
from alpha5_model.errors import Alpha5Error, InputError, ShapeError
from alpha5_model.numbers.parameters import (
    Alpha5Parameters,
    JointRange,
    chosen_arm,
)
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.trajectory.motions import Motion, MotionWarning

#: Fewer samples give no useful acceleration.
MINIMUM_SAMPLES = 5
#: Recordings hold a value for so long [s]; a step is a jump if twice the rated speed is
#: too slow for it, this time included.
HOLD = 0.1
#: A spike leaves and returns by more than this share of the joint's range, plus the
#: distance at twice the rated speed.
SPIKE_SHARE = 0.02
#: Samples of a spike at most, and one of so many samples may be in one.
_LONGEST_SPIKE = 3
_SAMPLES_FOR_A_SPIKE = 100
#: An arm moves if, in this time [s], a joint does so at this share of its rated speed.
_MOVING_TIME = 0.5
_MOVING_SHARE = 0.02
_TURN = 2 * math.pi
#: A position beyond a limit by less than this share of the joint's range is at the
#: limit.
LIMIT_SLACK = 1e-3
#: A gap is longer than this many median sample times.
GAP_FACTOR = 10.0
#: Times that differ by less are the same [s].
_SAME_TIME = 1e-9
#: A position this many times beyond the upper limit is in another unit.
_FAR = 4.0
#: Angles are in degrees if they are far off as radians, and as degrees within the range
#: or beyond it by this share of it. A recorded zero may be off by as much.
_DEGREES_SLACK = 0.1
#: Derivatives of larger numbers would overflow.
_LARGEST_TIME = 1e12
_LARGEST = 1e9
#: Supply of the arm [V], as `alpha5_model.numbers.plausibility` takes it.
SUPPLY = 24.0


class Origin(Protocol):
    """Where the samples of a motion come from, for messages.

    Attributes:
        to_radians: What to do with angles in degrees.
    """

    to_radians: str

    def place(self, sample: int, joint: str | None) -> str:
        """Where a sample is: the number of a joint, or the time if that is None."""

    def error(
        self, sample: int, joint: str | None, value: float, expected: str
    ) -> Alpha5Error:
        """The error about a number of a sample."""


class _ArrayOrigin:
    """Samples from the caller's arrays."""

    to_radians = "give numpy.radians of them"

    def place(self, sample: int, joint: str | None) -> str:
        return f"sample {sample} of {joint}" if joint else f"sample {sample}"

    def error(
        self, sample: int, joint: str | None, value: float, expected: str
    ) -> Alpha5Error:
        return InputError(f"{joint or 'time'}[{sample}]", float(value), expected)


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
    names = wanted
    if joints is not None:
        names = tuple(listed("joints", joints, "names of joints"))
    optional = {"velocity": velocity, "effort": effort, "current": current}
    arrays = {name: _like(name, value, q) for name, value in optional.items()}
    named("joint", names, JOINT_NAMES)
    if sorted(names) != sorted(wanted):
        raise InputError("joints", names, f"each of {', '.join(wanted)} once")

    order = [names.index(name) for name in wanted]
    ordered = {k: None if x is None else x[:, order] for k, x in arrays.items()}
    parameters = chosen_arm(arm)
    amperes = ordered["current"]
    most = most_amperes(parameters)
    if amperes is not None and (np.abs(amperes) > most).any():
        expected = (
            f"currents [A] up to the {most:.3g} A of a stalled motor; "
            "divide milliamperes by 1000"
        )
        first = float(amperes[np.abs(amperes) > most][0])
        raise InputError("current", first, expected)
    raw = Motion(
        time=t,
        joints=wanted,
        position=q[:, order],
        velocity=ordered["velocity"],
        effort=ordered["effort"],
        current=amperes,
    )
    return checked(raw, parameters, _ArrayOrigin())


def _like(
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


def most_amperes(parameters: Alpha5Parameters) -> float:
    """What the largest motor takes when it stalls [A]."""
    least = min(actuator.resistance for actuator in parameters.actuators)
    return SUPPLY / least


def checked(raw: Motion, parameters: Alpha5Parameters, origin: Origin) -> Motion:
    """A motion with read-only arrays, without repeated times, with warnings added.

    Args:
        raw: Samples in the order of the joints; efforts need not be finite.
        parameters: The arm, for the ranges and rated speeds of its joints.
        origin: Where the samples come from.

    Raises:
        Alpha5Error: Too few samples, numbers that are too large, time that runs back,
            angles in degrees.
    """
    raw = replace(raw, effort=_known(raw.effort), current=_known(raw.current))
    if raw.time.size < MINIMUM_SAMPLES:
        odd = "; ".join(map(str, raw.warnings))
        source = "time" if raw.source == "arrays" else raw.source
        expected = f"at least {MINIMUM_SAMPLES} samples (waypoints are no motion)"
        name = f"{source} ({odd})" if odd else source
        raise InputError(name, raw.time.size, expected)
    _check_sizes(raw, origin)
    _check_order(raw.time, origin)
    _check_radians(raw, parameters, origin)

    samples, warnings = _distinct_samples(raw.time, origin)
    _check_enough(raw, samples, origin)

    joints = parameters.joints[: len(raw.joints)]
    position = raw.position.copy()
    for k, limits in enumerate(joints[:4]):
        unwrapped, wraps = _unwrapped(raw.time[samples], position[samples, k], limits)
        position[samples, k] = unwrapped
        text = f"{limits.name} goes on by a full turn, unwrapped"
        warnings += _warning("wrapped", samples[wraps], limits.name, text, origin)

    samples, spikes = _without_spikes(raw.time, position, samples, joints, origin)
    samples, drop_outs = _without_drop_outs(raw.time, position, samples, joints, origin)
    warnings += spikes + drop_outs
    _check_enough(raw, samples, origin)

    time = raw.time[samples]
    position = position[samples]
    warnings += _gap_warnings(time, samples, origin)
    for k, limits in enumerate(joints):
        warnings += _joint_warnings(time, position[:, k], limits, samples, origin)

    return replace(
        raw,
        time=frozen(time),
        position=frozen(position),
        velocity=None if raw.velocity is None else frozen(raw.velocity[samples]),
        effort=None if raw.effort is None else frozen(raw.effort[samples]),
        current=None if raw.current is None else frozen(raw.current[samples]),
        warnings=(*raw.warnings, *warnings),
    )


def _check_enough(raw: Motion, samples: NDArray[np.intp], origin: Origin) -> None:
    """Refuse a motion of which too few samples are left."""
    if samples.size < MINIMUM_SAMPLES:
        expected = f"at least {MINIMUM_SAMPLES} samples with different times"
        raise origin.error(0, None, raw.time[0], expected)


def _unwrapped(
    time: FloatArray, angle: FloatArray, limits: JointRange
) -> tuple[FloatArray, NDArray[np.intp]]:
    """Angles that go on where they start again by a full turn, and where they did.

    Only steps that the joint cannot take, but without their full turns can, count. If
    there are any, all angles are shifted by the full turns that bring most of them
    into the joint's range.

    Args:
        time, angle: (N,) [s]; [rad].
        limits: The joint's range and rated speed.
    """
    steps = np.diff(angle)
    turns = np.round(steps / _TURN)
    rest = np.abs(steps - _TURN * turns)
    wraps = (
        jumps(time, angle, limits) & (turns != 0) & (rest <= _possible(time, limits))
    )
    if not wraps.any():
        return angle, np.flatnonzero(wraps)
    unwrapped = angle - _TURN * np.cumsum(np.concatenate([[0.0], turns * wraps]))

    first = round(
        ((limits.lower + limits.upper) / 2 - float(np.median(unwrapped))) / _TURN
    )
    shifts = sorted(range(first - 1, first + 2), key=abs)
    inside = [
        np.count_nonzero(
            (unwrapped + _TURN * shift >= limits.lower)
            & (unwrapped + _TURN * shift <= limits.upper)
        )
        for shift in shifts
    ]
    return unwrapped + _TURN * shifts[int(np.argmax(inside))], np.flatnonzero(wraps) + 1


def _without_spikes(
    time: FloatArray,
    position: FloatArray,
    samples: NDArray[np.intp],
    joints: Sequence[JointRange],
    origin: Origin,
) -> tuple[NDArray[np.intp], list[MotionWarning]]:
    """The samples without those that leave and return faster than the joint can.

    Args:
        time: (M,) [s] Of all samples.
        position: (M, n) [rad], jaw rod [m].
        samples: Those that are left, (N,).
        joints: Ranges and rated speeds.
        origin: Where the samples come from.
    """
    is_spike = np.zeros((samples.size, len(joints)), dtype=bool)
    t = time[samples]
    for k, limits in enumerate(joints):
        q = position[samples, k]
        too_far = np.abs(np.diff(q)) > (
            2 * limits.velocity * np.diff(t)
            + SPIKE_SHARE * (limits.upper - limits.lower)
        )
        for length in range(1, _LONGEST_SPIKE + 1):
            if samples.size < length + 2:
                continue
            # From the sample before a spike to the one behind it.
            across = np.abs(q[length + 1 :] - q[: -length - 1])
            out = np.abs(np.diff(q))[: across.size]
            back = too_far[: across.size] & too_far[length:]
            starts = np.flatnonzero(back & (across < out / 4))
            for shift in range(length):
                is_spike[starts + 1 + shift, k] = True

    spikes = is_spike.any(axis=1)
    if np.count_nonzero(spikes) > max(1, samples.size // _SAMPLES_FOR_A_SPIKE):
        return samples, []  # it is no single sample; the jumps are named
    warnings = []
    for k, limits in enumerate(joints):
        text = f"{limits.name} jumps and returns, sample left out as a spike"
        warnings += _warning(
            "spike", samples[is_spike[:, k]], limits.name, text, origin
        )
    return samples[~spikes], warnings


def _without_drop_outs(
    time: FloatArray,
    position: FloatArray,
    samples: NDArray[np.intp],
    joints: Sequence[JointRange],
    origin: Origin,
) -> tuple[NDArray[np.intp], list[MotionWarning]]:
    """The samples without those that repeat the last values until a jump.

    A driver without connection repeats them. An arm that was at rest before it jumps
    may have been there. The arguments are those of
    `_without_spikes`.
    """
    t = time[samples]
    q = position[samples]
    jump = np.zeros(samples.size - 1, dtype=bool)
    for k, limits in enumerate(joints):
        jump |= jumps(t, q[:, k], limits)
    moved = np.flatnonzero((np.diff(q, axis=0) != 0.0).any(axis=1))
    slow = _MOVING_SHARE * _MOVING_TIME * np.array([each.velocity for each in joints])
    left = np.ones(samples.size, dtype=bool)
    dropped: list[int] = []
    for end in np.flatnonzero(jump).tolist():
        # The last step before the jump with any change leads to the held sample.
        before = int(np.searchsorted(moved, end))
        if not before:
            continue
        start = int(moved[before - 1]) + 1
        earlier = int(np.searchsorted(t, t[start] - _MOVING_TIME))
        was_moving = (np.abs(q[start] - q[earlier]) > slow).any()
        if was_moving and t[end] - t[start] > HOLD:
            left[start + 1 : end + 1] = False
            dropped.append(start + 1)
    if not dropped:
        return samples, []
    longest = max(
        float(t[end] - t[start - 1])
        for start, end in zip(dropped, _ends(left, dropped), strict=True)
    )
    warning = MotionWarning(
        kind="drop_out",
        count=len(dropped),
        first=origin.place(int(samples[dropped[0]]), None),
        text=(
            f"all joints hold their values for up to {longest:.3g} s and then jump: a "
            "drop-out, left out"
        ),
    )
    return samples[left], [warning]


def _ends(left: BoolArray, starts: list[int]) -> list[int]:
    """Where the samples that are left out from each start end."""
    kept = np.flatnonzero(left)
    return [int(kept[np.searchsorted(kept, start)]) for start in starts]


def _known(recorded: FloatArray | None) -> FloatArray | None:
    """Efforts or currents with NaN for what is not finite; None if nothing is."""
    if recorded is None:
        return None
    known = np.isfinite(recorded)
    return np.where(known, recorded, np.nan) if known.any() else None


def _check_sizes(motion: Motion, origin: Origin) -> None:
    """Refuse numbers that are too large to compute with."""
    too_late = np.abs(motion.time) > _LARGEST_TIME
    if too_late.any():
        sample = int(np.argmax(too_late))
        expected = f"a time of at most {_LARGEST_TIME:g} in size"
        raise origin.error(sample, None, motion.time[sample], expected)

    quantities = {
        "position": motion.position,
        "velocity": motion.velocity,
        "recorded effort": motion.effort,
        "recorded current": motion.current,
    }
    for name, values in quantities.items():
        if values is None:
            continue
        too_large = np.argwhere(np.abs(values) > _LARGEST)
        if too_large.size:
            sample, k = too_large[0].tolist()
            expected = f"a {name} of at most {_LARGEST:g} in size"
            raise origin.error(sample, motion.joints[k], values[sample, k], expected)


def _check_order(time: FloatArray, origin: Origin) -> None:
    """Refuse time that runs back."""
    runs_back = np.diff(time) < 0
    if runs_back.any():
        sample = int(np.argmax(runs_back)) + 1
        before = _exact(time[sample - 1])
        expected = (
            f"a time of at least {before} s, got {_exact(time[sample])} s: time runs "
            "back (a clock that was set back?); cut the recording there"
        )
        raise origin.error(sample, None, time[sample], expected)


def _exact(time: float) -> str:
    """A time with all its digits."""
    return format(float(time), ".16g")


def _check_radians(
    motion: Motion, parameters: Alpha5Parameters, origin: Origin
) -> None:
    """Refuse angles in degrees.

    They are if most samples of a joint are far off as radians, and most of each joint
    are within its range as degrees. A few outliers are none.
    """
    suspect: tuple[int, str] | None = None
    for k, limits in enumerate(parameters.joints[:4]):
        angle = motion.position[:, k]
        slack = _DEGREES_SLACK * (limits.upper - limits.lower)
        in_degrees = np.abs(np.radians(angle) - (limits.lower + limits.upper) / 2)
        within = in_degrees <= (limits.upper - limits.lower) / 2 + slack
        if np.mean(within) <= 0.5:
            return
        far = np.abs(angle) > _FAR * limits.upper
        if suspect is None and np.mean(far) > 0.5:
            suspect = int(np.argmax(far)), limits.name

    if suspect is not None:
        sample, joint = suspect
        value = float(motion.position[sample, motion.joints.index(joint)])
        expected = f"radians, and {value:.6g} is an angle of {joint} in degrees"
        raise origin.error(sample, joint, value, f"{expected}; {origin.to_radians}")


def _distinct_samples(
    time: FloatArray, origin: Origin
) -> tuple[NDArray[np.intp], list[MotionWarning]]:
    """The samples with different times, and a warning about the dropped ones."""
    distinct = np.concatenate([[True], np.diff(time) >= _SAME_TIME])
    warnings = _warning(
        "repeated_time",
        np.flatnonzero(~distinct),
        None,
        "time repeated, sample dropped",
        origin,
    )
    return np.flatnonzero(distinct), warnings


def _gap_warnings(
    time: FloatArray, samples: NDArray[np.intp], origin: Origin
) -> list[MotionWarning]:
    """A warning about gaps, if there are any."""
    steps = np.diff(time)
    longest = GAP_FACTOR * float(np.median(steps))
    text = f"more than {longest:.3g} s without a sample, bridged"
    return _warning("gap", samples[1:][steps > longest], None, text, origin)


def _joint_warnings(
    time: FloatArray,
    position: FloatArray,
    limits: JointRange,
    samples: NDArray[np.intp],
    origin: Origin,
) -> list[MotionWarning]:
    """Warnings about the positions of a joint.

    Args:
        time, position: (N,) [s]; [rad], jaw rod [m].
        limits: The joint's range and rated speed.
        samples: Numbers of the samples in the file or arrays, (N,).
        origin: Where the samples come from.
    """
    name = limits.name
    too_far = (
        f"{name} jumps farther than it can move; both sides are smoothed on their own"
    )
    jump = samples[1:][jumps(time, position, limits)]

    slack = LIMIT_SLACK * (limits.upper - limits.lower)
    below = position < limits.lower - slack
    above = position > limits.upper + slack
    outside = samples[below | above]
    return [
        *_warning("jump", jump, name, too_far, origin),
        *_warning(
            "outside_limits", outside, name, _outside_text(position, limits), origin
        ),
    ]


def jumps(time: FloatArray, position: FloatArray, limits: JointRange) -> BoolArray:
    """Which steps of a joint are longer than it can move in their time, (N - 1,)."""
    return np.asarray(np.abs(np.diff(position)) > _possible(time, limits))


def _possible(time: FloatArray, limits: JointRange) -> FloatArray:
    """How far a joint may move in each step, (N - 1,) [rad], jaw rod [m].

    Drivers hold a value for up to `HOLD`.
    """
    return np.asarray(2 * limits.velocity * (np.diff(time) + HOLD))


def _outside_text(position: FloatArray, limits: JointRange) -> str:
    """The warning about positions outside the range of a joint."""
    name = limits.name
    unit = "m" if name == "axis_a" else "rad"
    text = f"{name} outside its range {limits.lower:.6g} to {limits.upper:.6g} {unit}"
    if np.abs(position).max() > _FAR * limits.upper:
        likely = "mm" if unit == "m" else "degrees"
        text += f" (is it in {likely}?)"
    return text


def _warning(
    kind: str,
    samples: NDArray[np.intp],
    joint: str | None,
    text: str,
    origin: Origin,
) -> list[MotionWarning]:
    """One warning about some samples; none if there are no samples."""
    if not samples.size:
        return []
    warning = MotionWarning(
        kind=kind,
        count=int(samples.size),
        first=origin.place(int(samples[0]), joint),
        text=text,
        joint=joint,
    )
    return [warning]
