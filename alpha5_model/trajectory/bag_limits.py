"""Limits on what reading a ROS bag may take, in proportion to its size.

A bag of 65 kB can expand to gigabytes, or describe an endless table, and rosbags sets
no limit. Within `limited`, the decompressors, the index and SQLite's queries of rosbags
count against a budget.
"""

from __future__ import annotations

from bz2 import BZ2Decompressor
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from alpha5_model._support.files import PathLike
from alpha5_model.errors import FileFormatError, MissingDependencyError
from alpha5_model.trajectory.file_table import EXPANSION

#: Any bag may expand to this size [bytes].
_LEAST_EXPANSION = 1_000_000
#: Steps of SQLite's virtual machine for each byte of a file. Reading messages takes
#: less than one.
_STEPS = 20
#: Steps between two checks of the budget.
_STEPS_AT_ONCE = 10_000
#: Generated columns, whose expressions may take any time.
_FORMULAS = """
    SELECT 1 FROM sqlite_master AS entry, pragma_table_xinfo(entry.name) AS field
    WHERE field.hidden > 0 LIMIT 1"""
#: Bytes decompressed between two checks of the budget.
_PIECE = 1_000_000
#: Levels of lists and tables in a bag's ``metadata.yaml``, which has six.
_DEPTH = 20


class _ExceededError(Exception):
    """More than the budget allows."""


class Budget:
    """Bytes that a bag may still expand to.

    Attributes:
        allowed: Bytes in all.
        exceeded: Whether the bag has expanded to more.
    """

    def __init__(self, size: int) -> None:
        self.allowed = _LEAST_EXPANSION + EXPANSION * size
        self.exceeded = False
        self._taken = 0

    def take(self, count: int) -> None:
        """Count bytes.

        Raises:
            Exception: More than allowed; `limited` makes it an error about the file.
        """
        self._taken += count
        if self._taken > self.allowed:
            self.exceeded = True
            raise _ExceededError


_current: ContextVar[Budget | None] = ContextVar("budget of a bag", default=None)


@contextmanager
def limited(path: PathLike) -> Iterator[Budget]:
    """Read a bag with rosbags within limits.

    Raises:
        FileFormatError: The bag takes more than is allowed.
        MissingDependencyError: A version of rosbags that cannot be limited.
    """
    _install()
    file = Path(path)
    if file.is_dir():
        _check_metadata(path, file / "metadata.yaml")
    budget = Budget(_size(file))
    token = _current.set(budget)
    try:
        yield budget
    except Exception:
        if not budget.exceeded:
            raise
        most = f"{budget.allowed / 1e6:.3g} MB, {EXPANSION} times its size"
        problem = (
            f"expands to more than {most}; "
            "a bag that is yours: write it without compression"
        )
        raise FileFormatError(path, problem) from None
    finally:
        _current.reset(token)


def _size(file: Path) -> int:
    """Bytes of a file, or of all files in a folder."""
    files = [file]
    if file.is_dir():
        files = [inside for inside in file.iterdir() if inside.is_file()]
    return sum(each.stat().st_size for each in files)


def _check_metadata(path: PathLike, file: Path) -> None:
    """Refuse YAML that grows or nests without end, which no recorder writes."""
    reader: Any = import_module("rosbags.rosbag2.reader")
    events: Any = import_module("ruamel.yaml.events")
    starts = (events.MappingStartEvent, events.SequenceStartEvent)
    ends = (events.MappingEndEvent, events.SequenceEndEvent)

    depth = 0
    for event in reader.YAML(typ="safe").parse(file.read_text()):
        if isinstance(event, events.AliasEvent):
            problem = "metadata.yaml has aliases (*name), which no recorder writes"
            raise FileFormatError(path, problem)
        depth += isinstance(event, starts)
        depth -= isinstance(event, ends)
        if depth > _DEPTH:
            problem = f"metadata.yaml nests deeper than {_DEPTH} levels"
            raise FileFormatError(path, problem)


@lru_cache(maxsize=1)
def _install() -> None:
    """Patch the limits into rosbags, once. They act only while a budget is set."""
    ros1: Any = import_module("rosbags.rosbag1.reader")
    ros2: Any = import_module("rosbags.rosbag2.reader")
    mcap: Any = import_module("rosbags.rosbag2.storage_mcap")
    sqlite: Any = import_module("rosbags.rosbag2.storage_sqlite3")
    try:
        _count_each(ros1.decompressors)
        _count_each(mcap.DECOMPRESSORS)
        zstd = ros2.zstd
        ros2.zstd = SimpleNamespace(
            decompress=_counted("zstd", zstd.decompress), open=_file_opener(zstd)
        )
        for module in (ros2, mcap, sqlite):
            module.parse_qos = _without_quality(module.parse_qos)
        ros1.Reader.read_index_data = _counted_index(ros1.Reader.read_index_data)
        sqlite.apsw.connection_hooks.append(_limit_queries)
    except AttributeError as error:
        needed = f"limiting what a bag expands to ({error})"
        remedy = "python -m pip install 'alpha5-model[bags]'"
        library = "a known version of rosbags"
        raise MissingDependencyError(library, needed, remedy) from None


