"""The validation on recordings.

It is proven on artificial recordings with a known answer, then runs on the real ones.
"""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from reference import COB, COM, MASS, VOLUME, inertial_frames
from shared_recordings import RECORDINGS, needs_recordings

from alpha5_model.errors import FileFormatError

SCRIPT = (
    Path(__file__).resolve().parents[2]
    / "scripts"
    / "recordings"
    / "validate_recordings.py"
)
FRESH = 1000.0
STIFFNESS = {"roll": 4.0, "pitch": 5.0}


@pytest.fixture(scope="module")
def script() -> ModuleType:
    spec = importlib.util.spec_from_file_location("validate_recordings", SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def first_moment(q: np.ndarray, mirrored: bool = False) -> np.ndarray:
    """Mass times COM minus displaced mass times COB, summed over links 1 to 4.

    In the base frame [kg m].
    """
    total = np.zeros(3)
    for link, frame in enumerate(inertial_frames(q)[1:], start=1):
        com = np.array(COM[link])
        if mirrored and link == 4:
            com[2] *= -1
        rotation, origin = frame[:3, :3], frame[:3, 3]
        displaced = FRESH * VOLUME[link] / 1000
        total += MASS[link] * (rotation @ com / 1000 + origin)
        total -= displaced * (rotation @ np.array(COB[link]) / 1000 + origin)
    return total


def gravity_in_vehicle(roll: float, pitch: float) -> np.ndarray:
    """R^T g of the rotation yaw-pitch-roll (Z-Y-X); yaw does not matter."""
    return 9.81 * np.array(
        [np.sin(pitch), -np.cos(pitch) * np.sin(roll), -np.cos(pitch) * np.cos(roll)]
    )


def quaternion(roll: float, pitch: float, yaw: float) -> list[float]:
    """x, y, z, w of Z-Y-X angles, by half angles."""
    cr, cp, cy = (np.cos(x / 2) for x in (roll, pitch, yaw))
    sr, sp, sy = (np.sin(x / 2) for x in (roll, pitch, yaw))
    return [
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    ]


def make_recordings(folder: Path, mirrored: bool = False, count: int = 4) -> None:
    """A vehicle with the stiffnesses above that answers 0.3 s late."""
    rng = np.random.default_rng(21)
    step, late = 0.02, 15
    for index in range(count):
        time = np.arange(0, 16, step)
        blend = 0.5 - 0.5 * np.cos(np.pi * np.clip((time - 3) / 8, 0, 1))
        start, end = rng.uniform([0.5, 0.2, 0.2, 0.5], [5.5, 3.2, 3.2, 5.5], (2, 4))
        q = start + np.outer(blend, end - start)
        trim = rng.uniform(-0.05, 0.05, 2)
        tilt = np.zeros((time.size, 2))
        for k in range(time.size):
            before = max(k - late, 0)
            moment = np.cross(
                first_moment(q[before], mirrored), gravity_in_vehicle(*tilt[before])
            )
            tilt[k] = (
                moment[0] / STIFFNESS["roll"] + trim[0],
                moment[1] / STIFFNESS["pitch"] + trim[1],
            )
        name = folder / f"made_up_{index}"
        joints = "time_secs," + ",".join(f"axis_{x}_pos" for x in "edcb")
        write(Path(f"{name}_joint_states.csv"), joints, np.column_stack([time, q]))
        yaw = rng.uniform(-3, 3)
        attitude = [quaternion(roll, pitch, yaw) for roll, pitch in tilt]
        header = "time_secs,x_ori,y_ori,z_ori,w_ori"
        write(Path(f"{name}_mocap.csv"), header, np.column_stack([time, attitude]))


def write(path: Path, header: str, rows: np.ndarray) -> None:
    lines = [header, *(",".join(repr(float(x)) for x in row) for row in rows)]
    path.write_text("\n".join(lines) + "\n", "utf-8")


def figures(
    script: ModuleType, folder: Path, capsys: pytest.CaptureFixture[str]
) -> dict:
    assert script.main([str(folder), "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_moment_is_that_of_the_printed_tables(
    script: ModuleType, tmp_path: Path
) -> None:
    make_recordings(tmp_path, count=2)
    recording = script.read(tmp_path)[0][0]
    moment = script.moments(script.moving_links(), recording)
    for k in range(0, len(moment), 50):
        q = recording.motion.position[k]
        gravity = gravity_in_vehicle(*recording.tilt[k])
        np.testing.assert_allclose(recording.gravity[k], gravity, atol=1e-12)
        np.testing.assert_allclose(
            moment[k], np.cross(first_moment(q), gravity)[:2], atol=1e-12
        )


def test_known_stiffness_is_found(
    script: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    make_recordings(tmp_path)
    found = figures(script, tmp_path, capsys)["models"]
    for axis, stiffness in STIFFNESS.items():
        assert found["model"][axis]["r2"] > 0.9999
        assert found["model"][axis]["stiffness_nm_per_rad"] == pytest.approx(
            [stiffness] * 2, rel=2e-3
        )
        assert found["COM and products wrong"][axis]["r2"] < 0.5


def test_arm_with_another_com_is_told_apart(
    script: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Recordings of an arm with a mirrored COM of the wrist refute the model."""
    make_recordings(tmp_path, mirrored=True)
    found = figures(script, tmp_path, capsys)["models"]
    for axis in STIFFNESS:
        assert found["model"][axis]["r2"] < 0.8
        assert found["COM and products wrong"][axis]["r2"] > 0.9999


def test_resting_arm_is_left_out_and_too_few_are_refused(
    script: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    make_recordings(tmp_path, count=2)
    for kind in ("joint_states", "mocap"):
        lines = (tmp_path / f"made_up_0_{kind}.csv").read_text().splitlines()
        (tmp_path / f"rest_{kind}.csv").write_text("\n".join(lines[:140]))
    assert script.read(tmp_path)[1] == ["rest"]
    (tmp_path / "made_up_1_mocap.csv").unlink()
    assert script.main([str(tmp_path)]) == 2
    assert "at least 2 needed" in capsys.readouterr().err
    assert script.main([str(tmp_path / "absent")]) == 2
    (tmp_path / "made_up_1_mocap.csv").write_text("time_secs,roll\n0,0\n")
    assert script.main([str(tmp_path)]) == 2
    assert "x_ori" in capsys.readouterr().err


@needs_recordings
def test_real_recordings(
    script: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = tmp_path / "page.png"
    assert script.main([str(RECORDINGS), "--json", "--plot", str(page)]) == 0
    found = json.loads(capsys.readouterr().out)
    assert len(found["recordings"]) >= 4
    for axis in STIFFNESS:
        model = found["models"]["model"][axis]
        assert model["r2"] >= 0.9
        first, second = model["stiffness_nm_per_rad"]
        assert first == pytest.approx(second, rel=0.1)
        assert first > 0
        moving = found["models"]["in moving water"][axis]
        assert moving["r2"] > model["r2"] - 0.005
        assert moving["r2_of_recordings"] != model["r2_of_recordings"]
        assert found["models"]["COM and products wrong"][axis]["r2"] < 0.5
        # Weight and buoyancy move alike here, so a stiffness absorbs the factor.
        assert found["models"]["no buoyancy"][axis]["course"] > 0.99
    assert page.read_bytes().startswith(b"\x89PNG")
    assert script.main([str(RECORDINGS)]) == 0
    assert "held-out R^2" in capsys.readouterr().out


def spoil(path: Path, change: Callable[[list[list[str]]], list[list[str]]]) -> None:
    lines = path.read_text("utf-8").splitlines()
    header, *rows = (line.split(",") for line in lines)
    changed = [header, *change(rows)]
    path.write_text("\n".join(",".join(row) for row in changed) + "\n", "utf-8")


def tumbled(rows: list[list[str]]) -> list[list[str]]:
    """The tracking confuses two markers: 100 degrees about the vehicle's x axis."""
    turn = np.array([np.sin(np.radians(50)), 0, 0, np.cos(np.radians(50))])
    out = []
    for time, *cells in rows:
        (x, y, z), w = np.array(cells[:3], dtype=float), float(cells[3])
        vector = (
            w * turn[:3] + turn[3] * np.array([x, y, z]) + np.cross([x, y, z], turn[:3])
        )
        out.append(
            [
                time,
                *map(repr, map(float, vector)),
                repr(float(w * turn[3] - x * turn[0])),
            ]
        )
    return out


def make_untidy(folder: Path) -> None:
    """Six made-up recordings, four of them as they come, and remains of others."""
    make_recordings(folder, count=6)

    def mocap(index: int) -> Path:
        return folder / f"made_up_{index}_mocap.csv"

    spoil(mocap(0), lambda rows: [*rows[:300], *tumbled(rows[300:360]), *rows[360:]])
    spoil(
        mocap(1), lambda rows: [*rows[:600], *tumbled(rows[600:])]
    )  # lost until the end
    spoil(
        mocap(2),
        lambda rows: [
            row if k % 50 else [row[0], "", "", "", ""]
            for k, row in enumerate(rows)
            if not 200 <= k < 250
        ],
    )
    spoil(
        mocap(2),
        lambda rows: [
            *rows[:401],
            rows[390],
            ["0.1"],
            [*rows[401][:1], *"0000"],
            *rows[402:],
        ],
    )
    spoil(
        folder / "made_up_3_joint_states.csv",
        lambda rows: [
            [*row[:3], "nan", row[4]] if k in (7, 8) else row
            for k, row in enumerate(rows)
        ],
    )
    remains = {
        "alone_joint_states.csv": (folder / "made_up_4_joint_states.csv").read_text(),
        "lost_joint_states.csv": (folder / "made_up_4_joint_states.csv")
        .read_text()
        .replace("_c_", "_x_"),
        "lost_mocap.csv": mocap(4).read_text(),
        "brief_joint_states.csv": (folder / "made_up_4_joint_states.csv").read_text(),
        "brief_mocap.csv": "\n".join(mocap(4).read_text().splitlines()[:200]),
        "empty_joint_states.csv": "",
        "empty_mocap.csv": "time_secs,x_ori,y_ori,z_ori,w_ori\n,,,,\n",
        "notes.txt": "not a recording",
    }
    for name, content in remains.items():
        (folder / name).write_text(content)


def test_recordings_as_they_come(
    script: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A stated rule leaves out bad data; the rest still gives the known stiffness."""
    make_untidy(tmp_path)
    found = figures(script, tmp_path, capsys)
    files = found["files"]
    assert found["recordings"] == [f"made_up_{k}" for k in range(6)]
    assert [name for name, file in files.items() if not file["used"]] == [
        "alone",
        "brief",
        "empty",
        "lost",
    ]
    left = {name: file["left_out"] for name, file in files.items()}
    assert left["made_up_0"] == {"jump": "60 rows", "gap": left["made_up_0"]["gap"]}
    # Every time of which the 1.5 s of average touch the 1.22 s without a row.
    assert float(left["made_up_0"]["gap"].split()[0]) == pytest.approx(
        1.22 + 1.5, abs=0.11
    )
    assert left["made_up_1"] == {"jump": "200 rows"}
    assert left["made_up_2"] == {
        "cells": "16 rows of mocap",
        "order": "1 rows of mocap",
        "norm": "1 rows",
        "gap": left["made_up_2"]["gap"],
    }
    assert left["made_up_3"] == {"cells": "2 rows of joint_states"}
    assert left["made_up_4"] == left["made_up_5"] == {}
    assert "alone_mocap.csv: no such file" in left["alone"]["file"]
    assert "no column 'axis_c_pos'" in left["lost"]["file"]
    assert list(left["brief"]) == ["short"]
    assert list(left["empty"]) == ["file"]
    assert {rule for file in left.values() for rule in file} <= set(found["rules"])
    seconds = {name: file["seconds"] for name, file in files.items()}
    assert seconds["made_up_4"] == pytest.approx([15.98 - 1.5 - 1.0, 15.98], abs=0.06)
    assert seconds["made_up_1"][1] == pytest.approx(600 * 0.02, abs=0.03)
    for axis, stiffness in STIFFNESS.items():
        model = found["models"]["model"][axis]
        assert model["r2"] > 0.9999
        assert model["lag_s"] == pytest.approx([0.3, 0.3])
        assert model["stiffness_nm_per_rad"] == pytest.approx([stiffness] * 2, rel=2e-3)
    assert script.main([str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert said.startswith(
        "6 of 10 recordings used; stiffnesses and lag fitted on the other half"
    )
    for rule, words in script.RULES.items():
        assert (f"  {rule}: {words}" in said) == (rule != "rest")
    # The rules know no names: other ones, in another order, and the same is used.
    before = {tuple(r.grid): r.tilt for r in script.read(tmp_path)[0]}
    for name in files:
        for suffix in script.SUFFIXES:
            if (path := tmp_path / f"{name}{suffix}").exists():
                path.rename(tmp_path / f"{name[::-1]}{suffix}")
    after = {tuple(r.grid): r.tilt for r in script.read(tmp_path)[0]}
    assert before.keys() == after.keys()
    for grid, tilt in before.items():
        np.testing.assert_array_equal(after[grid], tilt)


def test_a_trajectory_is_in_one_half_only(script: ModuleType, tmp_path: Path) -> None:
    """Fitted on one repetition and scored on the other would be no test."""
    make_recordings(tmp_path, count=4)
    for index, name in enumerate(("a-0", "a-1-test", "b-0", "b-1")):
        for kind in ("joint_states", "mocap"):
            path = tmp_path / f"made_up_{index}_{kind}.csv"
            path.rename(tmp_path / f"{name}_{kind}.csv")
    result = script.validate(tmp_path)
    models = [
        script.signals(r, script.moments(script.moving_links(), r))
        for r in script.read(tmp_path)[0]
    ]
    for k, fitted in enumerate((models[2:], models[:2])):
        _, compliance = script.fit(fitted)
        np.testing.assert_allclose(
            result["scores"]["model"].stiffness[k], 1 / compliance
        )
    for name in ("b-0", "b-1"):
        (tmp_path / f"{name}_mocap.csv").unlink()
    with pytest.raises(
        FileFormatError, match="1 trajectories of a moving arm, at least 2 needed"
    ):
        script.validate(tmp_path)


def test_lag_and_stiffness_are_fitted_elsewhere(
    script: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A folder that is only scored fits nothing: R^2 shows its other stiffness."""
    right, wrong = tmp_path / "right", tmp_path / "wrong"
    for folder in (right, wrong):
        folder.mkdir()
        make_recordings(folder, mirrored=folder == wrong, count=2)
    assert script.main([str(right), "--fit", str(wrong), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["fitted_on"] == ["made_up_0", "made_up_1"]
    assert len(found["models"]["model"]["roll"]["lag_s"]) == 1
    own = script.validate(right, right)["scores"]["model"]
    for k, axis in enumerate(("roll", "pitch")):
        assert found["models"]["model"][axis]["r2"] < own.r2[k]
        assert found["models"]["COM and products wrong"][axis]["r2"] < own.r2[k]
        assert own.stiffness[0, k] == pytest.approx(STIFFNESS[axis], rel=2e-3)
        assert (
            found["models"]["model"][axis]["stiffness_nm_per_rad"]
            != own.stiffness[:, k].tolist()
        )
    (right / "made_up_1_mocap.csv").unlink()
    assert script.main([str(right), "--fit", str(right)]) == 0  # one is enough to score
    assert "1 recordings of another folder" in capsys.readouterr().out
    (tmp_path / "none").mkdir()
    assert script.main([str(right), "--fit", str(tmp_path / "none")]) == 2
    assert "0 trajectories of a moving arm" in capsys.readouterr().err


@pytest.mark.slow
def test_no_recording_is_drawn_over_and_a_closed_pipe_is_no_error(
    tmp_path: Path,
) -> None:
    make_recordings(tmp_path, count=2)
    recording = tmp_path / "made_up_0_mocap.csv"
    (tmp_path / "page.png").hardlink_to(recording)
    content = recording.read_bytes()
    for arguments, status, words in (
        (
            f"{tmp_path} --plot {tmp_path / 'page.png'}",
            2,
            "another file than the one that is read",
        ),
        (f"{tmp_path} --plot {recording}", 2, "choose from .png, .pdf, .svg"),
        (f"{tmp_path} | true", 0, ""),
        (f"{tmp_path} --json | head -n 1", 0, ""),
    ):
        done = subprocess.run(
            [
                "bash",
                "-c",
                f"set -o pipefail; '{sys.executable}' '{SCRIPT}' {arguments}",
            ],
            capture_output=True,
            text=True,
            check=False,
            env={**os.environ, "PYTHONPATH": str(SCRIPT.parents[1])},
        )
        assert done.returncode == status
        assert words in done.stderr
        assert done.stderr.count("\n") == (status != 0)
    assert recording.read_bytes() == content


@needs_recordings
def test_real_recordings_that_nothing_was_tuned_to(
    script: ModuleType, capsys: pytest.CaptureFixture[str]
) -> None:
    """README's figure: stiffnesses and lag of the tidy four, scored on two others."""
    untidy = RECORDINGS / "untidy"
    if not untidy.is_dir():
        pytest.skip("no untidy recordings")
    assert script.main([str(untidy), "--fit", str(RECORDINGS), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["files"]["traj003-0-test"]["left_out"] == {"cells": "1 rows of mocap"}
    assert set(found["files"]["traj007-1"]["left_out"]) == {"jump", "gap"}
    for axis, r2 in (("roll", 0.90), ("pitch", 0.96)):
        assert found["models"]["model"][axis]["r2"] > r2
        assert found["models"]["COM and products wrong"][axis]["r2"] < 0.4
