"""Added mass by potential flow in water without bounds, with capytaine's boundary elements."""

from __future__ import annotations

from collections.abc import Sequence

import capytaine
import numpy as np
from numpy.typing import NDArray

#: The numbers are for fresh water [kg/m^3]; a fluid scales them by its density.
DENSITY = 1000.0

Array = NDArray[np.float64]


def rigid_motions(centres: Array) -> list[Array]:
    """Velocity of the panels' centres (m, 3) in the six unit motions about the origin, linear first."""
    linear = [np.broadcast_to(axis, centres.shape) for axis in np.eye(3)]
    return [*linear, *(np.cross(axis, centres) for axis in np.eye(3))]


def added_mass(
    vertices: Array, quads: NDArray[np.int64], motions: Sequence[Array] | None = None
) -> Array:
    """Added mass between motions of a closed mesh, those of a rigid body if none are given.

    Args:
        vertices: (n, 3) [m].
        quads: (m, 4), outward.
        motions: Velocity of each panel's centre, (m, 3) each.

    Returns:
        (k, k), as computed; its asymmetry is a measure of the error.
    """
    capytaine.set_logging("ERROR")
    mesh = capytaine.Mesh(vertices, quads, auto_clean=False, auto_check=False)
    given = rigid_motions(mesh.faces_centers) if motions is None else motions
    dofs = {str(i): motion for i, motion in enumerate(given)}
    body = capytaine.FloatingBody(mesh=mesh, dofs=dofs)
    # The potential formulation ("direct") errs by a quarter of what the source distribution does.
    solver = capytaine.BEMSolver(method="direct")
    columns = []
    for dof in dofs:
        # Without a free surface the frequency only scales the force, and is of no account.
        problem = capytaine.RadiationProblem(
            body=body,
            free_surface=np.inf,
            water_depth=np.inf,
            omega=1.0,
            rho=DENSITY,
            radiating_dof=dof,
        )
        forces = solver.solve(problem).added_masses
        columns.append([forces[other] for other in dofs])
    return np.array(columns).T
