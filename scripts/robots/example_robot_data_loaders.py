"""Loaders of the Reach Alpha 5."""

from .utils import RobotLoader


class Alpha5Loader(RobotLoader):
    """Four joints, jaws locked; reference posture ``home``."""

    path = "alpha5_description"
    urdf_filename = "alpha5.urdf"
    urdf_subpath = "urdf"
    srdf_filename = "alpha5.srdf"
    ref_posture = "home"


class Alpha5JawsLoader(Alpha5Loader):
    """With the jaw rod, and the fingers that follow it."""

    urdf_filename = "alpha5_jaws.urdf"
    srdf_filename = "alpha5_jaws.srdf"
