"""The notebooks are stored with the outputs that they have when they run."""

from __future__ import annotations

import base64
import io
import re
from pathlib import Path
from typing import Any

import nbformat
import pytest
from figures.store_notebooks import NOTEBOOKS, executed
from nbformat import NotebookNode
from PIL import Image

#: Bytes of all notebooks together: readers load them, and git keeps every version.
LARGEST = 1_500_000
#: Addresses in memory and paths of a machine: they differ from run to run.
VARYING = re.compile(r"0x[0-9a-f]{6}|/(tmp|home|root|Users|usr)/|[A-Z]:\\")


def outputs(notebook: NotebookNode) -> list[NotebookNode]:
    """Outputs of all cells, each with the id of its cell."""
    return [
        NotebookNode(output, cell=cell.id)
        for cell in notebook.cells
        for output in cell.get("outputs", [])
    ]


def texts(notebook: NotebookNode) -> list[dict[str, Any]]:
    """What the outputs say, without pictures."""
    return [
        {
            "cell": output.cell,
            "kind": output.output_type,
            "stream": output.get("name"),
            "text": output.get("text"),
            "data": {**output.get("data", {}), "image/png": None},
        }
        for output in outputs(notebook)
    ]


def picture_sizes(notebook: NotebookNode) -> dict[str, tuple[int, int]]:
    """Id of a cell -> width and height of its picture."""
    found = {}
    for output in outputs(notebook):
        picture = output.get("data", {}).get("image/png")
        if picture is not None:
            opened = Image.open(io.BytesIO(base64.b64decode(picture)))
            opened.load()
            found[output.cell] = opened.size
    return found


def test_all_notebooks_are_found():
    assert [path.stem for path in NOTEBOOKS] == ["mount-load", "tour"]
    assert sum(path.stat().st_size for path in NOTEBOOKS) < LARGEST


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_stored_with_its_outputs(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path / "ipython"))
    stored = nbformat.read(path, as_version=4)
    ran = executed(path, tmp_path)
    assert texts(ran) == texts(stored)
    assert ran.metadata == stored.metadata

    # Fonts of another version change a picture by some pixels.
    sizes = picture_sizes(stored)
    assert len(sizes) >= 3
    assert picture_sizes(ran).keys() == sizes.keys()
    for cell, size in picture_sizes(ran).items():
        assert size == pytest.approx(sizes[cell], rel=0.03)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_nothing_of_a_run_is_stored(path: Path) -> None:
    stored = nbformat.read(path, as_version=4)
    for cell in stored.cells:
        assert cell.metadata == {}
        assert cell.get("execution_count") is None
    for output in outputs(stored):
        assert output.get("execution_count") is None
        assert output.get("name") != "stderr"
    assert not VARYING.search(str(texts(stored)))
