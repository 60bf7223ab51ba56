"""``alpha5 ik`` and ``alpha5 workspace``, and what importing the kinematics costs."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from fk import tip

import alpha5_model as a5
from alpha5_model.cli import main

ROOT = Path(__file__).resolve().parents[2]


def test_ik_prints_the_branches(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["ik", "0.25", "-0.1", "0.05", "--wrist", "1.57"]) == 0
    out = capsys.readouterr().out
    for name in a5.BRANCHES:
        assert name in out
    assert "axis_e" in out


def test_ik_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["ik", "0.25", "-0.1", "0.05", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert [b["name"] for b in answer["branches"]] == list(a5.BRANCHES)
    np.testing.assert_allclose(
        tip(np.array(answer["best"])), [0.25, -0.1, 0.05], atol=1e-12
    )
    for branch in answer["branches"]:
        if branch["exists"]:
            np.testing.assert_allclose(
                tip(np.array(branch["q"])), [0.25, -0.1, 0.05], atol=1e-12
            )
        else:
            assert branch["q"] is None


def test_ik_marks_what_collides(capsys: pytest.CaptureFixture[str]) -> None:
    behind = ["ik", "-0.25", "-0.1", "0.05"]
    assert main([*behind, "--json"]) == 2
    answer = capsys.readouterr()
    branches = json.loads(answer.out)["branches"]
    arm = a5.load()
    for branch in branches:
        hits = branch["within_limits"] and arm.in_collision(branch["q"])
        assert branch["collides"] == hits
    assert any(branch["collides"] for branch in branches)
    assert json.loads(answer.out)["best"] is None
    assert "without self-collision: link_0 and link_2 overlap" in answer.err
    assert answer.err.count("\n") == 1

    assert main(behind) == 2
    answer = capsys.readouterr()
    assert "0.000000  collides\n" in answer.out
    assert "nearest to mid-range" not in answer.out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["ik", "0.9", "0", "0"], "nearest reachable point"),
        (["ik", "nan", "0", "0"], "position"),
        (["ik", "0.2", "0", "0.1", "--wrist", "6.25"], "axis_b"),
        (["ik", "a", "0", "0"], "X Y Z"),
        (["ik", "0.1", "0.2"], "X Y Z"),
        (["ik", "0.2", "0", "0.1", "--nonsense"], "nonsense"),
        (["workspace", "--plot", "x.bmp"], ".png"),
    ],
)
def test_errors_are_one_line(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert message in captured.err


@pytest.mark.slow
def test_workspace_prints_and_draws(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, magic in (("w.png", b"\x89PNG"), ("w.svg", b"<?xml"), ("w.pdf", b"%PDF")):
        assert main(["workspace", "--plot", str(tmp_path / name)]) == 0
        assert (tmp_path / name).read_bytes().startswith(magic)
    out = capsys.readouterr().out
    assert "published, not reachable" in out
    # Vector all through: no picture inside the picture.
    assert b"<image" not in (tmp_path / "w.svg").read_bytes()


@pytest.mark.slow
def test_workspace_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["workspace", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["volume"] == a5.workspace.volume()
    assert len(answer["boundary"]["both"]) == len(a5.workspace.boundary("both"))


@pytest.mark.slow
def test_the_share_without_self_collision_is_sampled_and_printed_first(
    capsys: pytest.CaptureFixture[str],
) -> None:
    words = ["workspace", "--self-collision", "--samples", "200", "--json"]
    assert main(words) == 0
    answer = json.loads(capsys.readouterr().out)
    expected = a5.workspace.sampled_share(a5.without_self_collision, 200)
    assert answer["without_self_collision"]["share"] == expected.share
    assert answer["volume"] == a5.workspace.volume()
    assert next(iter(answer)) == "without_self_collision"


def test_the_filled_loops_have_the_exact_area() -> None:
    from alpha5_model.viewer.outlines import loops

    for side in a5.workspace.SIDES:
        total = 0.0
        for loop in loops(a5.workspace.boundary(side), step=1e-3):
            x, y = loop.T
            total += 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
        assert total == pytest.approx(a5.workspace.cross_section_area(side), rel=1e-5)


def test_importing_the_kinematics_loads_numpy_only() -> None:
    script = (
        "import sys\n"
        "import alpha5_model as a5\n"
        "a5.inverse_kinematics([.2, 0, .1])\n"
        "a5.reachable([9, 0, 0])\n"
        "a5.workspace.volume()\n"
        "a5.inverse_kinematics_path([[.2, 0, .1]])\n"
        "heavy = {'scipy', 'matplotlib', 'rich'}\n"
        # Without compiled kernels Pinocchio tests for self-collision.
        "heavy |= {'pinocchio'} if a5.backend() == 'compiled' else set()\n"
        "print(heavy & set(sys.modules))"
    )
    done = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        text=True,
        check=True,
        cwd=ROOT,
    )
    assert done.stdout.strip() == "set()"
