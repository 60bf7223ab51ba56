"""Joint motion from ROS bags: the joint states of one topic as columns."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model._support.files import PathLike
from alpha5_model.errors import FileFormatError
from alpha5_model.trajectory.bag_messages import (
    Message,
    Selection,
    joint_states,
    select,
)
from alpha5_model.trajectory.file_table import FileTable, Problem, Progress, seconds
from alpha5_model.trajectory.joint_map import JointMap
from alpha5_model.trajectory.mcap_messages import is_other_mcap, mcap_joint_states
from alpha5_model.trajectory.warning import MotionWarning

_IntArray = NDArray[np.int64]
#: A message of a topic and its number, from 1.
_Numbered = tuple[int, Message]
#: Stamps below this are simulated times, which start at zero [ns].
_SIMULATED = 10**11
#: Messages that may be late in a row.
_MOST_LATE = 3


class BagTable(FileTable):
    """The joint states of one topic of a bag, columns named by the joints.

    Messages of the topic count from 1, in the order of the bag; see `read_motion`.

    Attributes:
        prefix: The prefix of the joints' names in the bag.
    """

    def __init__(
        self,
        path: PathLike,
        topic: str | None,
        prefix: str | None,
        joints: JointMap,
        progress: Progress | None,
    ) -> None:
        if is_other_mcap(path):
            streams = mcap_joint_states(path, topic)
        else:
            streams = joint_states(path, topic, progress)
        _rename(streams, joints)
        chosen = select(path, streams, prefix)
        stream = streams[chosen.topic]
        complete = _complete(stream, chosen)
        recorded = _samples(complete, chosen.joints)
        _refuse_clock_set_back(path, chosen.topic, recorded)
        in_order = recorded.take(np.argsort(recorded.time, kind="stable"))
        with_known_joints = _without_missing_rod(in_order)
        finite = np.isfinite(with_known_joints.position)
        usable = finite.any(axis=1) if chosen.polled else finite.all(axis=1)
        samples = with_known_joints.take(np.asarray(usable))

        self.prefix = chosen.prefix
        self.ignored = _other_names(stream, samples.joints)
        self.warnings = _warnings(chosen.topic, stream, complete, recorded, samples)
        self._topic = chosen.topic
        self._message_numbers = samples.number

        quantities = {"": samples.position, "_vel": samples.velocity}
        if samples.without_velocity().size:
            del quantities["_vel"]
        quantities["_effort"] = samples.effort
        names = [joint + ending for ending in quantities for joint in samples.joints]
        time = seconds(samples.time.tolist(), 10**9)
        self.names = ["time", *names]
        self.header = self.names
        self._columns = np.column_stack([time, *quantities.values()])

    def read(self, columns: Sequence[int]) -> tuple[FloatArray, str]:
        """The numbers of some columns; see `FileTable.read`."""
        return self._columns[:, [*columns]], "s"

    def problem(self, row: int, columns: Sequence[int]) -> Problem:
        """Why a number of a message cannot be used; see `FileTable.problem`."""
        numbers = self._columns[row, [*columns]]
        wrong = int(np.argmin(np.isfinite(numbers)))
        text = f"expected a finite number, got {numbers[wrong]:g}"
        return Problem(self.place(row, columns[wrong]), text)

    def place(self, row: int, column: int) -> str:
        """Where a number is in the bag, for messages."""
        message = f"message {self._message_numbers[row]} of {self._topic}"
        return f"{message} ({self.header[column]})" if column else message


def _rename(streams: dict[str, list[Message]], joints: JointMap) -> None:
    """Give the joints in the messages the arm's names.

    Raises:
        InputError: A name that no message has.
    """
    messages = [message for stream in streams.values() for message in stream]
    names = dict.fromkeys(name for m in messages for name in m.content.name)
    ours = dict(zip(names, joints.renamed(names), strict=True))
    for message in messages:
        message.content.name = [ours[name] for name in message.content.name]


class _Samples(NamedTuple):
    """The arm's joint states in the messages of a topic.

    Attributes:
        joints: Names of the n joints in the messages.
        number: (N,) Which message of the topic it is.
        time: (N,) [ns].
        position, velocity, effort: (N, n); NaN for what a message does not have.
        publishers: How many nodes sent them.
    """

    joints: list[str]
    number: _IntArray
    time: _IntArray
    position: FloatArray
    velocity: FloatArray
    effort: FloatArray
    publishers: int = 1

    def take(self, which: NDArray[Any]) -> _Samples:
        """Some of the samples, by their places or by a mask."""
        return _Samples(
            joints=self.joints,
            number=self.number[which],
            time=self.time[which],
            position=self.position[which],
            velocity=self.velocity[which],
            effort=self.effort[which],
            publishers=self.publishers,
        )

    def without_velocity(self) -> _IntArray:
        """The messages that lack a velocity of some joint."""
        return self.number[~_all_finite(self.velocity)]


def _complete(stream: list[Message], chosen: Selection) -> list[_Numbered]:
    """The messages that have a position of each joint, or of any if they are polled."""
    wanted = {*chosen.joints}
    complete = []
    for number, message in enumerate(stream, start=1):
        names = {*message.content.name}
        has_joints = bool(wanted & names) if chosen.polled else wanted <= names
        positions = len(message.content.position)
        if has_joints and positions == len(message.content.name):
            complete.append((number, message))
    return complete


def _refuse_clock_set_back(path: PathLike, topic: str, recorded: _Samples) -> None:
    """Refuse a bag whose clock was set back: sorted, it would mix two motions.

    A message that was late fits into a hole between the others, and few are late in a
    row.

    Raises:
        FileFormatError: Many messages in a row state earlier times than one before
            them, or messages of one publisher do not fit between the others.
    """
    time = recorded.time
    if time.size < _MOST_LATE:
        return
    latest = np.maximum.accumulate(time)
    late = np.flatnonzero(time < latest)
    if not late.size:
        return
    breaks = np.flatnonzero(np.diff(late) != 1) + 1
    longest = max(np.split(late, breaks), key=len)
    in_order = np.sort(time)
    typical = float(np.median(np.diff(in_order)))
    place = np.searchsorted(in_order, time[late])
    before = in_order[place] - in_order[np.maximum(place - 1, 0)]
    behind = in_order[np.minimum(place + 1, time.size - 1)] - in_order[place]
    crowded = np.minimum(before, behind) < typical / 2
    first: int | None = None
    if longest.size > _MOST_LATE:
        first = int(longest[0])
    elif recorded.publishers == 1 and crowded.any():
        first = int(late[np.argmax(crowded)])
    if first is None:
        return
    stamp = int(time[first]) / 10**9
    back = (int(latest[first]) - int(time[first])) / 10**9
    problem = (
        f"time runs back by {back:.9g} s, to {stamp:.16g} s (a clock that was set "
        "back?); cut the bag there"
    )
    place_of = f"message {recorded.number[first]} of {topic}"
    raise FileFormatError(path, problem, place_of)


def _samples(complete: list[_Numbered], joints: list[str]) -> _Samples:
    """The positions, velocities and efforts of the joints in the order of the bag.

    Times are the stamps of the messages, or those of recording if some have no stamp.
    """
    by_stamp = not _unstamped(complete)
    times = [m.stamp if by_stamp else m.received for _, m in complete]
    missing = [np.nan] * len(joints)
    positions = []
    velocities = []
    efforts = []
    for _, message in complete:
        content = message.content
        place_of = {name: k for k, name in enumerate(content.name)}
        at = [place_of.get(joint, -1) for joint in joints]
        # The last number stands for joints that the message does not have.
        count = len(content.name)
        has_velocity = len(content.velocity) == count
        has_effort = len(content.effort) == count
        positions.append(np.append(content.position, np.nan)[at])
        velocities.append(
            np.append(content.velocity, np.nan)[at] if has_velocity else missing
        )
        efforts.append(np.append(content.effort, np.nan)[at] if has_effort else missing)

    shape = (len(complete), len(joints))
    return _Samples(
        joints=joints,
        number=np.array([number for number, _ in complete], dtype=np.int64),
        time=np.array(times, dtype=np.int64),
        position=np.array(positions, dtype=float).reshape(shape),
        velocity=np.array(velocities, dtype=float).reshape(shape),
        effort=np.array(efforts, dtype=float).reshape(shape),
        publishers=len({message.publisher for _, message in complete}),
    )


def _unstamped(complete: list[_Numbered]) -> list[int]:
    """The messages that state no time."""
    unstamped = [number for number, message in complete if message.stamp == 0]
    simulated = [number for number, message in complete if message.stamp < _SIMULATED]
    if len(unstamped) == 1 and len(simulated) > 1:
        return []  # simulated time starts at zero
    return unstamped


def _without_missing_rod(samples: _Samples) -> _Samples:
    """The samples without the jaw rod, if it is the one joint that has no positions."""
    unknown = np.isnan(samples.position).all(axis=0)
    if unknown.tolist() != [False, False, False, False, True]:
        return samples
    return samples._replace(
        joints=samples.joints[:4],
        position=samples.position[:, :4],
        velocity=samples.velocity[:, :4],
        effort=samples.effort[:, :4],
    )


def _all_finite(values: FloatArray) -> BoolArray:
    """Which rows (N, n) hold only finite numbers, (N,)."""
    return np.asarray(np.isfinite(values).all(axis=1))


def _other_names(stream: list[Message], joints: list[str]) -> tuple[str, ...]:
    """The names in the messages that are not the arm's joints, sorted."""
    names = {name for message in stream for name in message.content.name}
    return tuple(sorted(names - {*joints}))


