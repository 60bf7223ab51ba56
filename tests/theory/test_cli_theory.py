"""The commands ``dh`` and ``planar``, the pictures and the examples of the notes."""

from __future__ import annotations

import importlib.util
import json
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.errors import OutputError, UnknownNameError
from alpha5_model.theory.planar import PlanarArm
from alpha5_model.viewer.planar_plot import plot_planar, save

SCRIPT = (
    Path(__file__).resolve().parents[2] / "scripts" / "checks" / "lecture_examples.py"
)


@pytest.fixture(autouse=True)
def wide(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "200")  # sentences stay whole


def run(capsys: pytest.CaptureFixture[str], *args: str) -> tuple[int, str, str]:
    status = main(list(args))
    out, err = capsys.readouterr()
    return status, out, err


@pytest.mark.parametrize(("joints", "answer"), [(3, "no"), (6, "yes")])
def test_dh_tells_what_an_arm_can_do(capsys, joints: int, answer: str) -> None:
    """Six skew axes reach all of SE(3); three of them reach neither kind of task."""
    links = [("--link", f"0 {0.1 * k} {0.3 - 0.02 * k} 1 0") for k in range(joints)]
    status, out, err = run(capsys, "dh", *(word for link in links for word in link))
    assert (status, err) == (0, "")
    lines = out.splitlines()
    for task in ("general tasks", "vertical insertion"):
        assert any(line.startswith(f"{task}: {answer}, ") for line in lines), task


def test_dh_prints_table_1(capsys) -> None:
    status, out, err = run(capsys, "dh")
    assert (status, err) == (0, "")
    lines = out.splitlines()
    assert lines[1].split()[:5] == [
        "axis_e",
        "q+3.141593",
        "0.046200",
        "0.020000",
        "1.570796",
    ]
    assert lines[4].split()[:5] == [
        "axis_b",
        "q+1.570796",
        "-0.180000",
        "0.000000",
        "1.570796",
    ]
    tool = next(line for line in lines if line.startswith("tool")).split()
    assert float(tool[4]) == pytest.approx(-0.08)


def test_dh_as_json(capsys) -> None:
    q = [-0.5, 1.2, 1.0, -0.25]
    status, out, _ = run(capsys, "dh", *map(str, q), "--json")
    assert status == 0
    data = json.loads(out)
    chain = a5.dh.DHChain.alpha5()
    assert data["q"] == q
    difference = np.array(data["frames"]["tool"]) - chain.forward_kinematics(q)
    assert np.abs(difference).max() < 1e-15
    difference = np.array(data["frames"]["{2}"]) - chain.forward_kinematics(q, 2)
    assert np.abs(difference).max() < 1e-15
    assert data["links"][3]["d"] == -0.18
    assert data["type"]["kind"] == "revolute"
    assert data["tasks"]["general"] is False


def test_dh_of_another_arm(capsys) -> None:
    rows = ("0 0.1 0.2 1.5707963267948966 0", "0 0 0.3 0 1")
    status, out, _ = run(
        capsys, "dh", "--link", rows[0], "--link", rows[1], "-0.4", "0.2", "--json"
    )
    assert status == 0
    data = json.loads(out)
    assert data["links"][0]["lower"] is None  # no limit; JSON knows no infinity
    chain = a5.dh.DHChain.from_table([[float(x) for x in row.split()] for row in rows])
    pose = chain.forward_kinematics([-0.4, 0.2])
    difference = np.array(data["frames"]["tool"]) - pose
    assert np.abs(difference).max() < 1e-15
    status, out, _ = run(capsys, "dh", "--urdf", a5.URDF_PATH, "--frame", "tcp")
    assert status == 0
    assert "axis_b" in out


@pytest.mark.parametrize(
    ("args", "words"),
    [
        (["dh", "1", "2"], "axis_e, axis_d, axis_c, axis_b"),
        (["dh", "1", "2", "3", "nan"], "finite"),
        (["dh", "--link", "0 1 x"], "THETA D A ALPHA SIGMA"),
        (["dh", "--link", "0 1 2 3 7"], "sigma"),
        (["dh", "--urdf", "missing.urdf"], "missing.urdf"),
        (["dh", "--frame", "tcp"], "--urdf"),
        (["dh", "--link", "0 0 1 0 0", "--urdf", "x.urdf"], "one of them"),
        (["dh", "--unknown"], "--unknown"),
        (["planar"], "LENGTHS"),
        (["planar", "5", "-4"], "positive"),
        (["planar", "5", "4", "--limits", "2 1", "-l", "none"], "lower <= upper"),
        (["planar", "5", "4", "--limits", "2", "-l", "none"], "LOWER UPPER"),
        (["planar", "5", "4", "--limits", "0 1"], "one (lower, upper)"),
        (["planar", "5", "4", "--joints", "RX"], "letters R or P"),
        (["planar", "5", "4", "--joints", "RP"], "prismatic"),
        (
            ["planar", "5", "4", "-l", "0 1", "-l", "none", "--radius", "2"],
            "without limits",
        ),
        (["planar", "5", "4", "1", "--radius", "-2"], "--radius"),
        (["planar", "5", "4", "--plot", "arm.gif"], ".png, .pdf, .svg"),
    ],
)
def test_bad_input_is_one_line(capsys, args, words) -> None:
    status, out, err = run(capsys, *args)
    assert (status, out) == (2, "")
    assert words in err
    assert err.count("\n") == 1


