"""One capsule for each link, for simulators that want few and simple shapes.

MJX has no contact between a cylinder and a box, and its cost grows with the pairs of
shapes. The capsules lie along the tubes of the links, with about their radius, so that
the named poses stay free. Corners stand out by up to 19 mm: for learning, not for
proving a motion safe. The tests measure both kinds of error.
"""

from __future__ import annotations

from typing import NamedTuple

Point = tuple[float, float, float]


class Capsule(NamedTuple):
    """A capsule in the frame of its link.

    Attributes:
        start, end: Of its axis [m].
        radius: [m].
    """

    start: Point
    end: Point
    radius: float


#: Link -> its capsule, the jaws closed and part of link_4.
_CAPSULES = {
    "link_0": Capsule((-0.1, -0.004, -0.001), (-0.002, 0.0, -0.0065), 0.019),
    "link_1": Capsule((0.0, -0.002, 0.034), (0.02, -0.002, 0.046), 0.02),
    "link_2": Capsule((0.0, 0.0, -0.0029), (0.1507, 0.0, -0.0029), 0.018),
    "link_3": Capsule((0.0, 0.0, 0.0), (0.02, -0.012, 0.0), 0.02),
    "link_4": Capsule((0.0, 0.0, -0.053), (0.0, 0.0, -0.204), 0.02),
}


def collision_capsules(spacer: float = 0.0) -> dict[str, Capsule]:
    """Link -> its capsule.

    Args:
        spacer: How far a spacer moves the jaws along -z of link_4 [m].
    """
    wrist = _CAPSULES["link_4"]
    x, y, z = wrist.end
    return {**_CAPSULES, "link_4": wrist._replace(end=(x, y, z - spacer))}
