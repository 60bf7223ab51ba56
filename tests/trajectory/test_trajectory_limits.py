"""Files made to exhaust memory or time are refused; sound compressed files are read."""

from __future__ import annotations

import sqlite3
import struct
import tracemalloc
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from bag_writer import State, write_bag

import alpha5_model as a5
from alpha5_model.errors import FileFormatError, InputError
from alpha5_model.trajectory.bag_limits import Budget, _ExceededError

NAMES = [f"axis_{letter}" for letter in "edcb"]
#: Form of a bag, and its compression.
COMPRESSED = [
    (".bag", "bz2"),
    (".bag", "lz4"),
    (".mcap", "storage"),
    ("folder", "storage"),
    ("folder", "message"),
    ("folder", "file"),
    ("folder.db3", "message"),
    ("folder.db3", "file"),
]


def states(count: int, frame: str = "") -> list[State]:
    """States of an arm at rest, the real recording that compresses best."""
    rest = [3.0, 1.5, 1.4, 1.2]
    return [
        State(10**18 + k * 10**7, NAMES, rest, [0.0] * 4, [0.1] * 4, frame=frame)
        for k in range(count)
    ]


@contextmanager
def within(megabytes: float) -> Iterator[None]:
    """Python's memory that a block may take. What works without end takes it, too."""
    tracemalloc.start()
    try:
        yield
        most = tracemalloc.get_traced_memory()[1] / 1e6
    finally:
        tracemalloc.stop()
    assert most < megabytes


@pytest.mark.parametrize(("kind", "compression"), COMPRESSED)
def test_compressed_bags_are_read_as_others(
    kind: str, compression: str, tmp_path: Path
) -> None:
    path = write_bag(tmp_path, kind, states(3000), compression)
    motion = a5.trajectory.read_motion(path)
    assert motion.time.size == 3000
    np.testing.assert_array_equal(
        motion.position, np.tile([3.0, 1.5, 1.4, 1.2], (3000, 1))
    )
    assert motion.warnings == ()


def test_a_bag_may_expand_to_a_hundred_times_its_size_and_a_megabyte() -> None:
    budget = Budget(2_000)
    budget.take(1_000_000)
    budget.take(200_000)
    assert not budget.exceeded
    with pytest.raises(_ExceededError):
        budget.take(1)
    assert budget.exceeded


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "compression"), COMPRESSED)
def test_what_expands_without_measure_is_refused(
    kind: str, compression: str, tmp_path: Path
) -> None:
    path = write_bag(tmp_path, kind, states(6, frame="a" * 20_000_000), compression)
    assert path.is_dir() or path.stat().st_size < 1_000_000
    with (
        within(150),
        pytest.raises(FileFormatError, match="100 times its size") as caught,
    ):
        a5.trajectory.read_motion(path)
    assert "\n" not in str(caught.value)


def record(kind: int, content: bytes) -> bytes:
    return struct.pack("<BQ", kind, len(content)) + content


def text(content: str) -> bytes:
    return struct.pack("<I", len(content)) + content.encode()


def mcap(compressed: bytes, size: int, copies: int = 0) -> bytes:
    """An MCAP file of one chunk, with an index that names it so many times."""

    magic = b"\x89MCAP0\r\n"
    schema = (
        struct.pack("<H", 1)
        + text("sensor_msgs/msg/JointState")
        + text("ros2msg")
        + text("")
    )
    channel = struct.pack("<HH", 1, 1) + text("/joint_states") + text("cdr") + text("")
    start = magic + record(1, text("ros2") + text(""))
    start += record(3, schema) + record(4, channel)
    head = struct.pack("<QQQI", 1, 2, size, 0) + text("zstd")
    chunk = record(6, head + struct.pack("<Q", len(compressed)) + compressed)
    places = struct.pack("<QQQQ", 1, 2, len(start), len(chunk))
    index = places + struct.pack("<IHQQ", 10, 1, 0, 0) + text("zstd")
    index += struct.pack("<QQ", len(compressed), size)
    counts = struct.pack("<IHQ", 10, 1, 10**6)
    statistics = struct.pack("<QHIIIIQQ", 10**6, 1, 1, 0, 0, copies, 1, 2) + counts
    summary = record(3, schema) + record(4, channel) + record(8, index) * copies
    summary += record(11, statistics)
    where = len(start + chunk) if copies else 0
    footer = record(2, struct.pack("<QQI", where, 0, 0))
    return (
        start
        + chunk
        + record(15, struct.pack("<I", 0)) * 0
        + summary * bool(copies)
        + footer
        + magic
    )


