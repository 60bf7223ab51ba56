"""The vehicles of a study, which tilt with the arm."""

from __future__ import annotations

from typing import Any

from alpha5_model.errors import InputError
from alpha5_model.water.carrier import Carrier, read_carrier


def read_vehicles(given: Any) -> dict[str, Carrier]:
    """The tables ``[vehicles.NAME]`` of a study, by name, in SI units.

    Raises:
        InputError: A missing key, or an invalid value, with its place.
        UnknownNameError: Another key.
    """
    if not isinstance(given, dict):
        raise InputError("vehicles", given, "tables [vehicles.NAME]")
    return {
        name: read_carrier(f"vehicles.{name}", table) for name, table in given.items()
    }
