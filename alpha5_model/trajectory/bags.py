"""Motion from a ROS bag: ``sensor_msgs/JointState`` messages of one topic, through rosbags."""

from __future__ import annotations

from collections import Counter
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model import errors
from alpha5_model.checks import FloatArray, choice
from alpha5_model.files import PathLike
from alpha5_model.trajectory.motion import JOINTS, MotionWarning, Progress
from alpha5_model.trajectory.tables import Table, only, prefixes, seconds

SUFFIXES = (".bag", ".db3", ".mcap")
_TYPE = "sensor_msgs/msg/JointState"
_HINT = "if it was cut off: rosbag reindex, ros2 bag reindex or mcap recover"
#: Messages read between two reports of progress.
_CHUNK = 10_000
#: A stamp of zero is a time if there are others below this [ns].
_SOON = 10**11
#: Publisher, time of recording and stamp [ns], message.
_Received = tuple[str, int, int, Any]
_Streams = dict[str, list[_Received]]


def is_bag(path: Any) -> bool:
    """Whether a path looks like a ROS bag: by its suffix, or a folder with a ``metadata.yaml``."""
    file = Path(str(path))
    with suppress(OSError, ValueError):  # a name that none can have
        return file.suffix.lower() in SUFFIXES or (file / "metadata.yaml").is_file()
    return False


def bag_table(
    path: PathLike, topic: str | None, prefix: str | None, progress: Progress | None
) -> tuple[Table, str]:
    """The joint states of one topic as columns by the joints' names, and what stands before these.

    Messages of the topic count from 1, in the order of the bag; see `read_motion`.
    """
    streams = _streams(path, topic, progress)
    topic, before, wanted = _chosen(path, streams, prefix)
    nothing, n, rows, values = np.full(len(wanted), np.nan), len(wanted), [], []
    partial: list[int] = []
    publishers: dict[str, int] = {}
    for number, (publisher, received, stamp, m) in enumerate(streams[topic], start=1):
        count = len(m.name)
        if len(m.position) != count or not {*wanted} <= {*m.name}:
            partial.append(number)
            continue
        at = [m.name.index(name) for name in wanted]
        fields = m.position, m.velocity, m.effort
        rows.append((number, received, stamp))
        values.append([x[at] if len(x) == count else nothing for x in fields])
        publishers.setdefault(publisher, number)
    numbers, times, stamps = np.array(rows, dtype=np.int64).reshape(-1, 3).T
    unstamped = numbers[stamps == 0]
    if (stamps < _SOON).sum() > unstamped.size == 1:
        unstamped = unstamped[:0]  # simulated time starts at zero
    ns = times if unstamped.size else stamps
    order = np.argsort(ns, kind="stable")
    back, numbers, ns = numbers[1:][np.diff(ns) < 0], numbers[order], ns[order]
    table = np.array(values).reshape(-1, 3, n)[order]
    if np.isnan(table[:, 0]).all(axis=0).tolist() == [*[False] * 4, True]:
        wanted, table = wanted[:4], table[..., :4]  # a gripper without a sensor
    whole = np.isfinite(table[:, 0]).all(axis=1)
    holes, numbers, table = numbers[~whole], numbers[whole], table[whole]
    slow = numbers[~np.isfinite(table[:, 1]).all(axis=1)]
    warnings: list[MotionWarning] = []

    def warn(kind: str, at: Any, text: str) -> None:
        if len(at):
            warnings.append(MotionWarning(kind, len(at), f"message {min(at)} of {topic}", text))

    warn("missing_joints", partial, f"no position of each of {', '.join(wanted)}, message left out")
    warn("not_finite", holes, "positions that are not finite, message left out")
    warn("no_stamp", unstamped, "no stamp; all times are those of recording")
    warn("out_of_order", back, "time runs back, messages sorted")
    others = [*publishers.values()][1:]
    warn("publishers", others, f"publishers: {', '.join(sorted(publishers))}")
    if slow.size < numbers.size:
        warn("velocity", slow, "no velocities, so none is used")
    kinds = {"": 0, "_effort": 2} if slow.size else {"": 0, "_vel": 1, "_effort": 2}
    header = ["time", *(name + kind for kind in kinds for name in wanted)]
    time = seconds(ns[whole].tolist(), 10**9)
    columns = np.column_stack([time, *(table[:, k] for k in kinds.values())])
    unused = {name for *_, m in streams[topic] for name in m.name} - {*wanted}

    def read(needed: list[int], efforts: list[int]) -> tuple[FloatArray, str]:
        return columns[:, [*needed, *efforts]], "s"

    def place(row: int, column: int) -> str:
        return f"message {numbers[row]} of {topic}" + (f" ({header[column]})" if column else "")

    return Table(header, read, place, "", tuple(warnings), tuple(sorted(unused))), before