def _count_each(decompressors: dict[str, Callable[..., bytes]]) -> None:
    """Replace each decompressor by one that counts what it returns."""
    for name, plain in [*decompressors.items()]:
        decompressors[name] = _counted(name, plain)


def _counted(name: str, plain: Callable[..., bytes]) -> Callable[..., bytes]:
    """A decompressor that counts what it returns, piece by piece."""
    types = _decompressor_types()

    def decompress(data: bytes, *size: int) -> bytes:
        budget = _current.get()
        if budget is None:
            return plain(data, *size)
        if name not in types:  # stored without compression
            content = plain(data, *size)
            budget.take(len(content))
            return content
        return _expanded(types[name], data, budget)

    return decompress


def expanded(name: str, data: bytes, budget: Budget) -> bytes:
    """Data that a compression of MCAP made, within a budget.

    Raises:
        ValueError: No such compression.
    """
    types = _decompressor_types()
    if name not in types:
        message = f"unknown compression {name[:40]!r}"
        raise ValueError(message)
    return _expanded(types[name], data, budget)


def _decompressor_types() -> dict[str, Callable[[], Any]]:
    """Compression -> class of decompressors that work piece by piece."""
    mcap: Any = import_module("rosbags.rosbag2.storage_mcap")
    return {
        "bz2": BZ2Decompressor,
        "lz4": import_module("lz4.frame").LZ4FrameDecompressor,
        "zstd": mcap.zstd.ZstdDecompressor,
    }


def _expanded(
    decompressor_type: Callable[[], Any], data: bytes, budget: Budget
) -> bytes:
    """All frames of compressed data."""
    pieces = []
    rest = data
    while rest:
        frame = decompressor_type()
        while not frame.eof:
            piece = frame.decompress(rest, _PIECE)
            rest = b""
            budget.take(len(piece))
            pieces.append(piece)
            if not frame.eof and frame.needs_input:
                raise EOFError("compressed data end too early")
        rest = frame.unused_data or b""
    return b"".join(pieces)


def _file_opener(zstd: Any) -> Callable[..., Any]:
    """``zstd.open`` whose files count what is read."""

    class CountedFile(zstd.ZstdFile):  # type: ignore[misc]
        def read(self, size: int = -1) -> bytes:
            budget = _current.get()
            if budget is None:
                return bytes(super().read(size))
            content = bytes(super().read(_PIECE if size < 0 else size))
            budget.take(len(content))
            return content

    def opened(file: Any, mode: str) -> Any:
        if _current.get() is None:
            return zstd.open(file, mode)
        return CountedFile(file, mode)

    return opened


def _without_quality(plain: Callable[..., Any]) -> Callable[..., Any]:
    """A parser that skips qualities of service, which are YAML of their own."""

    def parse_qos(given: Any) -> Any:
        return plain(given) if _current.get() is None else []

    return parse_qos


def _counted_index(plain: Callable[..., None]) -> Callable[..., None]:
    """A reader of a ROS 1 index that counts it: many chunks may claim the same one."""

    def read_index_data(self: Any, position: int, indexes: Any) -> None:
        before = self.bio.tell()
        plain(self, position, indexes)
        budget = _current.get()
        if budget is not None:
            budget.take(EXPANSION // 2 * (self.bio.tell() - before))

    return read_index_data


def _limit_queries(connection: Any) -> None:
    """Limit SQLite: damaged tables may have no end, and columns may be formulas."""
    apsw: Any = import_module("apsw")
    budget = _current.get()
    if budget is None:
        return
    size = Path(connection.filename).stat().st_size
    left = _LEAST_EXPANSION + _STEPS * size

    def beyond() -> bool:
        nonlocal left
        left -= _STEPS_AT_ONCE
        budget.exceeded |= left < 0
        return left < 0

    connection.limit(apsw.SQLITE_LIMIT_LENGTH, max(size, _LEAST_EXPANSION))
    connection.set_progress_handler(beyond, _STEPS_AT_ONCE)
    if list(connection.execute(_FORMULAS)):
        raise FileFormatError(connection.filename, "has columns that are formulas")
