"""Joint states in MCAP files that are no ROS 2 bags: JSON, ROS 1, or no profile."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from alpha5_model._support.checks import choice
from alpha5_model._support.files import PathLike
from alpha5_model.errors import FileFormatError
from alpha5_model.trajectory.bag_limits import Budget, expanded, limited
from alpha5_model.trajectory.bag_messages import Message
from alpha5_model.trajectory.file_table import library

_TYPE = "JointState"
#: Where the profile of an MCAP file is, behind its magic, the opcode of the header, and
#: the lengths of header and text.
_PROFILE = slice(21, 25)


def is_other_mcap(path: PathLike) -> bool:
    """Whether a file is MCAP, but not of ROS 2: rosbags reads only the latter."""
    file = Path(path)
    if file.suffix.lower() != ".mcap" or not file.is_file():
        return False
    with file.open("rb") as stream:
        start = stream.read(_PROFILE.stop)
    return start.startswith(b"\x89MCAP0\r\n\x01") and start[_PROFILE] != b"ros2"


def mcap_joint_states(path: PathLike, topic: str | None) -> dict[str, list[Message]]:
    """All joint states of an MCAP file by topic, or those of one topic.

    Messages may be JSON with the fields of ``sensor_msgs/JointState``, CDR or ROS 1.

    Raises:
        MissingDependencyError: mcap or rosbags is not installed.
        UnknownNameError: No joint states have this topic.
        FileFormatError: No joint states, or a message that is none.
    """
    with library(path, "bags"):
        streams, others = _read(path)
    if not streams:
        got = ", ".join(others)[:400] or "nothing"
        problem = f"no {_TYPE} in JSON, CDR or ROS 1, but {got}"
        raise FileFormatError(path, problem)
    if topic is None:
        return streams
    choice("topic", topic, sorted(streams))
    return {topic: streams[topic]}


def _read(path: PathLike) -> tuple[dict[str, list[Message]], list[str]]:
    """The joint states of a file by topic, and what its channels hold."""
    from mcap.records import Channel, Schema
    from mcap.records import Message as Record
    from rosbags.typesys import Stores, get_typestore

    ros_type = "sensor_msgs/msg/JointState"
    ros1 = get_typestore(Stores.ROS1_NOETIC)
    ros2 = get_typestore(Stores.LATEST)
    decoders: dict[str, Callable[[bytes], Any]] = {
        "json": _from_json,
        "cdr": lambda data: ros2.deserialize_cdr(data, ros_type),
        "ros1": lambda data: ros1.deserialize_ros1(data, ros_type),
    }
    schemas: dict[int, str] = {}
    channels: dict[int, Channel] = {}
    streams: dict[str, list[Message]] = {}
    with limited(path) as budget:
        for record in _records(Path(path), budget):
            if isinstance(record, Schema):
                schemas[record.id] = record.name
            elif isinstance(record, Channel):
                channels[record.id] = record
            elif isinstance(record, Record):
                channel = channels[record.channel_id]
                kind = schemas.get(channel.schema_id, "")
                decoder = decoders.get(channel.message_encoding)
                if decoder is None or not kind.endswith(_TYPE):
                    continue
                content = decoder(record.data)
                stamp = content.header.stamp
                message = Message(
                    publisher=f"channel {channel.id}",
                    received=record.log_time,
                    stamp=stamp.sec * 10**9 + stamp.nanosec,
                    content=content,
                )
                streams.setdefault(channel.topic, []).append(message)

    held = sorted(
        f"{channel.topic} ({schemas.get(channel.schema_id, 'no schema')}, "
        f"{channel.message_encoding})"
        for channel in channels.values()
    )
    return streams, held


def _records(file: Path, budget: Budget) -> Iterator[Any]:
    """All records of a file, those of its chunks in their place, within a budget."""
    from mcap.records import Chunk
    from mcap.stream_reader import StreamReader, breakup_chunk

    with file.open("rb") as stream:
        size = file.stat().st_size
        reader = StreamReader(stream, emit_chunks=True, record_size_limit=size)
        for record in reader.records:
            if not isinstance(record, Chunk):
                yield record
                continue
            plain = record
            if record.compression:
                data = expanded(record.compression, record.data, budget)
                plain = replace(record, compression="", data=data)
            yield from breakup_chunk(plain)


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
