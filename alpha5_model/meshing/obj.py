"""Wavefront OBJ, the one mesh format that Pinocchio, MuJoCo, Drake and PyBullet all read.

Not written by trimesh, which has one index for point and normal: the surface would fall apart at its creases.
"""

from __future__ import annotations

from collections.abc import Iterable

from alpha5_model.meshing.materials import Material
from alpha5_model.meshing.surface import DECIMALS, Surface

MTL_NAME = "alpha5.mtl"


def obj(name: str, surface: Surface, material: Material) -> bytes:
    """One object with smooth normals [m]."""
    lines = [
        "# Reach Alpha 5, drawn by alpha5-model; volume after the manufacturer's Table 3. Metres.",
        f"mtllib {MTL_NAME}",
        f"o {name}",
        *(f"v {_numbers(v, DECIMALS)}" for v in surface.vertices.tolist()),
        *(f"vn {_numbers(v, 4)}" for v in surface.normals.tolist()),
        f"usemtl {material.name}",
        *(
            "f " + " ".join(f"{v}//{n}" for v, n in zip(vs, ns, strict=True))
            for vs, ns in zip(
                (surface.faces + 1).tolist(), (surface.corner_normals + 1).tolist(), strict=True
            )
        ),
    ]
    return ("\n".join(lines) + "\n").encode("ascii")


def mtl(materials: Iterable[Material]) -> bytes:
    """The material library that the objects name."""
    lines: list[str] = []
    for m in materials:
        shine = 0.2 + 0.6 * m.metallic * (1.0 - m.roughness)
        lines += [
            f"newmtl {m.name}",
            f"Kd {_numbers(m.rgba[:3], 3)}",
            f"Ks {_numbers((shine,) * 3, 3)}",
            f"Ns {10 ** (2.5 * (1.0 - m.roughness)):.1f}",
            f"d {_numbers(m.rgba[3:], 3)}",
            "illum 2",
        ]
    return ("\n".join(lines) + "\n").encode("ascii")


def _numbers(values: Iterable[float], decimals: int) -> str:
    return " ".join(f"{v:.{decimals}f}".rstrip("0").rstrip(".") or "0" for v in values)
