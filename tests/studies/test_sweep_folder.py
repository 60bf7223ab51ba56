"""A folder of results: whatever happened to a file of it is noticed and repaired."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from parquet_files import read_schema, read_table

import alpha5_model as a5
from alpha5_model.cli import main

#: Three chunks of one block each.
STUDY = """# a comment
seed = 2
samples = 20000
[axes]
axis_e_pos = 0.1
axis_d_pos = {random = [0, 200], unit = "deg"}
axis_c_pos = {random = [0, 200], unit = "deg"}
axis_b_pos = {random = [-3, 3]}
[outputs.peak]
quantity = "torque"
as = "peak"
[outputs.spread]
quantity = "torque"
as = "quantile"
levels = [0.5]
[outputs.all]
quantity = "torque"
as = "table"
"""
#: Every file of the results of STUDY.
FILES = (
    "study.toml",
    "summary.json",
    "peak.parquet",
    "spread.parquet",
    *(f"parts/part-00000{k}.parquet" for k in range(3)),
    *(f"parts/part-00000{k}.sha256" for k in range(3)),
    *(f"rows/part-00000{k}.parquet" for k in range(3)),
)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A study, and the folder of its results."""
    folder = tmp_path_factory.mktemp("whole")
    study = folder / "study.toml"
    study.write_text(STUDY, encoding="utf-8")
    found = a5.sweep(study, folder / "out", rows=1)
    assert found.repaired == ()
    assert found.foreign == ()
    return study, folder / "out"


def content(folder: Path) -> dict[str, bytes]:
    """Path -> bytes of every file in a folder."""
    return {
        file.relative_to(folder).as_posix(): file.read_bytes()
        for file in folder.rglob("*")
        if file.is_file()
    }


def flip(file: Path, at: int, bit: int) -> None:
    """Change one bit of a file."""
    changed = bytearray(file.read_bytes())
    changed[at] ^= 1 << bit
    file.write_bytes(changed)


def repaired(whole: tuple[Path, Path], out: Path) -> tuple[str, ...]:
    """What a rerun in a folder repairs; its files are then those of the whole one."""
    study, kept = whole
    found = a5.sweep(study, out, rows=1)
    assert content(out) == content(kept)
    again = a5.sweep(study, out, rows=1)
    assert again.repaired == ()
    return found.repaired


def test_the_files_of_the_results(whole: tuple[Path, Path]) -> None:
    assert set(content(whole[1])) == set(FILES)


