"""The validation on recordings: proven on made-up ones whose answer is known, then run on the real ones."""

from __future__ import annotations

import importlib.util
import json
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from recordings import RECORDINGS, needs_recordings
from reference import COB, COM, MASS, VOLUME, inertial_frames

SCRIPT = Path(__file__).resolve().parent.parent / "scripts" / "validate_recordings.py"
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
    """Sum of mass times COM minus displaced mass times COB of links 1 to 4, in the base frame [kg m]."""
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
    """A vehicle that answers 0.3 s late with the stiffnesses above, written as real recordings are."""
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
            moment = np.cross(first_moment(q[before], mirrored), gravity_in_vehicle(*tilt[before]))
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
    path.write_text("\n".join(lines) + "\n")


def figures(script: ModuleType, folder: Path, capsys: pytest.CaptureFixture[str]) -> dict:
    assert script.main([str(folder), "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_moment_is_that_of_the_printed_tables(script: ModuleType, tmp_path: Path) -> None:
    make_recordings(tmp_path, count=2)
    recording = script.read(tmp_path)[0][0]
    moment = script.moments(script.moving_links(), recording)
    for k in range(0, len(moment), 50):
        q = recording.motion.position[k]
        gravity = gravity_in_vehicle(*recording.tilt[k])
        np.testing.assert_allclose(recording.gravity[k], gravity, atol=1e-12)
        np.testing.assert_allclose(moment[k], np.cross(first_moment(q), gravity)[:2], atol=1e-12)


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
    """The other way round: recordings of an arm with the wrist's COM on the wrong side refute the model."""
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
        assert found["models"]["COM and products wrong"][axis]["r2"] < 0.5
        # What these recordings cannot tell: weight and buoyancy move alike, a stiffness absorbs the factor.
        assert found["models"]["no buoyancy"][axis]["course"] > 0.99
    assert page.read_bytes().startswith(b"\x89PNG")
    assert script.main([str(RECORDINGS)]) == 0
    assert "held-out R^2" in capsys.readouterr().out
