"""Link 4 taken apart: wrist, jaw rod and two fingers, together Table 2's link 4.

The document prints link 4 as one body, with its jaws closed. The fingers and the rod
are estimated from supplementary geometry and densities. The wrist is the remainder. So
with closed jaws the assembly has the printed mass, first and second moments, whatever
the estimate.

Frames, by their pose in link_4 (wrist axis along -z, tip at negative z):

- ``link_4``: the wrist, frame unchanged.
- ``jaw_rod``: +z towards the tip; ``axis_a`` slides it along its +z. The jaws are
  closed with axis_a at its lower limit.
- ``finger_1`` on the -x side, ``finger_2`` on the +x side: +z along the hinge. Each
  turns about its +z by ``finger_turn`` times the rod's travel; a positive angle opens
  it, and 0 is closed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal, get_args

import numpy as np

from alpha5_model._support.checks import FloatArray, frozen, real
from alpha5_model._support.spatial import rotation_from_rpy
from alpha5_model.errors import InputError
from alpha5_model.numbers.inertia import combine
from alpha5_model.numbers.parameters import Alpha5Parameters, JointRange, chosen_arm
from alpha5_model.numbers.pose import Pose, tool_of
from alpha5_model.numbers.rigid_body import AttachedBody, RigidBody, joined

#: Jaws that are locked, or that axis_a opens.
Gripper = Literal["locked", "jaws"]
GRIPPERS: tuple[Gripper, ...] = get_args(Gripper)


@dataclass(frozen=True, eq=False)
class FingerJoint(JointRange):
    """A finger's hinge, ``angle = multiplier * leader + offset``.

    Attributes:
        leader: Name of the joint that it follows.
        multiplier: [rad/m].
        offset: [rad].
    """

    leader: str
    multiplier: float
    offset: float


@dataclass(frozen=True, eq=False)
class JawBody(RigidBody):
    """One body of the opened link 4: its wrist, ``jaw_rod`` or a finger.

    The rod moves inside the wrist and displaces nothing.

    Attributes:
        roll: Rotation about x from the body's frame to link_4, jaws closed [rad].
        origin: Origin of the body's frame in link_4, jaws closed, (3,) [m].
    """

    roll: float
    origin: FloatArray

    @property
    def pose(self) -> Pose:
        """Of the body's frame in link_4, jaws closed."""
        rotation = rotation_from_rpy((self.roll, 0.0, 0.0))
        return Pose(position=self.origin, rotation=rotation, parent="link_4")


@dataclass(frozen=True, eq=False)
class Jaws:
    """The four bodies of link 4 and the motion of the fingers.

    Attributes:
        wrist, rod, finger_1, finger_2: The bodies.
        joints: The rod's joint and the two that follow it, in the order of rod and
            fingers.
    """

    wrist: JawBody
    rod: JawBody
    finger_1: JawBody
    finger_2: JawBody
    joints: tuple[JointRange, FingerJoint, FingerJoint]

    @property
    def bodies(self) -> tuple[JawBody, JawBody, JawBody, JawBody]:
        """Wrist, rod and fingers."""
        return self.wrist, self.rod, self.finger_1, self.finger_2

    @property
    def closed(self) -> tuple[RigidBody, ...]:
        """Wrist, rod and fingers in link_4, jaws closed."""
        return tuple(_in_link_4(body) for body in self.bodies)


@lru_cache(maxsize=8)
def split_link_4(parameters: Alpha5Parameters) -> Jaws:
    """Take the rod and the fingers out of link 4.

    A finger is a box of the measured length, width and volume. Its centre is halfway
    along the finger, and halfway between its pivot and the wrist axis. The rod is a
    cylinder. Its centre is at the base of the jaws' collar with axis_a at 0; with
    closed jaws it is beyond that by axis_a's lower limit.

    A spacer between wrist and jaws moves rod and fingers along -z. Bodies that are
    attached to link_4 belong to the wrist.

    Args:
        parameters: The arm's parameters.

    Returns:
        The bodies. Without attached bodies, their sum with closed jaws is
        ``parameters.links[4]`` up to rounding.

    Raises:
        InputError: A link 4 that leaves no possible wrist.
    """
    rod = _rod(parameters)
    # Finger 1 sits at -x and turns about +y of link_4, finger 2 mirrors it: both open
    # with a positive angle, so one multiplier and one range serve both.
    volume_1 = parameters.jaws.finger_volume
    volume_2 = parameters.jaws.second_finger_volume
    finger_1 = _finger("finger_1", side=-1.0, volume=volume_1, parameters=parameters)
    finger_2 = _finger("finger_2", side=1.0, volume=volume_2, parameters=parameters)
    wrist = _remainder(parameters.links[4], [rod, finger_1, finger_2])
    attached = [body for body in parameters.attached if body.link == "link_4"]
    if attached:
        wrist = _loaded(wrist, attached)
    joints = (
        parameters.joints[4],
        _finger_joint("finger_1_joint", parameters),
        _finger_joint("finger_2_joint", parameters),
    )
    return Jaws(
        wrist=wrist,
        rod=_beyond(parameters.spacer, rod),
        finger_1=_beyond(parameters.spacer, finger_1),
        finger_2=_beyond(parameters.spacer, finger_2),
        joints=joints,
    )


