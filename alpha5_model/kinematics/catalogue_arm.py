"""The catalogue's arm, of which functions without an arm argument speak."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

from alpha5_model.numbers.parameters import parameters

if TYPE_CHECKING:
    from alpha5_model.kinematics.arm_kinematics import ArmKinematics


@cache
def catalogue() -> ArmKinematics:
    """The kinematics of the catalogue's arm."""
    # Late: one target is solved without all that this imports.
    from alpha5_model.kinematics.arm_kinematics import ArmKinematics

    return ArmKinematics(parameters())