def test_planar_on_the_notes_arm(capsys) -> None:
    status, out, err = run(capsys, "planar", "5", "4", "1", "--radius", "1.9")
    assert (status, err) == (0, "")
    assert "disc, 0 to 10 m" in out
    assert "0 and 2 to 8 m from the base" in out
    assert "holds for 2 to 8 m" in out
    assert "turns fully: no; theorem: no" in out
    status, out, _ = run(capsys, "planar", "5", "5", "3", "--radius", "1")
    assert "turns fully: yes; theorem: no" in out


def test_planar_as_json(capsys) -> None:
    status, out, _ = run(capsys, "planar", "5", "4", "1", "--json")
    assert status == 0
    data = json.loads(out)
    assert data["workspace"]["shape"] == "disc"
    assert data["workspace"]["area"] == pytest.approx(100 * math.pi)
    assert data["dexterous_workspace"]["radii"] == [[0, 0], [2, 8]]
    assert data["dexterous_workspace"]["area"] == pytest.approx(60 * math.pi)
    assert data["theorem"]["l_4"] == [2, 8]
    status, out, _ = run(
        capsys, "planar", "5", "4", "-l", "-1 2", "-l", "-2.5 1", "--json"
    )
    data = json.loads(out)
    assert data["workspace"]["shape"] == "region"
    assert data["dexterous_workspace"] is None
    assert data["necessary_conditions"]["satisfied"] is False


def test_planar_does_not_contradict_itself(capsys) -> None:
    limits = ("-l", "-2.967 2.967") * 3
    _, out, _ = run(capsys, "planar", "5", "4", "1", *limits)
    assert "about 155.8 m²" in out
    assert "necessary conditions satisfied" in out
    _, out, _ = run(capsys, "planar", "5", "4", "1", *("-l", "-1 1") * 3)
    assert "about 0 m²" in out
    assert "not every orientation occurs" in out


def test_planar_with_limits_states_its_resolution(capsys) -> None:
    args = ("planar", "5", "4", "1", "-l", "none", "-l", "-2.5 2.5", "-l", "none")
    status, out, _ = run(capsys, *args)
    assert status == 0
    assert "by enumeration every 0.25 m and with 120 orientations" in out
    data = json.loads(run(capsys, *args, "--json")[1])["dexterous_workspace"]
    # The elbow keeps the wrist 2.99 m from the base: ring from 3.99 to 8.
    low = math.sqrt(41 + 40 * math.cos(2.5)) + 1
    assert data["radii"] is None
    assert data["area"] == pytest.approx(math.pi * (64 - low**2), rel=0.03)


def test_planar_leaves_out_what_many_limited_joints_make_long(
    capsys, tmp_path: Path
) -> None:
    limits = [x for _ in range(6) for x in ("-l", "-1 1")]
    plot = tmp_path / "six.svg"
    status, out, _ = run(capsys, "planar", *"222221", *limits, "--plot", str(plot))
    assert status == 0
    assert "not computed for this arm" in out
    assert plot.stat().st_size > 0


def test_planar_prismatic_and_empty(capsys) -> None:
    status, out, _ = run(
        capsys, "planar", "1", "2", "--joints", "RP", "-l", "none", "-l", "0 1"
    )
    assert status == 0
    assert "annulus, 3 to 4 m" in out
    assert "dexterous workspace  empty" in out


@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf"])
def test_planar_writes_a_picture(capsys, tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"arm{suffix}"
    assert run(capsys, "planar", "5", "4", "1", "--plot", str(path))[0] == 0
    start = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}[suffix]
    assert path.read_bytes().startswith(start)
    assert list(tmp_path.iterdir()) == [path]


def test_a_picture_that_cannot_be_written(tmp_path: Path) -> None:
    axes = plot_planar(PlanarArm((1, 1)))
    with pytest.raises(OutputError):
        save(axes, SCRIPT / "arm.png")  # a file stands where the folder would be
    with pytest.raises(UnknownNameError, match="picture format"):
        save(axes, tmp_path / "arm")