def tip_height(parameters: Alpha5Parameters, jaw: float) -> tuple[float, float]:
    """How far the point between the finger tips is along -z of link_4.

    The fingers mirror each other, so the point is on the wrist axis. A tip is one
    finger length beyond its pivot and meets the other one if the jaws are closed; it
    turns about the pivot.

    Args:
        parameters: The arm's parameters.
        jaw: Position of axis_a [m].

    Returns:
        The height [m] and its derivative with respect to axis_a [1].
    """
    jaws = parameters.jaws
    angle = jaws.finger_turn * (jaw - parameters.joints[4].lower)
    cosine, sine = math.cos(angle), math.sin(angle)
    beyond_pivot = jaws.pivot_offset * sine + jaws.finger_length * cosine
    by_angle = jaws.pivot_offset * cosine - jaws.finger_length * sine
    pivot = jaws.collar_base + jaws.pivot_height + parameters.spacer
    return pivot + beyond_pivot, jaws.finger_turn * by_angle


def finger_tips(parameters: Alpha5Parameters) -> dict[str, FloatArray]:
    """The tip of each finger in its frame, (3,) [m]; closed, both are at one point."""
    jaws = parameters.jaws
    tip = np.array([jaws.pivot_offset, jaws.finger_length, 0.0])
    return {"finger_1": tip, "finger_2": -tip}


def tool_at_tip(
    arm: Alpha5Parameters | None = None, *, jaw: float | None = None
) -> Pose:
    """The point midway between the finger tips, as the tool of an arm.

    With ``arm=dataclasses.replace(record, tool=alpha5_model.tool_at_tip(record))``
    inverse kinematics, paths and workspaces are those of this point. Its axes are the
    tcp's. It is the frame ``tip`` of ``forward_kinematics`` at this opening, beyond the
    arm's spacers. The document prints no fingers: their length was measured in the
    manufacturer's public CAD (`alpha5_model.numbers.parameters.JawParameters`).

    Args:
        arm: Record of the arm; None is the catalogue's.
        jaw: Position of axis_a [m]; None for closed jaws.

    Raises:
        InputError: Beyond the limits of axis_a.
    """
    record = chosen_arm(arm)
    joint = record.joints[4]
    opening = joint.lower if jaw is None else real("jaw", jaw)
    if not joint.lower <= opening <= joint.upper:
        expected = f"a position of {joint.name}, {joint.lower:g} to {joint.upper:g} m"
        raise InputError("jaw", opening, expected)
    height, _ = tip_height(record, opening)
    position = np.array([0.0, 0.0, -height])
    return Pose(position=position, rotation=tool_of(record).rotation)


def _rod(parameters: Alpha5Parameters) -> JawBody:
    """The jaw rod, a cylinder along its z."""
    jaws = parameters.jaws
    radius = jaws.rod_diameter / 2
    length = jaws.rod_length
    mass = jaws.rod_density * math.pi * radius**2 * length
    across = mass * (3 * radius**2 + length**2) / 12
    along = mass * radius**2 / 2
    centre = frozen([0.0, 0.0, 0.0])
    height = jaws.collar_base + parameters.joints[4].lower
    return JawBody(
        name="jaw_rod",
        mass=mass,
        com=centre,
        inertia=frozen(np.diag([across, across, along])),
        volume=0.0,
        cob=centre,
        roll=math.pi,
        origin=frozen([0.0, 0.0, -height]),
    )


