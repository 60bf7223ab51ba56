"""Writes the arm as a page beside the documentation, which ``start.md`` shows."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import alpha5_model as a5
from alpha5_model.cli import main

#: The file, in the folder of the built pages.
NAME = "alpha5.html"


def write(folder: Path) -> None:
    """Write the page of the pose ``reach`` with what acts on the arm.

    Raises:
        RuntimeError: The command failed.
    """
    page = str(folder / NAME)
    shown = "bodies,com,cob,weight,buoyancy"
    if main(["view", "--pose", "reach", "--show", shown, "--html", page]) != 0:
        raise RuntimeError(f"alpha5 view did not write {NAME}")


def setup(app: Any) -> dict[str, Any]:
    """Sphinx's entry point."""

    def finished(sphinx: Any, error: Exception | None) -> None:
        if error is None and sphinx.builder.format == "html":
            write(Path(sphinx.outdir))

    app.connect("build-finished", finished)
    return {"parallel_read_safe": True, "version": a5.__version__}
