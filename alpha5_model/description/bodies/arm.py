"""The seven bodies of the arm, each with the volume that Table 3 prints."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

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
    place: Callable[[Solid], Solid] = lambda solid: solid,
    outside: Solid | None = None,
) -> Body:
    """Cut a blank until its volume [m^3] is the wanted one, and place it in its link."""
    solid, value = solve_volume(lambda x: cut(blank, x), volume * _MM3_PER_M3, *limits)
    return Body(
        name, place(solid), place(blank if outside is None else outside), free_dimension, value
    )


def _base() -> Body:
    volume = parameters(()).links[0].volume
    return _solved(
        "link_0", "depth of the connector recess", base.bored, base.base_blank(), volume, (10, 90)
    )


def _shells() -> tuple[Body, Body]:
    arm, blank, what = parameters(()), shell.shell_blank(), "bore radius of the half-shell"
    limits = (5.0, 18.0)
    return (
        _solved(
            *("link_1", what, shell.bored, blank, arm.links[1].volume, limits),
            place=lambda solid: shell.in_link_1(solid, arm.dh[0].d * _MM_PER_M),
        ),
        _solved(
            *("link_3", what, shell.bored, blank, arm.links[3].volume, limits),
            place=shell.in_link_3,
        ),
    )


def _upper_arm() -> Body:
    arm, blank = parameters(()), upper_arm.upper_arm_blank()
    return _solved(
        *("link_2", "radius of the shaft holes", upper_arm.bored, blank),
        *(arm.links[2].volume, (0.5, 14.0)),
        place=lambda solid: upper_arm.in_link_2(solid, arm.theta_c),
    )


def _wrist() -> Body:
    arm = parameters(())
    jaws = arm.jaws
    lengths = [x * _MM_PER_M for x in (jaws.collar_base, jaws.pivot_height, jaws.pivot_offset)]
    outside = wrist.wrist_blank(lengths[0])
    return _solved(
        *("link_4", "depth of the bearing seat", wrist.bored, wrist.slotted(outside, *lengths)),
        *(arm.links[4].volume - 2 * jaws.finger_volume, (0.5, 60.0)),
        outside=outside,
    )


def _fingers() -> tuple[Body, Body]:
    jaws = parameters(()).jaws
    lengths = [x * _MM_PER_M for x in (jaws.finger_width, jaws.pivot_offset, jaws.finger_length)]
    one = _solved(
        *("finger_1", "radius of the perforation", finger.perforated),
        *(finger.finger_blank(*lengths), jaws.finger_volume, (0.5, 3.6)),
    )
    other = Body(
        "finger_2",
        finger.as_finger_2(one.solid),
        finger.as_finger_2(one.outside),
        one.free_dimension,
        one.value,
    )
    return one, other
