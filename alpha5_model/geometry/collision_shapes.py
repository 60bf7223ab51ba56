"""The shapes that stand for the bodies of the arm in collision, link by link.

There are three sets, fitted to the drawn bodies of the catalogue's arm:

- `collision_primitives`: what the package compares. Together they enclose the drawn
  bodies and stay within 3 mm of them. Links 1 and 3 also fill the room in which link
  2's barrels turn, where no other body fits.
- `exported_primitives`: fewer ones with the same promise, for URDF, xacro, MJCF and
  USD. Both answers differ only if two bodies are less than 6 mm apart.
- `collision_capsules`: one for each link, for simulators that want few and simple
  shapes.

The first two are in files that are generated: ``compared_shapes.toml`` by
``scripts/generate.py``, ``exported_shapes.toml`` by
``scripts/shapes/fit_collision_shapes.py``. Bodies that turn against each other at a
joint overlap, so leave adjacent pairs out (`alpha5_model.description.srdf`).
"""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from alpha5_model._support.checks import choice
from alpha5_model._support.spatial import Triple, pose
from alpha5_model.geometry.primitives import Primitive
from alpha5_model.numbers.jaws import GRIPPERS, Gripper, split_link_4
from alpha5_model.numbers.parameters import parameters

COMPARED_SHAPES_PATH = Path(__file__).with_name("compared_shapes.toml")
EXPORTED_SHAPES_PATH = Path(__file__).with_name("exported_shapes.toml")


@cache
def collision_primitives(
    gripper: Gripper = "jaws", spacer: float = 0.0
) -> dict[str, tuple[Primitive, ...]]:
    """The shapes of each link that the package compares.

    Args:
        gripper: ``jaws`` has ``finger_1`` and ``finger_2`` as links of their own, in
            ``locked`` they belong to ``link_4``, closed.
        spacer: How far spacers move the jaws along -z of link_4 [m].

    Raises:
        UnknownNameError: Another gripper.
    """
    return _shapes(COMPARED_SHAPES_PATH, gripper, spacer)


@cache
def exported_primitives(
    gripper: Gripper = "jaws", spacer: float = 0.0
) -> dict[str, tuple[Primitive, ...]]:
    """The shapes of each link for other programs; see `collision_primitives`."""
    return _shapes(EXPORTED_SHAPES_PATH, gripper, spacer)


def _shapes(
    path: Path, gripper: Gripper, spacer: float
) -> dict[str, tuple[Primitive, ...]]:
    """The shapes of a file for an arm with a gripper."""
    choice("gripper", gripper, GRIPPERS)
    links = tomllib.loads(path.read_text(encoding="utf-8"))["links"]
    shapes = {link: list(map(_primitive, rows)) for link, rows in links.items()}
    if gripper == "locked":
        # The drawn fingers are the catalogue's, on every arm.
        jaws = split_link_4(parameters(()))
        for finger in (jaws.finger_1, jaws.finger_2):
            origin = finger.origin - [0.0, 0.0, spacer]
            closed = pose(origin * 1e3, (finger.roll, 0.0, 0.0))
            for shape in shapes.pop(finger.name):
                shapes["link_4"].append(shape.moved(closed))
    return {
        link: tuple(shape.as_written() for shape in items)
        for link, items in shapes.items()
    }


def _primitive(row: dict[str, Any]) -> Primitive:
    """A shape of a file [mm, rad]."""
    return Primitive(
        kind=row["kind"],
        size=tuple(row["size"]),
        xyz=tuple(row["xyz"]),
        rpy=tuple(row.get("rpy", (0.0, 0.0, 0.0))),
    )


class Capsule(NamedTuple):
    """A capsule in the frame of its link.

    Attributes:
        start, end: Of its axis [m].
        radius: [m].
    """

    start: Triple
    end: Triple
    radius: float


#: Link -> its capsule, the jaws closed and part of link_4. They lie along the tubes of
#: the links, with about their radius, so that the named poses stay free.
_CAPSULES = {
    "link_0": Capsule((-0.1, -0.004, -0.001), (-0.002, 0.0, -0.0065), 0.019),
    "link_1": Capsule((0.0, -0.002, 0.034), (0.02, -0.002, 0.046), 0.02),
    "link_2": Capsule((0.0, 0.0, -0.0029), (0.1507, 0.0, -0.0029), 0.018),
    "link_3": Capsule((0.0, 0.0, 0.0), (0.02, -0.012, 0.0), 0.02),
    "link_4": Capsule((0.0, 0.0, -0.053), (0.0, 0.0, -0.204), 0.02),
}


def collision_capsules(spacer: float = 0.0) -> dict[str, Capsule]:
    """Link -> its capsule.

    MJX has no contact between a cylinder and a box, and its cost grows with the pairs
    of shapes. Corners of the bodies stand out of the capsules by up to 19 mm: they are
    for learning, not for proving a motion safe.

    Args:
        spacer: How far a spacer moves the jaws along -z of link_4 [m].
    """
    wrist = _CAPSULES["link_4"]
    x, y, z = wrist.end
    return {**_CAPSULES, "link_4": wrist._replace(end=(x, y, z - spacer))}
