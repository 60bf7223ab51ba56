"""Planar arms: workspace, dexterous workspace, the lecture notes' theorem."""

from alpha5_model.planar.arm import PlanarArm, Workspace, annulus, workspace
from alpha5_model.planar.arrangement import Edge
from alpha5_model.planar.curves import Arc, Curve, Segment
from alpha5_model.planar.dexterous import (
    Conditions,
    DexterityMap,
    TheoremRow,
    dexterity,
    dexterity_map,
    dexterous_area,
    dexterous_radii,
    lecture_theorem,
    necessary_conditions,
    theorem_radii,
    theorem_row,
    turns_fully,
)

__all__ = [
    "Arc",
    "Conditions",
    "Curve",
    "DexterityMap",
    "Edge",
    "PlanarArm",
    "Segment",
    "TheoremRow",
    "Workspace",
    "annulus",
    "dexterity",
    "dexterity_map",
    "dexterous_area",
    "dexterous_radii",
    "lecture_theorem",
    "necessary_conditions",
    "theorem_radii",
    "theorem_row",
    "turns_fully",
    "workspace",
]
