"""A cylinder's added mass across itself, by rings of sources instead of panels.

The potential of a body of revolution that moves across its axis goes like cos(angle),
so an integral equation along its outline is left. The pieces get smaller towards the
edge, where the velocity has no bound.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray

#: Pieces from the axis to the edge.
PIECES = 20
#: The distances of their ends from the edge are this power of even steps.
GRADING = 3

Array = NDArray[np.float64]


def cylinder_across(ratio: float) -> float:
    """Added mass over displaced mass of a cylinder with flat ends.

    Args:
        ratio: Length over diameter.
    """
    outline = _outline(ratio)
    starts = outline[:-1]
    lines = np.diff(outline, axis=0)
    lengths = np.linalg.norm(lines, axis=1)
    normals = np.column_stack([-lines[:, 1], lines[:, 0]]) / lengths[:, None]
    middles = starts + lines / 2

    single, double = _layers(starts, lines, normals)
    speeds = normals[:, 0]
    equations = 2 * np.pi * np.eye(len(lines)) - double
    potential = np.linalg.solve(equations, single @ speeds)
    return float((potential * speeds * lengths * middles[:, 0]).sum() / (2 * ratio))


def _outline(ratio: float) -> Array:
    """Points (r, h) of a cylinder's outline from the axis to the axis, radius 1."""
    inward = np.linspace(1.0, 0.0, PIECES + 1)[:, None] ** GRADING
    edge = np.array([1.0, ratio])
    face = edge * [0, 1] + (1 - inward) * [1, 0]
    side = edge - inward[::-1] * [0, ratio]
    half = np.vstack([face, side[1:]])
    return np.vstack([half, half[-2::-1] * [1, -1]])


def _layers(starts: Array, lines: Array, normals: Array) -> tuple[Array, Array]:
    """Potential of the pieces' single and double layer at the pieces' middles, (n, n).

    Args:
        starts: Of the pieces, (n, 2).
        lines: From start to end, (n, 2).
        normals: (n, 2).
    """
    n = len(lines)
    lengths = np.linalg.norm(lines, axis=1)
    middles = starts + lines / 2
    plain, crowded = _quadratures()
    single = np.zeros((n, n))
    double = np.zeros((n, n))
    for j in range(n):
        others = [i for i in range(n) if i != j]
        for seen, (places, shares) in ((others, plain), ([j], crowded)):
            ring = starts[j] + places[:, None] * lines[j]
            source, dipole = _ring(middles[seen][:, None], ring, normals[j])
            single[seen, j] = (source * shares * ring[:, 0]).sum(axis=1) * lengths[j]
            double[seen, j] = (dipole * shares * ring[:, 0]).sum(axis=1) * lengths[j]
    return single, double


def _quadratures() -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Places on a piece, 0 to 1, and their shares.

    The first are for a piece seen from others, the second, which crowd in the middle,
    for one seen from its own middle.
    """
    abscissas, weights = leggauss(8)
    nodes = (abscissas + 1) / 2
    shares = weights / 2
    graded = nodes**GRADING
    places = 0.5 + 0.5 * np.concatenate([-graded, graded])
    crowded = 0.5 * GRADING * np.tile(nodes ** (GRADING - 1) * shares, 2)
    return (nodes, shares), (places, crowded)


def _ring(at: Array, ring: Array, normal: Array) -> tuple[Array, Array]:
    """Potentials of a ring of sources and of one of dipoles, seen from angle 0.

    They are the integrals over the ring, times cos(angle), of 1 / R and of its
    derivative along the ring's normal.

    Args:
        at: Points (r, h).
        ring: Points (r, h) of the rings.
        normal: Of the ring, (2,).
    """
    near = np.linalg.norm(at - ring, axis=-1) / ring[:, 0]
    span = np.arcsinh(np.pi / near)[..., None]
    nodes, weights = leggauss(40)
    step = (nodes + 1) / 2 * span  # angles crowd where the ring is near
    angles = near[..., None] * np.sinh(step)
    shares = near[..., None] * np.cosh(step) * span * weights
    x = at[..., :1] - ring[:, :1] * np.cos(angles)
    z = (at[..., 1] - ring[:, 1])[..., None]
    distance = np.sqrt(x**2 + (ring[:, :1] * np.sin(angles)) ** 2 + z**2)
    # R's component along the normal of the ring at that angle.
    radial = at[..., :1] * np.cos(angles) - ring[:, :1]
    share = shares * np.cos(angles)
    source = (share / distance).sum(axis=-1)
    dipole = (share * (normal[0] * radial + normal[1] * z) / distance**3).sum(axis=-1)
    return source, dipole
