"""Axes, quantities and forms that a study may have, from ``study.toml``."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

_SCHEMA: dict[str, Any] = tomllib.loads(
    Path(__file__).with_name("study.toml").read_text("utf-8")
)
#: SI unit of an axis -> the units that it may be given in, each with its size.
UNITS: dict[str, dict[str, float]] = _SCHEMA["units"]
#: Axis of a state -> its SI unit.
STATE_AXES: dict[str, str] = _SCHEMA["state"]
#: Axis of the arm and its surroundings -> its SI unit, ``""`` if it has no number.
CASE_AXES: dict[str, str] = _SCHEMA["case"]
#: Quantity -> its unit, then its columns.
QUANTITIES: dict[str, list[str]] = _SCHEMA["quantities"]
#: Form of an output -> the keys that only this form has.
FORMS: dict[str, list[str]] = _SCHEMA["forms"]
