"""The joint states in a ROS bag, and which of them are the arm's."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from alpha5_model._support.checks import FloatArray, choice
from alpha5_model._support.files import PathLike
from alpha5_model.errors import FileFormatError, MissingFileError
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.trajectory.bag_limits import Budget, limited
from alpha5_model.trajectory.file_table import CHUNK, Progress, library
from alpha5_model.trajectory.names import only_choice, prefixes
from alpha5_model.trajectory.text_table import refuse_git_lfs_pointer

_JOINT_STATE = "sensor_msgs/msg/JointState"


class JointState(Protocol):
    """A ``sensor_msgs/JointState``; fields that are not known are empty."""

    header: Any
    name: list[str]
    position: FloatArray
    velocity: FloatArray
    effort: FloatArray


class Message(NamedTuple):
    """A joint state as recorded.

    Attributes:
        publisher: Name of the node that sent it, or the connection's number.
        received: When it was recorded [ns].
        stamp: The time it states [ns]; 0 if it states none.
        content: The joint state.
    """

    publisher: str
    received: int
    stamp: int
    content: JointState


class Selection(NamedTuple):
    """Which joint states of a bag are the arm's.

    Attributes:
        topic: The topic.
        prefix: The prefix of the joints' names.
        joints: Names of the arm's joints in the messages, prefix included, base to tip.
        polled: Whether no message has all of them, but several together.
    """

    topic: str
    prefix: str
    joints: list[str]
    polled: bool = False


def joint_states(
    path: PathLike, topic: str | None, progress: Progress | None
) -> dict[str, list[Message]]:
    """All joint states of a bag by topic, or those of one topic.

    Raises:
        MissingFileError: No such file.
        MissingDependencyError: rosbags is not installed.
        UnknownNameError: No joint states have this topic.
        FileFormatError: A damaged bag, or one without joint states.
    """
    file = Path(path)
    with library(path, "bags"):
        from rosbags import rosbag1, rosbag2
        from rosbags.typesys import Stores, get_typestore

        if not file.exists():
            raise MissingFileError(path, "a ROS bag")
        for part in _files(file):
            with part.open("rb") as stream:
                refuse_git_lfs_pointer(part, stream.read(100))

        # The message is the same in every release: the definitions in the bag are not
        # needed.
        reader: Callable[[Path], Any]
        decode: Callable[[bytes, str], Any]
        if file.suffix.lower() == ".bag":
            reader = rosbag1.Reader
            decode = get_typestore(Stores.ROS1_NOETIC).deserialize_ros1
        else:
            reader = rosbag2.Reader
            decode = get_typestore(Stores.LATEST).deserialize_cdr

        with limited(path) as budget, reader(file) as bag:
            connections = _connections(path, bag, topic)
            messages = _messages(bag, connections, decode, budget, progress)

    if progress:
        progress("read", 1.0)
    return messages


def _files(bag: Path) -> list[Path]:
    """The files of a bag: one, or those of its folder."""
    files = [bag] if bag.is_file() else sorted(bag.iterdir())
    return [file for file in files if file.is_file()]


def _connections(path: PathLike, bag: Any, topic: str | None) -> list[Any]:
    """The connections of a bag that carry joint states, of one topic if it is given."""
    found = [c for c in bag.connections if c.msgtype == _JOINT_STATE]
    if not found:
        others = sorted(f"{c.topic} ({c.msgtype})" for c in bag.connections)
        got = ", ".join(others) or "nothing"
        raise FileFormatError(path, f"no sensor_msgs/JointState, but {got}")
    if topic is None:
        return found

    choice("topic", topic, sorted({c.topic for c in found}))
    return [c for c in found if c.topic == topic]


def _messages(
    bag: Any,
    connections: list[Any],
    decode: Callable[[bytes, str], Any],
    budget: Budget,
    progress: Progress | None,
) -> dict[str, list[Message]]:
    """The messages of some connections by topic, in the order of the bag."""
    messages: dict[str, list[Message]] = {}
    total = sum(c.msgcount for c in connections)
    for count, (c, received, raw) in enumerate(bag.messages(connections), start=1):
        budget.take(len(raw))
        content: JointState = decode(raw, _JOINT_STATE)
        stamp = content.header.stamp
        message = Message(
            publisher=getattr(c.ext, "callerid", None) or f"connection {c.id}",
            received=received,
            stamp=stamp.sec * 10**9 + stamp.nanosec,
            content=content,
        )
        messages.setdefault(c.topic, []).append(message)
        if progress and count % CHUNK == 0:
            progress("read", count / max(total, count))
    return messages


def select(
    path: PathLike, messages: dict[str, list[Message]], wanted_prefix: str | None
) -> Selection:
    """The only topic of the arm's joints, their only prefix, and their names.

    If the messages of the topic have different names, the most frequent set of names
    decides which joints there are.

    Args:
        path: Of the bag, for messages.
        messages: All joint states by topic.
        wanted_prefix: The prefix of the joints that the caller gave; None if none.

    Raises:
        InputError: Several topics or prefixes to choose from.
        FileFormatError: No message has the joints of an arm.
    """
    counts = _counts_by_names(messages)
    found = _arms(counts, wanted_prefix)
    polled = not found
    if polled:
        together: Counter[tuple[str, tuple[str, ...]]] = Counter()
        for topic, stream in messages.items():
            names = dict.fromkeys(name for m in stream for name in m.content.name)
            together[topic, tuple(names)] = len(stream)
        found = _arms(together, wanted_prefix)
    if not found:
        raise _no_arm(path, list(counts), wanted_prefix)

    topic = only_choice("topic", {topic for topic, _, _ in found})
    prefix = only_choice("prefix", {prefix for t, _, prefix in found if t == topic})

    candidates = {
        names: count
        for (t, names, p), count in found.items()
        if (t, p) == (topic, prefix)
    }
    most_frequent = max(candidates, key=candidates.__getitem__)
    wanted = [prefix + joint for joint in JOINT_NAMES]
    return Selection(
        topic=topic,
        prefix=prefix,
        joints=[name for name in wanted if name in most_frequent],
        polled=polled,
    )


def _arms(
    counts: Mapping[tuple[str, tuple[str, ...]], int], wanted_prefix: str | None
) -> dict[tuple[str, tuple[str, ...], str], int]:
    """Topic, names and prefix of each complete arm, and how many messages have it."""
    return {
        (topic, names, prefix): count
        for (topic, names), count in counts.items()
        for prefix in prefixes(names, wanted_prefix=wanted_prefix)
    }


def _counts_by_names(
    messages: dict[str, list[Message]],
) -> Counter[tuple[str, tuple[str, ...]]]:
    """How many messages of a topic have the same names of joints."""
    counts: Counter[tuple[str, tuple[str, ...]]] = Counter()
    for topic, stream in messages.items():
        counts.update((topic, tuple(message.content.name)) for message in stream)
    return counts


def _no_arm(
    path: PathLike, named: list[tuple[str, tuple[str, ...]]], wanted_prefix: str | None
) -> FileFormatError:
    """The error about a bag whose messages lack joints of the arm."""
    got = "; ".join(sorted(f"{topic}: {', '.join(names)}" for topic, names in named))
    joints = ", ".join((wanted_prefix or "") + joint for joint in JOINT_NAMES[:4])
    problem = f"no message has all of {joints}, but {got[:400]}"
    return FileFormatError(path, problem)
