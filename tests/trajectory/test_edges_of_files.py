"""Thresholds of files of joint motion, tried on both of their sides."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pyarrow
import pytest
from bag_writer import State, write_bag
from pyarrow import parquet
from rosbags.rosbag2.storage_mcap import zstd
from short_recording import (
    JOINTS,
    POSITION,
    TIME,
    csv,
    kinds,
    motion,
    positions,
    refused,
)

import alpha5_model as a5
from alpha5_model.errors import FileFormatError, InputError
from alpha5_model.trajectory import (
    bag_limits,
    bag_messages,
    mcap_file,
    parquet_table,
)
from alpha5_model.trajectory.bag_limits import Budget
from alpha5_model.trajectory.checks import Origin
from alpha5_model.trajectory.file_table import FileTable
from alpha5_model.trajectory.iso_times import iso_seconds
from alpha5_model.trajectory.joint_map import JointMap
from alpha5_model.trajectory.other_formats import refuse_other_formats
from alpha5_model.trajectory.ros_columns import echoed_names

TAKEN = a5.trajectory.analyse(motion())


# --- names and texts ------------------------------------------------------------------


@pytest.mark.parametrize("joints", [1, 4, 5])
@pytest.mark.parametrize("quantities", [1, 2, 3])
def test_a_row_of_joint_states_is_known_by_its_fields(
    joints: int, quantities: int
) -> None:
    names = ["axis_e", "_b", "/c", "d1", "e"][:joints]
    row = ["12", "500", "base", *names, *["-1.5"] * (joints * quantities)]
    found = echoed_names(row)
    assert found is not None
    assert len(found) == len(row)
    assert found[3:] == [
        *(f"name[{k}]" for k in range(joints)),
        *(f"position[{k}]" for k in range(joints)),
        *(
            [f"{q}[{k}]" for q in ("velocity", "effort") for k in range(joints)]
            if quantities == 3
            else [f"other[{k}]" for k in range(joints * (quantities - 1))]
        ),
    ]
    for other in (row[:-1], [*row, "1.5"], row[1:], ["x", *row[1:]], row[:1], []):
        if joints > 1:
            assert echoed_names(other) is None
    assert echoed_names(row[:3]) is None


@pytest.mark.parametrize("missing", [["r_1"], ["r_2", "r_1"]])
def test_the_first_name_that_a_file_lacks_is_told(missing: list[str]) -> None:
    """With at most 200 characters of what the file has."""
    joints = dict(zip(["axis_e", "axis_d"], missing, strict=False))
    columns = [f"column_{k}" for k in range(40)]
    with pytest.raises(InputError) as caught:
        JointMap(joints).renamed(columns)
    got = ", ".join(columns)[:200]
    words = f"joints[axis_e]: expected a name in {got}, got '{missing[0]}'"
    assert str(caught.value) == words


def test_a_missing_column_is_told_with_200_characters_of_what_is_there(
    tmp_path: Path,
) -> None:
    path = csv(tmp_path / "m.csv", {"time": TIME, "x" * 300: TIME})
    with pytest.raises(FileFormatError) as caught:
        a5.trajectory.read_motion(path)
    assert str(caught.value).endswith(f"got time, {'x' * 194}")


@pytest.mark.parametrize("count", [4, 5, 7])
def test_four_columns_that_are_no_positions_are_explained(
    count: int, tmp_path: Path
) -> None:
    words = ["tau", "acc", "temp", "volt", "power", "limit", "gain"][:count]
    columns = {f"axis_e_{word}": TIME for word in words}
    with pytest.raises(FileFormatError) as caught:
        a5.trajectory.read_motion(csv(tmp_path / "m.csv", {"time": TIME, **columns}))
    told = str(caught.value)
    for words_told in (
        "axis_e_tau is a torque",
        "axis_e_acc is an acceleration",
        "axis_e_temp is a temperature",
        "axis_e_volt is a voltage",
    ):
        assert words_told in told
    assert sum(f"axis_e_{word} is a" in told for word in words) == 4
    assert (f"{count - 4} more" in told) == (count > 4)
    assert (" more" in told) == (count > 4)


def test_the_first_word_of_another_meaning_is_the_reason(tmp_path: Path) -> None:
    columns = {"time": TIME, "axis_e_torque_error_max": TIME}
    with pytest.raises(FileFormatError, match="axis_e_torque_error_max is a torque"):
        a5.trajectory.read_motion(csv(tmp_path / "m.csv", columns))


def test_the_reason_of_a_long_name_is_short(tmp_path: Path) -> None:
    name = "tau_" + "r" * 90 + "_axis_e"
    with pytest.raises(FileFormatError) as caught:
        a5.trajectory.read_motion(csv(tmp_path / "m.csv", {"time": TIME, name: TIME}))
    assert f"; {name[:60]} is a torque" in str(caught.value)


@pytest.mark.parametrize(("blanks", "known"), [(0, True), (99, True), (100, False)])
def test_formats_are_told_by_a_file_s_first_hundred_bytes(
    blanks: int, known: bool
) -> None:
    with refused(known, "is JSON, a CSV file is expected"):
        refuse_other_formats("m.csv", b" " * blanks + b"{}")


def test_what_is_no_date_is_told() -> None:
    with pytest.raises(ValueError, match="expected a date and a time, got 'noon'"):
        iso_seconds("noon")


@pytest.mark.parametrize("rows", [199, 200])
def test_a_second_bad_row_is_left_out_of_two_hundred(rows: int, tmp_path: Path) -> None:
    lines = [f"{0.1 * k},1.5,1.5,1.5,1.5" for k in range(rows)]
    lines[50] = lines[60] = "?"
    path = tmp_path / "m.csv"
    path.write_text("\n".join([",".join(["time", *JOINTS]), *lines]), "utf-8")
    with refused(rows < 200, "line 52: 1 fields, expected 5"):
        assert a5.trajectory.read_motion(path).time.size == 198


# --- lists ----------------------------------------------------------------------------


def listed(folder: Path, names: Any, count: int, info_bytes: int = 0) -> Path:
    """A data set with one column of lists, and its info of some size."""
    path = folder / "data" / "chunk-000" / "episode.parquet"
    path.parent.mkdir(parents=True)
    rows = [[1.5] * count] * TIME.size
    state = pyarrow.array(rows, pyarrow.list_(pyarrow.float64()))
    table = {"timestamp": TIME, "observation.state": state}
    parquet.write_table(pyarrow.table(table), path)
    text = json.dumps({"features": {"observation.state": {"names": names}}})
    (folder / "meta").mkdir()
    (folder / "meta" / "info.json").write_text(text.ljust(info_bytes), "utf-8")
    return path


@pytest.mark.parametrize(("count", "read"), [(256, True), (257, False)])
def test_lists_have_256_names_at_most(count: int, read: bool, tmp_path: Path) -> None:
    names = [*JOINTS, *(f"other_{k}" for k in range(count - 4))]
    with refused(not read, "no column for the position"):
        a5.trajectory.read_motion(listed(tmp_path, names, count))


@pytest.mark.parametrize(("size", "read"), [(1_000_000, True), (1_000_001, False)])
def test_an_info_has_a_megabyte_at_most(size: int, read: bool, tmp_path: Path) -> None:
    with refused(not read, "no column for the position"):
        a5.trajectory.read_motion(listed(tmp_path, JOINTS, 4, size))


@pytest.mark.parametrize("names", [[], {}, {"motors": JOINTS, "others": []}, "axis_e"])
def test_names_in_another_form_are_none(names: Any, tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match="no column for the position"):
        a5.trajectory.read_motion(listed(tmp_path, names, 4))


# --- what files expand to -------------------------------------------------------------


def test_parquet_may_expand_to_a_hundred_megabytes_and_times_its_size(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "m.parquet"
    columns = {"time": TIME, **positions()}
    parquet.write_table(pyarrow.table(columns), path)
    most = 100_000_000 + 100 * path.stat().st_size
    for size in (most, most + 1):
        monkeypatch.setattr(parquet_table, "_expanded_size", lambda *_: size)  # noqa: B023
        with refused(size > most, "MB, 100 times its size"):
            assert a5.trajectory.read_motion(path).time.size == TIME.size


def test_a_number_in_parquet_takes_eight_bytes(tmp_path: Path) -> None:
    """However little equal rows take in the file."""
    lists = pyarrow.array([[1.0] * 5] * 4000, pyarrow.list_(pyarrow.float64()))
    equal = pyarrow.array(np.ones(4000))
    table = pyarrow.table({"one": equal, "two": equal, "lists": lists})
    path = tmp_path / "m.parquet"
    parquet.write_table(table, path, row_group_size=1500)
    metadata = parquet.ParquetFile(path).metadata
    for names, numbers in ((["one"], 1), (["one", "two"], 2), (["lists"], 5)):
        size = parquet_table._expanded_size(metadata, names)
        assert size == 8 * 4000 * numbers


def test_sqlite_may_take_twenty_steps_a_byte(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And a million more; checked every ten thousand."""
    file = tmp_path / "bag.db3"
    with file.open("wb") as stream:
        stream.truncate(50_000_000)
    asked: dict[str, Any] = {}

    class Connection:
        filename = str(file)

        def limit(self, kind: int, size: int) -> None:
            asked["length"] = size

        def set_progress_handler(self, beyond: Callable[[], bool], steps: int) -> None:
            asked["beyond"] = beyond
            asked["steps"] = steps

        def execute(self, query: str) -> list[Any]:
            return []

    budget = Budget(0)
    token = bag_limits._current.set(budget)
    try:
        bag_limits._limit_queries(Connection())
    finally:
        bag_limits._current.reset(token)
    assert asked["length"] == 50_000_000
    checks = (1_000_000 + 20 * 50_000_000) // asked["steps"]
    assert asked["steps"] == 10_000
    assert not any(asked["beyond"]() for _ in range(checks))
    assert not budget.exceeded
    assert asked["beyond"]()
    assert budget.exceeded


