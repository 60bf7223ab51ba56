"""The committed mesh files, for the folders that simulators load."""

from __future__ import annotations

from pathlib import Path

from alpha5_model.errors import MissingFileError
from alpha5_model.paths import REPOSITORY_PATH


def mesh_assets(*suffixes: str) -> dict[str, bytes]:
    """Name -> content of the files in ``meshes/`` that end in one of the suffixes.

    Raises:
        MissingFileError: There are none.
    """
    folder = Path(REPOSITORY_PATH) / "meshes"
    files = {p.name: p.read_bytes() for p in sorted(folder.glob("*")) if p.suffix in suffixes}
    if not files:
        raise MissingFileError(folder, f"mesh files ({', '.join(suffixes)})")
    return files
