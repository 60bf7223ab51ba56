"""What a sweep says before it starts, and when it is stopped by Ctrl-C."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.studies.sweep.chunks import Chunks, chunks_of
from alpha5_model.studies.sweep.extent import Extent
from alpha5_model.studies.sweep.study import read_study

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
    import distributed

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
