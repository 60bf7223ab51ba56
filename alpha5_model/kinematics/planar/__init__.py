"""Planar arms: workspace, dexterous workspace, the lecture notes' theorem."""

from alpha5_model.kinematics.planar.arrangement import Edge
from alpha5_model.kinematics.planar.curves import Arc, Curve, Segment
from alpha5_model.kinematics.planar.dexterity import DexterityMap, dexterity, dexterity_map
from alpha5_model.kinematics.planar.dexterous import (
    Conditions,
    TheoremRow,
    dexterous_area,
    dexterous_radii,
    lecture_theorem,
    necessary_conditions,
    theorem_radii,
    theorem_row,
    turns_fully,
)
from alpha5_model.kinematics.planar.workspace import PlanarArm, Workspace, annulus, workspace

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
