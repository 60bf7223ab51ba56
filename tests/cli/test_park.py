"""``alpha5 park``: what it prints and writes is what `placements` returns."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.planning import Placements

WORLD = "[wall]\nbox = [0.1, 3.0, 2.0]\nxyz = [0.65, 0.0, 0.0]\n"
HULL = "[rov]\nbox = [0.457, 0.338, 0.254]\nxyz = [-0.2, 0.0, -0.14]\n"
VEHICLE = "mass = 13.5\ncom = [0, 0, 0]\nvolume = 0.0134\ncob = [0, 0, 0.03]\n"
PLACE = "xyz = [0.2, 0.0, 0.14]\nrpy = [0.0, 0.0, 0.3]\n"
VALVE = ("450", "100", "100", "mm")
FILES = ("--hull", "hull.toml", "--obstacles", "world.toml")
COARSE = ("--spacing", "0.2", "--yaws", "4")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "world.toml").write_text(WORLD, "utf-8")
    (tmp_path / "hull.toml").write_text(HULL, "utf-8")
    (tmp_path / "rov.toml").write_text(VEHICLE + PLACE, "utf-8")
    return tmp_path


def expected(**more: Any) -> Placements:
    return a5.placements(
        [0.45, 0.1, 0.1],
        hull=[a5.Obstacle.box("rov", (0.457, 0.338, 0.254), (-0.2, 0.0, -0.14))],
        obstacles=[a5.Obstacle.box("wall", (0.1, 3.0, 2.0), (0.65, 0.0, 0.0))],
        spacing=0.2,
        yaws=4,
        **more,
    )


def answer(capsys: pytest.CaptureFixture[str], *words: str) -> dict:
    assert main(["park", *words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


@pytest.mark.usefixtures("folder")
def test_the_answer_is_that_of_python(capsys: pytest.CaptureFixture[str]) -> None:
    more = ("--vehicle", "rov.toml", "--clearance", "30mm", "--fluid", "fresh")
    found = answer(
        capsys, *VALVE, *FILES, *COARSE, *more, "--tilts", "0", "0", "0.1", "0"
    )
    vehicle = {"mass": 13.5, "com": [0, 0, 0], "volume": 0.0134, "cob": [0, 0, 0.03]}
    same = expected(
        arm=a5.load(a5.FRESH_WATER),
        vehicle={**vehicle, "xyz": [0.2, 0.0, 0.14], "rpy": [0.0, 0.0, 0.3]},
        clearance=0.03,
        tilts=[(0.0, 0.0), (0.1, 0.0)],
    )
    rows = found["placements"]
    assert found["tried"] == same.tried
    assert [row["pose"] for row in rows] == same.pose.tolist()
    for name, values in (
        ("clearance_m", same.clearance),
        ("hull_clearance_m", same.hull_clearance),
        ("reach_margin_m", same.reach_margin),
        ("holding", same.holding),
        ("tilt_rad", same.tilt),
    ):
        assert [row[name] for row in rows] == pytest.approx(values)


@pytest.mark.usefixtures("folder")
def test_a_mount_without_a_vehicle(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("--xyz", "0.2", "0", "0.14", "--rpy", "0", "0", "0.3")
    found = answer(capsys, *VALVE, *FILES, *COARSE, *words)
    turned = [[math.cos(0.3), -math.sin(0.3)], [math.sin(0.3), math.cos(0.3)]]
    mount = np.eye(4)
    mount[:2, :2] = turned
    mount[:3, 3] = 0.2, 0.0, 0.14
    same = expected(mount=mount)
    poses = np.array([row["pose"] for row in found["placements"]])
    assert poses == pytest.approx(same.pose, abs=1e-12)
    assert found["placements"][0]["tilt_rad"] is None


@pytest.mark.usefixtures("folder")
def test_points_and_boxes(capsys: pytest.CaptureFixture[str]) -> None:
    two = ("0.45", "0.1", "0.1", "0.4", "0", "0.1")
    found = answer(capsys, *two, *COARSE, "--box", "0.05", "0", "0")
    assert len(found["points"]) == 2 * 3
    assert len(found["placements"][0]["q"]) == 6


@pytest.mark.usefixtures("folder")
def test_files(capsys: pytest.CaptureFixture[str]) -> None:
    files = ("--output", "all.csv", "--plot", "map.png", "--html", "best.html")
    assert main(["park", *VALVE, *FILES, *COARSE, *files]) == 0
    printed = capsys.readouterr().out
    for name in ("all.csv", "map.png", "best.html"):
        assert f"wrote {name}" in printed
    same = expected()
    table = np.genfromtxt(
        "all.csv", delimiter=",", names=True, dtype=None, encoding=None
    )
    assert table["x_m"].tolist() == same.pose[:, 0].tolist()
    assert Path("map.png").read_bytes()[:4] == b"\x89PNG"
    page = Path("best.html").read_text("utf-8")
    assert "wall" in page
    assert "rov" in page


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize(
    ("words", "named"),
    [
        (("0.45", "0.1"), "X Y Z"),
        (("0.45", "0.1", "nan"), "targets"),
        (("0", "0", "0", "1.2", "0", "0"), "targets"),
        ((*VALVE, "--tilts", "0.1"), "tilts"),
        ((*VALVE, "--box", "-0.1", "0", "0"), "box"),
        ((*VALVE, "--vehicle", "rov.toml", "--xyz", "0", "0", "0"), "xyz: "),
        ((*VALVE, "--vehicle", "rov.toml", "--rpy", "0", "0", "0"), "rpy: "),
        ((*VALVE, "--vehicle", "hull.toml"), "vehicle"),
        ((*VALVE, "--hull", "nowhere.toml"), "nowhere.toml"),
        ((*VALVE, *COARSE, "--obstacles", "world.toml", "--clearance", "0.4"), "poses"),
        ((*VALVE, "--output", "all.xlsx"), "output"),
    ],
)
def test_what_cannot_be_used(
    words: tuple[str, ...], named: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["park", *words]) == 2
    out, error = capsys.readouterr()
    assert out == ""
    assert error.startswith("alpha5: ")
    assert error.count("\n") == 1
    assert named in error
