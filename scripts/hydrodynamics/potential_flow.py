"""Added mass by potential flow in unbounded water, with capytaine."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

#: The numbers are for fresh water [kg/m^3]; a fluid scales them by its density.
DENSITY = 1000.0
#: Constant panels err by size^2, and at a right-angled edge, where the potential goes
#: like r^(2/3), by size^(4/3).
SMOOTH = 2.0
EDGED = 4 / 3
#: Panels that are seen at a time.
ROWS = 1000
#: More panels are solved in single precision, which errs by less than 1e-6.
MANY = 15_000

Array = NDArray[np.float64]


def rigid_motions(centres: Array) -> list[Array]:
    """Velocity of the panels' centres (m, 3) in the six unit motions, linear first.

    Turns are about the origin.
    """
    linear = [np.broadcast_to(axis, centres.shape) for axis in np.eye(3)]
    angular = [np.cross(axis, centres) for axis in np.eye(3)]
    return [*linear, *angular]


def added_mass(
    vertices: Array,
    triangles: NDArray[np.int64],
    motions: Sequence[Array] | None = None,
) -> Array:
    """Added mass between motions of closed meshes.

    Args:
        vertices: (n, 3) [m].
        triangles: (m, 3), outward.
        motions: Velocity of each panel's centre, (m, 3) each; those of a rigid body if
            None.

    Returns:
        (k, k), as computed; its asymmetry is a measure of the error.
    """
    import capytaine  # late: a development tool
    import scipy.linalg
    from capytaine.green_functions.delhommeau import Delhommeau

    capytaine.set_logging("ERROR")
    # Its triangles are quadrilaterals with a corner twice.
    faces = triangles[:, [0, 1, 2, 2]]
    mesh = capytaine.Mesh(vertices, faces, auto_clean=False, auto_check=False)
    given = rigid_motions(mesh.faces_centers) if motions is None else motions
    normal_speeds = [(motion * mesh.faces_normals).sum(axis=1) for motion in given]
    speeds = np.stack(normal_speeds, axis=1)
    # Green's identity for the potential ("direct") errs by a quarter of what a
    # distribution of sources does. Without a free surface there is no frequency, and
    # the matrices are real; capytaine's are complex: some rows at a time.
    size = len(faces)
    double = np.empty((size, size), np.float32 if size > MANY else np.float64)
    sources = np.empty(speeds.shape)
    for rows in np.array_split(np.arange(size), -(-size // ROWS)):
        seen = capytaine.Mesh(vertices, faces[rows], auto_clean=False, auto_check=False)
        single, double[rows] = Delhommeau().evaluate_rankine_only(
            seen, mesh, adjoint_double_layer=False, diagonal_term_in_double_layer=False
        )
        double[rows, rows] += 0.5  # half of a panel's own flux goes inwards
        sources[rows] = single @ speeds
    # In place: a matrix of C's order is the transpose of one of Fortran's.
    in_place = {"transposed": True, "overwrite_a": True, "check_finite": False}
    potential = scipy.linalg.solve(double.T, sources.astype(double.dtype), **in_place)
    return np.asarray(-DENSITY * (speeds * mesh.faces_areas[:, None]).T @ potential)


def extrapolated(
    compute: Callable[[float], Array], sizes: Sequence[float], order: float = EDGED
) -> tuple[Array, list[Array], Array]:
    """Richardson's extrapolation to panels of no size.

    Args:
        compute: From a size of panels to the result.
        sizes: Of panels, falling: three or more, or one, whose result is returned.
        order: The error goes like size^order.

    Returns:
        The value from the last two sizes, what was computed at each, and the value from
        the two before.
    """
    found = [compute(size) for size in sizes]
    if len(found) == 1:
        return found[0], found, found[0]

    power = np.array(sizes) ** order
    before = _limit(found[-3:-1], power[-3:-1])
    last = _limit(found[-2:], power[-2:])
    return last, found, before


def _limit(values: Sequence[Array], powers: Array) -> Array:
    """The value at power 0 of the straight line through two values."""
    coarse, fine = values
    above, at = powers
    return np.asarray(fine + (fine - coarse) * at / (above - at))
