"""One recording in the forms that spreadsheets and loggers write.

The forms are written here from the numbers, and each must give the numbers back.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from datetime import UTC, datetime, timedelta, timezone
from pathlib import Path

import numpy as np
import pytest
from least_time import assert_linear_time

import alpha5_model as a5
from alpha5_model.cli.program import main
from alpha5_model.errors import FileFormatError
from alpha5_model.trajectory.clock_times import iso_seconds

HEADER = ["time_secs", *(f"axis_{letter}_pos" for letter in "edcb")]
#: (N, 5): the time [s] and positions [rad], none of which is a whole number.
ROWS = [
    [0.125 * k, *(1.5 + 0.0625 * j + 0.0078125 * k for j in range(4))]
    for k in range(24)
]


def text(
    separator: str = ",", decimal: str = ".", end: str = "\n", quote: str = ""
) -> str:
    """The recording as a table."""
    lines = [HEADER, *([repr(x).replace(".", decimal) for x in row] for row in ROWS)]
    return "".join(
        separator.join(f"{quote}{cell}{quote}" for cell in line) + end for line in lines
    )


def written(path: Path, content: str | bytes) -> Path:
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def check(motion: a5.trajectory.Motion) -> None:
    """Compare each number with the recording's."""
    expected = np.array(ROWS)
    np.testing.assert_array_equal(motion.time - motion.time[0], expected[:, 0])
    np.testing.assert_array_equal(motion.position, expected[:, 1:])


SEMICOLONS = text(";", ",")
FORMS: dict[str, str | bytes] = {
    "commas": text(),
    "semicolons": text(";"),
    "semicolons, decimal comma": SEMICOLONS,
    "tabs": text("\t"),
    "tabs, decimal comma": text("\t", ","),
    "quoted": text(quote='"'),
    "quoted, semicolons, decimal comma": text(";", ",", quote='"'),
    "quoted tabs": text("\t", quote='"'),
    "Excel's first line": "sep=;\r\n" + text(";", ",", "\r\n"),
    "Excel's first line, upper case": "SEP=,\r\n" + text(),
    "Excel's first line, quoted": '"sep=;"\n' + SEMICOLONS,
    "Excel's first line, tab": "sep=\t\n" + text("\t"),
    "UTF-8 with mark": text().encode("utf-8-sig"),
    "UTF-8 with mark, first line": ("sep=;\n" + SEMICOLONS).encode("utf-8-sig"),
    "UTF-16": text("\t", ",", "\r\n").encode("utf-16"),
    "UTF-16, little": b"\xff\xfe" + text("\t").encode("utf-16-le"),
    "UTF-16, big": b"\xfe\xff" + text(";").encode("utf-16-be"),
    "old Macintosh lines": text(end="\r"),
    "empty rows of a spreadsheet": SEMICOLONS + ";;;;\n;;;;\n",
    "empty rows between tabs": text("\t") + "\t\t\t\t\n",
    "comment above": "# arm 7, pool\n#\n" + text(),
    "comments between": text().replace("\n1.0,", "\n# marker, one\n1.0,"),
    "names in a comment": "# " + text(),
    "names in a comment, semicolons": "#" + SEMICOLONS,
    "two comments, the names in the last": "# by logger 2\n# " + text("\t"),
    "blank lines": text(end="\n\n"),
    "no last line end": text().rstrip("\n"),
    "blanks around": text(" , "),
    "spaces": text(" "),
    "spaces, decimal comma": text(" ", ","),
    "aligned by spaces": "\n".join(
        "".join(f"{cell:>16}" for cell in line) for line in [HEADER, *ROWS]
    ),
    "names separated by spaces, numbers by tabs": (
        " ".join(HEADER) + "\n" + text("\t").split("\n", 1)[1]
    ),
}


def test_each_form_has_the_same_numbers(tmp_path: Path) -> None:
    failures = []
    for name, content in FORMS.items():
        try:
            motion = a5.trajectory.read_motion(written(tmp_path / "m.csv", content))
            check(motion)
            assert motion.warnings == ()
            assert motion.ignored == ()
        except (AssertionError, a5.Alpha5Error) as error:
            failures.append(f"{name}: {error}")
    assert failures == []


def test_a_comma_is_decimal_only_where_it_separates_nothing(tmp_path: Path) -> None:
    """Thousands are no decimals: two signs in a number are refused."""
    thousands = text(";").replace("1.5;", "1,001.5;")
    with pytest.raises(FileFormatError, match=r"got '1\.001\.5'"):
        a5.trajectory.read_motion(
            written(tmp_path / "m.csv", thousands + "0;0;0;1.1.1;0\n")
        )
    quoted = text(",", ",", quote='"')
    with pytest.raises(FileFormatError, match=r"line 2, column 1.*got '0,0'"):
        a5.trajectory.read_motion(written(tmp_path / "m.csv", quoted))


