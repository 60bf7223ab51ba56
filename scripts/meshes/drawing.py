"""The seven bodies of the arm, each with the volume that Table 3 prints [mm]."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from meshes.dimensions import Dimensions, drawn_dimensions
from meshes.finger_part import finger
from meshes.solid import Solid
from meshes.wrist_part import wrist

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import pose, transform
from alpha5_model.errors import InputError
from alpha5_model.numbers.jaws import split_link_4
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters
from meshes import parts


class _Drawn(NamedTuple):
    """How a body is drawn.

    Attributes:
        part: Its part.
        low, high: Range of the free dimension, which is solved for.
    """

    part: Callable[[Dimensions], parts.Part]
    low: float
    high: float


#: Body, base to tip -> how it is drawn.
_DRAWN = {
    "link_0": _Drawn(part=parts.base, low=1.0, high=30.0),
    "link_1": _Drawn(part=parts.shell, low=5.0, high=18.0),
    "link_2": _Drawn(part=parts.upper_arm, low=0.5, high=14.0),
    "link_3": _Drawn(part=parts.shell, low=5.0, high=18.0),
    "link_4": _Drawn(part=wrist, low=0.5, high=60.0),
    "finger_1": _Drawn(part=finger, low=0.4, high=1.0),
    "finger_2": _Drawn(part=finger, low=0.4, high=1.0),
}


@dataclass(frozen=True, eq=False)
class DrawnBody:
    """A drawn body, in its link's frame [mm].

    Attributes:
        solid: The solid, with the printed volume.
        outside: The same before its recesses, slots and shaft holes are cut.
    """

    solid: Solid
    outside: Solid


@cache
def bodies() -> dict[str, DrawnBody]:
    """Draw all bodies of the published arm, base to tip.

    Raises:
        MissingDependencyError: manifold3d is not installed.
    """
    return draw(drawn_dimensions(), printed_volumes(parameters(())))


def printed_volumes(parameters: Alpha5Parameters) -> dict[str, float]:
    """Volume of each body [mm^3]; Table 3's link 4 has the fingers in it."""
    jaws = split_link_4(parameters)
    return {
        link.name: link.volume * 1e9 for link in (*parameters.links[:4], *jaws.bodies)
    }


def draw(dimensions: Dimensions, volumes: Mapping[str, float]) -> dict[str, DrawnBody]:
    """Draw all bodies, base to tip.

    Args:
        dimensions: Of the parts.
        volumes: Of each body [mm^3].
    """
    frames = frames_in_links(dimensions)
    # Two links are the same part.
    solved: dict[tuple[_Drawn, float], DrawnBody] = {}
    drawn = {}
    for name, how in _DRAWN.items():
        key = (how, volumes[name])
        if key not in solved:
            solved[key] = _draw_part(how, dimensions, volumes[name])
        body = solved[key]
        drawn[name] = _placed(body, frames[name]) if name in frames else body
    return drawn


def _draw_part(how: _Drawn, dimensions: Dimensions, volume: float) -> DrawnBody:
    """A part with a volume [mm^3], in its own frame."""
    part = how.part(dimensions)
    solid, _ = solve_volume(part.cut, volume, how.low, how.high)
    return DrawnBody(solid=solid, outside=part.outside)


def _placed(body: DrawnBody, frame: FloatArray) -> DrawnBody:
    """A body in its link's frame."""
    return DrawnBody(
        solid=body.solid.transform(frame),
        outside=body.outside.transform(frame),
    )


def frames_in_links(dimensions: Dimensions) -> dict[str, FloatArray]:
    """Poses in their links of the parts that have frames of their own, (3, 4) [mm]."""
    shell = dimensions.shell
    across = [[-1, 0, 0], [0, 0, -1], [0, -1, 0]]
    upper_arm = dimensions.upper_arm
    slant = -math.atan2(upper_arm.drop, upper_arm.reach)
    return {
        "link_1": transform(across, (shell.axes_apart, 0.0, shell.shoulder))[:3],
        "link_2": pose((0.0, 0.0, 0.0), (0.0, 0.0, slant))[:3],
        "link_3": transform(np.diag([1.0, -1.0, -1.0]))[:3],
        # The same part as finger_1, turned about its hinge.
        "finger_2": transform(np.diag([-1.0, -1.0, 1.0]))[:3],
    }


def solve_volume(
    build: Callable[[float], Solid], volume: float, low: float, high: float
) -> tuple[Solid, float]:
    """The part of a family whose volume is the wanted one.

    Args:
        build: From the free dimension [mm] to the solid; its volume changes
            monotonically.
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

    ends = sorted([excess(low), excess(high)])
    if ends[0] * ends[1] > 0:
        reach = " to ".join(f"{(volume + end) * 1e-6:.4f}" for end in ends)
        raise InputError("volume", volume * 1e-6, f"a volume of {reach} L")
    found = float(brentq(excess, low, high, xtol=1e-7, rtol=1e-12))
    return build(found), found
