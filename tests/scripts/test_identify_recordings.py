"""What recordings tell about the arm.

The script is proven on artificial recordings with a known arm, then runs on the real
ones.
"""

from __future__ import annotations

import json
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
import test_validate_recordings as made_up
from reference import COB, COM, MASS, VOLUME
from shared_recordings import RECORDINGS, needs_recordings

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"


@pytest.fixture(scope="module")
def script() -> ModuleType:
    from recordings import identify_recordings

    return identify_recordings


def found(
    script: ModuleType, capsys: pytest.CaptureFixture[str], *folders: Path
) -> Any:
    assert script.main([*map(str, folders), "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_the_eight_moments(script: ModuleType) -> None:
    """Those of link 4, and of link 3 with what link 4 adds along its axis, by hand."""
    net = [MASS[4] * np.array(COM[4]) / 1e3 - VOLUME[4] * np.array(COB[4]) / 1e3]
    np.testing.assert_allclose(script.numbers()[6:], net[0][:2], atol=1e-15)
    own = MASS[3] * np.array(COM[3]) / 1e3 - VOLUME[3] * np.array(COB[3]) / 1e3
    # z of {4} is the wrist's axis; -y of {3} is, too, because the next frame is turned
    # by -pi/2 about x. a_2 is 20 mm.
    weight = MASS[4] - VOLUME[4]
    handed = np.array([0.020 * weight, net[0][2]])
    np.testing.assert_allclose(script.numbers()[4:6], own[:2] + handed, atol=1e-15)


@pytest.mark.parametrize("corrected", [False, True])
def test_the_centre_of_buoyancy_that_the_recordings_were_made_with_is_found(
    script: ModuleType,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    corrected: bool,
) -> None:
    if corrected:
        x, y, z = COB[3]
        monkeypatch.setattr(made_up, "COB", [*COB[:3], (20 - x, z - 46.2, y), COB[4]])
    made_up.make_recordings(tmp_path)
    result = found(script, capsys, tmp_path)
    cob = result["link3_cob"]
    assert cob["fits_best_at"] == pytest.approx(float(corrected), abs=0.05)
    assert cob["standard_error"] < 0.5
    assert result["lag_s"] == pytest.approx(0.3)
    better, worse = (
        cob[f"held_out_r2_{name}"]
        for name in ("corrected", "printed")[:: 1 if corrected else -1]
    )
    assert sum(better) > sum(worse)
    assert min(better) > 0.9999


def test_what_cannot_be_used_is_said_in_one_line(
    script: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for folder in (tmp_path, tmp_path / "none"):
        assert script.main([str(folder)]) == 2
        said = capsys.readouterr().err
        assert said.startswith("identify_recordings: ")
        assert said.count("\n") == 1


@needs_recordings
def test_the_pool(script: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    """The findings that the documentation states."""
    folders = [RECORDINGS, RECORDINGS / "untidy"]
    result = found(script, capsys, *folders)
    assert len(result["recordings"]) == 6
    first, second, *_, last = result["combinations"]
    assert 0.02 < first["deviation"] < 0.05
    assert max(first["of"], key=lambda name: abs(first["of"][name])) == "link_2.ny"
    assert 0.05 < second["deviation"] < 0.12
    assert last["deviation"] > script.UNSEEN, "a common factor cannot be seen"
    assert all(
        one["deviation"] > 15 * one["by_digits"] for one in result["combinations"]
    )
    cob = result["link3_cob"]
    for point in (0.0, 1.0):
        assert abs(cob["fits_best_at"] - point) < 2 * cob["standard_error"], (
            "it can be told"
        )
    assert script.main([*map(str, folders)]) == 0
    assert "unseen" in capsys.readouterr().out
