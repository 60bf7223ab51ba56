"""Names that URDF, ROS and the simulators all take."""

from __future__ import annotations

import re
from typing import Any

from alpha5_model.errors import InputError

_PLAIN = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,63}")


def plain_name(name: str, value: Any) -> str:
    """Check a name of letters, digits and underscores.

    Args:
        name: Of the argument, for the message.
        value: What was given.

    Raises:
        InputError: Anything else, or more than 64 characters.
    """
    if not isinstance(value, str) or not _PLAIN.fullmatch(value):
        expected = "a name of at most 64 letters, digits and _, a letter first"
        raise InputError(name, value, expected)
    return value