def _streams(path: PathLike, topic: str | None, progress: Progress | None) -> _Streams:
    """All joint states of a bag by topic, or those of one topic."""
    try:
        from rosbags import rosbag1, rosbag2
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        remedy = "python -m pip install 'alpha5-model[bags]'"
        raise errors.MissingDependencyError("rosbags", f"reading {path}", remedy) from None
    file, streams = Path(path), _Streams()
    if not file.exists():
        raise errors.MissingFileError(path, "a ROS bag")
    first = file.suffix.lower() == ".bag"
    # The message is the same in every release: no need for the definitions in the bag.
    store = get_typestore(Stores.ROS1_NOETIC if first else Stores.LATEST)
    decode = store.deserialize_ros1 if first else store.deserialize_cdr
    try:
        with (rosbag1 if first else rosbag2).Reader(file) as bag:
            here = [c for c in bag.connections if c.msgtype == _TYPE]
            if not here:
                got = ", ".join(sorted(f"{c.topic} ({c.msgtype})" for c in bag.connections))
                raise errors.FileFormatError(
                    path, f"no sensor_msgs/JointState, but {got or 'nothing'}"
                )
            if topic is not None:
                choice("topic", topic, sorted({c.topic for c in here}))
                here = [c for c in here if c.topic == topic]
            total = sum(c.msgcount for c in here)
            for count, (c, received, raw) in enumerate(bag.messages(here), start=1):
                m: Any = decode(raw, _TYPE)
                stamp = m.header.stamp.sec * 10**9 + m.header.stamp.nanosec
                publisher = getattr(c.ext, "callerid", None) or f"connection {c.id}"
                streams.setdefault(c.topic, []).append((publisher, received, stamp, m))
                if progress and count % _CHUNK == 0:
                    progress("read", count / max(total, count))
    except errors.Alpha5Error:
        raise
    except Exception as error:  # whatever a damaged bag makes rosbags raise
        problem = f"cannot be read as a ROS bag ({type(error).__name__}: {error}); {_HINT}"
        raise errors.FileFormatError(path, problem) from None
    if progress:
        progress("read", 1.0)
    return streams


def _chosen(path: PathLike, streams: _Streams, asked: str | None) -> tuple[str, str, list[str]]:
    """The only topic of the arm's joints, their only prefix, and the joints in most messages."""
    named = Counter((topic, tuple(m.name)) for topic, got in streams.items() for *_, m in got)
    found = {
        (*key, before): count
        for key, count in named.items()
        for before in prefixes(key[1], asked=asked)
    }
    if not found:
        got = "; ".join(sorted(f"{topic}: {', '.join(names)}" for topic, names in named))[:400]
        joints = ", ".join((asked or "") + joint for joint in JOINTS[:4])
        raise errors.FileFormatError(path, f"no message has all of {joints}, but {got}")
    topic = only("topic", sorted({topic for topic, *_ in found}))
    before = only("prefix", sorted({before for t, _, before in found if t == topic}))
    most = max((key for key in found if key[::2] == (topic, before)), key=found.__getitem__)
    return topic, before, [before + joint for joint in JOINTS if before + joint in most[1]]
