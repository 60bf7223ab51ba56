"""The generated files that are committed, and how far they are from a fresh generation."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from alpha5_model.description.meshes import mesh_files
from alpha5_model.description.srdf import srdf
from alpha5_model.description.variants import Variant, parameter_yaml, urdf
from alpha5_model.files import atomic_write_all
from alpha5_model.parameters import parameters
from alpha5_model.paths import REPOSITORY_PATH

#: Printed where the meshes cannot be drawn.
NOT_DRAWN = "manifold3d is not installed: the meshes are not drawn anew (pip install manifold3d)"


@dataclass(frozen=True)
class StaleFile:
    """A committed file that differs from what would be generated now.

    Attributes:
        path: Relative to the repository.
        diff: Unified diff, committed against fresh; one line for binary or missing files.
    """

    path: str
    diff: str


def generated_files() -> dict[str, bytes]:
    """Every file that is committed and generated: path in the repository -> content.

    The meshes are there only where `can_draw`.
    """
    texts = {
        "xacro/parameters.yaml": parameter_yaml(parameters()),
        "urdf/alpha5.urdf": urdf(Variant()),
        "urdf/alpha5_jaws.urdf": urdf(Variant(gripper="jaws")),
        "urdf/alpha5.srdf": srdf(),
        "urdf/alpha5_jaws.srdf": srdf("jaws"),
    }
    return {
        **{path: text.encode("utf-8") for path, text in texts.items()},
        **{f"meshes/{n}": content for n, content in (mesh_files() if can_draw() else {}).items()},
    }


def can_draw() -> bool:
    """Whether manifold3d, with which the bodies are drawn, is installed."""
    return find_spec("manifold3d") is not None


def stale_files(
    repository: str = REPOSITORY_PATH, fresh: Mapping[str, bytes] | None = None
) -> list[StaleFile]:
    """Compare the committed files with a fresh generation; empty if all agree.

    Args:
        repository: Folder that holds ``urdf/``, ``xacro/`` and ``meshes/``.
        fresh: Result of `generated_files`; computed if not given.
    """
    stale = []
    for path, content in (generated_files() if fresh is None else fresh).items():
        file = Path(repository) / path
        committed = file.read_bytes() if file.is_file() else None
        if committed != content:
            stale.append(StaleFile(path, _diff(path, committed, content)))
    return stale


def update(repository: str = REPOSITORY_PATH) -> list[Path]:
    """Write the generated files into the repository; returns the paths that changed."""
    fresh = generated_files()
    stale = stale_files(repository, fresh)
    changed = {Path(repository) / file.path: fresh[file.path] for file in stale}
    atomic_write_all(changed)
    return list(changed)


def _diff(path: str, committed: bytes | None, fresh: bytes) -> str:
    if committed is None:
        return f"{path}: missing\n"
    try:
        old, new = (text.decode("utf-8").splitlines(True) for text in (committed, fresh))
    except UnicodeDecodeError:
        return f"{path}: {len(committed)} bytes differ from {len(fresh)} fresh ones\n"
    return "".join(difflib.unified_diff(old, new, f"committed/{path}", f"fresh/{path}"))
