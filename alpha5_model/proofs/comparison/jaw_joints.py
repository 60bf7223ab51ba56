"""The joints of another model's jaws, if they are ours, and what is wrong with them.

They are mended before the bodies are judged: a finger that stands elsewhere looks like
a link_4 with another centre of mass. Jaws of another design are left alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import pose
from alpha5_model.description.bodies import Body, arm_bodies
from alpha5_model.description.urdf_robot import UrdfJoint, UrdfLink, UrdfRobot
from alpha5_model.errors import InputError
from alpha5_model.numbers.jaws import FingerJoint, split_link_4
from alpha5_model.numbers.parameters import Alpha5Parameters, JointRange
from alpha5_model.proofs.comparison.corrections import (
    LIMIT_TOLERANCE,
    angle_between,
    origin_attributes,
    urdf_numbers,
    velocity_differs,
)
from alpha5_model.proofs.comparison.described import Described
from alpha5_model.proofs.comparison.digits import last_digits, last_place
from alpha5_model.proofs.comparison.model import rest_position
from alpha5_model.proofs.comparison.reduced import Reduced, Z
from alpha5_model.proofs.comparison.result import (
    Correction,
    Finding,
    finding,
    place_text,
)
from alpha5_model.proofs.comparison.wrong_numbers import SAME_FRAME

#: A link is one of ours if its mass, relative, and its COM [m] are as close as this.
SAME_MASS, SAME_COM = 0.01, 1e-4
#: So many of rod and fingers have to be ours, or the jaws are another design.
LEAST_PARTS = 2
#: Joint origins that are closer are the same [m], [rad].
LENGTH_TOLERANCE, ANGLE_TOLERANCE = 1e-5, 1e-4
#: Limits and positions of the rod that are closer are the same [m]: they turn the
#: fingers by less than `LIMIT_TOLERANCE`.
TRAVEL_TOLERANCE = 3e-5


@dataclass(frozen=True, eq=False)
class JawJoint:
    """A joint of the other model's jaws that is one of ours.

    Attributes:
        joint: As it is meant: in m and rad.
        right: As it has to be. Its own zero and sense are kept if its limits fit them.
        ours: Our joint.
    """

    joint: UrdfJoint
    right: UrdfJoint
    ours: JointRange

    @property
    def unit(self) -> str:
        """Of its positions."""
        return "m" if is_of_rod(self.ours) else "rad"

    @property
    def correction(self) -> Correction | None:
        """The elements to write in place of its own; None if they are right."""
        elements: dict[str, Mapping[str, str] | None] = {}
        written, right = self.joint, self.right
        if written.kind != right.kind:
            elements["joint"] = {"type": right.kind}
        if written.transform is not right.transform:
            elements["origin"] = origin_attributes(right.transform)
        if written.axis is not right.axis:
            elements["axis"] = {"xyz": urdf_numbers(right.axis)}
        limit = {}
        for name in ("lower", "upper"):
            if getattr(written, name) != getattr(right, name):
                limit[name] = f"{getattr(right, name):.7g}"
        for name in ("velocity", "effort"):
            own = getattr(self.ours, name)
            value = getattr(written, name)
            if not value or (name == "velocity" and velocity_differs(value, own)):
                limit[name] = f"{own:.5g}"
        if limit:
            elements["limit"] = limit
        if _mimic(written) != _mimic(right):
            elements["mimic"] = None
            if right.mimic is not None:
                elements["mimic"] = {
                    "joint": right.mimic,
                    "multiplier": f"{right.multiplier:.9g}",
                    "offset": f"{right.offset:.9g}",
                }
        if not elements:
            return None
        return Correction("joint", written.name, elements)


def is_of_rod(ours: JointRange) -> bool:
    """Whether a joint of our jaws is the rod's: the fingers follow it."""
    return not isinstance(ours, FingerJoint)


