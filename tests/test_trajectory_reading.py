"""Files of joint motion: what is read, and what is refused with its line and column."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from recordings import JOINT_STATES, needs_recordings

import alpha5_model as a5
from alpha5_model.errors import FileFormatError, InputError, MissingFileError, ShapeError

HEADER = ["time_secs", "axis_b_pos", "axis_e_pos", "axis_c_pos", "axis_d_pos"]


def table(count: int = 12) -> list[list[str]]:
    time = 0.1 * np.arange(count)
    rows = np.stack(
        [time, 1 + 0.1 * time, 2 + 0.2 * time, 1.5 - 0.1 * time, 0.5 + 0.3 * time], axis=1
    )
    return [[repr(float(x)) for x in row] for row in rows]


def write(path: Path, header: list[str], rows: list[list[str]], separator: str = ",") -> Path:
    path.write_text("\n".join(separator.join(line) for line in [header, *rows]) + "\n")
    return path


def test_columns_are_found_by_name(tmp_path: Path) -> None:
    rows = [[*row, "x", *row[1:]] for row in table()]
    header = [*HEADER, "note", *(name.replace("_pos", "_vel") for name in HEADER[1:])]
    motion = a5.trajectory.read_motion(write(tmp_path / "m.csv", header, rows))
    assert motion.joints == ("axis_e", "axis_d", "axis_c", "axis_b")
    assert motion.ignored == ("note",)
    values = {
        name: [float(row[k]) for row in rows] for k, name in enumerate(header) if name != "note"
    }
    np.testing.assert_array_equal(motion.time, values["time_secs"])
    for k, joint in enumerate(motion.joints):
        np.testing.assert_array_equal(motion.position[:, k], values[f"{joint}_pos"])
        assert motion.velocity is not None
        np.testing.assert_array_equal(motion.velocity[:, k], values[f"{joint}_vel"])
    assert motion.warnings == ()


def test_other_names_blank_lines_byte_order_mark_and_windows_lines(tmp_path: Path) -> None:
    path = write(tmp_path / "a.csv", HEADER, table())
    plain = a5.trajectory.read_motion(path)
    lines = path.read_text().replace("_pos", "").replace("time_secs", "time").split("\n")
    lines.insert(4, "   ")
    (tmp_path / "b.csv").write_bytes(("﻿" + "\r\n".join(lines) + "\r\n\r\n").encode())
    other = a5.trajectory.read_motion(tmp_path / "b.csv")
    np.testing.assert_array_equal(plain.position, other.position)
    np.testing.assert_array_equal(plain.time, other.time)


def with_cell(row: int, column: int, text: str) -> list[list[str]]:
    rows = table()
    rows[row][column] = text
    return rows


BAD = {
    "not a number": (
        HEADER,
        with_cell(4, 2, "high"),
        ",",
        r"line 6, column 3 \(axis_e_pos\).*'high'",
    ),
    "empty cell": (HEADER, with_cell(0, 1, ""), ",", r"line 2, column 2 \(axis_b_pos\).*''"),
    "NaN": (HEADER, with_cell(7, 4, "nan"), ",", r"line 9, column 5 \(axis_d_pos\).*'nan'"),
    "infinity": (HEADER, with_cell(7, 4, "-inf"), ",", r"line 9, column 5.*'-inf'"),
    "NaN in time": (HEADER, with_cell(3, 0, "nan"), ",", r"line 5, column 1 \(time_secs\)"),
    "time goes back": (HEADER, with_cell(5, 0, "0.2"), ",", r"line 7, column 1 .*0\.4.* runs back"),
    "short line": (HEADER, [*table()[:5], table()[5][:-1]], ",", "line 7: 4 fields, expected 5"),
    "long line": (HEADER, [*table()[:5], [*table()[5], "1"]], ",", "line 7: 6 fields, expected 5"),
    "semicolons": (HEADER, table(), ";", "line 1.*';', expected ','"),
    "tabs": (HEADER, table(), "\t", "line 1.*a tab, expected ','"),
    "no header": (table()[0], table(), ",", "starts with numbers"),
    "missing joint": (["time", "axis_b", "axis_e", "x", "axis_d"], table(), ",", "axis_c_pos"),
    "no time": (["t", *HEADER[1:]], table(), ",", "no column for the time"),
    "two times": (["time", "time_secs", *HEADER[2:]], table(), ",", "two columns for the time"),
    "doubled column": ([*HEADER[:-1], HEADER[1]], table(), ",", "'axis_b_pos' stands twice"),
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


def test_place_counts_blank_lines_and_chunks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("alpha5_model.trajectory.reading.CHUNK", 3)
    lines = [",".join(row) for row in [HEADER, *with_cell(9, 0, "0.05")]]
    lines.insert(3, "")
    path = tmp_path / "m.csv"
    path.write_text("\n".join(lines))
    seen: list[float] = []
    with pytest.raises(FileFormatError, match="line 12, column 1"):
        a5.trajectory.read_motion(path, lambda stage, done: seen.append(done))
    assert len(seen) == 5
    assert seen == sorted(seen)
    assert seen[-1] == 1.0


def test_empty_absent_and_binary(tmp_path: Path) -> None:
    with pytest.raises(MissingFileError):
        a5.trajectory.read_motion(tmp_path / "absent.csv")
    with pytest.raises(FileFormatError, match="folder"):
        a5.trajectory.read_motion(tmp_path)
    for content, message in ((b"", "empty"), (b"\n\n", "empty"), (b"\xff\xfe\x00", "UTF-8")):
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
    with pytest.raises(ShapeError):
        a5.trajectory.motion(time, q[:5])
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
def test_arrays_of_another_shape_are_refused(position: object, velocity: object) -> None:
    with pytest.raises(InputError, match=r"position|velocity"):
        a5.trajectory.motion(np.arange(10.0), position, velocity)  # type: ignore[arg-type]


@needs_recordings
@pytest.mark.parametrize("path", JOINT_STATES, ids=lambda p: p.stem)
def test_recordings_are_read_to_the_last_digit(path: Path) -> None:
    motion = a5.trajectory.read_motion(path)
    with path.open() as stream:
        rows = list(csv.DictReader(stream))
    assert motion.joints[-1] == "axis_a"
    assert motion.time.tolist() == [float(row["time_secs"]) for row in rows]
    assert motion.velocity is not None
    for k, joint in enumerate(motion.joints):
        assert motion.position[:, k].tolist() == [float(row[f"{joint}_pos"]) for row in rows]
        assert motion.velocity[:, k].tolist() == [float(row[f"{joint}_vel"]) for row in rows]
