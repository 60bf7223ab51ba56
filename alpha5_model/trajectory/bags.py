"""Joint motion from ROS bags: the joint states of one topic as a table."""

from __future__ import annotations

import json
import re
import struct
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any, BinaryIO, NamedTuple

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray, choice
from alpha5_model._support.files import PathLike, read_named
from alpha5_model.errors import FileFormatError, MissingFileError
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.trajectory.column_names import JointMap, arms_in, only_choice
from alpha5_model.trajectory.motions import MotionWarning
from alpha5_model.trajectory.tables import (
    EXPANSION,
    Problem,
    Progress,
    Table,
    library,
    refuse_expansion,
    refuse_git_lfs_pointer,
    seconds,
)

_TYPE = "JointState"
_ROS_TYPE = "sensor_msgs/msg/JointState"
#: Any bag may expand to this size [bytes].
_LEAST_EXPANSION = 1_000_000
#: Largest ``metadata.yaml`` that is read [bytes]; a recorder's is some kilobytes.
_MOST_METADATA = 1_000_000
#: Levels of lists and tables in it; a recorder's has six.
_MOST_LEVELS = 20
#: Stamps below this are simulated times, which start at zero [ns].
_SIMULATED = 10**11
#: Messages that may be late in a row.
_MOST_LATE = 3


class _Message(NamedTuple):
    """A joint state as recorded.

    Attributes:
        publisher: Name of the node that sent it, or the connection's number.
        received: When it was recorded [ns].
        stamp: The time it states [ns]; 0 if it states none.
        names: Of its joints.
        position, velocity, effort: Of the same joints; empty if not known.
    """

    publisher: str
    received: int
    stamp: int
    names: list[str]
    position: FloatArray
    velocity: FloatArray
    effort: FloatArray


def read_bag(
    path: PathLike,
    topic: str | None,
    prefix: str | None,
    joints: JointMap,
    progress: Progress | None,
) -> Table:
    """The joint states of one topic, with the joints' own names as columns.

    Messages of the topic count from 1, in the order of the bag.

    Args:
        path: A ``.bag``, ``.db3`` or ``.mcap`` file, or the folder of a ROS 2 bag.
        topic: Its topic; None for the only one with the arm's joints.
        prefix: Prefix of the joints' names; None for the only one.
        joints: Names of the joints in the messages.
        progress: Called with ``"read"`` and the part done, 0 to 1.

    Raises:
        InputError: Several topics or prefixes to choose from.
        UnknownNameError: No joint states have this topic.
        MissingFileError: No such file.
        MissingDependencyError: rosbags or mcap is not installed.
        FileFormatError: A damaged bag, one without joint states of the arm, or one
            whose clock was set back.
    """
    streams = _streams(path, topic, progress)
    every = dict.fromkeys(
        name for stream in streams.values() for m in stream for name in m.names
    )
    ours = dict(zip(every, joints.renamed(every), strict=True))

    names_of = {
        topic: dict.fromkeys(ours[name] for m in stream for name in m.names)
        for topic, stream in streams.items()
    }
    arms = {topic: arms_in(names, prefix) for topic, names in names_of.items()}
    if not any(arms.values()):
        listed = "; ".join(f"{t}: {', '.join(x)}" for t, x in sorted(names_of.items()))
        wanted = ", ".join((prefix or "") + joint for joint in JOINT_NAMES[:4])
        problem = f"no message has all of {wanted}, but {listed[:400]}"
        raise FileFormatError(path, problem)
    chosen = only_choice("topic", {topic for topic, found in arms.items() if found})
    group = only_choice("prefix", arms[chosen])

    names = [name for name in JOINT_NAMES if group + name in names_of[chosen]]
    place_of = {group + name: k for k, name in enumerate(names)}
    columns = {name: place_of[ours[name]] for name in every if ours[name] in place_of}
    ignored = tuple(sorted(name for name in names_of[chosen] if name not in place_of))
    return _table(path, chosen, streams[chosen], columns, names, ignored)


