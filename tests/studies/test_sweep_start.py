"""What a sweep says before and when it is stopped: size, time, workers, Ctrl-C."""

from __future__ import annotations

import dataclasses
import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import CancelledError
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.errors import InputError, OutputError
from alpha5_model.studies.sweep import extent as of_extent
from alpha5_model.studies.sweep import workers
from alpha5_model.studies.sweep.chunks import Chunks, chunks_of
from alpha5_model.studies.sweep.extent import Extent, extent_of
from alpha5_model.studies.sweep.study import read_study

distributed = pytest.importorskip("distributed")
pytest.importorskip("pyarrow")

STUDY = """
samples = {samples}
[axes]
axis_e_pos = 0.1
axis_d_pos = {{random = [0, 3]}}
axis_c_pos = {{random = [0, 3]}}
axis_b_pos = {{random = [-3, 3]}}
payload_mass = [0, 0.1]
[outputs.all]
quantity = "torque"
as = "{form}"
"""


def written(folder: Path, samples: int, form: str = "peak") -> Path:
    study = folder / "study.toml"
    study.write_text(STUDY.format(samples=samples, form=form), encoding="utf-8")
    return study


def refusal(words: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """The one line with which a command is refused."""
    assert main(words) == 2
    printed = capsys.readouterr().err
    assert printed.count("\n") == 1
    return printed


@pytest.mark.parametrize(
    ("samples", "form", "said"),
    [
        (10**9, "peak", "2,000,000,000 rows in 2,002 parts"),
        (2 * 10**8, "table", "GB of tables"),
    ],
)
def test_a_large_study_is_to_be_confirmed(
    samples: int,
    form: str,
    said: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    study = written(tmp_path, samples, form)
    words = ["sweep", str(study), "-o", str(tmp_path / "out")]
    printed = refusal(words, capsys)
    assert "expected a smaller one, or --yes:" in printed
    assert said in printed
    assert "about" in printed
    assert not (tmp_path / "out").exists()


class StoppedError(Exception):
    """Ends a sweep before its work."""


def extent(study: Path, folder: Path, workers: int = 0) -> Extent:
    """The extent that a sweep announces."""
    found: list[Extent] = []

    def stop(announced: Extent) -> None:
        found.append(announced)
        raise StoppedError

    with pytest.raises(StoppedError):
        a5.sweep(study, folder, workers=workers, announce=stop)
    return found[0]


def test_the_extent_is_that_of_what_is_left(tmp_path: Path) -> None:
    study = written(tmp_path, 2_000_000)
    before = extent(study, tmp_path / "out")
    assert before.rows == 4_000_000
    assert before.of_parts == before.parts == 5
    assert before.table_bytes == 0
    assert not before.is_large

    def stop(stage: str, done: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        a5.sweep(study, tmp_path / "out", progress=stop)
    after = extent(study, tmp_path / "out")
    assert (after.parts, after.of_parts) == (4, 5)
    assert after.rows == 3_200_000


def test_a_small_study_is_not_timed_and_has_no_size_of_tables(tmp_path: Path) -> None:
    """Neither is worth a line before it is done."""
    announced = extent(written(tmp_path, 50, "table"), tmp_path / "out")
    assert announced.rows == 100
    assert announced.table_bytes == 0
    assert announced.seconds is None


def test_the_size_of_tables_is_about_that_of_their_files(tmp_path: Path) -> None:
    study = written(tmp_path, 250_000, "table")
    announced: list[Extent] = []
    a5.sweep(study, tmp_path / "out", announce=announced.append)
    sizes = [file.stat().st_size for file in (tmp_path / "out" / "rows").iterdir()]
    assert announced[0].table_bytes == pytest.approx(sum(sizes), rel=0.3)
    assert announced[0].seconds > 0


def test_more_parts_than_a_folder_can_hold_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study = written(tmp_path, 10**13)
    words = ["sweep", str(study), "-o", str(tmp_path / "out"), "--yes"]
    assert "at most 1048576 parts" in refusal(words, capsys)
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_a_cluster_without_workers_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study = written(tmp_path, 10)
    with distributed.LocalCluster(n_workers=0, dashboard_address=None) as cluster:
        address = cluster.scheduler_address
        words = ["sweep", str(study), "-o", str(tmp_path / "out")]
        printed = refusal([*words, "--scheduler", address], capsys)
    assert "none came within 5 s" in printed
    assert f"dask worker {address}" in printed


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_ctrl_c_with_workers_prints_one_line(tmp_path: Path) -> None:
    """It goes to all processes of the terminal, the workers included."""
    study = written(tmp_path, 400_000_000)
    out = tmp_path / "out"
    # Jobs that a script starts in the background ignore Ctrl-C; their children, too.
    program = (
        "import signal, sys; from alpha5_model.cli import main; "
        "signal.signal(signal.SIGINT, signal.default_int_handler); sys.exit(main())"
    )
    words = [sys.executable, "-c", program, "sweep", str(study), "-o", str(out)]
    with (
        (tmp_path / "said").open("w") as said,
        subprocess.Popen(
            [*words, "--workers", "2"], stderr=said, start_new_session=True
        ) as process,
    ):
        deadline = time.monotonic() + 120
        # Until two parts are there: one whose writing is interrupted is taken back.
        parts = out / "parts"
        while len([*parts.glob("*.sha256")]) < 2 and time.monotonic() < deadline:
            time.sleep(0.1)
        os.killpg(process.pid, signal.SIGINT)
        assert process.wait(120) == 130
    *before, last = (tmp_path / "said").read_text().splitlines()
    assert last == "alpha5: interrupted; the same command goes on with what is left"
    assert len(before) <= 1
    assert all("rows in" in line for line in before)
    assert list(parts.glob("*.sha256"))


def test_workers_keep_their_memory_and_one_thread() -> None:
    from dask import config

    name = "distributed.nanny.pre-spawn-environ"
    before = dict(config.get(name))
    with workers._memory_kept():
        assert "MALLOC_TRIM_THRESHOLD_" not in config.get(name)
        assert config.get(name)["OMP_NUM_THREADS"] == 1
    assert config.get(name) == before


def test_what_is_large_is_a_billion_rows_or_ten_gigabytes() -> None:
    small = Extent(rows=10**9, parts=1, of_parts=1, table_bytes=10**10, seconds=None)
    assert not small.is_large
    assert dataclasses.replace(small, rows=10**9 + 1).is_large
    assert dataclasses.replace(small, table_bytes=10**10 + 1).is_large
    assert not dataclasses.replace(small, rows=None).is_large


#: Cases of one block each.
CASES = """
[axes]
axis_e_pos = 0.1
axis_d_pos = 1.0
axis_c_pos = 1.0
axis_b_pos = {{from = 0, to = 1, count = {states}}}
mount_roll = {{from = 0, to = 1, count = {cases}}}
[outputs.all]
quantity = "torque"
as = "peak"
"""


def chunks(folder: Path, cases: int, states: int = 1) -> Chunks:
    study = folder / "study.toml"
    study.write_text(CASES.format(cases=cases, states=states), encoding="utf-8")
    return chunks_of(read_study(study), 1)


def test_only_a_study_of_more_than_fifty_blocks_is_timed(tmp_path: Path) -> None:
    assert extent_of(chunks(tmp_path, 50), 50, 0).seconds is None
    assert extent_of(chunks(tmp_path, 51), 51, 0).seconds is not None
    assert extent_of(chunks(tmp_path, 60), 50, 0).seconds is None


@pytest.mark.parametrize(
    ("cases", "states", "blocks"), [(60, 1, 60), (30, 8193, 60), (60, 2, 60)]
)
@pytest.mark.parametrize(("workers", "share"), [(0, 1.0), (1, 1.0), (4, 0.25)])
def test_the_time_is_that_of_the_arms_and_of_the_blocks(
    cases: int,
    states: int,
    blocks: int,
    workers: int,
    share: float,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """By a clock that shows 9 s for loading, 5 s with an arm, and 2 s without."""
    clock = iter([100.0, 109.0, 200.0, 205.0, 300.0, 302.0])
    monkeypatch.setattr(of_extent, "perf_counter", lambda: next(clock))
    found = extent_of(chunks(tmp_path, cases, states), blocks, workers)
    assert found.seconds == pytest.approx(share * (cases * 3.0 + blocks * 2.0))
    assert found.rows == cases * states
    assert (found.parts, found.of_parts, found.table_bytes) == (blocks, blocks, 0)
    assert next(clock, None) is None


def test_a_first_block_that_is_faster_needs_no_time_for_its_arm(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = iter([0.0, 9.0, 0.0, 1.0, 0.0, 2.0])
    monkeypatch.setattr(of_extent, "perf_counter", lambda: next(clock))
    assert extent_of(chunks(tmp_path, 60), 60, 0).seconds == 120.0


def test_an_arm_that_cannot_be_is_named_by_its_chunk_not_before(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def impossible(*_: object) -> None:
        raise InputError("mass", -1.0, "one above 0")

    monkeypatch.setattr(of_extent, "_timed", impossible)
    found = extent_of(chunks(tmp_path, 60), 60, 0)
    assert (found.seconds, found.table_bytes) == (0.0, 0)


def test_the_extent_of_recordings_is_their_number(tmp_path: Path) -> None:
    """They are not read before."""
    study = tmp_path / "study.toml"
    axes = '[axes]\nrecordings = ["a.csv", "b.csv", "c.csv"]\n'
    output = '[outputs.all]\nquantity = "torque"\nas = "table"\n'
    study.write_text(f"{axes}{output}", encoding="utf-8")
    found = extent_of(chunks_of(read_study(study), 1), 2, 0)
    assert found == Extent(rows=None, parts=2, of_parts=3, table_bytes=0, seconds=None)


class _Client:
    """A client of Dask whose futures are what they are computed of."""

    def __enter__(self) -> _Client:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def map(self, work: Any, chunks: Any, pure: bool) -> list[Any]:
        return [SimpleNamespace(result=partial(work, chunk)) for chunk in chunks]


@pytest.mark.parametrize(
    ("error", "refused"),
    [
        (distributed.KilledWorker("chunk", SimpleNamespace(address="none"), 3), True),
        (CancelledError("chunk"), True),
        (OSError("no route"), True),
        (RuntimeError("a mistake"), False),
    ],
)
def test_lost_workers_are_told_from_mistakes(
    error: Exception, refused: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def work(chunk: int) -> int:
        if chunk == 2:
            raise error
        return 10 * chunk

    monkeypatch.setattr(workers, "_client", lambda *_: _Client())
    monkeypatch.setattr(distributed, "as_completed", iter)
    found = workers.results(work, [0, 1, 2], 1, None, tmp_path)
    assert [next(found), next(found)] == [0, 10]
    expected = OutputError if refused else type(error)
    said = "the workers are lost" if refused else "a mistake"
    with pytest.raises(expected, match=said):
        next(found)


def test_interrupts_are_ignored_by_the_main_thread_only() -> None:
    """Other threads cannot set what a signal does."""
    before = signal.getsignal(signal.SIGINT)
    inside = []
    with workers._interrupts_ignored():
        inside.append(signal.getsignal(signal.SIGINT))
    assert inside == [signal.SIG_IGN]

    def ignored() -> None:
        with workers._interrupts_ignored():
            inside.append(signal.getsignal(signal.SIGINT))

    thread = threading.Thread(target=ignored)
    thread.start()
    thread.join()
    assert inside == [signal.SIG_IGN, before]
    assert signal.getsignal(signal.SIGINT) is before
