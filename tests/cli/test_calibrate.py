"""``alpha5 calibrate``: plans, fits, and what it refuses, in one line each."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.cli import main


def filled(path: Path, factor: float = 1.0) -> None:
    """Write Pinocchio's readings, in grams, into a planned file."""
    planned = a5.calibrate.read_session(path)
    arm = a5.load(planned.density)
    still = np.zeros(4)
    wrenches = [arm.base_wrench(q, still, still).vector for q in planned.motion.q]
    rows = factor * 1e3 * np.array(wrenches) @ planned.sensor.matrix[:, 4:].T
    texts = iter([f"readings = {np.round(row).tolist()}" for row in rows])
    text = re.sub(r"readings = \[\]", lambda _: next(texts), path.read_text("utf-8"))
    path.write_text(text, "utf-8")


def test_a_plan_is_filled_in_and_fitted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan = tmp_path / "plan.toml"
    made = tmp_path / "arm.toml"
    points = "0.2 0 -0.03 -0.1 0.17 -0.03 -0.1 -0.17 -0.03"
    words = ["calibrate", "plan", str(plan), "--poses", "7", "--positions", points]
    assert main([*words, "--zeroed", "--noise", "0.0004", "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert np.shape(record["q"]) == (7, 4)
    filled(plan)

    fit = ["calibrate", "fit", str(plan), "--output", str(made), "--json"]
    assert main([*fit, "--zeros", "0.5deg"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["problems"] == []
    assert record["readings"] == 21
    zero = record["numbers"]["zeros.axis_d"]
    assert zero["before"] == pytest.approx(np.radians(0.5))
    assert abs(zero["value"]) < 4 * zero["deviation"] < 4 * zero["before"]
    assert a5.arm_file(made).covariance is not None

    # The file of the result is refused as a prior.
    assert main(["calibrate", "fit", str(plan), "--arm", str(made)]) == 2
    assert "fit all sessions together" in capsys.readouterr().err


def test_a_problem_is_said_first(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan = tmp_path / "plan.toml"
    assert main(["calibrate", "plan", str(plan)]) == 0
    filled(plan, factor=1000.0)
    capsys.readouterr()
    assert main(["calibrate", "fit", str(plan)]) == 1
    out = " ".join(capsys.readouterr().out.split())
    assert out.startswith("problem 1: unit (")
    assert "1000 times too large" in out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["fill", "plan.toml"], "choose from plan, fit"),
        (["plan", "one.toml", "two.toml"], "expected one file to write"),
        (["plan", "there.toml"], "it exists; name another file"),
        (["plan", "new.toml", "--sensor", "scale"], "choose from scales, weight"),
        (["plan", "new.toml", "--positions", "1 2 3"], "positions"),
        (["plan", "new.toml", "--sensor", "efforts", "--zeroed"], "no such option"),
        (["plan", "new.toml", "--fluid", ""], "expected sea, fresh, air or a density"),
        (["plan", "new.toml", "--prior", "tight"], "choose from digits, loose"),
        (["plan", "new.toml", "--gravity", "0 -9.81 0"], "right angle"),
        (["fit", "missing.toml"], "missing.toml"),
        (["fit", "there.toml"], "there.toml, format: missing"),
        (["fit", "there.toml", "--output", "arm.txt"], "choose from .toml"),
    ],
)
def test_what_is_refused(
    words: list[str],
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("there.toml").write_text("", "utf-8")
    assert main(["calibrate", *words]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert message in captured.err
    assert len(captured.err.strip().splitlines()) == 1
    assert not Path("new.toml").exists()
