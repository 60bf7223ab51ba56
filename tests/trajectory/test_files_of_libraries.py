"""One recording as libraries write it: the same numbers, or one clear line."""

from __future__ import annotations

import csv
from collections.abc import Callable
from datetime import datetime, timedelta
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bag_writer import State, write_bag

import alpha5_model as a5

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

Writer = Callable[[Path], Any]


class Tables:
    """The recording as tables of the libraries, which are loaded by the tests only."""

    def __init__(self) -> None:
        import pandas
        import polars
        import pyarrow

        values = np.column_stack([TIME, POSITION])
        self.frame = pandas.DataFrame(values, columns=COLUMNS)
        self.moving = self.frame.drop(columns="time_secs")
        self.dates = pandas.DatetimeIndex(MOMENTS, name="timestamp")
        self.nanoseconds = self.dates.astype("datetime64[ns]").astype("int64")
        of_names = dict(zip(COLUMNS, values.T, strict=True))
        self.polars = polars.DataFrame(of_names)
        self.arrow = pyarrow.table(of_names)

    def indexed(self, index: Any) -> Any:
        """The positions, with the time as pandas' index."""
        return self.moving.set_axis(index)

    def timed(self, values: Any) -> Any:
        """The positions, with the time as the last column."""
        return self.moving.assign(timestamp=values)


@pytest.fixture(scope="module")
def tables() -> Tables:
    return Tables()


def of_pandas(tables: Tables) -> dict[str, tuple[str, Writer]]:
    """Text files by pandas."""
    import pandas

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
        f"pandas, {name}": (".csv", partial(tables.frame.to_csv, **options))
        for name, options in forms.items()
    }
    frames = {
        "time as index": tables.indexed(pandas.Index(TIME, name="time")),
        "date as index": tables.indexed(tables.dates),
        "date with zone": tables.indexed(tables.dates.tz_localize("UTC")),
        "epoch in ns": tables.timed(tables.nanoseconds),
        "epoch in us": tables.timed(tables.nanoseconds // 1000),
        "epoch in ms": tables.timed(tables.nanoseconds // 1_000_000),
        "epoch in s": tables.timed(tables.nanoseconds / 1e9),
    }
    for name, frame in frames.items():
        found[f"pandas, {name}"] = (".csv", frame.to_csv)
    degrees = tables.moving.apply(np.degrees).add_suffix(" [deg]")
    degrees.insert(0, "time_secs", TIME)
    found["pandas, degrees"] = (".csv", partial(degrees.to_csv, index=False))
    printed = tables.frame.to_string(index=False, float_format="%.8f")
    found["pandas, as it prints"] = (".txt", lambda path: path.write_text(printed))
    return found


def of_parquet(tables: Tables) -> dict[str, tuple[str, Writer]]:
    """Parquet files by pandas, Polars and PyArrow."""
    import pandas
    import polars
    import pyarrow
    from pyarrow import parquet

    without_time = tables.arrow.drop_columns("time_secs")
    seconds = pyarrow.array([timedelta(seconds=float(t)) for t in TIME])
    dates = pyarrow.array(MOMENTS, pyarrow.timestamp("ns"))
    return {
        "pandas, Parquet": (".parquet", tables.frame.to_parquet),
        "pandas, Parquet, time as index": (
            ".parquet",
            tables.indexed(pandas.Index(TIME, name="time")).to_parquet,
        ),
        "pandas, Parquet, date as index": (
            ".parquet",
            tables.indexed(tables.dates).to_parquet,
        ),
        "pandas, Parquet, Zstandard": (
            ".parquet",
            partial(tables.frame.to_parquet, compression="zstd"),
        ),
        "Polars, Parquet": (".parquet", tables.polars.write_parquet),
        "Polars, Parquet, dates": (
            ".parquet",
            tables.polars.drop("time_secs")
            .with_columns(timestamp=polars.Series(MOMENTS))
            .write_parquet,
        ),
        "PyArrow, Parquet, small groups": (
            ".parquet",
            lambda path: parquet.write_table(tables.arrow, path, row_group_size=7),
        ),
        "PyArrow, Parquet, Brotli, version 1.0": (
            ".parquet",
            lambda path: parquet.write_table(
                tables.arrow, path, compression="brotli", version="1.0"
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
    }


def of_others(tables: Tables) -> dict[str, tuple[str, Writer]]:
    """Text files by Polars, PyArrow, NumPy and the standard library."""
    import polars
    import pyarrow.csv

    dated = tables.polars.drop("time_secs").with_columns(
        timestamp=polars.Series(MOMENTS)
    )
    semicolons = pyarrow.csv.WriteOptions(delimiter=";")
    numbers = tables.frame.to_numpy()
    found: dict[str, tuple[str, Writer]] = {
        "Polars": (".csv", tables.polars.write_csv),
        "Polars, semicolons, decimal commas": (
            ".csv",
            partial(tables.polars.write_csv, separator=";", decimal_comma=True),
        ),
        "Polars, seven decimals": (
            ".csv",
            partial(tables.polars.write_csv, float_precision=7),
        ),
        "Polars, all quoted": (
            ".csv",
            partial(tables.polars.write_csv, quote_style="always"),
        ),
        "Polars, with mark": (
            ".csv",
            partial(tables.polars.write_csv, include_bom=True),
        ),
        "Polars, dates": (".csv", dated.write_csv),
        "PyArrow": (".csv", lambda path: pyarrow.csv.write_csv(tables.arrow, path)),
        "PyArrow, semicolons": (
            ".csv",
            lambda path: pyarrow.csv.write_csv(tables.arrow, path, semicolons),
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
        found[f"csv, {dialect}"] = (".csv", partial(write_dialect, tables, dialect))
    return found


def write_dialect(tables: Tables, dialect: str, path: Path) -> None:
    """A CSV by the standard library."""
    with path.open("w", newline="") as stream:
        writer = csv.DictWriter(stream, COLUMNS, dialect=dialect)
        writer.writeheader()
        writer.writerows(tables.frame.to_dict("records"))


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


def test_files_of_libraries_give_the_numbers_back(
    tables: Tables, tmp_path: Path
) -> None:
    forms = of_pandas(tables) | of_parquet(tables) | of_others(tables)
    failures = []
    for name, (suffix, write) in forms.items():
        path = tmp_path / f"recording{suffix}"
        write(path)
        try:
            check(a5.trajectory.read_motion(path))
        except (AssertionError, a5.Alpha5Error) as error:
            failures.append(f"{name}: {error}")
    assert failures == []
    assert len(forms) > 40


@pytest.mark.parametrize(("kind", "compression"), BAGS)
def test_bags_of_rosbags_give_the_numbers_back(
    kind: str, compression: str, tables: Tables, tmp_path: Path
) -> None:
    states = [
        State(stamp=int(stamp), names=JOINTS, position=row.tolist())
        for stamp, row in zip(tables.nanoseconds, POSITION, strict=True)
    ]
    path = write_bag(tmp_path, kind, states, compression)
    check(a5.trajectory.read_motion(path))
