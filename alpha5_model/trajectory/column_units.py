"""Units in the names of columns: ``axis_e_pos [deg]``, ``axis_e_deg``."""

from __future__ import annotations

import math
import re

from alpha5_model.numbers.tables import JOINT_NAMES

_DEGREE = math.pi / 180.0
_MILLI = 1e-3
#: Units of a motor's current, each in A.
CURRENTS = {
    **dict.fromkeys(("a", "amp", "amps", "ampere", "amperes"), 1.0),
    **dict.fromkeys(("ma", "milliamp", "milliamps", "milliamperes"), _MILLI),
}
#: Quantity -> its units for an arm joint, each in rad, rad/s, N m or A.
_ANGLES = {
    "position": {
        **dict.fromkeys(("deg", "degs", "degree", "degrees", "°"), _DEGREE),
        **dict.fromkeys(("rad", "radian", "radians"), 1.0),
    },
    "velocity": {"deg/s": _DEGREE, "°/s": _DEGREE, "rad/s": 1.0},
    "effort": {"nm": 1.0, "n m": 1.0, "n*m": 1.0, "n·m": 1.0},
    "current": CURRENTS,
}
#: The same for the jaw rod, each in m, m/s, N or A.
_LENGTHS = {
    "position": {"mm": _MILLI, "m": 1.0},
    "velocity": {"mm/s": _MILLI, "m/s": 1.0},
    "effort": {"n": 1.0},
    "current": CURRENTS,
}
#: Units that may stand behind an underscore, without brackets.
_ENDINGS = {"deg", "degs", "degree", "degrees", "rad", "mm", "nm", *CURRENTS}
#: Units with a fraction that may, as in ``axis_e_vel_rad_s``.
_PER_SECOND = re.compile(r"(.*)_(rad|deg|mm|m)(?:_|/|_per_)s(?:ec)?", re.IGNORECASE)


def split_unit(name: str) -> tuple[str, str]:
    """A name, or its end, without a unit, and the unit in small letters.

    The unit is ``""`` if there is none.
    """
    text = name.rstrip()
    if text.endswith(("]", ")")):
        start = max(text.rfind("["), text.rfind("("))
        if start >= 0:
            return text[:start].rstrip(" _"), text[start + 1 : -1].strip().lower()

    per_second = _PER_SECOND.fullmatch(text)
    if per_second:
        return per_second[1], f"{per_second[2].lower()}/s"

    stem, sign, ending = text.rpartition("_")
    if sign and ending.lower() in _ENDINGS:
        return stem, ending.lower()
    return name, ""


def scale(joint: str, quantity: str, unit: str) -> float | None:
    """What a unit is in SI units; None if the quantity cannot have it.

    Args:
        joint: ``"axis_e"`` and so on.
        quantity: ``"position"``, ``"velocity"``, ``"effort"`` or ``"current"``, or
            another meaning.
        unit: From `split_unit`.
    """
    units = _LENGTHS if joint == JOINT_NAMES[4] else _ANGLES
    return units.get(quantity, {}).get(unit)