def _table(
    path: PathLike,
    topic: str,
    stream: list[_Message],
    columns: dict[str, int],
    names: list[str],
    ignored: tuple[str, ...],
) -> Table:
    """The messages of a topic in the order of their times, as a table.

    Args:
        path: Of the bag, for messages.
        topic: Its name.
        stream: Its messages, in the order of the bag.
        columns: Name in the messages -> which joint of the arm it is.
        names: Of the arm's n joints.
        ignored: Names of other joints.
    """
    n = len(names)
    values = np.full((len(stream), 1 + 3 * n), np.nan)
    for row, message in enumerate(stream):
        if len(message.position) != len(message.names):
            continue
        at = [k for k, name in enumerate(message.names) if name in columns]
        joints = [columns[message.names[k]] for k in at]
        parts = (message.position, message.velocity, message.effort)
        for part, numbers in enumerate(parts):
            if len(numbers) == len(message.names):
                values[row, [1 + part * n + k for k in joints]] = numbers[at]
    values[~np.isfinite(values)] = np.nan
    header = ["time"]
    header += [joint + ending for ending in ("", "_vel", "_effort") for joint in names]
    # Quantities that no message has are no columns.
    used = [
        k < 1 + n or bool(np.isfinite(values[:, k]).any()) for k in range(1 + 3 * n)
    ]
    header = [name for name, is_used in zip(header, used, strict=True) if is_used]
    values = values[:, used]

    # Only messages with numbers of the arm decide about its times.
    of_arm = np.flatnonzero(np.isfinite(values[:, 1 : 1 + n]).any(axis=1))
    messages = [stream[row] for row in of_arm]
    unstamped = _unstamped(messages)
    every = [m.received if unstamped else m.stamp for m in stream]
    times = np.array([every[row] for row in of_arm], dtype=np.int64)
    # Publisher of the first joint -> its first message.
    first_of: dict[str, int] = {}
    for row, message in zip(of_arm.tolist(), messages, strict=True):
        if np.isfinite(values[row, 1]):
            first_of.setdefault(message.publisher, row)
    _refuse_clock_set_back(path, topic, times, of_arm, len(first_of))
    values[of_arm, 0] = seconds(times.tolist(), 10**9)
    order = np.argsort(np.array(every, dtype=np.int64), kind="stable")

    odd: list[tuple[str, Sequence[int] | NDArray[np.intp], str]] = [
        ("no_stamp", of_arm[unstamped], "no stamp; all times are those of recording"),
        (
            "out_of_order",
            of_arm[1:][np.diff(times) < 0],
            "time runs back, messages sorted",
        ),
        (
            "publishers",
            [*first_of.values()][1:],
            f"publishers: {', '.join(sorted(first_of))}",
        ),
    ]

    def place(row: int, column: int) -> str:
        message = f"message {order[row] + 1} of {topic}"
        return f"{message} ({header[column]})" if column else message

    def problem(row: int, wanted: Sequence[int]) -> Problem:
        missing = [header[k] for k in wanted if np.isnan(values[order[row], k])]
        return Problem(place(row, 0), f"no position of {', '.join(missing)}")

    return Table(
        header=header,
        values=values[order],
        place=place,
        problem=problem,
        in_seconds=frozenset([0]),
        warnings=tuple(
            MotionWarning(
                kind=kind,
                count=len(rows),
                first=f"message {rows[0] + 1} of {topic}",
                text=text,
            )
            for kind, rows, text in odd
            if len(rows)
        ),
        ignored=ignored,
        every_row=False,
    )


def _unstamped(messages: list[_Message]) -> list[int]:
    """The messages that state no time."""
    unstamped = [k for k, message in enumerate(messages) if message.stamp == 0]
    simulated = [message for message in messages if message.stamp < _SIMULATED]
    if len(unstamped) == 1 and len(simulated) > 1:
        return []  # simulated time starts at zero
    return unstamped


def _refuse_clock_set_back(
    path: PathLike,
    topic: str,
    time: NDArray[np.int64],
    rows: NDArray[np.intp],
    publishers: int,
) -> None:
    """Refuse a bag whose clock was set back: sorted, it would mix two motions.

    A message that was late fits into a hole between the others, and few are late in a
    row.

    Args:
        path: Of the bag, for the message.
        topic: Its name.
        time: (N,) [ns], in the order of the bag.
        rows: Numbers of the messages, from 0, (N,).
        publishers: How many nodes sent them.

    Raises:
        FileFormatError: Many messages in a row state earlier times than one before
            them, or messages of one publisher do not fit between the others.
    """
    latest = np.maximum.accumulate(time) if time.size else time
    late = np.flatnonzero(time < latest)
    if time.size < _MOST_LATE or not late.size:
        return
    breaks = np.flatnonzero(np.diff(late) != 1) + 1
    longest = max(np.split(late, breaks), key=len)
    in_order = np.sort(time)
    typical = float(np.median(np.diff(in_order)))
    place = np.searchsorted(in_order, time[late])
    before = in_order[place] - in_order[np.maximum(place - 1, 0)]
    behind = in_order[np.minimum(place + 1, time.size - 1)] - in_order[place]
    crowded = np.minimum(before, behind) < typical / 2
    if longest.size > _MOST_LATE:
        first = int(longest[0])
    elif publishers == 1 and crowded.any():
        first = int(late[np.argmax(crowded)])
    else:
        return
    stamp = int(time[first]) / 10**9
    back = (int(latest[first]) - int(time[first])) / 10**9
    problem = (
        f"time runs back by {back:.9g} s, to {stamp:.16g} s (a clock that was set "
        "back?); cut the bag there"
    )
    raise FileFormatError(path, problem, f"message {rows[first] + 1} of {topic}")


