"""The notebooks run from top to bottom in their own kernels and are stored empty."""

from __future__ import annotations

import json
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient
from pages import DOCS

NOTEBOOKS = sorted((DOCS / "notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stored = json.loads(path.read_text("utf-8"))
    assert all(not cell.get("outputs") for cell in stored["cells"])
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path / "ipython"))
    resources = {"metadata": {"path": str(tmp_path)}}
    notebook = nbformat.read(path, as_version=4)
    cells = NotebookClient(notebook, timeout=120, resources=resources).execute().cells
    pictures = [
        o
        for c in cells
        for o in c.get("outputs", [])
        if "image/png" in o.get("data", {})
    ]
    assert len(pictures) >= 3
    assert not [
        o for c in cells for o in c.get("outputs", []) if o.get("name") == "stderr"
    ]
