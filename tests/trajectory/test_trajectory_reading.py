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


def with_cell(row: int, column: int, text: str) -> list[list[str]]:
    """Rows with a bad one, and another one behind it: a single one is left out."""
    rows = table()
    rows[row][column] = text
    rows[-1] = ["?"] * len(HEADER)
    return rows


BAD = {
    "not a number": (
        HEADER,
        with_cell(4, 2, "high"),
        ",",
        r"line 6, column 3 \(axis_e_pos\).*'high'",
    ),
    "empty cell": (
        HEADER,
        with_cell(0, 1, ""),
        ",",
        r"line 2, column 2 \(axis_b_pos\).*''",
    ),
    "NaN": (
        HEADER,
        with_cell(7, 4, "nan"),
        ",",
        r"line 9, column 5 \(axis_d_pos\).*'nan'",
    ),
    "infinity": (HEADER, with_cell(7, 4, "-inf"), ",", r"line 9, column 5.*'-inf'"),
    "NaN in time": (
        HEADER,
        with_cell(3, 0, "nan"),
        ",",
        r"line 5, column 1 \(time_secs\)",
    ),
    "time goes back": (
        HEADER,
        with_cell(5, 0, "0.2"),
        ",",
        r"line 7, column 1 .*0\.4.* runs back",
    ),
    "short line": (
        HEADER,
        [*table()[:5], table()[5][:-1], ["1"]],
        ",",
        "line 7: 4 fields, expected 5",
    ),
    "long line": (
        HEADER,
        [*table()[:5], [*table()[5], "1"], ["1"]],
        ",",
        "line 7: 6 fields, expected 5",
    ),
    "bars": (HEADER, table(), "|", "line 1.*no column for the time"),
    "no header": (table()[0], table(), ",", "starts with numbers"),
    "missing joint": (
        ["time", "axis_b", "axis_e", "x", "axis_d"],
        table(),
        ",",
        "axis_c_pos",
    ),
    "no time": (["tt", *HEADER[1:]], table(), ",", "no column for the time"),
    "two times": (
        ["time", "time_secs", *HEADER[2:]],
        table(),
        ",",
        "two columns for the time",
    ),
    "doubled column": (
        [*HEADER[:-1], HEADER[1]],
        table(),
        ",",
        "'axis_b_pos' stands twice",
    ),
    "some velocities": (
        [*HEADER, "axis_b_vel"],
        [[*row, "0"] for row in table()],
        ",",
        "velocity of axis_e",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_file_says_where(name: str, tmp_path: Path) -> None:
    header, rows, separator, message = BAD[name]
    path = write(tmp_path / "bad.csv", header, rows, separator)
    with pytest.raises(FileFormatError, match=message) as caught:
        a5.trajectory.read_motion(path)
    assert "\n" not in str(caught.value)
    assert "bad.csv" in str(caught.value)


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


def test_place_counts_blank_lines_and_chunks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("alpha5_model.trajectory.csv_table.CHUNK", 3)
    lines = [",".join(row) for row in [HEADER, *table()]]
    lines[10] = lines[10].replace("0.9", "0.05", 1)
    lines.insert(3, "")
    path = tmp_path / "m.csv"
    path.write_text("\n".join(lines))
    seen: list[float] = []
    with pytest.raises(FileFormatError, match="line 12, column 1"):
        a5.trajectory.read_motion(path, lambda stage, done: seen.append(done))
    assert len(seen) == 4
    assert seen == sorted(seen)
    assert seen[-1] == 1.0


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


@pytest.mark.parametrize(
    ("position", "velocity"),
    [
        ([[1.0], [2.0, 3.0]], None),
        (np.ones((2, 10, 4)), None),
        (np.ones((10, 6)), None),
        (np.ones((10, 4)), np.ones((2, 10, 4))),
        (np.ones((10, 4)), np.ones((10, 5))),
    ],
)
def test_arrays_of_another_shape_are_refused(
    position: object, velocity: object
) -> None:
    with pytest.raises(InputError, match=r"position|velocity"):
        a5.trajectory.motion(np.arange(10.0), position, velocity)  # type: ignore[arg-type]


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


def test_plans_of_few_points_stay_in_seconds(tmp_path: Path) -> None:
    """Steps of 1 are seconds if in milliseconds a joint would pass twice its rating."""
    rated = {
        "axis_e": 0.5235988,
        "axis_d": 0.5235988,
        "axis_c": 0.5235988,
        "axis_b": 0.8726646,
    }
    for column, name in enumerate(HEADER[1:], start=1):
        rated_speed = rated[name.removesuffix("_pos")]
        for share, unit in ((1.99, "ms"), (2.01, "s")):
            rows = [[repr(1.0 * k), "1.5", "1.5", "1.5", "1.5"] for k in range(6)]
            for k, row in enumerate(rows):
                row[column] = repr(1.5 + share * rated_speed * 1e-3 * k)
            path = write(tmp_path / "plan.csv", ["time", *HEADER[1:]], rows)
            assert a5.trajectory.read_motion(path).time_unit == unit


def test_the_median_step_decides_the_unit_of_a_joint_at_rest(tmp_path: Path) -> None:
    for step, unit in ((0.999, "s"), (1.0, "ms"), (999.0, "ms"), (1000.0, "us")):
        path = write(tmp_path / "m.csv", ["time", *HEADER[1:]], in_unit(1.0, step))
        still = [[row[0], "1", "1", "1", "1"] for row in in_unit(1.0, step)]
        path = write(tmp_path / "m.csv", ["time", *HEADER[1:]], still)
        assert a5.trajectory.read_motion(path).time_unit == unit


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


def test_several_columns_of_one_quantity_are_counted(tmp_path: Path) -> None:
    rows = [[*row, row[1], row[1]] for row in table()]
    header = [*HEADER, "axis_e", "axis_e_position"]
    path = write(tmp_path / "m.csv", header, rows)
    expected = (
        "3 columns for the position of axis_e: axis_e_pos, axis_e, axis_e_position"
    )
    with pytest.raises(FileFormatError, match=expected):
        a5.trajectory.read_motion(path)


def test_a_field_may_be_longer_than_the_csv_module_takes(tmp_path: Path) -> None:
    """The csv module takes 131 072 characters in a field."""
    long = "1." + "0" * 140_000
    rows = table()
    rows[3][1] = long
    path = write(tmp_path / "m.csv", HEADER, rows)
    assert a5.trajectory.read_motion(path).position[3, 3] == 1.0
    rows[4][1] = rows[5][1] = "?" * 140_000
    with pytest.raises(FileFormatError, match="line 5: is not a table of numbers"):
        a5.trajectory.read_motion(write(tmp_path / "m.csv", HEADER, rows))


def test_names_of_columns_without_end_are_one_short_error(tmp_path: Path) -> None:
    for header in ([*HEADER[:-1], "x" * 140_000], [*HEADER[:-1], "x" * 100_000]):
        with pytest.raises(FileFormatError, match="line 1") as caught:
            a5.trajectory.read_motion(write(tmp_path / "m.csv", header, table()))
        assert len(str(caught.value)) < 600
    header = [*HEADER, "y" * 1000, "y" * 1000]
    with pytest.raises(
        FileFormatError, match=r"line 1, column 7: column 'y{40}' stands twice"
    ):
        a5.trajectory.read_motion(write(tmp_path / "m.csv", header, table()))


def test_what_no_path_can_be_is_one_error() -> None:
    for name in (None, 3.5, "a\0b"):
        with pytest.raises(InputError, match="path"):
            a5.trajectory.read_motion(name)  # type: ignore[arg-type]
    with pytest.raises(FileFormatError, match="name too long"):
        a5.trajectory.read_motion("x" * 5000)
    with pytest.raises(FileFormatError, match="mcap recover"):
        a5.trajectory.read_motion("x" * 5000 + ".bag")


@pytest.mark.parametrize("size", [1.01e9, 1e300])
def test_what_would_overflow_is_refused(size: float, tmp_path: Path) -> None:
    time = np.arange(10.0)
    q = np.ones((10, 4))
    for argument in ("position", "velocity"):
        arrays = {"position": q.copy(), "velocity": q.copy()}
        arrays[argument][6, 2] = -size
        with pytest.raises(
            InputError, match=rf"axis_c\[6\]: expected a {argument} of at most 1e\+09"
        ) as caught:
            a5.trajectory.motion(time, **arrays)
        assert caught.value.value == -size
        arrays[argument][6, 2] = -1e9
        a5.trajectory.motion(time, **arrays)
    with pytest.raises(
        InputError, match=r"time\[9\]: expected a time of at most 1e\+12"
    ):
        a5.trajectory.motion([*range(9), size * 1e3], q)
    path = write(tmp_path / "m.csv", HEADER, with_cell(4, 2, repr(size)))
    with pytest.raises(FileFormatError, match=r"line 6, column 3 \(axis_e_pos\)"):
        a5.trajectory.read_motion(path)
    path = write(tmp_path / "m.csv", ["time", *HEADER[1:]], in_unit(1e300, 1e6, 12))
    with pytest.raises(FileFormatError, match=r"column 1 \(time\)"):
        a5.trajectory.read_motion(path)


def test_times_nearer_than_a_nanosecond_are_the_same() -> None:
    time = np.arange(10.0)
    q = np.ones((10, 4))
    for step, dropped in ((0.99e-9, 1), (1.01e-9, 0), (0.0, 1)):
        near = np.concatenate([[-step], time])
        motion = a5.trajectory.motion(near, np.ones((11, 4)))
        assert motion.time.size == 11 - dropped
        assert len(motion.warnings) == dropped
    with pytest.raises(InputError, match="5 samples with different times"):
        a5.trajectory.motion(time * 1e-10, q)


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