def _warnings(
    topic: str,
    stream: list[Message],
    complete: list[_Numbered],
    recorded: _Samples,
    samples: _Samples,
) -> tuple[MotionWarning, ...]:
    """Warnings about the messages of a topic.

    Args:
        topic: Its name.
        stream: All its messages.
        complete: Those that have a position of each joint.
        recorded: The same as samples, in the order of the bag.
        samples: Those of them whose positions are finite, in the order of time.
    """
    partial = np.setdiff1d(range(1, len(stream) + 1), recorded.number)
    not_finite = np.setdiff1d(recorded.number, samples.number)
    runs_back = recorded.number[1:][np.diff(recorded.time) < 0]
    first_messages = _first_messages(complete)
    slow = samples.without_velocity()
    some_have_velocity = slow.size < samples.number.size

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
            _unstamped(complete),
            "no stamp; all times are those of recording",
        ),
        (
            "out_of_order",
            runs_back,
            "time runs back, messages sorted",
        ),
        (
            "publishers",
            [*first_messages.values()][1:],
            f"publishers: {', '.join(sorted(first_messages))}",
        ),
        (
            "velocity",
            slow if some_have_velocity else [],
            "no velocities, so none is used",
        ),
    ]
    return tuple(
        MotionWarning(
            kind=kind,
            count=len(numbers),
            first=f"message {min(numbers)} of {topic}",
            text=text,
        )
        for kind, numbers, text in odd
        if len(numbers)
    )


def _first_messages(complete: list[_Numbered]) -> dict[str, int]:
    """Publisher -> its first message."""
    first: dict[str, int] = {}
    for number, message in complete:
        first.setdefault(message.publisher, number)
    return first
