"""Tables of joint motion: columns of CSV and Parquet files and of ROS bags, read when they are needed."""

from __future__ import annotations

import csv
import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from itertools import compress
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from alpha5_model import errors
from alpha5_model.checks import FloatArray, choice
from alpha5_model.files import PathLike, read_named
from alpha5_model.published.tables import JOINT_NAMES
from alpha5_model.trajectory.names import prefixes

#: Base to tip; the first four are the arm, the last is the jaw rod, which a motion may leave out.
JOINTS = JOINT_NAMES
PER_SECOND = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}
#: Lines of CSV parsed between two reports of progress.
CHUNK = 50_000
_JOINT_STATE = "sensor_msgs/msg/JointState"
#: (stage, part done, 0 to 1)
Progress = Callable[[str, float], None]
#: Of a message: publisher, time of recording and stamp [ns], content.
_Streams = dict[str, list[tuple[str, int, int, Any]]]


@dataclass(frozen=True)
class MotionWarning:
    """Something odd in a motion that does not stop the computation.

    Attributes:
        kind: ``"repeated_time"``, ``"gap"``, ``"jump"``, ``"outside_limits"``, ``"velocity"``,
            ``"effort"``, ``"time_unit"``, ``"time_column"`` or ``"command"``; of a bag also ``"missing_joints"``,
            ``"not_finite"``, ``"no_stamp"``, ``"out_of_order"`` or ``"publishers"``.
        count: How often.
        first: Where it happens first.
        text: What it is, and what is done about it.
    """

    kind: str
    count: int
    first: str
    text: str

    def __str__(self) -> str:
        return f"{self.text}: {self.count} x, first: {self.first}"


class Table(NamedTuple):
    """What any file of joint motion is read as.

    Attributes:
        header: Names of all columns; see `read_motion`.
        read: (columns that must be finite, the time first; columns of efforts) -> their numbers,
            (N, k), without efforts if these are no numbers; and the unit of the time if the file's
            format says it, else None.
        place: (row, column) -> words, for messages.
        head: Where the names stand in the file, for messages.
        warnings: What was found odd so far.
        ignored: What is not a column and not used either.
    """

    header: Sequence[str]
    read: Callable[[list[int], list[int]], tuple[FloatArray, str | None]]
    place: Callable[[int, int], str]
    head: str = ""
    warnings: tuple[MotionWarning, ...] = ()
    ignored: tuple[str, ...] = ()


def only(what: str, found: Sequence[str]) -> str:
    """The only one of some prefixes or topics; ``""`` if it is among them.

    Joints named exactly are the arm's, whatever else there is; only then prefixes count.

    Raises:
        InputError: There are several.
    """
    if len(found) > 1 and "" not in found:
        expected = f"one of {', '.join(found)}: each has the joints of an arm"
        raise errors.InputError(what, None, expected)
    return min(found)


def parquet_table(path: PathLike) -> Table:
    """A Parquet file; rows count from 1.

    Raises:
        MissingDependencyError: Without pyarrow.
        FileFormatError: No Parquet file, or, once they are read, columns that are no numbers.
    """
    with _library(path, "parquet"):
        from pyarrow import BufferReader, parquet, types

        content = read_named(path, "a Parquet file of joint motion")
        file = parquet.ParquetFile(BufferReader(content))
        header = file.schema_arrow.names

    def place(row: int, column: int) -> str:
        return f"row {row + 1} ({header[column]})"

    def numbers(column: Any) -> FloatArray:
        unit = getattr(column.type, "unit", None)
        if unit is None:
            return np.asarray(column.cast("float64").to_numpy())
        return _seconds(column.cast("int64").to_pylist(), int(PER_SECOND[unit]))

    def read(needed: list[int], efforts: list[int]) -> tuple[FloatArray, str | None]:
        names = [header[k] for k in (*needed, *efforts)]
        with _library(path, "parquet"):
            data = file.read(names)
            table = np.stack([numbers(data[name]) for name in names], axis=1)
        for row, k in np.argwhere(~np.isfinite(table[:, : len(needed)])):
            problem = f"expected a finite number, got {table[row, k]:g}"
            raise errors.FileFormatError(path, problem, place(int(row), needed[k]))
        return table, "s" if types.is_temporal(data[names[0]].type) else None

    return Table(header, read, place)


