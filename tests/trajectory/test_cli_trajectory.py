"""``alpha5 trajectory`` from the command line."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.cli import main

JOINTS = ("axis_e", "axis_d", "axis_c", "axis_b")


@pytest.fixture(autouse=True)
def wide(monkeypatch: pytest.MonkeyPatch) -> None:
    # A terminal this wide breaks neither sentences nor paths.
    monkeypatch.setenv("COLUMNS", "200")


@pytest.fixture
def motion_file(tmp_path: Path) -> Path:
    t = np.arange(0, 6, 0.02)
    q = np.stack(
        [1.5 + amplitude * np.sin(t) for amplitude in (0.4, 0.3, 0.2, 0.5)], axis=1
    )
    rod = 0.007 + 0.002 * np.sin(t)
    path = tmp_path / "motion.csv"
    header = "time," + ",".join(f"{joint}_pos" for joint in (*JOINTS, "axis_a"))
    rows = [
        ",".join(repr(float(x)) for x in row) for row in np.column_stack([t, q, rod])
    ]
    path.write_text("\n".join([header, *rows]) + "\n")
    return path


def test_the_recording_is_not_overwritten(
    motion_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = motion_file.read_bytes()
    around = motion_file.parent / "." / motion_file.name
    assert main(["trajectory", str(motion_file), "--output", str(around)]) == 2
    assert "another file than the one that is read" in capsys.readouterr().err
    assert motion_file.read_bytes() == before


def summary_of(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict:
    assert main(["trajectory", *arguments, "--json"]) == 0
    out = capsys.readouterr()
    assert out.err == ""
    return json.loads(out.out)


def test_json_is_the_library_summary(
    motion_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    motion = a5.trajectory.read_motion(motion_file)
    arm = a5.load(a5.FRESH_WATER, gripper="locked", gravity=(0.5, 0, -9.7))
    expected = a5.trajectory.analyse(
        motion,
        arm,
        bandwidth=3.0,
        constants="torque",
        efficiency="motor",
        supply_voltage=18,
        current_limit=0.5,
    )
    got = summary_of(
        capsys,
        *(
            str(motion_file),
            "--fluid",
            "fresh",
            "--gripper",
            "locked",
            "--gravity",
            "0.5 0 -9.7",
        ),
        *("--bandwidth", "3", "--constants", "torque"),
        *("--efficiency", "motor"),
        *("--supply-voltage", "18", "--current-limit", "0.5"),
    )
    # What the printed digits leave of the peaks is the command's to add.
    state = (
        expected.smooth.position,
        expected.smooth.velocity,
        expected.smooth.acceleration,
    )
    bounds = a5.uncertainty.bounds(*state, arm).torque
    for k, joint in enumerate(got["joints"].values()):
        ends = joint["torque_peak"]["interval"]
        joint["torque_peak"]["interval"] = None
        at = np.abs(expected.torque[:, k]).argmax()
        assert ends == pytest.approx(
            [end[at, k] for end in bounds], rel=1e-9, abs=1e-12
        )
    assert got == json.loads(json.dumps(a5.trajectory.summary(expected)))


def test_defaults_are_those_of_the_library(
    motion_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    expected = a5.trajectory.analyse(a5.trajectory.read_motion(motion_file))
    got = summary_of(capsys, str(motion_file))
    for joint in got["joints"].values():
        low, high = joint["torque_peak"]["interval"]
        joint["torque_peak"]["interval"] = None
        assert low <= joint["torque_peak"]["value"] <= high
    assert got == json.loads(json.dumps(a5.trajectory.summary(expected)))
    assert (got["smoothing"]["method"], got["smoothing"]["bandwidth_hz"]) == (
        "spline",
        2.0,
    )


def test_fluids_and_grippers(
    motion_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for text, density in (
        ("sea", 1025.0),
        ("fresh", 1000.0),
        ("air", 0.0),
        ("870.5", 870.5),
    ):
        got = summary_of(capsys, str(motion_file), "--fluid", text)
        assert got["model"]["fluid_density"] == density
        assert got["model"]["gripper"] == "jaws"
        assert list(got["joints"]) == [*JOINTS, "axis_a"]
    assert got["joints"]["axis_a"]["current_peak"] is None
    got = summary_of(capsys, str(motion_file), "--screw-lead", "0.001")
    assert got["joints"]["axis_a"]["current_peak"]["value"] != 0
    got = summary_of(capsys, str(motion_file), "--gripper", "locked")
    assert list(got["joints"]) == list(JOINTS)
    assert got["ignored_columns"] == ["axis_a"]


@pytest.mark.slow
def test_files_are_written_and_named(
    motion_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = motion_file.parent / "new"
    for table, page, magic in (
        ("a.csv", "a.png", b"\x89PNG"),
        ("b.json", "b.svg", b"<?xml"),
    ):
        arguments = ["--output", str(folder / table), "--plot", str(folder / page)]
        assert main(["trajectory", str(motion_file), *arguments]) == 0
        out = capsys.readouterr().out
        assert f"wrote {folder / table}" in out
        assert f"wrote {folder / page}" in out
        assert (folder / page).read_bytes().startswith(magic)
    assert len((folder / "a.csv").read_text().splitlines()) == 301
    assert (
        len(json.loads((folder / "b.json").read_text())["columns"]["time_secs"]) == 300
    )


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--fluid", "oil"], "sea, fresh, air"),
        (["--fluid", "-3"], "at least 0"),
        (["--gravity", "0 0"], "three numbers"),
        (["--gripper", "open"], "auto, locked, jaws"),
        (["--smoothing", "magic"], "spline, interpolate"),
        (["--bandwidth", "500"], "half the sample rate"),
        (["--bandwidth", "1e-100"], "at least 0.0001 of the sample rate"),
        (["--velocities", "file"], "no velocities"),
        (["--constants", "both"], "printed, torque, voltage"),
        (["--efficiency", "both"], "gearbox, motor"),
        (["--supply-voltage", "24"], "both or neither"),
        (["--screw-lead", "0.001", "--gripper", "locked"], "not part of the motion"),
        (["--output", "x.xls"], ".csv, .json"),
        (["--plot", "x.bmp"], ".png, .pdf, .svg"),
    ],
)
def test_one_line_for_what_cannot_be_used(
    arguments: list[str],
    message: str,
    motion_file: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    before = sorted(motion_file.parent.iterdir())
    files = (
        ["--output", str(motion_file.parent / "out.csv")]
        if "--output" not in arguments
        else []
    )
    assert main(["trajectory", str(motion_file), *files, *arguments]) == 2
    out = capsys.readouterr()
    assert out.out == ""
    assert out.err.count("\n") == 1
    assert message in out.err
    assert sorted(motion_file.parent.iterdir()) == before


def test_jaws_need_the_jaw_column(
    motion_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = motion_file.read_text("utf-8").replace("axis_a_pos", "something")
    motion_file.write_text(text, "utf-8")
    assert main(["trajectory", str(motion_file), "--gripper", "jaws"]) == 2
    assert "axis_a" in capsys.readouterr().err
    got = summary_of(capsys, str(motion_file))
    assert got["model"]["gripper"] == "locked"


def test_progress_is_reported_for_long_work(motion_file: Path) -> None:
    seen: list[tuple[str, float]] = []

    def note(stage: str, done: float) -> None:
        seen.append((stage, done))

    analysis = a5.trajectory.analyse(
        a5.trajectory.read_motion(motion_file, note), progress=note
    )
    a5.trajectory.write(analysis, motion_file.parent / "out.csv", note)
    assert [stage for stage, _ in seen] == ["read", "compute", "write"]
    assert all(done == 1.0 for _, done in seen)
