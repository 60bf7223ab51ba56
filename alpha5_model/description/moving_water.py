"""Drag and added mass of the links of an arm, for its descriptions."""

from __future__ import annotations

from alpha5_model.errors import InputError
from alpha5_model.numbers.arm_checks import LENGTHS
from alpha5_model.numbers.hydrodynamics import BodyHydrodynamics, hydrodynamics
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters

#: Largest change of a length with which the strips of the links still hold [m]. Sets of
#: numbers that round to the printed ones differ by 2 mm.
_SAME_LINK = 3e-3


def arm_water(arm: Alpha5Parameters, gripper: str) -> dict[str, BodyHydrodynamics]:
    """Added mass and drag strips of each link, in its frame.

    They are estimated for the catalogue's links and know of no attached body.

    Args:
        arm: The arm's parameters.
        gripper: ``locked`` or ``jaws``.

    Returns:
        Name of the link -> its added mass and drag, nominal.

    Raises:
        InputError: A length more than 3 mm from Table 1's, or a spacer of more than
            that: links of other sizes have other strips.
    """
    catalogue = parameters()
    for name, (i, field) in LENGTHS.items():
        if name == "d_3":
            # It moves the tcp only.
            continue
        change = getattr(arm.dh[i], field) - getattr(catalogue.dh[i], field)
        _check_change(name, change)
    _check_change("the spacer", arm.spacer)
    return hydrodynamics(gripper)


def _check_change(name: str, change: float) -> None:
    if abs(change) > _SAME_LINK:
        expected = "the lengths of Table 1 within 3 mm, for which it was estimated"
        given = f"an arm whose {name} differs by {change * 1e3:.3g} mm"
        raise InputError("hydrodynamics", given, expected)