@pytest.mark.parametrize("is_limited", [False, True])
def test_a_compressed_file_is_read_whole_without_a_size(is_limited: bool) -> None:
    content = bytes(range(250)) * 4
    packed = io.BytesIO(zstd.compress(content))
    token = bag_limits._current.set(Budget(len(content)) if is_limited else None)
    try:
        with bag_limits._file_opener(zstd)(packed, "rb") as file:
            assert file.read() == content
    finally:
        bag_limits._current.reset(token)


@pytest.mark.parametrize(("levels", "read"), [(20, True), (21, False)])
def test_metadata_of_a_bag_nests_twenty_levels(
    levels: int, read: bool, tmp_path: Path
) -> None:
    file = tmp_path / "metadata.yaml"
    file.write_text("[" * levels + "]" * levels + "\n", "utf-8")
    with refused(not read, "nests deeper than 20 levels"):
        bag_limits._check_metadata("bag", file)
    # Levels that are closed do not count.
    file.write_text("- [{a: [1]}]\n" * 40, "utf-8")
    bag_limits._check_metadata("bag", file)


# --- bags -----------------------------------------------------------------------------


def states(count: int) -> list[State]:
    rest = [3.0, 1.5, 1.4, 1.2]
    return [State(10**18 + k * 10**7, JOINTS, rest) for k in range(count)]


