"""The arm as a module of robot_descriptions: paths, and the metadata of its index.

``robot_descriptions.loaders`` read the constants of such a module. To add the arm to
that collection, only ``REPOSITORY_PATH`` would come from its cache instead.
"""

from __future__ import annotations

from pathlib import Path

from alpha5_model._support import paths
from alpha5_model.description.srdf import NAMED_POSES

REPOSITORY_PATH = paths.REPOSITORY_PATH
URDF_PATH = paths.URDF_PATH
JAWS_URDF_PATH = paths.JAWS_URDF_PATH
XACRO_PATH = paths.XACRO_PATH
#: Jaws locked; beside it are ``alpha5_jaws``, ``scene`` and ``scene_jaws``.
MJCF_PATH = paths.MJCF_PATH
#: The collection's loaders find relative mesh paths from here, yourdfpy's from nowhere
#: else.
PACKAGE_PATH = str(Path(URDF_PATH).parent)
#: Collision pairs and the postures below, for ``URDF_PATH``.
SRDF_PATH = str(Path(URDF_PATH).with_suffix(".srdf"))
#: Name -> positions of axis_e, axis_d, axis_c, axis_b [rad].
REFERENCE_POSTURES = NAMED_POSES
#: Metadata with the keys of robot_descriptions' index (since version 3), formats by
#: name.
DESCRIPTION: dict[str, object] = {
    "formats": ("URDF", "SRDF", "MJCF"),
    "tags": ("arm",),
    "robot": "Reach Alpha 5",
    "maker": "Reach Robotics",
    "dof": 4,
    "repository": "alpha5-model",
    "license_spdx": "BSD-3-Clause",
    "license_file": "LICENSE",
}
