"""Fewer collision shapes around the drawn bodies, for the files of other programs.

URDF, xacro, MJCF and USD have these. The package itself compares the shapes of
`alpha5_model.geometry.collision_shapes`, which are closer to the bodies in places, and
more. Both enclose the drawn bodies and stay within 3 mm of them, so their answers
differ only if two bodies are less than 6 mm apart.

``exported_shapes.toml`` has the shapes of each link, in its frame. The script
``scripts/shapes/fit_collision_shapes.py`` fits them around the bodies.
"""

from __future__ import annotations

import hashlib
import json
import tomllib
from dataclasses import asdict
from functools import cache
from pathlib import Path
from typing import Any

from alpha5_model._support.checks import choice
from alpha5_model.geometry.collision_shapes import (
    collision_primitives,
    with_closed_fingers,
)
from alpha5_model.geometry.primitives import Primitive
from alpha5_model.numbers.jaws import GRIPPERS

EXPORTED_SHAPES_PATH = Path(__file__).with_name("exported_shapes.toml")


@cache
def exported_primitives(
    gripper: str = "jaws", spacer: float = 0.0
) -> dict[str, tuple[Primitive, ...]]:
    """Primitives of each link of the published arm, for other programs.

    Args:
        gripper: ``jaws`` has ``finger_1`` and ``finger_2`` as links of their own, in
            ``locked`` they belong to ``link_4``, closed.
        spacer: How far spacers move the jaws along -z of link_4 [m].

    Raises:
        UnknownNameError: Another gripper.
    """
    moving = choice("gripper", gripper, GRIPPERS) == "jaws"
    shapes = {link: list(map(_primitive, rows)) for link, rows in _read().items()}
    if not moving:
        shapes = with_closed_fingers(shapes, spacer)
    return {
        link: tuple(shape.as_written() for shape in items)
        for link, items in shapes.items()
    }


def _primitive(row: dict[str, Any]) -> Primitive:
    """A shape of the file [mm]."""
    return Primitive(
        kind=row["kind"],
        size=tuple(row["size"]),
        xyz=tuple(row["xyz"]),
        rpy=tuple(row.get("rpy", (0.0, 0.0, 0.0))),
    )


def _read() -> dict[str, list[dict[str, Any]]]:
    """Link -> rows of the file."""
    table = tomllib.loads(EXPORTED_SHAPES_PATH.read_text(encoding="utf-8"))
    del table["made_for"]
    return table


def made_for() -> str:
    """Digest of the package's own shapes around which the file was fitted."""
    text = EXPORTED_SHAPES_PATH.read_text(encoding="utf-8")
    return str(tomllib.loads(text)["made_for"])


def digest() -> str:
    """Digest of the package's own shapes as they are now."""
    shapes = {
        link: [asdict(shape) for shape in items]
        for link, items in collision_primitives().items()
    }
    return hashlib.sha256(json.dumps(shapes).encode()).hexdigest()
