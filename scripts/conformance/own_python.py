"""Environments of their own, for tools whose packages do not go beside ours."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from conformance.ros_tools import NotThereError


def bare() -> dict[str, str]:
    """The environment's variables without ours."""
    ours = ("PIP_CONSTRAINT", "PYTHONPATH")
    return {name: value for name, value in os.environ.items() if name not in ours}


def own_python(folder: Path, *packages: str) -> str:
    """An interpreter with some packages; they are installed once.

    Raises:
        NotThereError: pip does not install them.
    """
    python = folder / "bin" / "python"
    done = folder / "done"
    if done.is_file():
        return str(python)
    make = [sys.executable, "-m", "venv", str(folder)]
    subprocess.run(make, check=True, env=bare())
    pip = [str(python), "-m", "pip", "install", "--quiet", *packages]
    try:
        subprocess.run(pip, capture_output=True, env=bare(), check=True, timeout=240)
    except (subprocess.CalledProcessError, subprocess.TimeoutExpired):
        raise NotThereError(f"pip does not install {' '.join(packages)}") from None
    done.touch()
    return str(python)
