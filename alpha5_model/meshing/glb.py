"""Binary glTF 2.0: the whole arm in one file, each link a node that turns about its own z.

Not written by trimesh: its nodes are matrices, which glTF does not let an animation turn (section 3.5.3),
its colours are rounded to 1/255, and its files, a fifth larger, change with its version.

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

from alpha5_model.meshing.materials import Material
from alpha5_model.meshing.surface import Surface

_FLOAT, _UNSIGNED_SHORT, _UNSIGNED_INT = 5126, 5123, 5125
_ARRAY_BUFFER, _ELEMENT_ARRAY_BUFFER = 34962, 34963


@dataclass(frozen=True, eq=False)
class Node:
    """A frame of the scene, with or without a body.

    Attributes:
        name: Its name.
        parent: Name of an earlier node; empty for a root.
        translation: (3,) [m].
        quaternion: (x, y, z, w).
        surface: Body drawn in this frame.
        material: Of the body.
    """

    name: str
    parent: str = ""
    translation: tuple[float, ...] = (0.0, 0.0, 0.0)
    quaternion: tuple[float, ...] = (0.0, 0.0, 0.0, 1.0)
    surface: Surface | None = None
    material: Material | None = None


def glb(nodes: Sequence[Node], materials: Sequence[Material]) -> bytes:
    """The scene as one GLB file; a parent stands before its children."""
    blob = _Blob()
    index = {node.name: i for i, node in enumerate(nodes)}
    children: dict[str, list[int]] = {}
    for node in nodes:
        children.setdefault(node.parent, []).append(index[node.name])
    meshes: list[dict[str, Any]] = []
    scene_nodes: list[dict[str, Any]] = []
    for node in nodes:
        entry: dict[str, Any] = {"name": node.name}
        if any(node.translation):
            entry["translation"] = [round(c, 9) for c in node.translation]
        if tuple(node.quaternion) != (0.0, 0.0, 0.0, 1.0):
            entry["rotation"] = [round(c, 9) + 0.0 for c in node.quaternion]
        if node.name in children:
            entry["children"] = children[node.name]
        if node.surface is not None and node.material is not None:
            entry["mesh"] = len(meshes)
            primitive = {**blob.add(node.surface), "material": materials.index(node.material)}
            meshes.append({"name": node.name, "primitives": [primitive]})
        scene_nodes.append(entry)
    header = {
        "asset": {"version": "2.0", "generator": "alpha5-model"},
        "scene": 0,
        "scenes": [{"nodes": children[""]}],
        "nodes": scene_nodes,
        "meshes": meshes,
        "materials": [_material(m) for m in materials],
        "accessors": blob.accessors,
        "bufferViews": blob.views,
        "buffers": [{"byteLength": len(blob.data)}],
    }
    text = json.dumps(header, separators=(",", ":")).encode("ascii")
    chunks = _chunk(b"JSON", text, b" ") + _chunk(b"BIN\0", bytes(blob.data), b"\0")
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def _chunk(kind: bytes, content: bytes, filler: bytes) -> bytes:
    content += filler * (-len(content) % 4)
    return struct.pack("<I4s", len(content), kind) + content


def _material(material: Material) -> dict[str, Any]:
    # glTF wants linear light, MTL and URDF carry sRGB (IEC 61966-2-1).
    linear = [
        round(c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4, 6)
        for c in material.rgba[:3]
    ]
    return {
        "name": material.name,
        "pbrMetallicRoughness": {
            "baseColorFactor": [*linear, material.rgba[3]],
            "metallicFactor": material.metallic,
            "roughnessFactor": material.roughness,
        },
    }


class _Blob:
    """The binary part, and the tables that say what is where in it."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    def add(self, surface: Surface) -> dict[str, Any]:
        """Append a surface; glTF has one normal per vertex, so vertices split at creases."""
        corners = np.column_stack([surface.faces.reshape(-1), surface.corner_normals.reshape(-1)])
        pairs, place = np.unique(corners, axis=0, return_inverse=True)
        positions = surface.vertices[pairs[:, 0]].astype("<f4")
        normals = surface.normals[pairs[:, 1]]
        normals = (normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype("<f4")
        short = len(pairs) < 2**16 - 1
        indices = place.reshape(-1).astype("<u2" if short else "<u4")
        bounds = {"min": positions.min(0).tolist(), "max": positions.max(0).tolist()}
        return {
            "attributes": {
                "POSITION": self._accessor(positions, _FLOAT, "VEC3", _ARRAY_BUFFER, bounds),
                "NORMAL": self._accessor(normals, _FLOAT, "VEC3", _ARRAY_BUFFER, {}),
            },
            "indices": self._accessor(
                indices,
                _UNSIGNED_SHORT if short else _UNSIGNED_INT,
                "SCALAR",
                _ELEMENT_ARRAY_BUFFER,
                {},
            ),
        }

    def _accessor(
        self, array: NDArray[Any], component: int, kind: str, target: int, extra: dict[str, Any]
    ) -> int:
        content = array.tobytes()
        self.data += b"\0" * (-len(self.data) % 4)
        self.views.append(
            {
                "buffer": 0,
                "byteOffset": len(self.data),
                "byteLength": len(content),
                "target": target,
            }
        )
        self.data += content
        self.accessors.append(
            {
                "bufferView": len(self.views) - 1,
                "componentType": component,
                "count": len(array),
                "type": kind,
                **extra,
            }
        )
        return len(self.accessors) - 1
