"""Meshes as Wavefront OBJ with their materials.

OBJ is the one mesh format that Pinocchio, MuJoCo, Drake and PyBullet all read. trimesh
does not write it here: its OBJ has one index for point and normal, so that the surface
would fall apart at its creases.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from meshes.triangles import DECIMALS, Surface

from alpha5_model.geometry.materials import MATERIALS, Material, material_of

MTL_NAME = "alpha5.mtl"


def obj(name: str, surface: Surface) -> bytes:
    """One body with smooth normals [m]."""
    # OBJ counts from 1.
    corners = np.stack([surface.faces, surface.corner_normals], axis=-1) + 1
    lines = [
        "# Reach Alpha 5, drawn by alpha5-model; "
        "volume after the manufacturer's Table 3. Metres.",
        f"mtllib {MTL_NAME}",
        f"o {name}",
    ]
    lines += [f"v {_decimal_text(v, DECIMALS)}" for v in surface.vertices.tolist()]
    lines += [f"vn {_decimal_text(v, 4)}" for v in surface.normals.tolist()]
    lines.append(f"usemtl {material_of(name).name}")
    for face in corners.tolist():
        indices = [f"{vertex}//{normal}" for vertex, normal in face]
        lines.append(f"f {' '.join(indices)}")
    return ("\n".join(lines) + "\n").encode("ascii")


def mtl() -> bytes:
    """The material library that the objects name."""
    return "".join(_material(material) for material in MATERIALS).encode("ascii")


def _material(material: Material) -> str:
    smooth = 1.0 - material.roughness
    shine = 0.2 + 0.6 * material.metallic * smooth
    lines = [
        f"newmtl {material.name}",
        f"Kd {_decimal_text(material.rgba[:3], 3)}",
        f"Ks {_decimal_text([shine, shine, shine], 3)}",
        f"Ns {10 ** (2.5 * smooth):.1f}",
        f"d {_decimal_text(material.rgba[3:], 3)}",
        "illum 2",
    ]
    return "\n".join(lines) + "\n"


def _decimal_text(values: Iterable[float], decimals: int) -> str:
    return " ".join(_number(value, decimals) for value in values)


def _number(value: float, decimals: int) -> str:
    """A number without zeros at its end."""
    return f"{value:.{decimals}f}".rstrip("0").rstrip(".") or "0"
