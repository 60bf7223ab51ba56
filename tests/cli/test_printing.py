"""Where progress is drawn: results on stdout stay clean."""

from __future__ import annotations

import pytest

from alpha5_model.cli.printing import progress_bars, progress_over


def test_progress_is_drawn_on_stderr(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    # Rich takes it for a terminal then.
    monkeypatch.setenv("FORCE_COLOR", "1")
    assert list(progress_over(["one", "two"], "Drawing", 2)) == ["one", "two"]
    with progress_bars() as progress:
        progress("Reading", 0.5)
    written = capsys.readouterr()
    assert written.out == ""
    assert "Drawing" in written.err
    assert "Reading" in written.err