def jaw_joints(
    robot: UrdfRobot, theirs: Reduced, described: Described, arm: Alpha5Parameters
) -> tuple[JawJoint, ...]:
    """The joints of the other model's jaws that are ours, the rod's first.

    Args:
        robot: The other model as it is meant.
        theirs: It, reduced.
        described: It in our terms.
        arm: Our arm.

    Returns:
        Empty without jaws, and for jaws of another design.
    """
    rigid = _fixed_to(robot, theirs.joints[3].child)
    moving = []
    for joint in robot.joints.values():
        if joint.parent in rigid and joint.kind != "fixed":
            moving.append(joint)
    if len(moving) < LEAST_PARTS:
        return ()
    try:
        bodies = arm_bodies(arm, "jaws")[5:]
        ours = split_link_4(arm).joints
    except InputError:  # the arm's link_4 leaves no possible wrist
        return ()

    places: dict[str, _Place] = {}
    for body, own in zip(bodies, ours, strict=True):
        taken = [place.joint for place in places.values()]
        for joint in moving:
            parent = described.placed[4] @ theirs.link_poses[joint.parent]
            frame = _our_frame(robot, joint, body, own, parent)
            if frame is not None and not any(joint is one for one in taken):
                places[body.name] = _Place(joint, body, own, parent, frame)
                break
    if len(places) < LEAST_PARTS:
        return ()
    return tuple(_with_mimics(places))


class _Place(NamedTuple):
    """Where one of our bodies is in the other model's jaws.

    Attributes:
        joint: The joint that carries it.
        body: Our body.
        ours: Its joint in our arm.
        parent: Pose of the joint's parent in our link_4, (4, 4).
        frame: Pose in the joint's child of the link that is our body, (4, 4).
    """

    joint: UrdfJoint
    body: Body
    ours: JointRange
    parent: FloatArray
    frame: FloatArray


def _fixed_to(robot: UrdfRobot, link: str) -> dict[str, FloatArray]:
    """A link and those fixed to it -> their poses (4, 4) in it."""
    poses = {link: np.eye(4)}
    for joint in robot.joints.values():  # each after the joint before it
        if joint.parent in poses and joint.kind == "fixed":
            poses[joint.child] = poses[joint.parent] @ joint.transform
    return poses


def _our_frame(
    robot: UrdfRobot,
    joint: UrdfJoint,
    body: Body,
    ours: JointRange,
    parent: FloatArray,
) -> FloatArray | None:
    """The pose in a joint's child of the link that is one of our bodies, (4, 4).

    Args:
        robot: The other model.
        joint: The joint.
        body: One of our jaws.
        ours: Its joint.
        parent: Pose of the joint's parent in our link_4, (4, 4).

    Returns:
        None if no link that the joint carries is the body: none stands where it does
        with the jaws closed, and none has its mass and COM.
    """
    closed = parent @ joint.transform @ joint.motion(rest_position(robot, joint))
    expected = _at(body, ours, ours.lower)
    for name, in_child in _fixed_to(robot, joint.child).items():
        stands = np.abs(closed @ in_child - expected).max() < SAME_FRAME
        link = robot.links[name]
        if (stands and link.mass) or _is_same_body(link, body):
            return in_child
    return None


def _is_same_body(link: UrdfLink, body: Body) -> bool:
    """Whether a link has the mass and COM of one of our bodies, in the same frame."""
    if not link.mass or abs(link.mass - body.mass) > SAME_MASS * body.mass:
        return False
    return bool(np.abs(link.com - body.com).max() < SAME_COM)


def _at(body: Body, ours: JointRange, position: float) -> FloatArray:
    """Pose of one of our jaws in link_4 at a position of its joint, (4, 4)."""
    zero = pose(body.placement.xyz, body.placement.rpy)
    return zero @ _kind(ours).motion(position)


def _kind(ours: JointRange) -> UrdfJoint:
    """Our joint, without a place."""
    kind = "prismatic" if is_of_rod(ours) else "revolute"
    return UrdfJoint(
        name=ours.name,
        kind=kind,
        parent="",
        child="",
        transform=np.eye(4),
        axis=Z,
    )


