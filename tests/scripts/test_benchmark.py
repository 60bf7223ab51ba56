"""The benchmark's frame: what it measures, and that its tables hold together."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"


@pytest.fixture
def timing(monkeypatch: pytest.MonkeyPatch) -> object:
    monkeypatch.syspath_prepend(str(SCRIPTS))
    from benchmarks import timing

    return timing


def test_measure_takes_turns_and_tells_fast_from_slow(
    timing: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls: list[str] = []
    now = 0.0  # a clock that only the candidates move, so that no load fails this test
    monkeypatch.setattr(timing, "time", SimpleNamespace(perf_counter=lambda: now))

    def candidate(name: str, seconds: float) -> object:
        def run() -> None:
            nonlocal now
            calls.append(name)
            now += seconds

        return run

    seconds = timing.measure(  # type: ignore[attr-defined]
        {"fast": candidate("fast", 0.002), "slow": candidate("slow", 0.02)},
        per_call=2,
        rounds=3,
    )
    assert seconds == pytest.approx({"fast": 0.001, "slow": 0.01}, rel=1e-9)
    assert "".join(name[0] for name in calls).count("sf") >= 2, "they take turns"


def test_rows_are_ratios_to_the_first_of_their_work(
    timing: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(SCRIPTS))
    from benchmarks import benchmark

    rows = [
        timing.Row("a", "ours", 2.0),  # type: ignore[attr-defined]
        timing.Row("a", "theirs", 6.0),  # type: ignore[attr-defined]
        timing.Row("b", "ours", 5.0),  # type: ignore[attr-defined]
    ]
    assert [benchmark.ratio(row, rows) for row in rows] == [1.0, 3.0, 1.0]


def test_unknown_section_is_refused() -> None:
    done = subprocess.run(
        [sys.executable, str(SCRIPTS / "benchmarks" / "benchmark.py"), "nonsense"],
        check=False,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 2
    assert "choose from" in done.stderr


def test_peers_that_are_missing_are_named(
    timing: object, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.syspath_prepend(str(SCRIPTS))
    from benchmarks import benchmark, kinematics

    absent = [*kinematics.missing(), "an absent peer"]
    benchmark.show([timing.Row("a", "ours", 2e-9, 1.0, "set up so")], absent)  # type: ignore[attr-defined]
    out = capsys.readouterr().out
    assert "2 ns" in out
    assert "100.00%" in out
    assert "set up so" in out
    for name in absent:
        assert name in out


def test_the_page_has_the_ratios_of_one_run(
    timing: object, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.syspath_prepend(str(SCRIPTS))
    from benchmarks import speed_page

    row = timing.Row  # type: ignore[attr-defined]
    rows = [
        row("import", "alpha5-model", 2e-6, 1.0),
        row("import", "roboticstoolbox", 6e-6, 0.5),
        row("import", "numpy", 8e-6),
    ]
    found = speed_page.comparisons(rows)
    assert [one.ratio for one in found] == pytest.approx([3.0, 4.0])

    page = tmp_path / "speed.md"
    page.write_text("before\n{}\nold\n{}\nafter\n".format(*speed_page.MARKS))
    monkeypatch.setattr(speed_page, "FIGURE", tmp_path / "speed.png")
    speed_page.write_page(page, rows)
    text = page.read_text()
    assert "| import | 2 µs | roboticstoolbox | 3 | 50% |" in text
    assert "old" not in text
    assert text.startswith("before\n")
    assert text.endswith("after\n")
    assert (tmp_path / "speed.png").read_bytes().startswith(b"\x89PNG")
    assert speed_page.bars(found) == pytest.approx({"import: roboticstoolbox": 3.0})
    shown = speed_page.figure(found).axes[0].get_yticklabels()
    assert [label.get_text() for label in shown] == ["import: roboticstoolbox"]
