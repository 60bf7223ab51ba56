"""Files of joint motion: what is read, and what is refused with its line and column."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from shared_recordings import JOINT_STATES, needs_recordings

import alpha5_model as a5
from alpha5_model.errors import (
    FileFormatError,
    InputError,
    MissingFileError,
    ShapeError,
)

HEADER = ["time_secs", "axis_b_pos", "axis_e_pos", "axis_c_pos", "axis_d_pos"]


def table(count: int = 12) -> list[list[str]]:
    time = 0.1 * np.arange(count)
    rows = np.stack(
        [time, 1 + 0.1 * time, 2 + 0.2 * time, 1.5 - 0.1 * time, 0.5 + 0.3 * time],
        axis=1,
    )
    return [[repr(float(x)) for x in row] for row in rows]


def write(
    path: Path, header: list[str], rows: list[list[str]], separator: str = ","
) -> Path:
    lines = [separator.join(cells) + "\n" for cells in [header, *rows]]
    path.write_text("".join(lines), "utf-8")
    return path


def test_columns_are_found_by_name(tmp_path: Path) -> None:
    rows = [[*row, "x", *row[1:]] for row in table()]
    header = [*HEADER, "note", *(name.replace("_pos", "_vel") for name in HEADER[1:])]
    motion = a5.trajectory.read_motion(write(tmp_path / "m.csv", header, rows))
    assert motion.joints == ("axis_e", "axis_d", "axis_c", "axis_b")
    assert motion.ignored == ("note",)
    values = {
        name: [float(row[k]) for row in rows]
        for k, name in enumerate(header)
        if name != "note"
    }
    np.testing.assert_array_equal(motion.time, values["time_secs"])
    for k, joint in enumerate(motion.joints):
        np.testing.assert_array_equal(motion.position[:, k], values[f"{joint}_pos"])
        assert motion.velocity is not None
        np.testing.assert_array_equal(motion.velocity[:, k], values[f"{joint}_vel"])
    assert motion.warnings == ()


def test_other_names_blank_lines_byte_order_mark_and_windows_lines(
    tmp_path: Path,
) -> None:
    path = write(tmp_path / "a.csv", HEADER, table())
    plain = a5.trajectory.read_motion(path)
    lines = (
        path.read_text().replace("_pos", "").replace("time_secs", "time").split("\n")
    )
    lines.insert(4, "   ")
    (tmp_path / "b.csv").write_bytes(("﻿" + "\r\n".join(lines) + "\r\n\r\n").encode())
    other = a5.trajectory.read_motion(tmp_path / "b.csv")
    np.testing.assert_array_equal(plain.position, other.position)
    np.testing.assert_array_equal(plain.time, other.time)


def test_a_short_and_a_long_line_do_not_make_two_right_ones(tmp_path: Path) -> None:
    rows = [[*row, "note"] for row in table()]
    rows[3] = rows[3][:-1]
    rows[11] = rows[11][:-1]
    # The missing field is of a column that nobody uses.
    short = write(tmp_path / "short.csv", [*HEADER, "note"], rows)
    with pytest.raises(FileFormatError, match="line 5: 5 fields, expected 6"):
        a5.trajectory.read_motion(short)
    rows[8] = [rows[8][0], *rows[8]]
    for quoted in (False, True):
        if quoted:
            rows[0][-1] = '"a note"'
        path = write(tmp_path / "m.csv", [*HEADER, "note"], rows)
        with pytest.raises(FileFormatError, match="line 5: 5 fields, expected 6"):
            a5.trajectory.read_motion(path)
    rows = [[*row, f'"{"x" * 140_000}"'] for row in table()]
    with pytest.raises(FileFormatError, match="line 2: is not a table of numbers"):
        a5.trajectory.read_motion(write(tmp_path / "m.csv", [*HEADER, "note"], rows))


def test_empty_absent_and_binary(tmp_path: Path) -> None:
    with pytest.raises(MissingFileError):
        a5.trajectory.read_motion(tmp_path / "absent.csv")
    with pytest.raises(FileFormatError, match="folder"):
        a5.trajectory.read_motion(tmp_path)
    for content, message in (
        (b"", "empty"),
        (b"\n\n", "empty"),
        (b"\xff\xfe\x00", "UTF-8"),
    ):
        (tmp_path / "e.csv").write_bytes(content)
        with pytest.raises(FileFormatError, match=message):
            a5.trajectory.read_motion(tmp_path / "e.csv")
    for rows in ([], table(4)):
        path = write(tmp_path / "few.csv", HEADER, rows)
        with pytest.raises(InputError, match="at least 5 samples"):
            a5.trajectory.read_motion(path)


def test_odd_things_are_counted(tmp_path: Path) -> None:
    rows = table(30)
    rows[6][0] = rows[7][0] = rows[5][0]  # two repeated times
    rows[11][1] = "3.9"  # there and back: two jumps of axis_b
    for row in rows[20:]:
        row[0] = repr(float(row[0]) + 5)  # one gap
    rows[25][4] = rows[26][4] = "3.6"  # axis_d beyond its range, two jumps
    motion = a5.trajectory.read_motion(write(tmp_path / "odd.csv", HEADER, rows))
    assert motion.time.size == 28
    found = {(w.kind, w.text.split()[0]): (w.count, w.first) for w in motion.warnings}
    assert found == {
        ("repeated_time", "time"): (2, "line 8, column 1 (time_secs)"),
        ("gap", "more"): (1, "line 22, column 1 (time_secs)"),
        ("jump", "axis_b"): (2, "line 13, column 2 (axis_b_pos)"),
        ("jump", "axis_d"): (2, "line 27, column 5 (axis_d_pos)"),
        ("outside_limits", "axis_d"): (2, "line 27, column 5 (axis_d_pos)"),
    }


def test_motion_from_arrays() -> None:
    time = np.linspace(0, 1, 6)
    q = np.arange(24.0).reshape(6, 4) / 24 + 0.5
    m = a5.trajectory.motion(time, q, joints=["axis_b", "axis_c", "axis_d", "axis_e"])
    np.testing.assert_array_equal(m.position, q[:, ::-1])
    q[:] = 0
    assert m.position.min() > 0
    with pytest.raises(ValueError, match="read-only"):
        m.position[0, 0] = 1.0
    with pytest.raises(InputError, match="each of"):
        a5.trajectory.motion(time, q, joints=["axis_e"] * 4)
    with pytest.raises(InputError, match="runs back"):
        a5.trajectory.motion(time[::-1], q)
    for other in (q[:5], q[..., None], q[0]):
        with pytest.raises(ShapeError, match=r"position.*shape \(6, 4\), or \(6, 5\)"):
            a5.trajectory.motion(time, other)
    bad = q.copy()
    bad[2, 1] = np.nan
    with pytest.raises(InputError, match=r"position\[2, 1\]"):
        a5.trajectory.motion(time, bad)


def in_unit(per_second: float, step: float = 0.1, count: int = 30) -> list[list[str]]:
    rows = table(count)
    for k, row in enumerate(rows):
        row[0] = repr(k * step * per_second)
    return rows


@pytest.mark.parametrize(
    ("name", "unit", "per_second"),
    [
        ("time_ms", "ms", 1e3),
        ("time [ms]", "ms", 1e3),
        ("Time (msecs)", "ms", 1e3),
        ("time_us", "us", 1e6),
        ("TIME [ns]", "ns", 1e9),
        ("time (s)", "s", 1.0),
        ("time_secs", "s", 1.0),
        ("time", "s", 1.0),
    ],
)
def test_unit_of_the_time_in_its_name(
    name: str, unit: str, per_second: float, tmp_path: Path
) -> None:
    path = write(tmp_path / "m.csv", [name, *HEADER[1:]], in_unit(per_second))
    motion = a5.trajectory.read_motion(path)
    np.testing.assert_allclose(motion.time, 0.1 * np.arange(30), rtol=1e-15)
    assert (motion.time_unit, motion.warnings, motion.ignored) == (unit, (), ())


@pytest.mark.parametrize(
    ("unit", "per_second"), [("ms", 1e3), ("us", 1e6), ("ns", 1e9)]
)
def test_time_without_a_unit_is_judged_by_steps_and_speeds(
    unit: str, per_second: float, tmp_path: Path
) -> None:
    header = ["time", *HEADER[1:]]
    motion = a5.trajectory.read_motion(
        write(tmp_path / "m.csv", header, in_unit(per_second))
    )
    np.testing.assert_allclose(motion.time, 0.1 * np.arange(30), rtol=1e-15)
    assert motion.time_unit == unit
    [warning] = motion.warnings
    assert (warning.kind, warning.count, warning.first) == (
        "time_unit",
        1,
        "line 2, column 1 (time)",
    )
    assert warning.text.startswith(f"time read as {unit}, ")
    # A name that says seconds is believed, but the doubt is said.
    header = ["time_secs", *HEADER[1:]]
    motion = a5.trajectory.read_motion(
        write(tmp_path / "n.csv", header, in_unit(per_second))
    )
    assert (motion.time[1], motion.time_unit) == (0.1 * per_second, "s")
    assert f"is it time_{unit}?" in motion.warnings[0].text
    # So is one that says anything else, as long as it is no second.
    header = ["time_us", *HEADER[1:]]
    motion = a5.trajectory.read_motion(
        write(tmp_path / "o.csv", header, in_unit(per_second))
    )
    assert (motion.time[1], motion.warnings) == (
        pytest.approx(0.1 * per_second / 1e6),
        (),
    )


def test_minutes_are_named_and_read_if_asked_for(tmp_path: Path) -> None:
    rows = in_unit(1 / 60)
    for k, row in enumerate(rows):
        row[1] = f"{1.0 + 0.4 * np.sin(0.1 * k)}"
    path = write(tmp_path / "m.csv", ["time", *HEADER[1:]], rows)
    motion = a5.trajectory.read_motion(path)
    assert motion.time[-1] == pytest.approx(2.9 / 60)
    [warning] = [one for one in motion.warnings if one.kind == "time_unit"]
    assert "time:min" in warning.text
    motion = a5.trajectory.read_motion(path, time="time:min")
    np.testing.assert_allclose(motion.time, 0.1 * np.arange(30), atol=1e-14)
    assert (motion.time_unit, motion.warnings) == ("min", ())


@pytest.mark.parametrize("header", [["time"], ["date", "time"]])
def test_dates_that_may_exchange_day_and_month_are_refused(
    header: list[str], tmp_path: Path
) -> None:
    rows = table()
    for k, row in enumerate(rows):
        row[0] = f"11/27/2026 10:00:{k:02d}"
    if len(header) == 2:
        rows = [[*row[0].split(), *row[1:]] for row in rows]
    path = write(tmp_path / "m.csv", [*header, *HEADER[1:]], rows)
    with pytest.raises(FileFormatError, match=r"2026-11-27 or 27\.11\.2026"):
        a5.trajectory.read_motion(path)


def test_two_names_for_the_time(tmp_path: Path) -> None:
    """Times in two other units are refused; beside plain seconds one is ignored."""
    rows = [[*row, row[0]] for row in table()]
    path = write(tmp_path / "m.csv", [*HEADER, "time_ms"], rows)
    motion = a5.trajectory.read_motion(path)
    assert (motion.ignored, motion.time[1]) == (("time_ms",), 0.1)
    path = write(tmp_path / "m.csv", ["time_us", *HEADER[1:], "time_ms"], rows)
    with pytest.raises(
        FileFormatError, match="two columns for the time: time_us, time_ms"
    ):
        a5.trajectory.read_motion(path)


def test_what_no_path_can_be_is_one_error() -> None:
    for name in (None, 3.5, "a\0b"):
        with pytest.raises(InputError, match="path"):
            a5.trajectory.read_motion(name)  # type: ignore[arg-type]
    with pytest.raises(FileFormatError, match="name too long"):
        a5.trajectory.read_motion("x" * 5000)
    with pytest.raises(FileFormatError, match="mcap recover"):
        a5.trajectory.read_motion("x" * 5000 + ".bag")


@needs_recordings
@pytest.mark.parametrize("path", JOINT_STATES, ids=lambda p: getattr(p, "stem", "none"))
def test_recordings_are_read_to_the_last_digit(path: Path) -> None:
    motion = a5.trajectory.read_motion(path)
    with path.open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert motion.joints[-1] == "axis_a"
    assert motion.time.tolist() == [float(row["time_secs"]) for row in rows]
    assert motion.velocity is not None
    for k, joint in enumerate(motion.joints):
        assert motion.position[:, k].tolist() == [
            float(row[f"{joint}_pos"]) for row in rows
        ]
        assert motion.velocity[:, k].tolist() == [
            float(row[f"{joint}_vel"]) for row in rows
        ]
