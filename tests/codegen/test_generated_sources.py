"""The generated sources that are committed are those of the equations."""

from __future__ import annotations

from pathlib import Path

import pytest

from alpha5_model._support.paths import REPOSITORY_PATH


@pytest.mark.slow
def test_the_committed_sources_are_those_of_the_equations() -> None:
    from alpha5_model.codegen.sources import generated_sources

    root = Path(REPOSITORY_PATH)
    for path, fresh in generated_sources().items():
        committed = (root / path).read_text(encoding="utf-8")
        assert committed == fresh, f"{path}: python scripts/generate.py"


@pytest.mark.slow
def test_nothing_else_lies_beside_the_generated_kernels() -> None:
    """A source that nothing generates any more would become stale unseen."""
    from alpha5_model.codegen.sources import generated_sources

    root = Path(REPOSITORY_PATH)
    folder = root / "alpha5_model" / "kernels" / "generated"
    found = {path.relative_to(root).as_posix() for path in folder.glob("*.*")}
    expected = {
        path
        for path in generated_sources()
        if path.startswith(folder.relative_to(root).as_posix())
    }
    assert found == expected
