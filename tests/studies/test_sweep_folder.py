"""A folder of results: what is missing is computed, whatever happened before."""

from __future__ import annotations

import itertools
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from parquet_files import read_schema, read_table

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.studies.sweep import parts

#: Three parts of at most `STATES`.
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
#: Many parts for processes that have the package's own `STATES`: one has 64 cases.
CASES = STUDY.replace("samples = 20000", "samples = 10").replace(
    "[outputs.peak]", "payload_mass = {from = 0, to = 1, count = 1000}\n[outputs.peak]"
)
STATES = 8192


@pytest.fixture(scope="module", autouse=True)
def small_parts() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(parts, "STATES", STATES)
        yield


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A study, and the folder of its results."""
    folder = tmp_path_factory.mktemp("whole")
    study = folder / "study.toml"
    study.write_text(STUDY, encoding="utf-8")
    a5.sweep(study, folder / "out")
    return study, folder / "out"


def content(folder: Path) -> dict[str, bytes]:
    """Path -> bytes of every file in a folder, hidden ones included."""
    return {
        file.relative_to(folder).as_posix(): file.read_bytes()
        for file in folder.rglob("*")
        if file.is_file()
    }


def refusal(words: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """The one line with which a command is refused."""
    assert main(words) == 2
    printed = capsys.readouterr().err
    assert printed.count("\n") == 1
    return printed


def test_the_files_of_the_results(whole: tuple[Path, Path]) -> None:
    files = sorted(content(whole[1]))
    tables = [name for name in files if "/" not in name]
    assert tables == ["peak.parquet", "spread.parquet", "study.toml", "summary.json"]
    of_parts = [name.removeprefix("parts/") for name in files if "parts/" in name]
    assert len(of_parts) == 3
    assert [f"rows/{name}" for name in of_parts] == [x for x in files if "rows/" in x]


@pytest.mark.parametrize("folder", ["parts", "rows"])
def test_only_a_missing_part_is_computed(
    folder: str, whole: tuple[Path, Path], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    shutil.copytree(whole[1], out)
    sorted((out / folder).iterdir())[1].unlink()
    done: list[float] = []
    a5.sweep(whole[0], out, progress=lambda _, share: done.append(share))
    assert done == [1.0]
    assert content(out) == content(whole[1])
    a5.sweep(whole[0], out, progress=lambda _, share: done.append(share))
    assert done == [1.0]
    a5.sweep(whole[0], out, restart=True, progress=lambda _, x: done.append(x))
    assert len(done) == 4
    assert content(out) == content(whole[1])


def test_a_run_that_was_stopped_goes_on(
    whole: tuple[Path, Path], tmp_path: Path
) -> None:
    def stop(stage: str, done: float) -> None:
        raise KeyboardInterrupt

    out = tmp_path / "out"
    with pytest.raises(KeyboardInterrupt):
        a5.sweep(whole[0], out, progress=stop)
    assert len([*(out / "parts").iterdir()]) == 1
    assert not (out / "summary.json").exists()
    done: list[float] = []
    a5.sweep(whole[0], out, progress=lambda _, share: done.append(share))
    assert len(done) == 2
    assert content(out) == content(whole[1])


@pytest.mark.slow
@pytest.mark.parametrize(("workers", "times"), [("0", 10), ("2", 3)])
def test_killed_at_random(workers: str, times: int, tmp_path: Path) -> None:
    """A rerun leaves the same files as a run that nobody killed."""
    study = tmp_path / "study.toml"
    study.write_text(CASES, encoding="utf-8")
    a5.sweep(study, tmp_path / "whole")
    out = tmp_path / "out"
    words = ["sweep", str(study), "-o", str(out), "--workers", workers]
    program = "import sys; from alpha5_model.cli import main; sys.exit(main())"
    chance = random.Random(int(workers))
    killed = 0
    for _ in range(times):
        before = len([*out.rglob("*.parquet")])
        with subprocess.Popen(
            [sys.executable, "-c", program, *words],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        ) as process:
            while process.poll() is None and len([*out.rglob("*.parquet")]) == before:
                time.sleep(0.002)
            time.sleep(chance.uniform(0.0, 0.2))
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
                killed += 1
    assert killed > 0
    assert main(words) == 0
    assert content(out) == content(tmp_path / "whole")


def test_a_disk_that_is_full(whole: tuple[Path, Path], tmp_path: Path) -> None:
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, limits[1]))
    try:
        with pytest.raises(a5.errors.OutputError, match=r"cannot write .*rows/"):
            a5.sweep(whole[0], tmp_path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert set(content(tmp_path)) == {"study.toml"}
    a5.sweep(whole[0], tmp_path)
    assert content(tmp_path) == content(whole[1])


def test_a_damaged_part_is_named(whole: tuple[Path, Path], tmp_path: Path) -> None:
    out = tmp_path / "out"
    shutil.copytree(whole[1], out)
    part = min((out / "parts").iterdir())
    part.write_bytes(part.read_bytes()[:-100])
    with pytest.raises(a5.errors.FileFormatError, match=f"{part.name}: is damaged"):
        a5.sweep(whole[0], out)


def test_a_foreign_file_among_the_rows_is_refused_by_name(
    whole: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A data set of rows would have taken it in."""
    out = tmp_path / "out"
    shutil.copytree(whole[1], out)
    (out / "notes.txt").write_text("mine")
    (out / "rows" / ".hidden").touch()
    a5.sweep(whole[0], out)
    shutil.copy(min((out / "rows").iterdir()), out / "rows" / "z.parquet")
    before = content(out)
    words = ["sweep", str(whole[0]), "-o", str(out)]
    assert "move z.parquet away" in refusal(words, capsys)
    assert "move z.parquet away" in refusal([*words, "--restart"], capsys)
    assert "rows/z.parquet" in content(out)
    assert content(out).keys() == before.keys()


