"""The seven bodies of the arm, each with the volume that Table 3 prints."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

from alpha5_model.errors import InputError
from alpha5_model.jaws import split_link_4
from alpha5_model.meshing import parts
from alpha5_model.meshing.solid import Solid
from alpha5_model.parameters import parameters

#: Body, base to tip -> its part, the free dimension that is solved for, and its range [mm].
_DRAWN: dict[str, tuple[Callable[[], parts.Part], str, float, float]] = {
    "link_0": (parts.base, "depth of the bore under link 1", 1.0, 30.0),
    "link_1": (parts.shell, "bore radius of the half-shell", 5.0, 18.0),
    "link_2": (parts.upper_arm, "radius of the shaft holes", 0.5, 14.0),
    "link_3": (parts.shell, "bore radius of the half-shell", 5.0, 18.0),
    "link_4": (parts.wrist, "depth of the bearing seat", 0.5, 60.0),
    "finger_1": (parts.finger, "radius of the largest holes", 2.0, 10.5),
    "finger_2": (parts.finger, "radius of the largest holes", 2.0, 10.5),
}


@dataclass(frozen=True, eq=False)
class DrawnBody:
    """A drawn body, in its link's frame [mm].

    Attributes:
        name: ``link_0`` to ``link_4``, ``finger_1`` or ``finger_2``.
        solid: The solid, with the printed volume.
        outside: The same before its recesses, slots and shaft holes are cut.
        free_dimension: What was solved for.
        value: Its value [mm].
    """

    name: str
    solid: Solid
    outside: Solid
    free_dimension: str
    value: float


@cache
def bodies() -> dict[str, DrawnBody]:
    """Draw all bodies, base to tip.

    Raises:
        MissingDependencyError: manifold3d is not installed.
    """
    arm, frames = parameters(()), parts.frames_in_links()
    jaws = split_link_4(arm)  # Table 3's link 4 has the fingers in it
    volumes = {link.name: link.volume for link in (*arm.links[:4], *jaws.bodies)}
    drawn = {}
    for name, (part, free_dimension, low, high) in _DRAWN.items():
        solid, outside, value = _solved(part, volumes[name] * 1e9, low, high)
        if name in frames:
            solid, outside = (one.transform(frames[name]) for one in (solid, outside))
        drawn[name] = DrawnBody(name, solid, outside, free_dimension, value)
    return drawn


@cache
def _solved(
    part: Callable[[], parts.Part], volume: float, low: float, high: float
) -> tuple[Solid, Solid, float]:
    """The part with a volume [mm^3], its outside, and its free dimension [mm]; drawn once for links of one part."""
    outside, cut = part()
    solid, value = solve_volume(cut, volume, low, high)
    return solid, outside, value


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
