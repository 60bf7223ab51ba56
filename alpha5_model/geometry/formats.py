"""The formats of the meshes: Wavefront OBJ with its materials, and binary glTF 2.0.

OBJ is the one mesh format that Pinocchio, MuJoCo, Drake and PyBullet all read. The GLB is the whole arm in
one file, each link a node that turns about its own z.

Neither is written by trimesh. Its OBJ has one index for point and normal: the surface would fall apart at
its creases. Its GLB nodes are matrices, which glTF does not let an animation turn (section 3.5.3), its
colours are rounded to 1/255, and its files, a fifth larger, change with its version.

Reference: Khronos glTF 2.0 specification, sections 3 (structure) and 4 (GLB).
"""

from __future__ import annotations

import json
import struct
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.spatial import Placement, quaternion_from_rpy
from alpha5_model.geometry.solid import DECIMALS, Surface

MTL_NAME = "alpha5.mtl"
_ROOT = Placement("")
#: Type of an array's numbers -> its code in glTF.
_COMPONENTS = {"<f4": 5126, "<u2": 5123, "<u4": 5125}
#: Type of an array's rows -> what it is bound to: points and normals, or indices.
_TARGETS = {"VEC3": 34962, "SCALAR": 34963}


@dataclass(frozen=True)
class Material:
    """How a surface looks.

    Attributes:
        name: Its name in URDF, MTL and GLB.
        rgba: Colour, sRGB, each 0 to 1.
        metallic, roughness: Of the metallic-roughness model of glTF 2.0, section 3.9.
    """

    name: str
    rgba: tuple[float, float, float, float]
    metallic: float
    roughness: float


MATERIALS = (
    Material("anodised", (0.17, 0.18, 0.2, 1.0), 0.3, 0.45),
    Material("bare_metal", (0.72, 0.73, 0.75, 1.0), 0.6, 0.35),
)


def material_of(body: str) -> Material:
    """Hard-anodised bodies, bare-metal fingers."""
    return MATERIALS[body.startswith("finger")]


def obj(name: str, surface: Surface) -> bytes:
    """One body with smooth normals [m]."""
    corners = np.stack([surface.faces, surface.corner_normals], axis=-1) + 1
    lines = [
        "# Reach Alpha 5, drawn by alpha5-model; volume after the manufacturer's Table 3. Metres.",
        f"mtllib {MTL_NAME}",
        f"o {name}",
        *(f"v {_numbers(v, DECIMALS)}" for v in surface.vertices.tolist()),
        *(f"vn {_numbers(v, 4)}" for v in surface.normals.tolist()),
        f"usemtl {material_of(name).name}",
        *("f " + " ".join(f"{v}//{n}" for v, n in face) for face in corners.tolist()),
    ]
    return ("\n".join(lines) + "\n").encode("ascii")


def mtl() -> bytes:
    """The material library that the objects name."""
    text = ""
    for m in MATERIALS:
        smooth = 1.0 - m.roughness
        shine = 0.2 + 0.6 * m.metallic * smooth
        text += f"newmtl {m.name}\nKd {_numbers(m.rgba[:3], 3)}\nKs {_numbers([shine] * 3, 3)}\n"
        text += f"Ns {10 ** (2.5 * smooth):.1f}\nd {_numbers(m.rgba[3:], 3)}\nillum 2\n"
    return text.encode("ascii")


def _numbers(values: Iterable[float], decimals: int) -> str:
    return " ".join(f"{v:.{decimals}f}".rstrip("0").rstrip(".") or "0" for v in values)


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
    scene: dict[str, Any] = {
        "asset": {"version": "2.0", "generator": "alpha5-model"},
        "scene": 0,
    }
    scene |= {"scenes": [{"nodes": children[""]}], "nodes": [], "meshes": []}
    scene |= {
        "materials": [_material(m) for m in MATERIALS],
        "accessors": [],
        "bufferViews": [],
    }
    blob = bytearray()

    def append(array: NDArray[Any], kind: str, **bounds: list[float]) -> int:
        """An array, and what is where; returns the number of its accessor."""
        blob.extend(b"\0" * (-len(blob) % 4))
        number, view = len(scene["accessors"]), {"buffer": 0, "byteOffset": len(blob)}
        scene["bufferViews"].append(
            {**view, "byteLength": array.nbytes, "target": _TARGETS[kind]}
        )
        blob.extend(array.tobytes())
        place = {"bufferView": number, "componentType": _COMPONENTS[array.dtype.str]}
        scene["accessors"].append(
            {**place, "count": len(array), "type": kind, **bounds}
        )
        return number

    for node in nodes:
        xyz, turn = node.at.xyz, quaternion_from_rpy(node.at.rpy)
        entry: dict[str, Any] = {
            "name": node.name,
            "translation": [round(c, 9) for c in xyz] if any(xyz) else None,
            "rotation": [round(c, 9) + 0.0 for c in turn] if any(node.at.rpy) else None,
            "children": children.get(node.name),
        }
        if node.surface is not None:
            points, normals, indices = _split_at_creases(node.surface)
            bounds = {"min": points.min(0).tolist(), "max": points.max(0).tolist()}
            corners = {
                "POSITION": append(points, "VEC3", **bounds),
                "NORMAL": append(normals, "VEC3"),
            }
            primitive = {"attributes": corners, "indices": append(indices, "SCALAR")}
            primitive["material"] = MATERIALS.index(material_of(node.name))
            entry["mesh"] = len(scene["meshes"])
            scene["meshes"].append({"name": node.name, "primitives": [primitive]})
        scene["nodes"].append(
            {key: value for key, value in entry.items() if value is not None}
        )
    scene["buffers"] = [{"byteLength": len(blob)}]
    text = json.dumps(scene, separators=(",", ":")).encode("ascii")
    chunks = _chunk(b"JSON", text, b" ") + _chunk(b"BIN\0", bytes(blob), b"\0")
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def _chunk(kind: bytes, content: bytes, filler: bytes) -> bytes:
    content += filler * (-len(content) % 4)
    return struct.pack("<I4s", len(content), kind) + content


def _material(material: Material) -> dict[str, Any]:
    # glTF wants linear light, MTL and URDF carry sRGB (IEC 61966-2-1).
    *srgb, alpha = material.rgba
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in srgb]
    look: dict[str, Any] = {"baseColorFactor": [*(round(c, 6) for c in linear), alpha]}
    look |= {"metallicFactor": material.metallic, "roughnessFactor": material.roughness}
    return {"name": material.name, "pbrMetallicRoughness": look}


def _split_at_creases(
    surface: Surface,
) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """Points, normals and corners of a surface; glTF has one normal per point."""
    corners = np.column_stack(
        [surface.faces.reshape(-1), surface.corner_normals.reshape(-1)]
    )
    pairs, place = np.unique(corners, axis=0, return_inverse=True)
    normals = surface.normals[pairs[:, 1]]
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    indices = place.reshape(-1).astype("<u2" if len(pairs) < 2**16 - 1 else "<u4")
    return surface.vertices[pairs[:, 0]].astype("<f4"), normals.astype("<f4"), indices