def _streams(
    path: PathLike, topic: str | None, progress: Progress | None
) -> dict[str, list[_Message]]:
    """All joint states of a bag by topic, or those of one topic."""
    file = Path(path)
    streams: dict[str, list[_Message]] = {}
    others: list[str] = []
    with library(path, "bags"):
        import rosbags  # noqa: F401 (its absence is named before a file's)

        if not file.exists():
            raise MissingFileError(path, "a ROS bag")
        _check_files(path, file)
        is_mcap = file.is_file() and file.suffix.lower() == ".mcap"
        read = _mcap_messages if is_mcap else _rosbags_messages
        for name, message in read(file, others):
            streams.setdefault(name, []).append(message)
    if progress:
        progress("read", 1.0)
    if not streams:
        got = ", ".join(sorted(others))[:400] or "nothing"
        raise FileFormatError(path, f"no sensor_msgs/JointState, but {got}")
    if topic is None:
        return streams
    choice("topic", topic, sorted(streams))
    return {topic: streams[topic]}


def _rosbags_messages(file: Path, others: list[str]) -> Iterator[tuple[str, _Message]]:
    """Topic and joint state of each message of a bag that rosbags reads."""
    from rosbags import rosbag1, rosbag2
    from rosbags.typesys import Stores, get_typestore

    # The message is the same in every release: definitions in the bag, which
    # `rosbags.highlevel.AnyReader` checks, are not needed.
    reader: Any = rosbag2.Reader
    decode: Any = get_typestore(Stores.LATEST).deserialize_cdr
    if file.suffix.lower() == ".bag":
        reader = rosbag1.Reader
        decode = get_typestore(Stores.ROS1_NOETIC).deserialize_ros1
    with reader(file) as bag:
        found = [c for c in bag.connections if c.msgtype == _ROS_TYPE]
        others += [f"{c.topic} ({c.msgtype})" for c in bag.connections]
        for connection, received, raw in bag.messages(found) if found else ():
            publisher = getattr(connection.ext, "callerid", None)
            publisher = publisher or f"connection {connection.id}"
            content = decode(raw, _ROS_TYPE)
            yield connection.topic, _message(publisher, received, content)


def _mcap_messages(file: Path, others: list[str]) -> Iterator[tuple[str, _Message]]:
    """Topic and joint state of each message of an MCAP file: CDR, ROS 1 or JSON."""
    from mcap.reader import make_reader
    from rosbags.typesys import Stores, get_typestore

    ros1 = get_typestore(Stores.ROS1_NOETIC)
    ros2 = get_typestore(Stores.LATEST)
    decoders: dict[str, Callable[[bytes], Any]] = {
        "json": _from_json,
        "cdr": lambda data: ros2.deserialize_cdr(data, _ROS_TYPE),
        "ros1": lambda data: ros1.deserialize_ros1(data, _ROS_TYPE),
    }
    with file.open("rb") as stream:
        reader = make_reader(stream)
        for schema, channel, record in reader.iter_messages():
            kind = "no schema" if schema is None else schema.name
            decode = decoders.get(channel.message_encoding)
            if decode is None or not kind.endswith(_TYPE):
                other = f"{channel.topic} ({kind}, {channel.message_encoding})"
                if other not in others:
                    others.append(other)
                continue
            publisher = f"channel {channel.id}"
            content = decode(record.data)
            yield channel.topic, _message(publisher, record.log_time, content)


def _message(publisher: str, received: int, content: Any) -> _Message:
    stamp = content.header.stamp
    return _Message(
        publisher=publisher,
        received=received,
        stamp=stamp.sec * 10**9 + stamp.nanosec,
        names=content.name,
        position=content.position,
        velocity=content.velocity,
        effort=content.effort,
    )


