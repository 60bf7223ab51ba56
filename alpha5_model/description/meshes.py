"""The mesh files: one OBJ per body, their material library, and the whole arm as one GLB."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from alpha5_model.description.frames import joint_placements
from alpha5_model.description.poses import NAMED_POSES
from alpha5_model.errors import MissingFileError
from alpha5_model.jaws import split_link_4
from alpha5_model.meshing.bodies import bodies
from alpha5_model.meshing.glb import Node, glb
from alpha5_model.meshing.materials import MATERIALS, material_of
from alpha5_model.meshing.obj import MTL_NAME, mtl, obj
from alpha5_model.meshing.surface import Surface, surface
from alpha5_model.parameters import parameters
from alpha5_model.paths import REPOSITORY_PATH
from alpha5_model.spatial import quaternion_from_rpy

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
        **{f"{name}.obj": obj(name, s, material_of(name)) for name, s in surfaces().items()},
        MTL_NAME: mtl(MATERIALS),
        GLB_NAME: glb(list(_scene()), MATERIALS),
    }


def _scene() -> Iterator[Node]:
    """The arm in its home pose; node ``link_i`` turns about z in node ``axis_...`` by the joint angle."""
    arm = parameters()
    # glTF has y up, the base frame has z up.
    yield Node("base_link", quaternion=quaternion_from_rpy((-math.pi / 2, 0.0, 0.0)))
    yield _body("link_0", "base_link", (0.0, 0.0, arm.base_yaw))
    angles = NAMED_POSES["home"]
    for i, (joint, at) in enumerate(joint_placements(arm).items()):
        yield Node(joint, at.parent, at.xyz, quaternion_from_rpy(at.rpy))
        yield _body(f"link_{i + 1}", joint, (0.0, 0.0, angles[i]))
    jaws = split_link_4(arm)
    for finger in (jaws.finger_1, jaws.finger_2):
        hinge, origin = f"{finger.name}_joint", tuple(finger.origin.tolist())
        yield Node(hinge, "link_4", origin, quaternion_from_rpy((finger.roll, 0.0, 0.0)))
        yield _body(finger.name, hinge, (0.0, 0.0, 0.0))


def _body(name: str, parent: str, rpy: tuple[float, float, float]) -> Node:
    return Node(
        name,
        parent,
        quaternion=quaternion_from_rpy(rpy),
        surface=surfaces()[name],
        material=material_of(name),
    )
