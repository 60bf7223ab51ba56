"""One recording as libraries write it: the same numbers, or one clear line."""

from __future__ import annotations

import bz2
import csv
import gzip
import json
import lzma
import pickle
import zipfile
from collections.abc import Callable
from datetime import datetime, timedelta
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas
import polars
import pyarrow
import pyarrow.csv
import pytest
from bag_writer import State, write_bag
from pyarrow import feather, parquet
from scipy.io import savemat

import alpha5_model as a5
from alpha5_model.errors import FileFormatError

JOINTS = [f"axis_{letter}" for letter in "edcb"]
COLUMNS = ["time_secs", *(f"{joint}_pos" for joint in JOINTS)]
COUNT = 60
TIME = 0.05 * np.arange(COUNT)
_PHASE = 2 * np.pi * TIME[:, None] / np.array([6.0, 4.0, 3.0, 5.0])
_GROWING = np.minimum(TIME[:, None] / 2, 1.0)
POSITION = np.array([3.1, 1.3, 1.6, 2.0]) + 0.3 * np.sin(_PHASE) * _GROWING
START = datetime(2026, 3, 1, 12, 0, 0, 250_000)
MOMENTS = [START + timedelta(seconds=float(t)) for t in TIME]
#: A file gives a number back to so many units [s], [rad].
DIGITS = 1e-6

FRAME = pandas.DataFrame(np.column_stack([TIME, POSITION]), columns=COLUMNS)
MOVING = FRAME.drop(columns="time_secs")
DATES = pandas.DatetimeIndex(MOMENTS, name="timestamp")
NANOSECONDS = DATES.astype("datetime64[ns]").astype("int64")
POLARS = polars.DataFrame({name: FRAME[name].to_numpy() for name in COLUMNS})
ARROW = pyarrow.table({name: FRAME[name].to_numpy() for name in COLUMNS})

Writer = Callable[[Path], Any]


def indexed(index: pandas.Index) -> pandas.DataFrame:
    """The positions, with the time as pandas' index."""
    return MOVING.set_axis(index)


def timed(values: Any) -> pandas.DataFrame:
    """The positions, with the time as the last column."""
    return MOVING.assign(timestamp=values)


