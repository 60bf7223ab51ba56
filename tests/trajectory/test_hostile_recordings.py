"""Files made to exhaust memory or time are refused; sound compressed files are read."""

from __future__ import annotations

import struct
import tracemalloc
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from bag_writer import State, write_bag

import alpha5_model as a5
from alpha5_model.errors import FileFormatError, InputError

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
    path = write_bag(tmp_path, kind, states(600), compression)
    motion = a5.trajectory.read_motion(path)
    np.testing.assert_array_equal(
        motion.position, np.tile([3.0, 1.5, 1.4, 1.2], (600, 1))
    )
    assert motion.warnings == ()


@pytest.mark.parametrize(
    ("kind", "compression"), [(".bag", "bz2"), (".mcap", "storage")]
)
def test_chunks_that_state_too_much_are_refused_before_they_are_opened(
    kind: str, compression: str, tmp_path: Path
) -> None:
    path = write_bag(tmp_path, kind, states(6, frame="a" * 500_000), compression)
    assert path.stat().st_size < 20_000
    with within(60), pytest.raises(FileFormatError) as caught:
        a5.trajectory.read_motion(path)
    assert "expands" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_frame_that_states_more_than_its_chunk(tmp_path: Path) -> None:
    """65 kB of two gigabytes, in a chunk that states 100 bytes."""
    import zstandard

    machine = zstandard.ZstdCompressor().compressobj(size=2_100_000_000)
    piece = bytes(21_000_000)
    packed = b"".join(machine.compress(piece) for _ in range(100)) + machine.flush()
    head = struct.pack("<QQQI", 1, 2, 100, 0) + struct.pack("<I", 4) + b"zstd"
    chunk = head + struct.pack("<Q", len(packed)) + packed
    path = tmp_path / "small.mcap"
    path.write_bytes(
        b"\x89MCAP0\r\n"
        + struct.pack("<BQII", 1, 8, 0, 0)
        + struct.pack("<BQ", 6, len(chunk))
        + chunk
        + struct.pack("<BQQQI", 2, 20, 0, 0, 0)
        + b"\x89MCAP0\r\n"
    )
    assert path.stat().st_size < 200_000
    with within(40), pytest.raises(FileFormatError, match="expands to more than"):
        a5.trajectory.read_motion(path)


YAML = {
    "brackets": "[" * 90_000,
    "code": (
        "rosbag2_bagfile_information: !!python/object/apply:os.system [touch hacked]"
    ),
    "nothing": "",
    "list": "[1, 2]",
    "binary": "\x00\x01",
    "large": "# " + "x" * 1_100_000,
}


@pytest.mark.parametrize("name", YAML)
def test_metadata_that_nests_or_does_something(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    path = write_bag(tmp_path, "folder", states(6))
    (path / "metadata.yaml").write_text(YAML[name])
    with within(80), pytest.raises(FileFormatError) as caught:
        a5.trajectory.read_motion(path)
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "hacked").exists()


def test_parquet_that_expands_without_measure(tmp_path: Path) -> None:
    import pyarrow
    from pyarrow import parquet

    zeros = pyarrow.array(np.zeros(3_500_000))
    table = pyarrow.table({"time": zeros} | dict.fromkeys(NAMES, zeros))
    path = tmp_path / "rows.parquet"
    parquet.write_table(table, path)
    assert path.stat().st_size < 300_000
    with within(80), pytest.raises(FileFormatError, match="expands to more than"):
        a5.trajectory.read_motion(path)
    # Equal rows are no harm by themselves, nor is what is not needed.
    small = table.slice(0, 100_000).append_column(
        "note", pyarrow.array(["x" * 999] * 100_000)
    )
    steps = pyarrow.array(0.01 * np.arange(100_000))
    parquet.write_table(small.set_column(0, "time", steps), path, compression="zstd")
    assert a5.trajectory.read_motion(path).time.size == 100_000


HEAD = "time,axis_e,axis_d,axis_c,axis_b\n"
MANY = "".join(f"{k / 100},1,1,1,1\n" for k in range(7000))
#: About 100 kB each; a word of the answer.
TABLES = {
    "quotes": ('"' * 90_000, ""),
    "commas": ("," * 90_000, "is empty"),
    "lines": ("\n" * 90_000, "is empty"),
    "zero bytes": (HEAD + "\0" * 90_000, "1 fields"),
    "open quote": ('"' + HEAD + MANY, ""),
    "lines in a quote": (HEAD + '1,"' + "\n" * 90_000 + '",1,1,1\n', "fields"),
    "the last line": (HEAD + MANY + "x,1,1,1,1\n" * 71, "line 7002, column 1"),
    "digits": (HEAD + f"{'1' * 300},1,1,1,1\n" * 300, "at most 1e"),
    "one number": (HEAD + "1" * 90_000 + ",1,1,1,1\n", "a finite number"),
    "fields": (HEAD + "1," * 45_000, "45001 fields"),
    "short lines": (HEAD + "1\n" * 45_000, "1 fields"),
    "the same time": (HEAD + "1,1,1,1,1\n" * 9000, "different times"),
    "one column": ("time," + "axis_e," * 14_000, "stands twice"),
    "a long name": (f"time,{'a_' * 50_000}axis_e\n1,2\n", "no column"),
    "underscores": (f"time,axis_e{'_' * 99_000}\n1,2\n", "no column"),
}


@pytest.mark.parametrize("name", TABLES)
def test_tables_that_nobody_wrote(name: str, tmp_path: Path) -> None:
    content, words = TABLES[name]
    path = tmp_path / "m.csv"
    path.write_text(content)
    with within(100), pytest.raises((FileFormatError, InputError)) as caught:
        a5.trajectory.read_motion(path)
    message = str(caught.value)
    assert words in message
    assert "\n" not in message
    assert len(message) <= 1000
