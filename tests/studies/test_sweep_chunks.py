"""The chunks and blocks of a study: how many, with which rows, by which version."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import FileFormatError, InputError
from alpha5_model.studies.sweep import chunks as of_chunks
from alpha5_model.studies.sweep import states as of_states
from alpha5_model.studies.sweep.blocks import blocks_of, table_of_block, values_of_row
from alpha5_model.studies.sweep.chunks import (
    Chunks,
    chunks_of,
    compute,
    facts_of_part,
    made_by,
    merge,
)
from alpha5_model.studies.sweep.reductions import empty_reductions
from alpha5_model.studies.sweep.states import states_of
from alpha5_model.studies.sweep.study import Study, read_study

pyarrow = pytest.importorskip("pyarrow")
parquet = pytest.importorskip("pyarrow.parquet")

STUDY = """
samples = {samples}
[axes]
axis_e_pos = 0.1
axis_d_pos = 1.0
axis_c_pos = {{random = [0, 3]}}
axis_b_pos = {{random = [-3, 3]}}
mount_roll = {{from = 0, to = 1, count = {cases}}}
[outputs.all]
quantity = "torque"
as = "{form}"
"""


def study_of(folder: Path, samples: int, cases: int, form: str = "table") -> Study:
    """A study of so many random states in each of so many cases."""
    file = folder / "study.toml"
    text = STUDY.format(samples=samples, cases=cases, form=form)
    file.write_text(text, encoding="utf-8")
    return read_study(file)


@pytest.mark.parametrize(
    ("samples", "cases", "rows", "of_chunks"),
    [
        (18, 6, 1, [18] * 6),
        (18, 6, 35, [18] * 6),
        (18, 6, 36, [36] * 3),
        (18, 6, 72, [72, 36]),
        (18, 6, 1000, [108]),
        # Blocks of 8192 states: three in a case.
        (20_000, 2, 8192, [8192, 8192, 3616] * 2),
        (20_000, 2, 33_000, [28_192, 11_808]),
    ],
)
def test_chunks_hold_about_as_many_rows_as_asked(
    samples: int, cases: int, rows: int, of_chunks: list[int], tmp_path: Path
) -> None:
    chunks = chunks_of(study_of(tmp_path, samples, cases, "peak"), rows)
    assert chunks.count() == len(of_chunks)
    parts = [compute(chunks, k).part for k in range(chunks.count())]
    assert [int(facts_of_part(part)["rows"]) for part in parts] == of_chunks
    assert sum(of_chunks) == samples * cases


def test_the_largest_number_of_parts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(of_chunks, "MOST_CHUNKS", 6)
    assert chunks_of(study_of(tmp_path, 2, 6), 1).count() == 6
    with pytest.raises(InputError, match="at most 6 parts of 1 rows") as caught:
        chunks_of(study_of(tmp_path, 2, 7), 1)
    assert "14 rows of the study" in str(caught.value)
    assert chunks_of(study_of(tmp_path, 2, 7), 4).count() == 4


def test_a_row_is_found_in_any_block(tmp_path: Path) -> None:
    study = study_of(tmp_path, 20_000, 2)
    tables = [table_of_block(study, block) for block in blocks_of(study, 0, 6)]
    whole = {name: np.concatenate([t[name] for t in tables]) for name in tables[0]}
    assert np.array_equal(whole["row"], np.arange(40_000))
    for row in (0, 8191, 8192, 19_999, 20_000, 36_385, 39_999):
        expected = {name: column[row] for name, column in whole.items()}
        assert values_of_row(study, row) == expected


def test_states_do_not_depend_on_where_their_block_begins(tmp_path: Path) -> None:
    study = study_of(tmp_path, 30, 2)
    whole = states_of(study, None, 0, 30)
    some = states_of(study, None, 7, 12)
    assert np.array_equal(some.number, whole.number[7:12])
    assert np.array_equal(some.motion.position, whole.motion.position[7:12])


@pytest.mark.parametrize(
    ("samples", "cases", "kept"),
    [(32 * 8192, 2, True), (32 * 8192 + 1, 2, False), (9, 2, True), (9, 1, False)],
)
def test_states_are_kept_for_the_next_case_if_there_is_room(
    samples: int, cases: int, kept: bool, tmp_path: Path
) -> None:
    """Thirty-two blocks of 8192 states take some 30 MB."""
    study = study_of(tmp_path, samples, cases)
    again = states_of(study, None, 0, 9) is states_of(study, None, 0, 9)
    assert again is kept


def test_another_version_computes_nothing(tmp_path: Path) -> None:
    chunks = chunks_of(study_of(tmp_path, 3, 2), 1)
    _, _, rest = chunks.head.partition("\n")
    other = replace(chunks, head=f"# alpha5-model 0.0.1, numpy kernels\n{rest}")
    with pytest.raises(
        InputError, match=r"what asks: # alpha5-model 0\.0\.1"
    ) as caught:
        compute(other, 0)
    assert made_by() in str(caught.value)
    kernels = ("compiled kernels", "numpy kernels")
    assert made_by() in {f"alpha5-model {a5.__version__}, {one}" for one in kernels}


def test_axes_are_in_a_dictionary_and_quantities_are_not(tmp_path: Path) -> None:
    """A dictionary takes most of the time for numbers that all differ."""
    rows = compute(chunks_of(study_of(tmp_path, 9, 2), 100), 0).rows
    file = parquet.ParquetFile(pyarrow.BufferReader(rows))
    group = file.metadata.row_group(0)
    columns = [group.column(k) for k in range(group.num_columns)]
    in_dictionary = {
        column.path_in_schema
        for column in columns
        if "RLE_DICTIONARY" in column.encodings
    }
    assert in_dictionary == {"axis_e_pos", "axis_d_pos", "mount_roll"}
    assert "torque.axis_e" in file.schema.names


@pytest.mark.parametrize("damage", ["cut", "other columns", "no metadata"])
def test_a_part_that_is_damaged_behind_its_head_is_named(
    damage: str, tmp_path: Path
) -> None:
    chunks = chunks_of(study_of(tmp_path, 9, 2, "peak"), 100)
    part = compute(chunks, 0).part
    file = tmp_path / "part.parquet"
    if damage == "cut":
        file.write_bytes(part[:-100])
    else:
        table = parquet.read_table(pyarrow.BufferReader(part))
        changed = table.drop_columns(["count"])
        if damage == "no metadata":
            changed = table.replace_schema_metadata(None)
        parquet.write_table(changed, file)
    with pytest.raises(FileFormatError, match=r"part\.parquet: is damaged"):
        merge(file, empty_reductions(chunks.study))


def of_recordings(folder: Path) -> Chunks:
    """A study of two recordings, 100 and 200 samples, in two fluids."""
    for name, count in (("a.csv", 100), ("b.csv", 200)):
        time = np.linspace(0.0, 6.0, count)
        q = np.array([3.1, 1.2, 1.8, 0.0]) + 0.1 * np.sin(time)[:, None]
        head = ",".join(["time", *(f"axis_{x}_pos" for x in "edcb")])
        rows = np.column_stack([time, q])
        np.savetxt(folder / name, rows, delimiter=",", header=head, comments="")
    file = folder / "study.toml"
    file.write_text(
        '[axes]\nrecordings = ["a.csv", "b.csv"]\nfluid_density = [1000, 1025]\n'
        '[outputs.all]\nquantity = "torque"\nas = "table"\n',
        encoding="utf-8",
    )
    return chunks_of(read_study(file), 1)


def test_each_recording_is_a_chunk_with_rows_of_its_own(tmp_path: Path) -> None:
    chunks = of_recordings(tmp_path)
    assert chunks.count() == 2
    tables = []
    for k, samples in enumerate((100, 200)):
        chunk = compute(chunks, k)
        assert facts_of_part(chunk.part)["rows"] == str(2 * samples)
        assert chunk.rows is not None
        tables.append(parquet.read_table(pyarrow.BufferReader(chunk.rows)).to_pylist())
    rows = [row for table in tables for row in table]
    assert len({row["row"] for row in rows}) == len(rows) == 600
    for row in (rows[0], rows[199], rows[-1]):
        assert values_of_row(chunks.study, row["row"]) == row


@pytest.mark.parametrize("said", ["out of paper", ""])
def test_a_recording_that_cannot_be_read_says_why(
    said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By the error's text, or by its kind if it has none."""

    def broken(*_: object, **__: object) -> None:
        raise RuntimeError(*said.splitlines())

    monkeypatch.setattr(of_states, "read_motion", broken)
    chunk = compute(of_recordings(tmp_path), 1)
    facts = facts_of_part(chunk.part)
    assert facts["problem"] == (said or "RuntimeError()")
    assert facts["rows"] == "0"
    assert chunk.rows is None