def _right(place: _Place) -> UrdfJoint:
    """A joint as it has to be, but for what it follows."""
    joint, body, ours, parent, frame = place
    zero = _zero(joint, place)
    if zero is not None and _has_limits(joint, ours, zero):
        return joint
    own = _kind(ours)
    origin = np.linalg.inv(parent) @ _at(body, ours, 0.0) @ np.linalg.inv(frame)
    axis = frame[:3, :3] @ Z
    is_placed = _is_same_pose(joint, joint.transform, origin)
    is_along = np.linalg.norm(joint.axis - axis) < ANGLE_TOLERANCE
    ends = {}
    for name in ("lower", "upper"):
        written = getattr(joint, name)
        own_end = getattr(ours, name)
        is_same = written is not None and abs(written - own_end) <= _rounding(
            joint, ours, name
        )
        ends[name] = written if is_same else own_end
    return replace(
        joint,
        kind=own.kind,
        transform=joint.transform if is_placed else origin,
        axis=joint.axis if is_along else axis,
        lower=ends["lower"],
        upper=ends["upper"],
    )


def _zero(joint: UrdfJoint, place: _Place) -> tuple[float, float] | None:
    """Sense and zero of a joint: ours is at ``sign * position + zero``.

    Args:
        joint: The joint of this place, as it is or as it has to be.
        place: What it carries.

    Returns:
        None if it moves along or about another line than ours.
    """
    own = _kind(place.ours)
    axis = place.frame[:3, :3].T @ joint.axis
    sign = 1.0 if axis[2] > 0 else -1.0
    if joint.kind != own.kind or np.linalg.norm(axis - sign * Z) > ANGLE_TOLERANCE:
        return None
    there = place.parent @ joint.transform @ place.frame
    at_zero = _at(place.body, place.ours, 0.0)
    if _is_same_pose(joint, there, at_zero):
        return sign, 0.0
    off = np.linalg.inv(at_zero) @ there
    zero = off[2, 3]
    if own.kind == "revolute":
        zero = math.atan2(off[1, 0], off[0, 0])
    expected = _at(place.body, place.ours, zero)
    return (sign, float(zero)) if _is_same_pose(joint, there, expected) else None


def _has_limits(joint: UrdfJoint, ours: JointRange, zero: tuple[float, float]) -> bool:
    """Whether the ends of a joint are ours, in its own sense and from its own zero."""
    if joint.lower is None or joint.upper is None:
        return False
    ends = sorted(zero[0] * end + zero[1] for end in (joint.lower, joint.upper))
    off = np.abs(np.subtract(ends, [ours.lower, ours.upper]))
    within = [_rounding(joint, ours, name) for name in ("lower", "upper")]
    return bool((off <= max(within)).all())


def _rounding(joint: UrdfJoint, ours: JointRange, name: str) -> float:
    """By how much a limit may be off: by half of its last digit, or by hardly any."""
    least = TRAVEL_TOLERANCE if is_of_rod(ours) else LIMIT_TOLERANCE
    text = (joint.limit or {}).get(name, "")
    number = getattr(joint, name)
    return max(least, 0.51 * last_place(text)) if number and number % 1 else least


def _is_same_pose(joint: UrdfJoint, one: FloatArray, other: FloatArray) -> bool:
    """Whether poses (4, 4) differ by no more than the digits of a joint's origin."""
    digits = last_digits([joint])
    off = float(np.linalg.norm(one[:3, 3] - other[:3, 3]))
    is_near = off <= max(LENGTH_TOLERANCE, digits.length)
    turned = angle_between(one, other)
    return is_near and turned <= max(ANGLE_TOLERANCE, digits.angle, 2 * digits.pi)


# --- Fingers follow the rod -----------------------------------------------------------


def _with_mimics(places: Mapping[str, _Place]) -> Iterator[JawJoint]:
    """The joints, with the rule by which the fingers have to follow the rod.

    Args:
        places: Name of our body -> where it is.
    """
    rights = {name: _right(place) for name, place in places.items()}
    zeros = {name: _zero(rights[name], place) for name, place in places.items()}
    rod = rights.get("jaw_rod")
    lead = zeros.get("jaw_rod")
    for name, (joint, _, ours, _, _) in places.items():
        right = rights[name]
        follow = zeros[name]
        if not isinstance(ours, FingerJoint):
            if joint.mimic:
                right = replace(right, mimic=None, multiplier=1.0, offset=0.0)
        elif rod is not None and lead is not None and follow is not None:
            offset = ours.multiplier * lead[1] + ours.offset - follow[1]
            following = replace(
                right,
                mimic=rod.name,
                multiplier=follow[0] * ours.multiplier * lead[0],
                offset=follow[0] * offset,
            )
            if not _follows_alike(joint, following, rod):
                right = following
        yield JawJoint(joint=joint, right=right, ours=ours)