@pytest.mark.parametrize("kind", [".bag", ".mcap"])
def test_reading_a_bag_reports_progress(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bag_messages, "CHUNK", 8)
    path = write_bag(tmp_path, kind, states(20))
    seen: list[tuple[str, float]] = []
    a5.trajectory.read_motion(path, lambda *report: seen.append(report))
    assert seen == [("read", done) for done in (0.4, 0.8, 1.0)]


def test_a_bag_without_the_arm_names_its_four_joints(tmp_path: Path) -> None:
    path = write_bag(tmp_path, ".mcap", [State(10**18, ["a", "b"], [1.0, 2.0])])
    joints = ", ".join(JOINTS)
    with pytest.raises(FileFormatError) as caught:
        a5.trajectory.read_motion(path)
    words = f"no message has all of {joints}, but /joint_states: a, b"
    assert str(caught.value).endswith(words)


@pytest.mark.parametrize("last", [10**11 - 1, 10**11])
def test_simulated_times_are_below_a_hundred_seconds(last: int, tmp_path: Path) -> None:
    """A first stamp of zero is one of them only if another one follows."""
    late = [10**12 + k * 10**7 for k in range(8)]
    rest = [3.0, 1.5, 1.4, 1.2]
    stamps = [0, last, *late]
    bag = [State(s, JOINTS, rest, received=10**15 + s) for s in stamps]
    found = a5.trajectory.read_motion(write_bag(tmp_path, ".mcap", bag))
    assert ("no_stamp" in kinds(found)) == (last >= 10**11)


