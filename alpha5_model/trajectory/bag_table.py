"""Joint motion from ROS bags: the joint states of one topic as columns."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model._support.files import PathLike
from alpha5_model.trajectory.bag_messages import (
    Message,
    Selection,
    joint_states,
    select,
)
from alpha5_model.trajectory.file_table import FileTable, Progress, seconds
from alpha5_model.trajectory.warning import MotionWarning

_IntArray = NDArray[np.int64]
#: Stamps below this are simulated times, which start at zero [ns].
_SIMULATED = 10**11
#: Quantities of a joint in a message, and the endings of their columns.
_POSITION, _VELOCITY, _EFFORT = range(3)
_ENDINGS = {_POSITION: "", _VELOCITY: "_vel", _EFFORT: "_effort"}


class BagTable(FileTable):
    """The joint states of one topic of a bag, columns named by the joints.

    Messages of the topic count from 1, in the order of the bag; see `read_motion`.

    Attributes:
        prefix: What stands before the joints' names in the bag.
    """

    header: list[str]

    def __init__(
        self,
        path: PathLike,
        topic: str | None,
        prefix: str | None,
        progress: Progress | None,
    ) -> None:
        messages = joint_states(path, topic, progress)
        chosen = select(path, messages, prefix)
        stream = messages[chosen.topic]

        found = _samples(stream, chosen.joints)
        time = _time(found)
        order = np.argsort(time, kind="stable")
        in_order = _without_missing_rod(found.rows(order))
        whole = _all_finite(in_order.values[:, _POSITION])
        samples = in_order.rows(whole)
        samples_time = time[order][whole]

        self.prefix = chosen.prefix
        self._topic = chosen.topic
        self._numbers = samples.number
        self.warnings = _warnings(stream, chosen, found, in_order, samples)
        self.ignored = _other_names(stream, samples.joints)

        self.header = ["time"]
        columns = [seconds(samples_time.tolist(), 10**9)]
        for k in _quantities(samples):
            self.header += [joint + _ENDINGS[k] for joint in samples.joints]
            columns.append(samples.values[:, k])
        self._columns = np.column_stack(columns)

    def read(self, needed: list[int], efforts: list[int]) -> tuple[FloatArray, str]:
        """The numbers of some columns; see `FileTable.read`."""
        return self._columns[:, [*needed, *efforts]], "s"

    def place(self, row: int, column: int) -> str:
        """Where a number is in the bag, for messages."""
        message = f"message {self._numbers[row]} of {self._topic}"
        return f"{message} ({self.header[column]})" if column else message


class _Samples(NamedTuple):
    """Messages that have a position of each joint of the arm.

    Attributes:
        joints: Names of the n joints in the messages.
        number: (N,) Which message of the topic it is.
        received: (N,) When it was recorded [ns].
        stamp: (N,) The time it states, 0 if none [ns].
        values: (N, 3, n) Positions, velocities and efforts, NaN if it has none.
    """

    joints: list[str]
    number: _IntArray
    received: _IntArray
    stamp: _IntArray
    values: FloatArray

    def rows(self, which: NDArray[Any]) -> _Samples:
        """Some of the messages, by their places or by a mask."""
        return self._replace(
            number=self.number[which],
            received=self.received[which],
            stamp=self.stamp[which],
            values=self.values[which],
        )


def _samples(stream: list[Message], joints: list[str]) -> _Samples:
    """The messages that have a position of each joint, in the order of the bag."""
    wanted = {*joints}
    missing = [np.nan] * len(joints)
    rows = []
    values = []
    for number, message in enumerate(stream, start=1):
        content = message.content
        count = len(content.name)
        if len(content.position) != count or not wanted <= {*content.name}:
            continue
        at = [content.name.index(name) for name in joints]
        fields = (content.position, content.velocity, content.effort)
        values.append([x[at] if len(x) == count else missing for x in fields])
        rows.append((number, message.received, message.stamp))

    number_column, received, stamp = np.array(rows, dtype=np.int64).reshape(-1, 3).T
    return _Samples(
        joints=joints,
        number=number_column,
        received=received,
        stamp=stamp,
        values=np.array(values).reshape(-1, 3, len(joints)),
    )


def _unstamped(samples: _Samples) -> _IntArray:
    """The messages that state no time."""
    numbers: _IntArray = samples.number[samples.stamp == 0]
    simulated = np.count_nonzero(samples.stamp < _SIMULATED)
    if numbers.size == 1 and simulated > 1:
        return numbers[:0]  # simulated time starts at zero
    return numbers


def _time(samples: _Samples) -> _IntArray:
    """Times of the messages [ns]: their stamps, if all of them have one."""
    return samples.received if _unstamped(samples).size else samples.stamp


def _without_missing_rod(samples: _Samples) -> _Samples:
    """The samples without the jaw rod, if it is the one joint that has no positions."""
    unknown = np.isnan(samples.values[:, _POSITION]).all(axis=0)
    if unknown.tolist() != [False, False, False, False, True]:
        return samples
    return samples._replace(joints=samples.joints[:4], values=samples.values[..., :4])


def _without_velocity(samples: _Samples) -> _IntArray:
    """The messages that lack a velocity of some joint."""
    known = _all_finite(samples.values[:, _VELOCITY])
    return samples.number[~known]


def _all_finite(values: FloatArray) -> BoolArray:
    """Which rows (N, n) hold only finite numbers, (N,)."""
    return np.asarray(np.isfinite(values).all(axis=1))


def _quantities(samples: _Samples) -> list[int]:
    """What the columns are: velocities only if each message has them."""
    if _without_velocity(samples).size:
        return [_POSITION, _EFFORT]
    return [_POSITION, _VELOCITY, _EFFORT]


def _other_names(stream: list[Message], joints: list[str]) -> tuple[str, ...]:
    """The names in the messages that are not the arm's joints, sorted."""
    names = {name for message in stream for name in message.content.name}
    return tuple(sorted(names - {*joints}))


