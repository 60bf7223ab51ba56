"""The whole arm as one binary glTF 2.0 file (GLB), each link a node that turns about z.

trimesh does not write it here. Its nodes are matrices, which glTF does not let an
animation turn (section 3.5.3), its colours are rounded to 1/255, and its files, a fifth
larger, change with its version.

Reference: Khronos glTF 2.0 specification, sections 3 (structure) and 4 (GLB).
"""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.spatial import Placement, quaternion_from_rpy
from alpha5_model.geometry.materials import (
    MATERIALS,
    Material,
    linear_light,
    material_of,
)
from alpha5_model.geometry.triangles import Surface

_ROOT = Placement("")
#: Type of an array's numbers -> its code in glTF.
_COMPONENTS = {"<f4": 5126, "<u2": 5123, "<u4": 5125}
#: Type of an array's rows -> what it is bound to: points and normals, or indices.
_TARGETS = {"VEC3": 34962, "SCALAR": 34963}


@dataclass(frozen=True, eq=False)
class Node:
    """A frame of the GLB's scene, with or without a body.

    Attributes:
        name: Its name, also that of its body.
        at: Pose in an earlier node; no parent for a root.
        surface: Body drawn in this frame.
    """

    name: str
    at: Placement = _ROOT
    surface: Surface | None = None


def glb(nodes: Sequence[Node]) -> bytes:
    """The scene as one GLB file; a parent stands before its children."""
    children: dict[str, list[int]] = {}
    for i, node in enumerate(nodes):
        children.setdefault(node.at.parent, []).append(i)

    buffer = _Buffer()
    entries: list[dict[str, Any]] = []
    meshes: list[dict[str, Any]] = []
    for node in nodes:
        mesh = None
        if node.surface is not None:
            mesh = len(meshes)
            meshes.append(_mesh(node.name, node.surface, buffer))
        entries.append(_node(node, children.get(node.name), mesh))

    scene = {
        "asset": {"version": "2.0", "generator": "alpha5-model"},
        "scene": 0,
        "scenes": [{"nodes": children[""]}],
        "nodes": entries,
        "meshes": meshes,
        "materials": [_material(material) for material in MATERIALS],
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [{"byteLength": len(buffer.content)}],
    }
    text = json.dumps(scene, separators=(",", ":")).encode("ascii")
    chunks = _chunk(b"JSON", text, b" ")
    chunks += _chunk(b"BIN\0", bytes(buffer.content), b"\0")
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


class _Buffer:
    """The arrays of a scene one after the other, and where they are.

    Attributes:
        content: Their bytes.
        views: Place of each array in the content.
        accessors: Type and length of each array.
    """

    def __init__(self) -> None:
        self.content = bytearray()
        self.views: list[dict[str, int]] = []
        self.accessors: list[dict[str, Any]] = []

    def append(self, array: NDArray[Any], kind: str, **bounds: list[float]) -> int:
        """Append an array of rows of a kind; returns the number of its accessor."""
        self.content.extend(b"\0" * (-len(self.content) % 4))
        number = len(self.accessors)
        view = {
            "buffer": 0,
            "byteOffset": len(self.content),
            "byteLength": array.nbytes,
            "target": _TARGETS[kind],
        }
        accessor = {
            "bufferView": number,
            "componentType": _COMPONENTS[array.dtype.str],
            "count": len(array),
            "type": kind,
            **bounds,
        }
        self.views.append(view)
        self.accessors.append(accessor)
        self.content.extend(array.tobytes())
        return number


def _node(node: Node, children: list[int] | None, mesh: int | None) -> dict[str, Any]:
    """A frame of the scene."""
    xyz = node.at.xyz
    turn = quaternion_from_rpy(node.at.rpy)
    entry = {
        "name": node.name,
        "translation": [round(c, 9) for c in xyz] if any(xyz) else None,
        "rotation": [round(c, 9) + 0.0 for c in turn] if any(node.at.rpy) else None,
        "children": children,
        "mesh": mesh,
    }
    return {key: value for key, value in entry.items() if value is not None}


def _mesh(name: str, surface: Surface, buffer: _Buffer) -> dict[str, Any]:
    """A body, whose arrays go into the buffer."""
    points, normals, indices = _split_at_creases(surface)
    lowest = points.min(0).tolist()
    highest = points.max(0).tolist()
    primitive = {
        "attributes": {
            "POSITION": buffer.append(points, "VEC3", min=lowest, max=highest),
            "NORMAL": buffer.append(normals, "VEC3"),
        },
        "indices": buffer.append(indices, "SCALAR"),
        "material": MATERIALS.index(material_of(name)),
    }
    return {"name": name, "primitives": [primitive]}


def _split_at_creases(
    surface: Surface,
) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """Points, normals and corners of a surface; glTF has one normal per point."""
    corner_points = surface.faces.reshape(-1)
    corner_normals = surface.corner_normals.reshape(-1)
    corners = np.column_stack([corner_points, corner_normals])
    pairs, place = np.unique(corners, axis=0, return_inverse=True)

    points = surface.vertices[pairs[:, 0]]
    normals = surface.normals[pairs[:, 1]]
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    index_type = "<u2" if len(pairs) < 2**16 - 1 else "<u4"
    indices = place.reshape(-1).astype(index_type)
    return points.astype("<f4"), normals.astype("<f4"), indices


def _material(material: Material) -> dict[str, Any]:
    """A material in linear light; MTL and URDF carry sRGB."""
    *srgb, alpha = material.rgba
    linear = [round(linear_light(c), 6) for c in srgb]
    return {
        "name": material.name,
        "pbrMetallicRoughness": {
            "baseColorFactor": [*linear, alpha],
            "metallicFactor": material.metallic,
            "roughnessFactor": material.roughness,
        },
    }


def _chunk(kind: bytes, content: bytes, filler: bytes) -> bytes:
    """A chunk of the file, filled to a multiple of four bytes."""
    content += filler * (-len(content) % 4)
    return struct.pack("<I4s", len(content), kind) + content
