"""Tables of joint motion from ROS bags: the joint states of one topic."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model import errors
from alpha5_model._support.checks import FloatArray, choice
from alpha5_model._support.files import PathLike
from alpha5_model.trajectory.bag_limits import limited
from alpha5_model.trajectory.names import prefixes
from alpha5_model.trajectory.tables import (
    JOINTS,
    MotionWarning,
    Progress,
    Table,
    library,
    only,
    seconds,
)

_JOINT_STATE = "sensor_msgs/msg/JointState"
#: Of a message: publisher, time of recording and stamp [ns], content.
_Streams = dict[str, list[tuple[str, int, int, Any]]]


def bag_table(
    path: PathLike, topic: str | None, prefix: str | None, progress: Progress | None
) -> tuple[Table, str]:
    """The joint states of one topic as columns by the joints' names, and what stands before these.

    Messages of the topic count from 1, in the order of the bag; see `read_motion`.
    """
    streams = _streams(path, topic, progress)
    topic, before, wanted = _chosen(path, streams, prefix)
    nothing, rows, values = [np.nan] * len(wanted), [], []
    publishers: dict[str, int] = {}
    for number, (publisher, received, stamp, m) in enumerate(streams[topic], start=1):
        count = len(m.name)
        if len(m.position) == count and {*wanted} <= {*m.name}:
            at = [m.name.index(name) for name in wanted]
            fields = m.position, m.velocity, m.effort
            values.append([x[at] if len(x) == count else nothing for x in fields])
            rows.append((number, received, stamp))
            publishers.setdefault(publisher, number)
    numbers, times, stamps = np.array(rows, dtype=np.int64).reshape(-1, 3).T
    partial = np.setdiff1d(range(1, len(streams[topic]) + 1), numbers)
    unstamped = numbers[stamps == 0]
    if (stamps < 10**11).sum() > unstamped.size == 1:
        unstamped = unstamped[:0]  # simulated time starts at zero
    ns = times if unstamped.size else stamps
    order = np.argsort(ns, kind="stable")
    back, numbers, ns = numbers[1:][np.diff(ns) < 0], numbers[order], ns[order]
    table = np.array(values).reshape(-1, 3, len(wanted))[order]
    if np.isnan(table[:, 0]).all(axis=0).tolist() == [*[False] * 4, True]:
        wanted, table = wanted[:4], table[..., :4]  # a gripper without a sensor
    whole = np.isfinite(table[:, 0]).all(axis=1)
    holes, numbers, table = numbers[~whole], numbers[whole], table[whole]
    slow = numbers[~np.isfinite(table[:, 1]).all(axis=1)]
    warnings: list[MotionWarning] = []

    def warn(kind: str, at: Any, text: str) -> None:
        if len(at):
            warnings.append(
                MotionWarning(kind, len(at), f"message {min(at)} of {topic}", text)
            )

    warn(
        "missing_joints",
        partial,
        f"no position of each of {', '.join(wanted)}, message left out",
    )
    warn("not_finite", holes, "positions that are not finite, message left out")
    warn("no_stamp", unstamped, "no stamp; all times are those of recording")
    warn("out_of_order", back, "time runs back, messages sorted")
    others = f"publishers: {', '.join(sorted(publishers))}"
    warn("publishers", [*publishers.values()][1:], others)
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
        return f"message {numbers[row]} of {topic}" + (
            f" ({header[column]})" if column else ""
        )

    return Table(
        header, read, place, "", tuple(warnings), tuple(sorted(unused))
    ), before


def _streams(path: PathLike, topic: str | None, progress: Progress | None) -> _Streams:
    """All joint states of a bag by topic, or those of one topic."""
    file, streams = Path(path), _Streams()
    with library(path, "bags"):
        from rosbags import rosbag1, rosbag2
        from rosbags.typesys import Stores, get_typestore

        if not file.exists():
            raise errors.MissingFileError(path, "a ROS bag")
        first = file.suffix.lower() == ".bag"
        # The message is the same in every release: no need for the definitions in the bag.
        store = get_typestore(Stores.ROS1_NOETIC if first else Stores.LATEST)
        decode = store.deserialize_ros1 if first else store.deserialize_cdr
        with (
            limited(path) as budget,
            (rosbag1 if first else rosbag2).Reader(file) as bag,
        ):
            here = [c for c in bag.connections if c.msgtype == _JOINT_STATE]
            if not here:
                got = ", ".join(
                    sorted(f"{c.topic} ({c.msgtype})" for c in bag.connections)
                )
                problem = f"no sensor_msgs/JointState, but {got or 'nothing'}"
                raise errors.FileFormatError(path, problem)
            if topic is not None:
                choice("topic", topic, sorted({c.topic for c in here}))
                here = [c for c in here if c.topic == topic]
            total = sum(c.msgcount for c in here)
            for count, (c, received, raw) in enumerate(bag.messages(here), start=1):
                budget.take(len(raw))
                m: Any = decode(raw, _JOINT_STATE)
                stamp = m.header.stamp.sec * 10**9 + m.header.stamp.nanosec
                publisher = getattr(c.ext, "callerid", None) or f"connection {c.id}"
                streams.setdefault(c.topic, []).append((publisher, received, stamp, m))
                if progress and count % 10_000 == 0:
                    progress("read", count / max(total, count))
    if progress:
        progress("read", 1.0)
    return streams


def _chosen(
    path: PathLike, streams: _Streams, asked: str | None
) -> tuple[str, str, list[str]]:
    """The only topic of the arm's joints, their only prefix, and the joints in most messages."""
    named = Counter(
        (topic, tuple(m.name)) for topic, got in streams.items() for *_, m in got
    )
    pairs = ((key, before) for key in named for before in prefixes(key[1], asked=asked))
    found = {(*key, before): named[key] for key, before in pairs}
    if not found:
        got = "; ".join(
            sorted(f"{topic}: {', '.join(names)}" for topic, names in named)
        )[:400]
        joints = ", ".join((asked or "") + joint for joint in JOINTS[:4])
        raise errors.FileFormatError(path, f"no message has all of {joints}, but {got}")
    topic = only("topic", sorted({topic for topic, *_ in found}))
    before = only("prefix", sorted({before for t, _, before in found if t == topic}))
    most = max(
        (key for key in found if key[::2] == (topic, before)), key=found.__getitem__
    )
    return (
        topic,
        before,
        [before + joint for joint in JOINTS if before + joint in most[1]],
    )