@pytest.mark.parametrize(
    "name",
    ["summary.json", "parts/part-000001.parquet", "rows/part-000001.parquet"],
)
def test_a_deleted_file_is_named_and_made_again(
    name: str, whole: tuple[Path, Path], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    shutil.copytree(whole[1], out)
    (out / name).unlink()
    (line,) = repaired(whole, out)
    assert line == f"{out / name}: is missing"


def test_the_command_names_what_it_made_again(
    whole: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    a5.sweep(whole[0], out)
    flip(out / "rows" / "part-000000.parquet", 2000, 3)
    (out / "notes.txt").write_text("mine")
    words = ["sweep", str(whole[0]), "-o", str(out)]
    assert main(words) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert "made again:" in printed
    assert "does not have its checksum" in printed
    assert "not of this study: notes.txt" in printed
    assert (out / "notes.txt").read_text() == "mine"
    assert main([*words, "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["repaired"] == []
    assert record["foreign"] == ["notes.txt"]


def test_a_foreign_file_among_parts_or_rows_is_refused_by_name(
    whole: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A data set of rows would have taken it in."""
    folder = "rows"
    out = tmp_path / "out"
    a5.sweep(whole[0], out)
    for name in ("part-000001.parquet", "z.parquet"):
        shutil.copy(out / "rows" / "part-000000.parquet", out / folder / name)
    (out / folder / ".hidden").touch()
    before = content(out)
    assert main(["sweep", str(whole[0]), "-o", str(out)]) == 2
    printed = capsys.readouterr().err
    assert printed.count("\n") == 1
    assert f"{folder}/part-000001.parquet: is no part of this study" in printed
    assert "nor are z.parquet" in printed
    assert content(out) == before


def test_a_changed_comment_does_not_prevent_going_on(
    whole: tuple[Path, Path], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    shutil.copytree(whole[1], out)
    study = tmp_path / "study.toml"
    text = STUDY.replace("# a comment", "# another one\n\n").replace(
        "[0, 200]", "[0,200]"
    )
    study.write_text(text, encoding="utf-8")
    found = a5.sweep(study, out, rows=1)
    (line,) = found.repaired
    assert line.endswith("study.toml: is not the text of this study")
    changed = content(out)
    before = content(whole[1])
    assert {name for name in FILES if changed[name] != before[name]} == {"study.toml"}
    assert changed["study.toml"].endswith(text.encode())


@pytest.mark.parametrize(
    "change", [("seed = 2", "seed = 3"), ("0.5]", "0.6]"), ("0.1", "0.2")]
)
def test_another_study_is_refused(
    change: tuple[str, str], whole: tuple[Path, Path], tmp_path: Path
) -> None:
    study = tmp_path / "study.toml"
    study.write_text(STUDY.replace(*change), encoding="utf-8")
    with pytest.raises(a5.errors.InputError, match="a part of another study"):
        a5.sweep(study, whole[1], rows=1)


def recording(file: Path, amplitude: float) -> None:
    """A motion of six seconds."""
    time = np.linspace(0, 6, 150)
    q = np.array([3.1, 1.2, 1.8, 0.0]) + amplitude * np.sin(time)[:, None]
    head = ",".join(["time_secs", *(f"axis_{x}_pos" for x in "edcb")])
    rows = np.column_stack([time, q])
    np.savetxt(file, rows, delimiter=",", header=head, comments="")


OF_RECORDINGS = """
[axes]
recordings = ["a.csv", "b.csv"]
fluid_density = [1000, 1025]
[outputs.torque]
quantity = "torque"
as = "peak"
by = ["recording"]
[outputs.all]
quantity = "torque"
as = "table"
"""


def season(folder: Path) -> Path:
    """A study of two recordings."""
    recording(folder / "a.csv", 0.1)
    recording(folder / "b.csv", 0.2)
    study = folder / "study.toml"
    study.write_text(OF_RECORDINGS, encoding="utf-8")
    return study


def test_a_changed_recording_is_computed_again(tmp_path: Path) -> None:
    study = season(tmp_path)
    first = a5.sweep(study, tmp_path / "out")
    recording(tmp_path / "b.csv", 0.3)
    found = a5.sweep(study, tmp_path / "out")
    assert found.repaired == (
        f"{tmp_path / 'b.csv'}: has changed since it was computed",
    )
    fresh = a5.sweep(study, tmp_path / "fresh")
    assert content(tmp_path / "out") == content(tmp_path / "fresh")
    assert fresh.repaired == ()
    before = first.outputs["torque"]["axis_d"]
    after = found.outputs["torque"]["axis_d"]
    assert before[0] == after[0]
    assert before[1] != after[1]


def test_a_recording_that_went_bad_leaves_no_old_rows(tmp_path: Path) -> None:
    study = season(tmp_path)
    a5.sweep(study, tmp_path / "out")
    (tmp_path / "b.csv").write_text("nothing")
    found = a5.sweep(study, tmp_path / "out")
    assert set(found.failures) == {"b.csv"}
    assert found.rows == 300
    rows = read_table(tmp_path / "out" / "rows")
    assert set(rows["recording"].to_pylist()) == {"a.csv"}


def units(file: Path) -> dict[str, str]:
    """Column -> unit in the metadata of its field."""
    fields = read_schema(file)
    metadata = {field.name: field.metadata or {} for field in fields}
    return {name: found.get(b"unit", b"").decode() for name, found in metadata.items()}


def test_every_column_has_its_unit(tmp_path: Path) -> None:
    study = tmp_path / "study.toml"
    text = """
    samples = 5
    [axes]
    axis_e_pos = {values = 90, unit = "deg"}
    axis_d_pos = {random = [0, 200], unit = "deg"}
    axis_c_pos = 1.0
    axis_b_pos = 0.0
    axis_b_vel = 0.1
    payload_mass = {values = [100, 200], unit = "g"}
    corrections = ["none"]
    [outputs.heavy]
    quantity = "power"
    as = "maximum"
    by = ["payload_mass"]
    [outputs.middle]
    quantity = "current"
    as = "quantile"
    levels = [0.5]
    [outputs.bars]
    quantity = "mount_force"
    as = "histogram"
    range = [0, 9]
    bins = 3
    [outputs.all]
    quantity = "reach"
    as = "table"
    """
    study.write_text(text, encoding="utf-8")
    a5.sweep(study, tmp_path / "out")
    rows = units(tmp_path / "out" / "rows" / "part-000000.parquet")
    angles = {f"axis_{x}_pos": "rad" for x in "edcb"}
    reach = {f"reach.{x}": "m" for x in ("x", "y", "z", "norm")}
    of_case = {"row": "", "payload_mass": "kg", "corrections": ""}
    assert rows == {**of_case, **angles, "axis_b_vel": "rad/s", **reach}

    heavy = units(tmp_path / "out" / "heavy.parquet")
    assert heavy["payload_mass"] == "kg"
    assert heavy["axis_d"] == "W"
    assert heavy["axis_d_row"] == ""
    middle = units(tmp_path / "out" / "middle.parquet")
    assert middle["axis_d_low"] == middle["axis_b_high"] == "A"
    assert middle["level"] == ""
    bars = units(tmp_path / "out" / "bars.parquet")
    assert bars == {
        **dict.fromkeys(["low", "high"], "N"),
        **dict.fromkeys("xyz", ""),
        "norm": "",
    }
    found = read_table(tmp_path / "out" / "rows")
    assert found["axis_e_pos"].to_pylist() == pytest.approx([np.pi / 2] * 10)
    summary = json.loads((tmp_path / "out" / "summary.json").read_text("utf-8"))
    outputs = {"heavy": "W", "middle": "A", "bars": "N", "all": "m"}
    assert summary["units"]["outputs"] == outputs
    assert summary["units"]["axes"]["payload_mass"] == "kg"


def test_the_time_of_a_recording_is_in_seconds(tmp_path: Path) -> None:
    a5.sweep(season(tmp_path), tmp_path / "out")
    rows = units(tmp_path / "out" / "rows" / "part-000000.parquet")
    assert rows["time"] == "s"
    assert rows["recording"] == rows["sample"] == ""


def test_a_new_recording_in_a_folder_is_found_in_the_same_process(
    tmp_path: Path,
) -> None:
    (tmp_path / "season").mkdir()
    recording(tmp_path / "season" / "a.csv", 0.1)
    study = tmp_path / "study.toml"
    text = OF_RECORDINGS.replace('["a.csv", "b.csv"]', '"season"')
    study.write_text(text, encoding="utf-8")
    assert a5.sweep(study, tmp_path / "one").rows == 300
    recording(tmp_path / "season" / "b.csv", 0.2)
    assert a5.sweep(study, tmp_path / "two").rows == 600
