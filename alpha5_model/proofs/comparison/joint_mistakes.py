"""Mistakes in joints that hide the arm: mm or cm, degrees, another axis.

They are mended before the axes are compared, because an arm of 150 m has no likeness to
this one.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import pose, rotation_about, transform
from alpha5_model.description.urdf_robot import UrdfJoint, UrdfRobot
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.proofs.comparison.described import BETTER, Described
from alpha5_model.proofs.comparison.model import Chain, find_chains
from alpha5_model.proofs.comparison.reduced import Reduced, Z

#: No origin of this arm's joints is so far from the one before it [m].
FARTHEST = 1.0
#: Units that lengths are written in by mistake.
PER_METRE = {"millimetres": 1e3, "centimetres": 1e2}
#: An angle beyond this is in degrees [rad].
LARGEST_ANGLE = math.tau + 0.01
#: A smaller turn of the base is rounding [rad].
LEAST_TURN = 1e-4
#: The COM of link_0 is ours if it is this close, once turned back [m].
SAME_COM = 1e-3
#: Axes that differ by more than the first may have been exchanged. They have been if
#: less than the second is left, and a quarter of what it was [m]; see `Chain.misfit`.
MISFIT = (1e-3, 5e-3)
#: An arm with more turning joints behind these four is another one; it may have jaws.
MOST_FOLLOWING = 2
#: Most axes that are exchanged at once; with three, any four joints would fit.
MOST_EXCHANGED = 2


class JointMistake(NamedTuple):
    """A joint that was mended.

    Attributes:
        id: ``millimetres``, ``centimetres``, ``degrees``, ``exchanged_axis`` or
            ``turned_base``.
        written: The joint as it is written.
        right: The joint as it was meant.
    """

    id: str
    written: UrdfJoint
    right: UrdfJoint


def without_joint_mistakes(
    robot: UrdfRobot,
    record: Alpha5Parameters,
    names: Mapping[str, str] | None = None,
) -> tuple[UrdfRobot, list[JointMistake]]:
    """Mend the mistakes in joints that hide the arm.

    A unit is only changed if no arm can have the number: an origin more than 1 m away,
    an angle of more than a full turn. Axes are only exchanged if the shape of the arm
    is right afterwards. The origins of what carries the arm are left as they are.

    Args:
        robot: As it is written.
        record: Our arm.
        names: Our joint name -> theirs, for joints that the user names.

    Returns:
        The robot as it was meant, and what was mended, from the root outwards.
    """
    best = None
    for unit, per_metre in PER_METRE.items():
        in_si = [_in_si(joint, per_metre) for joint in robot.joints.values()]
        everywhere = _with_joints(robot, in_si)
        chains = find_chains(everywhere, record, names)
        if chains and (best is None or chains[0].misfit < best[0].misfit):
            best = chains[0], unit, everywhere
        if not any(map(_is_far, robot.joints.values())):
            break  # the units are all one
    if best is None:
        return robot, []

    chain, unit, everywhere = best
    arm = {joint.name for joint in _behind(robot, chain.joints[0])}
    carriers = [joint for name, joint in robot.joints.items() if name not in arm]
    mended = _with_joints(everywhere, map(_in_si, carriers))
    if chain.misfit > MISFIT[0] and chain.following <= MOST_FOLLOWING:
        mended = _with_right_axes(mended, chain, record) or mended

    found = []
    for name, right in mended.joints.items():
        found += _mistakes(robot.joints[name], right, unit)
    return mended, found


def _behind(robot: UrdfRobot, first: UrdfJoint) -> list[UrdfJoint]:
    """A joint and all that move with it, and those fixed to its parent."""
    links = {first.parent}
    joints = []
    for joint in robot.joints.values():  # each after the joint before it
        if joint.parent in links:
            links.add(joint.child)
            joints.append(joint)
    return joints


def _with_joints(robot: UrdfRobot, joints: Iterable[UrdfJoint]) -> UrdfRobot:
    """The robot with other joints of the same names."""
    changed = {joint.name: joint for joint in joints}
    return replace(robot, joints={**robot.joints, **changed})


def _is_far(joint: UrdfJoint) -> bool:
    """Whether an origin is too far away to be in metres."""
    return bool(np.linalg.norm(joint.transform[:3, 3]) > FARTHEST)


def _in_si(joint: UrdfJoint, per_metre: float = 1.0) -> UrdfJoint:
    """The joint with its origin in m and rad; the same one if it is.

    Args:
        joint: As it is written.
        per_metre: The unit of its origin, if that is too far away to be in m.
    """
    is_far = per_metre != 1 and _is_far(joint)
    texts = joint.printed[1].split()
    in_degrees = any(abs(float(text)) > LARGEST_ANGLE for text in texts)
    if not (is_far or in_degrees):
        return joint

    transform = joint.transform.copy()
    xyz, rpy = joint.printed
    if is_far:
        transform[:3, 3] /= per_metre
        xyz = " ".join(repr(x) for x in transform[:3, 3].tolist())
    if in_degrees:
        angles = [math.radians(float(text)) for text in rpy.split()]
        transform = pose(transform[:3, 3], angles)
        rpy = " ".join(map(repr, angles))
    return replace(joint, transform=transform, printed=(xyz, rpy))


def _with_right_axes(
    robot: UrdfRobot, chain: Chain, record: Alpha5Parameters
) -> UrdfRobot | None:
    """The robot with one or two axes exchanged, if its arm then has our shape."""
    choices = {joint.name: list(_other_axes(joint)) for joint in chain.joints}
    for count in range(1, MOST_EXCHANGED + 1):
        for places in itertools.combinations(chain.names, count):
            for joints in itertools.product(*(choices[name] for name in places)):
                changed = _with_joints(robot, joints)
                left = find_chains(changed, record, chain.mapping)[0].misfit
                if left < min(MISFIT[1], chain.misfit / 4):
                    return changed
    return None


def _other_axes(joint: UrdfJoint) -> Iterator[UrdfJoint]:
    """The joint with each coordinate axis of its frame that it does not turn about."""
    for axis in np.eye(3):
        if abs(axis @ joint.axis) < 0.9:
            yield replace(joint, axis=axis)


def _mistakes(written: UrdfJoint, right: UrdfJoint, unit: str) -> list[JointMistake]:
    """How a joint differs from what was meant.

    Args:
        written: As it is.
        right: As it was meant.
        unit: Of origins that are not in metres.
    """
    found = []
    if right.printed[0] != written.printed[0]:
        found.append(JointMistake(unit, written, right))
    if right.printed[1] != written.printed[1]:
        found.append(JointMistake("degrees", written, right))
    if right.axis is not written.axis:
        found.append(JointMistake("exchanged_axis", written, right))
    return found


# --- A turned base -------------------------------------------------------------------


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
