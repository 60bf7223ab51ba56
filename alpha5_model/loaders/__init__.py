"""The arm as a robot of example-robot-data: its folder under ``robots/``, and its loader class.

Beside it `alpha5_description`, a module of the kind that robot_descriptions collects.
"""

from __future__ import annotations

from typing import Any

from alpha5_model.description import mesh_assets
from alpha5_model.description.srdf import srdf
from alpha5_model.description.variants import Variant, urdf
from alpha5_model.errors import MissingDependencyError

FOLDER = "alpha5_description"
_MESHES = f"package://example-robot-data/robots/{FOLDER}/meshes/"


def robot_files() -> dict[str, bytes]:
    """The folder: path under ``robots/`` -> content, mesh URIs as that collection has them."""
    files = {
        "urdf/alpha5.urdf": urdf(Variant(mesh_prefix=_MESHES)).encode(),
        "srdf/alpha5.srdf": srdf().encode(),
        **{f"meshes/{name}": data for name, data in mesh_assets(".obj", ".mtl").items()},
    }
    return {f"{FOLDER}/{path}": content for path, content in files.items()}


def loader_class() -> Any:
    """A subclass of example-robot-data's ``RobotLoader``, reference posture ``home``.

    Raises:
        MissingDependencyError: example-robot-data-loaders is not installed.
    """
    try:
        from example_robot_data.utils import RobotLoader
    except ImportError:
        package = "example-robot-data-loaders"
        remedy = f"python -m pip install {package}"
        raise MissingDependencyError(package, "the loader class", remedy) from None

    class Alpha5Loader(RobotLoader):  # type: ignore[misc]
        path = FOLDER
        urdf_filename = "alpha5.urdf"
        urdf_subpath = "urdf"
        srdf_filename = "alpha5.srdf"
        ref_posture = "home"

    return Alpha5Loader
