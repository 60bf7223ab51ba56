"""Link 4 taken apart: wrist, jaw rod and two fingers that together are Table 2's link 4.

The document prints link 4 with its jaws closed as one body. The fingers and the rod are estimated
(their geometry and densities are supplementary values); the wrist is what remains, so that with
closed jaws mass, first and second moments of the assembly are the printed ones whatever the
estimate.

Frames, by their pose in link_4 (wrist axis along -z, tip at negative z):

- ``link_4``: the wrist, frame unchanged.
- ``jaw_rod``: +z towards the tip; ``axis_a`` slides it along its +z.
- ``finger_1`` on the -x side, ``finger_2`` on the +x side: +z along the hinge; each turns about its
  +z by ``finger_turn`` times the rod's travel, and a positive angle opens it. Closed is 0.
"""

from __future__ import annotations

import math
import operator
from dataclasses import dataclass

import numpy as np

from alpha5_model._support.checks import FloatArray, frozen
from alpha5_model._support.spatial import moved, pose
from alpha5_model.numbers.inertia import combine, rotate_tensor
from alpha5_model.numbers.parameters import Alpha5Parameters, JointRange, RigidBody

GRIPPERS = ("locked", "jaws")


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
    """One body of the opened link 4: ``link_4``, ``jaw_rod``, ``finger_1`` or ``finger_2``.

    The rod moves inside the wrist and displaces nothing.

    Attributes:
        roll: Rotation about x from the body's frame to link_4, jaws closed [rad].
        origin: Origin of the body's frame in link_4, jaws closed, (3,) [m].
    """

    roll: float
    origin: FloatArray


@dataclass(frozen=True, eq=False)
class Jaws:
    """The four bodies of link 4 and the motion of the fingers.

    Attributes:
        wrist, rod, finger_1, finger_2: The bodies.
        joints: The rod's joint and the two that follow it, in the order of rod and fingers.
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


def split_link_4(parameters: Alpha5Parameters) -> Jaws:
    """Take the rod and the fingers out of link 4.

    A finger is a box of the measured length, width and volume, its centre halfway along and halfway
    between its pivot and the wrist axis; the rod is a cylinder centred at the jaw collar's base.

    Args:
        parameters: The arm's parameters.

    Returns:
        The bodies. Their sum with closed jaws is ``parameters.links[4]`` up to rounding.
    """
    link, jaws, slide = parameters.links[4], parameters.jaws, parameters.joints[4]
    radius, zero = jaws.rod_diameter / 2, frozen([0.0, 0.0, 0.0])
    mass = jaws.rod_density * math.pi * radius**2 * jaws.rod_length
    across = mass * (3 * radius**2 + jaws.rod_length**2) / 12
    inertia = frozen(np.diag([across, across, mass * radius**2 / 2]))
    origin = frozen([0.0, 0.0, -(jaws.collar_base + slide.lower)])
    rod = JawBody("jaw_rod", mass, zero, inertia, 0.0, zero, math.pi, origin)
    turn, fingers, hinges = jaws.finger_turn, [], []
    upper, velocity = turn * (slide.upper - slide.lower), turn * slide.velocity
    # What a finger, which only follows, can exert is the rod's effort over its lever.
    effort, offset = slide.effort / turn, -turn * slide.lower
    # Finger 1 sits at -x and turns about +y of link_4, finger 2 mirrors it: both open with a
    # positive angle, so one multiplier and one range serve both.
    for side, volume in ((-1.0, jaws.finger_volume), (1.0, jaws.second_finger_volume)):
        name = "finger_1" if side < 0 else "finger_2"
        y, z = jaws.finger_length, jaws.finger_width
        x = volume / (y * z)
        mass = jaws.finger_density * volume
        inertia = frozen(mass / 12 * np.diag([y**2 + z**2, x**2 + z**2, x**2 + y**2]))
        centre = frozen([-side * jaws.pivot_offset / 2, -side * y / 2, 0.0])
        origin = frozen(
            [side * jaws.pivot_offset, 0.0, -(jaws.collar_base + jaws.pivot_height)]
        )
        roll = side * math.pi / 2
        fingers.append(
            JawBody(name, mass, centre, inertia, volume, centre, roll, origin)
        )
        joint = FingerJoint(
            f"{name}_joint", 0.0, upper, velocity, effort, slide.name, turn, offset
        )
        hinges.append(joint)
    moving = [rod, *fingers]
    placed = [pose(body.origin, (body.roll, 0.0, 0.0)) for body in moving]
    coms = map(moved, placed, [body.com for body in moving])
    cobs = map(moved, placed, [body.cob for body in moving])
    tensors = [
        rotate_tensor(at[:3, :3], b.inertia)
        for at, b in zip(placed, moving, strict=True)
    ]
    masses = [link.mass, *(-body.mass for body in moving)]
    inertias = [link.inertia, *(-tensor for tensor in tensors)]
    mass, com, inertia = combine(masses, [link.com, *coms], inertias)
    volumes = [body.volume for body in moving]
    volume = link.volume - sum(volumes)
    cob = frozen(
        (link.volume * link.cob - sum(map(operator.mul, volumes, cobs))) / volume
    )
    inertia = frozen((inertia + inertia.T) / 2)
    wrist = JawBody("link_4", mass, frozen(com), inertia, volume, cob, 0.0, zero)
    return Jaws(wrist, rod, fingers[0], fingers[1], (slide, hinges[0], hinges[1]))
