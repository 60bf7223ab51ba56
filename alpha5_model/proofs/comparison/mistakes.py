"""Name the single mistake that turns a right number of a body into the written one.

The interface for the rest of `comparison`; see `wrong_numbers`, `in_metres` and
`in_radians`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Literal, NamedTuple

from alpha5_model._support.checks import FloatArray
from alpha5_model.description.urdf_robot import UrdfRobot
from alpha5_model.numbers.parameters import Alpha5Parameters

Quantity = Literal["mass", "com", "inertia"]


class Body(NamedTuple):
    """Mass, COM and tensor of a body, all in one frame.

    Attributes:
        mass: [kg].
        com: (3,) [m].
        inertia: At the COM, in the frame's axes, URDF sign, (3, 3) [kg m^2].
    """

    mass: float
    com: FloatArray
    inertia: FloatArray


class Part(NamedTuple):
    """One link of the other model, of those that make up one of our bodies.

    Attributes:
        link: Its name.
        body: What its ``<inertial>`` says, in its own frame.
        pose: transform_link_to_ours: its pose in our link frame, (4, 4).
    """

    link: str
    body: Body
    pose: FloatArray


class Digits(NamedTuple):
    """Half a unit of the last digit that a file writes, the same for every link.

    Attributes:
        mass: [kg].
        com: [m].
        inertia: [kg m^2].
    """

    mass: float
    com: float
    inertia: float


class Mistake(NamedTuple):
    """A mistake that people make.

    Attributes:
        id: Its name in scripts, such as ``i_link``; the same in every version.
        words: It in words, to follow "COM 20 mm off: ".
    """

    id: str
    words: str


class WrongNumber(NamedTuple):
    """A number of a link that has to be changed.

    Attributes:
        link: The link of the other model.
        quantity: ``mass``, ``com`` or ``inertia``.
        mistake: What gives the written number; None if nothing in the table does.
        right: What the link should say, in its own frame: our body less the other
            links that make it up.
    """

    link: str
    quantity: Quantity
    mistake: Mistake | None
    right: Body


def digits_of(robot: UrdfRobot) -> Digits:
    """The digits that a file writes in its inertials."""
    raise NotImplementedError


def wrong_numbers(
    record: Alpha5Parameters, index: int, parts: Sequence[Part], digits: Digits
) -> list[WrongNumber]:
    """What the links of a body say wrong, each with the mistake that explains it.

    If several links make up the body, only one is taken to be wrong: the one whose
    change mends the body with the fewest numbers.

    Args:
        record: Our arm.
        index: Which of its bodies: 0 for link_0 to 4 for link_4.
        parts: The links that make it up, with a mass, without those that the user is
            told to empty (dummies, vehicles).
        digits: Of the file.

    Returns:
        Empty if the body agrees to the digits of the file.
    """
    raise NotImplementedError


def in_metres(
    robot: UrdfRobot, joints: Iterable[str] | None = None
) -> tuple[UrdfRobot, tuple[str, ...]]:
    """The robot with joint origins in m, and the joints that were in mm.

    Args:
        robot: As written.
        joints: Names of the joints to look at; all if None.
    """
    raise NotImplementedError


def in_radians(
    robot: UrdfRobot, joints: Iterable[str] | None = None
) -> tuple[UrdfRobot, tuple[str, ...]]:
    """The robot with rpy of joint origins in rad, and the joints that were in degrees.

    Args:
        robot: As written.
        joints: Names of the joints to look at; all if None.
    """
    raise NotImplementedError
