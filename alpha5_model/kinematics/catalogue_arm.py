"""The arm that a function is asked about: the catalogue's, or one of the user's."""

from __future__ import annotations

from functools import cache, lru_cache
from typing import TYPE_CHECKING

from alpha5_model._support.checks import instance
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters

if TYPE_CHECKING:
    from alpha5_model.kinematics.arm_kinematics import ArmKinematics


@cache
def catalogue() -> ArmKinematics:
    """The kinematics of the catalogue's arm."""
    return _kinematics(parameters())


def kinematics_of(arm: Alpha5Parameters | None) -> ArmKinematics:
    """The kinematics of an arm; None is the catalogue's.

    Raises:
        InputError: Not the record of an arm.
        PublishedDataError: Not a vertical plane with two links in it.
    """
    if arm is None:
        return catalogue()
    return _kinematics(instance("arm", arm, Alpha5Parameters))


@lru_cache(maxsize=64)
def _kinematics(arm: Alpha5Parameters) -> ArmKinematics:
    # Imported late: solving a single target needs none of it.
    from alpha5_model.kinematics.arm_kinematics import ArmKinematics

    return ArmKinematics(arm)
