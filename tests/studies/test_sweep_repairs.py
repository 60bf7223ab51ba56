"""A folder of results: what its checksums may say, and whose files may be there."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import FileFormatError, InputError
from alpha5_model.studies.sweep import workers

pytest.importorskip("distributed")
pytest.importorskip("pyarrow")

#: Four chunks of two rows, if one asks for one row.
STUDY = """
[axes]
axis_e_pos = 0.1
axis_d_pos = 1.0
axis_c_pos = 1.0
axis_b_pos = [0.0, 1.0]
payload_mass = [0.0, 0.1, 0.2, 0.3]
[outputs.all]
quantity = "torque"
as = "{form}"
"""


def study(folder: Path, form: str = "table") -> Path:
    file = folder / "study.toml"
    file.write_text(STUDY.format(form=form), encoding="utf-8")
    return file


def sums(out: Path, number: int) -> Path:
    return out / "parts" / f"part-00000{number}.sha256"


@pytest.mark.parametrize("form", ["peak", "table"])
def test_a_finished_study_has_nothing_to_repair(form: str, tmp_path: Path) -> None:
    """With rows or without; the work is told chunk by chunk, here without workers."""
    file = study(tmp_path, form)
    told: list[tuple[str, float]] = []
    out = tmp_path / "out"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(workers, "_client", None)
        a5.sweep(file, out, rows=1, progress=lambda *done: told.append(done))
    assert told == [
        ("compute", 0.25),
        ("compute", 0.5),
        ("compute", 0.75),
        ("compute", 1.0),
    ]
    before = {path: path.stat().st_mtime_ns for path in (out / "parts").iterdir()}
    assert len(before) == 8
    found = a5.sweep(file, out, rows=1)
    assert (found.rows, found.repaired, found.foreign) == (8, (), ())
    after = {path: path.stat().st_mtime_ns for path in (out / "parts").iterdir()}
    assert after == before


@pytest.mark.parametrize(
    ("kind", "problem"),
    [
        ("of another part", "part-000001.sha256: is damaged"),
        ("of rows only", "part-000001.sha256: is damaged"),
        ("of one more file", "part-000001.sha256: is damaged"),
        ("of no rows", "rows/part-000001.parquet: has no checksum"),
    ],
)
def test_checksums_of_other_files_are_none(
    kind: str, problem: str, tmp_path: Path
) -> None:
    file = study(tmp_path)
    out = tmp_path / "out"
    a5.sweep(file, out, rows=1)
    whole = sums(out, 1).read_text("utf-8")
    lines = whole.splitlines(keepends=True)
    (part,) = (line for line in lines if "parts/" in line)
    (rows,) = (line for line in lines if "rows/" in line)
    texts = {
        "of another part": sums(out, 2).read_text("utf-8"),
        "of rows only": rows,
        "of one more file": whole + part.replace("parts/", "more/"),
        "of no rows": part,
    }
    sums(out, 1).write_text(texts[kind], encoding="utf-8")
    (line,) = a5.sweep(file, out, rows=1).repaired
    assert line == f"{out}/{problem}" or line == f"{out}/parts/{problem}"
    assert sums(out, 1).read_text("utf-8") == whole


def test_rows_in_a_study_without_a_table_are_foreign(tmp_path: Path) -> None:
    file = study(tmp_path, "peak")
    out = tmp_path / "out"
    a5.sweep(file, out, rows=1)
    (out / "rows").mkdir()
    stray = out / "rows" / "part-000001.parquet"
    stray.touch()
    expected = f"{stray}: is no part of this study; move it away"
    with pytest.raises(FileFormatError, match=f"^{expected}$"):
        a5.sweep(file, out, rows=1)


def test_five_foreign_files_are_all_named(tmp_path: Path) -> None:
    file = study(tmp_path)
    out = tmp_path / "out"
    a5.sweep(file, out, rows=1)
    for name in "abcde":
        (out / "rows" / name).touch()
    with pytest.raises(FileFormatError, match="nor are b, c, d, e; move it away"):
        a5.sweep(file, out, rows=1)


def test_parts_of_another_size_are_refused(tmp_path: Path) -> None:
    file = study(tmp_path)
    a5.sweep(file, tmp_path / "out", rows=1)
    with pytest.raises(InputError, match="of this study in chunks of another size"):
        a5.sweep(file, tmp_path / "out", rows=4)


def test_a_recording_that_is_good_at_last_is_no_repair(tmp_path: Path) -> None:
    """Its results are new, so that they differ from those in the folder."""
    time = np.linspace(0.0, 6.0, 150)
    q = np.array([3.1, 1.2, 1.8, 0.0]) + 0.1 * np.sin(time)[:, None]
    head = ",".join(["time", *(f"axis_{x}_pos" for x in "edcb")])
    rows = np.column_stack([time, q])
    (tmp_path / "a.csv").write_text("nothing")
    file = tmp_path / "study.toml"
    axes = '[axes]\nrecordings = "a.csv"\n'
    output = '[outputs.most]\nquantity = "torque"\nas = "peak"\n'
    file.write_text(f"{axes}{output}", encoding="utf-8")
    first = a5.sweep(file, tmp_path / "out")
    assert set(first.failures) == {"a.csv"}
    assert np.isnan(first.outputs["most"]["axis_d"]).all()
    np.savetxt(tmp_path / "a.csv", rows, delimiter=",", header=head, comments="")
    found = a5.sweep(file, tmp_path / "out")
    assert (found.rows, found.failures, found.repaired) == (150, {}, ())