def _warnings(
    stream: list[Message],
    chosen: Selection,
    found: _Samples,
    in_order: _Samples,
    samples: _Samples,
) -> tuple[MotionWarning, ...]:
    """What is odd in the messages of a topic.

    Args:
        stream: All messages of the topic.
        chosen: The topic and the arm's joints.
        found: The messages that have a position of each joint, in the order of the bag.
        in_order: The same in the order of time.
        samples: Those of them whose positions are all finite.
    """
    partial = np.setdiff1d(range(1, len(stream) + 1), found.number)
    not_finite = np.setdiff1d(in_order.number, samples.number, assume_unique=True)
    runs_back = found.number[1:][np.diff(_time(found)) < 0]
    publishers = _publishers(stream, found)
    slow = _without_velocity(samples)
    some_velocities = slow.size < samples.number.size

    odd: list[tuple[str, Sequence[int] | _IntArray, str]] = [
        (
            "missing_joints",
            partial,
            f"no position of each of {', '.join(samples.joints)}, message left out",
        ),
        (
            "not_finite",
            not_finite,
            "positions that are not finite, message left out",
        ),
        (
            "no_stamp",
            _unstamped(found),
            "no stamp; all times are those of recording",
        ),
        (
            "out_of_order",
            runs_back,
            "time runs back, messages sorted",
        ),
        (
            "publishers",
            [*publishers.values()][1:],
            f"publishers: {', '.join(sorted(publishers))}",
        ),
        (
            "velocity",
            slow if some_velocities else [],
            "no velocities, so none is used",
        ),
    ]
    return tuple(
        MotionWarning(
            kind=kind,
            count=len(numbers),
            first=f"message {min(numbers)} of {chosen.topic}",
            text=text,
        )
        for kind, numbers, text in odd
        if len(numbers)
    )


def _publishers(stream: list[Message], samples: _Samples) -> dict[str, int]:
    """Who sent the messages, and the first one of each."""
    first: dict[str, int] = {}
    for number in samples.number.tolist():
        first.setdefault(stream[number - 1].publisher, number)
    return first
