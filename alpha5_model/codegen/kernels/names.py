"""Names of the kernels that come twice: for the catalogue's arm, and for any arm."""

from __future__ import annotations

#: The kernels that have the catalogue's dimensions as constants.
KINEMATICS = ("forward_kinematics", "link_poses", "jacobian")


def own(kernel: str) -> str:
    """The kernel that takes the dimensions of an arm instead."""
    return f"own_{kernel}"
