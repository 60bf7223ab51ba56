"""The arm in the formats of collections of robots.

For example-robot-data: `robot_files`, its folder under ``robots/``, and
``alpha5_loader``, its loaders. For robot_descriptions: the modules
``alpha5_description`` and ``alpha5_mj_description``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from alpha5_model._support.paths import REPOSITORY_PATH
from alpha5_model.description.assets import mesh_assets
from alpha5_model.description.srdf import srdf
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.errors import needing

FOLDER = "alpha5_description"
_MESHES = f"package://example-robot-data/robots/{FOLDER}/meshes/"


def robot_files() -> dict[str, bytes]:
    """The folder: path under ``robots/`` -> content, with its own mesh URIs."""
    files = {
        "README.md": Path(__file__).with_name("readme.md").read_bytes(),
        "LICENSE": (Path(REPOSITORY_PATH) / "LICENSE").read_bytes(),
    }
    for name, content in mesh_assets(".obj", ".mtl").items():
        files[f"meshes/{name}"] = content
    for gripper, name in (("locked", "alpha5"), ("jaws", "alpha5_jaws")):
        variant = Variant(gripper=gripper, mesh_prefix=_MESHES)
        files[f"urdf/{name}.urdf"] = urdf(variant).encode()
        files[f"srdf/{name}.srdf"] = srdf(gripper).encode()
    return {f"{FOLDER}/{path}": content for path, content in files.items()}


def loader_class() -> Any:
    """example-robot-data's loader of the arm, reference posture ``home``.

    Raises:
        MissingDependencyError: example-robot-data-loaders is not installed.
    """
    package = "example-robot-data-loaders"
    with needing("the loader class", f"python -m pip install {package}", package):
        from alpha5_model.loaders.alpha5_loader import Alpha5Loader
    return Alpha5Loader