def _mimic(joint: UrdfJoint) -> tuple[str | None, float, float]:
    """What a joint follows, and how."""
    return joint.mimic, joint.multiplier, joint.offset


def _follows_alike(one: UrdfJoint, other: UrdfJoint, leader: UrdfJoint) -> bool:
    """Whether two joints follow the same leader in the same way, over its range."""
    if one.mimic != other.mimic:
        return False
    ends = np.array([leader.lower or 0.0, leader.upper or 0.0])
    off = (one.multiplier - other.multiplier) * ends + one.offset - other.offset
    return bool(np.abs(off).max() <= LIMIT_TOLERANCE)


# --- Findings -------------------------------------------------------------------------


def findings_of_jaws(robot: UrdfRobot, jaw: JawJoint, cost: float) -> Iterator[Finding]:
    """What is wrong with a joint of the jaws.

    Args:
        robot: The other model.
        jaw: The joint.
        cost: Gravity torque that its wrong place causes [N m].
    """
    written, right, ours = jaw.joint, jaw.right, jaw.ours
    where = written.name
    corrections = [jaw.correction]
    if written.kind != right.kind:
        yield finding(
            "jaws.type",
            where,
            cost=cost,
            kind=written.kind,
            ours=right.kind,
            corrections=corrections,
        )
    if written.transform is not right.transform:
        shift = np.linalg.norm(written.transform[:3, 3] - right.transform[:3, 3])
        turned = angle_between(written.transform, right.transform)
        yield finding(
            "jaws.origin",
            where,
            cost=cost,
            off=place_text(float(shift), turned),
            corrections=corrections,
        )
    if written.axis is not right.axis:
        yield finding(
            "jaws.axis",
            where,
            cost=cost,
            theirs=urdf_numbers(written.axis),
            ours=urdf_numbers(right.axis),
            corrections=corrections,
        )
    has_ends = written.lower is not None and written.upper is not None
    ends = [written.lower or 0.0, written.upper or 0.0]
    if has_ends and ends != [right.lower, right.upper]:
        beyond = max((right.lower or 0.0) - ends[0], ends[1] - (right.upper or 0.0))
        yield finding(
            "jaws.limits",
            where,
            theirs=ends,
            ours=[right.lower, right.upper],
            unit=jaw.unit,
            serious=beyond > 0,
            corrections=corrections,
        )
    for name, unit in (("velocity", "/s"), ("effort", "")):
        value = getattr(written, name)
        own = getattr(ours, name)
        if value and value > 0 and velocity_differs(value, own):
            of_effort = "N" if jaw.unit == "m" else "N m"
            limit = {"limit": {name: f"{own:.5g}"}}
            yield finding(
                f"jaws.{name}",
                where,
                theirs=value,
                ours=own,
                unit=of_effort if name == "effort" else jaw.unit + unit,
                corrections=[Correction("joint", where, limit)],
            )
    if _mimic(written) == _mimic(right) or (
        written.mimic is not None and written.mimic not in robot.joints
    ):  # a leader that is not there is a finding of `lint`
        return
    if written.mimic is None:
        leader = right.mimic
        yield finding("jaws.free", where, leader=leader, corrections=corrections)
    elif right.mimic is None:
        leader = written.mimic
        yield finding("jaws.follows", where, leader=leader, corrections=corrections)
    else:
        yield finding(
            "jaws.mimic",
            where,
            cost=cost,
            theirs=_rule(written),
            ours=_rule(right),
            corrections=corrections,
        )


def _rule(joint: UrdfJoint) -> str:
    """What a joint follows, as a formula."""
    return f"{joint.multiplier:.6g} {joint.mimic} {joint.offset:+.6g}"
