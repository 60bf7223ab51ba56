"""The seven bodies of the arm, each with the volume that Table 3 prints."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

from alpha5_model.checks import FloatArray
from alpha5_model.errors import InputError
from alpha5_model.meshing import parts
from alpha5_model.meshing.solid import Solid
from alpha5_model.parameters import parameters

#: Bodies in the order base to tip.
BODIES = ("link_0", "link_1", "link_2", "link_3", "link_4", "finger_1", "finger_2")
_MM_PER_M, _MM3_PER_M3 = 1e3, 1e9


@dataclass(frozen=True, eq=False)
class DrawnBody:
    """A drawn body, in its link's frame [mm].

    Attributes:
        name: One of `BODIES`.
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
    drawn = (_base(), *_shells(), _upper_arm(), _wrist(), *_fingers())
    by_name = {body.name: body for body in drawn}
    return {name: by_name[name] for name in BODIES}


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


def _solved(
    name: str,
    free_dimension: str,
    cut: Callable[[Solid, float], Solid],
    blank: Solid,
    volume: float,
    limits: tuple[float, float],
    in_link: Callable[[Solid], Solid] = lambda solid: solid,
) -> DrawnBody:
    """Cut a blank until its volume [m^3] is the wanted one, and place both in the link."""
    solid, value = solve_volume(lambda x: cut(blank, x), volume * _MM3_PER_M3, *limits)
    return DrawnBody(name, in_link(solid), in_link(blank), free_dimension, value)


def _base() -> DrawnBody:
    volume, what = parameters(()).links[0].volume, "depth of the connector recess"
    return _solved("link_0", what, parts.base_bored, parts.base_blank(), volume, (10.0, 90.0))


def _shells() -> tuple[DrawnBody, DrawnBody]:
    arm, blank, what = parameters(()), parts.shell_blank(), "bore radius of the half-shell"

    def one(i: int, frame: FloatArray) -> DrawnBody:
        def in_link(solid: Solid) -> Solid:
            return solid.transform(frame)

        volume = arm.links[i].volume
        return _solved(f"link_{i}", what, parts.shell_bored, blank, volume, (5.0, 18.0), in_link)

    return (
        one(1, parts.frame_in_link_1(arm.dh[0].d * _MM_PER_M)),
        one(3, parts.frame_in_link_3()),
    )


def _upper_arm() -> DrawnBody:
    arm, what = parameters(()), "radius of the shaft holes"
    blank, volume = parts.upper_arm_blank(), arm.links[2].volume

    def in_link(solid: Solid) -> Solid:
        return parts.in_link_2(solid, arm.theta_c)

    return _solved("link_2", what, parts.upper_arm_bored, blank, volume, (0.5, 14.0), in_link)


def _wrist() -> DrawnBody:
    arm, what = parameters(()), "depth of the bearing seat"
    jaws = arm.jaws
    base_height, *pivot = (
        length * _MM_PER_M for length in (jaws.collar_base, jaws.pivot_height, jaws.pivot_offset)
    )
    outside = parts.wrist_blank(base_height)
    blank = parts.slotted(outside, base_height, *pivot)
    # Table 3's link 4 has the jaws in it.
    volume = arm.links[4].volume - 2 * jaws.finger_volume
    body = _solved("link_4", what, parts.wrist_bored, blank, volume, (0.5, 60.0))
    return replace(body, outside=outside)


def _fingers() -> tuple[DrawnBody, DrawnBody]:
    jaws, what = parameters(()).jaws, "radius of the perforation"
    lengths = (jaws.finger_width, jaws.pivot_offset, jaws.finger_length)
    blank = parts.finger_blank(*(length * _MM_PER_M for length in lengths))
    one = _solved("finger_1", what, parts.perforated, blank, jaws.finger_volume, (0.5, 3.6))
    solid, outside = parts.as_finger_2(one.solid), parts.as_finger_2(one.outside)
    return one, replace(one, name="finger_2", solid=solid, outside=outside)
