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

from alpha5_model.geometry.collision_shapes import collision_primitives, with_gripper
from alpha5_model.geometry.primitives import Primitive

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
    table = _read()
    del table["made_for"]
    shapes = {link: list(map(_primitive, rows)) for link, rows in table.items()}
    return with_gripper(shapes, gripper, spacer)


def _primitive(row: dict[str, Any]) -> Primitive:
    """A shape of the file [mm]."""
    return Primitive(
        kind=row["kind"],
        size=tuple(row["size"]),
        xyz=tuple(row["xyz"]),
        rpy=tuple(row.get("rpy", (0.0, 0.0, 0.0))),
    )


def _read() -> dict[str, Any]:
    """The file: link -> rows, and ``made_for``."""
    return tomllib.loads(EXPORTED_SHAPES_PATH.read_text(encoding="utf-8"))


def made_for() -> str:
    """Digest of the package's own shapes around which the file was fitted."""
    return str(_read()["made_for"])


def digest() -> str:
    """Digest of the package's own shapes as they are now."""
    shapes = {
        link: [asdict(shape) for shape in items]
        for link, items in collision_primitives().items()
    }
    return hashlib.sha256(json.dumps(shapes).encode()).hexdigest()