def of_pandas() -> dict[str, tuple[str, Writer]]:
    """Text files by pandas."""
    forms: dict[str, dict[str, Any]] = {
        "with its index": {},
        "without index": {"index": False},
        "semicolons, decimal commas": {"sep": ";", "decimal": ",", "index": False},
        "tabs": {"sep": "\t"},
        "UTF-16": {"encoding": "utf-16", "index": False},
        "UTF-8 with mark": {"encoding": "utf-8-sig"},
        "all quoted": {"quoting": csv.QUOTE_ALL, "index": False},
        "names quoted": {"quoting": csv.QUOTE_NONNUMERIC},
        "six decimals": {"float_format": "%.7f", "index": False},
        "powers of ten": {"float_format": "%.8e"},
        "lines of Windows": {"lineterminator": "\r\n"},
        "named index": {"index_label": "row"},
        "blanks": {"sep": " ", "index": False},
    }
    found = {
        f"pandas, {name}": (".csv", partial(FRAME.to_csv, **options))
        for name, options in forms.items()
    }
    frames = {
        "time as index": indexed(pandas.Index(TIME, name="time")),
        "date as index": indexed(DATES),
        "date with zone": indexed(DATES.tz_localize("UTC")),
        "epoch in ns": timed(NANOSECONDS),
        "epoch in us": timed(NANOSECONDS // 1000),
        "epoch in ms": timed(NANOSECONDS // 1_000_000),
        "epoch in s": timed(NANOSECONDS / 1e9),
    }
    for name, frame in frames.items():
        found[f"pandas, {name}"] = (".csv", frame.to_csv)
    degrees = MOVING.apply(np.degrees).add_suffix(" [deg]")
    degrees.insert(0, "time_secs", TIME)
    found["pandas, degrees"] = (".csv", partial(degrees.to_csv, index=False))
    printed = FRAME.to_string(index=False, float_format="%.8f")
    found["pandas, as it prints"] = (".txt", lambda path: path.write_text(printed))
    return found


def of_parquet() -> dict[str, tuple[str, Writer]]:
    """Parquet files by pandas, Polars and PyArrow."""
    without_time = ARROW.drop_columns("time_secs")
    seconds = pyarrow.array([timedelta(seconds=float(t)) for t in TIME])
    dates = pyarrow.array(MOMENTS, pyarrow.timestamp("ns"))
    arrays = {
        "timestamp": TIME,
        "observation.state": [row.tolist() for row in POSITION],
    }
    features = {"features": {"observation.state": {"names": JOINTS}}}
    names = {b"lerobot": json.dumps(features).encode()}
    return {
        "pandas, Parquet": (".parquet", FRAME.to_parquet),
        "pandas, Parquet, time as index": (
            ".parquet",
            indexed(pandas.Index(TIME, name="time")).to_parquet,
        ),
        "pandas, Parquet, date as index": (".parquet", indexed(DATES).to_parquet),
        "pandas, Parquet, Zstandard": (
            ".parquet",
            partial(FRAME.to_parquet, compression="zstd"),
        ),
        "Polars, Parquet": (".parquet", POLARS.write_parquet),
        "Polars, Parquet, dates": (
            ".parquet",
            POLARS.drop("time_secs")
            .with_columns(timestamp=polars.Series(MOMENTS))
            .write_parquet,
        ),
        "PyArrow, Parquet, small groups": (
            ".parquet",
            lambda path: parquet.write_table(ARROW, path, row_group_size=7),
        ),
        "PyArrow, Parquet, Brotli, version 1.0": (
            ".parquet",
            lambda path: parquet.write_table(
                ARROW, path, compression="brotli", version="1.0"
            ),
        ),
        "PyArrow, Parquet, ns": (
            ".parquet",
            lambda path: parquet.write_table(
                without_time.append_column("timestamp", dates), path
            ),
        ),
        "PyArrow, Parquet, durations": (
            ".parquet",
            lambda path: parquet.write_table(
                without_time.append_column("time", seconds), path
            ),
        ),
        "PyArrow, Parquet, LeRobot's arrays": (
            ".parquet",
            lambda path: parquet.write_table(
                pyarrow.table(arrays).replace_schema_metadata(names), path
            ),
        ),
    }


def of_others() -> dict[str, tuple[str, Writer]]:
    """Text files by Polars, PyArrow, NumPy and the standard library."""
    dated = POLARS.drop("time_secs").with_columns(timestamp=polars.Series(MOMENTS))
    semicolons = pyarrow.csv.WriteOptions(delimiter=";")
    numbers = FRAME.to_numpy()
    found: dict[str, tuple[str, Writer]] = {
        "Polars": (".csv", POLARS.write_csv),
        "Polars, semicolons, decimal commas": (
            ".csv",
            partial(POLARS.write_csv, separator=";", decimal_comma=True),
        ),
        "Polars, seven decimals": (
            ".csv",
            partial(POLARS.write_csv, float_precision=7),
        ),
        "Polars, all quoted": (".csv", partial(POLARS.write_csv, quote_style="always")),
        "Polars, with mark": (".csv", partial(POLARS.write_csv, include_bom=True)),
        "Polars, dates": (".csv", dated.write_csv),
        "PyArrow": (".csv", lambda path: pyarrow.csv.write_csv(ARROW, path)),
        "PyArrow, semicolons": (
            ".csv",
            lambda path: pyarrow.csv.write_csv(ARROW, path, semicolons),
        ),
        "NumPy, commas": (
            ".csv",
            lambda path: np.savetxt(
                path, numbers, delimiter=",", header=",".join(COLUMNS)
            ),
        ),
        "NumPy, blanks": (
            ".txt",
            lambda path: np.savetxt(path, numbers, header=" ".join(COLUMNS)),
        ),
    }
    for dialect in ("excel", "excel-tab", "unix"):
        found[f"csv, {dialect}"] = (".csv", partial(write_dialect, dialect))
    return found


def write_dialect(dialect: str, path: Path) -> None:
    """A CSV by the standard library."""
    with path.open("w", newline="") as stream:
        writer = csv.DictWriter(stream, COLUMNS, dialect=dialect)
        writer.writeheader()
        writer.writerows(FRAME.to_dict("records"))


READ = of_pandas() | of_parquet() | of_others()
#: Kind of bag, and how it is compressed.
BAGS = (
    (".bag", ""),
    (".bag", "bz2"),
    (".bag", "lz4"),
    (".db3", ""),
    (".mcap", ""),
    (".mcap", "storage"),
    ("folder", ""),
    ("folder", "message"),
    ("folder", "file"),
)


def check(motion: a5.trajectory.Motion) -> None:
    """Compare each number with the recording's."""
    assert motion.joints == tuple(JOINTS)
    elapsed = motion.time - motion.time[0]
    np.testing.assert_allclose(elapsed, TIME, rtol=0, atol=DIGITS)
    np.testing.assert_allclose(motion.position, POSITION, rtol=0, atol=DIGITS)


@pytest.mark.parametrize("name", READ)
def test_files_of_libraries_give_the_numbers_back(name: str, tmp_path: Path) -> None:
    suffix, write = READ[name]
    path = tmp_path / f"recording{suffix}"
    write(path)
    check(a5.trajectory.read_motion(path))


@pytest.mark.parametrize(("kind", "compression"), BAGS)
def test_bags_of_rosbags_give_the_numbers_back(
    kind: str, compression: str, tmp_path: Path
) -> None:
    states = [
        State(stamp=int(stamp), names=JOINTS, position=row.tolist())
        for stamp, row in zip(NANOSECONDS, POSITION, strict=True)
    ]
    path = write_bag(tmp_path, kind, states, compression)
    check(a5.trajectory.read_motion(path))


def write_zip(path: Path) -> None:
    """An archive with a CSV in it."""
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("recording.csv", FRAME.to_csv())


def savez(path: Path) -> None:
    with path.open("wb") as stream:
        np.savez(stream, time=TIME, position=POSITION)


def save(path: Path) -> None:
    with path.open("wb") as stream:
        np.save(stream, POSITION)


def matlab(path: Path) -> None:
    with path.open("wb") as stream:
        savemat(stream, {"time": TIME, "position": POSITION})


TEXT = FRAME.to_csv(index=False)
#: Form -> what writes it, and what the refusal says.
REFUSED: dict[str, tuple[Writer, str]] = {
    "ZIP": (write_zip, "a ZIP archive"),
    "NumPy, .npz": (savez, "a ZIP archive"),
    "NumPy, .npy": (save, "a NumPy array"),
    "MATLAB": (matlab, "a MATLAB file"),
    "Feather": (
        lambda path: feather.write_feather(ARROW, path, compression="uncompressed"),
        "an Arrow or Feather file",
    ),
    "pickle": (
        lambda path: path.write_bytes(pickle.dumps(FRAME.to_dict())),
        "a pickle",
    ),
    "gzip": (lambda path: path.write_bytes(gzip.compress(TEXT.encode())), "gzip"),
    "bzip2": (lambda path: path.write_bytes(bz2.compress(TEXT.encode())), "bzip2"),
    "xz": (lambda path: path.write_bytes(lzma.compress(TEXT.encode())), "by xz"),
    "Parquet without suffix": (FRAME.to_parquet, "name it .parquet"),
    "JSON": (FRAME.to_json, "is JSON"),
    "JSON lines": (
        partial(FRAME.to_json, orient="records", lines=True),
        "is JSON",
    ),
    "HTML": (FRAME.to_html, "is XML or HTML"),
    "no names": (
        lambda path: np.savetxt(path, FRAME.to_numpy(), delimiter=","),
        "expected column names",
    ),
    "durations in words": (
        MOVING.assign(time=pandas.to_timedelta(TIME, unit="s")).to_csv,
        "got '0 days 00:00:00",
    ),
    "bars": (partial(FRAME.to_csv, sep="|"), "no column for the time"),
}


@pytest.mark.parametrize("form", REFUSED)
def test_other_formats_are_named(form: str, tmp_path: Path) -> None:
    write, words = REFUSED[form]
    path = tmp_path / "recording.csv"
    write(path)
    with pytest.raises(FileFormatError) as refusal:
        a5.trajectory.read_motion(path)
    message = str(refusal.value)
    assert words in message
    assert "\n" not in message
    assert len(message) < 300 + len(str(path))


def test_the_forms_are_many() -> None:
    assert len(READ) + len(BAGS) + len(REFUSED) >= 60