@pytest.mark.parametrize(
    "arm",
    [
        PlanarArm((5, 4)),
        PlanarArm((5, 4), [(0, 2), (0.3, 2.5)]),
        PlanarArm((5, 4, 3), [(-1, 2), (-1, 2.5), (-1, 1)]),
        PlanarArm((1, 2), [(0, 3), None], "PR"),
    ],
)
def test_the_filled_area_is_the_workspace(arm: PlanarArm) -> None:
    """Each pixel is filled if, and only if, its point is in the workspace."""
    axes = plot_planar(arm, dexterous=False)
    axes.figure.canvas.draw()
    image = np.asarray(axes.figure.canvas.buffer_rgba())[..., :3].astype(int)
    rng = np.random.default_rng(0)
    x_0, x_1 = axes.get_xlim()
    y_0, y_1 = axes.get_ylim()
    points = rng.uniform((x_0, y_0), (x_1, y_1), (4000, 2))
    pixels = axes.transData.transform(points)
    rows = image.shape[0] - 1 - pixels[:, 1].astype(int)
    colour = image[rows, pixels[:, 0].astype(int)]
    filled = (colour == (0xDB, 0xE7, 0xF3)).all(axis=1)
    empty = (colour == 255).all(axis=1)
    inside = arm.workspace().contains(points)
    assert (filled | empty).mean() > 0.85  # the rest is arm and outline
    assert inside[filled].mean() > 0.998
    assert (~inside[empty]).mean() > 0.998
    assert filled.any()
    assert empty.any()


def test_the_dexterous_rings_are_drawn_where_they_are() -> None:
    axes = plot_planar(PlanarArm((5, 4, 1)))
    axes.figure.canvas.draw()
    image = np.asarray(axes.figure.canvas.buffer_rgba())[..., :3].astype(int)
    for radius, colour in (
        (1.5, "DBE7F3"),
        (3.0, "5B9BD5"),
        (7.5, "5B9BD5"),
        (9.0, "DBE7F3"),
    ):
        x, y = axes.transData.transform([-radius, 0.0]).astype(int)
        assert tuple(image[image.shape[0] - 1 - y, x]) == tuple(bytes.fromhex(colour))


def test_the_line_around_the_dexterous_workspace_has_its_area() -> None:
    """With joint limits it is a contour of a map; the notes' arm has 155.8."""
    from matplotlib.contour import ContourSet

    arm = PlanarArm((5, 4, 1), [(-2.967, 2.967)] * 3)
    axes = plot_planar(arm, resolution=81)
    (contour,) = [line for line in axes.collections if isinstance(line, ContourSet)]
    area = 0.0
    for path in contour.get_paths():
        for ring in path.to_polygons(closed_only=False):
            x, y = ring.T
            area += abs(x[:-1] @ y[1:] - x[1:] @ y[:-1]) / 2
    # The line is inside of it, by up to a cell.
    assert 0.9 * 155.8 < area < 155.8
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert "dexterous (numerical)" in labels


def test_without_a_turning_hand_there_is_no_map_of_orientations() -> None:
    from matplotlib.collections import QuadMesh

    limits = [(-2.0, 2.0), (-2.0, 2.0), (0.5, 1.0)]
    axes = plot_planar(PlanarArm((5, 4, 1), limits, "RRP"), resolution=21)
    assert not any(isinstance(drawn, QuadMesh) for drawn in axes.collections)
    limits[2] = (-1.0, 1.0)
    axes = plot_planar(PlanarArm((5, 4, 1), limits, "RRR"), resolution=21)
    (mesh,) = [drawn for drawn in axes.collections if isinstance(drawn, QuadMesh)]
    assert 0 < mesh.get_array().max() < 1


@pytest.fixture
def lecture_examples(monkeypatch: pytest.MonkeyPatch) -> Any:
    spec = importlib.util.spec_from_file_location("lecture_examples", SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "lecture_examples", module)
    spec.loader.exec_module(module)
    return module


def test_the_help_of_the_walk_makes_no_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, lecture_examples: Any
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as left:
        lecture_examples.main(["--help"])
    assert left.value.code == 0
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_the_walk_through_the_notes(
    tmp_path: Path, capsys, monkeypatch: pytest.MonkeyPatch, lecture_examples: Any
) -> None:
    module = lecture_examples
    assert module.main([str(tmp_path)]) == 0
    out = capsys.readouterr().out
    assert "DIFFERS" not in out
    assert "the notes' arm, l = (5.0, 4.0, 1.0): 0 and 2 to 8 m" in out
    assert {p.name for p in tmp_path.iterdir()} == {"dexterous.png", "workspaces.png"}
    # Negative control: a misprint in the table is found.
    wrong = ((10.0, 9.0, 11.0), *module.PRINTED_TABLE[1:])
    monkeypatch.setattr(module, "PRINTED_TABLE", wrong)
    assert module.theorem_table() is False
    assert "DIFFERS" in capsys.readouterr().out