def test_an_mcap_file_is_written_with_progress_and_for_times_from_zero(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(mcap_file, "CHUNK", 30)
    seen: list[tuple[str, float]] = []
    mcap_file.mcap(TAKEN, lambda *report: seen.append(report))
    assert TAKEN.smooth.time[0] == 0.0
    parts = [30 * k / TIME.size for k in range(3)]
    assert seen == [("write", done) for done in (*parts, 1.0)]

    # The seconds of a stamp have 31 bits.
    for last, late in ((2.0**31, True), (2.0**31 - 0.5, False)):
        time = TAKEN.smooth.time + (last - TAKEN.smooth.time[-1])
        smooth = replace(TAKEN.smooth, time=time)
        with refused(late, "0 to 2147483647 s, as ROS counts"):
            mcap_file.mcap(replace(TAKEN, smooth=smooth))


def test_the_numbers_that_a_parquet_file_claims_are_one_a_row_at_least() -> None:
    """Whatever is written of a column in damaged metadata."""
    column = SimpleNamespace(
        path_in_schema="a", total_uncompressed_size=10, num_values=1
    )
    group = SimpleNamespace(num_columns=1, column=lambda _: column)
    metadata = SimpleNamespace(
        num_rows=1000, num_row_groups=1, row_group=lambda _: group
    )
    assert parquet_table._expanded_size(metadata, ["a"]) == 8 * 1000
    column.total_uncompressed_size = 123_456
    assert parquet_table._expanded_size(metadata, ["a"]) == 123_456
    assert parquet_table._expanded_size(metadata, ["b", "c"]) == 2 * 8 * 1000


def test_an_index_of_ros_1_counts_fifty_times_its_bytes() -> None:
    """Many chunks may claim the same one."""

    def plain(bag: Any, position: int, indexes: Any) -> None:
        bag.bio.seek(position)

    bag = SimpleNamespace(bio=io.BytesIO())
    bag.bio.seek(10)
    budget = Budget(0)
    token = bag_limits._current.set(budget)
    try:
        bag_limits._counted_index(plain)(bag, 30, [])
    finally:
        bag_limits._current.reset(token)
    budget.take(budget.allowed - 50 * 20)
    assert not budget.exceeded
    with pytest.raises(bag_limits._ExceededError):
        budget.take(1)


def test_the_last_of_several_comments_holds_the_names(tmp_path: Path) -> None:
    names = ",".join(["time", *JOINTS])
    rows = [f"{0.1 * k},1.1,1.2,1.3,1.4" for k in range(9)]
    path = tmp_path / "m.csv"
    for before in ([], ["# run 7"], ["# run 7", "# a,b,c,d,e"], ["# 1", "# 2", "# 3"]):
        path.write_text("\n".join([*before, f"# {names}", *rows]), "utf-8")
        found = a5.trajectory.read_motion(path)
        np.testing.assert_array_equal(found.position[4], [1.1, 1.2, 1.3, 1.4])


def test_a_date_is_found_behind_a_short_row(tmp_path: Path) -> None:
    """The time is the last column, and the first row lacks it."""
    head = ",".join([*JOINTS, "time"])
    rows = [f"1.1,1.2,1.3,1.4,2026-11-27T02:00:{k:02d}" for k in range(9)]
    path = tmp_path / "m.csv"
    path.write_text("\n".join([head, "1.1,1.2", *rows]), "utf-8")
    found = a5.trajectory.read_motion(path)
    np.testing.assert_array_equal(np.diff(found.time), np.ones(8))
    assert kinds(found) == ["bad_row"]


def test_the_longest_name_of_a_joint_is_taken() -> None:
    joints = JointMap({"axis_e": "j", "axis_d": "j_2", "axis_c": "j_2_b"})
    names = ["j_pos", "j_2_pos", "left_j_2_b_vel", "jj", "j2"]
    expected = ["axis_e_pos", "axis_d_pos", "left_axis_c_vel", "jj", "j2"]
    assert joints.renamed(names) == expected


def test_long_names_in_rows_are_cut_in_messages(tmp_path: Path) -> None:
    names = ["r" * 60 + f"_{joint}" for joint in JOINTS]
    head = ["time", *(f"name[{k}]" for k in range(4))]
    head += [f"position[{k}]" for k in range(4)]
    rows = [[f"{0.1 * k}", *names, "1", "1", "1", "1"] for k in range(9)]
    path = tmp_path / "m.csv"

    def write() -> None:
        lines = [",".join(row) for row in (head, *rows)]
        path.write_text("\n".join(lines), "utf-8")

    write()
    assert a5.trajectory.read_motion(path).time.size == 9
    rows[3][2] = rows[5][2] = "x" * 90
    write()
    expected, got = names[1][:40], "x" * 40
    words = rf"line 5, column 3 \(name\[1\]\): expected '{expected}', got '{got}'$"
    with pytest.raises(FileFormatError, match=words):
        a5.trajectory.read_motion(path)


def test_a_long_separator_is_cut_in_a_message(tmp_path: Path) -> None:
    path = tmp_path / "m.csv"
    path.write_text(f"sep={'x' * 60}\n1,2\n", "utf-8")
    with pytest.raises(FileFormatError, match=r"line 1: separator 'x{40}', expected"):
        a5.trajectory.read_motion(path)


def test_the_first_row_names_the_joints(tmp_path: Path) -> None:
    """Of a table with names in each row: the last row may be another one's."""
    head = ["time", *(f"name[{k}]" for k in range(4))]
    head += [f"position[{k}]" for k in range(4)]
    rows = [[f"{0.1 * k}", *JOINTS, "1.1", "1.2", "1.3", "1.4"] for k in range(9)]
    rows[-1][1:5] = JOINTS[::-1]
    path = tmp_path / "m.csv"
    path.write_text("\n".join(",".join(row) for row in (head, *rows)), "utf-8")
    found = a5.trajectory.read_motion(path)
    np.testing.assert_array_equal(found.position[:, 0], np.full(8, 1.1))
    assert [(w.kind, w.first) for w in found.warnings] == [
        ("bad_row", "line 10, column 2 (name[0])")
    ]
    path.write_text("\n".join(",".join(row) for row in (head, rows[0])), "utf-8")
    with pytest.raises(InputError, match="at least 5 samples, got 1"):
        a5.trajectory.read_motion(path)


@pytest.mark.parametrize(
    ("base", "methods"),
    [
        (Origin, ["name", "place", "to_radians", "error"]),
        (FileTable, ["read", "place"]),
    ],
)
def test_a_new_format_must_have_all_methods(base: type, methods: list[str]) -> None:
    for missing in methods:
        others = [name for name in methods if name != missing]
        incomplete = type("Incomplete", (base,), dict.fromkeys(others))
        with pytest.raises(TypeError, match=missing):
            incomplete()
    type("Complete", (base,), dict.fromkeys(methods))()


@pytest.mark.parametrize("quantity", ["torque", "vel", "acc", "xyz", "temp", "status"])
def test_an_arm_without_positions_is_no_choice(quantity: str, tmp_path: Path) -> None:
    """Whatever else a file has of another arm's four joints."""
    columns = {f"left_{name}": angles for name, angles in positions().items()}
    columns |= {f"right_{joint}_{quantity}": TIME for joint in JOINTS}
    path = csv(tmp_path / "m.csv", {"time": TIME, **columns})
    np.testing.assert_array_equal(a5.trajectory.read_motion(path).position, POSITION)