def _from_json(data: bytes) -> SimpleNamespace:
    """A joint state from JSON; what it lacks is empty, its stamp 0.

    Raises:
        ValueError: Another message.
    """
    try:
        fields = json.loads(data)
    except RecursionError:
        raise ValueError("JSON nests too deep") from None
    if not isinstance(fields, dict):
        raise ValueError("a message that is no JSON object")
    names = fields.get("name")
    if not isinstance(names, list) or not all(isinstance(x, str) for x in names):
        raise ValueError("a JointState without a list of names")

    header = fields.get("header")
    stamp = header.get("stamp") if isinstance(header, dict) else None
    known: dict[str, Any] = stamp if isinstance(stamp, dict) else {}
    return SimpleNamespace(
        header=SimpleNamespace(
            stamp=SimpleNamespace(
                sec=int(known.get("sec", known.get("secs", 0))),
                nanosec=int(known.get("nanosec", known.get("nsec", 0))),
            )
        ),
        name=names,
        position=np.array(fields.get("position") or [], dtype=float),
        velocity=np.array(fields.get("velocity") or [], dtype=float),
        effort=np.array(fields.get("effort") or [], dtype=float),
    )


def _check_files(path: PathLike, bag: Path) -> None:
    """Refuse pointers of Git LFS, and files that expand without measure.

    Sizes are those that the files state: of the chunks of MCAP and ROS 1.

    Raises:
        FileFormatError: Such a file.
    """
    files = sorted(bag.iterdir()) if bag.is_dir() else [bag]
    for file in filter(Path.is_file, files):
        size = file.stat().st_size
        if file.name == "metadata.yaml":
            _check_metadata(path, file)
        with file.open("rb") as stream:
            start = stream.read(100)
            refuse_git_lfs_pointer(file, start)
            if start.startswith(b"\x89MCAP0\r\n"):
                expanded = _mcap_size(stream, size)
            elif start.startswith(b"#ROSBAG V2.0\n"):
                expanded = _ros1_size(stream, size)
            else:
                continue
        refuse_expansion(path, expanded, _LEAST_EXPANSION + EXPANSION * size)


def _check_metadata(path: PathLike, file: Path) -> None:
    """Refuse YAML that is large, or takes much more time or memory than it is large."""
    text = read_named(file, "the metadata of a bag", _MOST_METADATA)
    depth = 0
    for bracket in re.findall(rb"[\[{\]}]", text):
        depth += 1 if bracket in b"[{" else -1
        if depth > _MOST_LEVELS:
            break
    if depth > _MOST_LEVELS or re.search(rb"(?:[-?] ){%d}" % _MOST_LEVELS, text):
        problem = f"metadata.yaml nests deeper than {_MOST_LEVELS} levels"
        raise FileFormatError(path, problem)
    if re.search(rb"[\[{,:-][ \n]*\*\w", text):
        problem = "metadata.yaml has aliases (*name), which no recorder writes"
        raise FileFormatError(path, problem)


def _mcap_size(stream: BinaryIO, size: int) -> int:
    """Bytes that the chunks of an MCAP file state, and those their frames do."""
    import zstandard

    expanded = 0
    position = 8
    while position + 9 <= size:
        stream.seek(position)
        head = stream.read(9 + 100)
        kind, length = struct.unpack_from("<BQ", head)
        if kind == 6 and len(head) >= 9 + 32:  # a chunk
            (stated, _, words) = struct.unpack_from("<QII", head, 9 + 16)
            frame = head[9 + 32 + min(words, 30) + 8 :]
            in_frame = 0
            if frame.startswith(zstandard.FRAME_HEADER):
                in_frame = max(0, zstandard.frame_content_size(frame))
            expanded += max(stated, in_frame)
        position += 9 + length
    return expanded


def _ros1_size(stream: BinaryIO, size: int) -> int:
    """Bytes that the chunks of a ROS 1 bag state."""
    expanded = 0
    position = 13
    while position + 4 <= size:
        stream.seek(position)
        (length,) = struct.unpack("<I", stream.read(4))
        header = stream.read(min(length, 4096))
        stream.seek(position + 4 + length)
        data = stream.read(4)
        if len(data) < 4:
            break
        place = header.find(b"size=")
        if b"op=\x05" in header and place >= 0 and place + 9 <= len(header):
            expanded += struct.unpack_from("<I", header, place + 5)[0]
        position += 8 + length + struct.unpack("<I", data)[0]
    return expanded
