"""A fixed joint between base_link and axis_e that is turned about axis_e.

It turns link_0 and all that follows. That looks like a shifted zero of axis_e and wrong
numbers of link_0, so it is mended before both are judged.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import rotation_about, transform
from alpha5_model.description.urdf_robot import UrdfRobot
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.proofs.comparison.described import BETTER, Described
from alpha5_model.proofs.comparison.joint_mistakes import JointMistake
from alpha5_model.proofs.comparison.reduced import Reduced, Z

#: A smaller turn is rounding [rad].
LEAST_TURN = 1e-4
#: The COM of link_0 is ours if it is this close, once turned back [m].
SAME_COM = 1e-3


def turned_base_joint(
    robot: UrdfRobot, theirs: Reduced, described: Described, record: Alpha5Parameters
) -> JointMistake | None:
    """The fixed joint that explains a turned link_0 and a shifted zero of axis_e.

    Args:
        robot: The other model as it is meant.
        theirs: It, reduced.
        described: It in our terms.
        record: Our arm.

    Returns:
        None if the base link is not the model's own base_link, if there is not just one
        joint between it and axis_e, or if turning it back does not bring both the COM
        and the tensor of link_0 to ours.
    """
    base = described.base_link
    is_own = base.endswith("base_link") and base not in theirs.foreign
    turn = float(described.sign[0] * described.zero[0])
    if not (described.same_base and is_own and theirs.mass[0]):
        return None
    behind = theirs.base_path[theirs.base_path.index(base) + 1 :]
    if len(behind) != 1 or abs(turn) < LEAST_TURN:
        return None

    back = rotation_about(Z, turn)
    com = back @ described.coms[0]
    turned = _error(com, back @ described.inertias[0] @ back.T, record)
    written = _error(described.coms[0], described.inertias[0], record)
    is_ours = np.linalg.norm(com - record.links[0].com) < SAME_COM
    if not is_ours or BETTER * turned > written:
        return None

    (joint,) = (one for one in robot.joints.values() if one.child == behind[0])
    parent = described.placed[0] @ theirs.link_poses[joint.parent]
    origin = np.linalg.inv(parent) @ transform(back) @ parent @ joint.transform
    right = replace(joint, transform=origin)
    return JointMistake(id="turned_base", written=joint, right=right)


def _error(com: FloatArray, inertia: FloatArray, record: Alpha5Parameters) -> float:
    """Error of link_0 as one number, in second moments [kg m^2]."""
    ours = record.links[0]
    off = com - ours.com
    return float(ours.mass * (off @ off) + np.abs(inertia - ours.inertia).max())
