"""What all descriptions of the arm are asked for: which arm, which jaws, where."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from alpha5_model._support.checks import array, choice, flag, plain_name
from alpha5_model._support.spatial import Triple, rotation_from_rpy
from alpha5_model.errors import InputError
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS
from alpha5_model.numbers.fluids import SEA_WATER, density_of
from alpha5_model.numbers.jaws import GRIPPERS, Gripper
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm
from alpha5_model.numbers.pose import Pose

#: xacro would evaluate ``${...}`` and ``$(...)``; the others would need escapes in XML.
_FORBIDDEN = set("${}<>&\"'")


@dataclass(frozen=True)
class ArmOptions:
    """Which arm is described.

    Attributes:
        gripper: ``locked`` (4 joints) or ``jaws`` (adds axis_a and two fingers that
            follow it).
        corrections: Recorded corrections to apply.
        arm: Record of an arm of your own, which has its corrections already; None for
            the catalogue's. Its name is the model's. What is attached to a link is part
            of the link.

    Raises:
        Alpha5Error: An option that cannot be.
    """

    gripper: Gripper = "locked"
    corrections: Iterable[str] = DEFAULT_CORRECTIONS
    arm: Alpha5Parameters | None = None

    def __post_init__(self) -> None:
        choice("gripper", self.gripper, GRIPPERS)
        # An iterator can be read once.
        record = chosen_arm(self.arm, self.corrections)
        object.__setattr__(self, "corrections", record.corrections)

    @property
    def record(self) -> Alpha5Parameters:
        """The arm's record."""
        return chosen_arm(self.arm, self.corrections)


@dataclass(frozen=True)
class MountedOptions(ArmOptions):
    """Which arm is described, and where it is mounted.

    Attributes:
        parent: Name of a new link, body or frame that base_link is mounted on; empty
            for the mount of ``arm``.
        xyz: Position of base_link in the parent [m].
        rpy: Its roll, pitch, yaw [rad].
    """

    parent: str = ""
    xyz: Triple = (0.0, 0.0, 0.0)
    rpy: Triple = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        xyz = array("xyz", self.xyz, 3)
        rpy = plausibility.angles("rpy", self.rpy)
        for name, given in (("xyz", xyz), ("rpy", rpy)):
            if given.any() and self.parent == "":
                raise InputError(name, given.tolist(), "a parent link to mount on")

    @property
    def mount(self) -> Pose | None:
        """The mount that these options name, or the arm's own; None without one."""
        if self.parent == "":
            return self.record.mount
        rotation = rotation_from_rpy(array("rpy", self.rpy, 3))
        return Pose(array("xyz", self.xyz, 3), rotation, self.parent)

    def check_parent(self, taken: Iterable[str]) -> None:
        """Check that the parent of the mount is no part of the arm.

        Args:
            taken: Names of the parts of the arm.

        Raises:
            InputError: It is.
        """
        mount = self.mount
        if mount is not None and mount.parent in taken:
            name = "parent" if self.parent else "mount.parent"
            raise InputError(name, mount.parent, "a name that no link of the arm has")


@dataclass(frozen=True)
class SimulationOptions(MountedOptions):
    """Which arm is simulated, and in what.

    Attributes:
        fluid_density: [kg/m^3]; 0 is air. Given as for `alpha5_model.load`.
        hydrodynamics: Adds what moving water does, which is estimated, not published:
            the catalogue's, in the frames of the links.
    """

    fluid_density: float = SEA_WATER
    hydrodynamics: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        flag("hydrodynamics", self.hydrodynamics)
        density = density_of(self.fluid_density)
        object.__setattr__(self, "fluid_density", density)
        if self.parent != "":
            plain_name("parent", self.parent)


def check_text(name: str, text: Any) -> None:
    """Check that xacro and XML keep a text unchanged.

    Some unprintable characters do not exist in UTF-8 or XML.

    Args:
        name: Of the option, for the message.
        text: What was given.

    Raises:
        InputError: They do not.
    """
    printable = isinstance(text, str) and text.isprintable()
    if not printable or set(text) & _FORBIDDEN:
        allowed = "a text without any of $ { } < > & quotes or unprintable characters"
        raise InputError(name, text, allowed)


def check_name(name: str, text: Any) -> None:
    """Check a name, or a prefix of names, as `check_text` does; it has no spaces.

    Raises:
        InputError: It has, or xacro and XML do not keep it.
    """
    check_text(name, text)
    if " " in text:
        raise InputError(name, text, "a name without spaces")
