"""Find the one free dimension of a part from its volume."""

from __future__ import annotations

from collections.abc import Callable

from alpha5_model.description.bodies.solid import Solid
from alpha5_model.errors import InputError


def solve_volume(
    build: Callable[[float], Solid], volume: float, low: float, high: float
) -> tuple[Solid, float]:
    """The part of a family whose volume is the wanted one.

    Args:
        build: From the free dimension [mm] to the solid; its volume changes monotonically.
        volume: Wanted [mm^3].
        low, high: Range of the free dimension [mm].

    Returns:
        The solid, and the dimension found, to 1e-7 mm.

    Raises:
        InputError: No dimension in the range gives this volume.
    """
    from scipy.optimize import brentq

    def excess(dimension: float) -> float:
        return float(build(dimension).volume()) - volume

    ends = excess(low), excess(high)
    if ends[0] * ends[1] > 0:
        reach = " to ".join(f"{(volume + e) * 1e-6:.4f}" for e in sorted(ends))
        raise InputError("volume", volume * 1e-6, f"a volume of {reach} L")
    found = float(brentq(excess, low, high, xtol=1e-7, rtol=1e-12))
    return build(found), found
