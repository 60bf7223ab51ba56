"""Joint states in bags of each kind, written by rosbags."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

KINDS = (".bag", ".db3", ".mcap", "folder")


@dataclass
class State:
    """One message.

    Times are in ns, and no stamp is written if it is zero. A message is recorded a
    millisecond after its stamp unless another time is given.
    """

    stamp: int
    names: Sequence[str]
    position: Sequence[float]
    velocity: Sequence[float] = ()
    effort: Sequence[float] = ()
    topic: str = "/joint_states"
    received: int = 0
    publisher: str = "/driver"
    frame: str = ""


def write_bag(
    folder: Path, kind: str, states: Iterable[State], compression: str = ""
) -> Path:
    """The bag's file, or the folder of a ROS 2 bag, as `read_motion` takes it.

    Args:
        folder: For the bag.
        kind: One of `KINDS`; ``"folder.db3"`` is the folder of a SQLite bag.
        states: Its messages.
        compression: ``"bz2"`` or ``"lz4"`` of ROS 1; ``"storage"`` of MCAP;
            ``"message"`` or ``"file"`` of the folder of a ROS 2 bag.
    """
    from rosbags import rosbag1, rosbag2
    from rosbags.typesys import Stores, get_typestore

    first = kind == ".bag"
    store = get_typestore(Stores.ROS1_NOETIC if first else Stores.ROS2_HUMBLE)
    joint_state, header, time = (
        store.types[name]
        for name in (
            "sensor_msgs/msg/JointState",
            "std_msgs/msg/Header",
            "builtin_interfaces/msg/Time",
        )
    )
    path = folder / ("recording.bag" if first else "recording")
    if first:
        writer: Any = rosbag1.Writer(path)
        if compression:
            writer.set_compression(writer.CompressionFormat[compression.upper()])
    else:
        plugin = (
            rosbag2.StoragePlugin.SQLITE3
            if kind.endswith(".db3")
            else rosbag2.StoragePlugin.MCAP
        )
        writer = rosbag2.Writer(path, version=9, storage_plugin=plugin)
        if compression:
            mode = rosbag2.CompressionMode[compression.upper()]
            writer.set_compression(mode, rosbag2.CompressionFormat.ZSTD)
    serialize = store.serialize_ros1 if first else store.serialize_cdr
    with writer:
        connections: dict[tuple[str, str], Any] = {}
        for s in states:
            key = s.topic, s.publisher if first else ""
            if key not in connections:
                extra = {"callerid": s.publisher} if first else {}
                connections[key] = writer.add_connection(
                    s.topic, joint_state.__msgtype__, typestore=store, **extra
                )
            stamp = time(*divmod(s.stamp, 10**9))
            head = header(0, stamp, s.frame) if first else header(stamp, s.frame)
            arrays = (
                np.array(x, dtype=float) for x in (s.position, s.velocity, s.effort)
            )
            message = joint_state(head, list(s.names), *arrays)
            received = s.received or s.stamp + 10**6
            writer.write(
                connections[key], received, serialize(message, joint_state.__msgtype__)
            )
    whole = kind == ".bag" or kind.startswith("folder")
    return path if whole else next(path.glob(f"*{kind}"))
