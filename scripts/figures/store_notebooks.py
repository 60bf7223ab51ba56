"""Run the notebooks and store them with their outputs.

    python scripts/figures/store_notebooks.py

GitHub and the documentation show a notebook as it is stored. What differs from run to
run is left out: counts of executions, times, versions. A test compares the texts.
"""

from __future__ import annotations

import base64
import io
import sys
import tempfile
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbformat import NotebookNode
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOKS = sorted((ROOT / "docs" / "notebooks").glob("*.ipynb"))

#: Colours of a stored picture: lines and shaded bodies look the same with so many.
COLORS = 64
#: Longest run of a cell [s].
LONGEST = 120


def executed(path: Path, folder: Path) -> NotebookNode:
    """A notebook with the outputs of a run in a folder, in the form that is stored."""
    notebook = nbformat.read(path, as_version=4)
    resources = {"metadata": {"path": str(folder)}}
    NotebookClient(notebook, timeout=LONGEST, resources=resources).execute()

    notebook.metadata.language_info = NotebookNode(name="python")
    for cell in notebook.cells:
        cell.metadata = NotebookNode()
        if cell.cell_type == "code":
            cell.execution_count = None
            cell.outputs = _joined(cell.outputs)
            for output in cell.outputs:
                _simplify(output)
    return notebook


def _joined(outputs: list[NotebookNode]) -> list[NotebookNode]:
    """Outputs with each stream in one piece: the kernel cuts them at any place."""
    joined: list[NotebookNode] = []
    for output in outputs:
        last = joined[-1] if joined else NotebookNode()
        if output.output_type == "stream" and last.get("name") == output.name:
            last.text += output.text
        else:
            joined.append(output)
    return joined


def _simplify(output: NotebookNode) -> None:
    """Remove the count of the execution, and store a picture in few colours."""
    if "execution_count" in output:
        output.execution_count = None
    if "metadata" in output:
        output.metadata = NotebookNode()
    picture = output.get("data", {}).get("image/png")
    if picture is not None:
        output.data["image/png"] = _in_few_colors(picture)


def _in_few_colors(encoded: str) -> str:
    opened = Image.open(io.BytesIO(base64.b64decode(encoded)))
    reduced = opened.convert("RGB").quantize(COLORS, dither=Image.Dither.NONE)
    file = io.BytesIO()
    reduced.save(file, format="PNG", optimize=True)
    return base64.b64encode(file.getvalue()).decode("ascii")


def main() -> int:
    """Run each notebook in an empty folder and write it."""
    for path in NOTEBOOKS:
        with tempfile.TemporaryDirectory() as folder:
            notebook = executed(path, Path(folder))
        nbformat.write(notebook, path)
        print(f"{path.relative_to(ROOT)}: {path.stat().st_size / 1e3:.0f} kB")
    return 0


if __name__ == "__main__":
    sys.exit(main())
