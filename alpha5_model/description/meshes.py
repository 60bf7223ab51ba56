"""The mesh files: one OBJ per body, their material library, and the whole arm as one GLB."""

from __future__ import annotations

from functools import cache

from alpha5_model.description.bodies.arm import bodies
from alpha5_model.description.bodies.materials import MATERIALS, material_of
from alpha5_model.description.bodies.obj import MTL_NAME, mtl, obj
from alpha5_model.description.bodies.surface import Surface, surface


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
    }