def test_65_kilobytes_of_two_gigabytes(tmp_path: Path) -> None:
    from rosbags.rosbag2.storage_mcap import zstd

    size = 2_100_000_000
    machine = zstd.ZstdCompressor()
    piece = bytes(21_000_000)
    compressed = b"".join(machine.compress(piece) for _ in range(100)) + machine.flush()
    for copies in (0, 1):
        path = tmp_path / "small.mcap"
        path.write_bytes(mcap(compressed, size, copies))
        assert path.stat().st_size < 200_000
        with (
            within(40),
            pytest.raises(FileFormatError, match="expands to more than"),
        ):
            a5.trajectory.read_motion(path)


def test_an_index_that_names_a_chunk_many_times(tmp_path: Path) -> None:
    from rosbags.rosbag2.storage_mcap import zstd

    content = record(5, bytes(22) + bytes(2_000_000))
    compressed = zstd.compress(content)
    path = tmp_path / "again.mcap"
    path.write_bytes(mcap(compressed, len(content), copies=900))
    assert path.stat().st_size < 110_000
    with within(80), pytest.raises(FileFormatError, match="expands to more than"):
        a5.trajectory.read_motion(path)


def test_chunks_of_ros_1_that_share_an_index(tmp_path: Path) -> None:
    path = write_bag(tmp_path, ".bag", states(300))
    content = path.read_bytes()
    assert a5.trajectory.read_motion(path).time.size == 300
    place = content.index(b"index_pos=") + len("index_pos=")
    (last,) = struct.unpack_from("<Q", content, place)
    for _ in range(2):  # a connection, its header and its data
        last += 4 + struct.unpack_from("<I", content, last)[0]
    again = content[last:]
    assert b"op=\x06" in again
    once = b"chunk_count=" + struct.pack("<I", 1)
    assert content.count(once) == 1
    many = content.replace(once, b"chunk_count=" + struct.pack("<I", 901))
    path.write_bytes(many + again * 900)
    with within(40), pytest.raises(FileFormatError, match="expands to more than"):
        a5.trajectory.read_motion(path)


FORMULAS = (
    "zeroblob(900000000)",
    "replace(hex(zeroblob(400000)), '0', 'a') LIKE '%a%a%a%a%b'",
)


@pytest.mark.parametrize("formula", FORMULAS)
def test_columns_that_are_formulas(formula: str, tmp_path: Path) -> None:
    path = write_bag(tmp_path, ".db3", states(6))
    with sqlite3.connect(path) as database:
        database.execute("DROP TABLE messages")
        database.execute(
            "CREATE TABLE messages(id INTEGER PRIMARY KEY, "
            "topic_id INTEGER, timestamp INTEGER, "
            f"data BLOB GENERATED ALWAYS AS ({formula}))"
        )
        database.execute("INSERT INTO messages(topic_id, timestamp) VALUES (1, 1)")
    database.close()
    with (
        within(80),
        pytest.raises(FileFormatError, match="columns that are formulas"),
    ):
        a5.trajectory.read_motion(path)


