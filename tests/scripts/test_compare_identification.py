"""The comparison of identification: what the guide says of this package's part."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import alpha5_model as a5

GUIDE = Path(__file__).parents[2] / "docs" / "guides" / "calibration.md"


def printed(row: str) -> list[float]:
    """The figures of a row of the guide's table."""
    lines = GUIDE.read_text("utf-8").splitlines()
    (line,) = [line for line in lines if line.startswith(f"| {row}")]
    return [float(text) for text in re.findall(r"\d+\.\d+(?= \|)", line)]


@pytest.mark.slow
def test_the_guide_has_the_errors_of_the_script(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Least squares without a prior has the deviation that figaroh's errors show."""
    from recordings import compare_identification as script

    assert script.main(["write", str(tmp_path)]) == 0
    lines = capsys.readouterr().out.splitlines()
    found = {line[:24].strip(): line[24:40].split() for line in lines[1:]}
    tables = [float(x) for x in found["printed tables"]]
    ours = [float(x) for x in found["alpha5_model.identify"]]
    assert printed("the printed tables") == pytest.approx(tables, abs=0.011)
    assert printed("`a5.identify`") == pytest.approx(ours, abs=0.03)

    arm = dict(np.load(tmp_path / "0.npz"))
    in_air = a5.load(a5.AIR)
    rows = in_air.regressor(arm["q"], arm["v"], arm["a"]).matrix.reshape(-1, 38)
    rest = np.zeros_like(arm["positions"])
    static = in_air.regressor(arm["positions"], rest, rest).matrix
    _, sizes, ways = np.linalg.svd(rows, full_matrices=False)
    known = sizes > 1e-10 * sizes[0]
    root = ways[known].T / sizes[known]
    deviation = 3 * np.sqrt(((static[:, 1:3] @ root) ** 2).sum(axis=2).mean(axis=0))
    assert printed("figaroh") == pytest.approx(deviation, rel=0.3)


def test_the_motion_keeps_the_rated_speeds() -> None:
    from recordings import compare_identification as script

    smooth = a5.trajectory.smooth(script.sway(), "interpolate")
    speeds = np.abs(smooth.velocity).max(axis=0)
    assert (speeds <= a5.load().limits.velocity).all()
