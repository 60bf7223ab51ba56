"""The seven bodies of the arm, each with the volume that Table 3 prints."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

from alpha5_model.checks import FloatArray
from alpha5_model.description.bodies import base, finger, shell, upper_arm, wrist
from alpha5_model.description.bodies.solid import Solid
from alpha5_model.description.bodies.solve import solve_volume
from alpha5_model.parameters import parameters

#: Bodies in the order base to tip.
BODIES = ("link_0", "link_1", "link_2", "link_3", "link_4", "finger_1", "finger_2")
_MM_PER_M, _MM3_PER_M3 = 1e3, 1e9


@dataclass(frozen=True, eq=False)
class Body:
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
def bodies() -> dict[str, Body]:
    """Draw all bodies, base to tip.

    Raises:
        MissingDependencyError: manifold3d is not installed.
    """
    drawn = (_base(), *_shells(), _upper_arm(), _wrist(), *_fingers())
    by_name = {body.name: body for body in drawn}
    return {name: by_name[name] for name in BODIES}


def _solved(
    name: str,
    free_dimension: str,
    cut: Callable[[Solid, float], Solid],
    blank: Solid,
    volume: float,
    limits: tuple[float, float],
    in_link: Callable[[Solid], Solid] = lambda solid: solid,
) -> Body:
    """Cut a blank until its volume [m^3] is the wanted one, and place both in the link."""
    solid, value = solve_volume(lambda x: cut(blank, x), volume * _MM3_PER_M3, *limits)
    return Body(name, in_link(solid), in_link(blank), free_dimension, value)


def _base() -> Body:
    volume, what = parameters(()).links[0].volume, "depth of the connector recess"
    return _solved("link_0", what, base.bored, base.base_blank(), volume, (10.0, 90.0))


def _shells() -> tuple[Body, Body]:
    arm, blank, what = parameters(()), shell.shell_blank(), "bore radius of the half-shell"

    def one(i: int, frame: FloatArray) -> Body:
        def in_link(solid: Solid) -> Solid:
            return solid.transform(frame)

        volume = arm.links[i].volume
        return _solved(f"link_{i}", what, shell.bored, blank, volume, (5.0, 18.0), in_link)

    return (
        one(1, shell.frame_in_link_1(arm.dh[0].d * _MM_PER_M)),
        one(3, shell.frame_in_link_3()),
    )


def _upper_arm() -> Body:
    arm, what = parameters(()), "radius of the shaft holes"
    blank, volume = upper_arm.upper_arm_blank(), arm.links[2].volume

    def in_link(solid: Solid) -> Solid:
        return upper_arm.in_link_2(solid, arm.theta_c)

    return _solved("link_2", what, upper_arm.bored, blank, volume, (0.5, 14.0), in_link)


def _wrist() -> Body:
    arm, what = parameters(()), "depth of the bearing seat"
    jaws = arm.jaws
    base_height, *pivot = (
        length * _MM_PER_M for length in (jaws.collar_base, jaws.pivot_height, jaws.pivot_offset)
    )
    outside = wrist.wrist_blank(base_height)
    blank = wrist.slotted(outside, base_height, *pivot)
    # Table 3's link 4 has the jaws in it.
    volume = arm.links[4].volume - 2 * jaws.finger_volume
    body = _solved("link_4", what, wrist.bored, blank, volume, (0.5, 60.0))
    return replace(body, outside=outside)


def _fingers() -> tuple[Body, Body]:
    jaws, what = parameters(()).jaws, "radius of the perforation"
    lengths = (jaws.finger_width, jaws.pivot_offset, jaws.finger_length)
    blank = finger.finger_blank(*(length * _MM_PER_M for length in lengths))
    one = _solved("finger_1", what, finger.perforated, blank, jaws.finger_volume, (0.5, 3.6))
    solid, outside = finger.as_finger_2(one.solid), finger.as_finger_2(one.outside)
    return one, replace(one, name="finger_2", solid=solid, outside=outside)
