"""Meshes and text templates that the writers of models copy."""

from __future__ import annotations

from pathlib import Path

from alpha5_model._support.paths import REPOSITORY_PATH
from alpha5_model.errors import MissingFileError


def mesh_assets(*suffixes: str) -> dict[str, bytes]:
    """Name -> content of the files in ``meshes/`` that end in one of the suffixes.

    Raises:
        MissingFileError: There are none.
    """
    folder = Path(REPOSITORY_PATH) / "meshes"
    files = {}
    for path in sorted(folder.glob("*")):
        if path.suffix in suffixes:
            files[path.name] = path.read_bytes()

    if not files:
        raise MissingFileError(folder, f"mesh files ({', '.join(suffixes)})")
    return files


def template(name: str) -> str:
    """Text of a file in ``templates/``."""
    folder = Path(__file__).with_name("templates")
    return (folder / name).read_text(encoding="utf-8")
