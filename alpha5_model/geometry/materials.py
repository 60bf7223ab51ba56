"""How the drawn bodies look."""

from __future__ import annotations

from dataclasses import dataclass


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


ANODISED = Material(
    name="anodised", rgba=(0.17, 0.18, 0.2, 1.0), metallic=0.3, roughness=0.45
)
BARE_METAL = Material(
    name="bare_metal", rgba=(0.72, 0.73, 0.75, 1.0), metallic=0.6, roughness=0.35
)
MATERIALS = (ANODISED, BARE_METAL)


def material_of(body: str) -> Material:
    """The material of a body: the fingers are bare metal, the others hard-anodised."""
    return BARE_METAL if body.startswith("finger") else ANODISED
