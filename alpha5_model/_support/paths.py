"""Where the files are: in a checkout, or inside an installed wheel."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent.parent
_WHEEL_DATA = _PACKAGE / "_data"
#: Folder with ``urdf/``, ``xacro/``, ``meshes/``, ``mjcf/``: the checkout, or the
#: wheel's data folder.
REPOSITORY_PATH = str(_WHEEL_DATA if _WHEEL_DATA.is_dir() else _PACKAGE.parent)
#: Folder to which ``package://alpha5_description`` resolves.
PACKAGE_PATH = REPOSITORY_PATH
#: The arm with its jaws locked, 4 joints.
URDF_PATH = str(Path(REPOSITORY_PATH) / "urdf" / "alpha5.urdf")
#: The arm with jaws: 5 joints, and 2 fingers that follow the last one.
JAWS_URDF_PATH = str(Path(REPOSITORY_PATH) / "urdf" / "alpha5_jaws.urdf")
#: MuJoCo, in the form of MuJoCo Menagerie, jaws locked; ``alpha5_jaws.xml`` beside it.
MJCF_PATH = str(Path(REPOSITORY_PATH) / "mjcf" / "alpha5.xml")
#: For plain xacro, with arguments.
XACRO_PATH = str(Path(REPOSITORY_PATH) / "xacro" / "alpha5.urdf.xacro")