def test_a_table_whose_pages_are_one_page(tmp_path: Path) -> None:
    """Four levels of a B-tree, each with the next one as all of its 300 children."""
    path = write_bag(tmp_path, ".db3", states(6))
    with sqlite3.connect(path) as database:
        database.execute("DROP INDEX timestamp_idx")
        query = "SELECT rootpage FROM sqlite_master WHERE name = 'messages'"
        [[root]] = database.execute(query)
        [[size]] = database.execute("PRAGMA page_size")
        [[count]] = database.execute("PRAGMA page_count")
    database.close()
    content = bytearray(path.read_bytes())
    leaf = content[(root - 1) * size : root * size]
    chain = [root, count + 1, count + 2, count + 3, count + 4]
    content += bytes(4 * size)
    for page, child in pairwise(chain):
        content[(page - 1) * size : page * size] = interior(child, size)
    content[(chain[-1] - 1) * size : chain[-1] * size] = leaf
    content[28:32] = struct.pack(">I", count + 4)
    path.write_bytes(content)
    assert len(content) < 100_000
    with within(80), pytest.raises(FileFormatError, match="expands to more than"):
        a5.trajectory.read_motion(path)


def interior(child: int, size: int) -> bytes:
    """A page of a B-tree of a table with one child 300 times."""
    cells = 300
    cell = struct.pack(">IB", child, 1)
    start = size - cells * len(cell)
    head = struct.pack(">BHHHBI", 5, 0, cells, start, 0, child)
    places = struct.pack(f">{cells}H", *range(start, size, len(cell)))
    gap = bytes(start - len(head) - len(places))
    return head + places + gap + cell * cells


BOMB = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"{b}: &{b} [{', '.join([f'*{a}'] * 9)}]\n"
    for a, b in zip("abcdefgh", "bcdefghi", strict=True)
)
YAML = {
    "aliases": BOMB
    + "rosbag2_bagfile_information: {compression_mode: file, compression_format: *i}",
    "merge": "a: &a {x: 1}\nrosbag2_bagfile_information: {<<: [*a, *a]}",
    "brackets": "[" * 90_000,
    "braces": "{" * 90_000,
    "dashes": "- " * 45_000,
    "code": (
        "rosbag2_bagfile_information: !!python/object/apply:os.system [touch hacked]"
    ),
    "nothing": "",
    "list": "[1, 2]",
    "binary": "\x00\x01",
}


@pytest.mark.parametrize("name", YAML)
def test_metadata_that_grows_or_does_something(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    path = write_bag(tmp_path, "folder", states(6))
    (path / "metadata.yaml").write_text(YAML[name])
    with within(80), pytest.raises(FileFormatError) as caught:
        a5.trajectory.read_motion(path)
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "hacked").exists()


def test_without_our_reading_rosbags_works_as_before(tmp_path: Path) -> None:
    """The limits are those of `read_motion`, not of the library."""
    from rosbags import rosbag2

    path = write_bag(tmp_path, ".mcap", states(6, frame="a" * 2_000_000), "storage")
    with pytest.raises(FileFormatError, match="expands"):
        a5.trajectory.read_motion(path)
    with rosbag2.Reader(path) as bag:
        messages = list(bag.messages())
        [connection] = bag.connections
        assert connection.ext.offered_qos_profiles is not None
    assert sum(len(raw) for *_, raw in messages) > 12_000_000


def test_parquet_that_expands_without_measure(tmp_path: Path) -> None:
    import pyarrow
    from pyarrow import parquet

    zeros = pyarrow.array(np.zeros(3_500_000))
    table = pyarrow.table({"time": zeros} | dict.fromkeys(NAMES, zeros))
    path = tmp_path / "rows.parquet"
    parquet.write_table(table, path)
    assert path.stat().st_size < 300_000
    with (
        within(80),
        pytest.raises(FileFormatError, match=r"expands to more than .* MB"),
    ):
        a5.trajectory.read_motion(path)
    # Equal rows are no harm by themselves, nor is what is not needed.
    small = table.slice(0, 100_000).append_column(
        "note", pyarrow.array(["x" * 999] * 100_000)
    )
    steps = pyarrow.array(0.01 * np.arange(100_000))
    parquet.write_table(small.set_column(0, "time", steps), path, compression="zstd")
    assert a5.trajectory.read_motion(path).time.size == 100_000


