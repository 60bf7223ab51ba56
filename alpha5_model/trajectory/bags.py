"""Motion from a ROS bag: ``sensor_msgs/JointState`` messages of one topic, through rosbags."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model.checks import choice
from alpha5_model.errors import (
    Alpha5Error,
    FileFormatError,
    MissingDependencyError,
    MissingFileError,
)
from alpha5_model.files import PathLike
from alpha5_model.trajectory.columns import only, prefixes
from alpha5_model.trajectory.motion import JOINTS, Motion, MotionWarning, Place, Progress

SUFFIXES = (".bag", ".db3", ".mcap")
_TYPE = "sensor_msgs/msg/JointState"
_HINT = "if it was cut off: rosbag reindex, ros2 bag reindex or mcap recover"
#: Messages read between two reports of progress.
_CHUNK = 10_000
#: A stamp of zero is a time if there are others below this [ns].
_SOON = 10**11
#: Publisher, time of recording and stamp [ns], message.
_Received = tuple[str, int, int, Any]


def is_bag(path: Any) -> bool:
    """Whether a path looks like a ROS bag: by its suffix, or a folder with a ``metadata.yaml``."""
    file = Path(str(path))
    with suppress(OSError, ValueError):  # a name that none can have
        return file.suffix.lower() in SUFFIXES or (file / "metadata.yaml").is_file()
    return False


def read_bag(
    path: PathLike, topic: str | None, prefix: str | None, progress: Progress | None
) -> tuple[Motion, Place]:
    """Motion, still to be checked, and where its numbers stand; see `read_motion`.

    Messages of the topic count from 1, in the order of the bag.
    """
    streams = _streams(path, topic, progress)
    topic, before, wanted = _chosen(path, streams, prefix)
    n, nothing, rows, partial = len(wanted), np.full(len(wanted), np.nan), [], []
    for number, (publisher, received, stamp, m) in enumerate(streams[topic], start=1):
        count = len(m.name)
        if len(m.position) != count or not {*wanted} <= {*m.name}:
            partial.append(number)
            continue
        at = [m.name.index(name) for name in wanted]
        fields = (x[at] if len(x) == count else nothing for x in (m.position, m.velocity, m.effort))
        rows.append((number, publisher, received, stamp, np.concatenate([*fields])))
    unstamped = [row[0] for row in rows if not row[3]]
    if sum(row[3] < _SOON for row in rows) > len(unstamped) == 1:
        unstamped = []  # simulated time starts at zero
    ns = [row[2] if unstamped else row[3] for row in rows]
    back = [rows[k][0] for k in range(1, len(rows)) if ns[k] < ns[k - 1]]
    order = sorted(range(len(rows)), key=ns.__getitem__)  # keeps the order of equal times
    # Python divides whole numbers to the last digit; nanoseconds since 1970 do not fit a float.
    time = np.array([ns[k] / 10**9 for k in order])
    table = np.array([rows[k][4] for k in order]).reshape(-1, 3 * n)
    numbers = np.array([rows[k][0] for k in order], dtype=int)
    whole = np.isfinite(table[:, :n]).all(axis=1)
    holes, numbers = numbers[~whole], numbers[whole]
    position, velocity, effort = np.split(table[whole], 3, axis=1)
    slow = numbers[~np.isfinite(velocity).all(axis=1)]
    publishers = {row[1]: row[0] for row in reversed(rows)}
    found: tuple[tuple[str, Sequence[int], str], ...] = (
        (
            "missing_joints",
            partial,
            f"no position of each of {', '.join(wanted)}, message left out",
        ),
        ("not_finite", holes, "positions that are not finite, message left out"),
        ("no_stamp", unstamped, "no stamp; all times are those of recording"),
        ("out_of_order", back, "time runs back, messages sorted"),
        ("publishers", [*publishers.values()][1:], f"publishers: {', '.join(sorted(publishers))}"),
        ("velocity", slow if slow.size < numbers.size else [], "no velocities, so none is used"),
    )
    raw = Motion(
        time[whole],
        JOINTS[:n],
        position,
        None if slow.size else velocity,
        tuple(
            MotionWarning(kind, len(at), f"message {min(at)} of {topic}", text)
            for kind, at, text in found
            if len(at)
        ),
        str(path),
        tuple(sorted({name for *_, m in streams[topic] for name in m.name} - {*wanted})),
        effort=effort,
    )

    def place(sample: int, joint: str | None) -> str:
        return f"message {numbers[sample]} of {topic}" + (f" ({before}{joint})" if joint else "")

    return raw, place


def _streams(
    path: PathLike, topic: str | None, progress: Progress | None
) -> dict[str, list[_Received]]:
    """All joint states of a bag by topic, or those of one topic."""
    try:
        from rosbags import rosbag1, rosbag2
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        remedy = "python -m pip install 'alpha5-model[bags]'"
        raise MissingDependencyError("rosbags", f"reading {path}", remedy) from None
    file, streams = Path(path), dict[str, list[_Received]]()
    if not file.exists():
        raise MissingFileError(path, "a ROS bag")
    first = file.suffix.lower() == ".bag"
    # The message is the same in every release: no need for the definitions in the bag.
    store = get_typestore(Stores.ROS1_NOETIC if first else Stores.LATEST)
    decode = store.deserialize_ros1 if first else store.deserialize_cdr
    try:
        with (rosbag1 if first else rosbag2).Reader(file) as bag:
            here = [c for c in bag.connections if c.msgtype == _TYPE]
            if not here:
                got = ", ".join(sorted(f"{c.topic} ({c.msgtype})" for c in bag.connections))
                raise FileFormatError(path, f"no sensor_msgs/JointState, but {got or 'nothing'}")
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
    except Alpha5Error:
        raise
    except Exception as error:  # whatever a damaged bag makes rosbags raise
        problem = f"cannot be read as a ROS bag ({type(error).__name__}: {error}); {_HINT}"
        raise FileFormatError(path, problem) from None
    if progress:
        progress("read", 1.0)
    return streams


def _chosen(
    path: PathLike, streams: dict[str, list[_Received]], asked: str | None
) -> tuple[str, str, list[str]]:
    """The only topic that names the arm's joints, their only prefix, and the joints in most messages."""
    named = Counter((topic, tuple(m.name)) for topic, got in streams.items() for *_, m in got)
    found = {
        (*key, before): count
        for key, count in named.items()
        for before in prefixes(key[1], asked=asked)
    }
    if not found:
        got = "; ".join(sorted(f"{topic}: {', '.join(names)}" for topic, names in named))[:400]
        joints = ", ".join((asked or "") + joint for joint in JOINTS[:4])
        raise FileFormatError(path, f"no message has all of {joints}, but {got}")
    topic = only("topic", sorted({topic for topic, *_ in found}))
    before = only("prefix", sorted({before for t, _, before in found if t == topic}))
    most = max((key for key in found if key[::2] == (topic, before)), key=found.__getitem__)
    return topic, before, [before + joint for joint in JOINTS if before + joint in most[1]]
