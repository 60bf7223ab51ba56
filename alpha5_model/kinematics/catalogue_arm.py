"""The catalogue's arm, which functions without an arm argument use."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

from alpha5_model.numbers.parameters import parameters

if TYPE_CHECKING:
    from alpha5_model.kinematics.arm_kinematics import ArmKinematics


@cache
def catalogue() -> ArmKinematics:
    """The kinematics of the catalogue's arm."""
    # Imported late: solving a single target needs none of it.
    from alpha5_model.kinematics.arm_kinematics import ArmKinematics

    return ArmKinematics(parameters())