@pytest.mark.slow
def test_a_large_parquet_file_may_expand_by_its_size(tmp_path: Path) -> None:
    """Noise does not compress: a file of 2 MB may hold more than the least limit."""
    import pyarrow
    from pyarrow import parquet

    rng = np.random.default_rng(3)
    noise = pyarrow.array(rng.uniform(1.0, 2.0, 250_000))
    time = pyarrow.array(0.01 * np.arange(250_000))
    note = pyarrow.array(["x" * 999] * 250_000)
    table = pyarrow.table(
        {"time": time} | dict.fromkeys(NAMES, noise) | {"axis_a": noise, "note": note}
    )
    path = tmp_path / "large.parquet"
    parquet.write_table(table, path, compression="zstd")
    assert path.stat().st_size > 2_000_000
    assert a5.trajectory.read_motion(path).time.size == 250_000


def test_wide_parquet_takes_little_memory(tmp_path: Path) -> None:
    import pyarrow
    from pyarrow import parquet

    columns = {f"c{k}": np.zeros(1) for k in range(5000)}
    path = tmp_path / "wide.parquet"
    parquet.write_table(pyarrow.table(columns), path)
    with within(200), pytest.raises(FileFormatError, match="no column for the time"):
        a5.trajectory.read_motion(path)


HEAD = "time,axis_e,axis_d,axis_c,axis_b\n"
MANY = "".join(f"{k / 100},1,1,1,1\n" for k in range(7000))
#: About 100 kB each; the words of the answer, "" if it is a motion.
TABLES = {
    "quotes": ('"' * 90_000, "no column for the time"),
    "commas": ("," * 90_000, "is empty"),
    "separators": (";" * 90_000, "is empty"),
    "lines": ("\n" * 90_000, "is empty"),
    "zero bytes": (HEAD + "\0" * 90_000, "1 fields"),
    "open quote": ('"' + HEAD + MANY, "no column for the time"),
    "quoted": (HEAD + "".join(f'"{k}","1","1","1","1"\n' for k in range(4000)), ""),
    "lines in a quote": (HEAD + '1,"' + "\n" * 90_000 + '",1,1,1\n', "2 fields"),
    "the last line": (HEAD + MANY + "x,1,1,1,1\n" * 71, "line 7002, column 1"),
    "digits": (HEAD + f"{'1' * 300},1,1,1,1\n" * 300, "at most 1e"),
    "one number": (HEAD + "1" * 90_000 + ",1,1,1,1\n", "a finite number"),
    "fields": (HEAD + "1," * 45_000, "45001 fields"),
    "short lines": (HEAD + "1\n" * 45_000, "1 fields"),
    "the same time": (HEAD + "1,1,1,1,1\n" * 9000, "different times"),
    "one column": ("time," + "axis_e," * 14_000, "stands twice"),
    "prefixes": (
        "time," + ",".join(f"p{k}_{n}_pos" for k in range(1500) for n in NAMES),
        "one of",
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", TABLES)
def test_tables_that_nobody_wrote(name: str, tmp_path: Path) -> None:
    content, words = TABLES[name]
    path = tmp_path / "m.csv"
    path.write_text(content)
    with within(100):
        if not words:
            assert a5.trajectory.read_motion(path).time.size == 4000
            return
        with pytest.raises((FileFormatError, InputError)) as caught:
            a5.trajectory.read_motion(path)
    message = str(caught.value)
    assert words in message
    assert "\n" not in message
    assert len(message) <= 1000


def test_a_gap_without_measure() -> None:
    """A gap whose even samples would not fit into memory is refused by savgol only."""
    gap = np.array([*0.01 * np.arange(20), 1e12])
    q = np.tile([3.0, 1.5, 1.4, 1.2], (21, 1))
    # Two hours without a sample are no harm.
    hours = np.array([*0.01 * np.arange(20), 7200.0])
    smooth = a5.trajectory.smooth(a5.trajectory.motion(hours, q), "savgol", 20.0)
    np.testing.assert_allclose(smooth.position, q, atol=1e-9)
    # The libraries are loaded by now.
    with within(100):
        with pytest.raises(
            InputError, match="expected spline: a gap of the motion takes 1e"
        ):
            a5.trajectory.smooth(a5.trajectory.motion(gap, q), "savgol")
        a5.trajectory.smooth(a5.trajectory.motion(gap, q), "spline")
