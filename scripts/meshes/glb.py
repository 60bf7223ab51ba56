"""The whole arm as one binary glTF 2.0 file (GLB), each link a node that turns about z.

The nodes have matrices, as trimesh writes them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import trimesh
from meshes.triangles import Surface

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import Placement, pose
from alpha5_model.description.bodies import arm_bodies
from alpha5_model.description.srdf import NAMED_POSES
from alpha5_model.geometry.materials import Material, material_of
from alpha5_model.numbers.parameters import parameters

#: Decimals of the matrices: last digits of a sine differ between processors.
_DECIMALS = 9


def glb(surfaces: Mapping[str, Surface]) -> bytes:
    """The arm in its home pose; ``link_i`` turns about z in the node of its joint.

    Args:
        surfaces: Body -> its surface.
    """
    scene = trimesh.Scene(base_frame="world")
    # glTF has y up, the base frame has z up.
    upright = _matrix(Placement("world", rpy=(-math.pi / 2, 0.0, 0.0)))
    scene.graph.update("base_link", "world", matrix=upright)
    angles = iter(NAMED_POSES["home"])
    for body in arm_bodies(parameters(), "jaws"):
        if not body.meshes:  # the rod
            continue
        at = body.placement
        if body.joint is not None:
            scene.graph.update(body.joint.name, at.parent, matrix=_matrix(at))
            angle = next(angles, 0.0)
            at = Placement(body.joint.name, rpy=(0.0, 0.0, angle))
        scene.add_geometry(
            _drawn(surfaces[body.name], material_of(body.name)),
            node_name=body.name,
            geom_name=body.name,
            parent_node_name=at.parent,
            transform=_matrix(at),
        )
    content: bytes = scene.export(file_type="glb", include_normals=True)
    return content


def _matrix(at: Placement) -> FloatArray:
    return np.asarray(np.round(pose(at.xyz, at.rpy), _DECIMALS) + 0.0)


def _drawn(surface: Surface, material: Material) -> Any:
    """A mesh with one normal for each point: split at the creases of the surface."""
    corners = np.stack([surface.faces, surface.corner_normals], axis=-1).reshape(-1, 2)
    pairs, place = np.unique(corners, axis=0, return_inverse=True)
    normals = surface.normals[pairs[:, 1]]
    look = trimesh.visual.material.PBRMaterial(
        name=material.name,
        baseColorFactor=_linear_light(material.rgba),
        metallicFactor=material.metallic,
        roughnessFactor=material.roughness,
    )
    return trimesh.Trimesh(
        vertices=surface.vertices[pairs[:, 0]],
        faces=place.reshape(-1, 3),
        vertex_normals=normals / np.linalg.norm(normals, axis=1, keepdims=True),
        visual=trimesh.visual.TextureVisuals(material=look),
        process=False,
    )


def _linear_light(rgba: tuple[float, ...]) -> list[float]:
    """A colour of sRGB (IEC 61966-2-1) in linear light, which glTF has."""
    *srgb, alpha = rgba
    linear = []
    for channel in srgb:
        dark = channel / 12.92
        bright = ((channel + 0.055) / 1.055) ** 2.4
        linear.append(dark if channel <= 0.04045 else bright)
    return [*linear, alpha]
