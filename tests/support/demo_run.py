"""One run of ``alpha5 demo`` for every test that looks at what it makes."""

from __future__ import annotations

import atexit
import contextlib
import io
import shutil
import tempfile
from functools import cache
from pathlib import Path

from alpha5_model.cli import main


@cache
def demo_run() -> tuple[Path, str]:
    """The folder that it wrote, and what it said."""
    folder = Path(tempfile.mkdtemp(prefix="alpha5-demo-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        assert main(["demo", "--output", str(folder)]) == 0
    return folder, said.getvalue()