ISO = {
    "T": lambda t: t.isoformat(timespec="microseconds"),
    "blank": lambda t: t.isoformat(" ", timespec="milliseconds"),
    "Z": lambda t: t.isoformat(timespec="milliseconds") + "Z",
    "zone": lambda t: t.replace(tzinfo=timezone(timedelta(hours=2))).isoformat(),
    "nanoseconds": lambda t: t.isoformat(timespec="microseconds") + "000Z",
    "slashes": lambda t: t.strftime("%Y/%m/%d %H:%M:%S.%f"),
}


@pytest.mark.parametrize("name", ISO)
@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_times_may_be_dates(name: str, separator: str, tmp_path: Path) -> None:
    start = datetime(2026, 2, 28, 23, 59, 58)  # midnight and a month's end follow
    lines = [separator.join(["timestamp", *HEADER[1:]])]
    for seconds, *position in ROWS:
        moment = ISO[name](start + timedelta(seconds=seconds))
        lines.append(separator.join([moment, *map(repr, position)]))
    motion = a5.trajectory.read_motion(written(tmp_path / "m.csv", "\n".join(lines)))
    check(motion)
    assert motion.warnings == ()
    assert motion.time_unit == "s"


def test_dates_against_the_calendar() -> None:
    for moment in (
        datetime(1970, 1, 1, 0, 0, 1, tzinfo=UTC),
        datetime(2024, 2, 29, 12, 30, 15, 250_000, tzinfo=UTC),
        datetime(2026, 11, 23, 1, 2, 3, tzinfo=timezone(-timedelta(hours=9.5))),
    ):
        assert iso_seconds(moment.isoformat()) == moment.timestamp()
    assert iso_seconds("2000-01-01T00:00:00+0100") == 946_681_200.0
    for other in ("2026-02-29T00:00:00", "2026-01-01", "12:00:00", "1e3", "", "x" * 99):
        with pytest.raises(ValueError):
            iso_seconds(other)


def test_more_than_one_bad_row_in_a_hundred_is_an_error(tmp_path: Path) -> None:
    rows = [[0.125 * k, 1.5, 1.5, 1.5, 1.5] for k in range(300)]
    for count in (2, 3, 4):
        lines = [",".join(HEADER), *(",".join(map(repr, row)) for row in rows)]
        for line in range(100, 100 + count):
            lines[line] = "?"
        path = written(tmp_path / "m.csv", "\n".join(lines))
        if count <= 3:
            motion = a5.trajectory.read_motion(path)
            assert motion.time.size == 300 - count
            assert motion.warnings[0].count == count
            continue
        with pytest.raises(FileFormatError, match="line 101: 1 fields, expected 5"):
            a5.trajectory.read_motion(path)


REFUSED = {
    "spaces between names, commas between numbers": (
        " ".join(HEADER) + "\n" + text().split("\n", 1)[1],
        "line 2: 1 fields, expected 5 as in line 1",
    ),
    "a title": ("pool run 7\n" + text(), "no column for the time.*got pool, run, 7"),
    "another first line": ("sep=|\n" + text("|"), r"line 1: separator '\|', expected"),
    "only comments": ("# a\n# b\n", "has comments only"),
    "only a first line": ("sep=;\n", "has comments only"),
    "numbers only": (text().split("\n", 1)[1], "line 1: starts with numbers"),
    "numbers below a short comment": (
        "# by logger 2\n" + text().split("\n", 1)[1],
        "line 2: starts with numbers",
    ),
    "no text": (b"time;axis_e [\xb0]\n\x00;1\n", "UTF-16 or Windows-1252"),
    "half of UTF-16": (text().encode("utf-16")[:-1], "UTF-16 or Windows-1252"),
    "Git LFS": (
        "version https://git-lfs.github.com/spec/v1\n"
        f"oid sha256:{'0' * 64}\nsize 1234\n",
        "is a Git LFS pointer, not the recording: run git lfs pull first",
    ),
}


def test_what_is_refused_is_one_clear_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for content, words in REFUSED.values():
        path = written(tmp_path / "m.csv", content)
        with pytest.raises(FileFormatError, match=words):
            a5.trajectory.read_motion(path)
        assert main(["trajectory", str(path)]) == 2
        out, err = capsys.readouterr()
        assert (out, err.count("\n")) == ("", 1)


def test_a_git_lfs_pointer_is_known_whatever_its_name(tmp_path: Path) -> None:
    pointer = REFUSED["Git LFS"][0]
    for suffix in (".parquet", ".bag", ".db3", ".mcap"):
        with pytest.raises(FileFormatError, match="run git lfs pull first"):
            a5.trajectory.read_motion(written(tmp_path / f"m{suffix}", pointer))


@pytest.mark.slow
@pytest.mark.parametrize("line", ["#" * 100, "?;?", '"', "2026-01-01 00:00:00,1,1,1,1"])
def test_many_odd_lines_take_linear_time(line: str, tmp_path: Path) -> None:
    def prepared(count: int) -> Callable[[], None]:
        path = written(tmp_path / f"{count}.csv", text() + f"{line}\n" * count)

        def read() -> None:
            with suppress(FileFormatError):
                check(a5.trajectory.read_motion(path))

        return read

    assert_linear_time(prepared, 5_000)