def _finger(
    name: str, side: float, volume: float, parameters: Alpha5Parameters
) -> JawBody:
    """A finger on the -x side (-1) or the +x side (1) of the wrist axis, a box."""
    jaws = parameters.jaws
    length = jaws.finger_length  # along y
    width = jaws.finger_width  # along z, the hinge
    thickness = volume / (length * width)  # along x
    mass = jaws.finger_density * volume
    squares = np.diag(
        [length**2 + width**2, thickness**2 + width**2, thickness**2 + length**2]
    )
    centre = frozen([-side * jaws.pivot_offset / 2, -side * length / 2, 0.0])
    pivot_height = jaws.collar_base + jaws.pivot_height
    return JawBody(
        name=name,
        mass=mass,
        com=centre,
        inertia=frozen(mass / 12 * squares),
        volume=volume,
        cob=centre,
        roll=side * math.pi / 2,
        origin=frozen([side * jaws.pivot_offset, 0.0, -pivot_height]),
    )


def _finger_joint(name: str, parameters: Alpha5Parameters) -> FingerJoint:
    """The hinge of a finger, which follows the rod."""
    rod = parameters.joints[4]
    turn = parameters.jaws.finger_turn
    return FingerJoint(
        name=name,
        lower=0.0,
        upper=turn * (rod.upper - rod.lower),
        velocity=turn * rod.velocity,
        # A finger only follows the rod, whose force acts on it by this lever.
        effort=rod.effort / turn,
        leader=rod.name,
        multiplier=turn,
        offset=-turn * rod.lower,
    )


def _remainder(link: RigidBody, moving: Sequence[JawBody]) -> JawBody:
    """The wrist: what remains of link 4 without the moving bodies, jaws closed."""
    taken = [_in_link_4(body) for body in moving]
    mass, com, inertia = combine(
        masses=[link.mass, *(-body.mass for body in taken)],
        coms=[link.com, *(body.com for body in taken)],
        inertias=[link.inertia, *(-body.inertia for body in taken)],
    )
    volume = link.volume - sum(body.volume for body in taken)
    if not volume > 0.0:
        raise _no_wrist(link, moving)
    moment = link.volume * link.cob - sum(body.volume * body.cob for body in taken)
    try:
        return JawBody(
            name="link_4",
            mass=mass,
            com=com,
            inertia=(inertia + inertia.T) / 2,
            volume=volume,
            cob=moment / volume,
            roll=0.0,
            origin=frozen([0.0, 0.0, 0.0]),
        )
    except InputError:
        raise _no_wrist(link, moving) from None


def _no_wrist(link: RigidBody, moving: Sequence[JawBody]) -> InputError:
    """That a link 4 is too light, too small or too slender for what is in it."""
    moments = ", ".join(f"{moment:.4g}" for moment in np.diag(link.inertia))
    volume = f"{link.volume:.4g} m^3"
    given = f"{link.mass:.4g} kg, {volume}, moments {moments} kg m^2"
    mass = sum(body.mass for body in moving)
    return InputError(
        "links.link_4",
        given,
        "a body that leaves a possible wrist if rod and fingers, which are estimated "
        f"at {mass:.3g} kg, are taken out of it",
    )


def _loaded(wrist: JawBody, attached: Sequence[AttachedBody]) -> JawBody:
    """The wrist with the bodies that are attached to link_4."""
    whole = joined(wrist.name, [wrist, *(body.in_link() for body in attached)])
    return replace(
        wrist,
        mass=whole.mass,
        com=whole.com,
        inertia=whole.inertia,
        volume=whole.volume,
        cob=whole.cob,
    )


def _beyond(spacer: float, body: JawBody) -> JawBody:
    """A body, moved by a spacer along -z of link_4."""
    if not spacer:
        return body
    return replace(body, origin=frozen(body.origin - [0.0, 0.0, spacer]))


def _in_link_4(body: JawBody) -> RigidBody:
    """A body in the frame of link_4, jaws closed."""
    plain = RigidBody(
        name=body.name,
        mass=body.mass,
        com=body.com,
        inertia=body.inertia,
        volume=body.volume,
        cob=body.cob,
    )
    return plain.at(body.pose)


def loaded_links(parameters: Alpha5Parameters) -> tuple[RigidBody, ...]:
    """``link_0`` to ``link_4`` with what is attached to them, jaws closed.

    A spacer moves the jaws, and so their part of link_4, along -z of link_4.

    Args:
        parameters: The arm's parameters.

    Returns:
        Five bodies in the frames of their links. A link without anything attached is
        ``parameters.links[i]`` itself.
    """
    links: list[RigidBody] = []
    for link in parameters.links:
        attached = [body for body in parameters.attached if body.link == link.name]
        parts: Sequence[RigidBody] = [link]
        if parameters.spacer and link is parameters.links[4]:
            parts = split_link_4(parameters).closed
        elif attached:
            parts = [link, *(body.in_link() for body in attached)]
        links.append(link if parts == [link] else joined(link.name, parts))
    return tuple(links)
