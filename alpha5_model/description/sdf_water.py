"""Moving water in Gazebo: added mass and drag of a link, in SDF 1.11.

The numbers are estimated, not published.

Added mass goes into ``<fluid_added_mass>``, which is about the link's origin
[SDFormat]_. Drag is computed by Gazebo's hydrodynamics system. Its coefficients are
those of products ``nu_j |nu_k|`` about the link's origin (``yVabsV``, negative if they
brake). So its drag equals that of the strips if the velocity has one component, and
approximates it otherwise.

.. [SDFormat] SDFormat 1.11, inertial.sdf, ``fluid_added_mass``; gz-sim,
``systems::Hydrodynamics``.
"""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import cross_matrix
from alpha5_model.description.digits import rounded
from alpha5_model.description.xml import Nested
from alpha5_model.numbers.hydrodynamics import (
    WATER_DENSITY,
    BodyHydrodynamics,
    DragStrip,
    gauss_points,
)

#: Names of the components of a velocity in a matrix of added mass.
_ADDED = "xyzpqr"
#: Names of the components of a force, and of a velocity, in damping.
_FORCE = "xyzkmn"
_VELOCITY = "UVWPQR"
#: Weight of the other components in the speed of a component. The speed is a norm, but
#: Gazebo takes a weighted sum of magnitudes. With this weight, the damping differs from
#: that of the strips by a tenth in a current, and by a sixth if joints move (root mean
#: square). Weights 0 and 1 both err by more.
_BESIDE = 0.45
#: Points of the quadrature along a strip. More points do not slow the simulation.
_POINTS = 8


def added_mass(water: BodyHydrodynamics, density: float) -> dict[str, Nested]:
    """Entries ``xx`` to ``rr`` of a link's added mass in a fluid of this density."""
    matrix = water.added_mass * (density / WATER_DENSITY)
    entries: dict[str, Nested] = {}
    for i, j in combinations_with_replacement(range(6), 2):
        entries[_ADDED[i] + _ADDED[j]] = float(rounded(matrix[i, j]))
    return entries


def drag(water: BodyHydrodynamics, density: float) -> dict[str, Nested]:
    """Coefficients of quadratic damping about and in the link's frame, by their names.

    Force i is ``D[i, j, k] nu_j |nu_k|``, components linear before angular. It is exact
    for a velocity of one component, and never adds energy.
    """
    damping = np.zeros((6, 6, 6))
    for strip in water.strips:
        _add_strip(damping, strip, density)

    sizes = np.abs(damping)
    coefficients: dict[str, Nested] = {}
    for i, j, k in np.argwhere(sizes > 1e-9 * sizes.max()).tolist():
        name = f"{_FORCE[i]}{_VELOCITY[j]}abs{_VELOCITY[k]}"
        coefficients[name] = float(rounded(damping[i, j, k]))
    return coefficients


def _add_strip(damping: FloatArray, strip: DragStrip, density: float) -> None:
    """Add the damping of a strip to that of its link, (6, 6, 6)."""
    mix = _BESIDE + (1 - _BESIDE) * np.eye(6)
    line = strip.end - strip.start
    length = float(np.linalg.norm(line))
    along = np.outer(line, line) / length**2
    across = np.eye(3) - along
    for point, weight in gauss_points(strip, _POINTS):
        velocity_at_point = np.hstack([np.eye(3), -cross_matrix(point)])
        for direction, coefficient in ((across, strip.across), (along, strip.along)):
            slip = direction @ velocity_at_point
            speeds = np.linalg.norm(slip, axis=0)
            drag_area = density / 2 * coefficient * strip.diameter * length * weight
            damping -= drag_area * (slip.T @ slip)[:, :, None] * speeds * mix
