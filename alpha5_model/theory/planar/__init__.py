"""Planar arms: workspace, dexterous workspace, the lecture notes' theorem.

The dexterous workspace is the set of points reached with every orientation of the last
link.

Pin the tip at p, at a distance d from the base. The last link then turns about p, and
its other end, the wrist, runs on the circle about p whose radius is the last link's
length. p is dexterous exactly if the rest of the arm reaches that whole circle. If the
rest reaches an annulus with the radii low and high, the exact condition is

    d + l_n <= high   and   |d - l_n| >= low.

For a 3R arm, with l_4 for d as in the notes, it is ``l_3 + l_4 <= l_1 + l_2`` and
``|l_3 - l_4| >= |l_1 - l_2|``. The notes' theorem is only sufficient. Both contain
Grashof's inequality: the shortest and the longest link together are not longer than the
other two. The theorem requires l_3 to be the shortest link. But l_3 also turns fully if
l_4, the ground, is the shortest: then the four-bar linkage is a double crank.

A 3R arm that reaches every orientation at a point can also turn through all of them
with the tip held there: one elbow follows the wrist round the whole circle. Isolated
radii exist: with l = (5, 4, 1) the point p = 0 is dexterous and no neighbour is.

With joint limits, dexterity is found by enumeration. Each of evenly spaced orientations
of the last link puts the wrist at one place, which the two joints before it reach in at
most two ways. Joints before those are sampled.

References:
    [Lecture7.1] Describing Robot Arms, "Dexterous Workspace" and "A topological
        perspective for 3R-planar robots".
    [Kumar1981] Kumar, Waldron: The workspaces of a mechanical manipulator, J. Mech.
        Design 103, 1981.
    [McCarthy2011] McCarthy, Soh: Geometric Design of Linkages, section 2.4 (Grashof
        linkages).
    [Ting1989] Ting: Mobility criteria of single-loop N-bar linkages, J. Mech. Design
        111(4), 1989.
    [Siciliano2009] Siciliano et al.: Robotics, section 2.12.1 (solution of the planar
        arm).
"""

from alpha5_model.theory.arcs import Arc, Curve, Edge, Segment
from alpha5_model.theory.planar.arm import PlanarArm, Workspace
from alpha5_model.theory.planar.dexterous import (
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
    "dexterity",
    "dexterity_map",
    "dexterous_area",
    "dexterous_radii",
    "lecture_theorem",
    "necessary_conditions",
    "theorem_radii",
    "theorem_row",
    "turns_fully",
]