def test_comments_and_spaces_are_not_another_study(
    whole: tuple[Path, Path], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    shutil.copytree(whole[1], out)
    study = tmp_path / "study.toml"
    text = STUDY.replace("# a comment", "# another one\n").replace(
        "[0, 200]", "[0,200]"
    )
    study.write_text(text, encoding="utf-8")
    a5.sweep(study, out)
    assert content(out) == {**content(whole[1]), "study.toml": text.encode()}


@pytest.mark.parametrize(
    "change", [("seed = 2", "seed = 3"), ("0.5]", "0.6]"), ("0.1", "0.2")]
)
def test_another_study_is_refused_unless_it_restarts(
    change: tuple[str, str],
    whole: tuple[Path, Path],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    out = tmp_path / "out"
    shutil.copytree(whole[1], out)
    study = tmp_path / "study.toml"
    study.write_text(STUDY.replace(*change), encoding="utf-8")
    words = ["sweep", str(study), "-o", str(out)]
    assert "or to restart: it has parts of another study" in refusal(words, capsys)
    assert content(out) == content(whole[1])
    assert main([*words, "--restart"]) == 0
    a5.sweep(study, tmp_path / "fresh")
    assert content(out) == content(tmp_path / "fresh")


def test_folders_that_cannot_be(
    whole: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study = str(whole[0])
    file = tmp_path / "file"
    file.touch()
    (tmp_path / "taken" / "spread.parquet").mkdir(parents=True)
    for arguments, problem in (
        ([str(tmp_path / "no.toml"), "-o", str(tmp_path / "x")], "no.toml: no such"),
        ([study, "-o", str(file)], "cannot write"),
        ([study, "-o", str(file / "inside")], "cannot write"),
        ([study, "-o", "/proc/no"], "cannot write"),
        ([study, "-o", str(tmp_path / "taken")], "spread.parquet: it is a folder"),
        ([study, "-o", str(tmp_path / "x"), "--scheduler", "nonsense://"], "scheduler"),
    ):
        assert problem in refusal(["sweep", *arguments], capsys)
    assert not (tmp_path / "taken" / "parts").exists()


def test_more_parts_than_a_folder_can_hold_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study = tmp_path / "study.toml"
    study.write_text(STUDY.replace("20000", "10000000000"))
    words = ["sweep", str(study), "-o", str(tmp_path / "out")]
    assert "at most 1048576 parts" in refusal(words, capsys)
    assert not (tmp_path / "out").exists()


def test_one_process_needs_no_dask(
    whole: tuple[Path, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    monkeypatch.setitem(sys.modules, "dask", None)
    a5.sweep(whole[0], tmp_path)
    assert content(tmp_path) == content(whole[1])
    with pytest.raises(a5.errors.MissingDependencyError, match="distributed"):
        a5.sweep(whole[0], tmp_path, workers=1)


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    import distributed

    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None
    ) as cluster:
        yield cluster


@pytest.mark.slow
def test_a_worker_killed_in_the_middle(tmp_path: Path, cluster: Any) -> None:
    """Two workers of a scheduler, given by its address, do as one process does."""
    study = tmp_path / "study.toml"
    study.write_text(CASES.replace("1000", "320"), encoding="utf-8")
    a5.sweep(study, tmp_path / "whole")
    pids = [worker.pid for worker in cluster.workers.values()]

    def accident(stage: str, done: float) -> None:
        if pids:
            os.kill(pids.pop(), signal.SIGKILL)
            pids.clear()

    address = cluster.scheduler_address
    a5.sweep(study, tmp_path / "out", scheduler=address, progress=accident)
    assert not pids
    assert content(tmp_path / "out") == content(tmp_path / "whole")


@pytest.mark.slow
def test_a_cluster_without_workers_is_refused(
    whole: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    import distributed

    with distributed.LocalCluster(n_workers=0, dashboard_address=":0") as cluster:
        address = cluster.scheduler_address
        words = ["sweep", str(whole[0]), "-o", str(tmp_path), "--scheduler", address]
        printed = refusal(words, capsys)
    assert "none came within 5 s" in printed
    assert f"dask worker {address}" in printed


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_ctrl_c_with_workers_prints_one_line(tmp_path: Path) -> None:
    """It goes to all processes of the terminal, the workers included."""
    study = tmp_path / "study.toml"
    study.write_text(CASES.replace("1000", "100000"), encoding="utf-8")
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
        deadline = time.monotonic() + 300
        while len([*out.glob("parts/*.parquet")]) < 2 and time.monotonic() < deadline:
            time.sleep(0.1)
        os.killpg(process.pid, signal.SIGINT)
        assert process.wait(120) == 130
    lines = (tmp_path / "said").read_text().splitlines()
    said = "alpha5: interrupted; the same command goes on with what is left"
    assert lines == [said]
    assert [*out.glob("parts/*.parquet")]


def recording(file: Path, amplitude: float) -> None:
    """A motion of six seconds."""
    time = np.linspace(0, 6, 150)
    q = np.array([3.1, 1.2, 1.8, 0.0]) + amplitude * np.sin(time)[:, None]
    head = ",".join(["time_secs", *(f"axis_{x}_pos" for x in "edcb")])
    rows = np.column_stack([time, q])
    np.savetxt(file, rows, delimiter=",", header=head, comments="")


@pytest.fixture
def season(tmp_path: Path) -> Path:
    """A study of a folder with two recordings."""
    folder = tmp_path / "season"
    folder.mkdir()
    recording(folder / "a.csv", 0.1)
    recording(folder / "b.csv", 0.2)
    (folder / "notes.txt").write_text("no recording")
    study = tmp_path / "study.toml"
    text = """
    [axes]
    recordings = "season"
    fluid_density = [0, 1025]
    [outputs.torque]
    quantity = "torque"
    as = "peak"
    by = ["recording", "fluid_density"]
    [outputs.current]
    quantity = "current"
    as = "table"
    """
    study.write_text(text, encoding="utf-8")
    return study


def test_rows_of_recordings_are_those_of_their_analysis(
    season: Path, tmp_path: Path
) -> None:
    found = a5.sweep(season, tmp_path / "out")
    assert (found.rows, found.failures) == (600, {})
    table = read_table(tmp_path / "out" / "rows").to_pylist()
    assert len(table) == 600
    peaks = iter(found.outputs["torque"]["axis_d"])
    for name in ("season/a.csv", "season/b.csv"):
        motion = a5.trajectory.read_motion(tmp_path / name)
        for density in (0.0, 1025.0):
            analysis = a5.trajectory.analyse(motion, a5.load(density))
            peak = np.abs(analysis.torque[:, 1]).max()
            assert next(peaks) == pytest.approx(peak, rel=1e-12)
            key = name, density
            own = [r for r in table if (r["recording"], r["fluid_density"]) == key]
            current = [row["current.axis_c"] for row in own]
            expected = analysis.current[:, 2]
            np.testing.assert_allclose(current, expected, rtol=1e-9, atol=1e-12)
            assert [row["time"] for row in own] == motion.time.tolist()
            assert found.inputs(own[9]["row"]) == own[9]
    with pytest.raises(a5.errors.InputError, match="row"):
        found.inputs(150)  # the first recording has 150 samples


def test_a_changed_recording_is_computed_again(season: Path, tmp_path: Path) -> None:
    first = a5.sweep(season, tmp_path / "out")
    recording(tmp_path / "season" / "b.csv", 0.3)
    done: list[float] = []
    found = a5.sweep(
        season, tmp_path / "out", progress=lambda _, share: done.append(share)
    )
    assert done == [1.0]
    a5.sweep(season, tmp_path / "fresh")
    assert content(tmp_path / "out") == content(tmp_path / "fresh")
    changed = first.outputs["torque"]["axis_d"] != found.outputs["torque"]["axis_d"]
    assert changed.tolist() == [False, False, True, True]


def test_a_recording_that_changes_meanwhile_is_not_used(
    season: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    computing = parts.quantities_of
    amplitudes = itertools.count(0.3, 0.01)

    def changing(*arguments: Any) -> Any:
        recording(tmp_path / "season" / "b.csv", next(amplitudes))
        return computing(*arguments)

    monkeypatch.setattr(parts, "quantities_of", changing)
    found = a5.sweep(season, tmp_path / "out")
    assert found.failures == {"season/b.csv": "has changed while it was read"}


def test_a_recording_that_went_bad_is_named_and_leaves_no_old_rows(
    season: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    a5.sweep(season, out)
    broken = tmp_path / "season" / "a.csv"
    good = broken.read_text()
    broken.write_text(good.replace("1.8", "one.8"))
    assert main(["sweep", str(season), "--output", str(out)]) == 1
    printed = " ".join(capsys.readouterr().out.split())
    assert "300 rows" in printed
    assert "not used: season/a.csv" in printed
    assert "line " in printed
    summary = json.loads((out / "summary.json").read_text())
    assert "season/a.csv" in summary["failures"]
    names = read_table(out / "rows")["recording"].to_pylist()
    assert set(names) == {"season/b.csv"}

    broken.write_text(good)
    found = a5.sweep(season, out)
    assert (found.rows, found.failures) == (600, {})


def test_a_new_recording_in_a_folder_is_found_in_the_same_process(
    season: Path, tmp_path: Path
) -> None:
    assert a5.sweep(season, tmp_path / "one").rows == 600
    recording(tmp_path / "season" / "c.csv", 0.2)
    assert a5.sweep(season, tmp_path / "two").rows == 900


def units(file: Path) -> dict[str, str]:
    """Column -> unit in the metadata of its field."""
    fields = read_schema(file)
    metadata = {field.name: field.metadata or {} for field in fields}
    return {name: found.get(b"unit", b"").decode() for name, found in metadata.items()}


def test_every_column_has_its_unit(season: Path, tmp_path: Path) -> None:
    study = tmp_path / "units.toml"
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
    out = tmp_path / "units"
    a5.sweep(study, out)
    angles = {f"axis_{x}_pos": "rad" for x in "edcb"}
    reach = {f"reach.{x}": "m" for x in ("x", "y", "z", "norm")}
    of_case = {"row": "", "payload_mass": "kg", "corrections": ""}
    rows = units(min((out / "rows").iterdir()))
    assert rows == {**of_case, **angles, "axis_b_vel": "rad/s", **reach}
    found = read_table(out / "rows")
    assert found["axis_e_pos"].to_pylist() == pytest.approx([np.pi / 2] * 10)

    heavy = units(out / "heavy.parquet")
    assert heavy["payload_mass"] == "kg"
    assert heavy["axis_d"] == "W"
    assert heavy["axis_d_row"] == ""
    middle = units(out / "middle.parquet")
    assert middle["axis_d_low"] == middle["axis_b_high"] == "A"
    assert middle["level"] == ""
    bars = units(out / "bars.parquet")
    assert bars == {"low": "N", "high": "N", "x": "", "y": "", "z": "", "norm": ""}
    summary = json.loads((out / "summary.json").read_text("utf-8"))
    outputs = {"heavy": "W", "middle": "A", "bars": "N", "all": "m"}
    assert summary["units"]["outputs"] == outputs
    assert summary["units"]["axes"]["payload_mass"] == "kg"

    a5.sweep(season, tmp_path / "recorded")
    rows = units(min((tmp_path / "recorded" / "rows").iterdir()))
    assert rows["time"] == "s"
    assert rows["recording"] == rows["sample"] == ""