@contextmanager
def _library(path: PathLike, extra: str) -> Iterator[None]:
    """What a library raises, or its lack, as an error about the file."""
    try:
        with errors.needing(f"reading {path}", f"python -m pip install 'alpha5-model[{extra}]'"):
            yield
    except errors.Alpha5Error:
        raise
    except Exception as error:  # whatever a damaged file makes it raise
        problem = f"cannot be read as a table of numbers: {error}"
        if extra == "bags":
            problem = f"cannot be read as a ROS bag ({type(error).__name__}: {error}); if it was "
            problem += "cut off: rosbag reindex, ros2 bag reindex or mcap recover"
        raise errors.FileFormatError(path, problem) from None


def _seconds(whole: Iterable[int | None], per_second: int) -> FloatArray:
    """Times to the last digit; nanoseconds since 1970 do not fit a float, Python's numbers do."""
    return np.array([np.nan if x is None else x / per_second for x in whole])


def csv_table(path: PathLike, progress: Progress | None) -> Table:
    """A CSV file; lines and columns count from 1.

    Raises:
        FileFormatError: No table with column names, or, once they are read, what is no number.
    """
    content = read_named(path, "a CSV file of joint motion (or Parquet, or a ROS bag)")
    try:
        text = content.decode("utf-8-sig").rstrip().replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError:
        raise errors.FileFormatError(path, "is not UTF-8 text, a CSV file is expected") from None
    every = [line.strip() for line in text.split("\n")]
    if not every[0]:
        problem = "is empty" if len(every) == 1 else "no column names in line 1"
        raise errors.FileFormatError(path, problem, "line 1")
    lines, numbers = [*filter(None, every)], [*compress(range(1, len(every) + 1), every)]
    header = _header(path, lines[0])

    def read(needed: list[int], efforts: list[int]) -> tuple[FloatArray, None]:
        # With text among the efforts these are ignored, as other columns are.
        for used in ([*needed, *efforts], needed):
            with suppress(ValueError, csv.Error):
                table = _parse(lines, used, len(header), progress)
                if np.isfinite(table[:, : len(needed)]).all():
                    return table, None
        for row, line in enumerate(lines[1:]):  # which one cannot be read, and why
            number = f"line {numbers[row + 1]}"
            fields = _fields(path, line, number)
            if len(fields) != len(header):
                problem = f"{len(fields)} fields, expected {len(header)} as in line 1"
                raise errors.FileFormatError(path, problem, number)
            for column in needed:
                value = _number(fields[column])
                if value is None or not math.isfinite(value):
                    problem = f"expected a finite number, got {fields[column][:40]!r}"
                    raise errors.FileFormatError(path, problem, place(row, column))
        raise errors.FileFormatError(path, "cannot be read as a table of numbers")

    def place(row: int, column: int) -> str:
        return f"line {numbers[row + 1]}, column {column + 1} ({header[column]})"

    return Table(header, read, place, "line 1")


def _fields(path: PathLike, line: str, place: str) -> list[str]:
    try:
        return [text.strip() for text in next(csv.reader([line]))]
    except csv.Error as error:  # a field of more than 131 072 characters
        raise errors.FileFormatError(path, f"is not a table of numbers: {error}", place) from None


def _header(path: PathLike, line: str) -> list[str]:
    others = {";": "';'", "\t": "a tab", " ": "a space"}.items()
    if found := [name for separator, name in others if separator in line and "," not in line]:
        problem = f"columns are separated by {found[0]}, expected ','"
        raise errors.FileFormatError(path, problem, "line 1")
    header = _fields(path, line, "line 1")
    if _number(header[0]) is not None:
        raise errors.FileFormatError(path, "starts with numbers, expected column names", "line 1")
    seen: set[str] = set()
    for k, name in enumerate(header):
        if name and name in seen:
            problem = f"column {name[:40]!r} stands twice"
            raise errors.FileFormatError(path, problem, f"line 1, column {k + 1}")
        seen.add(name)
    return header


def _parse(lines: list[str], used: list[int], width: int, progress: Progress | None) -> FloatArray:
    blocks = [np.empty((0, len(used)))]
    for start in range(0, len(lines), CHUNK):
        block = lines[max(1, start) : start + CHUNK]
        quoted = any('"' in line for line in block)
        widths = map(len, csv.reader(block)) if quoted else (x.count(",") + 1 for x in block)
        if any(found != width for found in widths):
            raise ValueError
        if block:
            how: dict[str, Any] = {"delimiter": ",", "comments": None, "quotechar": '"'}
            blocks.append(np.loadtxt(block, usecols=used, ndmin=2, **how))
        if progress:
            progress("read", min(start + CHUNK, len(lines)) / len(lines))
    return np.concatenate(blocks)


