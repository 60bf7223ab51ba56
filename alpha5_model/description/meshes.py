"""The mesh files: one OBJ per body, their material library, and the whole arm as one GLB."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from alpha5_model.description.bodies import arm_bodies
from alpha5_model.description.srdf import NAMED_POSES
from alpha5_model.errors import MissingFileError
from alpha5_model.meshing.bodies import bodies
from alpha5_model.meshing.formats import MTL_NAME, Node, glb, mtl, obj
from alpha5_model.meshing.solid import Surface, surface
from alpha5_model.parameters import parameters
from alpha5_model.paths import REPOSITORY_PATH

GLB_NAME = "alpha5.glb"


def mesh_assets(*suffixes: str) -> dict[str, bytes]:
    """Name -> content of the files in ``meshes/`` that end in one of the suffixes.

    Raises:
        MissingFileError: There are none.
    """
    folder = Path(REPOSITORY_PATH) / "meshes"
    files = {p.name: p.read_bytes() for p in sorted(folder.glob("*")) if p.suffix in suffixes}
    if not files:
        raise MissingFileError(folder, f"mesh files ({', '.join(suffixes)})")
    return files


@cache
def surfaces() -> dict[str, Surface]:
    """Closed surface of each body in its link's frame, base to tip.

    Raises:
        MissingDependencyError: manifold3d, with which the bodies are drawn, is not installed.
    """
    return {name: surface(body.solid) for name, body in bodies().items()}


def mesh_files() -> dict[str, bytes]:
    """Name -> content of every file in ``meshes/``; the same bytes every time.

    Raises:
        MissingDependencyError: manifold3d, with which the bodies are drawn, is not installed.
    """
    return {
        **{f"{name}.obj": obj(name, body) for name, body in surfaces().items()},
        MTL_NAME: mtl(),
        GLB_NAME: glb(list(_scene())),
    }


def _scene() -> Iterator[Node]:
    """The arm in its home pose; node ``link_i`` turns about z in node ``axis_...`` by the joint angle."""
    # glTF has y up, the base frame has z up.
    yield Node("base_link", rpy=(-math.pi / 2, 0.0, 0.0))
    angles = iter(NAMED_POSES["home"])
    for body in arm_bodies(parameters(), "jaws"):
        if not body.meshes:  # the rod
            continue
        parent, turn = body.placement.parent, body.placement.rpy
        if body.joint is not None:
            yield Node(body.joint.name, parent, body.placement.xyz, turn)
            parent, turn = body.joint.name, (0.0, 0.0, next(angles, 0.0))
        yield Node(body.name, parent, rpy=turn, surface=surfaces()[body.name])
