"""The record that a caller means: the catalogue's arm, or one of the user's."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from os import PathLike

from alpha5_model._support.checks import instance
from alpha5_model.errors import InputError
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS, check_corrections
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters


def chosen_arm(
    arm: Alpha5Parameters | None, corrections: Iterable[str] = DEFAULT_CORRECTIONS
) -> Alpha5Parameters:
    """The record of an arm, which already has its corrections.

    Args:
        arm: A record; None for the catalogue's with these corrections.
        corrections: With a record, the default ones, which then mean nothing, or the
            record's own.

    Raises:
        InputError: Not a record, or a record together with other corrections.
        UnknownNameError: A correction that is not recorded.
    """
    chosen = DEFAULT_CORRECTIONS
    if corrections is not DEFAULT_CORRECTIONS:
        chosen = check_corrections(corrections)
    if arm is None:
        return _of_catalogue(chosen)
    if isinstance(arm, str | PathLike):
        expected = "a Alpha5Parameters, as alpha5_model.arm_file(FILE) returns"
        raise InputError("arm", arm, expected)
    record = instance("arm", arm, Alpha5Parameters)
    if chosen not in (DEFAULT_CORRECTIONS, record.corrections):
        own = ", ".join(record.corrections) or "none"
        expected = f"no corrections beside an arm, which has its own ({own})"
        raise InputError("corrections", chosen, expected)
    return record


#: `parameters` without its checks, which take longer than an inverse kinematics.
_of_catalogue = cache(parameters)


def is_catalogue(arm: Alpha5Parameters) -> bool:
    """Whether a record is the catalogue's, with any corrections."""
    return arm is parameters(arm.corrections)
