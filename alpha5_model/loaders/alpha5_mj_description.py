"""The arm for MuJoCo as a module of robot_descriptions, from ``mjcf/``."""

from __future__ import annotations

from pathlib import Path

from alpha5_model._support import paths
from alpha5_model.loaders import alpha5_description

REPOSITORY_PATH = paths.REPOSITORY_PATH
MJCF_PATH = paths.MJCF_PATH
PACKAGE_PATH = str(Path(MJCF_PATH).parent)
#: As `alpha5_description.DESCRIPTION`. Beside the model are the variants
#: ``alpha5_jaws``, ``scene`` and ``scene_jaws``.
DESCRIPTION: dict[str, object] = {
    **alpha5_description.DESCRIPTION,
    "formats": ("MJCF",),
    "license_file": "mjcf/LICENSE",
}