def _number(text: str) -> float | None:
    with suppress(ValueError):
        return float(text)
    return None


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
            warnings.append(MotionWarning(kind, len(at), f"message {min(at)} of {topic}", text))

    warn("missing_joints", partial, f"no position of each of {', '.join(wanted)}, message left out")
    warn("not_finite", holes, "positions that are not finite, message left out")
    warn("no_stamp", unstamped, "no stamp; all times are those of recording")
    warn("out_of_order", back, "time runs back, messages sorted")
    others = f"publishers: {', '.join(sorted(publishers))}"
    warn("publishers", [*publishers.values()][1:], others)
    if slow.size < numbers.size:
        warn("velocity", slow, "no velocities, so none is used")
    kinds = {"": 0, "_effort": 2} if slow.size else {"": 0, "_vel": 1, "_effort": 2}
    header = ["time", *(name + kind for kind in kinds for name in wanted)]
    time = _seconds(ns[whole].tolist(), 10**9)
    columns = np.column_stack([time, *(table[:, k] for k in kinds.values())])
    unused = {name for *_, m in streams[topic] for name in m.name} - {*wanted}

    def read(needed: list[int], efforts: list[int]) -> tuple[FloatArray, str]:
        return columns[:, [*needed, *efforts]], "s"

    def place(row: int, column: int) -> str:
        return f"message {numbers[row]} of {topic}" + (f" ({header[column]})" if column else "")

    return Table(header, read, place, "", tuple(warnings), tuple(sorted(unused))), before


def _streams(path: PathLike, topic: str | None, progress: Progress | None) -> _Streams:
    """All joint states of a bag by topic, or those of one topic."""
    file, streams = Path(path), _Streams()
    with _library(path, "bags"):
        from rosbags import rosbag1, rosbag2
        from rosbags.typesys import Stores, get_typestore

        if not file.exists():
            raise errors.MissingFileError(path, "a ROS bag")
        first = file.suffix.lower() == ".bag"
        # The message is the same in every release: no need for the definitions in the bag.
        store = get_typestore(Stores.ROS1_NOETIC if first else Stores.LATEST)
        decode = store.deserialize_ros1 if first else store.deserialize_cdr
        with (rosbag1 if first else rosbag2).Reader(file) as bag:
            here = [c for c in bag.connections if c.msgtype == _JOINT_STATE]
            if not here:
                got = ", ".join(sorted(f"{c.topic} ({c.msgtype})" for c in bag.connections))
                problem = f"no sensor_msgs/JointState, but {got or 'nothing'}"
                raise errors.FileFormatError(path, problem)
            if topic is not None:
                choice("topic", topic, sorted({c.topic for c in here}))
                here = [c for c in here if c.topic == topic]
            total = sum(c.msgcount for c in here)
            for count, (c, received, raw) in enumerate(bag.messages(here), start=1):
                m: Any = decode(raw, _JOINT_STATE)
                stamp = m.header.stamp.sec * 10**9 + m.header.stamp.nanosec
                publisher = getattr(c.ext, "callerid", None) or f"connection {c.id}"
                streams.setdefault(c.topic, []).append((publisher, received, stamp, m))
                if progress and count % 10_000 == 0:
                    progress("read", count / max(total, count))
    if progress:
        progress("read", 1.0)
    return streams


def _chosen(path: PathLike, streams: _Streams, asked: str | None) -> tuple[str, str, list[str]]:
    """The only topic of the arm's joints, their only prefix, and the joints in most messages."""
    named = Counter((topic, tuple(m.name)) for topic, got in streams.items() for *_, m in got)
    pairs = ((key, before) for key in named for before in prefixes(key[1], asked=asked))
    found = {(*key, before): named[key] for key, before in pairs}
    if not found:
        got = "; ".join(sorted(f"{topic}: {', '.join(names)}" for topic, names in named))[:400]
        joints = ", ".join((asked or "") + joint for joint in JOINTS[:4])
        raise errors.FileFormatError(path, f"no message has all of {joints}, but {got}")
    topic = only("topic", sorted({topic for topic, *_ in found}))
    before = only("prefix", sorted({before for t, _, before in found if t == topic}))
    most = max((key for key in found if key[::2] == (topic, before)), key=found.__getitem__)
    return topic, before, [before + joint for joint in JOINTS if before + joint in most[1]]
